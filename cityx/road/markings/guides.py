"""Guide lines of major roads and of cycle lanes across junctions."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import shapely
import shapely.affinity

from cityx.geometry.arrays import BoolArray, FloatArray, IntArray
from cityx.geometry.polylines import Polylines, arc_lengths, every, line_strips, locate, pieces
from cityx.geometry.ranges import numbered
from cityx.road.markings.lane_lines import Partings
from cityx.road.markings.marks import LINE, Marks, Shapes, Street, paved_share
from cityx.road.markings.symbols import bicycle, placed
from cityx.road.network.through_roads import Through, across_junctions
from cityx.road.surface.carriageway import Carriageway, joined_by

DASH, GAP = 1.0, 1.0  # metres of the lines of a road that goes straight on
CYCLE_DASH, CYCLE_GAP = 0.5, 0.5  # metres beside bicycles that cross (German Furt, Dutch blocks)
CYCLE_LINE = 0.15  # metres, width of these
FURT_GAP = 0.05  # metres between these and the coloured surface between them
CYCLE_WAY = 1.3  # metres between the two lines
LONGEST = 60.0  # metres across a junction; farther apart no line leads
WHOLE = 0.97  # share of a mark that lies on what is driven on
STEPS = 8  # pieces of a line that bends
# Of the bicycle at the beginning of a coloured way: metres from where it begins, factors along and
# across, and metres of way that has one.
SYMBOL_AT, SYMBOL, LEAST_SYMBOL = 1.2, (1.7, 0.58), 7.0
ROLES = 4096  # what the lines of a road part, told apart by number


def guide_lines(
    street: Street,
    found: Partings,
    through: Through,
    painted: BoolArray,
    road: Carriageway,
    *,
    stems: bool,
) -> tuple[Marks, BoolArray, Shapes]:
    """Continue the lines of major roads and of cycle lanes across junctions.

    Lines beside cycle lanes go on everywhere, with a bicycle where they begin, those between lanes
    of equal number and between the directions only past a single side street where nothing halts
    their traffic. Where `stems` of
    equals give way, the road they end at is major too. Also returns which part the two directions,
    and the surfaces between the lines beside cycle lanes.
    """
    through = across_junctions(street, through)
    major = through.major | (through.tee & stems)
    chosen = np.flatnonzero(major & painted[through.edge].all(axis=1))
    first, second, row = _continued(street, found, through, chosen)
    # A lane of bicycles has a line on either side, so that its way across is seen as one.
    beyond = replace(found, lateral=found.lateral + CYCLE_WAY * np.sign(found.lateral))
    inner, outer = (
        _curves(street, each, through, chosen[row], first, second) for each in (found, beyond)
    )
    shapes, edges, centre = [np.zeros(0, object)], [np.zeros(0, np.int64)], [np.zeros(0, bool)]
    for lines, cycle, dash, gap, width in (
        (inner, False, DASH, GAP, LINE), (inner, True, CYCLE_DASH, CYCLE_GAP, CYCLE_LINE),
        (outer, True, CYCLE_DASH, CYCLE_GAP, CYCLE_LINE),
    ):  # fmt: skip
        length = arc_lengths(lines)[1]
        good = (length > DASH) & (length < LONGEST)
        own = np.flatnonzero(good & (found.cycle[first] == cycle))
        which, along = every(length[own], dash + gap, dash / 2 + gap / 2)
        own = own[which]
        cut = pieces(lines, own, along - dash / 2, along + dash / 2)
        shapes.append(line_strips(cut, np.zeros(len(own)), width))
        edges.append(found.edge[first[own]])
        centre.append(found.centre[first[own]])
    ways = np.flatnonzero(good & found.cycle[first])
    entry = through.edge[chosen[row[ways]], 0], through.side[chosen[row[ways]], 0]
    sign = np.where(entry[1] == 0, -1, 1) * np.where(street.network.left_hand[entry[0]], -1, 1)
    symbols, own = _bicycles(inner, outer, ways, found.lateral[first[ways]] * sign < 0)
    shapes.append(symbols)
    edges.append(found.edge[first[own]])
    centre.append(np.zeros(len(own), bool))
    marks, middle = np.concatenate(shapes), np.concatenate(centre)
    paved = paved_share(marks, road.stars, road.strips, road.curves) > WHOLE
    between = _between(inner, outer, ways, road)
    return (marks[paved], np.concatenate(edges)[paved]), middle[paved], between


def _bicycles(
    inner: Polylines, outer: Polylines, rows: IntArray, onward: BoolArray
) -> tuple[Shapes, IntArray]:
    """Paint a bicycle where the ways between two lines begin, `onward` or at their other ends.

    Short ways have none; also returns the row of each part of one.
    """
    near, far = (each.points.reshape(-1, STEPS + 1, 2)[rows] for each in (inner, outer))
    middle = (near + far) / 2
    long = np.hypot(*(middle[:, -1] - middle[:, 0]).T) >= LEAST_SYMBOL
    rows, middle, onward = rows[long], middle[long], onward[long]
    middle = np.where(onward[:, None, None], middle, middle[:, ::-1])
    ahead = middle[:, 1] - middle[:, 0]
    ahead = ahead / np.maximum(np.hypot(*ahead.T), 1e-9)[:, None]
    outline = shapely.affinity.scale(bicycle(), *SYMBOL, origin=(0, 0))
    made = placed(outline, middle[:, 0] + SYMBOL_AT * ahead, ahead, np.zeros(len(rows)))
    return made, np.repeat(rows, len(made) // max(len(rows), 1))


def _between(inner: Polylines, outer: Polylines, rows: IntArray, road: Carriageway) -> Shapes:
    """Return what is driven on between two lines of equally many points."""
    if not len(rows):
        return np.zeros(0, object)
    near, far = (each.points.reshape(-1, STEPS + 1, 2)[rows] for each in (inner, outer))
    rings = np.concatenate([near, far[:, ::-1]], axis=1)
    shapes = shapely.buffer(shapely.polygons(rings), -CYCLE_LINE / 2 - FURT_GAP)
    surfaces = np.concatenate([road.stars, road.curves, road.strips])
    row, surface = shapely.STRtree(surfaces).query(shapes, predicate="intersects")
    paved, own = joined_by(surfaces[surface], row)
    return np.asarray(shapely.get_parts(shapely.intersection(shapes[own], paved)))


def _continued(
    street: Street, found: Partings, through: Through, chosen: IntArray
) -> tuple[IntArray, IntArray, IntArray]:
    """Pair the lines of both arms: rows of `found` before and behind, and the row of `chosen`."""
    sides: list[tuple[IntArray, IntArray]] = []
    for arm, leaving in ((0, False), (1, True)):
        edge, side = through.edge[chosen, arm], through.side[chosen, arm]
        # Seen as one travels from the first arm into the second.
        onward = np.where((side == 0) == leaving, 1, -1)
        low = np.searchsorted(found.edge, edge)
        size = np.searchsorted(found.edge, edge, side="right") - low
        pair = np.repeat(np.arange(len(edge)), size)
        line = low[pair] + numbered(size)
        sides.append((_roles(found, pair, line, onward[pair]), line))
    (keys, lines), (other_keys, other_lines) = sides
    _, here, there = np.intersect1d(keys, other_keys, return_indices=True)
    first, second = lines[here], other_lines[there]
    row = keys[here] // ROLES
    pair = chosen[row]
    zebra = street.marked[through.edge[pair], through.side[pair]].any(axis=1)
    halted = street.signalled[through.node[pair]] | zebra
    # Beside a single side street; where roads cross, and under signals, lines end at the junction.
    node = through.node[pair]
    passed = (street.network.node_degree[node] == 3) & ~halted
    passed &= street.arms[street.cluster[node]] == 3
    lanes = found.centre[first] | ~found.mixed[first]
    kept = found.cycle[first] | (passed & lanes)
    return first[kept], second[kept], row[kept]


def _roles(found: Partings, pair: IntArray, line: IntArray, onward: IntArray) -> IntArray:
    """Return the (k,) pair and role of each line, the same number before and behind a junction.

    Lines between lanes count from the right among those of their direction, and only roads with
    equally many have the same.
    """
    centre, cycle = found.centre[line], found.cycle[line]
    lateral = found.lateral[line] * onward
    ahead = found.direction[line] * onward > 0
    kind = np.select([centre, cycle & (lateral > 0), cycle], [0, 1, 2], 3 + ahead)
    group = pair * 8 + kind
    order = np.lexsort((lateral, group))
    place = np.empty(len(line), np.int64)
    begin = np.searchsorted(group[order], group[order])
    place[order] = np.arange(len(line)) - begin
    count = np.bincount(group, minlength=1)[group] if len(group) else group
    return np.asarray(pair * ROLES + kind * 512 + np.minimum(count, 15) * 32 + place)


def _curves(
    street: Street, found: Partings, through: Through, pair: IntArray, first: IntArray,
    second: IntArray,
) -> Polylines:  # fmt: skip
    """Cubic curves from the ends of lines to those that continue them."""
    a, ahead = _ends(street, found, through, pair, 0, first)
    d, back = _ends(street, found, through, pair, 1, second)
    handle = np.hypot(*(d - a).T)[:, None] / 3
    b, c = a + ahead * handle, d + back * handle
    t = (np.arange(STEPS + 1) / STEPS)[None, :, None]
    p, q, r, s = (point[:, None] for point in (a, b, c, d))
    curve = (1 - t) ** 3 * p + 3 * (1 - t) ** 2 * t * q + 3 * (1 - t) * t**2 * r + t**3 * s
    start = np.arange(len(first) + 1, dtype=np.int64) * (STEPS + 1)
    return Polylines(np.round(curve.reshape(-1, 2), 6), start)


def _ends(
    street: Street, found: Partings, through: Through, pair: IntArray, arm: int, line: IntArray
) -> tuple[FloatArray, FloatArray]:
    """Where lines end at the junction, and the unit vectors on into it, (k, 2) each."""
    network = street.network
    edge, side = found.edge[line], through.side[pair, arm]
    free = np.where(side == 0, street.free[0][edge], street.length[edge] - street.free[1][edge])
    back = np.where(street.marked[edge, side], network.trim[edge, side], free)
    back += np.where(street.marked, np.minimum(street.setback, 0.0), 0.0)[edge, side]
    along = np.where(side == 0, back, street.length[edge] - back)
    position, direction = locate(street.lines, edge, along)
    left = np.column_stack([-direction[:, 1], direction[:, 0]])
    into = np.where(side == 0, -1.0, 1.0)[:, None]
    return position + left * found.lateral[line][:, None], direction * into
