"""Places of pedestrian crossings: at which ends of edges, and how far from the node."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.geometry.arrays import BoolArray, FloatArray, IntArray
from cityx.geometry.polylines import Polylines, arc_lengths
from cityx.ground.walking.crosswalks import FAST, WIDEST_BARE
from cityx.ground.walking.mapped_crossings import (
    MappedCrossings,
    barred_crossings,
    mapped_crossings,
)
from cityx.road.network.signal_places import signal_places
from cityx.road.surface.corners import MOST_TRIM, Arms, Corners, curve_lengths, meeting_of

if TYPE_CHECKING:
    from cityx.city.layout import Layout


BEFORE = 1.0  # metres from the stop line to the crossing or the junction
STOP = 0.4  # metres, width of a stop line
DEPTH, WIDE_DEPTH = 3.0, 4.0  # metres along the road, on a street and on a main road
MAIN = ("primary", "secondary", "tertiary", "trunk")
SETBACK, RING_SETBACK = 0.5, 5.0  # metres from the junction, or a roundabout's, to the crossing
NEAR_CROSSING = 12.0  # metres beyond the junction within which a mapped crossing is at the end
FLARE = 1.2  # metres by which a kerb may have left its street where people cross
LEAST_LEFT = 0.5  # metres of street behind the line before a crossing
SIGNAL_REACH = 25.0  # metres from a traffic signal to the junction it controls
DENSE_REACH = 30.0  # metres within which buildings make a junction urban
DENSE_COUNT = 4
SETTLED_REACH = 60.0  # metres within which a single building makes people cross
MAJOR = (
    "trunk", "primary", "secondary", "tertiary",
    "trunk_link", "primary_link", "secondary_link", "tertiary_link",
)  # fmt: skip


def at_ends(
    mapped: MappedCrossings, length: FloatArray, trim: FloatArray, joint: BoolArray
) -> tuple[FloatArray, IntArray]:
    """Assign mapped crossings to the ends of edges at junctions.

    Parameters
    ----------
    mapped
        The crossings.
    length
        (e,) metres.
    trim, joint
        (e, 2) metres of edges within junctions, and whether streets meet there.

    Returns
    -------
    place, told
        (e, 2) metres from the end to the crossing, infinity without one; and the most that the map
        tells of it, into `TELLS`.
    """
    place, told = np.full(trim.shape, np.inf), np.zeros(trim.shape, np.int64)
    edge, (back, near) = mapped.edge, ends_near(mapped, length, trim, joint)
    for side in (0, 1):
        own = near[:, side]
        np.minimum.at(place[:, side], edge[own], back[own, side])
        np.maximum.at(told[:, side], edge[own], mapped.told[own])
    return place, told


def ends_near(
    mapped: MappedCrossings, length: FloatArray, trim: FloatArray, joint: BoolArray
) -> tuple[FloatArray, BoolArray]:
    """(m, 2) metres from both ends of its edge to each crossing, and at which of them it lies.

    One that is near to both ends is at the one whose junction is nearer.
    """
    back = np.column_stack([mapped.along, length[mapped.edge] - mapped.along])
    out = back - trim[mapped.edge]
    near = (out < NEAR_CROSSING) & joint[mapped.edge]
    both = near.all(axis=1)
    near[both, 0] = out[both, 0] <= out[both, 1]
    near[both, 1] = ~near[both, 0]
    return back, near


def mouths(arms: Arms, corners: Corners, half: FloatArray, count: int) -> FloatArray:
    """(e, 2) metres from the nodes from which both kerbs of arms keep within `FLARE` of them."""
    curve = curve_lengths(corners)
    flare = np.minimum(FLARE, corners.radius)
    inward = np.sqrt(2 * corners.radius * flare - flare**2)
    found = np.zeros((count, 2))
    for own, other in ((corners.first, corners.second), (corners.second, corners.first)):
        edge = arms.edge[own]
        reach = meeting_of(half[edge], half[arms.edge[other]], corners.gap) + curve
        reach = np.clip(reach, 0.0, MOST_TRIM)
        np.maximum.at(found, (edge, arms.end[own]), np.maximum(reach - inward, 0.0))
    return np.round(found, 3)


def depths(kind: NDArray[Any]) -> FloatArray:
    """(e,) metres along the road that a crossing takes."""
    return np.where(np.isin(kind, MAIN), WIDE_DEPTH, DEPTH)


def crossing_middles(
    place: FloatArray, mouth: FloatArray, usual: FloatArray, depth: FloatArray
) -> FloatArray:
    """(e, 2) metres from the nodes to the middles of crossings.

    A crossing lies where the map has it, but not farther in than the mouth of its arm; where the
    map has none it lies at the `usual` place behind the curves of the kerbs.
    """
    half = depth[:, None] / 2
    told = np.where(np.isfinite(place), place, usual + half)
    return np.maximum(told, np.minimum(mouth, usual) + half)


def crossed_ends(
    layout: Layout,
    table: Any,
    lines: Polylines,
    edge_nodes: NDArray[Any],
    degree: NDArray[Any],
    position: FloatArray,
    trim: FloatArray,
    mouth: FloatArray,
) -> BoolArray:
    """(e, 2) at which ends of which edges people cross."""
    length = arc_lengths(lines)[1]
    joint = degree[edge_nodes] >= 3
    place, _ = at_ends(mapped_crossings(layout, lines), length, trim, joint)
    crossing = np.isfinite(place)
    spots = shapely.points(position)
    signalled = _within(spots, signal_places(layout), SIGNAL_REACH, 1)
    dense = dense_places(layout, position)
    major = table["kind"].isin(MAJOR).to_numpy()
    grand = np.zeros(len(position), bool)
    np.logical_or.at(grand, edge_nodes, major[:, None] & np.ones(2, bool))
    streets = ~table["kind"].isin(("service", "track")).to_numpy()
    arms = np.bincount(edge_nodes[streets].ravel(), minlength=len(position))
    walked = (table["sidewalk_left"].to_numpy() + table["sidewalk_right"].to_numpy()) > 0
    walked &= ~table["kind"].isin(("service", "track", "living_street")).to_numpy()
    urban = (arms >= 3) & dense & (signalled | grand)
    crossing |= urban[edge_nodes] & walked[:, None]
    if not (layout.points["kind"] == "crossing").any():
        # No map tells where people get over roads that are too wide to cross just anywhere.
        wide = walked & ~table["kind"].isin(FAST).to_numpy()
        wide &= table["width"].to_numpy(float) > WIDEST_BARE
        settled = _within(spots, layout.buildings.geometry.to_numpy(), SETTLED_REACH, 1)
        crossing |= (settled & grand & (arms >= 3))[edge_nodes] & wide[:, None]
    barred, _ = at_ends(barred_crossings(layout, lines), length, trim, joint)
    crossing &= ~np.isfinite(barred) | np.isfinite(place)
    depth = depths(table["kind"].to_numpy())
    outer = crossing_middles(place, mouth, trim + SETBACK, depth) + depth[:, None] / 2
    outer = np.maximum(outer + BEFORE + STOP, trim)
    kept = np.zeros_like(crossing)
    # Where there is no room for all, those of the map have it.
    for chosen in (crossing, crossing & np.isfinite(place)):
        # A crossing needs room: 3 m of bars and the stop line before the next junction.
        roomy = length - trim.sum(axis=1) > 8.0 * np.maximum(chosen.sum(axis=1), 1)
        roomy |= np.isfinite(place).any(axis=1)
        roomy &= length - np.where(chosen, outer, trim).sum(axis=1) > LEAST_LEFT
        kept |= chosen & roomy[:, None]
    return np.asarray(kept)


def dense_places(layout: Layout, position: FloatArray) -> BoolArray:
    """(k,) whether houses stand closely about places."""
    walls = layout.buildings.geometry.to_numpy()
    return _within(shapely.points(position), walls, DENSE_REACH, DENSE_COUNT)


def _within(spots: NDArray[Any], things: NDArray[Any], distance: float, count: int) -> BoolArray:
    if not len(things):
        return np.zeros(len(spots), bool)
    found = shapely.STRtree(things).query(spots, predicate="dwithin", distance=distance)[0]
    return np.asarray(np.bincount(found, minlength=len(spots)) >= count)
