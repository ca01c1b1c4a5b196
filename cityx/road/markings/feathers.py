"""Cycle arrowheads (feathers): rows that mark where bicycles ride on roads without a cycle lane.

References
----------
Ministry of Land, Infrastructure, Transport and Tourism and National Police Agency of Japan,
"Guideline for creating safe and comfortable environments for cycling", 2016: arrowheads 0.75 m wide
and 1.5 m long every 10 m along roads that cars and bicycles share, closer across junctions, with a
bicycle where a stretch begins.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import shapely

from cityx.city.lanes import MOVEMENTS
from cityx.city.section import KIND
from cityx.geometry.arrays import BoolArray, FloatArray, IntArray
from cityx.geometry.polylines import arc_lengths, every, locate
from cityx.road.markings.marks import RANK, Shapes, Street, paved_share
from cityx.road.markings.symbols import FEATHER, bicycle, feather, placed
from cityx.road.network.junction_ways import JunctionWays, kerbside
from cityx.road.surface.carriageway import Carriageway

LEAST_RANK = RANK.index("tertiary")  # and roads before it, but for motorways
EVERY, ACROSS = 10.0, 3.5  # metres between feathers along roads and across junctions
FROM_END = 4.0  # metres from where lines end to the first
FROM_WAY = 1.2  # metres of a way across a junction without feathers at both ends
FROM_LINE = 0.25  # metres from the middle of a line along the kerb to feathers
MARGIN = 1.15  # metres behind such a line in which one rides instead
LEAST_LANE = 2.75  # metres of a lane that bicycles share
SYMBOL = (1.25, 0.42)  # factors of the bicycle, along and across
BEHIND = 2.3  # metres from the foot of the bicycle to the middle of the first feather
APART = 0.1  # metres between feathers and other paint
WHOLE = 0.97  # share of a feather that lies on what is driven on


def feathers(
    street: Street,
    chosen: BoolArray,
    ways: JunctionWays,
    insets: FloatArray,
    road: Carriageway,
    taken: Shapes,
) -> tuple[Shapes, Shapes]:
    """Lay feathers along the kerbs of roads and straight across their junctions.

    Parameters
    ----------
    street, road
        The network and its surfaces.
    chosen
        (e,) bool, edges that may have them.
    ways
        The ways across its junctions.
    insets
        (e,) metres from kerbs to the lines along them.
    taken
        Other paint, which stays whole.

    Returns
    -------
    feathers, bicycles
        Polygons of either.
    """
    ranked = chosen & (street.rank <= LEAST_RANK) & (street.rank > RANK.index("motorway"))
    aside = np.where(insets > MARGIN, insets / 2, insets + FROM_LINE + FEATHER[1] / 2)
    lines, signs = _along(street, ranked, aside)
    across = _across(street, ranked, ways, aside)
    found = np.concatenate([lines, across])
    free = ~_near(found, taken) & (_paved(found, road) > WHOLE)
    # Where two rows cross the later one has a gap.
    one, other = shapely.STRtree(found).query(found, predicate="intersects")
    free[one[(other < one) & free[other]]] = False
    whole = ~_near(signs, np.concatenate([taken, found[free]]))
    return found[free], shapely.get_parts(signs[whole])


def _along(street: Street, ranked: BoolArray, aside: FloatArray) -> tuple[Shapes, Shapes]:
    """Feathers of lanes, and the bicycle behind the first of each lane."""
    network, bands = street.network, street.bands
    begin, end = street.free
    row = np.flatnonzero((bands.kind == KIND["drive"]) & (bands.direction != 0)
                         & ranked[bands.edge])  # fmt: skip
    own = bands.edge[row]
    outside, outer = kerbside(street, own, bands.direction[row], bands.left[row], bands.right[row])
    good = outside & (bands.width[row] > LEAST_LANE)
    row, own, outer = row[good], own[good], outer[good]
    which, place = every((end - begin)[own], EVERY, FROM_END)
    onward = bands.direction[row] > 0
    first = np.r_[True, np.diff(which) != 0][: len(which)]
    at = np.where(onward[which], begin[own[which]] + place, end[own[which]] - place)

    def put(outline: Any, rows: IntArray, along: FloatArray) -> Shapes:
        position, direction = locate(street.lines, own[rows], along)
        sign = np.where(onward[rows], 1.0, -1.0)
        lateral = (outer * (network.half_width - aside)[own])[rows] * sign
        return placed(outline, position, direction * sign[:, None], lateral)

    back = np.where(onward, -BEHIND, BEHIND)[which[first]]
    parts = put(_sign(), which[first], at[first] + back)
    each = np.repeat(np.arange(len(back)), len(parts) // max(len(back), 1))
    signs = shapely.multipolygons(parts, indices=each) if len(parts) else parts
    return put(feather(), which, at), np.asarray(signs, object)


def _across(street: Street, ranked: BoolArray, ways: JunctionWays, aside: FloatArray) -> Shapes:
    """Feathers of those who go straight on across junctions from a lane along the kerb."""
    rows = ways.kerbside & ranked[ways.edge] & (ways.width > LEAST_LANE)
    rows &= ways.movement == MOVEMENTS.index("through")
    chosen = ways.take(rows)
    length = arc_lengths(chosen.line)[1]
    way, place = every(length, ACROSS, FROM_WAY + FEATHER[0] / 2)
    position, direction = locate(chosen.line, way, place)
    outer = np.where(street.network.left_hand[chosen.edge], 1.0, -1.0)
    lateral = np.asarray(outer * (chosen.width / 2 - aside[chosen.edge]), float)
    return placed(feather(), position, direction, lateral[way])


def _sign() -> Any:
    """Return the bicycle that tells whom feathers lead, a foot behind the first of them."""
    return shapely.affinity.scale(bicycle(), *SYMBOL, origin=(0, 0))


def _near(shapes: Shapes, things: Shapes) -> BoolArray:
    found = np.zeros(len(shapes), bool)
    found[shapely.STRtree(things).query(shapes, predicate="dwithin", distance=APART)[0]] = True
    return found


def _paved(shapes: Shapes, road: Carriageway) -> FloatArray:
    return paved_share(shapes, road.stars, road.strips, road.curves)
