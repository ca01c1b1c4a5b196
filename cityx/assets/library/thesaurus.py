"""A small thesaurus of city words: words of one line mean nearly the same."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

# Concept -> words. A word may stand in several lines. Stems are looked up too, so plurals need no
# word of their own.
CONCEPTS: Mapping[str, str] = MappingProxyType(
    {
        # what it is
        "building": "building block structure edifice",
        "house": "house home villa cottage bungalow dwelling detached semidetached farmhouse cabin "
        "townhouse",
        "flats": "flats flat apartment apartments residential tenement condominium condo housing "
        "dwelling mietshaus",
        "office": "office offices bank headquarters commercial corporate business workplace "
        "government",
        "retail": "retail shop shops store supermarket mall boutique market storefront kiosk "
        "commercial",
        "industry": "industry industrial warehouse factory hall depot workshop plant works hangar "
        "storage logistics",
        "worship": "worship church chapel cathedral mosque temple synagogue religious shrine "
        "basilica",
        "civic": "civic school hospital library university museum townhall public institution "
        "kindergarten college",
        "shed": "shed garage hut outbuilding carport garages lockup",
        "tower": "tower skyscraper highrise tall lofty high",
        "low": "low lowrise small single-storey onestorey squat",
        "large": "large big huge wide vast long",
        "little": "small little tiny compact narrow",
        # plants
        "plant": "plant vegetation greenery tree trees",
        "tree": "tree trees trunk crown leafy broadleaf deciduous",
        "conifer": "conifer evergreen needle needles fir spruce pine coniferous",
        "shrub": "shrub bush hedge",
        "palm": "palm tropical frond",
        "wood": "grove copse wood woodland forest thicket",
        # vehicles
        "vehicle": "vehicle car automobile auto motorcar",
        "hatchback": "hatchback compact supermini",
        "sedan": "sedan saloon limousine",
        "suv": "suv crossover offroader jeep",
        "van": "van minivan transporter delivery",
        "bus": "bus coach omnibus transit",
        # furniture
        "furniture": "furniture street amenity object fixture",
        "lamp": "lamp light lantern streetlight lamppost luminaire mast",
        "seat": "bench seat",
        "bin": "basket bin waste trash rubbish litter garbage recycling",
        "bollard": "bollard post",
        "stop": "stop shelter busstop",
        "signal": "signal traffic stoplight semaphore",
        "sign": "sign plate board signpost",
        "hydrant": "hydrant fire",
        "letterbox": "postbox mailbox letterbox pillarbox",
        "telephone": "telephone phone booth callbox",
        "bicycle": "bicycle bike cycle rack stand parking",
        "fountain": "fountain water basin",
        "column": "column advertising morris litfass pillar",
        "statue": "statue monument sculpture memorial",
        "vending": "vending machine automat",
        "flag": "flag flagpole banner",
        "fence": "fence railing barrier palings",
        # people
        "person": "person people pedestrian human man woman walker",
        # style
        "european": "european eu continental old historic classical traditional haussmann paris "
        "wilhelminian",
        "british": "british english georgian victorian london terrace",
        "mediterranean": "mediterranean southern italian spanish greek shuttered",
        "american": "american suburban us walkup brownstone midwestern",
        "asian": "asian japanese chinese korean tokyo eastern",
        "modern": "modern contemporary new minimalist modernist sleek futuristic current",
        "classic": "classic classical ornate ornamental decorated stately historic traditional",
        "plain": "plain simple unadorned modest austere sober",
        "slab": "slab panel prefabricated plattenbau estate",
        "curtain": "curtain glazed glassy transparent glass fullyglazed",
        # surfaces
        "brick": "brick bricks clinker masonry brickwork",
        "stone": "stone sandstone limestone ashlar granite masonry",
        "plaster": "plaster stucco render rendered plastered painted stuccoed",
        "concrete": "concrete cement exposed",
        "glass": "glass glazed glazing window windows",
        "metal": "metal steel aluminium tin sheet corrugated clad cladding",
        "timber": "timber wood wooden boards boarded log weatherboard",
        # roofs
        "roof": "roof roofed top roofline",
        "flat roof": "flat level parapet terrace",
        "pitched": "pitched sloping steep gabled gable saddle",
        "hipped": "hipped hip",
        "mansard": "mansard gambrel attic",
        "skillion": "skillion lean monopitch shed",
        "pyramidal": "pyramidal pyramid pointed spire",
        "round": "round rounded dome domed barrel curved vaulted",
        "tiles": "tiles tile tiled clay terracotta",
        "slate": "slate shingle shingles",
        # parts
        "storey": "storey storeys story stories floor floors level levels",
        "balcony": "balcony balconies loggia",
        "terraced": "terraced row attached adjoining rowhouse infill party",
        "freestanding": "detached freestanding standalone alone",
        # colours
        "white": "white cream ivory offwhite chalk pale",
        "grey": "grey gray silver ash light-grey stone-grey",
        "black": "black dark anthracite charcoal",
        "red": "red crimson rusty terracotta brickred scarlet",
        "brown": "brown tan umber chocolate bronze",
        "yellow": "yellow ochre mustard sand sandy golden cream",
        "orange": "orange apricot peach",
        "beige": "beige sand sandy buff cream",
        "green": "green olive sage leafy",
        "blue": "blue navy azure teal",
        "pink": "pink rose salmon",
    }
)


def _by_word(table: Mapping[str, str]) -> dict[str, tuple[str, ...]]:
    found: dict[str, list[str]] = {}
    for concept, words in table.items():
        for word in dict.fromkeys([*concept.split(), *words.split()]):
            if " " not in concept or word in words.split():
                found.setdefault(word, []).append(concept)
    return {word: tuple(concepts) for word, concepts in found.items()}


CONCEPTS_OF: Mapping[str, tuple[str, ...]] = MappingProxyType(_by_word(CONCEPTS))

_PLAIN = (
    "a an the of and or with in on at by to for from its it is are was were be this that which "
    "has have having very some any each as into about over under m metre metres meter meters"
)
STOP_WORDS = frozenset(_PLAIN.split())

NUMBER_WORDS: Mapping[str, str] = MappingProxyType(
    {
        "one": "1", "two": "2", "three": "3", "four": "4", "five": "5", "six": "6", "seven": "7",
        "eight": "8", "nine": "9", "ten": "10", "eleven": "11", "twelve": "12", "fifteen": "15",
        "twenty": "20", "thirty": "30", "forty": "40", "fifty": "50",
    }
)  # fmt: skip
