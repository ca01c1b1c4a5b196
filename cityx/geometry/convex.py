"""Convex solids: hulls of points, few of them round a shape of many pieces, and what they hold."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import combinations

import numpy as np
from numpy.typing import ArrayLike, NDArray

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
THIN = 0.02  # metres; what is thinner is given this thickness, so that nothing passes through
MOST_POINTS = 48  # corners of a hull; engines slow down beyond, and MuJoCo's advice is fewer
DIRECTIONS = 40  # of the planes round a hull with more corners
NEAR = 0.3  # metres between the boxes of two pieces that may be neighbours
BOX_SHARE = 0.9  # of a box that a hull fills which is taken for one
# A cylinder of eight sides fills 0.90 of its round one, a square bar 0.64.
ROUND_SHARE = 0.85


@dataclass(frozen=True)
class Hull:
    """A convex solid.

    Attributes
    ----------
    points
        (n, 3) float64, its corners, metres.
    planes
        (f, 4) float64, one of each triangle of its skin: unit normal outwards and offset; inside,
        normal . x + offset <= 0.
    volume
        Cubic metres.
    """

    points: FloatArray
    planes: FloatArray
    volume: float

    def outside(self, points: FloatArray) -> FloatArray:
        """Return how far (n, 3) points are outside of its planes, (n,) metres, below 0 inside."""
        return np.asarray((points @ self.planes[:, :3].T + self.planes[:, 3]).max(axis=1))


@dataclass(frozen=True)
class Box:
    """An upright box that is turned about z.

    Attributes
    ----------
    center, half
        (3,) middle and half of length, width and height, metres.
    yaw
        Radians counter-clockwise from x of its length.
    """

    center: FloatArray
    half: FloatArray
    yaw: float

    @property
    def volume(self) -> float:
        """Cubic metres."""
        return float(8 * np.prod(self.half))

    def corners(self) -> FloatArray:
        """Return its corners, (8, 3)."""
        c, s = np.cos(self.yaw), np.sin(self.yaw)
        signs = np.array([[i, j, k] for i in (-1, 1) for j in (-1, 1) for k in (-1, 1)], float)
        return np.asarray(signs * self.half @ [[c, s, 0], [-s, c, 0], [0, 0, 1]] + self.center)


@dataclass(frozen=True)
class Cylinder:
    """An upright cylinder.

    Attributes
    ----------
    center
        (3,) its middle, metres.
    radius, half_height
        Metres.
    """

    center: FloatArray
    radius: float
    half_height: float

    @property
    def volume(self) -> float:
        """Cubic metres."""
        return float(2 * np.pi * self.radius**2 * self.half_height)


Solid = Hull | Box | Cylinder


def hull_of(points: ArrayLike) -> Hull:
    """Return the convex hull of (n, 3) points; what is flat is given a thickness of `THIN`."""
    from scipy.spatial import ConvexHull, QhullError

    held = np.asarray(points, float).reshape(-1, 3)
    try:
        found = ConvexHull(held)
        if found.volume < THIN**3:
            raise QhullError("flat")
    except (QhullError, ValueError):
        held = _thickened(held)
        found = ConvexHull(held)
    return Hull(held[np.sort(found.vertices)], found.equations, float(found.volume))


def _thickened(points: FloatArray) -> FloatArray:
    """Grow points to small cubes."""
    cube = np.array([[i, j, k] for i in (-1, 1) for j in (-1, 1) for k in (-1, 1)]) * THIN / 2
    return np.asarray((points[:, None] + cube).reshape(-1, 3))


def fewer_corners(hull: Hull, most: int = MOST_POINTS) -> Hull:
    """Return a hull that holds another and has few corners, cut by planes in fixed directions."""
    if len(hull.points) <= most:
        return hull
    from scipy.spatial import HalfspaceIntersection

    # As wide in every direction, so that planes lie as close to a pole as to a ball.
    size = np.maximum(np.ptp(hull.points, axis=0), THIN)
    even = hull.points / size
    normals = _directions()
    planes = np.column_stack([normals, -(even @ normals.T).max(axis=0)])
    corners = HalfspaceIntersection(planes, even.mean(axis=0)).intersections
    return hull_of(np.round(corners * size, 6))


@lru_cache(maxsize=1)
def _directions() -> FloatArray:
    """Return unit vectors: the axes, and a spiral from pole to pole (Vogel 1979), (d, 3)."""
    number = np.arange(DIRECTIONS) + 0.5
    z = 1 - 2 * number / DIRECTIONS
    turn = np.pi * (1 + np.sqrt(5)) * number
    flat = np.sqrt(1 - z * z)
    spiral = np.column_stack([flat * np.cos(turn), flat * np.sin(turn), z])
    return np.concatenate([spiral, np.eye(3), -np.eye(3)])


def simplest(hull: Hull) -> Solid:
    """Return the cylinder or box round a hull if it is hardly larger, else the hull in few corners.

    What is returned holds the hull whole.
    """
    low, high = hull.points.min(axis=0), hull.points.max(axis=0)
    box = box_round(hull.points)
    if hull.volume >= BOX_SHARE * box.volume:
        return box
    middle = (low + high) / 2
    radius = float(np.hypot(*(hull.points - middle)[:, :2].T).max())
    cylinder = Cylinder(middle, radius, float(high[2] - low[2]) / 2)
    if hull.volume >= ROUND_SHARE * cylinder.volume:
        return cylinder
    return fewer_corners(hull)


def box_round(points: FloatArray) -> Box:
    """Return the smallest upright box round (n, 3) points."""
    import shapely

    low, high = points[:, 2].min(), points[:, 2].max()
    plan = shapely.minimum_rotated_rectangle(shapely.multipoints(points[:, :2]))
    if plan.geom_type != "Polygon":  # all on one line
        plan = shapely.minimum_rotated_rectangle(plan.buffer(THIN / 2, quad_segs=1))
    a, b, c = shapely.get_coordinates(plan)[:3]
    yaw = float(np.arctan2(*(b - a)[::-1]))
    # Of the equal ways to turn a box the one nearest to no turn is taken.
    quarter = int(np.round(yaw / (np.pi / 2)))
    size = np.array([np.hypot(*(b - a)), np.hypot(*(c - b))]) / 2
    yaw -= quarter * np.pi / 2
    size = size[::-1] if quarter % 2 else size
    half = np.maximum([*size, (high - low) / 2], THIN / 2)
    return Box(np.array([*((a + c) / 2), (low + high) / 2]), half, yaw)


def hulls_round(clusters: Sequence[FloatArray], *, most: int, slack: float) -> list[Hull]:
    """Cover pieces of a shape by few hulls: neighbours are joined while little air comes in.

    Parameters
    ----------
    clusters
        Points of each piece, (n, 3); a piece counts as convex.
    most
        Hulls at most, from 1.
    slack
        Share of the hull of all that a hull may hold beyond its pieces, unless there are too many.
    """
    hulls = {number: hull_of(points) for number, points in enumerate(clusters)}
    solid = {number: hull.volume for number, hull in hulls.items()}
    allowed = slack * hull_of(np.concatenate([hull.points for hull in hulls.values()])).volume
    costs = {
        pair: _joined(hulls, solid, *pair) for pair in combinations(hulls, 2)
        if _near(hulls[pair[0]], hulls[pair[1]])
    }  # fmt: skip
    while len(hulls) > 1:
        if not costs and len(hulls) > most:
            costs = {pair: _joined(hulls, solid, *pair) for pair in combinations(hulls, 2)}
        if not costs:
            break
        best = min(costs, key=lambda pair: (costs[pair][0], pair))
        if costs[best][0] > allowed and len(hulls) <= most:
            break
        one, other = best
        hulls[one] = costs[best][1]
        solid[one] += solid[other]
        del hulls[other], solid[other]
        costs = {pair: cost for pair, cost in costs.items() if not {one, other} & set(pair)}
        for number in hulls:
            if number != one and _near(hulls[number], hulls[one]):
                pair = (min(number, one), max(number, one))
                costs[pair] = _joined(hulls, solid, *pair)
    return list(hulls.values())


def _joined(
    hulls: dict[int, Hull], solid: dict[int, float], one: int, other: int
) -> tuple[float, Hull]:
    """Return the air that the hull of two would hold, cubic metres, and the hull."""
    hull = hull_of(np.concatenate([hulls[one].points, hulls[other].points]))
    return hull.volume - solid[one] - solid[other], hull


def _near(one: Hull, other: Hull) -> bool:
    gap = np.maximum(one.points.min(axis=0), other.points.min(axis=0))
    gap -= np.minimum(one.points.max(axis=0), other.points.max(axis=0))
    return bool((gap <= NEAR).all())
