"""Ends of roofs: caps along ridges and hips, gutters along eaves, windows in gables."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cityx.assets.trims.dormers import gutter, ridge_tiles
from cityx.assets.trims.surrounds import SURROUND_HEIGHT, SURROUND_WIDTH
from cityx.assets.trims.trims import trim
from cityx.building.assembly import TRIM_MATERIAL
from cityx.building.facade.fronts import walled_up
from cityx.building.facade.placing import Placing
from cityx.building.roofs.dormers import attic_windows
from cityx.building.roofs.roof_heights import THICKNESS, RoofField
from cityx.city.mesh import NO_VERTEX, MeshBatch
from cityx.geometry.arrays import FloatArray, IntArray
from cityx.geometry.solids import area_vectors
from cityx.ids import hash_ids, uniform

if TYPE_CHECKING:
    from cityx.building.facade.facade_plan import Facade
    from cityx.city.city import City
    from cityx.city.scene import Prototype


CAPPED = ("roof_tiles", "slate", "roof_metal", "copper", "bitumen")  # roof materials with caps
DARKER = 0.82  # how much darker caps are than the roof, for the shadow of their joints
OVERLAP = 0.1  # metres a cap runs on at both ends
LIFT = 0.02  # metres of a cap above its line
SLOPING = 0.17  # least sine of the tilt of a roof (10 degrees) that has a ridge
FOLD = np.radians(24.0)  # a flatter fold (of a dome, a barrel) bears no ridge tiles
LEAST_LENGTH = 0.15  # metres; the ridge over a verge is hardly longer
UPRIGHT = 0.05  # largest share of an upright face's area seen from above
LEVEL = 0.01  # metres by which the ends of a level edge may differ
INSIDE = 0.08  # metres behind the wall at which its gable is measured
LEAST_RISE = 2.0  # metres of a gable with a window
PLACES = 9  # along a wall at which its highest point is looked for
SILL = 0.5  # metres above the eave
LARGE, SMALL = (0.95, 1.25), (0.7, 0.85)  # metres; the second is tried where the first is too large
FRAME = 0.3  # metres of wall kept round a window, up to the roof
SPACING = 2.1  # metres between the windows of one gable
SHARE = 0.85  # of buildings with windows in their gables


@dataclass(frozen=True)
class RoofLines:
    """Lines of roofs, k of them.

    Attributes
    ----------
    start, end
        (k, 3) metres; of eaves with the outside on the right hand.
    face
        (k,) row of a face beside the line.
    owner
        (k,) row of the object.
    """

    start: FloatArray
    end: FloatArray
    face: NDArray[np.int64]
    owner: NDArray[np.int64]


def ridges_of(batch: MeshBatch, roof: NDArray[np.bool_]) -> RoofLines:
    """Find the lines along which two slopes fall away to either side.

    Parameters
    ----------
    batch
        k objects, f faces.
    roof
        (f,) bool, the faces that are of a roof.
    """
    vector = area_vectors(batch.vertices, batch.faces)
    size = np.maximum(np.linalg.norm(vector, axis=1), 1e-12)
    normal = vector / size[:, None]
    tilt = np.hypot(normal[:, 0], normal[:, 1])
    rows = np.flatnonzero(roof & (normal[:, 2] > 0.05) & (tilt > SLOPING))
    faces = batch.faces[rows].astype(np.int64)
    quad = faces[:, 3] != NO_VERTEX
    third = np.where(quad, faces[:, 3], faces[:, 0])
    begin = np.concatenate([faces[:, 0], faces[:, 1], faces[:, 2], faces[quad, 3]])
    end = np.concatenate([faces[:, 1], faces[:, 2], third, faces[quad, 0]])
    face = np.concatenate([rows, rows, rows, rows[quad]])
    low, high = np.minimum(begin, end), np.maximum(begin, end)
    key = low * np.int64(len(batch.vertices)) + high
    order = np.argsort(key, kind="stable")
    pair = np.flatnonzero(key[order][1:] == key[order][:-1])
    first, second = order[pair], order[pair + 1]
    one, two = normal[face[first]], normal[face[second]]
    a, b = batch.vertices[begin[first]], batch.vertices[end[first]]
    run = b - a
    length = np.linalg.norm(run, axis=1)
    fold = np.arccos(np.clip((one * two).sum(axis=1), -1.0, 1.0))
    # Both slopes fall away from the line: the first to its left hand, the second to its right.
    left = np.column_stack([-run[:, 1], run[:, 0]])
    falls = ((left * one[:, :2]).sum(axis=1) > 0) & ((left * two[:, :2]).sum(axis=1) < 0)
    kept = falls & (fold > FOLD) & (length > LEAST_LENGTH)
    beside = face[first[kept]]
    return RoofLines(a[kept], b[kept], beside, batch.face_object()[beside])


def eaves_of(batch: MeshBatch, trim: NDArray[np.bool_], height: float) -> RoofLines:
    """Find the upper edges of level fascias.

    Parameters
    ----------
    batch
        k objects, f faces.
    trim
        (f,) bool, the faces of eaves among others.
    height
        Of a fascia, metres.
    """
    rows = np.flatnonzero(trim & (batch.faces[:, 3] != NO_VERTEX))
    corner = batch.vertices[batch.faces[rows]]  # low, low, high, high
    z = corner[:, :, 2]
    level = (np.abs(z[:, 0] - z[:, 1]) < LEVEL) & (np.abs(z[:, 2] - z[:, 3]) < LEVEL)
    level &= np.abs(z[:, 2] - z[:, 1] - height) < LEVEL
    level &= np.hypot(*(corner[:, 2] - corner[:, 1])[:, :2].T) < LEVEL
    length = np.hypot(*(corner[:, 1] - corner[:, 0])[:, :2].T)
    kept = level & (length > LEAST_LENGTH)
    face = rows[kept]
    return RoofLines(corner[kept, 3], corner[kept, 2], face, batch.face_object()[face])


def roof_edges(placing: Placing, batch: MeshBatch) -> None:
    """Put caps on ridges and hips and gutters under eaves of shells."""
    names = np.array(batch.materials)
    of_face = np.isin(names, CAPPED)[batch.material] if len(names) else np.zeros(0, bool)
    ridges = ridges_of(batch, of_face)
    word = names[batch.material[ridges.face]] if len(ridges.face) else np.zeros(0, "U1")
    for name in np.unique(word).tolist():
        rows = np.flatnonzero(word == name)
        made = ridge_tiles(name, detail=placing.detail)
        tint = DARKER * batch.tint[ridges.face[rows]]
        _run(placing, batch, made, _taken(ridges, rows), OVERLAP, LIFT, tint)
    trim = np.isin(names, [TRIM_MATERIAL])[batch.material] if len(names) else of_face
    eaves = eaves_of(batch, trim, THICKNESS)
    made = gutter(detail=placing.detail)
    _run(placing, batch, made, eaves, 0.0, 0.0, np.ones((len(eaves.face), 3), np.float32))


def _taken(lines: RoofLines, rows: NDArray[np.int64]) -> RoofLines:
    return RoofLines(lines.start[rows], lines.end[rows], lines.face[rows], lines.owner[rows])


def _run(
    placing: Placing, batch: MeshBatch, made: Prototype, lines: RoofLines, overlap: float,
    lift: float, tint: NDArray[np.float32],
) -> None:  # fmt: skip
    """Stretch a metre of something along lines; what slopes is turned about its own y axis."""
    vector = lines.end - lines.start
    length = np.linalg.norm(vector, axis=1)
    run = np.hypot(vector[:, 0], vector[:, 1])
    rotation = np.zeros((len(length), 3))
    rotation[:, 1] = -np.arctan2(vector[:, 2], run)
    rotation[:, 2] = np.arctan2(vector[:, 1], vector[:, 0])
    middle = (lines.start + lines.end) / 2
    building = batch.object_id[lines.owner]
    place = np.rint(middle * 1000).astype(np.int64).view(np.uint64)
    with np.errstate(over="ignore"):
        key = place[:, 0] * np.uint64(73856093) + place[:, 1] * np.uint64(19349663) + place[:, 2]
    scale = np.ones((len(length), 3))
    scale[:, 0] = length + overlap
    placing.put(
        made, hash_ids(0, "roof/edge", building, key), building,
        middle + np.array([0.0, 0.0, lift]), rotation, scale=scale, tint=tint,
    )  # fmt: skip


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
