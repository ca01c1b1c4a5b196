"""Stop line and give-way line markings, and the words and triangles before them."""

from __future__ import annotations

from typing import Any

import numpy as np
import shapely

from cityx.city.section import KIND, TRAVELLED
from cityx.geometry.arrays import BoolArray, FloatArray, IntArray
from cityx.geometry.polylines import every, locate
from cityx.places.painting import Painting
from cityx.road.markings.crossing_places import BEFORE
from cityx.road.markings.marks import (
    LINE,
    Marks,
    Street,
    boxes,
    near_any_of,
    paved_share,
    spans_of,
    together,
)
from cityx.road.markings.symbols import give_way_triangle, placed, word
from cityx.road.network.signal_places import signal_places
from cityx.road.network.through_roads import Through, stems
from cityx.road.surface.carriageway import Carriageway
from cityx.road.surface.roundabouts import ring_edges, ring_nodes

# Depth and width of a mark, the gap after it, and how far behind a second row begins, metres.
TOOTH = (0.6, 0.5, 0.4, 0.0)
GIVE_WAY = (0.3, 0.5, 0.25, 0.0)
DOUBLE = (0.2, 0.6, 0.3, 0.5)  # TSRGD 2016, diagram 1003
ACROSS_EXIT = (0.1, 0.6, 0.3, 0.0)  # diagram 1009: the edge of the road that a mouth opens to
MOUTH_GAP = 0.2  # metres from the mouth of a minor road to the line
BEFORE_SETTS = 0.9  # metres that the line begins ahead of setts across a mouth
PAST_SETTS = 0.4  # metres between them and a triangle or a word
RING_GAP = 0.3  # metres from a roundabout to the line of those who enter
YIELDING = 4  # rank of a road to which every lower one gives way
BEFORE_LINE, LEAST_BEFORE = 1.2, 1.0  # metres from the line to the middle one, and of that
FLARED = 2.5  # metres that a line at a mouth may be longer for the curves of its kerbs
WHOLE = 0.97  # share of a mark that lies on the carriageway
BEHIND_LINE = 2.1  # metres from the line to a triangle or a word
LEAST_ROOM = 8.0  # metres of street that a triangle or a word needs, the line before it included
LEAST_LANE = 2.4  # metres of a lane with a triangle or a word
_MOVING = [KIND[name] for name in TRAVELLED]


def halt_lines(
    street: Street, chosen: BoolArray, painting: Painting, through: Through, road: Carriageway,
    setts: FloatArray | None = None,
) -> Marks:  # fmt: skip
    """Lines where traffic that arrives halts or gives way.

    A stop line lies before signals, stop signs and the zebras of a junction; at the mouths of
    minor roads and of the arms of a roundabout it is what the country paints to give way. Where
    `setts` lie across a mouth, from and to metres off its node (e, 2, 2), it lies ahead of them,
    and words and triangles behind.
    """
    network = street.network
    laid = np.full((network.edge_count, 2, 2), np.nan) if setts is None else setts
    layout, length = street.layout, street.length
    ring, on_ring = ring_edges(layout, network), ring_nodes(layout, network)
    spots = shapely.points(network.node_position)
    signs = layout.points.geometry.to_numpy()[(layout.points["kind"] == "stop").to_numpy()]
    ruled = near_any_of(spots, np.concatenate([signal_places(layout), signs]))
    ending = stems(street, through) & painting.stems
    found = []
    for end in (0, 1):
        node = network.edge_nodes[:, end]
        enters = on_ring[node] & ~ring
        minor = (street.rank > street.best[node]) & (street.best[node] <= YIELDING)
        minor = ((minor | ending[:, end]) & ~ring) | enters
        zebra = street.marked[:, end]
        stops = chosen & (network.node_degree[node] >= 3)
        stops &= minor | zebra | street.signalled[node]
        # Only where lanes arrive at this end: not at the start of a one-way street.
        low, high = _arriving(street, end)
        stops &= high > low
        behind = network.trim[:, end] + np.where(zebra, street.halt[:, end], BEFORE)
        # Where the zebra stands back from a ring, one gives way between the two.
        behind = np.where(enters, network.trim[:, end] + RING_GAP, behind)
        yields = minor & ~ruled[node] & (~zebra | enters)
        # Those who give way come up to the road they meet.
        front, back = laid[:, end].T
        paved = np.isfinite(front) & yields & ~enters
        at_mouth = np.where(paved, front - BEFORE_SETTS, street.mouth[:, end] + MOUTH_GAP)
        behind = np.where(yields & ~enters, at_mouth, behind)
        # The line reaches the kerb, also where cars are parked before, or where it has curved away.
        reaches = yields & (painting.give_way != "stop")
        flared = reaches & ~enters
        kerb = network.half_width + np.where(flared, FLARED, 0.0)
        on_right = network.left_hand == (end == 0)
        right = np.where(reaches & on_right, -kerb, low)
        left = np.where(reaches & ~on_right, kerb, high)
        plain = stops & ~(yields & (painting.give_way != "stop"))
        lines = [(plain, "stop", right, left), (stops & ~plain, painting.give_way, right, left)]
        if painting.give_way == "double dashes":  # and across the half of those who leave
            exit_ = np.where(on_right, left, -kerb), np.where(on_right, kerb, right)
            lines.append((stops & flared, "exit", *exit_))
        for rows, shape, begin, stop in lines:
            edge = np.flatnonzero(rows)
            span = behind[edge], begin[edge], stop[edge]
            marks, of = _line_across(street, edge, end, *span, shape, painting.stop_line)
            if shape != "stop":
                whole = paved_share(marks, road.stars, road.strips, road.curves) > WHOLE
                marks, of = marks[whole], of[whole]
            found.append((marks, of))
        if painting.give_way == "double dashes":
            plain = stops & flared & ~paved
            found.append(_line_before(street, plain, end, behind, low, high))
        past = np.where(paved, back + PAST_SETTS - BEHIND_LINE - behind, 0.0)
        roomy = length - network.trim.sum(axis=1) > LEAST_ROOM + past
        roomy &= stops & yields & ~enters & (high > low + LEAST_LANE)
        edge, middle = _arriving_lanes(street, end, roomy, low, high)
        found.append(_told(street, edge, end, (behind + past)[edge], middle, painting))
    return together(found)


def _arriving(street: Street, end: int) -> tuple[FloatArray, FloatArray]:
    """(e,) bounds of the lanes that arrive at an end; of a lane for both ways its own half."""
    bands, network = street.bands, street.network
    low, high = spans_of(bands, network.edge_count, 1 if end == 1 else -1)
    rows = np.flatnonzero(np.isin(bands.kind, _MOVING) & (bands.direction == 0))
    edge = bands.edge[rows]
    # Along the edge one keeps to its right, against it to its left; left-hand traffic the reverse.
    on_left = (end == 0) != network.left_hand[edge]
    low[edge] = np.where(on_left, bands.middle[rows], bands.right[rows])
    high[edge] = np.where(on_left, bands.left[rows], bands.middle[rows])
    return low, high


def _arriving_lanes(
    street: Street, end: int, chosen: BoolArray, low: FloatArray, high: FloatArray
) -> tuple[IntArray, FloatArray]:
    """Edge and middle of each wide lane that arrives at an end; where none does, of all at once."""
    bands = street.bands
    lane = np.isin(bands.kind, _MOVING) & (bands.direction == (1 if end == 1 else -1))
    lane &= chosen[bands.edge] & (bands.left - bands.right >= LEAST_LANE)
    shared = chosen.copy()
    shared[bands.edge[lane]] = False
    edge = np.concatenate([bands.edge[lane], np.flatnonzero(shared)])
    return edge, np.concatenate([bands.middle[lane], (low[shared] + high[shared]) / 2])


def _line_across(
    street: Street, edge: IntArray, end: int, behind: FloatArray, low: FloatArray,
    high: FloatArray, shape: str, breadth: float,
) -> Marks:  # fmt: skip
    """Paint where lanes that arrive halt or give way: a stop line, triangles or rows of dashes."""
    lines, length = street.lines, street.length
    sign = 1.0 if end == 0 else -1.0
    if shape == "stop":
        back = behind + breadth / 2
        along = back if end == 0 else length[edge] - back
        return boxes(lines, edge, along, (low + high) / 2, breadth, high - low - 0.3)
    row = {"teeth": TOOTH, "dashes": GIVE_WAY, "double dashes": DOUBLE, "exit": ACROSS_EXIT}[shape]
    depth, size, gap, second = row
    which, at = every(high - low, size + gap, size / 2 + 0.15)
    edge, behind, lateral = edge[which], behind[which], low[which] + at
    back = behind + depth / 2
    along = back if end == 0 else length[edge] - back
    if shape != "teeth":
        rows = [boxes(lines, edge, along + sign * more, lateral, depth, np.full(len(edge), size))
                for more in ((0.0, second) if second else (0.0,))]  # fmt: skip
        return together(rows)
    position, direction = locate(lines, edge, along)
    across = np.column_stack([-direction[:, 1], direction[:, 0]])
    centre = position + across * lateral[:, None]
    # The tips point at those who arrive.
    tip = direction * (sign * depth / 2)
    base = across * (size / 2)
    corners = np.stack([centre + tip, centre - tip + base, centre - tip - base], axis=1)
    return np.asarray(shapely.polygons(corners)), edge


def _line_before(
    street: Street, chosen: BoolArray, end: int, behind: FloatArray, low: FloatArray,
    high: FloatArray,
) -> Marks:  # fmt: skip
    """Continue the middle line of minor roads, which ends at the junction, to their line."""
    network = street.network
    leaving = spans_of(street.bands, network.edge_count, -1 if end == 1 else 1)
    near = behind + BEFORE_LINE
    size = network.trim[:, end] + 1.0 - near
    edge = np.flatnonzero(chosen & (leaving[1] > leaving[0]) & (size > LEAST_BEFORE))
    inner = np.where(street.network.left_hand == (end == 0), high, low)[edge]
    back = (near + size / 2)[edge]
    along = back if end == 0 else street.length[edge] - back
    return boxes(street.lines, edge, along, inner, size[edge], np.full(len(edge), LINE))


def _told(
    street: Street, edge: IntArray, end: int, behind: FloatArray, lateral: FloatArray,
    painting: Painting,
) -> Marks:  # fmt: skip
    """Paint what the country writes behind the line of a minor road."""
    outline = _legend(painting)
    if outline is None or not len(edge):
        return np.zeros(0, object), np.zeros(0, np.int64)
    sign = 1.0 if end == 0 else -1.0
    back = behind + BEHIND_LINE + shapely.bounds(outline)[2]
    along = back if end == 0 else street.length[edge] - back
    position, direction = locate(street.lines, edge, along)
    made = placed(outline, position, -sign * direction, -sign * lateral)
    return made, np.repeat(edge, len(made) // len(edge))


def _legend(painting: Painting) -> Any:
    if painting.give_way == "double dashes":
        return give_way_triangle()
    return word(painting.stop_word) if painting.stop_word else None
