"""Polygons from relations and broken outlines: even-odd assembly of the member lines."""

from __future__ import annotations

from collections import Counter
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.sources.features.clipping import IntArray

MAX_AVOIDED = 2  # a jetty or a boathouse may stand in water
MAX_GAP_SHARE = 0.5  # of its length, how far the ends of a building's outline may lie apart


def assemble(lines: NDArray[Any], owner: IntArray, count: int) -> NDArray[Any]:
    """Build the area that the lines of each of `count` owners enclose, even-odd, in bulk."""
    built = np.full(count, None, object)
    if len(lines) == 0:
        return built
    order = np.argsort(owner, kind="stable")
    rows, index = np.unique(owner[order], return_inverse=True)
    collections = shapely.geometrycollections(lines[order], indices=index)
    built[rows] = shapely.build_area(collections)
    return built


def open_ends(lines: NDArray[Any]) -> list[tuple[float, float]]:
    """Return the points where an odd number of lines end, sorted."""
    ends: Counter[tuple[float, float]] = Counter()
    for line in lines:
        points = shapely.get_coordinates(line)
        ends[tuple(points[0].tolist())] += 1
        ends[tuple(points[-1].tolist())] += 1
    return sorted(point for point, number in ends.items() if number % 2)


def close_along(
    lines: NDArray[Any], box: tuple[float, float, float, float], avoid: NDArray[Any]
) -> Any:
    """Close lines that leave the site along its border, and build the area they enclose.

    The border is cut where the lines meet it; its pieces are alternately inside and outside. Of
    the two possibilities the one with fewer points to avoid is taken, then the one with the
    shorter border. Lines that end within the site enclose nothing.

    Parameters
    ----------
    lines
        (n,) pieces of the outline.
    box
        The site.
    avoid
        (m,) points that cannot lie in the area: buildings, when it is water. When both
        possibilities hold more than `MAX_AVOIDED` of them, a shore is missing and nothing is built.

    Returns
    -------
    area
        Clipped to the site; None when nothing closes.
    """
    frame = shapely.box(*box)
    inside = shapely.intersection(shapely.union_all(lines), frame)
    chains = shapely.get_parts(shapely.line_merge(inside))
    chains = chains[shapely.get_type_id(chains) == 1]
    border = frame.exterior
    closed, open_chains, cuts = [], [], []
    for chain in chains:
        points = shapely.get_coordinates(chain)
        ends = shapely.points(points[[0, -1]])
        if (points[0] == points[-1]).all():
            closed.append(chain)
        elif (shapely.distance(ends, border) < 1e-6).all():
            open_chains.append(chain)
            cuts += shapely.line_locate_point(border, ends).tolist()
    if not open_chains:
        return _enclosed(closed) if closed else None
    cuts.sort()
    spans = [*zip(cuts, [*cuts[1:], cuts[0] + border.length], strict=True)]
    halves = [spans[0::2], spans[1::2]]
    areas = [_enclosed([*closed, *open_chains, *_border_pieces(border, half)]) for half in halves]
    length = [sum(end - begin for begin, end in half) for half in halves]
    built = [int(shapely.intersects(area, avoid).sum()) for area in areas]
    best = 0 if (built[0], length[0]) <= (built[1], length[1]) else 1
    return areas[best] if built[best] <= MAX_AVOIDED else None


def _enclosed(pieces: list[Any]) -> Any:
    noded = shapely.node(shapely.geometrycollections(_snapped(pieces)))
    return shapely.build_area(shapely.geometrycollections(shapely.get_parts(noded)))


def _border_pieces(border: Any, spans: list[tuple[float, float]]) -> list[Any]:
    from shapely.ops import substring

    length = border.length
    found = []
    for begin, end in spans:
        if end - begin < 1e-9:
            continue
        if end <= length:
            found.append(substring(border, begin, end))
        else:
            found += [substring(border, begin, length), substring(border, 0.0, end - length)]
    return [piece for piece in found if piece.length > 0]


def _snapped(pieces: list[Any]) -> NDArray[Any]:
    """Put the ends of lines on the border exactly where the border's pieces end."""
    return np.asarray(shapely.set_precision(np.array(pieces, object), 1e-4), object)


def close_straight(lines: NDArray[Any]) -> Any:
    """Close an outline with a straight line when its ends are near compared with its length."""
    merged = shapely.get_parts(shapely.line_merge(shapely.union_all(lines)))
    found = []
    for chain in merged:
        points = shapely.get_coordinates(chain)
        gap = float(np.hypot(*(points[0] - points[-1])))
        if len(points) >= 3 and gap <= MAX_GAP_SHARE * chain.length:
            found.append(shapely.make_valid(shapely.Polygon(points), method="structure"))
    return shapely.union_all(found) if found else None
