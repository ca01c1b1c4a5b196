"""Signal warrant: where a junction needs signals although the map has none."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city.layout import joined_tables, make_table
from cityx.geometry.arrays import BoolArray, FloatArray
from cityx.geometry.polylines import arc_lengths
from cityx.ground.walking.mapped_crossings import mapped_crossings
from cityx.ids import hash_ids
from cityx.road.markings.crossing_places import MAIN, at_ends, dense_places
from cityx.road.network.signal_places import signal_places

if TYPE_CHECKING:
    from geopandas import GeoDataFrame

    from cityx.city.layout import Layout
    from cityx.city.roads import RoadNetwork


NO_STREET = ("service", "track", "living_street", "busway", "bus_guideway", "raceway", "road")
FAST = ("motorway", "trunk", "motorway_link", "trunk_link")
MAIN_ARMS, STREETS = 3, 4  # of classified roads, and of all, that cross
MANY, CROSSED = 5, 4  # streets that meet at one place, and how many of them the map has crossed
SIGNAL_GAP = 60.0  # metres from a warranted junction to the next signals
RULED = 20.0  # metres from it to a sign of the map that rules it
TOLD = 0.3  # share of crossings of classified roads with signals from which a map knows them


def warranted(layout: Layout, network: RoadNetwork, cluster: NDArray[Any]) -> FloatArray:
    """Find the junctions that warrant signals of their own.

    In dense town these are crossings of classified roads, unless the map knows the signals of such
    crossings, and places where `MANY` streets meet and the map has people cross `CROSSED` of them.
    A sign to stop or to give way, a roundabout or signals near by rule out others.

    Parameters
    ----------
    layout, network
        The layout and its streets.
    cluster
        (n,) the lowest node of the junction of each node.

    Returns
    -------
    places
        (k, 2) metres.
    """
    table = layout.roads.iloc[network.edge_road]
    kind = table["kind"].to_numpy().astype(str)
    count = len(network.node_position)
    if not network.edge_count:
        return np.zeros((0, 2))
    ends = cluster[network.edge_nodes]
    arm = (~np.isin(kind, NO_STREET) & (ends[:, 0] != ends[:, 1]))[:, None] & np.ones(2, bool)
    main = arm & np.isin(kind, MAIN)[:, None]
    length = arc_lengths(network.lines)[1]
    mapped = mapped_crossings(layout, network.lines)
    joint = network.node_degree[network.edge_nodes] >= 3
    crossed = arm & np.isfinite(at_ends(mapped, length, network.trim, joint)[0])
    arms, mains, walked = (
        np.bincount(ends[rows], minlength=count) for rows in (arm, main, crossed)
    )
    grand = (mains >= MAIN_ARMS) & (arms >= STREETS)
    many = (arms >= MANY) & (walked >= CROSSED)
    rows = np.flatnonzero(grand | many)
    if not len(rows):
        return np.zeros((0, 2))
    barred = np.zeros(count, bool)
    fast = np.isin(kind, FAST) | table["roundabout"].to_numpy(bool)
    barred[ends[fast]] = True
    places = network.node_position[rows]
    signals = signal_places(layout)
    ruled = _near(places, signals, SIGNAL_GAP)
    knows = grand[rows].any() and ruled[grand[rows]].mean() >= TOLD
    points = layout.points
    signs = points["kind"].isin(("stop", "give_way", "mini_roundabout")).to_numpy()
    ruled |= _near(places, points.geometry.to_numpy()[signs], RULED)
    chosen = ~ruled & ~barred[rows] & dense_places(layout, places) & (many[rows] | ~knows)
    return _apart(places[chosen], (mains + arms)[rows][chosen])


def _near(places: FloatArray, things: NDArray[Any], reach: float) -> BoolArray:
    found = np.zeros(len(places), bool)
    if len(things):
        tree = shapely.STRtree(things)
        found[tree.query(shapely.points(places), predicate="dwithin", distance=reach)[0]] = True
    return found


def _apart(places: FloatArray, weight: NDArray[np.int64]) -> FloatArray:
    """Keep of places that lie near each other the one where most roads meet."""
    order = np.lexsort((places[:, 1], places[:, 0], -weight))
    places = places[order]
    spots = shapely.points(places)
    one, other = shapely.STRtree(spots).query(spots, predicate="dwithin", distance=SIGNAL_GAP)
    kept = np.ones(len(places), bool)
    for row in range(len(places)):
        if kept[row]:
            kept[other[(one == row) & (other > row)]] = False
    return np.asarray(places[kept])


def with_signals(points: GeoDataFrame, places: FloatArray) -> GeoDataFrame:
    """Add signals to a table of points."""
    x, y = np.rint(places * 1000).astype(np.int64).T
    ids = hash_ids(0, "warranted signals", x.view(np.uint64), y.view(np.uint64))
    added = make_table(
        "points", shapely.points(places), id=ids, kind=["traffic_signals"] * len(places)
    )
    return joined_tables(points, added)
