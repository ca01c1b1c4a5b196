"""Noding: lines that cross get points in common, as drawn, or on a grid by snap rounding.

Every end and every crossing of two segments makes a grid point hot; a segment is led through the
hot points whose squares it passes. All predicates are exact on whole numbers.

References
----------
Hobby, "Practical segment intersection with finite precision output", 1999.
"""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
import shapely
from numpy.typing import ArrayLike, NDArray

from cityx.geometry.arrays import FloatArray, IntArray
from cityx.geometry.chains import components
from cityx.geometry.polylines import arc_lengths, pack
from cityx.geometry.ranges import numbered
from cityx.system.cores import in_threads

Shapes = NDArray[Any]

MILLIMETRE = 3  # decimals of shared points
NEAR_POINT = 0.05  # metres; a crossing this close to a point of one of its lines is that point
SAME = 0.5 * 10.0**-MILLIMETRE  # metres; closer points are one

FINE = 128  # parts of a grid step in which segments are given: whole numbers make tests exact
REACH = 1000 * FINE  # the boxes by which slanting segments are compared are no larger
CORNERS = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)])  # of a square; the first is its own
BATCH = 25_000  # boxes that are compared with all others at once, by one thread
# Segments from which compiled kernels do the work: eight times as fast, for the half second that it
# takes to load numba and the few to compile them once.
MANY = 100_000
CELL = 256 * FINE  # edge of the cells by which those are compared, and how many a segment has
CELLS = 8
LISTED, POINTS = 500_000, 100_000  # segments of cells, and points, that one thread looks at


def node_lines(lines: ArrayLike, level: ArrayLike, old: ArrayLike) -> Shapes:
    """Give lines of one level that cross or touch a common point where they do.

    Parameters
    ----------
    lines
        (n,) shapely LineStrings.
    level
        (n,) int; lines of different levels do not meet.
    old
        (n,) bool, lines that were there before: they get no points where only they cross.

    Returns
    -------
    noded
        (n,) LineStrings, those that met nothing as they were. Common points are equal bit by bit.
    """
    lines, old, level = np.asarray(lines, object), np.asarray(old, bool), np.asarray(level)
    new = np.flatnonzero(~old)
    row, second = shapely.STRtree(lines).query(lines[new], predicate="intersects")
    first = new[row]
    keep = (level[first] == level[second]) & (old[second] | (first > second))
    first, second = first[keep], second[keep]
    met = shapely.intersection(lines[first], lines[second])
    places, pair = shapely.get_coordinates(met, return_index=True)
    for side in (first, second):  # where both have a point, that of the older line holds
        places = _on_points(places, lines[side[pair]])
    places = _joined(np.round(places, MILLIMETRE))
    owner = np.concatenate([first[pair], second[pair]])
    return with_points(lines, owner, np.concatenate([places, places]))


def _joined(places: FloatArray) -> FloatArray:
    """Move places closer than `NEAR_POINT` to the first of them, so that many lines meet in one."""
    spots = shapely.points(places)
    pairs = shapely.STRtree(spots).query(spots, predicate="dwithin", distance=NEAR_POINT)
    return np.asarray(places[components(pairs.T, len(places))])


def _on_points(places: FloatArray, lines: Shapes) -> FloatArray:
    """Move each place, (k, 2), to the nearest point of its line where that is near."""
    if not len(places):
        return places
    xy, owner = shapely.get_coordinates(lines, return_index=True)
    to_point = shapely.shortest_line(shapely.multipoints(xy, indices=owner), shapely.points(places))
    nearest = shapely.get_coordinates(shapely.get_point(to_point, 0))
    near = np.hypot(*(nearest - places).T) < NEAR_POINT
    return np.asarray(np.where(near[:, None], nearest, places))


def with_points(lines: Shapes, line: ArrayLike, places: ArrayLike) -> Shapes:
    """Insert points into lines, in order along them; points a line has already are left out.

    Parameters
    ----------
    lines
        (n,) shapely LineStrings.
    line
        (k,) int, the line of each new point.
    places
        (k, 2) float, the points, on their lines or close to them.
    """
    line, places = np.asarray(line, np.int64), np.asarray(places, float)
    touched, slot = np.unique(line, return_inverse=True)
    if not len(touched):
        return lines
    packed = pack(lines[touched])
    new_along = shapely.line_locate_point(lines[line], shapely.points(places))
    xy = np.concatenate([packed.points, places])
    owner = np.concatenate([packed.line_of_point(), slot])
    along = np.concatenate([arc_lengths(packed)[0], new_along])
    order = np.lexsort((along, owner))
    xy, owner = xy[order], owner[order]
    again = (owner[1:] == owner[:-1]) & (np.abs(np.diff(xy, axis=0)).max(axis=1) < SAME)
    kept = np.r_[True, ~again]
    changed = lines.copy()
    changed[touched] = shapely.linestrings(xy[kept], indices=owner[kept])
    return changed


def join_ends(lines: ArrayLike, own: ArrayLike, reach: ArrayLike, new: ArrayLike) -> Shapes:
    """Extend or cut the ends of new lines to the lines that they almost reach or just pass.

    Parameters
    ----------
    lines
        (n,) shapely LineStrings.
    own
        (n,) int; lines of one number do not join each other.
    reach
        (n,) float, metres from a line within which an end belongs to it.
    new
        (n,) bool, lines whose ends are led.

    Returns
    -------
    joined
        (n,) LineStrings; those that ends were led to have a point there.
    """
    lines = np.asarray(lines, object).copy()
    own, reach, new = np.asarray(own), np.asarray(reach, float), np.asarray(new, bool)
    open_ = np.flatnonzero(new & ~shapely.is_closed(lines))
    tips = np.repeat(open_, 2)
    head = np.tile([True, False], len(open_))
    spots = shapely.get_point(lines[tips], np.where(head, 0, -1))
    row, other = shapely.STRtree(lines).query(
        spots, predicate="dwithin", distance=float(reach.max(initial=0.0))
    )
    apart = shapely.distance(spots[row], lines[other])
    keep = (own[tips[row]] != own[other]) & (apart <= reach[other])
    row, other, apart = row[keep], other[keep], apart[keep]
    nearest = np.lexsort((other, apart, row))
    row, which = np.unique(row[nearest], return_index=True)
    target = other[nearest][which]
    # Of two lines that reach for each other only the later one is led.
    pairs = set(zip(tips[row].tolist(), target.tolist(), strict=True))
    leads = [one > two or (two, one) not in pairs
             for one, two in zip(tips[row].tolist(), target.tolist(), strict=True)]  # fmt: skip
    row, target = row[leads], target[leads]
    places = _meeting_places(lines, tips[row], spots[row], target, reach[target])
    lines = with_points(lines, target, places)
    for line, at_head, place in zip(tips[row].tolist(), head[row], places, strict=True):
        lines[line] = _led_to(lines[line], place, at_head=bool(at_head))
    return lines


def _meeting_places(
    lines: Shapes, line: IntArray, spots: Shapes, target: IntArray, reach: FloatArray
) -> FloatArray:
    """Where ends meet their targets: where the line crosses it close to the end, else beside it."""
    crossing = shapely.intersection(
        shapely.intersection(lines[line], shapely.buffer(spots, 2 * reach)), lines[target]
    )
    foot = shapely.get_point(shapely.shortest_line(lines[target], spots), 0)
    near = shapely.get_point(shapely.shortest_line(crossing, spots), 0)
    chosen = np.where(shapely.is_empty(crossing), foot, near)
    places = np.round(shapely.get_coordinates(chosen), MILLIMETRE)
    return _on_points(places, lines[target])


def _led_to(line: shapely.LineString, place: FloatArray, *, at_head: bool) -> shapely.LineString:
    """Cut the end of a line off at a place on it, or lead it there from the end.

    A line of which nothing would be left stays as it is.
    """
    xy = shapely.get_coordinates(line)
    xy = xy[::-1] if at_head else xy
    along = shapely.line_locate_point(shapely.LineString(xy), shapely.Point(place))
    run = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(xy, axis=0).T))])
    # A last point closer than this to the place would leave a kink.
    kept = xy[run < min(along, run[-1]) - NEAR_POINT]
    beyond = along >= run[-1] - NEAR_POINT and np.hypot(*(xy[-1] - place)) > NEAR_POINT
    parts = [kept, xy[-1:], [place]] if beyond else [kept, [place]]
    if not len(kept) and not beyond:
        return line
    led = shapely.LineString(np.concatenate(parts))
    return shapely.reverse(led) if at_head else led


def snap_round(begin: ArrayLike, end: ArrayLike) -> tuple[IntArray, IntArray]:
    """Divide segments so that any two have whole edges in common, or end points, or nothing.

    Parameters
    ----------
    begin, end
        (m, 2) int64, ends of segments, in parts of a grid step (`FINE`), below 2**30 apart.

    Returns
    -------
    points
        (n, 2) int64, the places where edges end, in grid steps, in rising order.
    edges
        (k, 2) int64 into the points, each once, the lower end first. They meet at their ends alone.
    """
    first, second = _distinct(np.asarray(begin, np.int64), np.asarray(end, np.int64))
    if not len(first):
        return np.zeros((0, 2), np.int64), np.zeros((0, 2), np.int64)
    near = (_Listed if len(first) >= MANY else _Boxed)(first, second)
    crossings, pairs = _crossings(first, second, near)
    hot = np.concatenate([_square(first), _square(second), crossings])
    points, at = places(hot)
    at = at[2 * len(first) :]
    segment, point = np.divmod(near.passed(points), len(points))
    del near  # cells or boxes of millions
    segment = np.concatenate([segment, pairs[:, 0], pairs[:, 1]])
    point = np.concatenate([point, at, at])
    segment, point = _in_turn(first, second, points, segment, point)
    step = (segment[1:] == segment[:-1]) & (point[1:] != point[:-1])
    low = np.minimum(point[:-1], point[1:])[step]
    high = np.maximum(point[:-1], point[1:])[step]
    keys = np.unique(low * len(points) + high)
    return points, np.column_stack([keys // len(points), keys % len(points)])


def _in_turn(
    first: IntArray, second: IntArray, points: IntArray, segment: IntArray, point: IntArray
) -> tuple[IntArray, IntArray]:
    """Sort pairs of a segment and a point by segments, and along each that has several."""
    # Most have two, between which there is one edge whichever comes first.
    simple = np.bincount(segment, minlength=len(first))[segment] == 2
    some = np.flatnonzero(simple)
    # They come in order, but for some.
    keys = np.sort(segment[some] * len(points) + point[some], kind="stable")
    rest = np.flatnonzero(~simple)
    own, at = segment[rest], point[rest]
    ahead = second[own] - first[own]
    along = (FINE * points[at] - first[own]) * ahead
    order = np.lexsort((along[:, 0] + along[:, 1], own))
    return (
        np.concatenate([keys // len(points), own[order]]),
        np.concatenate([keys % len(points), at[order]]),
    )


def _square(spots: NDArray[Any]) -> IntArray:
    """Return the grid points to whose squares places belong."""
    return np.asarray(np.floor((spots + FINE // 2) / FINE).astype(np.int64))


def places(points: IntArray) -> tuple[IntArray, IntArray]:
    """Return the distinct rows of (n, 2) whole numbers in order, and the number of each row."""
    import pandas as pd

    low = points.min(axis=0) if len(points) else np.zeros(2, np.int64)
    keys = ((points[:, 0] - low[0]) << np.int64(32)) | (points[:, 1] - low[1])
    # Hashing first and sorting what is distinct takes a third of the time of `np.unique`.
    code, found = pd.factorize(keys)
    order = np.argsort(found)
    number = np.empty(len(order), np.int64)
    number[order] = np.arange(len(order))
    spots = found[order]
    return np.column_stack([spots >> 32, spots & 0xFFFFFFFF]) + low, number[code]


def _distinct(begin: IntArray, end: IntArray) -> tuple[IntArray, IntArray]:
    """Return each segment once, its end to the west, or to the south, first."""
    turned = (begin[:, 0] > end[:, 0]) | ((begin[:, 0] == end[:, 0]) & (begin[:, 1] > end[:, 1]))
    low = np.where(turned[:, None], end, begin)
    high = np.where(turned[:, None], begin, end)
    points, number = places(np.concatenate([low, high]))
    one, other = number[: len(low)], number[len(low) :]
    keys = np.unique(
        (one * len(points) + other)[(_square(points)[one] != _square(points)[other]).any(axis=1)]
    )
    return points[keys // max(len(points), 1)], points[keys % max(len(points), 1)]


def _crossings(
    first: IntArray, second: IntArray, near: _Boxed | _Listed
) -> tuple[IntArray, IntArray]:
    """Grid points next to where segments cross inside of both, (c, 2), and the pairs, (c, 2)."""
    # Two slanting segments may meet in several pairs of boxes, or cells.
    one, two = near.crossing().T
    pair = np.column_stack(np.divmod(np.unique(one * len(first) + two), len(first)))
    a, b, c, d = _ends(first, second, pair)
    from_one, to_one = _side(a, b, c), _side(a, b, d)
    share = from_one / (from_one - to_one)
    return _square(c + share[:, None] * (d - c)), pair


class _Boxed:
    """Segments that are found by boxes; a class for what both questions share.

    Boxes are over half a step round pieces of the segments. A box is the line between two of its
    corners, of which search trees take the bounds. Ends of pieces are rounded: without the one
    more, a box could miss a square that its corner touches.
    """

    def __init__(self, first: IntArray, second: IntArray) -> None:
        self.first, self.second = first, second
        size = np.abs(second - first)
        count = np.maximum(-(-size.min(axis=1) // REACH), 1)
        self.owner = np.repeat(np.arange(len(first)), count)
        number = numbered(count)
        ahead = (second - first)[self.owner] / count[self.owner][:, None]
        begin = first[self.owner] + ahead * number[:, None]
        end = begin + ahead
        low, high = np.minimum(begin, end) - FINE / 2 - 1, np.maximum(begin, end) + FINE / 2 + 1
        self.boxes = shapely.linestrings(np.stack([low, high], axis=1))

    def crossing(self) -> IntArray:
        """Return (k, 2) pairs of segments that cross inside of both, some several times."""
        tree = shapely.STRtree(self.boxes)

        def some(start: int) -> IntArray:
            row, other = tree.query(self.boxes[start : start + BATCH])
            one, two = self.owner[row + start], self.owner[other]
            pair = np.column_stack([one, two])[one < two]
            a, b, c, d = _ends(self.first, self.second, pair)
            pair = pair[np.sign(_side(a, b, c)) * np.sign(_side(a, b, d)) < 0]
            a, b, c, d = _ends(self.first, self.second, pair)
            return np.asarray(pair[np.sign(_side(c, d, a)) * np.sign(_side(c, d, b)) < 0])

        return np.concatenate(in_threads(some, range(0, len(self.boxes), BATCH)))

    def passed(self, points: IntArray) -> IntArray:
        """Return segments times (n, 2) points, and points, whose squares they pass, rising.

        The west and the south side are included.
        """
        tree = shapely.STRtree(shapely.points(FINE * points.astype(float)))
        half = FINE // 2

        def some(start: int) -> IntArray:
            row, point = tree.query(self.boxes[start : start + BATCH])
            segment = self.owner[row + start]
            a, b, centre = self.first[segment], self.second[segment], FINE * points[point]
            low, high = np.minimum(a, b), np.maximum(a, b)
            over = ((low < centre + half) & (high >= centre - half)).all(axis=1)
            segment, point = segment[over], point[over]
            a, b, centre = self.first[segment], self.second[segment], FINE * points[point]
            corners = [_side(a, b, centre + half * way) for way in CORNERS]
            most, least = np.maximum.reduce(corners), np.minimum.reduce(corners)
            upright = (a == b).any(axis=1)
            inside = upright | ((most > 0) & (least < 0)) | (corners[0] == 0)
            return np.asarray(segment[inside] * len(points) + point[inside])

        parts = in_threads(some, range(0, len(self.boxes), BATCH))
        return np.asarray(np.unique(np.concatenate(parts)))


class _Listed:
    """Segments by cells, by compiled kernels: a search tree of millions takes much memory and time.

    It answers what `_Boxed` does.
    """

    def __init__(self, first: IntArray, second: IntArray) -> None:
        from cityx.geometry.noding_kernel import list_cells

        self.first, self.second = first, second
        ends = np.concatenate([first, second])
        self.low = ends.min(axis=0) - 4 * FINE
        span = ends.max(axis=0) + 4 * FINE - self.low
        # Cells of segments that lie far apart are larger: an empty one takes memory, too.
        wide = np.sqrt(float(span[0]) * float(span[1]) / (CELLS * len(first)))
        self.size = max(CELL, int(np.ceil(wide)))
        columns, self.rows = (span // self.size + 1).tolist()
        given = first, second, FINE // 2, self.size, self.low, self.rows
        count = np.zeros(columns * self.rows, np.int64)
        list_cells(*given, count, np.zeros(0, np.int32))
        self.start = np.concatenate([[0], np.cumsum(count)])
        self.listed = np.empty(self.start[-1], np.int32)
        list_cells(*given, self.start[:-1].copy(), self.listed)

    def crossing(self) -> IntArray:
        """Return (k, 2) pairs of segments that cross inside of both, some several times."""
        from cityx.geometry.noding_kernel import crossing_pairs

        given = self.first, self.second, self.start, self.listed
        # Parts of the cells with as many segments each.
        every = np.arange(0, len(self.listed), LISTED)
        bounds = np.searchsorted(self.start, [*every, len(self.listed)]).tolist()
        bounds[0], bounds[-1] = 0, len(self.start) - 1

        def some(part: tuple[int, int]) -> IntArray:
            room = LISTED // 4
            while True:
                found = np.empty((room, 2), np.int64)
                count = crossing_pairs(*given, *part, found)
                if count <= room:
                    return found[:count].copy()
                room = count

        return np.concatenate(in_threads(some, pairwise(bounds)))

    def passed(self, points: IntArray) -> IntArray:
        """Return segments times (n, 2) points, and points, whose squares they pass, rising."""
        from cityx.geometry.noding_kernel import passed_points

        lists = self.size, self.low, self.rows, self.start, self.listed
        given = self.first, self.second, np.ascontiguousarray(points), FINE // 2, *lists

        def some(begin: int) -> IntArray:
            end, room = min(begin + POINTS, len(points)), 4 * POINTS
            while True:
                found = np.empty(room, np.int64)
                count = passed_points(*given, begin, end, found)
                if count <= room:
                    return found[:count].copy()
                room = count

        return np.asarray(np.sort(np.concatenate(in_threads(some, range(0, len(points), POINTS)))))


def _ends(first: IntArray, second: IntArray, pair: IntArray) -> tuple[IntArray, ...]:
    """Return both ends of the one and of the other segment of pairs, (k, 2) each."""
    one, two = pair.T
    return first[one], second[one], first[two], second[two]


def _side(a: IntArray, b: IntArray, c: IntArray) -> IntArray:
    """Twice the area of triangles: above zero where c lies left of the line from a to b."""
    u, v = b - a, c - a
    return np.asarray(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0])
