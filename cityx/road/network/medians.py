"""Dual carriageways: pairs of opposite one-way roads, and the median between them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city.ground import LABEL, SURFACES
from cityx.city.section import NARROWEST_LANE
from cityx.geometry.arrays import FloatArray, IntArray
from cityx.geometry.polylines import Polylines, arc_lengths, locate, to_linestrings
from cityx.ground.arrangement import Regions, regions

if TYPE_CHECKING:
    from geopandas import GeoDataFrame

    from cityx.city.layout import Layout
    from cityx.city.roads import RoadNetwork


WIDEST = 25.0  # metres between the centrelines of two carriageways of one road
OPPOSED = np.cos(np.radians(155.0))  # of the angle between them
GREEN = 2.5  # metres of median that is planted; a narrower one is paved
NARROW = 1.5  # metres; what parts two carriageways less is paved
PRIORITY = SURFACES[LABEL["sidewalk"]].priority  # kerbs win, and all that is driven on
FINE = 0.1  # metres by which centrelines are simplified
SHARES = (0.1, 0.3, 0.5, 0.7, 0.9)  # of a carriageway at which its distance is measured
BESIDE = 3  # of these places that must lie beside the other


@dataclass(frozen=True)
class Twins:
    """Pairs of one-way edges that are the two directions of one road, t of them.

    Attributes
    ----------
    first, second
        (t,) int64, edges of the network, ``first < second``.
    gap
        (t,) float, metres between their carriageways.
    side
        (t, 2) float, +1 where the other carriageway lies left of the edge, -1 where right.
    """

    first: IntArray
    second: IntArray
    gap: FloatArray
    side: FloatArray


def twins_of(layout: Layout, network: RoadNetwork) -> Twins:
    """Pair one-way edges closer than 25 m, of one name, that run against each other."""
    lines = network.lines
    first, second, distance, side = _opposed(layout.roads.iloc[network.edge_road], lines)
    gap = np.nanmean(distance, axis=1) if len(first) else np.zeros(0)
    gap = gap - network.half_width[first] - network.half_width[second]
    return Twins(first, second, np.round(gap, 3), side)


def parted_halves(table: GeoDataFrame, lines: Polylines, half: FloatArray) -> FloatArray:
    """Narrow the two carriageways of one road where they would overlap.

    Maps draw them nearer than their lanes are wide by default; nothing is narrowed beyond what its
    lanes need.

    Parameters
    ----------
    table
        Roads of the edges, e rows.
    lines
        Centrelines of the edges.
    half
        (e,) metres, half of their widths.

    Returns
    -------
    half
        (e,) metres.
    """
    first, second, distance, _ = _opposed(table, lines)
    if not len(first):
        return half
    share = np.nanmedian(distance, axis=1) / (half[first] + half[second])
    limit = np.ones(len(half))
    np.minimum.at(limit, np.concatenate([first, second]), np.tile(share, 2))
    least = np.maximum(table["lanes"].to_numpy(float), 1.0) * NARROWEST_LANE / 2
    return np.minimum(half, np.round(np.maximum(half * limit, least), 3))


def _opposed(
    table: GeoDataFrame, lines: Polylines
) -> tuple[IntArray, IntArray, FloatArray, FloatArray]:
    """Find pairs of edges that are the two directions of one road.

    Returns
    -------
    first, second
        (t,) edges.
    distance
        (t, 5) metres between their centrelines at `SHARES` of the first, NaN where it is not
        beside the second.
    side
        (t, 2) as of `Twins`.
    """
    ring = table["roundabout"].to_numpy(bool)
    name = table["name"].to_numpy().astype(str)
    ref = table["tags"].str.extract(r'"ref":\s*"([^"]*)"', expand=False).fillna("").to_numpy(str)
    edges = np.flatnonzero(table["oneway"].to_numpy(bool) & ~ring & ((name != "") | (ref != "")))
    shapes = to_linestrings(lines)
    one, other = shapely.STRtree(shapes[edges]).query(
        shapes[edges], predicate="dwithin", distance=WIDEST
    )
    first, second = edges[one], edges[other]
    same = (name[first] == name[second]) & (name[first] != "")
    same |= (ref[first] == ref[second]) & (ref[first] != "")
    keep = same & (first < second)
    first, second = first[keep], second[keep]
    length = arc_lengths(lines)[1]
    distances, side = np.full((len(first), len(SHARES)), np.nan), np.zeros((len(first), 2))
    for column, share in enumerate(SHARES):
        place, ahead = locate(lines, first, share * length[first])
        along = shapely.line_locate_point(shapes[second], shapely.points(place))
        foot, against = locate(lines, second, along)
        across = foot - place
        distance = np.hypot(*across.T)
        inner = (along > 0.5) & (along < length[second] - 0.5) & (distance < WIDEST)
        inner &= (ahead * against).sum(axis=1) < OPPOSED
        distances[inner, column] = distance[inner]
        left = ahead[:, 0] * across[:, 1] - ahead[:, 1] * across[:, 0]
        right = against[:, 1] * across[:, 0] - against[:, 0] * across[:, 1]
        side += np.where(inner[:, None], np.sign(np.column_stack([left, right])), 0.0)
    keep = np.isfinite(distances).sum(axis=1) >= BESIDE
    return first[keep], second[keep], distances[keep], np.sign(side[keep])


def median_regions(layout: Layout, network: RoadNetwork, on_ground: NDArray[np.bool_]) -> Regions:
    """Return the strips between two carriageways of one road: paved, or wide enough for lawn.

    What is too narrow to stand on is no median: it is paved like the gutters on both sides of it.
    """
    twins = twins_of(layout, network)
    rows = np.flatnonzero(on_ground[twins.first] & on_ground[twins.second] & (twins.gap > 0))
    if not len(rows):
        return Regions()
    lines = shapely.simplify(to_linestrings(network.lines), FINE)
    reach = twins.gap[rows] + network.half_width[twins.first[rows]]
    reach = reach + network.half_width[twins.second[rows]] + 1.0
    sides: list[Any] = [
        shapely.buffer(lines[edge[rows]], twins.side[rows, number] * reach, cap_style="flat",
                       single_sided=True, join_style="mitre", mitre_limit=2.0)
        for number, edge in enumerate((twins.first, twins.second))
    ]  # fmt: skip
    between = shapely.intersection(shapely.make_valid(sides[0]), shapely.make_valid(sides[1]))
    label = np.where(twins.gap[rows] < GREEN, LABEL["plaza"], LABEL["grass"])
    return regions(between, label, PRIORITY + 1)
