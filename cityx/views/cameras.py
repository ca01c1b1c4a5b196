"""Cameras chosen by looking at the city: along a good street, over its densest part, from above."""

from __future__ import annotations

from math import atan2, pi, radians, tan
from typing import TYPE_CHECKING, Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city.camera import DEFAULT_SIZE, Camera
from cityx.city.mesh import NO_VERTEX, MeshBatch
from cityx.geometry.ranges import numbered

if TYPE_CHECKING:
    from cityx.city.roads import RoadNetwork
    from cityx.city.store import View

EYE_HEIGHT = 1.7  # metres
STREET_FOV = radians(70)
STREET_PITCH = radians(3)  # a little up: more facade, less road
STEP = 12.0  # metres between eye points tried along a street
SIGHT = 120.0  # metres of open view along the street that are as good as endless
DEPTH = 350.0  # metres of city ahead that fill the view to its vanishing point
SIDE_REACH = 30.0  # metres within which a facade lines the street
WALL_BAND = 3.0  # metres above a building's foot: the walls that a person at the kerb sees
CLEAR_OBJECT = 3.0  # metres to the nearest tree, lamp or car
MAX_CANDIDATES = 3000
AERIAL_FOV = radians(55)
AERIAL_PITCH = radians(-32)
# With the sun in the south most facades in view are lit; the one with most city ahead is taken.
AERIAL_HEADINGS = np.radians([25.0, 0.0, -30.0, 55.0])
THING_PITCH = radians(-35)  # steep enough to look over most houses of a street
THING_HEADINGS = np.radians([0.0, 45.0, -45.0, 90.0, -90.0, 135.0, -135.0, 180.0])
THING_SPAN = 28.0  # metres from a small thing
TOP_FOV = radians(25)  # narrow: almost a map
CELL = 50.0  # metres, of the grid on which density is measured
OBSTACLES = ("trees", "street_furniture", "furniture", "vehicles", "parked_cars", "barriers")


def street_camera(
    view: View, *, width: int = DEFAULT_SIZE[0], height: int = DEFAULT_SIZE[1]
) -> Camera:
    """Choose an eye point at the kerb of a long street with facades and trees on both sides.

    Without a street to stand on the camera stands before the densest part of the city.
    """
    walls = _walls(view)
    candidates = None if view.network is None else _candidates(view.network, view.extent)
    if candidates is None:
        return _without_street(view, width, height)
    eyes, headings, length = candidates
    score = np.minimum(length, SIGHT) / SIGHT
    # A view that runs off the map ends in open land; one through the city ends in the city.
    depth = _to_border(eyes, headings, view.extent)
    score += 1.5 * np.minimum(depth, DEPTH) / DEPTH
    if len(walls):
        tree = shapely.STRtree(walls)
        sides = np.stack(
            [_distance(tree, walls, eyes, headings + turn, SIDE_REACH) for turn in _SIDES], axis=1
        )  # (n, 6)
        left, right = (sides[:, :3] < SIDE_REACH), (sides[:, 3:] < SIDE_REACH)
        score += 0.8 * np.minimum(left.mean(axis=1), right.mean(axis=1)) + 0.2 * left.mean(axis=1)
        score += 0.2 * right.mean(axis=1)
        ahead = np.min(
            [_distance(tree, walls, eyes, headings + turn, SIGHT) for turn in (-0.12, 0.0, 0.12)],
            axis=0,
        )
        score += ahead / SIGHT
        nearest = sides.min(axis=1)
        score -= 2.0 * (ahead < 25.0) + 1.0 * (nearest < 1.2)
        inside = shapely.STRtree(_boxes(view)).query(shapely.points(eyes), predicate="within")[0]
        # A turned building's box covers more than the building: a hint, not a verdict.
        score[np.unique(inside)] -= 0.4
    score += _greenery(view, eyes, headings)
    best = int(np.argmax(np.round(score, 6)))  # the first of equals; rows are in order of id
    return _standing(view, "street", eyes[best], float(headings[best]), width, height)


def _to_border(
    eyes: NDArray[np.float64],
    headings: NDArray[np.float64],
    extent: tuple[float, float, float, float],
) -> NDArray[np.float64]:
    """(n,) metres from each eye along its heading to the border of the site."""
    way = np.column_stack([np.sin(headings), np.cos(headings)])
    way = np.where(np.abs(way) < 1e-9, 1e-9, way)
    low, high = np.array(extent[:2]), np.array(extent[2:])
    ahead: NDArray[np.float64] = np.where(way > 0, high - eyes, low - eyes) / way
    return np.asarray(ahead.min(axis=1))


# Rays to the left (first three) and right that a lined street stops.
_SIDES = (-1.2, -0.9, -0.6, 0.6, 0.9, 1.2)


def _standing(
    view: View, name: str, eye: NDArray[np.float64], heading: float, width: int, height: int
) -> Camera:
    ground = float(view.terrain.height_at(eye[None])[0])
    return Camera(
        name,
        (float(eye[0]), float(eye[1]), ground + EYE_HEIGHT),
        heading % (2 * pi),
        STREET_PITCH,
        STREET_FOV,
        width,
        height,
    )


def _candidates(
    network: RoadNetwork, extent: tuple[float, float, float, float]
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]] | None:
    """Eye points near the kerb, (n, 2), their headings and the straight length ahead, (n,)."""
    if not network.edge_count:
        return None
    order = np.argsort(network.edge_id, kind="stable")
    counts = np.diff(network.point_start)
    owner = np.repeat(np.arange(network.edge_count), counts)
    lines = shapely.linestrings(network.points, indices=owner) if (counts > 1).all() else None
    if lines is None:
        order = order[counts[order] > 1]
        lines = np.array(
            [
                shapely.linestrings(network.edge_points(e)) if counts[e] > 1 else None
                for e in range(network.edge_count)
            ],
            dtype=object,
        )
    if not len(order):
        return None
    length = shapely.length(lines[order])
    steps = np.maximum((length // STEP).astype(int), 1)
    row = np.repeat(np.arange(len(order)), steps)
    place = (numbered(steps) + 0.5) / steps[row]
    line, along = lines[order][row], place * length[row]
    half = network.half_width[order][row]
    eyes, headings, ahead = [], [], []
    for sign, near_kerb in ((1.0, True), (-1.0, True), (1.0, False), (-1.0, False)):
        spot = shapely.get_coordinates(shapely.line_interpolate_point(line, along))
        reach = np.clip(along + sign * 15.0, 0.0, length[row])
        target = shapely.get_coordinates(shapely.line_interpolate_point(line, reach))
        way = target - spot
        size = np.linalg.norm(way, axis=1)
        way /= np.maximum(size, 1e-9)[:, None]
        right = np.column_stack([way[:, 1], -way[:, 0]])
        # At the right kerb or in the lane beside parked cars, looking slightly to the left.
        offset = np.maximum(half - 0.6, 0.0) if near_kerb else 0.35 * half
        eyes.append(spot + right * offset[:, None])
        headings.append(np.arctan2(way[:, 0], way[:, 1]) - radians(4.0))
        ahead.append(_straight(line, along, sign, spot, way, length[row]) * (size > 5.0))
    points, angles = np.concatenate(eyes), np.concatenate(headings)
    sight = np.concatenate(ahead)
    xmin, ymin, xmax, ymax = extent
    inside = (points > (xmin, ymin)).all(axis=1) & (points < (xmax, ymax)).all(axis=1)
    # Wide enough to be a street for cars, and not the edge of the map.
    good = np.flatnonzero(inside & (np.tile(half, 4) > 1.5))
    if not len(good):
        return None
    centre = np.array([(xmin + xmax) / 2, (ymin + ymax) / 2])
    off = np.linalg.norm((points[good] - centre) / (xmax - xmin, ymax - ymin), axis=1)
    rank = np.minimum(sight[good], SIGHT) / SIGHT - 0.5 * off
    chosen = np.sort(good[np.argsort(-np.round(rank, 6), kind="stable")[:MAX_CANDIDATES]])
    return points[chosen], angles[chosen], sight[chosen]


def _straight(line: Any, along: Any, sign: float, spot: Any, way: Any, length: Any) -> Any:
    """Metres along an edge until it leaves the line of sight by more than 3 m."""
    free = np.zeros(len(along))
    open_ahead = np.ones(len(along), bool)
    for step in (15.0, 30.0, 60.0, 90.0, 120.0):
        reach = along + sign * step
        open_ahead &= (reach >= 0) & (reach <= length)
        point = shapely.get_coordinates(
            shapely.line_interpolate_point(line, np.clip(reach, 0.0, length))
        )
        delta = point - spot
        across = np.abs(delta[:, 0] * way[:, 1] - delta[:, 1] * way[:, 0])
        open_ahead &= across < 3.0
        free[open_ahead] = step
    return free


def _distance(tree: Any, walls: Any, eyes: Any, headings: Any, reach: float) -> NDArray[np.float64]:
    """Metres from each eye to the first wall in a direction, `reach` when there is none."""
    ends = eyes + reach * np.column_stack([np.sin(headings), np.cos(headings)])
    rays = shapely.linestrings(np.stack([eyes, ends], axis=1))
    ray, wall = tree.query(rays, predicate="intersects")
    hit = shapely.distance(shapely.points(eyes[ray]), shapely.intersection(rays[ray], walls[wall]))
    found = np.full(len(eyes), reach)
    np.minimum.at(found, ray, hit)
    return found


def _buildings(view: View) -> MeshBatch | None:
    batch = view.scene.meshes.get("buildings")
    return batch if batch is not None and batch.count and len(batch.faces) else None


def _walls(view: View) -> Any:
    """Feet of the outer walls as line segments, seen from above."""
    batch = _buildings(view)
    if batch is None:
        return np.zeros(0, dtype=object)
    filled = np.diff(batch.vertex_start) > 0
    foot = np.zeros(batch.count)
    foot[filled] = np.minimum.reduceat(batch.vertices[:, 2], batch.vertex_start[:-1][filled])
    corner = np.where(batch.faces == NO_VERTEX, batch.faces[:, :1], batch.faces)
    points = batch.vertices[corner]  # (f, 4, 3)
    low = points[:, :, 2].min(axis=1) < foot[batch.face_object()] + WALL_BAND
    normal = np.cross(points[:, 1] - points[:, 0], points[:, 2] - points[:, 0])
    upright = np.abs(normal[:, 2]) < 0.1 * np.linalg.norm(normal, axis=1)
    flat = points[low & upright][:, :, :2]  # (w, 4, 2)
    if not len(flat):
        return np.zeros(0, dtype=object)
    # The two corners farthest apart in plan span the wall.
    start = flat[:, 0]
    far = np.linalg.norm(flat - start[:, None], axis=2).argmax(axis=1)
    ends = np.round(np.stack([start, flat[np.arange(len(flat)), far]], axis=1), 2)
    ends = ends[np.linalg.norm(ends[:, 0] - ends[:, 1], axis=1) > 0.3]
    return shapely.linestrings(np.unique(ends.reshape(-1, 4), axis=0).reshape(-1, 2, 2))


def _boxes(view: View) -> Any:
    batch = _buildings(view)
    if batch is None:
        return np.zeros(0, dtype=object)
    low, high = _bounds(batch)
    return shapely.box(low[:, 0], low[:, 1], high[:, 0], high[:, 1])


def _bounds(batch: MeshBatch) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    begin = batch.vertex_start[:-1][np.diff(batch.vertex_start) > 0]
    return np.minimum.reduceat(batch.vertices, begin), np.maximum.reduceat(batch.vertices, begin)


def _greenery(view: View, eyes: Any, headings: Any) -> NDArray[np.float64]:
    """Reward for some trees ahead, less a penalty for things right before the eye."""
    score = np.zeros(len(eyes))
    for layer in OBSTACLES:
        rows = view.scene.instances.get(layer)
        if rows is None or not rows.count:
            continue
        points = shapely.points(rows.position[:, :2])
        tree = shapely.STRtree(points)
        near = tree.query(shapely.points(eyes), predicate="dwithin", distance=CLEAR_OBJECT)[0]
        score[np.unique(near)] -= 1.0
        along = np.column_stack([np.sin(headings), np.cos(headings)])
        close = shapely.points(eyes + 6.0 * along)
        blocked = tree.query(close, predicate="dwithin", distance=2.5)[0]
        score[np.unique(blocked)] -= 0.6
        if layer == "trees":
            seen = shapely.points(eyes + 45.0 * along)
            ahead = tree.query(seen, predicate="dwithin", distance=35.0)[0]
            score += 0.5 * np.minimum(np.bincount(ahead, minlength=len(eyes)), 10) / 10
    return score


def _densest(view: View) -> NDArray[np.float64]:
    """Middle of the part with most building volume, (3,): x, y and its usual height."""
    batch = _buildings(view)
    xmin, ymin, xmax, ymax = view.extent
    if batch is None:
        return np.array([(xmin + xmax) / 2, (ymin + ymax) / 2, 0.0])
    low, high = _bounds(batch)
    middle, size = (low + high) / 2, high - low
    volume = size.prod(axis=1)
    shape = (np.ceil([(xmax - xmin) / CELL, (ymax - ymin) / CELL])).astype(int).clip(1)
    cell = ((middle[:, :2] - (xmin, ymin)) // CELL).astype(int).clip(0, shape - 1)
    grid = np.zeros(shape)
    np.add.at(grid, (cell[:, 0], cell[:, 1]), volume)
    for axis in (0, 1):  # blur over about 250 m: a quarter counts, not one hall
        for _ in range(3):
            padded = np.pad(grid, [(1, 1) if a == axis else (0, 0) for a in (0, 1)])
            parts = [np.take(padded, np.arange(k, k + shape[axis]), axis=axis) for k in range(3)]
            grid = (parts[0] + 2 * parts[1] + parts[2]) / 4
    spot = np.array(np.unravel_index(int(np.argmax(np.round(grid, 3))), shape))
    x, y = (spot + 0.5) * CELL + (xmin, ymin)
    height = float(np.median(size[:, 2]))
    return np.array([min(x, xmax), min(y, ymax), height])


def _without_street(view: View, width: int, height: int) -> Camera:
    """Stand at the southern edge of the densest part and look north."""
    x, y, _ = _densest(view)
    eye = np.array([x, max(y - 60.0, view.extent[1])])
    boxes = _boxes(view)
    if len(boxes):  # step south until free of buildings
        tree = shapely.STRtree(boxes)
        steps = eye - np.outer(np.arange(60) * 5.0, (0.0, 1.0))
        taken = np.unique(tree.query(shapely.points(steps), "dwithin", distance=4.0)[0])
        free = np.setdiff1d(np.arange(len(steps)), taken)
        eye = steps[free[0]] if len(free) else steps[-1]
    return _standing(view, "street", eye, 0.0, width, height)


def aerial_camera(
    view: View, *, width: int = DEFAULT_SIZE[0], height: int = DEFAULT_SIZE[1]
) -> Camera:
    """Choose an oblique view from the south over the densest part of the city, into the city."""
    target = _densest(view)
    xmin, ymin, xmax, ymax = view.extent
    depth = _to_border(np.repeat(target[None, :2], len(AERIAL_HEADINGS), 0), AERIAL_HEADINGS,
                       view.extent)  # fmt: skip
    heading = float(AERIAL_HEADINGS[np.argmax(np.round(depth, 3))])
    span = min(max(min(xmax - xmin, ymax - ymin), 60.0), 450.0)
    distance = 0.55 * span / tan(AERIAL_FOV / 2) + 2 * target[2]
    ground = float(view.terrain.height_at(target[None, :2])[0])
    level = distance * float(np.cos(AERIAL_PITCH))
    x = target[0] - level * float(np.sin(heading))
    y = target[1] - level * float(np.cos(heading))
    z = ground + target[2] / 2 - distance * float(np.sin(AERIAL_PITCH))
    batch = _buildings(view)
    if batch is not None:  # never inside a tower
        low, high = _bounds(batch)
        over = ((low[:, :2] < (x + 15, y + 15)) & (high[:, :2] > (x - 15, y - 15))).all(axis=1)
        z = max(z, float(high[over, 2].max(initial=-np.inf)) + 25.0)
    pitch = -atan2(z - ground - target[2] / 2, level)
    return Camera(
        "aerial",
        (float(x), float(y), float(z)),
        heading % (2 * pi),
        pitch,
        AERIAL_FOV,
        width,
        height,
    )


def camera_on(
    view: View, name: str, box: NDArray[np.float64], *, width: int, height: int
) -> Camera:
    """Choose an oblique view of a thing, from the side from which least stands before it.

    Parameters
    ----------
    box
        (4,) west, south, east and north end of it, metres.
    """
    middle = (box[:2] + box[2:]) / 2
    ground = float(view.terrain.height_at(middle[None])[0])
    distance = max(THING_SPAN, 1.6 * float(np.hypot(*(box[2:] - box[:2]))))
    level, rise = distance * float(np.cos(THING_PITCH)), -distance * float(np.sin(THING_PITCH))
    batch = _buildings(view)
    before = np.zeros(len(THING_HEADINGS))
    if batch is not None:
        low, high = _bounds(batch)
        own = ((low[:, :2] < box[2:]) & (high[:, :2] > box[:2])).all(axis=1)
        walls = shapely.box(*low[~own, :2].T, *high[~own, :2].T)
        for place, heading in enumerate(THING_HEADINGS):
            eye = middle - level * np.array([np.sin(heading), np.cos(heading)])
            hit = shapely.intersects(shapely.linestrings([eye, middle]), walls)
            before[place] = np.maximum(high[~own, 2][hit] - ground, 0.0).sum()
    heading = float(THING_HEADINGS[np.argmin(np.round(before, 1))])
    x, y = middle - level * np.array([np.sin(heading), np.cos(heading)])
    return Camera(name, (float(x), float(y), ground + 2.0 + rise), heading % (2 * pi),
                  float(THING_PITCH), AERIAL_FOV, width, height)  # fmt: skip


def top_camera(
    view: View, *, width: int = DEFAULT_SIZE[0], height: int = DEFAULT_SIZE[1]
) -> Camera:
    """Choose a view straight down on the whole site, north up."""
    xmin, ymin, xmax, ymax = view.extent
    across = max(xmax - xmin, (ymax - ymin) * width / height)
    middle = ((xmin + xmax) / 2, (ymin + ymax) / 2)
    ground = float(view.terrain.height_at([middle])[0])
    z = ground + across / 2 / tan(TOP_FOV / 2)
    return Camera("top", (*middle, z), 0.0, -pi / 2, TOP_FOV, width, height)


def choose_camera(
    view: View, name: str, *, width: int = DEFAULT_SIZE[0], height: int = DEFAULT_SIZE[1]
) -> Camera:
    """Return the camera of a name: "street", "aerial" or "top".

    Raises
    ------
    KeyError
        If there is no such camera.
    """
    return CHOOSERS[name](view, width=width, height=height)


CHOOSERS = {"street": street_camera, "aerial": aerial_camera, "top": top_camera}
