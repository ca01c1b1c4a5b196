"""Strips: straight members that repeat over fronts: fins, mullions, spandrels, panel joints."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cityx.assets.styles.facade_styles import Strip
from cityx.assets.styles.materials import MATERIALS
from cityx.assets.styles.palette_tables import SELF_COLORED
from cityx.assets.trims.trims import trim
from cityx.building.catalogue import looks
from cityx.building.facade.dressing import band
from cityx.building.facade.grammar import bays_of
from cityx.building.facade.placing import Placing
from cityx.geometry.arrays import FloatArray, IntArray
from cityx.geometry.ranges import numbered
from cityx.ids import uniform

if TYPE_CHECKING:
    from cityx.building.facade.facade_plan import Facade

LEAST_WALL = 1.0  # metres; shorter walls bear none
LEAST_HEIGHT = 0.5  # metres of an upright member
ROOM = 2.0  # metres of wall above a neighbour that is worth a member
END = 0.04  # metres between an upright member's middle and the end of its wall
MADE_OF = {"band_box": "trim", "band_paint": "door_paint", "band_frame": "frame_paint"}
TINTS = {"wall": "wall_tint", "trim": "trim_tint", "frame": "frame_tint", "accent": "accent_tint"}


def strips(placing: Placing, found: Facade, seed: int) -> None:
    """Put the fins and slabs of every look on its walls."""
    style = found.designs.style[found.walls.part]
    # Walls of neighbours below, where nothing shows.
    open_from = np.maximum(found.walls.blind_to, found.walls.z_low)
    room = found.walls.z_high - open_from
    usable = (found.walls.length > LEAST_WALL) & (room > ROOM)
    for key in np.unique(style).tolist():
        facade = looks()[key].facade
        rows = np.flatnonzero(usable & (style == key))
        if not len(rows):
            continue
        ids = found.volumes.building[found.walls.part[rows]]
        for number, strip in enumerate(facade.fins):
            having = uniform(seed, f"facade/fins/{key}/{number}", ids) < strip.share
            _fins(placing, found, rows[having], strip, open_from, number)
        for number, strip in enumerate(facade.slabs):
            having = uniform(seed, f"facade/slabs/{key}/{number}", ids) < strip.share
            _slabs(placing, found, rows[having], strip, open_from, number)


def _tint(found: Facade, strip: Strip, wall: IntArray) -> NDArray[np.float32]:
    part = found.walls.part[wall]
    tint = strip.shade * getattr(found.finishes, TINTS[strip.tint])[part]
    if strip.tint == "wall":
        # Tints are relative to the base colour of the wall's own material.
        known, index = np.unique(found.finishes.wall_material[part], return_inverse=True)
        base = np.array([_base_of(word) for word in known.tolist()]).reshape(-1, 3)
        tint = tint * (base / _base_of(MADE_OF[strip.name]))[index] if len(part) else tint
    return np.asarray(np.clip(tint, 0.0, 1.0), np.float32)


def _base_of(material: str) -> FloatArray:
    """Return the base colour of a material, that of trims where it bears its own."""
    word = "trim" if material in SELF_COLORED else material
    return np.asarray(MATERIALS[word].color)


def _lobby(found: Facade) -> FloatArray:
    """Height of the floor above the ground floor of each wall, its foot where it hangs; (w,)."""
    storeys = found.storeys
    number = np.arange(found.walls.count)
    above = storeys.floor_of(number, np.minimum(storeys.first + 1, storeys.count))
    ground = found.fronts.grounded & (storeys.count > 1)
    return np.where(ground, above, found.walls.z_low)


def _fins(
    placing: Placing, found: Facade, rows: IntArray, strip: Strip, open_from: FloatArray, layer: int
) -> None:
    walls = found.walls
    if strip.spacing > 0:
        count = np.maximum(1, np.round(walls.length[rows] / strip.spacing)).astype(np.int64) + 1
        first = np.full(len(rows), END)
        step = (walls.length[rows] - 2 * END) / (count - 1)
    else:
        bays, margin, bay, _ = bays_of(found.storey_walls, found.fronts)
        count = np.where(bays[rows] > 0, bays[rows] + 1, 0)
        first, step = margin[rows], bay[rows]
    row = np.repeat(np.arange(len(rows)), count)
    number = numbered(count)
    wall = rows[row]
    half = strip.breadth / 2
    along = np.clip(first[row] + number * step[row], half, walls.length[wall] - half)
    foot = np.where(strip.lobby, _lobby(found), walls.z_low)
    low = np.maximum(open_from, foot)[wall]
    tall = walls.z_high[wall] - low
    keep = (tall > LEAST_HEIGHT) & (number % strip.every == 0)
    placing.add(
        strip.name, partial(trim, strip.name), wall[keep], along[keep], low[keep],
        scale=(strip.breadth, strip.depth, tall[keep]), tint=_tint(found, strip, wall[keep]),
        index=layer * 100_000 + number[keep], reach=half,
    )  # fmt: skip


def _slabs(
    placing: Placing, found: Facade, rows: IntArray, strip: Strip, open_from: FloatArray, layer: int
) -> None:
    walls, storeys = found.walls, found.storeys
    floors = storeys.count[rows] + 1
    wall = np.repeat(rows, floors)
    floor = numbered(floors)
    z = storeys.floor_of(wall, floor) - 0.5 * strip.breadth
    keep = (floor > storeys.first[wall]) & (floor % strip.every == 0)
    keep &= (z > open_from[wall]) & (z < walls.z_high[wall] - strip.breadth)
    if strip.lobby:
        keep &= z > _lobby(found)[wall] - strip.breadth
    wall, floor, z = wall[keep], floor[keep], z[keep]
    none = np.zeros(len(wall))
    band(
        placing, strip.name, wall, z, _tint(found, strip, wall), none, none, depth=strip.depth,
        height=np.full(len(wall), strip.breadth), index=(layer + 1) * 10_000 + floor,
    )  # fmt: skip
