"""Semantic classes: what datasets call the things of a city.

Every object has one class, the same in all channels, boxes, sweeps and files. The table is fixed:
numbers mean the same in every city and are only ever added to. Pieces of a whole (windows, trims,
wheels, riders) are of the class of the whole; their own class is kept beside it (`Stage.piece`).

References
----------
M. Cordts et al., "The Cityscapes dataset for semantic urban scene understanding", CVPR 2016.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from cityx.assets.colliders import class_of, kind_of
from cityx.assets.styles.surface_states import material_named
from cityx.city.ground import SURFACES
from cityx.city.mesh import MeshBatch
from cityx.city.scene import Prototype
from cityx.city.tracks import MOVER_KINDS
from cityx.geometry.solids import area_vectors
from cityx.ids import stable_id

IGNORED = 255  # train id of what Cityscapes does not rate
SKY = 0


@dataclass(frozen=True)
class Class:
    """One class.

    Attributes
    ----------
    number
        In the semantic channel.
    name
        Its word.
    color
        sRGB, 0 to 255, for people to look at.
    thing
        Whether its objects are counted one by one; stuff is one segment per picture.
    train_id
        Number in Cityscapes' evaluation, 255 where it rates none.
    """

    number: int
    name: str
    color: tuple[int, int, int]
    thing: bool
    train_id: int


# Name, colour, T for things or S for stuff, train id. New rows go to the end of the table.
_ROWS = (
    ("sky", 0x4682B4, "S", 10),
    ("other", 0x6E6E78, "T", IGNORED),
    # ground
    ("road", 0x804080, "S", 0),
    ("road_marking", 0xE6E6FA, "S", 0),
    ("cycle_lane", 0x9C4A6E, "S", 0),
    ("parking", 0xFAAAA0, "S", IGNORED),
    ("sidewalk", 0xF423E8, "S", 1),
    ("kerb", 0xC4B4C8, "S", 1),
    ("tactile_paving", 0xF0C850, "S", 1),
    ("path", 0xD28CD2, "S", 1),
    ("plaza", 0xE070C8, "S", 1),
    ("stairs", 0xB45ABE, "S", 1),
    ("yard", 0xB4A08C, "S", IGNORED),
    ("terrain", 0x98FB98, "S", 9),
    ("grass", 0x78D250, "S", 9),
    ("farmland", 0xC8B450, "S", 9),
    ("forest_floor", 0x6E8C46, "S", 9),
    ("soil", 0xA0784B, "S", 9),
    ("sand", 0xE1CD96, "S", 9),
    ("pitch", 0x50BE82, "S", 9),
    ("water", 0x3C6EC8, "S", IGNORED),
    ("rail_track", 0xE6968C, "S", IGNORED),
    ("flower_bed", 0xBE5078, "S", 8),
    # built
    ("building", 0x464646, "T", 2),
    ("window", 0x5A78A0, "T", 2),
    ("door", 0x82503C, "T", 2),
    ("shopfront", 0xA05A8C, "T", 2),
    ("trim", 0x8C8C82, "T", 2),
    ("roof_furniture", 0x5F5F73, "T", 2),
    ("neon", 0xFF50B4, "T", 2),
    ("bridge", 0x966464, "S", IGNORED),
    ("wall", 0x66669C, "S", 3),
    ("fence", 0xBE9999, "S", 4),
    ("hedge", 0x508C3C, "S", 8),
    ("guard_rail", 0xB4A5B4, "S", IGNORED),
    ("wire", 0x1E1E28, "S", IGNORED),
    # nature
    ("tree", 0x6B8E23, "T", 8),
    ("shrub", 0x8CAA3C, "T", 8),
    ("reeds", 0xA0B464, "T", 8),
    ("boulder", 0x8C826E, "T", IGNORED),
    # furniture
    ("street_lamp", 0x999999, "T", 5),
    ("pole", 0x828282, "T", 5),
    ("traffic_signal", 0xFAAA1E, "T", 6),
    ("sign", 0xDCDC00, "T", 7),
    ("bench", 0xA07850, "T", IGNORED),
    ("bin", 0x788C64, "T", IGNORED),
    ("litter_bin", 0x5A7850, "T", IGNORED),
    ("bollard", 0xB4B48C, "T", IGNORED),
    ("planter", 0xB4643C, "T", IGNORED),
    ("hydrant", 0xD23C28, "T", IGNORED),
    ("post_box", 0xC81E1E, "T", IGNORED),
    ("telephone", 0x3C96AA, "T", IGNORED),
    ("bus_stop", 0x2878B4, "T", IGNORED),
    ("vending_machine", 0x3CB4C8, "T", IGNORED),
    ("kiosk", 0xAA7882, "T", IGNORED),
    ("fountain", 0x78B4D2, "T", IGNORED),
    ("statue", 0xA0AAA0, "T", IGNORED),
    ("advertising_column", 0xC88C3C, "T", IGNORED),
    ("cafe_set", 0xD2A078, "T", IGNORED),
    ("parasol", 0xE68C5A, "T", IGNORED),
    ("bicycle_parking", 0x96AAB4, "T", IGNORED),
    ("playground", 0xFF9628, "T", IGNORED),
    ("sports_equipment", 0xE6E6DC, "T", IGNORED),
    ("traffic_cone", 0xFF6400, "T", IGNORED),
    ("street_cover", 0x5A5064, "S", 0),
    ("street_furniture", 0x96A0AA, "T", IGNORED),
    # vehicles and the living
    ("car", 0x00008E, "T", 13),
    ("truck", 0x000046, "T", 14),
    ("bus", 0x003C64, "T", 15),
    ("tram", 0x005064, "T", 16),
    ("motorcycle", 0x0000E6, "T", 17),
    ("bicycle", 0x770B20, "T", 18),
    ("boat", 0x285AA0, "T", IGNORED),
    ("vehicle", 0x1E1E6E, "T", IGNORED),
    ("pedestrian", 0xDC143C, "T", 11),
    ("rider", 0xFF0000, "T", 12),
    ("animal", 0xB43CB4, "T", IGNORED),
)  # fmt: skip
CLASSES: tuple[Class, ...] = tuple(
    Class(number, name, (c >> 16, c >> 8 & 255, c & 255), kind == "T", train)
    for number, (name, c, kind, train) in enumerate(_ROWS)
)
CLASS: Mapping[str, int] = MappingProxyType({held.name: held.number for held in CLASSES})
THING: NDArray[np.bool_] = np.array([held.thing for held in CLASSES])

_SURFACE = {
    "block": "terrain", "courtyard": "yard", "farmland": "farmland", "grass": "grass",
    "meadow": "grass", "wood": "forest_floor", "park": "grass", "sand": "sand", "bare": "soil",
    "pitch": "pitch", "playground": "sand", "plaza": "plaza", "parking": "parking",
    "water": "water", "railway": "rail_track", "path": "path", "sidewalk": "sidewalk",
    "kerb": "kerb", "carriageway": "road", "setts": "road", "gravel_road": "road",
    "junction": "road", "marking": "road_marking", "tramway": "rail_track",
    "marking_yellow": "road_marking", "crossing_row": "road_marking", "apron": "road",
    "kerb_dropped": "kerb",
    "tactile": "tactile_paving", "tactile_pale": "tactile_paving",
    "tactile_buff": "tactile_paving", "tactile_red": "tactile_paving",
    "ramp": "sidewalk", "landing": "sidewalk", "guide_strip": "tactile_paving",
    "cycle_lane": "cycle_lane", "rail": "rail_track", "trail": "path", "furnishing": "sidewalk",
    "gravel": "yard", "building": "terrain", "void": "other",
    "bed": "soil", "threshold": "road", "gutter": "road", "parking_lane": "road",
    "mouth_setts": "road", "coat": "road", "feather": "road_marking",
    "edging": "sidewalk", "frontage": "sidewalk",
}  # fmt: skip
# Layers of meshes whose objects are all of one class.
_LAYER = {
    "buildings": "building", "building_assets": "building", "decks": "bridge",
    "structures": "bridge", "surroundings": "terrain", "guard_rails": "guard_rail",
    "garden_paths": "path", "lawn_edging": "sidewalk", "shores": "stairs", "stairs": "stairs",
    "courts": "pitch", "bay_lines": "road_marking",
    "wires": "wire",
}  # fmt: skip
# By the material that most of an object is made of: ground beyond the labels, barriers.
_MATERIAL = {
    "asphalt": "road", "asphalt_light": "path", "asphalt_red": "cycle_lane", "setts": "road",
    "asphalt_brown": "road", "pale_setts": "road",
    "small_setts": "road", "gutter_stones": "road", "gutter_slabs": "road",
    "cobbles": "road", "clinker": "road", "pavers": "sidewalk", "road_concrete": "road",
    "paving": "sidewalk", "flagstones": "sidewalk", "mosaic": "sidewalk",
    "plaza_slabs": "sidewalk", "slab_walk": "sidewalk",
    "walk_blocks": "sidewalk", "guided_blocks": "sidewalk", "yard": "yard", "kerb_stone": "kerb",
    "marking_white": "road_marking", "marking_blue": "road_marking",
    "marking_yellow": "road_marking", "grass": "grass", "meadow": "grass", "pitch": "pitch",
    "forest_floor": "forest_floor", "farmland": "farmland", "soil": "soil", "sand": "sand",
    "gravel": "path", "rail_ballast": "rail_track", "rail_steel": "rail_track", "water": "water",
}  # fmt: skip
_BARRIER = {"hedge": "hedge", "leaf": "hedge", "metal_dark": "fence", "metal_grey": "fence",
            "wood": "fence", "bench_wood": "fence"}  # fmt: skip
# What `cityx.assets.colliders.class_of` says of pieces where the word is not that of a class.
_PIECE = {
    "roof_window": "window", "power_pole": "pole", "flagpole": "pole",
    "utility_pole": "pole", "utility_pole_wrapped": "pole", "utility_pole_board": "pole",
    "guard_rail_post": "guard_rail", "bus_pole": "sign", "traffic_signal_mast": "traffic_signal",
    "traffic_signal_japan": "traffic_signal",
    "fire_hydrant": "hydrant", "fence_segment": "fence", "wall_segment": "wall",
    "hedge_segment": "hedge", "swing": "playground", "slide": "playground",
    "climbing_frame": "playground", "spring_rider": "playground", "sandpit": "playground",
    "picnic_table": "bench", "football_goal": "sports_equipment",
    "basketball_hoop": "sports_equipment", "tennis_net": "sports_equipment", "park_board": "sign",
    "shop_board": "sign", "rowing_boat": "boat", "motor_boat": "boat", "barge": "boat",
    "mooring_bollard": "bollard", "quay_steps": "stairs", "grating": "street_cover",
    "tree_pit_open": "street_cover", "tree_pit_flush": "street_cover",
    "tree_pit_grate": "street_cover", "tree_pit_planted": "street_cover",
    "tree_pit_staked": "street_cover",
    "van": "car", "scooter": "motorcycle", "person": "pedestrian",
    "asset": "building",
}  # fmt: skip
_KIND = {"furniture": "street_furniture", "vehicle": "vehicle", "tree": "tree",
         "wheel": "vehicle", "vehicle_part": "vehicle"}  # fmt: skip


def class_of_piece(prototype: Prototype) -> int:
    """Return the class of what a prototype shows by itself."""
    for word in (class_of(prototype), prototype.name.removesuffix("_fine"), prototype.kind):
        name = _PIECE.get(word, word)
        if name in CLASS and name != "sky":
            return CLASS[name]
    return CLASS[_KIND.get(prototype.kind, "other")]


def class_of_mover(kind: int) -> int:
    """Return the class of a mover of a kind of `cityx.city.tracks.MOVER_KINDS`."""
    return CLASS[_PIECE.get(MOVER_KINDS[kind], MOVER_KINDS[kind])]


def classes_of_layer(layer: str, batch: MeshBatch) -> NDArray[np.uint8]:
    """Return the class of each object of a layer of meshes, (k,) uint8."""
    name = _LAYER.get(layer, "")
    if name:
        return np.full(batch.count, CLASS[name], np.uint8)
    found = np.full(batch.count, CLASS["other"], np.uint8)
    labels = _surfaces(layer)
    table = _BARRIER if kind_of(layer) == "barrier" else _MATERIAL
    usual = "wall" if kind_of(layer) == "barrier" else "other"
    for row, object_id in enumerate(batch.object_id.tolist()):
        surface = labels.get(object_id)
        known = _SURFACE[surface] if surface is not None else None
        found[row] = CLASS[known or table.get(_most(batch.one(row)), usual)]
    return found


@cache
def _surfaces(layer: str) -> Mapping[int, str]:
    """Return the surfaces of the ground by the ids of their objects."""
    return {stable_id(layer, surface.name): surface.name for surface in SURFACES}


def _most(mesh: MeshBatch) -> str:
    """Return the root of the material that most of a mesh is made of."""
    if not len(mesh.faces):
        return ""
    area = np.linalg.norm(area_vectors(mesh.vertices, mesh.faces.astype(np.int64)), axis=1)
    shown = np.bincount(mesh.material, np.nan_to_num(area), minlength=len(mesh.materials))
    return material_named(mesh.materials[int(np.argmax(shown))]).root
