"""Free views: moments at which nothing that moves stands right before the lens, and what is hidden.

A car that drives past a metre before the eye fills the picture, whatever the city is like. A person
with a camera waits until it is gone; what stays they step around, or it is left out.
"""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING, Any

import numpy as np
import shapely
from numpy.typing import ArrayLike, NDArray

from cityx.city.camera import Camera
from cityx.city.moments import Moments, moments_of
from cityx.city.thing_outlines import placed_outlines
from cityx.city.tracks import Tracks
from cityx.geometry.arrays import FloatArray, IntArray
from cityx.geometry.polylines import locate, to_linestrings
from cityx.geometry.ranges import numbered

if TYPE_CHECKING:
    from cityx.city.store import View

NEAR = 5.0  # metres before the lens that movers keep free
ROOM = 9.0  # the same where the busiest moment is looked for
SEEN = 60.0  # metres before the lens within which movers make a picture busy
HIGH_SEEN = 2.5  # of a high lens the same, in heights above the ground
SOLID = ("buildings", "structures", "decks")  # layers that hide what moves
TOUCHING = 2.5  # metres within which what is parked is left out
EVERY = 0.5  # seconds between the moments that are looked at
ARC = 9  # corners of the outer edge of what a lens sees
PARKED = ("vehicles",)  # layers of the scene
WAITING = 0.5  # share by which who stands counts; those who cross a street bring it to life
PASSING = 0.4  # share by which vehicles that pass each other count: a row across a street looks set
ABREAST = 5.5  # metres between the middles of two that do
BROADSIDE = 0.4  # share by which vehicles across the view count; they hide mouths of side streets
TURNING = 0.1  # share by which vehicles that turn or wait amid a junction count; they look askew
TURN = 0.1  # radians a second from which on one turns
CAR = 3.0  # metres of the shortest vehicle that does
# Factor on a moment for each person within metres before the lens, of the first few, who walks
# along a roadway: beside a pavement too narrow for two it is so, and yet looks wrong.
ASTRAY, ASTRAY_NEAR, MOST_ASTRAY = 0.7, 30.0, 4
ON_ROADWAY = 0.03  # metres above the roadway below which one stands on it
ALONG = 0.8  # cosine between a street and those who walk along it
AT_EDGE = 0.3  # share by which what the edge of a picture nearly cuts counts
SLOW = 0.2  # metres a second below which one stands
COLUMNS = 128  # of the grid on which movers hide one another
LEAST_DEPTH = 0.3  # metres before the lens
UP = np.array([0.0, 0.0, 1.0])
_CORNERS = tuple(itertools.product((-1, 1), (-1, 1), (0, 1)))  # of a box: along, across, up


def free_moment(view: View, camera: Camera, *, busiest: bool = False) -> float:
    """Return the moment that a picture shows: the one next to the city's own with a free view.

    Parameters
    ----------
    view
        The city with its tracks.
    camera
        Of the picture.
    busiest
        Whether to take, of the moments with a free view, the one that shows most of what moves:
        each mover within `SEEN` metres, or more of a high lens, that no house hides counts by how
        near it is, by the square root of what it covers from the side, by how much of it no nearer
        mover hides, and by how far amid the picture it is; of those painted alike the farther ones
        count for half, a third and so on; people who stand and wait count for half, and vehicles
        that pass each other, lie across the view, or turn or wait amid a junction for less.
        Vehicles with people count for more than either alone, and each of the first few people
        near by who walk along a roadway takes `1 - ASTRAY` of the whole.

    Returns
    -------
    moment
        Seconds into the tracks. The city's own where nothing moves, or nothing moves within `NEAR`
        (`ROOM` for the busiest) metres before the lens; where something always does, the moment at
        which it is farthest.
    """
    tracks = view.tracks
    if tracks is None or not tracks.count:
        return view.moment
    times = np.arange(0.0, tracks.duration + EVERY / 2, EVERY)
    times = np.append(times[times <= tracks.duration], view.moment)
    order = np.argsort(times, kind="stable")
    everybody = moments_of(tracks, times[order])
    eye = np.array(camera.position)
    high = eye[2] - float(view.terrain.height_at(eye[None, :2])[0])
    near, reach = (ROOM, max(SEEN, HIGH_SEEN * high)) if busiest else (NEAR, NEAR)
    size = tracks.size[everybody.mover].astype(float)
    beside = np.hypot(*(everybody.position[:, :2] - eye[:2]).T)
    beside = beside <= reach + np.hypot(size[:, 0], size[:, 1]) / 2
    foot = everybody.position[:, 2]
    above = np.maximum(eye[2] - foot - size[:, 2], foot - eye[2])
    seen = np.flatnonzero(beside & (above < reach))
    if busiest:
        framed = _framed(camera, everybody.take(seen), size[seen])
        seen = seen[(framed[1] > framed[0]).all(axis=1) | (above[seen] < near)]
    found, size, above = everybody.take(seen), size[seen], above[seen]
    far = _before(camera, found.boxes(tracks.size), reach)
    moment, low = order[found.number], above < near
    away = np.full(len(times), near)
    np.minimum.at(away, moment[low], np.minimum(far, near)[low])
    shown = (1.0 - far / reach) * np.sqrt(size[:, 0] * size[:, 2])
    if busiest:
        framed = _framed(camera, found, size)
        shown *= _in_sight(view, camera, found.position + 0.5 * size[:, 2:] * UP)
        shown *= _unhidden(camera, found, framed, moment, far) * _amid(camera, framed)
        shown /= 1.0 + _alike(tracks, found, moment, far)
    walks = tracks.on_foot[found.mover]
    if busiest:
        stands = _stands(everybody)[seen]
        shown[stands] *= WAITING
        askew = (stands | _turns(everybody)[seen]) & (found.place == 0) & ~walks
        shown[askew] *= TURNING
        shown[_abreast(found, size, moment)] *= PASSING
        # Headings are from east, those of cameras from north, clockwise.
        along = np.abs(np.sin(found.heading + camera.heading))
        shown[~walks] *= (BROADSIDE + (1.0 - BROADSIDE) * along)[~walks]
    both = [np.bincount(moment, shown * own, len(times)) for own in (walks, ~walks)]
    life = np.sqrt((1.0 + both[0]) * (1.0 + both[1])) * busiest
    if busiest:
        astray = walks & (far < ASTRAY_NEAR) & (shown > 0)
        astray[astray] = _along_roadway(view, found.take(np.flatnonzero(astray)))
        count = np.bincount(moment[astray], minlength=len(times))
        life = life * ASTRAY ** np.minimum(count, MOST_ASTRAY)
    wait = np.round(np.abs(times - view.moment), 6)
    best = np.lexsort((times, wait, -np.round(life, 3), -np.round(away, 2)))[0]
    return float(times[best])


def in_the_way(view: View, camera: Camera) -> NDArray[np.uint64]:
    """Return the ids of parked vehicles that fill a picture: about the lens, or right before it."""
    eye = np.array(camera.position)
    if eye[2] - float(view.terrain.height_at(eye[None, :2])[0]) > NEAR:
        return np.zeros(0, np.uint64)
    shapes, _, ids = placed_outlines(view.scene, PARKED)
    return np.asarray(np.unique(ids[_before(camera, shapes, TOUCHING) < TOUCHING]))


def sector(
    eye: ArrayLike, heading: float, angle: float, reach: float
) -> shapely.Polygon:  # fmt: skip
    """Return the ground within reach of a lens.

    Parameters
    ----------
    eye
        (2,) metres.
    heading, angle
        Radians, of its middle from north clockwise, and between its sides.
    reach
        Metres.
    """
    turn = heading + angle * np.linspace(-0.5, 0.5, ARC)
    arc = np.asarray(eye, float) + reach * np.column_stack([np.sin(turn), np.cos(turn)])
    return shapely.Polygon([eye, *arc])


def _stands(found: Moments) -> NDArray[np.bool_]:
    """(m,) whether movers hardly move from the moment before or to the next."""
    way = np.hypot(*np.diff(found.position[:, :2], axis=0).T)
    return _between(found, way <= SLOW * np.diff(found.time))


def _turns(found: Moments) -> NDArray[np.bool_]:
    """(m,) whether movers turn from the moment before or to the next."""
    turn = np.diff(found.heading)
    turn = np.abs(np.arctan2(np.sin(turn), np.cos(turn)))
    return _between(found, turn > TURN * np.diff(found.time))


def _along_roadway(view: View, found: Moments) -> NDArray[np.bool_]:
    """(m,) whether people walk along a street on its roadway, rather than across it."""
    network = view.network
    if network is None or not network.edge_count or not len(found.mover):
        return np.zeros(len(found.mover), bool)
    place = found.position[:, :2]
    low = found.position[:, 2] - view.terrain.height_at(place) < ON_ROADWAY
    lines = to_linestrings(network.lines)
    points = shapely.points(place)
    edge = shapely.STRtree(lines).nearest(points)
    foot = shapely.line_locate_point(lines[edge], points)
    ahead = locate(network.lines, edge, foot)[1]
    way = np.column_stack([np.cos(found.heading), np.sin(found.heading)])
    inside = shapely.distance(lines[edge], points) < network.half_width[edge]
    return np.asarray(low & inside & (np.abs((way * ahead).sum(axis=1)) > ALONG))


def _between(found: Moments, step: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """(m,) whether a step, of (m - 1,) from row to row, begins or ends at a mover's moment."""
    step = step & (np.diff(found.mover) == 0) & (np.diff(found.time) > 0)
    either = np.zeros(len(found.mover), bool)
    either[1:] |= step
    either[:-1] |= step
    return either


def _abreast(found: Moments, size: FloatArray, moment: IntArray) -> NDArray[np.bool_]:
    """(m,) whether vehicles stand or pass beside another of the same moment."""
    from scipy.spatial import cKDTree

    rows = np.flatnonzero(size[:, 0] > CAR)
    places = np.column_stack([found.position[rows, :2], moment[rows] * 2 * ABREAST])
    beside = np.zeros(len(size), bool)
    beside[rows[cKDTree(places).query_pairs(ABREAST, output_type="ndarray").ravel()]] = True
    return beside


def _alike(tracks: Tracks, found: Moments, moment: IntArray, far: FloatArray) -> IntArray:
    """(m,) how many of the same look and paint are nearer at the same moment."""
    _, paint = np.unique(tracks.tint, axis=0, return_inverse=True)
    body = np.where(tracks.on_foot, tracks.look, "")  # cars of one colour are alike from afar
    _, look = np.unique(body, return_inverse=True)
    keys = (far, paint.ravel()[found.mover], look.ravel()[found.mover], moment)
    order = np.lexsort(keys)
    changed = np.zeros(len(order), bool)
    for key in keys[1:]:
        changed[1:] |= np.diff(key[order]) != 0
    group = np.cumsum(changed)
    rank = np.zeros(len(order), np.int64)
    rank[order] = numbered(np.bincount(group)) if len(order) else 0
    return rank


def _in_sight(view: View, camera: Camera, places: FloatArray) -> NDArray[np.bool_]:
    """(m,) whether nothing solid stands between a lens and places."""
    from cityx.geometry.raycast import cast, ray_scene

    meshes = [view.scene.meshes[layer] for layer in SOLID if layer in view.scene.meshes]
    if not meshes:
        return np.ones(len(places), bool)
    whole = np.broadcast_to(np.eye(3, 4), (len(meshes), 3, 4))
    solid = ray_scene(
        [mesh.vertices for mesh in meshes], [mesh.triangles()[0] for mesh in meshes],
        np.arange(len(meshes)), whole,
    )  # fmt: skip
    eye = np.array(camera.position)
    return np.asarray(cast(solid, eye, places - eye, reach=1.0).instance < 0)


def _unhidden(
    camera: Camera,
    found: Moments,
    framed: tuple[IntArray, IntArray],
    moment: IntArray,
    far: FloatArray,
) -> FloatArray:
    """(m,) share of what a picture shows of each mover that no nearer one of its moment hides.

    Movers count as the boxes about them, on a coarse grid of the picture.
    """
    low, high = framed
    share = np.zeros(len(far))
    free = np.ones((_rows(camera), COLUMNS), bool)
    last = -1
    for row in np.lexsort((found.mover, far, moment)).tolist():
        if moment[row] != last:
            free[:], last = True, moment[row]
        (left, top), (right, bottom) = low[row], high[row]
        cells = free[top:bottom, left:right]
        if cells.size:
            share[row] = cells.mean()
            cells[:] = False
    return share


def _amid(camera: Camera, framed: tuple[IntArray, IntArray]) -> FloatArray:
    """(m,) weight of boxes by place: 1 in the middle of a picture, `AT_EDGE` at its edge."""
    low, high = framed
    out = np.abs((low + high) / np.array([COLUMNS, _rows(camera)]) - 1.0).max(axis=1, initial=0.0)
    return np.asarray(1.0 - (1.0 - AT_EDGE) * out**2)


def _rows(camera: Camera) -> int:
    return max(round(COLUMNS * camera.height / camera.width), 1)


def _framed(camera: Camera, found: Moments, size: FloatArray) -> tuple[IntArray, IntArray]:
    """(m, 2) first and last columns and rows of the grid that boxes about movers cover.

    None where they lie beside the picture, or partly behind the lens.
    """
    along, across, up = (np.array(each) for each in zip(*_CORNERS, strict=True))
    cos, sin = np.cos(found.heading)[:, None], np.sin(found.heading)[:, None]
    u, v = size[:, :1] / 2 * along, size[:, 1:2] / 2 * across
    offset = found.position - np.array(camera.position)
    east, north = offset[:, :1] + u * cos - v * sin, offset[:, 1:2] + u * sin + v * cos
    height = offset[:, 2:] + size[:, 2:] * up
    ahead = east * np.sin(camera.heading) + north * np.cos(camera.heading)
    right = east * np.cos(camera.heading) - north * np.sin(camera.heading)
    depth = ahead * np.cos(camera.pitch) + height * np.sin(camera.pitch)
    rise = height * np.cos(camera.pitch) - ahead * np.sin(camera.pitch)
    whole = (depth > LEAST_DEPTH).all(axis=1)
    scale = COLUMNS / 2 / np.tan(camera.hfov / 2) / np.maximum(depth, LEAST_DEPTH)
    x, y = COLUMNS / 2 + right * scale, _rows(camera) / 2 - rise * scale
    grid = np.array([COLUMNS, _rows(camera)])
    low = np.column_stack([np.floor(x.min(axis=1)), np.floor(y.min(axis=1))])
    high = np.column_stack([np.ceil(x.max(axis=1)), np.ceil(y.max(axis=1))])
    low, high = (np.clip(each, 0, grid).astype(np.int64) for each in (low, high))
    return np.where(whole[:, None], low, 0), np.where(whole[:, None], high, 0)


def _before(camera: Camera, shapes: NDArray[Any], reach: float) -> NDArray[np.float64]:
    """(n,) metres from the lens to what of shapes it sees within reach, `reach` for none."""
    eye = camera.position[:2]
    seen = shapely.intersection(sector(eye, camera.heading, camera.hfov, reach), shapes)
    away = shapely.distance(shapely.Point(eye), seen)
    return np.where(shapely.is_empty(seen), reach, np.minimum(away, reach))
