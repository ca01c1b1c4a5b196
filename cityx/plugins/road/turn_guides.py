"""Broken lines that lead those who turn, or who find no straight way, across large junctions.

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
from cityx.geometry.polylines import arc_lengths, every, line_strips, pieces
from cityx.plugins.road.carriageway import Carriageway
from cityx.plugins.road.crossing_places import FLARE
from cityx.plugins.road.drops import patches
from cityx.plugins.road.junction_ways import JunctionWays
from cityx.plugins.road.marks import (
    RANK,
    BoolArray,
    FloatArray,
    IntArray,
    Marks,
    Shapes,
    Street,
)
from cityx.plugins.road.zebras import Zebras

DASH, GAP, WIDTH = 1.0, 1.0, 0.12  # metres
LEAST_AREA = 200.0  # square metres of a junction in which one may lose one's way
MANY_ARMS = 5  # arms from which on even the way straight on is marked
ASIDE = 0.8  # metres by which a lane goes on beside where it came from, to be led there
LANE = 3.25  # metres; lines stand no farther apart
FROM_ENDS = 0.6  # metres of a way without lines at both ends
OFF_CROSSING = 0.4  # metres between a line and a crossing
OFF_TAKEN = 0.4  # metres between a line and other marks
APART = 0.25  # metres between two lines


def turn_guides(
    street: Street, ways: JunctionWays, zebras: Zebras, road: Carriageway, taken: Shapes, sides: str
) -> Marks:
    """Paint broken lines along ways across large junctions under signals.

    Led are those who turn across the traffic that comes towards them from a lane of their own,
    and those who go on but find their lane aside, or more than four arms.

    Parameters
    ----------
    street, road
        The network and its surfaces.
    ways
        The ways across its junctions.
    zebras
        Crossings, which stay free.
    taken
        Surfaces that stay free as well.
    sides
        "both" of a way, the "outer" of a turn, or "" for no lines.
    """
    nothing = np.zeros(0, object), np.zeros(0, np.int64)
    star = _large(street, road) if sides else np.zeros(0, np.int64)
    if not len(star):
        return nothing
    far = MOVEMENTS.index("right" if street.network.left_hand.any() else "left")
    turn = ways.movement == far
    led = np.isin(ways.hub, road.node[star])
    led &= np.where(turn, _own_lane(ways, far), _strays(street, ways))
    # The first come first where two lines would meet: who turns, on the greater road.
    rank = street.rank[ways.edge]
    rows = np.flatnonzero(led)
    rows = rows[np.lexsort((ways.origin[rows], rank[rows], ~turn[rows]))]
    if not len(rows):
        return nothing
    chosen = ways.take(rows)
    shapes, edges = [], []
    outer = 1.0 if street.network.left_hand.any() else -1.0
    for side in (1.0, -1.0):
        own = np.arange(len(rows))
        if sides == "outer" and side != outer:
            own = own[chosen.movement != far]
        marks, of = _dashes(chosen, own, side)
        shapes.append(marks)
        edges.append(of)
    marks, edge = np.concatenate(shapes), np.concatenate(edges)
    free = _covered(marks, road.stars[star])
    boxes = crossing_boxes(street, zebras)
    tree = shapely.STRtree(marks)
    for things, gap in ((boxes, 0.0), (taken, OFF_TAKEN)):
        free[tree.query(things, predicate="dwithin", distance=gap)[1]] = False
    marks, edge = marks[free], edge[free]
    first = _first_of_near(marks)
    return marks[first], edge[first]


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


def _strays(street: Street, ways: JunctionWays) -> BoolArray:
    """(w,) whether who goes straight on is to be led: not along a straight line, or by many arms.

    Where a lane leads on into several, only the way that strays least counts; on minor roads, none
    but by many arms.
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
    return np.asarray(nearest & ((street.arms[ways.hub] >= MANY_ARMS) | ((aside > ASIDE) & major)))


def _dashes(ways: JunctionWays, own: IntArray, side: float) -> tuple[Shapes, IntArray]:
    """Dashes on one side, 1 for the left, of some ways, and the edges that they come from."""
    length = arc_lengths(ways.line)[1][own]
    which, along = every(length, DASH + GAP, FROM_ENDS + DASH / 2)
    own = own[which]
    cut = pieces(ways.line, own, along - DASH / 2, along + DASH / 2)
    lateral: FloatArray = side * np.minimum(ways.width[own], LANE) / 2
    return line_strips(cut, lateral, WIDTH), ways.edge[own]


def _covered(marks: Shapes, surfaces: Shapes) -> BoolArray:
    """Mark what lies wholly on one of some surfaces."""
    found = shapely.is_valid(marks)
    inside = np.zeros(len(marks), bool)
    inside[shapely.STRtree(surfaces).query(marks, predicate="covered_by")[0]] = True
    return np.asarray(found & inside)


def _first_of_near(marks: Shapes) -> BoolArray:
    """Mark what stands near no earlier mark that stays."""
    one, other = shapely.STRtree(marks).query(marks, predicate="dwithin", distance=APART)
    earlier = other < one
    kept = np.ones(len(marks), bool)
    order = np.lexsort((other[earlier], one[earlier]))
    for mark, before in zip(one[earlier][order].tolist(), other[earlier][order].tolist(),
                            strict=True):  # fmt: skip
        kept[mark] &= not kept[before]
    return kept
