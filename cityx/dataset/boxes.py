"""Boxes about the things of a shot: upright ones in the city, and those in the picture.

How much of a thing is seen is told by rays against that thing alone, through the pixels of its box;
beyond `MOST_RAYS` they go through every second, third, ... pixel of every second, third, ... row.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray
from scipy import ndimage
from scipy.spatial import ConvexHull, QhullError

from cityx.city.camera import Camera, axes
from cityx.dataset.classes import CLASS, THING
from cityx.dataset.record import Boxes
from cityx.dataset.sight import NEAR, Sight
from cityx.dataset.stage import Stage
from cityx.geometry.arrays import FloatArray, IntArray
from cityx.geometry.ranges import ranges
from cityx.geometry.raycast import cast, mesh_corners, subset, ways_at
from cityx.geometry.rectangles import rectangles_of

MOST_RAYS = 4096  # per thing: 1.5 % of error in its visibility
MANY = 64  # corners from which a mesh is taken by its hull
BEYOND = 1.0  # widths and heights of the picture beyond it in which what is cut off is counted


@dataclass(frozen=True)
class Outlines:
    """Points whose hulls hold k things, in the frame of the city.

    Attributes
    ----------
    instance
        (m,) instances of the things, those of one after those of the other.
    first
        (k + 1,) first instance of each thing.
    points
        (n, 3) metres.
    start
        (m + 1,) first point of each instance.
    """

    instance: IntArray
    first: IntArray
    points: FloatArray
    start: IntArray

    @property
    def thing(self) -> IntArray:
        """(k,) first point of each thing."""
        return np.asarray(self.start[self.first[:-1]])

    @property
    def of_point(self) -> IntArray:
        """(n,) thing of each point."""
        return np.repeat(np.arange(len(self.first) - 1), np.diff(self.start[self.first]))


def boxes_of(seen: Sight, *, threads: int | None = None) -> Boxes:
    """Return the boxes of all things of which a shot shows at least one pixel.

    Parameters
    ----------
    seen
        What the pixels meet.
    threads
        That share the work; what is found is the same for any number.
    """
    stage, camera = seen.stage, seen.shot.camera
    whole = np.where(seen.met, stage.whole[seen.rows], -1)
    whole[seen.met & ~THING[stage.semantic[whole]]] = -1
    rows = np.unique(whole[whole >= 0])
    rows = rows[np.argsort(stage.object_id[rows], kind="stable")]
    number = np.zeros(len(stage.whole) + 1, np.int32)  # of the last row, the sky: 0
    number[rows] = np.arange(1, len(rows) + 1)
    picture = number[whole].reshape(camera.height, camera.width)
    spans = ndimage.find_objects(picture, max_label=len(rows))
    marks = np.array([(r.start, d.start, r.stop, d.stop) for d, r in spans], float).reshape(-1, 4)
    held = outlines_of(stage, rows)
    centre, size, heading = solids_of(stage, rows, held)
    reach = _extents(camera, held)
    reach[:, :2] = np.minimum(reach[:, :2], marks[:, :2])
    reach[:, 2:] = np.maximum(reach[:, 2:], marks[:, 2:])
    pixels = np.bincount(picture.ravel(), minlength=len(rows) + 1)[1:].astype(np.int64)
    shares = np.zeros((len(rows), 2), np.float32)
    for at in range(len(rows)):
        members = held.instance[held.first[at] : held.first[at + 1]]
        shares[at] = _shares(seen, members, picture, at + 1, reach[at], threads)
    full = np.clip(reach, 0, [camera.width, camera.height] * 2)
    return Boxes(
        stage.object_id[rows], stage.semantic[rows], centre, size, heading, marks, full,
        shares[:, 0].copy(), shares[:, 1].copy(), pixels,
    )  # fmt: skip


def outlines_of(stage: Stage, rows: IntArray) -> Outlines:
    """Return points around the things that some rows of a stage stand for."""
    wanted = np.full(len(stage.whole), -1, np.int64)
    wanted[rows] = np.arange(len(rows))
    found = wanted[stage.whole[stage.instance_object]]
    own = np.flatnonzero(found >= 0)
    own = own[np.argsort(found[own], kind="stable")]
    kind, mesh = np.unique(stage.instance_triangle[own], return_index=True)
    shapes = [_outline(stage, int(own[at])) for at in mesh.tolist()]
    table = np.concatenate([[0], np.cumsum([len(points) for points in shapes])]).astype(np.int64)
    at, start = ranges(table, np.searchsorted(kind, stage.instance_triangle[own]))
    local = np.concatenate([np.zeros((0, 3)), *shapes])[at]
    ways, _, _ = ways_at(stage.rays, own)
    way = np.repeat(ways, np.diff(start), axis=0)
    points = np.einsum("nij,nj->ni", way[:, :, :3], local) + way[:, :, 3]
    first = np.searchsorted(found[own], np.arange(len(rows) + 1))
    return Outlines(own, first, points, start)


def _outline(stage: Stage, instance: int) -> FloatArray:
    """Return points whose hull holds the mesh of an instance, (n, 3), in its own frame."""
    stands = stage.still is not None and instance < stage.first_mover
    held = stage.still.outlines if stage.still is not None and stands else stage.outlines
    key = int(stage.instance_triangle[instance])
    if key not in held:
        held[key] = _hull(np.unique(mesh_corners(stage.rays, instance).reshape(-1, 3), axis=0))
    return held[key]


def _hull(points: FloatArray) -> FloatArray:
    if len(points) < MANY:
        return points
    try:
        return np.asarray(points[ConvexHull(points).vertices])
    except QhullError:  # it is flat
        return points


def solids_of(
    stage: Stage, rows: IntArray, held: Outlines
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return upright boxes: along the front of a thing, of least area for a building.

    Returns
    -------
    centre, size, heading
        (k, 3) metres, (k, 3) length along the heading, width and height, (k,) radians
        counter-clockwise from east.
    """
    if not len(rows):
        return np.zeros((0, 3)), np.zeros((0, 3)), np.zeros(0)
    # The instance that is the thing itself; the pieces of it come elsewhere.
    itself = held.first[:-1].copy()
    thing = np.repeat(np.arange(len(rows)), np.diff(held.first))
    own = np.flatnonzero(stage.instance_object[held.instance] == rows[thing])
    itself[thing[own]] = own
    ways, _, _ = ways_at(stage.rays, held.instance[itself])
    heading = np.arctan2(-ways[:, 1, 1], -ways[:, 0, 1])  # by themselves things face -y
    built = np.flatnonzero(stage.semantic[rows] == CLASS["building"])
    of_point = held.of_point
    around = np.isin(of_point, built)
    if len(built):
        number = np.searchsorted(built, of_point[around])
        plans = shapely.convex_hull(shapely.linestrings(held.points[around, :2], indices=number))
        heading[built] = np.nan_to_num(rectangles_of(plans).angle)
    cos, sin = np.cos(heading), np.sin(heading)
    x, y, z = held.points.T
    local = np.column_stack([
        cos[of_point] * x + sin[of_point] * y, cos[of_point] * y - sin[of_point] * x, z
    ])  # fmt: skip
    low = np.minimum.reduceat(local, held.thing, axis=0)
    high = np.maximum.reduceat(local, held.thing, axis=0)
    ahead, aside, height = ((low + high) / 2).T
    centre = np.column_stack([cos * ahead - sin * aside, sin * ahead + cos * aside, height])
    return centre, high - low, heading


def _extents(camera: Camera, held: Outlines) -> FloatArray:
    """Return (k, 4) x0, y0, x1, y1 of what is before the camera of some things, not cut."""
    count = len(held.first) - 1
    if not count:
        return np.zeros((0, 4))
    focal = camera.width / 2 / np.tan(camera.hfov / 2)
    local = (held.points - np.array(camera.position)) @ axes(camera).T
    before = local[:, 2] >= NEAR
    spot = local[:, :2] / np.where(before, local[:, 2], 1.0)[:, None] * focal
    low = np.minimum.reduceat(np.where(before[:, None], spot, np.inf), held.thing, axis=0)
    high = np.maximum.reduceat(np.where(before[:, None], spot, -np.inf), held.thing, axis=0)
    # A hull meets the plane of the clip in the hull of where its chords do.
    of_instance = np.repeat(np.arange(len(held.instance)), np.diff(held.start))
    shown = np.bincount(of_instance, before, minlength=len(held.instance))
    astride = np.flatnonzero((shown > 0) & (shown < np.diff(held.start)))
    thing = np.searchsorted(held.first, astride, side="right") - 1
    for row, instance in zip(thing.tolist(), astride.tolist(), strict=True):
        own = slice(int(held.start[instance]), int(held.start[instance + 1]))
        front, behind = local[own][before[own]], local[own][~before[own]]
        share = (NEAR - behind[None, :, 2]) / (front[:, None, 2] - behind[None, :, 2])
        cut = behind[None, :, :2] + share[:, :, None] * (front[:, None, :2] - behind[None, :, :2])
        ends = cut.reshape(-1, 2) / NEAR * focal
        low[row] = np.minimum(low[row], ends.min(axis=0))
        high[row] = np.maximum(high[row], ends.max(axis=0))
    middle = np.array([camera.width, camera.height]) / 2
    return np.concatenate([low + middle, high + middle], axis=1)


def _shares(
    seen: Sight, members: IntArray, picture: NDArray[np.int32], number: int, reach: FloatArray,
    threads: int | None,
) -> tuple[float, float]:  # fmt: skip
    """Return the visibility and the truncation of a thing of a number in the picture."""
    camera = seen.shot.camera
    size = np.array([camera.width, camera.height])
    low = np.floor(np.maximum(reach[:2], -BEYOND * size)).astype(int)
    high = np.ceil(np.minimum(reach[2:], (1 + BEYOND) * size)).astype(int)
    wide, tall = (high - low).tolist()
    step = int(np.ceil(np.sqrt(max(wide * tall / MOST_RAYS, 1.0))))
    columns = np.arange(low[0] + (step - 1) // 2, high[0], step)
    lines = np.arange(low[1] + (step - 1) // 2, high[1], step)
    x, y = (grid.ravel() for grid in np.meshgrid(columns, lines))
    inside = (x >= 0) & (x < size[0]) & (y >= 0) & (y < size[1])
    focal = camera.width / 2 / np.tan(camera.hfov / 2)
    right, down, ahead = axes(camera)
    directions = (
        ahead
        + ((x + 0.5 - size[0] / 2) / focal)[:, None] * right
        + ((y + 0.5 - size[1] / 2) / focal)[:, None] * down
    )
    eye = np.array(camera.position)
    alone = subset(seen.stage.rays, members)
    met = cast(alone, eye + NEAR * directions, directions, threads=threads).instance >= 0
    shown = picture[y[inside], x[inside]] == number
    within, total = np.count_nonzero(met[inside]), np.count_nonzero(met)
    if not within:  # a sliver between the rays
        return 1.0, 0.0
    if shown.any():
        return min(1.0, np.count_nonzero(shown) / within), 1 - within / total
    pixels = np.count_nonzero(picture == number)
    return min(1.0, pixels / (within * step**2)), 1 - within / total
