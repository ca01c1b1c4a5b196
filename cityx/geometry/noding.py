"""Lines that cross get points in common: what a graph of ways needs, and drawn lines lack."""

from __future__ import annotations

from typing import Any

import numpy as np
import shapely
from numpy.typing import ArrayLike, NDArray

from cityx.geometry.chains import components
from cityx.geometry.polylines import arc_lengths, pack

IntArray = NDArray[np.int64]
FloatArray = NDArray[np.float64]
Shapes = NDArray[Any]

MILLIMETRE = 3  # decimals of shared points
NEAR_POINT = 0.05  # metres; a crossing this close to a point of one of its lines is that point
SAME = 0.5 * 10.0**-MILLIMETRE  # metres; closer points are one


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
