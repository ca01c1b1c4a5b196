"""Turn guides: broken lines across large junctions, beside turns, bends and through ways.

References
----------
Forschungsgesellschaft für Straßen- und Verkehrswesen, "Richtlinien für die Markierung von Straßen"
(RMS-1), 1993: broken lines in junctions beside those who turn left.
Japan Society of Traffic Engineers, manual on the design of intersections: lines on both sides of
those who turn right, and of ways that bend.
"""

from __future__ import annotations

import numpy as np
import shapely

from cityx.city.lanes import MOVEMENTS
from cityx.geometry.arrays import BoolArray, FloatArray, IntArray
from cityx.geometry.polylines import arc_lengths, every, line_strips, pieces
from cityx.road.markings.crossing_places import FLARE
from cityx.road.markings.marks import RANK, Marks, Shapes, Street
from cityx.road.markings.zebras import Zebras
from cityx.road.network.junction_ways import JunctionWays
from cityx.road.surface.carriageway import Carriageway
from cityx.road.surface.drops import patches

DASH, GAP, WIDTH = 1.0, 1.0, 0.12  # metres
# Square metres of a junction in which one may lose one's way, and in which who turns alone may too.
LEAST_AREA, WIDE_AREA = 300.0, 450.0
ASIDE = 1.5  # metres by which a lane goes on beside where it came from, to be led there
LEAST_LANES = 2  # of a road that is led along a bend; a single lane finds its way
PLAIN = 4  # directions of streets at a junction; amid more whoever goes straight on is led
LANE = 3.25  # metres; lines stand no farther apart
FROM_ENDS = 0.6  # metres of a way without lines at both ends
OFF_CROSSING = 0.4  # metres between a line and a crossing
OFF_TAKEN = 0.4  # metres between a line and other marks
APART = 0.25  # metres between two lines
LEAST_DASHES, LEAST_RUN = 4, 2  # of a line, and of each piece of it; fewer lead nobody


def turn_guides(
    street: Street, ways: JunctionWays, zebras: Zebras, road: Carriageway, taken: Shapes, sides: str
) -> Marks:
    """Paint broken lines along ways across large junctions under signals.

    Led are those who turn across the traffic that comes towards them from a lane of their own,
    where only the outer side has a line beside others who do or in wide junctions alone. Where both
    sides of a way have lines, those too who go on along a bend of a road of several lanes, or
    straight on where streets leave in more than four directions.
    No two ways with lines cross: that of the greater road is led.

    Parameters
    ----------
    street, road
        The network and its surfaces.
    ways
        The ways across its junctions.
    zebras
        Crossings, which stay free.
    taken
        Surfaces that stay free as well; a line goes on beyond them.
    sides
        "both" of a way, the "outer" of a turn, or "" for no lines.
    """
    nothing = np.zeros(0, object), np.zeros(0, np.int64)
    star = _large(street, road) if sides else np.zeros(0, np.int64)
    if not len(star):
        return nothing
    left_hand = bool(street.network.left_hand.any())
    far = MOVEMENTS.index("right" if left_hand else "left")
    turn = ways.movement == far
    led = np.isin(ways.hub, road.node[star])
    own = _own_lane(ways, far)
    wide = road.node[star][shapely.area(road.stars[star]) > WIDE_AREA]
    several = (_lanes(ways, own & turn) >= LEAST_LANES) | np.isin(ways.hub, wide)
    own &= (sides == "both") | several
    led &= np.where(turn, own, (sides == "both") & _onward(street, ways))
    # Where two would cross the first stays: who turns, on the greater road.
    rows = np.flatnonzero(led)
    rank = street.rank[ways.edge[rows]]
    rows = rows[np.lexsort((ways.target[rows], ways.origin[rows], rank, ~turn[rows]))]
    rows = rows[np.sort(np.unique(ways.origin[rows], return_index=True)[1])]
    if not len(rows):
        return nothing
    chosen = ways.take(rows)
    outer = 1.0 if left_hand else -1.0
    boxes = crossing_boxes(street, zebras)
    found = [
        _line(chosen, side, road.stars[star], ((boxes, 0.0), (taken, OFF_TAKEN)))
        for side in ((1.0, -1.0) if sides == "both" else (outer,))
    ]
    marks, own, whole = (np.concatenate(column) for column in zip(*found, strict=True))
    free = np.isin(own, _first_of_crossing(whole, np.tile(np.arange(len(rows)), len(found))))
    return marks[free], chosen.edge[own[free]]


def crossing_boxes(street: Street, zebras: Zebras) -> Shapes:
    """(z,) rectangles about crossings that reach past their kerbs."""
    reach = street.network.half_width[zebras.edge] + 2 * FLARE
    shapes = patches(street, zebras, np.arange(len(reach)), -reach, reach, OFF_CROSSING)
    return np.asarray(shapely.make_valid(shapes))


def _large(street: Street, road: Carriageway) -> IntArray:
    """Rows of the large junctions under signals."""
    ruled = np.isin(road.node, street.ruled_hubs)
    return np.flatnonzero(ruled & (shapely.area(road.stars) > LEAST_AREA))


def _own_lane(ways: JunctionWays, far: int) -> BoolArray:
    """(w,) whether those who make a turn have a lane in which nobody goes another way."""
    size = int(ways.origin.max(initial=0)) + 1
    all_of = np.bincount(ways.origin, minlength=size)
    turning = np.bincount(ways.origin[ways.movement == far], minlength=size)
    return np.asarray((all_of == turning)[ways.origin])


def _lanes(ways: JunctionWays, chosen: BoolArray) -> IntArray:
    """(w,) how many lanes of the arm that a way comes from have one of the chosen ways."""
    arm, of_arm = np.unique(np.column_stack([ways.edge, ways.end]), axis=0, return_inverse=True)
    pairs = np.column_stack([of_arm.ravel(), ways.origin])[chosen]
    lane = np.unique(pairs, axis=0)[:, 0]
    return np.asarray(np.bincount(lane, minlength=len(arm))[of_arm.ravel()])


def _onward(street: Street, ways: JunctionWays) -> BoolArray:
    """(w,) whether who goes straight on strays from a straight line or may take another arm for it.

    Where a lane leads on into several, only the way that strays least counts.
    """
    first, last = ways.line.start[:-1], ways.line.start[1:] - 1
    ahead = ways.line.points[first + 1] - ways.line.points[first]
    ahead = ahead / np.maximum(np.hypot(*ahead.T), 1e-9)[:, None]
    reach = ways.line.points[last] - ways.line.points[first]
    aside = np.abs(ahead[:, 0] * reach[:, 1] - ahead[:, 1] * reach[:, 0])
    through = ways.movement == MOVEMENTS.index("through")
    least = np.full(int(ways.origin.max(initial=0)) + 1, np.inf)
    np.minimum.at(least, ways.origin[through], aside[through])
    nearest = through & (aside <= least[ways.origin])
    best = np.full(len(street.cluster), len(RANK))
    np.minimum.at(best, street.cluster, street.best)
    major = street.rank[ways.edge] == best[ways.hub]
    lanes = _lanes(ways, np.ones(len(ways.edge), bool))
    bends = (aside > ASIDE) & (lanes >= LEAST_LANES)
    return np.asarray(nearest & major & (bends | (street.directions[ways.hub] > PLAIN)))


def _line(
    ways: JunctionWays, side: float, stars: Shapes, things: tuple[tuple[Shapes, float], ...]
) -> tuple[Shapes, IntArray, Shapes]:
    """Lay dashes on one side of each way where nothing else lies.

    Returns
    -------
    marks, own
        The dashes, and the way of each; ways with too few have none.
    whole
        (w,) each line from its first dash to its last; empty where it has none.
    """
    length = arc_lengths(ways.line)[1]
    own, along = every(length, DASH + GAP, FROM_ENDS + DASH / 2)
    lateral: FloatArray = side * np.minimum(ways.width, LANE) / 2
    cut = pieces(ways.line, own, along - DASH / 2, along + DASH / 2)
    marks = line_strips(cut, lateral[own], WIDTH)
    free = _covered(marks, stars)
    tree = shapely.STRtree(marks)
    for shapes, gap in things:
        free[tree.query(shapes, predicate="dwithin", distance=gap)[1]] = False
    run = np.cumsum(np.r_[True, (np.diff(own) != 0) | (free[1:] != free[:-1])][: len(own)]) - 1
    kept = free & (np.bincount(run)[run] >= LEAST_RUN)
    kept &= np.bincount(own[kept], minlength=len(length))[own] >= LEAST_DASHES
    begin, end = np.full(len(length), np.inf), np.full(len(length), -np.inf)
    np.minimum.at(begin, own[kept], along[kept] - DASH / 2)
    np.maximum.at(end, own[kept], along[kept] + DASH / 2)
    whole = np.full(len(length), shapely.Polygon(), object)
    rows = np.flatnonzero(end > begin)
    lines = pieces(ways.line, rows, begin[rows], end[rows])
    whole[rows] = shapely.make_valid(line_strips(lines, lateral[rows], WIDTH))
    return marks[kept], own[kept], whole


def _covered(marks: Shapes, surfaces: Shapes) -> BoolArray:
    """Mark what lies wholly on one of some surfaces."""
    found = shapely.is_valid(marks)
    inside = np.zeros(len(marks), bool)
    inside[shapely.STRtree(surfaces).query(marks, predicate="covered_by")[0]] = True
    return np.asarray(found & inside)


def _first_of_crossing(lines: Shapes, way: IntArray) -> IntArray:
    """Return the ways whose lines come near none of those of an earlier way that stays."""
    one, other = shapely.STRtree(lines).query(lines, predicate="dwithin", distance=APART)
    pair = np.unique(np.column_stack([way[one], way[other]]), axis=0)
    kept = np.zeros(int(way.max(initial=-1)) + 1, bool)
    for each in np.unique(way).tolist():
        met = pair[(pair[:, 0] == each) & (pair[:, 1] < each), 1]
        kept[each] = not kept[met].any()
    return np.flatnonzero(kept)
