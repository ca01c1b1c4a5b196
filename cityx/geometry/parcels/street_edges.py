"""Streets as edges: those of parcels along their block's border, and the graph of lines."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.geometry.arrays import FloatArray, IntArray
from cityx.geometry.chains import components
from cityx.geometry.polygons import rings_of

TOUCH = 1e-6  # metres; far above what rounding moves, far below any wall
PROBES = (0.37, 0.71)  # of an edge; two odd places that only an edge along the border touches both
BEND = np.radians(20.0)  # edges that turn less are one front
STRAIGHT = 0.8  # of its length from end to end; of a run more bent the longest edge is the front
WRONG_WAY = 0.02  # of its length that an edge counts which does not look the wanted way
NONE = -1
GRID = 1000  # steps per metre; places that are the same to the millimetre are one


@dataclass(frozen=True)
class StreetEdges:
    """k edges on the street, interior on their left hand, in the order of the rings.

    Attributes
    ----------
    owner
        (k,) parcel, ascending.
    start, end
        (k, 2) float64.
    following
        (k,) the edge that goes on from this one on the same ring, -1 where that is no street.
    """

    owner: IntArray
    start: FloatArray
    end: FloatArray
    following: IntArray

    @property
    def length(self) -> FloatArray:
        """(k,) metres."""
        return np.asarray(np.hypot(*(self.end - self.start).T))


def street_edges(shapes: NDArray[Any], streets: NDArray[Any], block: IntArray) -> StreetEdges:
    """Find the edges of shapes on the lines of their block.

    Parameters
    ----------
    shapes
        (m,) polygons.
    streets
        (n,) lines; the borders of the blocks.
    block
        (m,) row of each shape's block.
    """
    rings = rings_of(shapes)
    after = rings.following()
    owner = rings.polygon[rings.ring_of_point]
    start, end = rings.points, rings.points[after]
    shapely.prepare(streets)
    lines = streets[block[owner]]
    on = np.ones(len(owner), bool)
    for share in PROBES:
        rows = np.flatnonzero(on)
        at = shapely.points(start[rows] * (1 - share) + end[rows] * share)
        on[rows] = shapely.dwithin(lines[rows], at, TOUCH)
    rows = np.flatnonzero(on)
    place = np.full(len(on), NONE)
    place[rows] = np.arange(len(rows))
    return StreetEdges(owner[rows], start[rows], end[rows], place[after[rows]])


def street_lengths(shapes: NDArray[Any], streets: NDArray[Any], block: IntArray) -> FloatArray:
    """Measure how much of each shape's border lies on the street, (m,) metres."""
    edges = street_edges(shapes, streets, block)
    return np.bincount(edges.owner, edges.length, minlength=len(shapes)).astype(float)


def fronts_of(edges: StreetEdges, count: int, heading: FloatArray) -> FloatArray:
    """Choose the front of each parcel: its longest run of edges along the street.

    Parameters
    ----------
    heading
        (count, 2) unit vector that the front should follow, NaN where any will do.

    Returns
    -------
    front
        (count, 2, 2) its ends, interior on the left; NaN where no edge is on the street.
    """
    front = np.full((count, 2, 2), np.nan)
    if not len(edges.owner):
        return front
    run, head, tail = _runs(edges)
    length = np.bincount(run, edges.length, minlength=len(head))
    bent = np.hypot(*(edges.end[tail] - edges.start[head]).T) < STRAIGHT * length
    longest = np.lexsort((np.arange(len(run)), -np.round(edges.length, 6), run))
    longest = longest[np.searchsorted(run[longest], np.arange(len(head)))]
    head, tail = np.where(bent, longest, head), np.where(bent, longest, tail)
    chord = edges.end[tail] - edges.start[head]
    wanted = heading[edges.owner[head]]
    along = (chord * wanted).sum(axis=1) / np.maximum(np.hypot(*chord.T), TOUCH)
    score = length * np.where(np.isnan(along), 1.0, np.maximum(along, 0.0) ** 2 + WRONG_WAY)
    owner = edges.owner[head]
    order = np.lexsort((head, -np.round(score, 6), owner))
    first = np.ones(len(order), bool)
    first[1:] = owner[order][1:] != owner[order][:-1]
    best = order[first]
    front[owner[best], 0] = edges.start[head[best]]
    front[owner[best], 1] = edges.end[tail[best]]
    return front


def _runs(edges: StreetEdges) -> tuple[IntArray, IntArray, IntArray]:
    """Join edges that go straight on: (k,) run of each, then first and last edge of each run."""
    count = len(edges.owner)
    here = np.flatnonzero(edges.following != NONE)
    there = edges.following[here]
    a, b = (edges.end - edges.start)[here], (edges.end - edges.start)[there]
    turn = np.abs(np.arctan2(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0], (a * b).sum(axis=1)))
    # A ring that is all street must begin somewhere.
    on = (turn < BEND) & ((there > here) | _opened(edges, here, there))
    here, there = here[on], there[on]
    lowest = components(np.column_stack([here, there]), count)
    names, run = np.unique(lowest, return_inverse=True)
    head, tail = np.zeros(len(names), np.int64), np.zeros(len(names), np.int64)
    begins, ends = np.ones(count, bool), np.ones(count, bool)
    begins[there] = False
    ends[here] = False
    head[run[begins]] = np.flatnonzero(begins)
    tail[run[ends]] = np.flatnonzero(ends)
    return run, head, tail


def _opened(edges: StreetEdges, here: IntArray, there: IntArray) -> NDArray[np.bool_]:
    """Return which links across the end of a ring belong to rings that are not all street."""
    whole = np.zeros(edges.owner[-1] + 1, bool)
    whole[:] = True
    whole[edges.owner[edges.following == NONE]] = False
    return np.asarray(~whole[edges.owner[here]] | (there > here))


def street_lines(edges: StreetEdges, count: int) -> NDArray[Any]:
    """Return the edges of each parcel as one line, or several where the street leaves it.

    Returns
    -------
    lines
        (count,) LineStrings and MultiLineStrings, empty where no edge is on the street.
    """
    pieces = shapely.linestrings(np.stack([edges.start, edges.end], axis=1))
    lines = np.full(count, shapely.MultiLineString(), object)
    owners, first = np.unique(edges.owner, return_inverse=True)
    if len(owners):
        lines[owners] = shapely.line_merge(shapely.multilinestrings(pieces, indices=first))
    return lines


@dataclass(frozen=True)
class StreetGraph:
    """Places along streets, n of them.

    Attributes
    ----------
    places
        (n, 2) metres.
    degree
        (n,) ways that lead from each: 1 at a blind end, 2 along a street, more at a junction.
    """

    places: FloatArray
    degree: IntArray


def street_graph(lines: NDArray[Any]) -> StreetGraph:
    """Find how many ways lead from every point of some lines; they meet in points they share.

    Parameters
    ----------
    lines
        (m,) linestrings, metres.
    """
    points, line = shapely.get_coordinates(lines, return_index=True)
    whole = np.rint(points * GRID).astype(np.int64)
    known, row = np.unique(whole, axis=0, return_inverse=True)
    row = row.ravel()
    along = np.flatnonzero((line[1:] == line[:-1]) & (row[1:] != row[:-1]))
    ends = np.sort(np.column_stack([row[along], row[along + 1]]), axis=1)
    links = np.unique(ends, axis=0)
    return StreetGraph(known / GRID, np.bincount(links.ravel(), minlength=len(known)))
