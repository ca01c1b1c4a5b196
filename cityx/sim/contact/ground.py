"""What a robot stands on and runs into near a place: heights, kerbs, walls and loose things.

A field of heights alone would be a ramp at every kerb. So what is raised begins a cell later in the
field, and a box lies along each real kerb, as high as it is measured to be. Where a kerb is lowered
there is none, and the field has the slope.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray
from scipy import ndimage

from cityx.dataset.classes import CLASS
from cityx.errors import UsageError
from cityx.geometry.arrays import FloatArray, IntArray
from cityx.sim.kernels import gather, rasters
from cityx.sim.scenery import Scenery
from cityx.sim.world import World

CELL = 0.2  # metres between two heights
KERB = 0.05  # metres of a step from which on it is a kerb
HIGHEST = 0.6  # metres up to which an upright face of the ground is one
BEHIND = 0.6  # metres that a box reaches in behind the face of a kerb, where there is so much
ALIGNED = 0.03  # metres within which the points of a kerb are on one line
LONG = 4.0  # metres of a box along a kerb at most
LEVEL = 0.35  # upward part of a normal below which a face is upright
HEADROOM = 2.5  # metres above the robot from where on nothing is in its way
FOOT = 0.15  # metres by which walls are longer downwards: they are cut at the ankle
FIRST_ROOM = 65_536  # triangles
GROUNDS = ("road", "road_marking", "cycle_lane", "parking", "sidewalk", "kerb", "tactile_paving",
           "path", "plaza", "stairs", "yard", "terrain", "grass", "farmland", "forest_floor",
           "soil", "sand", "pitch", "water", "rail_track", "flower_bed")  # fmt: skip


@dataclass(frozen=True)
class Patch:
    """What is about a place, in the frame of the city, metres.

    Attributes
    ----------
    middle
        (2,) of the square.
    height
        (n, n) of the ground, `CELL` apart, row 0 in the south.
    kerb
        (k, 7): x, y, z of the middle of the upper edge, its half length, the direction in which the
        raised side is, radians, how far the box reaches that way, and the drop.
    kerb_slope
        (k,) radians, rise of the edge to the left of that direction.
    wall, wall_object
        (w, 6) as ``World.segment``, and (w,) uint64.
    prop
        (p,) rows of ``Scenery.prop_thing``.
    """

    middle: FloatArray
    height: FloatArray
    kerb: FloatArray
    kerb_slope: FloatArray
    wall: FloatArray
    wall_object: NDArray[np.uint64]
    prop: IntArray


def patch_of(world: World, scenery: Scenery, place: FloatArray, size: float) -> Patch:
    """Return what is about a place.

    Parameters
    ----------
    world, scenery
        Of the city.
    place
        (3,) metres; of streets above each other the one that is met from its height is taken.
    size
        Metres of a side.

    Raises
    ------
    UsageError
        If there is no ground.
    """
    half = size / 2
    middle = np.asarray(place[:2], float)
    bounds = np.array([*(middle - half - 1.0), *(middle + half + 1.0)])
    corner = _ground_triangles(scenery, bounds)
    corner = corner[corner[:, :, 2].min(axis=1) < place[2] + HEADROOM]
    normal = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
    length = np.linalg.norm(normal, axis=1)
    corner, normal = corner[length > 0], normal[length > 0] / length[length > 0, None]
    upright = np.abs(normal[:, 2]) < LEVEL
    height = _heights(corner[~upright], middle, size)
    kerb, slope = _kerbs(corner[upright], height, middle, half)
    wall, of = _walls(world, scenery, bounds, float(place[2]))
    spot = scenery.thing_way[scenery.prop_thing][:, :, 3]
    near = (np.abs(spot[:, :2] - middle) < half - 1.0).all(axis=1)
    near &= np.abs(spot[:, 2] - place[2]) < HEADROOM
    return Patch(middle, _shrunk(height), kerb, slope, wall, of, np.flatnonzero(near))


def height_at(scenery: Scenery, x: float, y: float, below: float = np.inf) -> float:
    """Return the height of the highest ground at a place that is not above a height.

    Raises
    ------
    UsageError
        If there is none.
    """
    corner = _ground_triangles(scenery, np.array([x, y, x, y]))
    a = corner[:, 0]
    u, v = corner[:, 1] - a, corner[:, 2] - a
    area = u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]
    level = np.abs(area) > 1e-12
    a, u, v, area = a[level], u[level], v[level], area[level]
    dx, dy = x - a[:, 0], y - a[:, 1]
    one, other = (dx * v[:, 1] - dy * v[:, 0]) / area, (dy * u[:, 0] - dx * u[:, 1]) / area
    z = a[:, 2] + one * u[:, 2] + other * v[:, 2]
    inside = (one >= -1e-9) & (other >= -1e-9) & (one + other <= 1 + 1e-9) & (z <= below)
    if not inside.any():
        raise UsageError(f"There is no ground at ({x:.1f}, {y:.1f}); a robot needs some.")
    return float(z[inside].max())


def _ground_triangles(scenery: Scenery, bounds: FloatArray) -> FloatArray:
    ground = np.isin(scenery.object_class, [CLASS[name] for name in GROUNDS])
    wanted = ground[scenery.thing_object]
    room = FIRST_ROOM
    while True:
        found, row = np.empty((room, 3, 3)), np.empty((room, 2), np.int64)
        count = gather.within(
            scenery.box, scenery.child, scenery.corner, scenery.thing_way, scenery.cluster_thing,
            scenery.cluster_node, wanted, bounds, found, row,
        )  # fmt: skip
        if count <= room:
            break
        room = count
    found, row = found[:count], row[:count]
    own = ground[scenery.thing_object[row[:, 0]] + scenery.face_part[row[:, 1]]]
    return np.asarray(found[own])


def _heights(corner: FloatArray, middle: FloatArray, size: float) -> FloatArray:
    """(n, n) heights of the ground; where there is none, those of the nearest."""
    count = round(size / CELL) + 1
    west, south = middle - (count * CELL) / 2
    frame = np.array([west, south, CELL, count, count])
    height = np.full((count, count), np.nan, np.float32)
    triangles = np.arange(3 * len(corner), dtype=np.int64).reshape(-1, 3)
    rasters.draw_tops(height, np.zeros((0, 0), np.int32), frame, corner.reshape(-1, 3), triangles,
                      np.zeros(0, np.int64))  # fmt: skip
    missing = np.isnan(height)
    if missing.all():
        raise UsageError(f"There is no ground at ({middle[0]:.1f}, {middle[1]:.1f}).")
    row, column = ndimage.distance_transform_edt(missing, return_distances=False,
                                                 return_indices=True)  # fmt: skip
    return np.asarray(height[row, column], float)


def _shrunk(height: FloatArray) -> FloatArray:
    """Return heights in which what is raised by a kerb begins a cell later."""
    low = ndimage.minimum_filter(height, 3, mode="nearest")
    return np.where(height - low > KERB, low, height)


def _kerbs(
    corner: FloatArray, height: FloatArray, middle: FloatArray, half: float
) -> tuple[FloatArray, FloatArray]:
    """Return kerbs of `Patch` and their slopes, of upright faces of the ground."""
    order = np.argsort(-corner[:, :, 2], axis=1, kind="stable")
    sorted_ = np.take_along_axis(corner, order[:, :, None], axis=1)
    drop = sorted_[:, 1, 2] - sorted_[:, 2, 2]
    upper = sorted_[:, 0, 2] - sorted_[:, 1, 2] < 0.5 * drop
    apart = np.hypot(*(sorted_[:, 1] - sorted_[:, 0])[:, :2].T)
    kept = upper & (drop >= KERB) & (drop <= HIGHEST) & (apart > 0.01)
    edges = sorted_[kept, :2]
    if not len(edges):
        return np.zeros((0, 7)), np.zeros(0)
    edges = np.unique(np.round(edges, 3), axis=0)
    lines = shapely.line_merge(shapely.multilinestrings(shapely.linestrings(edges)))
    points = [_straightened(shapely.get_coordinates(line, include_z=True))
              for line in shapely.get_parts(lines)]  # fmt: skip
    begin = np.concatenate([each[:-1] for each in points])
    end = np.concatenate([each[1:] for each in points])
    length = np.hypot(*(end - begin)[:, :2].T)
    centre = (begin + end) / 2
    inside = (np.abs(centre[:, :2] - middle) < half).all(axis=1) & (length > 0.02)
    begin, end, length, centre = begin[inside], end[inside], length[inside], centre[inside]
    along = (end - begin)[:, :2] / length[:, None]
    left = np.column_stack([-along[:, 1], along[:, 0]])
    one, other = (_at(height, middle, centre[:, :2] + side * 0.3 * left) for side in (1.0, -1.0))
    high = np.where(one > other, 1.0, -1.0)
    step = np.abs(one - other)
    behind = np.zeros(len(length))
    for away in np.arange(0.1, BEHIND + 0.01, 0.1):
        there = _at(height, middle, centre[:, :2] + (high * away)[:, None] * left)
        goes_on = (np.abs(there - centre[:, 2]) < 0.04) & (behind >= away - 0.11)
        behind = np.where(goes_on, away, behind)
    # The raised side is to the left of `along`, turned about where it is not.
    heading = np.arctan2(high * left[:, 1], high * left[:, 0])
    slope = np.arctan2(end[:, 2] - begin[:, 2], length) * -high
    kept = (step >= KERB) & (behind > 0)
    found = np.column_stack([centre, length / 2, heading, behind, step])
    return found[kept], slope[kept]


def _straightened(points: FloatArray) -> FloatArray:
    """Return the points of a line without which it lies elsewhere, none farther apart than `LONG`.

    Height counts thrice, so that a kerb is not carried on over where it is lowered.
    """
    kept = {0, len(points) - 1}
    todo = [(0, len(points) - 1)]
    while todo:
        first, last = todo.pop()
        if last - first < 2:
            continue
        chord, away = points[last] - points[first], points[first + 1 : last] - points[first]
        share = np.clip(away[:, :2] @ chord[:2] / max(chord[:2] @ chord[:2], 1e-12), 0.0, 1.0)
        off = (away - share[:, None] * chord) * [1.0, 1.0, 3.0]
        worst = int(np.argmax(np.linalg.norm(off, axis=1)))
        if np.linalg.norm(off[worst]) > ALIGNED:
            middle = first + 1 + worst
            kept.add(middle)
            todo += [(first, middle), (middle, last)]
    ends = points[sorted(kept)]
    parts = np.ceil(np.hypot(*np.diff(ends[:, :2], axis=0).T) / LONG).astype(int)
    cut = [a + (b - a) * np.arange(count)[:, None] / count
           for a, b, count in zip(ends, ends[1:], np.maximum(parts, 1), strict=False)]  # fmt: skip
    return np.concatenate([*cut, ends[-1:]])


def _at(height: FloatArray, middle: FloatArray, spot: FloatArray) -> FloatArray:
    """Return (k,) heights of the cells that places lie in."""
    count = len(height)
    cell = np.floor((spot - middle + count * CELL / 2) / CELL).astype(int)
    column, row = np.clip(cell, 0, count - 1).T
    return np.asarray(height[row, column])


def _walls(
    world: World, scenery: Scenery, bounds: FloatArray, z: float
) -> tuple[FloatArray, NDArray[np.uint64]]:
    """Return what is solid about a place, without what can be pushed."""
    side = np.asarray(world.segment, float)
    loose = scenery.object_id[scenery.thing_object[scenery.prop_thing]]
    near = (np.maximum(side[:, 0], side[:, 2]) > bounds[0]) & (
        np.minimum(side[:, 0], side[:, 2]) < bounds[2])  # fmt: skip
    near &= (np.maximum(side[:, 1], side[:, 3]) > bounds[1]) & (
        np.minimum(side[:, 1], side[:, 3]) < bounds[3])  # fmt: skip
    near &= (side[:, 4] < z + HEADROOM) & (side[:, 5] > z - HEADROOM)
    near &= np.hypot(side[:, 2] - side[:, 0], side[:, 3] - side[:, 1]) > 0.005
    near &= ~np.isin(world.segment_object, loose)
    found = side[near]
    found[:, 4] -= FOOT
    return found, np.asarray(world.segment_object[near])
