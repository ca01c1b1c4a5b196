"""What tags mean: tables from OpenStreetMap's words to those of the layout."""

from __future__ import annotations

from collections.abc import Mapping

Tags = Mapping[str, str]

# (key, value) -> kind of area, first match wins; "*" stands for any other value but "no".
AREA_TABLE: tuple[tuple[str, Mapping[str, str]], ...] = (
    ("area:highway", {
        "pedestrian": "pedestrian", "footway": "pedestrian", "sidewalk": "pedestrian",
        "path": "pedestrian", "steps": "pedestrian", "cycleway": "pedestrian",
        "crossing": "road_area", "traffic_island": "pedestrian", "*": "road_area",
    }),
    ("waterway", {"riverbank": "river", "dock": "water", "boatyard": "industrial"}),
    ("natural", {
        "water": "water", "bay": "sea", "wetland": "wetland", "wood": "wood", "scrub": "scrub",
        "heath": "scrub", "grassland": "grass", "fell": "meadow", "moor": "scrub",
        "tundra": "grass",
        "sand": "sand", "beach": "sand", "shoal": "sand", "dune": "sand", "mud": "wetland",
        "bare_rock": "rock", "rock": "rock", "scree": "rock", "shingle": "rock", "stone": "rock",
        "blockfield": "rock", "glacier": "rock", "shrubbery": "scrub", "reef": "sea",
    }),
    ("water", {"*": "water"}),
    ("landuse", {
        "reservoir": "water", "basin": "water", "pond": "water", "salt_pond": "water",
        "forest": "wood", "wood": "wood", "trees": "wood", "grass": "grass",
        "village_green": "park", "recreation_ground": "park", "greenfield": "grass",
        "flowerbed": "garden", "meadow": "meadow", "farmland": "farmland", "farm": "farmland",
        "field": "farmland", "crop": "farmland", "farmyard": "industrial", "orchard": "orchard",
        "vineyard": "orchard", "plant_nursery": "orchard", "allotments": "garden",
        "greenhouse_horticulture": "farmland", "cemetery": "cemetery", "grave_yard": "cemetery",
        "quarry": "rock", "brownfield": "bare", "landfill": "bare", "logging": "bare",
        "construction": "construction", "railway": "railway", "residential": "residential",
        "commercial": "commercial", "retail": "retail", "industrial": "industrial",
        "port": "industrial", "harbour": "industrial", "depot": "industrial",
        "garages": "residential", "military": "industrial", "institutional": "civic",
        "education": "civic", "religious": "civic", "civic_admin": "civic",
        "churchyard": "cemetery",
        "conservation": "meadow", "animal_keeping": "meadow", "paddock": "meadow",
    }),
    ("leisure", {
        "swimming_pool": "pool", "park": "park", "garden": "garden", "common": "grass",
        "dog_park": "grass", "recreation_ground": "park", "playground": "playground",
        "pitch": "pitch", "track": "pitch", "miniature_golf": "golf", "golf_course": "golf",
        "nature_reserve": "", "marina": "", "sports_centre": "civic", "stadium": "civic",
        "horse_riding": "sand", "bathing_place": "sand", "beach_resort": "sand",
        "schoolyard": "playground", "outdoor_seating": "pedestrian", "bandstand": "",
    }),
    ("golf", {"bunker": "sand", "green": "pitch", "fairway": "grass", "tee": "pitch",
              "rough": "meadow", "water_hazard": "water", "lateral_water_hazard": "water"}),
    ("amenity", {
        "parking": "parking", "parking_space": "parking", "bicycle_parking": "pedestrian",
        "motorcycle_parking": "parking", "grave_yard": "cemetery", "school": "civic",
        "kindergarten": "civic", "university": "civic", "college": "civic", "hospital": "civic",
        "clinic": "civic", "townhall": "civic", "place_of_worship": "civic", "fuel": "road_area",
        "bus_station": "road_area", "marketplace": "pedestrian", "swimming_pool": "pool",
        "fountain": "water", "prison": "civic", "fire_station": "civic", "police": "civic",
        "taxi": "road_area",
    }),
    ("place", {"square": "pedestrian", "islet": "", "island": ""}),
    ("railway", {"platform": "pedestrian", "yard": "railway", "turntable": "railway",
                 "station": ""}),
    ("public_transport", {"platform": "pedestrian"}),
    ("man_made", {"pier": "pier", "breakwater": "pier", "groyne": "pier", "quay": "pier",
                  "wastewater_plant": "industrial", "works": "industrial",
                  "water_works": "industrial",
                  "bridge": ""}),
    ("aeroway", {"runway": "road_area", "taxiway": "road_area", "apron": "road_area",
                 "helipad": "pedestrian", "aerodrome": "grass"}),
    ("power", {"substation": "industrial", "plant": "industrial"}),
    ("tourism", {"camp_site": "grass", "caravan_site": "grass", "picnic_site": "grass",
                 "zoo": "park", "theme_park": "park"}),
    ("landcover", {"grass": "grass", "trees": "wood", "scrub": "scrub", "flowerbed": "garden",
                   "sand": "sand", "gravel": "bare", "bushes": "scrub"}),
)  # fmt: skip
WATER_KINDS = frozenset({"water", "sea", "river", "pool"})

# A closed way of these keys is a line unless area=yes says otherwise.
LINEAR_KEYS = ("highway", "railway", "barrier", "aerialway", "route")
LINEAR_VALUES = frozenset({
    ("natural", "coastline"), ("natural", "cliff"), ("natural", "ridge"), ("natural", "arete"),
    ("natural", "tree_row"), ("leisure", "slipway"),
    ("man_made", "breakwater"), ("man_made", "groyne"), ("man_made", "embankment"),
    ("man_made", "pier"), ("man_made", "quay"), ("aeroway", "taxiway"), ("aeroway", "runway"),
})  # fmt: skip
AREA_ALWAYS = frozenset({"platform"})  # highway and railway values that are areas when closed

NO_BUILDING = frozenset({
    "", "no", "none", "false", "entrance", "proposed", "planned", "demolished", "razed",
    "destroyed", "collapsed", "abandoned:yes", "underground", "door", "gate",
})  # fmt: skip
ROOF_ONLY = frozenset({"roof", "carport", "canopy", "shelter", "pergola"})
TOWERS = frozenset({
    "tower", "chimney", "silo", "storage_tank", "water_tower", "gasometer", "cooling_tower",
    "lighthouse", "communications_tower", "windmill", "watermill", "bunker_silo", "kiln",
    "observatory", "minaret", "campanile", "obelisk", "cooling", "gas_holder", "water_tank",
    "reservoir_covered",
})  # fmt: skip

# Lanes and surface of the streets without tags, by class; the place decides how wide they are.
ROAD_TABLE: Mapping[str, tuple[int, str]] = {
    "motorway": (4, "asphalt"),
    "motorway_link": (1, "asphalt"),
    "trunk": (2, "asphalt"),
    "trunk_link": (1, "asphalt"),
    "primary": (2, "asphalt"),
    "primary_link": (1, "asphalt"),
    "secondary": (2, "asphalt"),
    "secondary_link": (1, "asphalt"),
    "tertiary": (2, "asphalt"),
    "tertiary_link": (1, "asphalt"),
    "residential": (2, "asphalt"),
    "unclassified": (2, "asphalt"),
    "living_street": (2, "paving_stones"),
    "service": (1, "asphalt"),
    "busway": (2, "asphalt"),
    "track": (1, "gravel"),
    "pedestrian": (1, "paving_stones"),
    "footway": (1, "paving_stones"),
    "cycleway": (1, "asphalt"),
    "path": (1, "ground"),
    "bridleway": (1, "ground"),
    "steps": (1, "paving_stones"),
    "rail": (1, "ballast"),
    "light_rail": (1, "ballast"),
    "subway": (1, "ballast"),
    "tram": (1, "asphalt"),
}
# Words of highway=* and railway=* that mean one of the classes above.
ROAD_WORDS: Mapping[str, str] = {
    "road": "unclassified", "minor": "residential", "byway": "track", "stairs": "steps",
    "bus_guideway": "busway", "raceway": "service", "sidewalk": "footway", "crossing": "footway",
    "trail": "path", "alley": "service", "driveway": "service", "street": "residential",
    "residental": "residential", "ford": "unclassified", "access": "service",
    "footpath": "footway", "unsurfaced": "track", "services": "service",
}  # fmt: skip
RAIL_WORDS: Mapping[str, str] = {
    "rail": "rail", "light_rail": "light_rail", "subway": "subway", "tram": "tram",
    "narrow_gauge": "rail", "preserved": "rail",
}  # fmt: skip
CARS = frozenset({
    "motorway", "motorway_link", "trunk", "trunk_link", "primary", "primary_link", "secondary",
    "secondary_link", "tertiary", "tertiary_link", "residential", "unclassified", "living_street",
    "service", "busway",
})  # fmt: skip
SURFACE_WORDS: Mapping[str, str] = {
    "asphalt": "asphalt", "paved": "asphalt", "chipseal": "asphalt", "tarmac": "asphalt",
    "bitmac": "asphalt", "bitumen": "asphalt", "concrete": "concrete",
    "concrete:plates": "concrete",
    "concrete:lanes": "concrete", "cement": "concrete", "sett": "sett", "cobblestone": "sett",
    "unhewn_cobblestone": "sett", "cobblestone:flattened": "sett", "stone": "sett",
    "paving_stones": "paving_stones", "paving_stones:lanes": "paving_stones",
    "bricks": "paving_stones", "brick": "paving_stones", "tiles": "paving_stones",
    "granite": "paving_stones", "flagstone": "paving_stones", "plates": "paving_stones",
    "grass_paver": "grass_paver", "gravel": "gravel", "fine_gravel": "gravel",
    "compacted": "gravel", "pebblestone": "gravel", "crushed_limestone": "gravel",
    "unpaved": "gravel", "dirt": "ground", "earth": "ground", "ground": "ground", "mud": "ground",
    "soil": "ground", "clay": "ground", "woodchips": "ground", "grass": "grass", "sand": "sand",
    "wood": "wood", "metal": "metal", "metal_grid": "metal", "tartan": "tartan",
    "ballast": "ballast",
}  # fmt: skip

LINE_TABLE: tuple[tuple[str, Mapping[str, str]], ...] = (
    ("barrier", {
        "wall": "wall", "fence": "fence", "hedge": "hedge", "city_wall": "city_wall",
        "retaining_wall": "retaining_wall", "wire_fence": "fence", "wood_fence": "fence",
        "railing": "fence", "noise_barrier": "wall", "jersey_barrier": "wall",
        "hedge_bank": "hedge",
        "wooden_fence": "fence", "metal_fence": "fence", "sound_barrier": "wall",
    }),
    ("natural", {"tree_row": "tree_row", "hedge": "hedge"}),
    ("historic", {"citywalls": "city_wall", "city_wall": "city_wall"}),
)  # fmt: skip
LINE_HEIGHT: Mapping[str, float] = {
    "wall": 1.8, "fence": 1.5, "hedge": 1.5, "city_wall": 6.0, "tree_row": 9.0,
    "retaining_wall": 1.5, "route": 0.0, "curve": 0.0,
}  # fmt: skip

# Values of amenity=* that have a front and a sign like a shop.
LET_TO_TRADE = (
    "cafe", "restaurant", "fast_food", "bar", "pub", "biergarten", "nightclub", "ice_cream",
    "pharmacy", "bank", "bureau_de_change", "internet_cafe",
)  # fmt: skip
POINT_TABLE: tuple[tuple[str, Mapping[str, str]], ...] = (
    ("natural", {"tree": "tree", "shrub": "shrub"}),
    ("highway", {
        "street_lamp": "street_lamp", "bus_stop": "bus_stop", "traffic_signals": "traffic_signals",
        "crossing": "crossing", "stop": "stop", "give_way": "give_way",
        "turning_circle": "turning_circle", "turning_loop": "turning_circle",
        "mini_roundabout": "mini_roundabout",
    }),
    ("amenity", {
        "bench": "bench", "waste_basket": "waste_basket", "waste_disposal": "waste_basket",
        "post_box": "post_box", "telephone": "telephone", "bicycle_parking": "bicycle_parking",
        "fountain": "fountain", "vending_machine": "vending_machine", "recycling": "recycling",
        "parking_meter": "vending_machine",
    }),
    ("emergency", {"fire_hydrant": "fire_hydrant"}),
    ("barrier", {"bollard": "bollard"}),
    ("advertising", {"column": "advertising_column", "poster_box": "advertising_column"}),
    ("power", {"pole": "power_pole"}),
    ("man_made", {"street_lamp": "street_lamp", "flagpole": "flagpole",
                  "utility_pole": "power_pole",
                  "street_cabinet": ""}),
    ("historic", {"memorial": "", "monument": "statue"}),
    ("artwork_type", {"statue": "statue", "sculpture": "statue", "bust": "statue"}),
    ("memorial", {"statue": "statue", "bust": "statue"}),
    ("public_transport", {"pole": "bus_stop"}),
    ("building", {"entrance": "entrance"}),
    ("entrance", {"*": "entrance"}),
    ("door", {"*": "entrance"}),
    ("shop", {"vacant": "", "*": "shop"}),
    ("amenity", dict.fromkeys(LET_TO_TRADE, "shop")),
)  # fmt: skip
# Metres, low and high; a hash of the id chooses between.
POINT_HEIGHT: Mapping[str, tuple[float, float]] = {
    "tree": (6.0, 14.0), "shrub": (0.8, 2.0), "street_lamp": (5.0, 8.0), "bench": (0.85, 0.85),
    "waste_basket": (1.0, 1.0), "bollard": (0.9, 0.9), "bus_stop": (2.8, 2.8),
    "traffic_signals": (3.4, 3.4), "crossing": (0.0, 0.0), "stop": (2.4, 2.4),
    "give_way": (2.4, 2.4), "fire_hydrant": (0.8, 0.8), "post_box": (1.3, 1.3),
    "telephone": (2.3, 2.3), "bicycle_parking": (0.8, 0.8), "fountain": (1.2, 2.5),
    "advertising_column": (3.6, 3.6), "power_pole": (8.0, 10.0), "statue": (2.5, 5.0),
    "entrance": (2.1, 2.1), "vending_machine": (1.8, 1.8), "recycling": (1.5, 1.5),
    "flagpole": (7.0, 10.0), "turning_circle": (0.0, 0.0), "mini_roundabout": (0.0, 0.0),
    "shop": (0.0, 0.0),
}  # fmt: skip

ROOF_WORDS: Mapping[str, str] = {
    "flat": "flat", "gabled": "gabled", "hipped": "hipped", "half-hipped": "half-hipped",
    "pyramidal": "pyramidal", "skillion": "skillion", "gambrel": "gambrel", "mansard": "mansard",
    "dome": "dome", "onion": "onion", "round": "round", "saltbox": "saltbox",
    "sawtooth": "sawtooth", "cone": "cone", "butterfly": "butterfly", "zollinger": "zollinger",
    "crosspitched": "crosspitched", "side_hipped": "side_hipped",
    "side_half-hipped": "side_half-hipped", "hipped-and-gabled": "hipped-and-gabled",
    "gabled_row": "gabled_row", "gabled_height_moved": "gabled_height_moved",
    "double_saltbox": "double_saltbox", "quadruple_saltbox": "quadruple_saltbox",
    "none": "flat", "no": "flat", "terrace": "flat", "gable": "gabled", "pitched": "gabled",
    "side_gabled": "gabled", "cross_gabled": "crosspitched", "cross-gabled": "crosspitched",
    "double_pitch": "gabled", "hip": "hipped", "hip-and-gable": "hipped-and-gabled",
    "half_hipped": "half-hipped", "bellcast_hipped": "hipped", "bellcast_gabled": "gabled",
    "hipped_and_gabled": "hipped-and-gabled", "side_half_hipped": "side_half-hipped",
    "side-hipped": "side_hipped", "pyramid": "pyramidal", "tented": "pyramidal",
    "spire": "pyramidal", "lean_to": "skillion", "lean-to": "skillion", "shed": "skillion",
    "pent": "skillion", "monopitch": "skillion", "triple_saltbox": "double_saltbox",
    "barrel": "round", "arched": "round", "vaulted": "round", "half_round": "round",
    "conical": "cone", "spherical": "dome", "cupola": "dome",
    "dutch_gabled": "hipped-and-gabled", "mansard_hipped": "mansard",
}  # fmt: skip


def lookup(table: tuple[tuple[str, Mapping[str, str]], ...], tags: Tags) -> str:
    """Return the first kind of a table that the tags match, or ""."""
    for key, values in table:
        value = tags.get(key)
        if value is not None:
            kind = values.get(value)
            if kind is None and value != "no":
                kind = values.get("*")
            if kind:
                return kind
    return ""


def area_kind(tags: Tags) -> str:
    """Return the kind of area of a closed outline with these tags, or ""."""
    highway = tags.get("highway")
    if highway and (is_area(tags) or highway in AREA_ALWAYS):
        cars = ROAD_WORDS.get(highway, highway) in CARS
        return "road_area" if cars else "pedestrian"
    kind = lookup(AREA_TABLE, tags)
    if kind == "water":
        water = tags.get("water", "")
        return {"river": "river", "canal": "river", "pool": "pool"}.get(water, "water")
    if kind == "wood" and tags.get("produce") == "fruit":
        return "orchard"
    return kind


def is_water(tags: Tags) -> bool:
    """Tell whether an outline with these tags encloses water."""
    return area_kind(tags) in WATER_KINDS


def is_area(tags: Tags) -> bool:
    """Tell whether area=yes or type=multipolygon is given."""
    return tags.get("area") == "yes" or tags.get("type") in ("multipolygon", "boundary")


def closed_is_area(tags: Tags) -> bool:
    """Tell whether a closed way with these tags encloses an area."""
    if tags.get("area") == "no":
        return False
    if is_area(tags) or "area:highway" in tags:
        return True
    for key in LINEAR_KEYS:
        value = tags.get(key)
        if value and value not in AREA_ALWAYS and not (key == "barrier" and area_kind(tags)):
            return False
    return LINEAR_VALUES.isdisjoint(tags.items())


def is_underground(tags: Tags) -> bool:
    """Tell whether a thing lies below the ground."""
    if tags.get("location") in ("underground", "underwater", "subsurface"):
        return True
    for key in ("layer", "level"):
        value = tags.get(key)
        if value is not None and value.startswith("-") and not _reaches_up(value):
            return not any(name in tags for name in ("height", "building:levels"))
    return False


def _reaches_up(levels: str) -> bool:
    """Tell whether a list of levels such as "-1;0" holds one at or above the ground."""
    return any(part.strip() and not part.strip().startswith("-") for part in levels.split(";"))
