"""What predicates can measure: names of the brief in the words of the predicate language."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from cityx.assets.furniture.street_furniture import outside_pieces
from cityx.assets.styles.style_shares import outside_styles
from cityx.language.lexicon.nouns import outside_types

# Noun of the brief -> a choice of things. Nouns that stand in none of these tables have no measure.
_SAME = (
    "building", "tree", "park", "garden", "lake", "river", "sea", "beach", "plaza", "fountain",
    "meadow", "playground", "cemetery", "bridge", "railway", "bench", "traffic_light",
    "streetlight", "statue", "vehicle", "bus", "pedestrian", "boat", "green", "water", "road",
    "sidewalk", "path", "pond", "forest", "waste_basket", "bollard", "planter", "bicycle_stand",
    "bus_stop", "kiosk", "picnic_table", "hydrant", "flagpole", "post_box", "parasol", "cone",
)  # fmt: skip
_RENAMED = {
    "canal": "river", "harbour": "pier", "lawn": "grass", "sports_field": "pitch",
    "parking_lot": "parking", "hedge": "shrub", "flower": "flower_bed", "vineyard": "orchard",
    "main_street": "road, class=main", "side_street": "road, class=local",
    "avenue": "road, class=avenue", "ring_road": "road, class=ring",
    "motorway": "road, class=motorway", "truck": "vehicle, type=truck",
    "bicycle": "vehicle, type=bicycle", "car": "vehicle, type=car",
    "man": "pedestrian, gender=male", "woman": "pedestrian, gender=female",
    "everything": "building",
}  # fmt: skip
# Type of building -> the condition that tells it: by its measures, its use or its tag in OSM.
TYPES: Mapping[str, str] = MappingProxyType(
    {
        "tower": "type=tower", "house": "type=house", "warehouse": "type=warehouse",
        "factory": "type=factory", "shed": "type=shed", "church": "type=church",
        "apartment": "use=flats", "office": "use=office", "shop": "use=retail",
        "mall": "use=retail", "terrace": "tag=terrace", "villa": "tag=villa",
        "cottage": "tag=cottage", "bungalow": "tag=bungalow", "hotel": "tag=hotel",
        "cathedral": "tag=cathedral", "mosque": "tag=mosque", "temple": "tag=temple",
        "school": "tag=school", "university": "tag=university", "hospital": "tag=hospital",
        "station": "tag=train_station", "stadium": "tag=stadium", "town_hall": "tag=townhall",
        "museum": "tag=museum", "library": "tag=library", "theatre": "tag=theatre",
        "castle": "tag=castle", "barn": "tag=barn", "greenhouse": "tag=greenhouse",
        "garage": "tag=garage", "parking": "tag=parking", "petrol_station": "tag=fuel",
        "market_hall": "tag=marketplace",
    }
)  # fmt: skip
MATERIALS: Mapping[str, str] = MappingProxyType(
    {name: name for name in ("brick", "glass", "concrete", "stone", "plaster", "metal")}
    | {"timber": "wood"}
)
COLORS: Mapping[str, str] = MappingProxyType(
    {name: name for name in (
        "red", "orange", "yellow", "green", "blue", "purple", "pink", "brown", "beige", "white",
        "grey", "black", "turquoise",
    )}
    | {"light_blue": "blue", "gold": "yellow", "terracotta": "orange"}
)  # fmt: skip
ROOFS: Mapping[str, str] = MappingProxyType(
    {"tile": "tiles", "slate": "slate", "thatch": "thatch", "metal": "metal", "green": "grass"}
)
STYLES = frozenset(
    {
        "american", "art_deco", "asian", "british", "brutalist", "chinese", "classical",
        "european", "futuristic", "georgian", "haussmann", "japanese", "mediterranean", "modern",
        "postmodern", "soviet", "victorian",
    }
)  # fmt: skip
USES: Mapping[str, str] = MappingProxyType(
    {name: name for name in ("residential", "office", "retail", "industrial")}
)
PATTERNS = ("grid", "radial", "organic", "ring")
SIDES = ("north", "east", "south", "west")

_LOOKS: Mapping[str, tuple[str, Mapping[str, str]]] = {
    "building.material": ("material", MATERIALS), "material": ("material", MATERIALS),
    "building.color": ("color", COLORS), "color": ("color", COLORS),
    "building.roof": ("roof", ROOFS), "roof": ("roof", ROOFS), "building.use": ("use", USES),
}  # fmt: skip


def things(noun: str) -> str:
    """Return the choice of things that a noun or an id names; "" where nothing measures it."""
    if noun in _SAME or (any(letter.isdigit() for letter in noun) and noun.isascii()):
        return noun
    if noun in outside_pieces():
        return noun
    if condition("type", noun):
        return f"building, {condition('type', noun)}"
    return _RENAMED.get(noun, "")


def condition(key: str, value: str) -> str:
    """Return the condition on buildings that a slot says, "" where nothing measures it."""
    if key in ("building.type", "type"):
        return f"generator={value}" if value in outside_types() else TYPES.get(value, "")
    if key == "style":
        return f"style={value}" if value in STYLES or value in outside_styles() else ""
    name, words = _LOOKS.get(key, ("", {}))
    return f"{name}={words[value]}" if value in words else ""
