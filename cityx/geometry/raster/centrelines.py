"""Centrelines: the mask of a street network becomes a graph of lines with widths.

The mask is thinned to a skeleton; what the skeleton says of ends and crossings is noise of the
size of a street's width, so spurs are cut off, crossings that are one are joined, and each crossing
is set where the straight parts of its arms meet. All points are (column, row), lengths pixels.

References
----------
Lee, Kashyap and Chu, "Building skeleton models via 3-D medial surface/axis thinning algorithms",
1994.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.geometry.arrays import BoolArray, FloatArray, IntArray
from cityx.geometry.chains import components
from cityx.geometry.raster.patches import depth

SPUR = 2.0  # depths of its crossing that an end must reach out to be a street
STUB = 0.8  # of its own depths that a shorter one, like a drive, must leave its street by
STUB_EVEN = 0.75  # of its greatest depth that its median has; towards a corner the mask narrows
LEAST_STUB = 2.0  # pixels of depth; what is narrower is a ragged border
JOIN = 1.5  # depths at its two ends, on average, below which an edge lies within one crossing
CLEAR = 1.2  # depths from a crossing at which the skeleton no longer bends towards it
REACH = 3.0  # depths beyond that over which the direction of an arm is measured
FURTHEST = 4.0  # depths that a loose end may lie beyond the clear part of its street
PULL = 0.05  # weight with which a crossing stays where the skeleton has it
SMOOTH = 2.0  # pixels, deviation of the filter that takes the staircase out of a skeleton
EVEN = 0.5  # pixels; a skeleton lies half a pixel off the middle of every other strip
CALM = 0.4  # the same in depths: wide streets wave less than their ragged borders
WAVES = 0.06  # widths that a line may stray when points are dropped
ROUNDS = 4  # of cutting off spurs; each may lay bare the next


@dataclass(frozen=True)
class Centrelines:
    """k lines between crossings and ends.

    Attributes
    ----------
    lines
        (k,) LineStrings, (column, row); lines that meet share their end points exactly.
    width
        (k,) pixels from border to border of the mask, the median along the line.
    """

    lines: NDArray[Any]
    width: FloatArray


def centrelines(mask: BoolArray, *, tolerance: float) -> Centrelines:
    """Trace the middles of the streets of a mask.

    Parameters
    ----------
    mask
        (rows, columns), cleaned of specks and pinholes.
    tolerance
        Pixels that a line may stray when points are dropped.
    """
    from skimage.morphology import skeletonize

    deep = depth(mask)
    chains = _chains(skeletonize(mask, method="lee") > 0)  # Zhang's loses slanting strips
    for _ in range(ROUNDS):
        spur = _spurs(chains, deep)
        if not spur.any():
            break
        chains = _merged(chains[~spur])
    if len(chains) == 0:
        return Centrelines(np.zeros(0, object), np.zeros(0))
    return _straightened(chains, deep, tolerance)


def _chains(skeleton: BoolArray) -> NDArray[Any]:
    """Join the pixels of a skeleton to lines between ends and crossings."""
    rows, columns = skeleton.shape
    number = np.full((rows + 1, columns + 2), -1, np.int64)  # one more row and column on each side
    inner = number[:rows, 1:-1]
    row, column = np.nonzero(skeleton)
    inner[skeleton] = np.arange(len(row))
    pairs = []
    for down, right in ((0, 1), (1, 0), (1, 1), (1, -1)):
        other = number[down : down + rows, 1 + right : 1 + right + columns]
        joined = (inner >= 0) & (other >= 0)
        if down and right:  # a diagonal is left out where two straight steps join the same pixels
            beside = number[:rows, 1 + right : 1 + right + columns]
            below = number[down : down + rows, 1:-1]
            joined &= (beside < 0) & (below < 0)
        pairs.append(np.column_stack([inner[joined], other[joined]]))
    pair = np.concatenate(pairs)
    if len(pair) == 0:
        return np.zeros(0, object)
    middle = np.column_stack([column, row]) + 0.5
    steps = shapely.linestrings(middle[pair])
    return _merged(steps)


def _merged(lines: NDArray[Any]) -> NDArray[Any]:
    """Join lines through points at which exactly two meet, in an order of their own."""
    if len(lines) == 0:
        return lines
    return _ordered(shapely.get_parts(shapely.line_merge(shapely.multilinestrings(lines))))


def _ordered(lines: NDArray[Any]) -> NDArray[Any]:
    """Sort lines by place, each from its lower end, so that nothing depends on their making."""
    if len(lines) == 0:
        return lines
    first, last = _ends(lines)
    backward = (first[:, 1] > last[:, 1]) | (
        (first[:, 1] == last[:, 1]) & (first[:, 0] > last[:, 0])
    )
    lines = np.where(backward, shapely.reverse(lines), lines)
    first, last = _ends(lines)
    middle = shapely.get_coordinates(shapely.line_interpolate_point(lines, 0.5, normalized=True))
    keys = np.round(np.column_stack([middle, last, first]), 6)
    return np.asarray(lines[np.lexsort(keys.T)], object)


def _ends(lines: NDArray[Any]) -> tuple[FloatArray, FloatArray]:
    first = shapely.get_coordinates(shapely.get_point(lines, 0))
    last = shapely.get_coordinates(shapely.get_point(lines, -1))
    return first, last


def _nodes(lines: NDArray[Any]) -> tuple[FloatArray, IntArray]:
    """Return the end points of lines, (n, 2), and the two of each line, (k, 2)."""
    first, last = _ends(lines)
    place, index = np.unique(np.concatenate([first, last]), axis=0, return_inverse=True)
    return place, index.reshape(2, -1).T


def _depth_at(deep: FloatArray, points: FloatArray) -> FloatArray:
    cell = np.floor(points).astype(np.int64)
    rows, columns = deep.shape
    values: FloatArray = deep[np.clip(cell[:, 1], 0, rows - 1), np.clip(cell[:, 0], 0, columns - 1)]
    return values


def _spurs(lines: NDArray[Any], deep: FloatArray) -> BoolArray:
    """Mark ends that do not leave the street they branch off."""
    if len(lines) == 0:
        return np.zeros(0, bool)
    place, ends = _nodes(lines)
    degree = np.bincount(ends.ravel(), minlength=len(place))
    at = _depth_at(deep, place)
    loose = degree[ends] == 1
    one = loose.any(axis=1)
    # A line loose at both ends is a patch of its own; it is long or it is no street.
    room = np.where(
        loose.all(axis=1), at[ends].max(axis=1), np.where(loose, 0, at[ends]).max(axis=1)
    )
    short = one & (shapely.length(lines) < SPUR * room)
    for row in np.flatnonzero(short & ~loose.all(axis=1)).tolist():
        points = shapely.get_coordinates(lines[row])
        crossing = int(ends[row, int(loose[row, 0])])
        short[row] = not _is_stub(points, _depth_at(deep, points), place[crossing], at[crossing])
    return np.asarray(short)


def _is_stub(points: FloatArray, own: FloatArray, crossing: FloatArray, room: float) -> bool:
    """Return whether a short end is a street: as wide to its end where it leaves the crossing."""
    away = np.hypot(*(points - crossing).T)
    outer = away > room
    if not outer.any():
        return False
    half = float(np.median(own[outer]))
    even = half >= max(STUB_EVEN * float(own[outer].max()), LEAST_STUB)
    return even and float(away.max()) - room >= STUB * half


def _straightened(lines: NDArray[Any], deep: FloatArray, tolerance: float) -> Centrelines:
    """Join crossings, set them where their arms meet, and measure widths."""
    place, ends = _nodes(lines)
    at = _depth_at(deep, place)
    node, inside = _crossings(lines, ends, at, len(place))
    lines, ends = lines[~inside], node[ends[~inside]]
    weight = np.bincount(node, at, minlength=len(place))
    middle = np.column_stack([
        np.bincount(node, at * axis, minlength=len(place)) for axis in place.T
    ]) / np.where(weight > 0, weight, 1.0)[:, None]  # fmt: skip
    room = np.zeros(len(place))
    np.maximum.at(room, node, at)
    degree = np.bincount(ends.ravel(), minlength=len(place))
    half = np.array([np.median(_depth_at(deep, shapely.get_coordinates(line))) for line in lines])
    arms = _Arms(lines, ends, half, middle, room, degree)
    place = _met(arms)
    shapes, width = [], []
    for row, line in enumerate(lines):
        points = shapely.get_coordinates(line)
        kept = _clear_part(points, arms, row)
        width.append(2 * float(np.median(_depth_at(deep, points[kept]))) + EVEN)
        shapes.append(_drawn(points[kept], arms, row, place, deep))
    across = np.array(width)
    found = shapely.simplify(np.array(shapes, object), np.maximum(tolerance, WAVES * across))
    real = shapely.length(found) > 0
    return Centrelines(found[real], across[real])


@dataclass(frozen=True)
class _Arms:
    """Lines with their ends and depth, and place, depth and degree of each node."""

    lines: NDArray[Any]
    ends: IntArray
    half: FloatArray
    place: FloatArray
    room: FloatArray
    degree: IntArray


def _crossings(
    lines: NDArray[Any], ends: IntArray, at: FloatArray, count: int
) -> tuple[IntArray, BoolArray]:
    """Group the nodes that are one crossing; return each node's group and the lines within one."""
    degree = np.bincount(ends.ravel(), minlength=count)
    length = shapely.length(lines)
    limit = JOIN * at[ends].mean(axis=1)
    short = (length < limit) & (degree[ends] > 2).all(axis=1)
    node = components(ends[short], count)
    within = (node[ends[:, 0]] == node[ends[:, 1]]) & (short | (length < 2 * limit))
    return node, within


def _clear_part(points: FloatArray, arms: _Arms, row: int) -> slice:
    """Return the points of a line that are clear of crossings and of its own ends, at least two."""
    begin, end = 0, len(points)
    for side, node in enumerate(arms.ends[row].tolist()):
        room = CLEAR * arms.room[node] if arms.degree[node] > 1 else arms.half[row]
        away = np.hypot(*(points - arms.place[node]).T) > room
        if side == 0:
            begin = int(np.argmax(away)) if away.any() else len(points)
        else:
            end = len(points) - int(np.argmax(away[::-1])) if away.any() else 0
    if end - begin < 2:
        middle = len(points) // 2
        return slice(max(middle - 1, 0), middle + 1)
    return slice(begin, end)


def _met(arms: _Arms) -> FloatArray:
    """Return the place of each node: where the lines of its arms come nearest to each other."""
    matrix = np.zeros((len(arms.place), 2, 2))
    right = np.zeros((len(arms.place), 2))
    for row, line in enumerate(arms.lines):
        points = shapely.get_coordinates(line)
        clear = points[_clear_part(points, arms, row)]
        for side, node in enumerate(arms.ends[row].tolist()):
            if arms.degree[node] < 3:
                continue
            near = clear if side == 0 else clear[::-1]
            reach = max(int(REACH * arms.room[node]), 2)
            part = near[:reach]
            centre = part.mean(axis=0)
            spread = np.cov((part - centre).T) if len(part) > 1 else np.eye(2)
            across = np.linalg.eigh(spread)[1][:, 0]
            normal = np.outer(across, across)
            matrix[node] += normal
            right[node] += normal @ (centre - arms.place[node])
    moved = np.linalg.solve(matrix + PULL * np.eye(2), right[:, :, None])[:, :, 0]
    far = np.hypot(*moved.T)
    limit = np.maximum(arms.room, 1.0)
    return np.asarray(arms.place + moved * np.minimum(1.0, limit / np.maximum(far, 1e-9))[:, None])


def _drawn(
    clear: FloatArray, arms: _Arms, row: int, place: FloatArray, deep: FloatArray
) -> shapely.LineString:
    """Draw a line smoothly from node to node; loose ends reach to the border of the mask."""
    from scipy.ndimage import gaussian_filter1d

    half = float(arms.half[row])
    smooth = gaussian_filter1d(clear, max(SMOOTH, CALM * half), axis=0, mode="nearest")
    first, last = arms.ends[row].tolist()
    head = place[first] if arms.degree[first] > 1 else _end(smooth, half, deep)
    tail = place[last] if arms.degree[last] > 1 else _end(smooth[::-1], half, deep)
    return shapely.LineString(np.vstack([head, smooth, tail]))


def _end(points: FloatArray, half: float, deep: FloatArray) -> FloatArray:
    """Return where a street ends that is seen to run to the first of some points."""
    back = points[min(int(REACH * half) + 2, len(points) - 1)]
    away = points[0] - back
    length = float(np.hypot(*away))
    if length == 0.0:
        return np.asarray(points[0])
    ahead = np.arange(0.0, FURTHEST * half + 1.0, 0.5)
    ray = points[0] + ahead[:, None] * away / length
    inside = _inside(deep, ray)
    return np.asarray(ray[max(int(np.argmin(inside)) - 1, 0)] if not inside.all() else points[0])


def _inside(deep: FloatArray, points: FloatArray) -> BoolArray:
    rows, columns = deep.shape
    within = (points >= 0).all(axis=1) & (points < [columns, rows]).all(axis=1)
    return np.asarray(within & (_depth_at(deep, points) > 0))
