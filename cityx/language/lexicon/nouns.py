"""Nouns of the phrase book, and the looks of things: materials and colours."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from cityx.protocol.plugged import mesh_actions
from cityx.system.extensions import remembered

Book = Mapping[str, Mapping[str, str]]

# Nouns: class -> canonical noun -> triggers. "type" are types of building.
NOUNS: Book = {
    "building": {
        "building": "building, structure, edifice, construction, blocks of buildings, "
        "built structure, cube, volume",
    },
    "type": {
        "house": "house, detached house, home, dwelling, family house, single family house, "
        "family home, detached home, semi detached house, semi, townhome, farmhouse, "
        "private house, residence, single family home, suburban house, semi detached",
        "terrace": "terraced house, terrace house, row house, rowhouse, townhouse, town house, "
        "terraced, brownstone, terraces of houses, rows of terraces, row of houses, "
        "terraced home, canal house",
        "villa": "villa, mansion, manor, country house, estate house",
        "cottage": "cottage, cabin, hut, chalet, log cabin",
        "bungalow": "bungalow, ranch house, single storey house, one storey house",
        "apartment": "apartment, apartment block, apartment building, apartment house, flat, "
        "block of flats, tenement, residential block, condominium, condo, condo building, "
        "residential building, mietshaus, multi family house, housing block, panel building, "
        "tower block of flats, walk up, slab block, slab, multi family building, tenement house, "
        "living block, "
        "multi storey flats, apartment complex, perimeter block",
        "tower": "tower, skyscraper, high rise, highrise, high rise building, high rise tower, "
        "tower block, office tower, sky scraper, apartment tower, "
        "tall tower, high riser, glass tower block, towering building, high rise block, "
        "multi storey tower, superstructure, high building, cloud scraper",
        "office": "office, office building, office block, corporate building, headquarters, "
        "office complex, bank building, office slab, commercial building, business building",
        "hotel": "hotel, inn, hostel, resort hotel",
        "shop": "shop, store, boutique, cafe, restaurant, shopping arcade, bar, pub, bakery, "
        "eatery, retail building, shop house, shophouse, diner, bistro, coffee shop",
        "mall": "mall, shopping mall, shopping center, department store, supermarket, big box "
        "store, hypermarket",
        "warehouse": "warehouse, depot, storage hall, storehouse, storage building, hangar, "
        "logistics center, storage shed, distribution center, wharehouse, wherehouse, "
        "industrial shed, logistics hall, storage facility",
        "factory": "factory, plant, manufacturing plant, workshop, mill, industrial hall, "
        "production hall, industrial building, foundry, power plant, refinery, power station, "
        "steelworks, factory hall, manufactory",
        "church": "church, chapel, parish church",
        "cathedral": "cathedral, basilica, minster",
        "mosque": "mosque, minaret",
        "temple": "temple, shrine, pagoda, synagogue",
        "school": "school, primary school, kindergarten, college building, high school",
        "university": "university, university building, college, lecture hall, faculty building",
        "hospital": "hospital, clinic, medical center",
        "station": "railway station, train station, central station, station, main station, "
        "metro station, rail station, station building",
        "stadium": "stadium, arena, sports arena, football ground, ball park",
        "town_hall": "town hall, city hall, rathaus",
        "museum": "museum, gallery, art gallery",
        "library": "library",
        "theatre": "theater, opera house, concert hall, cinema, opera, playhouse",
        "castle": "castle, fortress, citadel, palace, fort",
        "barn": "barn, farm building, stable, silo, farm",
        "greenhouse": "greenhouse, glasshouse, hothouse",
        "garage": "garage, carport, lock up garage",
        "parking": "parking garage, multi storey car park, parking structure, car park building, "
        "parking deck",
        "petrol_station": "petrol station, gas station, filling station, service station",
        "lighthouse": "lighthouse",
        "market_hall": "market hall, covered market",
        "monument": "monument, obelisk, triumphal arch, memorial",
        "shed": "shed, garden shed, outbuilding",
    },
    "element": {
        "park": "park, city park, public park, central park, urban park, green park, "
        "municipal park, parkland, parklet",
        "garden": "garden, front garden, back garden, backyard, yard, front yard, public garden, "
        "botanical garden, back yard, kitchen garden, allotment, gardened",
        "lake": "lake, lagoon, reservoir, boating lake",
        "pond": "pond, duck pond, pool, basin, fish pond",
        "river": "river, stream, brook, creek, watercourse, waterway, rivulet, riverside, "
        "river bank, riverbank, riverfront",
        "canal": "canal, channel, water channel, gracht",
        "sea": "sea, ocean, open sea, bay, gulf, open water",
        "beach": "beach, sandy beach, sand beach, sandy shore, strand, pebble beach, "
        "beachfront, sands, sandy strip",
        "harbour": "harbor, port, marina, dock, quay, wharf, pier, jetty, seaport, yacht harbor",
        "plaza": "plaza, square, main square, town square, market square, piazza, "
        "market place, marketplace, city square, central square, public square, forum, "
        "central plaza, village square, village green square, cathedral square, main plaza, "
        "public plaza, platz, plazas, town plaza, central marketplace, agora",
        "fountain": "fountain, water feature, water jet, water fountain",
        "forest": "forest, wood, woodland, grove, woods, copse, thicket, pine forest",
        "meadow": "meadow, field, pasture, grassland, wildflower meadow, green field",
        "lawn": "lawn, grass, green lawn, grass area, turf, village green, grassy area",
        "playground": "playground, play area, children's playground, play ground",
        "sports_field": "sports field, football pitch, playing field, football field, soccer "
        "field, sports ground, tennis court, basketball court, pitch",
        "cemetery": "cemetery, graveyard, churchyard, burial ground",
        "island": "island, isle, islet, peninsula",
        "wall": "city wall, town wall, rampart, ring of walls, defensive wall",
        "bridge": "bridge, footbridge, overpass, viaduct, pedestrian bridge, road bridge, "
        "river crossing",
        "tunnel": "tunnel, underpass, subway tunnel",
        "railway": "railway, railroad, train track, rail line, railway line, rail track, "
        "train line",
        "roundabout": "roundabout, traffic circle, rotary",
        "parking_lot": "parking lot, car park, parking area, parking space",
        "promenade": "promenade, esplanade, boardwalk, waterfront promenade, corniche",
        "statue": "statue, sculpture",
        "courtyard": "courtyard, inner courtyard, inner yard, patio",
        "green": "green space, green area, greenspace, open space, green spaces, green land",
        "water": "water, body of water, water surface, water bodies",
        "waterfall": "waterfall, cascade",
        "vineyard": "vineyard, orchard",
        "cycleway": "bike lane, cycle lane, cycle path, cycleway, bike path, bicycle path, "
        "bicycle lane",
        "airport": "airport, airfield, runway",
        "bench": "bench, seat, street furniture",
        "waste_basket": "bin, waste basket, litter bin, trash can, garbage can, rubbish bin, "
        "waste bin, dustbin, litter basket, trash bin",
        "bollard": "bollard",
        "planter": "planter, flower tub, plant tub",
        "bicycle_stand": "bicycle stand, bike rack, bike stand, cycle stand, bicycle rack, "
        "bicycle parking, bike parking, cycle rack",
        "bus_stop": "bus stop, bus shelter",
        "kiosk": "kiosk, newsstand, news stand",
        "picnic_table": "picnic table",
        "hydrant": "hydrant, fire hydrant",
        "flagpole": "flagpole, flag pole",
        "post_box": "post box, postbox, mailbox, letter box, pillar box",
        "parasol": "parasol, sunshade",
        "cone": "traffic cone, cone",
        "crosswalk": "crosswalk, zebra crossing, pedestrian crossing",
        "traffic_light": "traffic light, traffic signal, stop light, stoplight",
        "streetlight": "street light, streetlight, street lamp, lamp post, lamppost, lamp, "
        "street lighting, lantern, streetlamp, light pole, lighting",
        "billboard": "billboard, advertising board, hoarding, advertisement, sign",
        "market": "market stall, street market, stall, farmers market",
        "hedge": "hedge, shrub, bush, hedgerow, shrubbery",
        "flower": "flower, flower bed, flowerbed, flowering",
        "fence": "fence, railing, picket fence",
    },
    "plant": {
        "tree": "tree, street tree, plane tree, oak, oak tree, lime tree, linden, maple, birch, "
        "chestnut, chestnut tree, pine, pine tree, palm, palm tree, fir, poplar, willow, "
        "cherry tree, beech, elm, cypress, olive tree, shade tree, evergreen, conifer, planting, "
        "plant, vegetation, foliage",
    },
    "vehicle": {
        "vehicle": "vehicle, car, automobile, motor car, motor vehicle, traffic, motorcar, "
        "car parked, vehicle parked, motor traffic, motorized traffic, motorised traffic, "
        "parked car, auto, road traffic, car traffic",
        "bus": "bus, coach, double decker, city bus",
        "truck": "truck, lorry, hgv, pickup, semi truck, semi trailer, delivery truck",
        "taxi": "taxi, cab, taxicab, yellow cab",
        "van": "van, minivan, delivery van, minibus, camper",
        "motorcycle": "motorcycle, motorbike, scooter, moped, vespa",
        "bicycle": "bicycle, bike, cyclist, cycle, push bike, biker, rider",
        "tram": "tram, streetcar, trolley, tramway, light rail",
        "train": "train, locomotive",
        "boat": "boat, ship, ferry, barge, yacht, sailing boat, gondola, sailboat",
        "ambulance": "ambulance, fire engine, fire truck, police car, emergency vehicle",
        "sedan": "sedan, saloon car, hatchback, suv, sports car, estate car",
    },
    "person": {
        "pedestrian": "pedestrian, person, passer by, passers by, walker, human, resident, "
        "stroller, shopper, tourist, character, figure, human being, passerby, folk, inhabitant, "
        "citizen, somebody, anyone, anybody, soul, visitor, runner, jogger, commuter, "
        "human figure, townsfolk, human character, foot traffic, pedestrian traffic, walking "
        "person, child, kid, worker, crowd of people",
        "man": "man, guy, gentleman, boy, male, male jogger, male pedestrian, male person, bloke, "
        "businessman, male character, lad",
        "woman": "woman, lady, girl, female, female jogger, female pedestrian, female person, "
        "businesswoman, female character",
        "dog": "dog, animal, cat, pet",
    },
    "road": {
        "road": "road, street, lane, roadway, carriageway, thoroughfare, alley, alleyway, "
        "path network, street network, road network, asphalt road, secondary road, strasse",
        "main_street": "main street, main road, main avenue, boulevard, high road, "
        "primary road, arterial, arterial road, main thoroughfare, major road, principal road, "
        "high street, main boulevard, trunk road, highway, central avenue, main artery, "
        "primary street, artery, principal street, grand boulevard, central boulevard, "
        "major street, main axis, central road, "
        "major avenue, principal avenue, main highway, dual carriageway, parkway",
        "motorway": "motorway, freeway, expressway, autobahn, interstate, elevated highway, "
        "elevated road, elevated motorway, elevated expressway, urban motorway, city motorway, "
        "flyover, tollway, turnpike, controlled-access highway",
        "avenue": "avenue, radial road, radial street, radial avenue, radial, spoke, axis, "
        "radial boulevard",
        "side_street": "side street, other street, local street, other road, side road, back "
        "street, minor road, minor street, residential street, remaining street, local road, "
        "secondary street, rest of the streets, remaining road, "
        "smaller street, smaller road, residential road, lesser street, every other street, "
        "all other streets, rest of the roads, back lane, neighborhood street, "
        "all the other streets, all other roads",
        "ring_road": "ring road, ring, beltway, orbital road, ring street, circular road, "
        "orbital, ring boulevard, ringroad, circular street, bypass ring, beltroad, "
        "orbital motorway, peripheral road, concentric road, concentric street, "
        "concentric ring, concentric ring road, circular avenue, orbital ring",
        "sidewalk": "sidewalk, pavement, footpath, walkway, footway, foot path, foot way",
        "path": "path, trail, track, running track, footpath through the park, gravel path, loop",
        "carriageway": "driving surface, roadbed",
        "crossing": "junction, intersection, crossroad, crossing",
    },
    "place": {
        "city": "city, town, urban area, urban landscape, cityscape, townscape, place, area, "
        "scene, environment, settlement, metropolis, market town, square city, square town, "
        "square plot, square site, square area, square block, square district, capital, "
        "capital city, city quarter, site, district, quarter, conurbation, urban scene, "
        "plot, terrain size, neighbourhood block, map area, block, city block, urban block, "
        "urban district, part of town, layout size, model, world, street scene, municipality, "
        "extent, total area, whole city, entire city, whole town, entire town, "
        "whole scene, entire scene, city model, territory, urban quarter, "
        "urban environment, zone, locality, square plot",
        "everything": "everything, anything, "
        "all of it, everything else, the whole thing, all objects, everything there",
        "roof": "roof, rooftop, roofing",
        "window": "window",
        "facade": "facade, front, house front, wall, exterior, cladding",
        "sky": "sky, air, atmosphere",
        "light": "light",
        "flying": "flying, flying car, flying vehicle, drone, aircraft, airship, helicopter, "
        "plane, aeroplane, airplane",
        "crane": "crane, construction site, scaffolding",
        "landscape": "landscape, ground, land, soil",
        "center": "center, middle, heart, midpoint, core",
    },
}

MATERIALS: Mapping[str, str] = {
    "brick": "brick, red brick, clinker, brickwork, bricks, brick built, brick clad, bricked",
    "glass": "glass, glazed, all glass, curtain wall, glass clad, mirrored glass, glassy, "
    "glass fronted, glass facade, mirror glass, fully glazed, glass and steel, steel and glass, "
    "glass walled",
    "concrete": "concrete, cement, exposed concrete, raw concrete, reinforced concrete, precast",
    "stone": "stone, sandstone, limestone, granite, marble, natural stone, ashlar, stone built, "
    "stone clad, masonry, cut stone",
    "plaster": "plaster, stucco, stuccoed, plastered, rendered walls, whitewashed, whitewash, "
    "adobe, rendered",
    "timber": "timber, wood, wooden, log, weatherboard, timber clad, wood clad, boarded, timbered",
    "metal": "metal, steel, corrugated iron, aluminium, metal clad, corrugated steel, copper, "
    "corrugated metal, iron, sheet metal, metallic, zinc, chrome",
}

COLOURS: Mapping[str, str] = {
    "red": "red, crimson, scarlet, brick red, dark red, bright red, ruby, vermilion",
    "blue": "blue, navy, azure, navy blue, dark blue, sky blue, cobalt, ultramarine",
    "light_blue": "light blue, pale blue, baby blue",
    "green": "green, olive, emerald, dark green, mint, lime green, light green, olive green, sage",
    "yellow": "yellow, lemon, mustard, ochre, bright yellow, canary yellow, ocher",
    "orange": "orange, apricot, tangerine",
    "white": "white, snow white, off white, ivory, bright white, pure white, chalk white",
    "black": "black, jet black, pitch black paint, ebony",
    "grey": "gray, silver, silvery, slate gray, ash gray, charcoal, anthracite, "
    "light gray, dark gray",
    "brown": "brown, chocolate, tan, umber, chestnut brown, dark brown, bronze",
    "beige": "beige, sand colored, cream, sandy, cream colored, buff, sand, ecru",
    "pink": "pink, rose, salmon, magenta, fuchsia, salmon pink",
    "purple": "purple, violet, lilac, lavender, mauve",
    "turquoise": "turquoise, teal, cyan, aquamarine",
    "gold": "gold, golden",
    "terracotta": "terracotta, rust, rusty, rust red, brick colored, ocher red",
    "pastel": "pastel, pastel colored, pastel colors",
    "colourful": "colorful, multicolored, brightly colored, many colored, brightly painted, "
    "vibrantly colored",
}


@remembered
def outside_types() -> Mapping[str, tuple[str, ...]]:
    """Return the types of building that installed packages add, with the words for them.

    A word for a type of CityX goes to a package that brings just that ("silo" says a barn until
    there is one), but the types' own names do not, nor words that mean anything else.
    """
    own = {noun.replace("_", " ") for noun in NOUNS["type"]}
    held = own | {
        trigger for group, names in NOUNS.items() if group != "type"
        for triggers in names.values() for trigger in triggers.split(", ")
    }  # fmt: skip
    found = {
        name: tuple(word for word in made.words if word not in held)
        for name, made in mesh_actions().items()
        if name not in NOUNS["type"]
    }
    return MappingProxyType({name: words for name, words in found.items() if words})
