"""What materials and kinds of things mean to a physics engine: weights, friction, what moves.

Densities and friction are those of handbooks, rounded: dry surfaces against concrete or asphalt.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import inf
from types import MappingProxyType

from cityx.assets.styles.surface_states import material_named


@dataclass(frozen=True)
class Substance:
    """A material by weight and touch.

    Attributes
    ----------
    density
        Kilograms per cubic metre.
    wall
        Metres: how thick what is made of it is at most. Posts, bins and bodies of cars are hollow.
    friction
        Coefficient of Coulomb.
    restitution
        Share of the speed that is left after a bounce.
    """

    density: float
    wall: float
    friction: float
    restitution: float


_CONCRETE = Substance(2400.0, inf, 0.65, 0.1)
_RENDER = Substance(1800.0, 0.15, 0.65, 0.1)
_STONE = Substance(2600.0, inf, 0.6, 0.1)
_BRICK = Substance(1800.0, inf, 0.65, 0.1)
_WOOD = Substance(650.0, inf, 0.45, 0.2)
_STEEL = Substance(7850.0, 0.003, 0.4, 0.2)
_GLASS = Substance(2500.0, 0.008, 0.4, 0.1)
_PLASTIC = Substance(950.0, 0.004, 0.4, 0.3)
_RUBBER = Substance(1150.0, 0.02, 0.8, 0.3)
_PAINTED = Substance(7850.0, 0.001, 0.4, 0.2)
_CLOTH = Substance(300.0, 0.002, 0.5, 0.05)
_LEAF = Substance(700.0, 0.0003, 0.5, 0.0)
_SOIL = Substance(1600.0, inf, 0.6, 0.0)
_GRASS = Substance(1400.0, inf, 0.45, 0.05)
_ASPHALT = Substance(2300.0, inf, 0.8, 0.1)
_ROOFING = Substance(1900.0, 0.02, 0.6, 0.1)
_WATER = Substance(1000.0, inf, 0.05, 0.0)
_BODY = Substance(1000.0, inf, 0.5, 0.05)
SUBSTANCES: Mapping[str, Substance] = MappingProxyType(
    {
        name: substance
        for substance, names in (
            (_CONCRETE, "concrete road_concrete kerb_stone step_stone pavers paving yard "
             "walk_blocks guided_blocks tactile_yellow tactile_pale tactile_buff tactile_red "
             "gutter_slabs"),
            (_RENDER, "plaster trim room_wall"),
            (_STONE, "stone setts pale_setts small_setts gutter_stones cobbles slate flagstones "
             "mosaic plaza_slabs slab_walk"),
            (_BRICK, "brick clinker"),
            (_WOOD, "wood bench_wood bark bark_smooth bark_flaking thatch"),
            (_STEEL, "metal_dark metal_grey metal_panel roof_metal copper rail_steel"),
            (_GLASS, "glass pane car_glass car_pane window_lit glass_wall lamp_glow signal_red "
             "signal_stop signal_amber signal_green walk_red walk_green neon_red neon_amber "
             "neon_green neon_cyan neon_blue neon_violet neon_pink"),
            (_PLASTIC, "plastic sign ware_cream ware_red ware_ochre ware_blue ware_green "
             "lens_white lens_red lens_amber plate_white plate_yellow plate_blue plate_green"),
            (_RUBBER, "rubber"),
            (_PAINTED, "car_paint door_paint frame_paint"),
            (_CLOTH, "cloth leather curtain hair car_trim"),
            (_LEAF, "leaf foliage hedge"),
            (_SOIL, "soil sand gravel roof_gravel rail_ballast farmland forest_floor"),
            (_GRASS, "grass meadow pitch"),
            (_ASPHALT, "asphalt asphalt_light asphalt_red asphalt_brown marking_white "
             "marking_yellow marking_blue"),
            (_ROOFING, "roof_tiles bitumen"),
            (_WATER, "water"),
            (_BODY, "skin"),
        )
        for name in names.split()
    }
)  # fmt: skip


def substance(material: str) -> Substance:
    """Return the substance of a material, or of the one it is a state of; concrete if unknown."""
    return SUBSTANCES.get(material_named(material).root, _CONCRETE)


# Kerb weights, kilograms, of what holds more than its skin shows.
WEIGHTS: Mapping[str, float] = MappingProxyType(
    {
        "car_hatchback": 1150.0, "car_sedan": 1450.0, "car_suv": 1700.0, "car_van": 1950.0,
        "car_estate": 1550.0, "car_city_car": 1000.0, "car_mpv": 1500.0, "car_black_cab": 2150.0,
        "car_tall_taxi": 1400.0, "car_kei_car": 900.0, "car_kei_van": 950.0,
        "car_small_van": 1450.0, "car_delivery_van": 2150.0,
        "bus": 12_000.0, "recycling": 350.0, "vending_machine": 300.0, "advertising_column": 900.0,
        "fire_hydrant": 90.0, "post_box": 80.0, "bicycle": 15.0, "traffic_cone": 3.0,
        "motor_scooter": 110.0, "motor_scooter_red": 110.0, "motor_scooter_dark": 110.0,
        "street_cabinet": 180.0, "kiosk": 1200.0, "barge": 40_000.0, "motor_boat": 900.0,
        "rowing_boat": 90.0,
    }
)  # fmt: skip
VEHICLE_DENSITY = 180.0  # kilograms per cubic metre of collider, of vehicles that are not named
BUILDING_DENSITY = 350.0  # kilograms per cubic metre of a building, storeys and all
# Kilograms of what moves by itself, with who rides it.
MOVER_WEIGHTS: Mapping[str, float] = MappingProxyType(
    {
        "car": 1400.0, "van": 2000.0, "truck": 12_000.0, "bus": 12_000.0, "motorcycle": 270.0,
        "bicycle": 90.0, "tram": 40_000.0, "pedestrian": 75.0, "animal": 30.0,
    }
)  # fmt: skip

# Semantic class of pieces by how their names begin; others are a class of their own name.
CLASSES: Mapping[str, str] = MappingProxyType(
    {
        "street_lamp": "street_lamp", "sign_": "sign", "traffic_signal": "traffic_signal",
        "waste_basket": "litter_bin", "wheelie_bins": "bin", "recycling": "bin",
        "stone_bench": "bench", "planter": "planter",
        "pot_row": "planter", "car_": "car", "shrub": "shrub",
        "motor_scooter": "motorcycle", "banner_": "sign", "fire_hydrant": "fire_hydrant",
        "post_box": "post_box", "bollard": "bollard", "telephone": "telephone",
        "parking_board": "sign", "wheel_stop": "kerb", "wall_trough": "planter",
        "wall_pots": "planter", "furled_banner": "sign",
    }
)  # fmt: skip
# Pieces that stand by their weight alone. Bicycles are locked, boats moored, posts set in concrete.
LOOSE = frozenset(
    {"bench", "bin", "litter_bin", "planter", "cafe_set", "shop_board", "picnic_table", "boulder",
     "traffic_cone", "vending_machine", "fruit_stand", "flower_stand", "clothes_rail", "cartons"}
)  # fmt: skip
# A box each: what hangs on a post in the ground would fall over without it.
UPRIGHT = frozenset({"litter_bin"})
