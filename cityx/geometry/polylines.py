"""Many polylines in one array: lengths, positions along them, pieces of them."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import shapely
from numpy.typing import ArrayLike, NDArray

from cityx.geometry.arrays import FloatArray, IntArray
from cityx.geometry.ranges import counted

# Positions are cut no closer than this to an existing vertex: half the arrangement's grid.
SAME_POINT = 0.005
SAGITTA = 0.015  # metres from a curve to its chords; hardly more than the grid of the ground
SLACK = 0.001  # metres; keys of far lines are rounded, by much less


@dataclass(frozen=True)
class Polylines:
    """n polylines with p points together.

    How long they are, and what they are to shapely, is found once.

    Attributes
    ----------
    points
        (p, 2) float64, metres.
    start
        (n + 1,) int64; line i has the points ``points[start[i]:start[i + 1]]``, at least two.
    """

    points: FloatArray
    start: IntArray

    @property
    def count(self) -> int:
        """Number of lines."""
        return len(self.start) - 1

    def line_of_point(self) -> IntArray:
        """(p,) line each point belongs to."""
        return np.repeat(np.arange(self.count), np.diff(self.start))

    @cached_property
    def measured(self) -> Measured:
        """Lengths along them."""
        if not self.count:
            none = np.zeros(0)
            return Measured(none, none, none, none)
        step = np.zeros(len(self.points))
        step[1:] = np.hypot(*np.diff(self.points, axis=0).T)
        step[self.start[:-1]] = 0.0
        # Summing line by line keeps a line's numbers free of what stands before it in the array.
        total = np.cumsum(step)
        size = np.diff(self.start)
        along = np.round(total - np.repeat(total[self.start[:-1]], size), 6)
        length = along[self.start[1:] - 1]
        shift = np.concatenate([[0.0], np.cumsum(length + 1.0)])[:-1]
        return Measured(along, length, shift, along + np.repeat(shift, size))

    @cached_property
    def shapes(self) -> NDArray[Any]:
        """(n,) shapely LineStrings; not to be written to."""
        if not self.count:
            return np.zeros(0, dtype=object)
        return np.asarray(shapely.linestrings(self.points, indices=self.line_of_point()))

    def __getstate__(self) -> dict[str, Any]:
        """Return what they are, without what is found of it again."""
        return {"points": self.points, "start": self.start}


@dataclass(frozen=True)
class Measured:
    """Metres along n polylines with p points together; not to be written to.

    Attributes
    ----------
    along, length
        (p,) from the start of each point's line, and (n,) of lines.
    shift, keys
        (n,) where lines begin on one axis on which they follow each other, and (p,) their points.
    """

    along: FloatArray
    length: FloatArray
    shift: FloatArray
    keys: FloatArray


def pack(lines: ArrayLike) -> Polylines:
    """Pack an array of shapely LineStrings."""
    lines = np.asarray(lines, dtype=object)
    points, owner = shapely.get_coordinates(lines, return_index=True)
    return Polylines(points, np.searchsorted(owner, np.arange(len(lines) + 1)).astype(np.int64))


def to_linestrings(lines: Polylines) -> NDArray[Any]:
    """Return (n,) shapely LineStrings."""
    return lines.shapes.copy()


def traced(shapes: NDArray[Any]) -> NDArray[Any]:
    """Return (n,) LineStrings of lines and polygons, of the latter the outer rings."""
    found = np.asarray(shapes, object).copy()
    rows = shapely.get_dimensions(found) == 2
    rings = shapely.get_exterior_ring(found[rows])
    points, index = shapely.get_coordinates(rings, return_index=True)
    if len(points):
        found[rows] = shapely.linestrings(points, indices=index)
    return found


def chords_of_quarter(radius: ArrayLike) -> IntArray:
    """Count the chords of a quarter circle that stay within `SAGITTA` of it, for radii in metres.

    Counts are even, so that there are few of them.
    """
    size = np.maximum(np.asarray(radius, float), 2 * SAGITTA)
    half = np.arccos(1.0 - SAGITTA / size)
    return np.asarray(2 * np.ceil(np.pi / 8 / half), np.int64)


def arc_lengths(lines: Polylines) -> tuple[FloatArray, FloatArray]:
    """Measure lines: (p,) distance of each point from its line's start, (n,) lengths."""
    return lines.measured.along.copy(), lines.measured.length.copy()


def locate(lines: Polylines, line: ArrayLike, along: ArrayLike) -> tuple[FloatArray, FloatArray]:
    """Find positions on lines.

    Parameters
    ----------
    lines
        The lines.
    line
        (k,) int, line of each position.
    along
        (k,) float, metres from the line's start, clipped to its length.

    Returns
    -------
    position, direction
        (k, 2) float each; the direction is a unit vector, zero on lines without length.
    """
    line = np.asarray(line, dtype=np.int64)
    known = lines.measured
    s, length = known.along, known.length
    along = np.clip(np.asarray(along, dtype=float), 0.0, length[line] if len(line) else 0.0)
    # One sorted key over all lines: every line is moved behind the one before it.
    after = np.searchsorted(known.keys, along + known.shift[line], side="left")
    after = np.clip(after, lines.start[line] + 1, lines.start[line + 1] - 1)
    a, b = lines.points[after - 1], lines.points[after]
    step = b - a
    size = np.hypot(step[:, 0], step[:, 1])
    direction = step / np.where(size > 0, size, 1.0)[:, None]
    position = a + direction * (along - s[after - 1])[:, None]
    return position, direction


def nearest_on(
    lines: Polylines, places: ArrayLike, reach: float
) -> tuple[IntArray, IntArray, FloatArray]:
    """Find the nearest place on any line; the cost does not grow with the lengths of lines.

    Parameters
    ----------
    lines
        The lines.
    places
        (k,) shapely Points.
    reach
        Metres up to which lines are near.

    Returns
    -------
    place, line, along
        (m,) the places that have a line near, ascending, the line nearest to each (of equally near
        ones the first) and metres from its start.
    """
    first, owner = segments(lines)
    ends = lines.points[np.stack([first, first + 1], axis=1)]
    chords, points = shapely.linestrings(ends), np.asarray(places, object)
    place, chord = shapely.STRtree(chords).query_nearest(points, max_distance=reach)
    order = np.lexsort((chord, place))  # chords lie line by line
    place, rows = np.unique(place[order], return_index=True)
    chord = chord[order][rows]
    share = shapely.line_locate_point(chords[chord], points[place], normalized=True)
    begin, end = arc_lengths(lines)[0][np.stack([first[chord], first[chord] + 1])]
    # As lengths are: a place at a vertex is neither before nor behind it.
    return place, owner[chord], np.round(begin + share * (end - begin), 6)


def bends(lines: Polylines, values: ArrayLike, slack: float) -> NDArray[np.bool_]:
    """Mark the points between which values run straight along lines, their ends included.

    Parameters
    ----------
    lines
        The lines.
    values
        (p,) float, at their points, or (p, d).
    slack
        What the values of unmarked points may differ from those interpolated between marked ones.

    Returns
    -------
    kept
        (p,) bool.
    """
    owner = lines.line_of_point()
    along, length = arc_lengths(lines)
    # The lines follow each other on one axis, so that a point is known by where it lies.
    place = along + np.concatenate([[0.0], np.cumsum(length + 1.0)])[:-1][owner]
    kept = np.zeros(len(owner), bool)
    kept[lines.start[:-1]] = kept[lines.start[1:] - 1] = True
    for column in np.asarray(values, float).reshape(len(owner), -1).T:
        profile = to_linestrings(Polylines(np.column_stack([place, column]), lines.start))
        thin = shapely.simplify(profile, slack, preserve_topology=False)
        kept[np.searchsorted(place, shapely.get_coordinates(thin)[:, 0])] = True
    return kept


def values_along(
    lines: Polylines, values: ArrayLike, line: ArrayLike, along: ArrayLike
) -> FloatArray:
    """Interpolate values given at points.

    Parameters
    ----------
    lines
        The lines.
    values
        (p,) float, at their points.
    line, along
        (k,) line and metres from its start of each place, clipped to its length.
    """
    line = np.asarray(line, dtype=np.int64)
    if not len(line):
        return np.zeros(0)
    values = np.asarray(values, dtype=float)
    known = lines.measured
    s = known.along
    at = np.clip(np.asarray(along, dtype=float), 0.0, known.length[line])
    after = np.searchsorted(known.keys, at + known.shift[line], side="left")
    after = np.clip(after, lines.start[line] + 1, lines.start[line + 1] - 1)
    gap = s[after] - s[after - 1]
    share = np.clip((at - s[after - 1]) / np.where(gap > 0, gap, 1.0), 0.0, 1.0)
    return np.asarray(values[after - 1] * (1 - share) + values[after] * share)


def pieces(lines: Polylines, line: ArrayLike, begin: ArrayLike, end: ArrayLike) -> Polylines:
    """Cut pieces out of lines.

    Parameters
    ----------
    lines
        The lines.
    line
        (k,) int, line of each piece.
    begin, end
        (k,) float, metres from the line's start, begin < end.

    Returns
    -------
    pieces
        k lines.
    """
    line = np.asarray(line, dtype=np.int64)
    begin, end = np.asarray(begin, dtype=float), np.asarray(end, dtype=float)
    known = lines.measured
    s, shift = known.along, known.shift[line]
    # Of a long line with many pieces only the points about each are looked at.
    low, high = (np.searchsorted(known.keys, at + shift) for at in (begin - SLACK, end + SLACK))
    low, high = np.maximum(low, lines.start[line]), np.minimum(high, lines.start[line + 1])
    owner, number = counted(np.maximum(high - low, 0))
    rows = low[owner] + number
    inside = (s[rows] > begin[owner] + SAME_POINT) & (s[rows] < end[owner] - SAME_POINT)
    head, tail = locate(lines, line, begin)[0], locate(lines, line, end)[0]
    each = np.arange(len(line))
    who = np.concatenate([each, owner[inside], each])
    where = np.concatenate([begin, s[rows[inside]], end])
    points = np.concatenate([head, lines.points[rows[inside]], tail])
    order = np.lexsort((where, who))
    start = np.searchsorted(who[order], np.arange(len(line) + 1)).astype(np.int64)
    return Polylines(points[order], start)


def segments(lines: Polylines) -> tuple[IntArray, IntArray]:
    """Return the (m,) first point of every segment and the (m,) line it belongs to."""
    owner = lines.line_of_point()
    first = np.flatnonzero(owner[1:] == owner[:-1])
    return first, owner[first]


def segment_bounds(shapes: ArrayLike) -> FloatArray:
    """Return the (m, 4) bounds of every segment of shapely lines: xmin, ymin, xmax, ymax."""
    lines = pack(shapely.get_parts(np.asarray(shapes, object)))
    first, _ = segments(lines)
    one, other = lines.points[first], lines.points[first + 1]
    return np.concatenate([np.minimum(one, other), np.maximum(one, other)], axis=1)


def every(length: ArrayLike, period: float, margin: ArrayLike = 0.0) -> tuple[IntArray, FloatArray]:
    """Place marks at a regular spacing, centred on each line.

    Parameters
    ----------
    length
        (n,) float, metres.
    period
        Spacing, metres.
    margin
        Free length at both ends, metres.

    Returns
    -------
    line, along
        (k,) the line of each mark and its distance from the line's start.
    """
    length = np.asarray(length, dtype=float)
    free = length - 2 * np.asarray(margin, dtype=float)
    count = np.where(free >= 0, np.floor(np.maximum(free, 0) / period) + 1, 0).astype(np.int64)
    line = np.repeat(np.arange(len(length)), count)
    first = np.concatenate([[0], np.cumsum(count)])[:-1]
    number = np.arange(len(line)) - np.repeat(first, count)
    return line, length[line] / 2 + (number - (count[line] - 1) / 2) * period


def line_strips(lines: Polylines, lateral: ArrayLike, width: float) -> NDArray[Any]:
    """Return strips that follow lines at a distance, as (n,) shapely Polygons.

    Parameters
    ----------
    lines
        The lines.
    lateral
        (n,) float, metres to the left of each line, negative to the right.
    width
        Width of the strips, metres.
    """
    if not lines.count:
        return np.zeros(0, dtype=object)
    owner = lines.line_of_point()
    lateral = np.asarray(lateral, dtype=float)[owner]
    miter = miters(lines)
    left = lines.points + miter * (lateral + width / 2)[:, None]
    right = lines.points + miter * (lateral - width / 2)[:, None]
    # Forth along the left side and back along the right one.
    ring = np.concatenate([left, right])
    ring_owner = np.concatenate([owner, owner])
    step = np.arange(len(owner))
    order = np.lexsort((np.concatenate([step, 3 * len(owner) - step]), ring_owner))
    return np.asarray(shapely.polygons(shapely.linearrings(ring[order], indices=ring_owner[order])))


def miters(lines: Polylines) -> FloatArray:
    """(p, 2) left-hand vectors at the points, long enough to keep a parallel line parallel."""
    first, _ = segments(lines)
    step = lines.points[first + 1] - lines.points[first]
    normal = np.column_stack([-step[:, 1], step[:, 0]])
    normal /= np.maximum(np.hypot(*step.T), 1e-9)[:, None]
    total = np.zeros_like(lines.points)
    np.add.at(total, first, normal)
    np.add.at(total, first + 1, normal)
    size = np.hypot(*total.T)
    unit = total / np.maximum(size, 1e-9)[:, None]
    inner = np.zeros(len(lines.points), bool)
    inner[first] = True
    inner[lines.start[:-1]] = False
    # Half the sum of two unit normals is the cosine of half the turn; beyond 2 the corner is cut.
    stretch = np.where(inner, np.minimum(2.0 / np.maximum(size, 1e-9), 2.0), 1.0)
    return np.asarray(unit * stretch[:, None])
