"""Hatched areas amid wide junctions, which nobody drives over on the way from arm to arm."""

from __future__ import annotations

from typing import Any

import numpy as np
import shapely

from cityx.geometry.polylines import locate
from cityx.plugins.road.carriageway import Carriageway
from cityx.plugins.road.crossing_places import FLARE
from cityx.plugins.road.drops import patches
from cityx.plugins.road.marks import (
    LINE,
    BoolArray,
    FloatArray,
    IntArray,
    Shapes,
    Street,
    hatched,
    lane_count,
    spans_of,
)
from cityx.plugins.road.network import junction_clusters
from cityx.plugins.road.zebras import Zebras

WIDEST = 260.0  # square metres; a larger junction may have areas that nobody drives over
LEAST_ARMS = 4
LEAST_AREA, LEAST_HALF = 5.0, 0.6  # square metres, and metres of half width, of a hatched area
HALF_LANE = 1.5  # metres to either side of the middle of the way of one lane
BESIDE = 0.35  # metres between a way and an area
FROM_KERB = 0.4  # metres between an area and the rim of the junction
HATCH = (0.45, 1.35)  # metres: width and spacing of the bars
HANDLE, STEPS = 0.38, 12  # of the curves across, share of the chord and pieces
OFF_CROSSING = 0.8  # metres between an area and a crossing


def no_go_areas(street: Street, zebras: Zebras, painted: BoolArray, road: Carriageway) -> Shapes:
    """Return the paint of hatched areas, one shape per junction that has any.

    They are what remains of the surface of a junction beside the ways from each arm on which
    traffic arrives to each on which it leaves, away from kerbs and crossings.
    """
    wide = np.flatnonzero(shapely.area(road.stars) > WIDEST)
    if not len(wide):
        return np.zeros(0, object)
    network = street.network
    cluster = junction_clusters(network)[network.edge_nodes]
    inside = cluster[:, 0] == cluster[:, 1]
    edge, end = np.nonzero((painted & ~inside)[:, None] & np.isin(cluster, road.node[wide]))
    hub = cluster[edge, end]
    place, inward, half = _gates(street, edge, end)
    crossings = _crossing_boxes(street, zebras)
    tree = shapely.STRtree(crossings)
    found = []
    for star, node in zip(road.stars[wide], road.node[wide], strict=True):
        rows = np.flatnonzero(hub == node)
        if len(rows) < LEAST_ARMS:
            continue
        near = crossings[tree.query(star, predicate="intersects")]
        area = _area(star, place[:, rows], inward[:, rows], half[:, rows], near)
        if not shapely.is_empty(area):
            found.append(_paint(area))
    return np.array(found, object)


def _gates(
    street: Street, edge: IntArray, end: IntArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Where traffic comes from arms (row 0) and goes into them (row 1).

    Returns
    -------
    place, inward, half
        (2, k, 2) middles of the lanes and unit vectors into the junction, (2, k) metres to either
        side; NaN where nobody goes.
    """
    network = street.network
    back = network.trim[edge, end]
    along = np.where(end == 0, back, street.length[edge] - back)
    position, ahead = locate(street.lines, edge, along)
    left = np.column_stack([-ahead[:, 1], ahead[:, 0]])
    into = ahead * np.where(end == 0, -1.0, 1.0)[:, None]
    places, halves = [], []
    spans = {way: spans_of(street.bands, network.edge_count, way) for way in (1, -1, 0)}
    lanes = {way: lane_count(street.bands, network.edge_count, way) for way in (1, -1, 0)}
    for arriving in (True, False):
        forward = (end == 1) == arriving
        low = np.where(forward, spans[1][0][edge], spans[-1][0][edge])
        high = np.where(forward, spans[1][1][edge], spans[-1][1][edge])
        low, high = np.minimum(low, spans[0][0][edge]), np.maximum(high, spans[0][1][edge])
        there = high > low
        half = np.where(there, (high - low) / 2, np.nan)
        middle = np.where(there, (np.where(there, low, 0) + np.where(there, high, 0)) / 2, np.nan)
        places.append(position + left * middle[:, None])
        count = np.where(forward, lanes[1][edge], lanes[-1][edge]) + lanes[0][edge]
        halves.append(np.minimum(half, HALF_LANE * np.maximum(count, 1)))
    return np.stack(places), np.stack([into, into]), np.stack(halves)


def _crossing_boxes(street: Street, zebras: Zebras) -> Shapes:
    """(z,) rectangles about crossings that reach past their kerbs."""
    reach = street.network.half_width[zebras.edge] + 2 * FLARE
    shapes = patches(street, zebras, np.arange(len(reach)), -reach, reach, OFF_CROSSING)
    return np.asarray(shapely.make_valid(shapes))


def _area(star: Any, place: FloatArray, inward: FloatArray, half: FloatArray, near: Shapes) -> Any:
    """Return what ways from arm to arm leave of the surface of a junction."""
    one, other = np.nonzero(~np.eye(half.shape[1], dtype=bool))
    driven = ~np.isnan(half[0, one]) & ~np.isnan(half[1, other])
    one, other = one[driven], other[driven]
    a, d = place[0, one], place[1, other]
    chord = HANDLE * np.hypot(*(d - a).T)[:, None]
    b, c = a + inward[0, one] * chord, d + inward[1, other] * chord
    t = np.linspace(0.0, 1.0, STEPS + 1)[None, :, None]
    p, q, r, s = (point[:, None] for point in (a, b, c, d))
    curve = (1 - t) ** 3 * p + 3 * (1 - t) ** 2 * t * q + 3 * (1 - t) * t**2 * r + t**3 * s
    swept = shapely.buffer(
        shapely.linestrings(curve),
        np.maximum(half[0, one], half[1, other]) + BESIDE, quad_segs=4,
    )  # fmt: skip
    free = shapely.buffer(star, -FROM_KERB)
    taken = shapely.union_all(np.concatenate([swept, near]))
    rest = shapely.difference(free, taken)
    # Narrow ends are left out, and corners rounded.
    rest = shapely.buffer(shapely.buffer(rest, -LEAST_HALF), LEAST_HALF - 0.1, quad_segs=4)
    parts = shapely.get_parts(rest)
    return shapely.union_all(parts[shapely.area(parts) > LEAST_AREA])


def _paint(area: Any) -> Any:
    """Rim and bars of an area."""
    width, spacing = HATCH
    rim = shapely.difference(area, shapely.buffer(area, -1.5 * LINE))
    bars = hatched(area, np.sqrt(0.5) * np.array([1.0, -1.0]), spacing, width)
    return shapely.union_all([rim, bars])
