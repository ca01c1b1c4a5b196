"""Rivers between districts: their course round each corner, banks, and where roads cross.

A river flows along the sides between districts on its two banks. From the middle of one side to
the middle of the next it turns round the corner between them on a parabola, so that a course is
known corner by corner.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely

from cityx.geometry.arrays import FloatArray, IntArray
from cityx.geometry.parcels.lattice import PER_METRE, Corner, Key
from cityx.town.plane import Plane

Pair = tuple[Key, Key]

QUAY = 28.0  # metres from the water to the middle of the road along the bank
ABUTMENT = 18.0  # metres of a crossing at either end that lie on the ground
PIECES = 14  # pieces of the course round a corner
MOUTH = 90.0  # metres that a river runs on into the water it ends in
GREEN = 9.5  # metres from the middle of the bank's road to the green beside it


@dataclass(frozen=True)
class Turn:
    """The course of a river round a corner of districts.

    Attributes
    ----------
    place
        (2,) the corner, whole millimetres.
    middle
        (2,) of its course, where roads to the corner meet it, whole millimetres.
    sides
        The sides it comes along and goes along; one where it ends.
    course
        (k, 2) of the middle of the water, whole millimetres.
    left, right
        (k, 2) each: its banks where their roads run, whole millimetres, in the order of ``sides``.
    water, green
        (n, 2) each: rings of the water and of the green on both banks, whole millimetres.
    """

    place: IntArray
    middle: IntArray
    sides: tuple[Pair, ...]
    course: IntArray
    left: IntArray
    right: IntArray
    water: IntArray
    green: IntArray

    def line(self, bank: IntArray) -> Any:
        """Return a bank as a line about the corner, metres."""
        return shapely.LineString((bank - self.place) / PER_METRE)


def around(plane: Plane, name: Corner) -> list[Key]:
    """Return the districts round a corner, from the lowest."""
    found = [name[0]]
    while True:
        cell = plane.cell(found[-1])
        after = cell.beyond[cell.corners.index(name) - 1]
        if after == found[0]:
            lowest = found.index(min(found))
            return found[lowest:] + found[:lowest]
        found.append(after)


def turn_at(plane: Plane, name: Corner) -> Turn | None:
    """Return the course of the river round a corner, or None where there is none.

    Where two rivers would meet in one corner the first two sides are taken.
    """
    cells = around(plane, name)
    pairs = [_pair(a, b) for a, b in zip(cells, [*cells[1:], cells[0]], strict=True)]
    wet = sorted(pair for pair in pairs if plane.side_kind(*pair) == "river")
    if not wet:
        return None
    place = plane.corner(name)
    middles, normals = zip(*(_middle(plane, pair, name) for pair in wet[:2]), strict=True)
    if len(wet) == 1:
        way = (place - middles[0]) / np.hypot(*(place - middles[0]))
        end = place + np.rint(MOUTH * PER_METRE * way).astype(np.int64)
        course, normal = np.stack([middles[0], place, end]), np.stack([-normals[0]] * 2)
        dry = 2  # points of the course before the shore
    else:
        course = _parabola(middles[0], place, middles[1])
        normal = np.stack([-normals[0], normals[1]])
        dry = len(course)
    half = plane.plan.river_width / 2
    left, right = _beside(course, normal, half + QUAY)
    edge = half + QUAY - GREEN
    return Turn(
        place, course[len(course) // 2], tuple(wet[:2]), course, left, right,
        _ring(*_beside(course, normal, half)), _ring(*_beside(course[:dry], normal, edge)),
    )  # fmt: skip


def _pair(a: Key, b: Key) -> Pair:
    return min(a, b), max(a, b)


def _middle(plane: Plane, pair: Pair, name: Corner) -> tuple[IntArray, FloatArray]:
    """Return the middle of a side, and the normal left of it as seen from a corner at its end."""
    cell = plane.cell(pair[0])
    m = cell.beyond.index(pair[1])
    ends = [cell.corners[m], cell.corners[(m + 1) % len(cell.corners)]]
    start, end = (plane.corner(corner) for corner in ends)
    way = (end - start) / np.hypot(*(end - start))
    normal = np.array([-way[1], way[0]])
    return (start + end) // 2, normal if name == ends[0] else -normal


def _parabola(a: IntArray, b: IntArray, c: IntArray) -> IntArray:
    """Return a curve from a to c that is drawn to b."""
    t = np.linspace(0.0, 1.0, PIECES + 1)[:, None]
    from_b = (1 - t) ** 2 * (a - b) + t**2 * (c - b)
    course = b + np.rint(from_b).astype(np.int64)
    course[0], course[-1] = a, c
    return np.asarray(course)


def _beside(course: IntArray, normal: FloatArray, away: float) -> tuple[IntArray, IntArray]:
    """Return lines at a distance left and right of a course; tight bends are cut short inside."""
    line = shapely.LineString((course - course[0]) / PER_METRE)
    left, right = (_offset(line, course, side * away, normal) for side in (1.0, -1.0))
    return left, right


def _offset(line: Any, course: IntArray, away: float, normal: FloatArray) -> IntArray:
    ends = course[[0, -1]] + np.rint(away * PER_METRE * normal[[0, -1]]).astype(np.int64)
    points = shapely.get_coordinates(shapely.offset_curve(line, away, quad_segs=4))
    inner = course[0] + np.rint(points[1:-1] * PER_METRE).astype(np.int64)
    return np.concatenate([ends[:1], inner, ends[1:]])


def _ring(left: IntArray, right: IntArray) -> IntArray:
    return np.concatenate([left, right[::-1]])


def landing(turn: Turn, bank: IntArray, road: IntArray) -> IntArray | None:
    """Return where a road that leads to a corner meets a bank, or None where it does not.

    Parameters
    ----------
    road
        (k, 2) whole millimetres, from the middle of the turn.
    """
    line = shapely.LineString((road - turn.place) / PER_METRE)
    met = shapely.get_coordinates(shapely.intersection(line, turn.line(bank)))
    if not len(met):
        return None
    at = shapely.line_locate_point(line, shapely.points(met))
    return np.asarray(turn.place + np.rint(met[np.argmax(at)] * PER_METRE), np.int64)


def across(turn: Turn, start: IntArray, bank: IntArray) -> IntArray | None:
    """Return where a bridge that crosses a river squarely from a landing meets the other bank."""
    begin = (start - turn.place) / PER_METRE
    course = turn.line(turn.course)
    way = shapely.get_coordinates(course.interpolate(course.project(shapely.Point(begin))))[0]
    ray = shapely.LineString([begin, begin + 4.0 * (way - begin)])
    met = shapely.get_coordinates(shapely.intersection(ray, turn.line(bank)))
    if not len(met):
        return None
    nearest = met[np.argmin(np.hypot(*(met - begin).T))]
    return np.asarray(turn.place + np.rint(nearest * PER_METRE), np.int64)
