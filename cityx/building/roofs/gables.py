"""Gables: windows in the upright triangles under the ends of roofs."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cityx.assets.trims.surrounds import SURROUND_HEIGHT, SURROUND_WIDTH
from cityx.assets.trims.trims import trim
from cityx.building.facade.fronts import walled_up
from cityx.building.facade.placing import Placing
from cityx.building.roofs.dormers import attic_windows
from cityx.building.roofs.roof_heights import RoofField
from cityx.geometry.polygons import FloatArray, IntArray
from cityx.ids import uniform

if TYPE_CHECKING:
    from cityx.building.facade.facade_plan import Facade
    from cityx.city.city import City

INSIDE = 0.08  # metres behind the wall at which its gable is measured
LEAST_RISE = 2.0  # metres of a gable with a window
PLACES = 9  # along a wall at which its highest point is looked for
SILL = 0.5  # metres above the eave
LARGE, SMALL = (0.95, 1.25), (0.7, 0.85)  # metres; the second is tried where the first is too large
FRAME = 0.3  # metres of wall kept round a window, up to the roof
SPACING = 2.1  # metres between the windows of one gable
SHARE = 0.85  # of buildings with windows in their gables


def gable_windows(placing: Placing, found: Facade, city: City, field: RoofField) -> None:
    """Put one window, two or three in the gables that no neighbour covers."""
    walls, part = found.walls, found.walls.part.astype(np.int64)
    rise = found.volumes.top - found.volumes.eave
    having = uniform(city.seed, "roof/gable", found.volumes.building) < SHARE
    free = (walls.blind_to <= walls.z_low + 0.05) & (walls.open_to > walls.z_high - 0.05)
    usable = free & (having & (rise > LEAST_RISE))[part] & (walls.length > 3.0)
    rows = np.flatnonzero(usable & (walls.z_high - walls.z_low > 1.5))
    # A gable is highest somewhere between its ends.
    middle = _over(placing, field, rows, walls.length[rows] / 2)
    rows = rows[middle > 0.6 * LEAST_RISE]
    share = (np.arange(PLACES) + 0.5) / PLACES
    along = walls.length[rows, None] * share
    height = _over(placing, field, np.repeat(rows, PLACES), along.ravel()).reshape(-1, PLACES)
    peak = np.nan_to_num(height, nan=-1.0).argmax(axis=1)
    near = np.abs(share[peak] - 0.5) < 0.5 / PLACES + 1e-9
    at = np.where(near, walls.length[rows] / 2, along[np.arange(len(rows)), peak])
    tall = np.nan_to_num(height, nan=0.0).max(axis=1) > LEAST_RISE - 0.5
    rows, at = rows[tall], at[tall]
    for size in (LARGE, SMALL):
        fits = _fits(placing, field, rows, at, size)
        _place(placing, found, city, field, rows[fits], at[fits], size)
        rows, at = rows[~fits], at[~fits]


def _over(placing: Placing, field: RoofField, wall: IntArray, along: FloatArray) -> FloatArray:
    """Metres the roof lies above the eave at places just behind walls, NaN where there is none."""
    walls = placing.walls
    out = placing.faces.before(walls, wall, along)
    at = walls.start[wall] + placing.unit[wall] * along[:, None]
    at = at + walls.normal[wall] * (out - INSIDE)[:, None]
    return field.at(at, placing.building[wall])[0] - walls.z_high[wall]


def _fits(
    placing: Placing, field: RoofField, wall: IntArray, at: FloatArray, size: tuple[float, float]
) -> NDArray[np.bool_]:
    """(k,) whether a window lies within its gable."""
    fits = np.ones(len(wall), bool)
    for side in (-1.0, 1.0):
        along = at + side * (size[0] / 2 + FRAME)
        over = _over(placing, field, wall, along)
        fits &= over > SILL + size[1] + FRAME / 2
        fits &= (along > FRAME) & (along < placing.walls.length[wall] - FRAME)
    return fits


def _place(
    placing: Placing, found: Facade, city: City, field: RoofField, wall: IntArray, at: FloatArray,
    size: tuple[float, float],
) -> None:  # fmt: skip
    """Place the window in the middle, or where there is room a pair beside it."""
    beside = np.ones(len(wall), bool)
    for side in (-SPACING, SPACING):
        beside &= _fits(placing, field, wall, at + side, size)
    row = np.concatenate([np.arange(len(wall)), *([np.flatnonzero(beside)] * 2)])
    number = np.repeat([0, 1, 2], [len(wall), beside.sum(), beside.sum()])
    along = at[row] + np.array([0.0, -SPACING, SPACING])[number]
    wall = wall[row]
    z = placing.walls.z_high[wall] + SILL
    one = np.ones(len(wall))
    shut = walled_up(found.volumes, found.walls, wall, along, z, size[0] * one, size[1] * one)
    free = np.flatnonzero(~shut)
    wall, along, z, number, one = wall[free], along[free], z[free], number[free], one[free]
    attic_windows(
        placing, found, city, wall, along, z, (size[0] * one, size[1] * one), 3000 + number
    )
    part = found.walls.part[wall]
    placing.add(
        "sill", partial(trim, "sill"), wall, along, z,
        scale=(size[0] / SURROUND_WIDTH, 1.0, size[1] / SURROUND_HEIGHT),
        tint=found.finishes.trim_tint[part], index=3000 + number, reach=size[0] / 2,
    )  # fmt: skip
