"""Tables of `cityx.assets.styles.palettes`: which buildings look how, in which colours.

Colours are sRGB as seen in daylight: muted, since real walls are; weights are relative.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import MappingProxyType

GROUPS = ("house", "flats", "office", "retail", "industry", "worship", "civic", "shed")
GROUP_WORDS: Mapping[str, str] = MappingProxyType(
    {
        "house": "house detached semidetached_house semi terrace bungalow cabin farm villa "
        "static_caravan houseboat tree_house allotment_house cottage",
        "flats": "apartments residential dormitory hotel hostel tower",
        "office": "office government skyscraper bank",
        "retail": "retail supermarket commercial mall shop kiosk restaurant pub",
        "industry": "industrial warehouse hangar factory manufacture storage_tank depot "
        "transportation power works sports_hall sports_centre riding_hall grandstand stadium "
        "data_center",
        "worship": "church cathedral chapel basilica mosque temple synagogue shrine religious "
        "monastery presbytery",
        "civic": "school university college hospital public civic townhall museum kindergarten "
        "train_station library theatre clinic fire_station castle palace courthouse prison embassy "
        "observatory",
        "shed": "garage garages shed carport roof hut greenhouse outbuilding service stable barn "
        "parking farm_auxiliary sty cowshed container toilets bunker boathouse ruins storage tent",
    }
)
GROUP_OF = {word: GROUPS.index(name) for name, text in GROUP_WORDS.items() for word in text.split()}
SHED_AREA = 32.0  # square metres; a smaller untyped building of one storey is no dwelling
HOUSE_AREA = 420.0  # square metres; a larger untyped building is no single house
HALL_AREA = 1800.0  # square metres; a larger untyped low building is a hall

# Style families: what a brief or a region can ask of a whole town.
STYLES = (
    "european", "brick", "mediterranean", "american", "asian", "modern", "industrial", "house",
)  # fmt: skip
SYNONYMS = {
    "classical": "european", "classic": "european", "georgian": "brick", "british": "brick",
    "london": "brick", "contemporary": "modern", "glass": "modern", "futuristic": "modern",
    "american": "american", "suburban": "house", "rural": "house", "japanese": "asian",
    "chinese": "asian", "southern": "mediterranean", "italian": "mediterranean",
    "haussmann": "european", "victorian": "brick", "medieval": "european", "gothic": "european",
    "baroque": "european", "art_nouveau": "european", "scandinavian": "european", "dutch": "brick",
    "arabic": "mediterranean", "latin_american": "mediterranean", "indian": "asian",
    "rustic": "house",
}  # fmt: skip
# Styles that shift the choice of buildings within the family of the region.
REGIONAL = ("brutalist", "soviet", "art_deco", "postmodern")

# Weight, material, and colours (sRGB, as seen).
Surfaces = Sequence[tuple[float, str, tuple[int, ...]]]
# Lime and mineral paints: creams, ochres, greys and a few greens and reds, none of them loud.
PLASTERS = (
    0xDDD2BA, 0xD2BF98, 0xC8BBA3, 0xC9B08A, 0xBBA28C, 0xDAD3C8, 0xABA69C, 0xC2A593, 0xB2B8A6,
    0xD5C8AA, 0xBFAC80, 0xDEDAD0, 0xA8997F, 0xAA8577, 0xA4ABAD, 0xD2BEAA, 0xDACBA4, 0x9D9D92,
    0xC6AFA6, 0x918A7E, 0xCDC5B4, 0xB9B5AC, 0xE0D9C8, 0xBDB09C,
)  # fmt: skip
# Of the decades after the war: sprayed and scraped renders, bleached.
PALE_PLASTERS = (
    0xC6C1B2, 0xBBB4A4, 0xC9BD9F, 0xB2AC9D, 0xABA9A1, 0xCCC5B2, 0xBDAF92, 0xA19E94, 0xB1B6A8,
    0xBBAD9B, 0xC8C5BC, 0xAFA48C,
)  # fmt: skip
WARM = (
    0xE4DCCB, 0xD8C39E, 0xD0B08C, 0xDFCFAF, 0xC39C82, 0xE8E3D8, 0xD3BCA6, 0xC09B7C, 0xDBC8B8,
    0xD6CDBB, 0xC2A88A, 0xE4D6B8,
)  # fmt: skip
STOCK = (0xA68A66, 0x9C7F5E, 0x8E6A50, 0x8A5543, 0x96594A, 0xA06A52, 0xB1976F, 0x7D5A48, 0x915F4B)
REDS = (0x8C4A3A, 0x96543F, 0x7C4234, 0xA25F48, 0x86503E, 0x6F4337, 0x9B6A54, 0xA98A70)
STONES = (0xC4B79C, 0xB8AC97, 0xCCC2AE, 0xA89F8F, 0xD2C8B2)
TILES = (
    0xD9D6CE, 0xC9C5BB, 0xB9B2A5, 0xCFC6B4, 0xA69C8E, 0xDFDDD8, 0xBBA994, 0x9DA3A6, 0xC8BBA8,
    0x8F8378, 0xE4E2DC, 0xB09A86,
)  # fmt: skip
GREYS = (0xB4B3AF, 0xA3A29E, 0xC2C0BA, 0x93928F, 0xCBC8C0)
LIGHTS = (0xE2E0DB, 0xD3CFC7, 0xC4C1BB, 0xB4AFA6, 0xDAD2C4, 0x9C9A97, 0x85827E)
BOARDS = (0xD9D5CA, 0xB8BDB8, 0xC9BFA5, 0x9FAAB0, 0xA6A58F, 0xDCD8D2, 0x8E9A92, 0xB59A7C, 0xCDC8B4)
RED_TILES = (0x8E4B36, 0x9A5740, 0x7B4434, 0x86523F, 0xA26248, 0x6C4236, 0x74503F, 0x5E4038)
SLATES = (0x50545A, 0x5C6064, 0x474A50, 0x66676A, 0x55504F)
CLAY = (0xB47A55, 0xA96C4B, 0xC08B66, 0x9C6346, 0xB5835F)
SHINGLES = (0x5D5A56, 0x6D655D, 0x4E4B4A, 0x75695C, 0x7B7873)
FELT = (0x5E5E5D, 0x6D6B68, 0x4C4C4D, 0x7B7872, 0x5A5F5C)
MEMBRANE = (0xA2A19C, 0x8F8E8A, 0xB0AEA6)
Roofs = Mapping[str, Surfaces]
PITCHED: Roofs = MappingProxyType(
    {
        "european": ((8, "roof_tiles", RED_TILES), (3, "slate", SLATES),
                     (1, "roof_metal", (0x7E8486,))),
        "brick": ((8, "slate", SLATES), (3, "roof_tiles", (0x6F4A3C, 0x7C5242, 0x5C4640))),
        "mediterranean": ((9, "roof_tiles", CLAY + RED_TILES[:2]), (1, "slate", SLATES)),
        "american": ((8, "bitumen", SHINGLES), (2, "slate", SLATES),
                     (1, "roof_metal", (0x84888A,))),
        "asian": ((6, "slate", (0x4A4E55, 0x5A5E66, 0x3F4349)),
                  (3, "roof_tiles", (0x55504E, 0x6E4A3F)), (2, "roof_metal", (0x6E7A78, 0x7A6A60))),
        "modern": ((4, "roof_metal", (0x75797C, 0x5D6164)), (3, "slate", SLATES)),
        "industrial": ((4, "roof_metal", (0x85898B, 0x6E7274)), (3, "bitumen", SHINGLES)),
        "house": ((8, "roof_tiles", RED_TILES), (3, "slate", SLATES)),
    }
)  # fmt: skip
FLAT: Surfaces = (
    (7, "bitumen", FELT),
    (4, "roof_gravel", (0x7E7B75, 0x8B8780, 0x6F6C67, 0x857C6E)),
    (2, "bitumen", MEMBRANE),
    (1, "concrete", GREYS),
)
HALL_ROOF: Surfaces = ((5, "roof_metal", (0x9A9D9E, 0x85898B, 0xAEB0AF)), (3, "bitumen", MEMBRANE))

TRIMS = (0xE4DFD3, 0xD6CFC0, 0xC9BFAC, 0xEAE8E2, 0xBDB3A2)
PLAIN_FRAMES = (0xEFEDE8, 0xF2F1EE, 0xE6E2D8, 0x6B4F3A, 0xD9D6CE)
ACCENTS = (
    0x6B2A22, 0x22402F, 0x1F2E48, 0x2B2B2C, 0x5B4630, 0x7A6A3A, 0x8A2E2A, 0x2F5560, 0x44533A,
    0x6E5A72, 0x9C7A3C, 0x34302C,
)  # fmt: skip

WALL_WORDS: Mapping[str, str] = MappingProxyType(
    {
        "brick": "brick bricks brickwork red_brick clinker",
        "plaster": "plaster stucco render rendered plastered cement clay adobe loam mud pebbledash "
        "tile tiles ceramic vinyl plastic painted rammed_earth cob fibre_cement fiber_cement "
        "eternit fabric tent polystyrene",
        "stone": "stone sandstone limestone granite marble masonry rock slate bluestone travertine "
        "cobblestone flint basalt tuff",
        "concrete": "concrete cement_block concrete_block reinforced_concrete block panel beton "
        "cement_blocks concrete_blocks prefab prefabricated",
        "wood": "wood timber timber_framing timber-framing bamboo log weatherboard "
        "logs timber_frame half-timbered plywood siding wood_siding reed straw palm_leaves",
        "metal_panel": "metal steel aluminium aluminum tin corrugated_metal corrugated_iron iron "
        "zinc copper sheet_metal metal_panel "
        "metal_plates metal_sheet stainless_steel lead titanium bronze",
        "glass_wall": "glass mirror glass_wall solar_panels glass_block polycarbonate plexiglass",
    }
)
ROOF_WORDS: Mapping[str, str] = MappingProxyType(
    {
        "roof_tiles": "roof_tiles tiles tile clay ceramic brick shingle shingles "
        "interlocking_tiles concrete_tiles cement_tiles clay_tiles terracotta",
        "slate": "slate stone asbestos eternit fibre_cement solar_panels solar_panel "
        "fiber_cement slates",
        "roof_metal": "metal steel zinc tin aluminium aluminum lead metal_sheet sheet_metal "
        "corrugated_metal iron stainless_steel metal_shingle corrugated_iron titanium_zinc "
        "titanium composite",
        "copper": "copper",
        "bitumen": "tar_paper bitumen asphalt asphalt_shingle felt tar rubber membrane plastic "
        "acrylic_glass roofing_felt fabric tent membranes pvc epdm",
        "roof_gravel": "gravel pebbles",
        "concrete": "concrete cement sandstone paving",
        "thatch": "thatch reed palm_leaves straw thatched",
        "glass_wall": "glass polycarbonate",
        "grass": "grass green plants sedum soil sod turf",
        "wood": "wood timber wood_shingles wooden_shingles shakes bamboo",
    }
)


# Colour of a material when the input names the material alone.
OWN_COLORS: Mapping[str, tuple[int, ...]] = MappingProxyType(
    {
        "brick": REDS + STOCK, "plaster": PLASTERS, "stone": STONES, "concrete": GREYS,
        "wood": (0x8A7256, 0x9A7B58, 0x7A644C), "metal_panel": (0x9DA1A3, 0x84888A, 0xB1B2AE),
        "glass_wall": (0xFFFFFF, 0xE6F2FF, 0xE8FFF4), "roof_tiles": RED_TILES, "slate": SLATES,
        "roof_metal": (0x85898B, 0x9A9D9E, 0x6E7274), "copper": (0xFFFFFF,), "bitumen": FELT,
        "roof_gravel": (0x8E8B84, 0x9B978F), "thatch": (0xFFFFFF,), "grass": (0xFFFFFF,),
    }
)  # fmt: skip
# Materials whose own base colour is the point; colours only shade them.
SELF_COLORED = frozenset({"glass_wall", "copper", "thatch", "grass"})
# Those that a stated colour may lie beyond, and the form of them that takes it.
PAINTED: Mapping[str, str] = MappingProxyType(
    {
        "glass_wall": "glass_tinted", "concrete": "concrete_painted", "copper": "copper_painted",
        "roof_gravel": "gravel_painted", "thatch": "thatch_painted", "grass": "grass_painted",
    }
)  # fmt: skip
