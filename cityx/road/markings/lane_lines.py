"""Lines between lanes: dashes between lanes of cars, unbroken lines where none cross."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cityx.city.section import CARRIAGEWAY, KIND
from cityx.geometry.polylines import Polylines, every, line_strips, pieces
from cityx.road.markings.crossing_places import MAIN
from cityx.road.markings.marks import (
    LINE,
    BoolArray,
    FloatArray,
    IntArray,
    Marks,
    Street,
)

SOLID = 25.0  # metres before a junction along which no line between lanes may be crossed
LEAST_SOLID = 6.0  # metres; shorter ones say nothing
DASHED = 12.0  # metres between the unbroken ends of a line that stay broken
FAR_DASHES = (3.0, 9.0)  # metres of dash and gap outside towns
LONG_DASH = ("motorway", "trunk", "motorway_link", "trunk_link")
JUNCTION_LINES = (*MAIN, "unclassified")
_KERBED = [KIND[name] for name in CARRIAGEWAY]
_FOR_CARS = [KIND[name] for name in ("drive", "bus")]
_UNLINED = [KIND["parking"]]


@dataclass(frozen=True)
class Partings:
    """Where two bands of an edge meet at a line, p of them. Parked cars have none of their own.

    Attributes
    ----------
    edge
        (p,) int64.
    lateral
        (p,) float, metres to the left of the centreline.
    direction
        (p,) int64, of the band on the left.
    centre
        (p,) bool, whether the line parts the two directions.
    bus
        (p,) bool, whether one of the two is a lane for buses.
    cycle
        (p,) bool, whether one of the two is a lane for bicycles.
    mixed
        (p,) bool, whether the two are anything but two lanes for cars.
    dash, gap
        (p,) float, metres of its dashes, and between them.
    """

    edge: IntArray
    lateral: FloatArray
    direction: IntArray
    centre: BoolArray
    bus: BoolArray
    cycle: BoolArray
    mixed: BoolArray
    dash: FloatArray
    gap: FloatArray


def partings_of(
    street: Street, chosen: BoolArray, kerbed: BoolArray, dashes: tuple[float, float] = (3.0, 3.0)
) -> Partings:
    """Find what parts the bands of the chosen edges.

    The lines have `dashes`, metres of dash and gap, between kerbs, and longer gaps elsewhere.
    """
    bands = street.bands
    begin, end = street.free
    inside = np.flatnonzero(np.isin(bands.kind, _KERBED))
    first, second = inside[:-1], inside[1:]
    edge = bands.edge[first]
    beside = edge == bands.edge[second]
    beside &= ~np.isin(bands.kind[first], _UNLINED) & ~np.isin(bands.kind[second], _UNLINED)
    beside &= chosen[edge] & ((end - begin)[edge] > 3.0)
    first, second, edge = first[beside], second[beside], edge[beside]
    kinds = bands.kind[first], bands.kind[second]
    drive, bus, cycle = KIND["drive"], KIND["bus"], KIND["cycle"]
    far = np.isin(street.kind[edge], LONG_DASH) | ~kerbed[edge]
    return Partings(
        edge,
        bands.right[first],
        bands.direction[first].astype(np.int64),
        bands.direction[first] * bands.direction[second] < 0,
        (kinds[0] == bus) != (kinds[1] == bus),
        (kinds[0] == cycle) != (kinds[1] == cycle),
        (kinds[0] != drive) | (kinds[1] != drive),
        *(np.where(far, other, own) for other, own in zip(FAR_DASHES, dashes, strict=True)),
    )


def lane_lines(street: Street, found: Partings, *, closing: bool = True) -> tuple[Marks, BoolArray]:
    """Paint what parts two bands.

    Unbroken are the middle of roads with four lanes and more, the sides of bus lanes, cycle lanes,
    shoulders and medians, and where `closing` all lines just before a junction. Also returns which
    marks part the two directions.
    """
    lines, bands, edge = street.lines, street.bands, found.edge
    begin, end = street.free
    cars = np.isin(bands.kind, _FOR_CARS)
    lanes = np.bincount(bands.edge[cars], minlength=len(begin))
    solid = (found.centre & (lanes[edge] >= 4)) | found.mixed
    shapes, edges, middle = [], [], []

    def paint(rows: IntArray, cut: Polylines, width: float) -> None:
        shapes.append(line_strips(cut, found.lateral[rows], width))
        edges.append(edge[rows])
        middle.append(found.centre[rows])

    for wide in (False, True):
        rows = np.flatnonzero(solid & (found.bus == wide))
        at = edge[rows]
        paint(rows, pieces(lines, at, begin[at], end[at]), LINE * (1 + wide))
    low, high = begin[edge].copy(), end[edge].copy()
    for side, rows in enumerate(_closing(street, found, solid) if closing else ()):
        at = edge[rows]
        size = _solid_length(end[at] - begin[at])
        if side == 0:
            low[rows] += size
            paint(rows, pieces(lines, at, begin[at], low[rows]), LINE)
        else:
            high[rows] -= size
            paint(rows, pieces(lines, at, high[rows], end[at]), LINE)
    for dash, gap in np.unique(np.column_stack([found.dash, found.gap]), axis=0).tolist():
        rows = np.flatnonzero(~solid & (found.dash == dash) & (found.gap == gap))
        which, along = every((high - low)[rows], dash + gap, dash / 2 + 0.1)
        rows = rows[which]
        middles = low[rows] + along
        cut = pieces(lines, edge[rows], middles - dash / 2, middles + dash / 2)
        paint(rows, cut, LINE)
    return (np.concatenate(shapes), np.concatenate(edges)), np.concatenate(middle)


def _closing(street: Street, found: Partings, solid: BoolArray) -> list[IntArray]:
    """Broken lines that are unbroken before the junction at the start, and at the end of an edge.

    Lines between lanes of one direction are so only where their traffic arrives.
    """
    network, edge = street.network, found.edge
    begin, end = street.free
    junction = street.joint[network.edge_nodes] & (network.trim > 0)
    ruled = np.isin(street.kind, JUNCTION_LINES)[:, None] | street.signalled[network.edge_nodes]
    closed = junction & ruled & (_solid_length(end - begin) >= LEAST_SOLID)[:, None]
    return [
        np.flatnonzero(~solid & closed[edge, side] & (found.centre | (found.direction == arriving)))
        for side, arriving in ((0, -1), (1, 1))
    ]


def _solid_length(room: FloatArray) -> FloatArray:
    """Metres of unbroken line at each end of a free part, which leave dashes between them."""
    return np.asarray(np.minimum(SOLID, (room - DASHED) / 2))
