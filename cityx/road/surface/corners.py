"""Kerb return: the curve of the kerb at a corner, between two neighbouring arms of a junction."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np
import shapely
from numpy.typing import ArrayLike

from cityx.geometry.arrays import BoolArray, FloatArray, IntArray

if TYPE_CHECKING:
    from cityx.city.layout import Layout


LEAST_RADIUS, MOST_RADIUS = 3.0, 12.0  # metres; what a car and what a lorry with trailer needs
# Metres of kerb radius by class; a corner takes the mean of its two arms (RASt 06, table 63, and
# the Manual for Streets, 6.3, give 3-5 in residential streets, 8-10 on main roads).
RADIUS: Mapping[str, float] = MappingProxyType({
    "motorway": 12.0, "motorway_link": 12.0, "trunk": 10.0, "trunk_link": 10.0, "primary": 9.0,
    "primary_link": 9.0, "secondary": 8.0, "secondary_link": 8.0, "tertiary": 6.0,
    "tertiary_link": 6.0, "unclassified": 5.0, "residential": 4.0, "busway": 8.0, "road": 5.0,
    "raceway": 10.0,
})  # fmt: skip
INDUSTRIAL = 12.0  # metres on industrial land, whatever the class
STRAIGHT = np.radians(150.0)  # arms that meet flatter than this leave each other alone
ACUTE = np.radians(50.0)  # a sharper nose has the least radius
NOSE, NOSE_RADIUS = np.radians(35.0), 1.5  # a merging lane is no corner that anybody turns round
LEAST_SINE = 0.15  # acute arms would trim each other without end
MOST_TRIM = 25.0  # metres
STUB = 1.0  # metres of carriageway that must be left between two junctions
WALK_LEFT = 1.2  # metres of walk left before a house by a wide curve
WALK_LEAST = 0.6  # the same by a curve of the least radius
TIGHTEST = 0.5  # metres; a kerb between houses that leave no room
HOUSE_REACH = 12.0  # metres from a corner within which a house may narrow its curve
STEP = 0.25  # metres; radii are whole multiples


@dataclass(frozen=True)
class Arms:
    """Arms of all nodes, a of them, node by node, counter-clockwise.

    Attributes
    ----------
    node, edge, end
        (a,) int64; ``end`` is 0 where the edge leaves the node and 1 where it arrives.
    bearing
        (a,) float64, mathematical angle at which it leaves the node.
    """

    node: IntArray
    edge: IntArray
    end: IntArray
    bearing: FloatArray

    def following(self) -> tuple[IntArray, FloatArray]:
        """Return the next arm counter-clockwise, (a,), and the angle to it, (a,), 0 to 2 pi."""
        size = len(self.node)
        here = np.arange(size)
        same = np.r_[self.node[1:] == self.node[:-1], False][:size]
        after = np.where(same, here + 1, np.searchsorted(self.node, self.node))
        return after, np.mod(self.bearing[after] - self.bearing, 2 * np.pi)


@dataclass(frozen=True)
class Corners:
    """Corners of junctions, c of them.

    Attributes
    ----------
    first, second
        (c,) int64, rows of `Arms`; the second follows the first counter-clockwise.
    gap
        (c,) float64, radians between them.
    place
        (c, 2) float64, where the two kerbs would meet without a curve.
    radius
        (c,) float64, metres of the kerb's curve.
    """

    first: IntArray
    second: IntArray
    gap: FloatArray
    place: FloatArray
    radius: FloatArray


def corners_of(
    layout: Layout, kind: ArrayLike, arms: Arms, position: FloatArray, half: FloatArray,
    length: FloatArray,
) -> tuple[Corners, FloatArray]:  # fmt: skip
    """Choose the kerb radius of every corner.

    Parameters
    ----------
    layout
        Houses, which must keep a walk before them, and industrial land.
    kind
        (e,) str, class of each edge's road.
    arms
        Arms of the nodes.
    position
        (n, 2) float, of the nodes.
    half, length
        (e,) float, half the width of each edge's carriageway and its length, metres.

    Returns
    -------
    corners
        Where two arms of a node meet more sharply than 150 degrees.
    reach
        (e, 2) float, metres from both ends of each edge to where its corners' curves begin; 0 at
        nodes of two arms, which are bends and no junctions.
    """
    degree = np.bincount(arms.node, minlength=len(position))
    after, gap = arms.following()
    first = np.flatnonzero(
        (gap < STRAIGHT) & (degree[arms.node] >= 2) & (after != np.arange(len(after)))
    )
    second, gap = after[first], gap[first]
    along = meeting_of(half[arms.edge[first]], half[arms.edge[second]], gap)
    bearing = arms.bearing[first]
    ahead = np.column_stack([np.cos(bearing), np.sin(bearing)])
    left = np.column_stack([-ahead[:, 1], ahead[:, 0]])
    place = position[arms.node[first]] + ahead * along[:, None]
    place = place + left * half[arms.edge[first]][:, None]
    words = np.asarray(kind).astype(str)
    known, which = np.unique(words, return_inverse=True)
    of_class = np.array([RADIUS.get(word, LEAST_RADIUS) for word in known.tolist()] or [0.0])[which]
    wanted = (of_class[arms.edge[first]] + of_class[arms.edge[second]]) / 2
    wanted[_on_industrial_land(layout, place)] = INDUSTRIAL
    wanted = np.where(gap < NOSE, NOSE_RADIUS, np.where(gap < ACUTE, LEAST_RADIUS, wanted))
    wanted = np.minimum(wanted, _room(layout, place, gap))
    radius = np.maximum(np.floor(wanted / STEP) * STEP, TIGHTEST)
    corners = Corners(first, second, gap, place, radius)
    reach = _reach(corners, arms, half, len(length), degree)
    # Where the curves at both ends leave nothing between them, the edge gets the least ones.
    tight = reach.sum(axis=1) > length - STUB
    pressed = tight[arms.edge[first]] | tight[arms.edge[second]]
    if pressed.any():
        radius = np.where(pressed, np.minimum(radius, LEAST_RADIUS), radius)
        corners = Corners(first, second, gap, place, radius)
        reach = _reach(corners, arms, half, len(length), degree)
    return replace(corners, radius=_fitting(corners, arms, half, reach, length)), reach


def trims_of(reach: FloatArray, length: FloatArray) -> tuple[FloatArray, BoolArray]:
    """Share edges that are too short for what both ends need: (e, 2) metres, (e,) which ones."""
    total = reach.sum(axis=1)
    swallowed = (total > 0) & (total > length - STUB)
    share = (length / np.where(total > 0, total, 1.0))[:, None]
    return np.round(np.where(swallowed[:, None], reach * share, reach), 4), swallowed


def _fitting(
    corners: Corners, arms: Arms, half: FloatArray, reach: FloatArray, length: FloatArray
) -> FloatArray:
    """(c,) radii no larger than edges that lie wholly inside of junctions have room for."""
    trim, swallowed = trims_of(reach, length)
    radius = corners.radius.copy()
    for own, other in ((corners.first, corners.second), (corners.second, corners.first)):
        edge = arms.edge[own]
        room = trim[edge, arms.end[own]] - meeting_of(
            half[edge], half[arms.edge[other]], corners.gap
        )
        most = np.maximum(room * np.tan(corners.gap / 2), TIGHTEST)
        radius = np.where(swallowed[edge], np.minimum(radius, most), radius)
    return radius


def meeting_of(own: FloatArray, other: FloatArray, gap: FloatArray) -> FloatArray:
    """Metres along an arm to where its kerb meets that of the other."""
    sine = np.maximum(np.sin(gap), LEAST_SINE)
    return np.asarray((other + own * np.cos(gap)) / sine)


def curve_lengths(corners: Corners) -> FloatArray:
    """Metres along an arm from where its kerb meets the next to where their curve begins."""
    return np.asarray(corners.radius / np.maximum(np.tan(corners.gap / 2), LEAST_SINE / 2))


def _reach(
    corners: Corners, arms: Arms, half: FloatArray, count: int, degree: IntArray
) -> FloatArray:
    """(e, 2) metres from the ends of edges to where the curves of their corners begin."""
    curve = curve_lengths(corners)
    reach = np.zeros((count, 2))
    for own, other in ((corners.first, corners.second), (corners.second, corners.first)):
        edge = arms.edge[own]
        needed = meeting_of(half[edge], half[arms.edge[other]], corners.gap) + curve
        needed = np.where(degree[arms.node[own]] >= 3, np.clip(needed, 0.0, MOST_TRIM), 0.0)
        np.maximum.at(reach, (edge, arms.end[own]), needed)
    return reach


def _on_industrial_land(layout: Layout, place: FloatArray) -> BoolArray:
    inside = np.zeros(len(place), bool)
    land = layout.areas.geometry.to_numpy()[(layout.areas["kind"] == "industrial").to_numpy()]
    if len(land):
        inside[shapely.STRtree(land).query(shapely.points(place), predicate="within")[0]] = True
    return inside


def _room(layout: Layout, place: FloatArray, gap: FloatArray) -> FloatArray:
    """(c,) the largest radius that leaves a walk between the curve and the nearest house."""
    parts = layout.parts
    standing = (parts["base"].to_numpy() < 0.5) & parts["walls"].to_numpy()
    walls: Any = parts.geometry.to_numpy()[standing]
    distance = np.full(len(place), np.inf)
    if len(walls) and len(place):
        corner, wall = shapely.STRtree(walls).query_nearest(
            shapely.points(place), max_distance=HOUSE_REACH, all_matches=False
        )
        distance[corner] = shapely.distance(shapely.points(place[corner]), walls[wall])
    # The middle of the curve lies this share of the radius behind the corner.
    slim = np.maximum(np.sin(gap / 2), 1e-9)  # arms may leave in one direction
    depth = np.maximum(1.0 / slim - 1.0, 0.05)
    wide = (distance - WALK_LEFT) / depth
    least = np.minimum((distance - WALK_LEAST) / depth, LEAST_RADIUS)
    return np.asarray(np.clip(np.maximum(wide, least), TIGHTEST, MOST_RADIUS))
