"""Dropped kerbs: where a crossing meets the walk, or the walk a drive, with a ramp behind."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city.ground import DROPPED, KERB_HEIGHT, KERB_WIDTH, LABEL, SURFACES
from cityx.geometry.arrangement import Regions, join_regions, regions
from cityx.geometry.drape import RAMP_SLOPE
from cityx.geometry.polylines import locate
from cityx.plugins.road.carriageway import Carriageway, joined_by
from cityx.plugins.road.corners import LEAST_RADIUS, RADIUS
from cityx.plugins.road.crossing_places import dense_places
from cityx.plugins.road.marks import Street
from cityx.plugins.road.network import arm_bearings, arms_of
from cityx.plugins.road.zebras import Zebras

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]

RAMP = RAMP_SLOPE * (KERB_HEIGHT - DROPPED)  # metres
RIBS = 0.6  # metres of tactile paving behind the kerb (ISO 23599)
LEAST_WALK = 0.3  # metres left behind a ramp
FLARE = 0.5  # metres by which the kerb may bend away from its street within a crossing
FLARED = 2.0  # metres, the same where its curve begins within a crossing
BENT_RIBS = SURFACES[LABEL["kerb"]].priority + 1  # over the ramp that surrounds them
DEEP = RIBS + RAMP + LEAST_WALK + 0.05  # metres of a walk with ribs and a ramp
NARROW = 1.2  # metres of a walk in town that is lowered as a whole
_APART = r'"sidewalk(?::both|:left|:right)?": *"separate"'
END_STONES = SURFACES[LABEL["kerb_dropped"]].priority - 1  # over the kerb, under what is dropped
LEAST_SINE = 0.4  # of the angle between a drive and its street; a flatter one is no drive
FREE_SIDE = 0.2  # metres that a drop reaches beyond the bars at both ends


def dropped_regions(street: Street, zebras: Zebras, road: Carriageway, *, ribs: str) -> Regions:
    """Lower the kerbs on both sides of crossings, with ribs and a ramp where there is a walk.

    Parameters
    ----------
    street
        The network and what its marks share.
    zebras
        The crossings.
    road
        The surfaces along whose rims the kerbs run.
    ribs
        Surface of the ribs.
    """
    if not len(zebras.edge):
        return Regions()
    table = street.layout.roads.iloc[street.network.edge_road[zebras.edge]]
    half = street.network.half_width[zebras.edge]
    every = np.arange(len(half))
    parts = []
    apart = table["tags"].str.contains(_APART, regex=True).to_numpy().astype(bool)
    flare = np.where(zebras.flared, FLARED, FLARE)
    town = dense_places(street.layout, locate(street.lines, zebras.edge, zebras.along)[0])
    straight, bent = np.flatnonzero(~zebras.flared), np.flatnonzero(zebras.flared)
    for sign, column in ((1.0, "sidewalk_left"), (-1.0, "sidewalk_right")):
        walk = table[column].to_numpy(float)
        walk = np.where(apart, np.maximum(walk, DEEP), walk)
        kerb = half + KERB_WIDTH
        # In town the ground behind a narrow walk is paved, up to the houses if need be.
        walk = np.where(town & (walk >= NARROW), np.maximum(walk, DEEP), walk)
        sloped = walk > RAMP + LEAST_WALK
        ribbed = walk > RIBS + RAMP + LEAST_WALK
        front = kerb + np.where(ribbed, RIBS, 0.0)
        # The walk falls towards the crossing from three sides, and so do the kerb's end stones.
        lowered = patches(street, zebras, every, sign * half, sign * (kerb + flare))
        ends = patches(street, zebras, every, sign * half, sign * (kerb + flare), RAMP)
        ribbon = patches(street, zebras, every, sign * kerb, sign * front)
        slope = patches(street, zebras, every, sign * kerb, sign * (front + RAMP), RAMP)
        # Where a way bends, patches may cross themselves.
        rest = shapely.difference(shapely.make_valid(slope), shapely.make_valid(ribbon))
        slope = np.where(ribbed, rest, slope)
        # Before a curve that begins within a crossing ribs and ramp follow the kerb.
        behind = sign * half, sign * (front + RAMP + FLARED)
        near, far = (patches(street, zebras, every, *behind, past) for past in (0.0, RAMP))
        near, far = near[bent][ribbed[bent]], far[bent][sloped[bent]]
        for name, rank, shapes in (
            ("kerb_dropped", 0, along_rims(lowered, road, KERB_WIDTH)),
            ("ramp", END_STONES, along_rims(ends[sloped], road, KERB_WIDTH)),
            (ribs, 0, ribbon[straight][ribbed[straight]]),
            ("ramp", 0, slope[straight][sloped[straight]]),
            (ribs, BENT_RIBS, along_rims(near, road, KERB_WIDTH + RIBS)),
            ("ramp", 0, along_rims(far, road, KERB_WIDTH + RIBS + RAMP)),
        ):
            parts.append(regions(shapes, LABEL[name], rank or SURFACES[LABEL[name]].priority))
    return join_regions(parts)


def drive_regions(street: Street, road: Carriageway) -> Regions:
    """Lower the kerbs at both sides of service ways where they cross the walk of a street.

    Round the corners of the drive the walk rises along the street's kerb, too.
    """
    mouths = _mouths(street)
    if not len(mouths.place):
        return Regions()
    shapes, ends = (_mouth_shapes(mouths, past) for past in (0.0, 2 * RAMP))
    parts = []
    for name, rank, where, width in (
        ("kerb_dropped", 0, shapes, KERB_WIDTH),
        ("ramp", END_STONES, ends, KERB_WIDTH),
        ("ramp", 0, ends, KERB_WIDTH + RAMP),
    ):
        priority = rank or SURFACES[LABEL[name]].priority
        parts.append(regions(along_rims(where, road, width), LABEL[name], priority))
    return join_regions(parts)


@dataclass(frozen=True)
class _Mouths:
    """Drives where they cross the walk of a street, m of them, in the frame of the street.

    Attributes
    ----------
    place, along
        (m, 2) float: where the drive leaves the street's middle, and the way along the street.
    away
        (m,) 1 where the drive goes to the left of that way, -1 to the right.
    slant
        (m,) cotangent of the angle between the two.
    near, far
        (m,) metres from the street's middle to its kerb, and to the back of its walk.
    behind, ahead
        (m,) metres along the street that the mouth takes to both sides of the drive's middle.
    """

    place: FloatArray
    along: FloatArray
    away: FloatArray
    slant: FloatArray
    near: FloatArray
    far: FloatArray
    behind: FloatArray
    ahead: FloatArray


def _mouths(street: Street) -> _Mouths:
    """Find the mouths of drives at streets that have walks, where the drive is long enough."""
    network = street.network
    table = street.layout.roads.iloc[network.edge_road]
    walk = np.maximum(
        table["sidewalk_left"].to_numpy(float), table["sidewalk_right"].to_numpy(float)
    )
    service = street.kind == "service"
    node, edge, end = arms_of(street.lines, network.edge_nodes)
    bearing = arm_bearings(street.lines, edge, end)
    count = len(network.node_position)
    of_node, half = np.zeros(count), np.zeros(count)
    np.maximum.at(of_node, node[~service[edge]], walk[edge][~service[edge]])
    np.maximum.at(half, node[~service[edge]], network.half_width[edge][~service[edge]])
    drive = np.flatnonzero(service[edge] & (of_node[node] > RAMP + LEAST_WALK))
    other, found = _squarest(node, bearing, ~service[edge], drive)
    drive, other = drive[found], other[found]
    at = node[drive]
    turn = np.round(bearing[drive] - bearing[other], 6)
    sine, cosine = np.sin(turn), np.cos(turn)
    away = np.where(sine < 0, -1.0, 1.0)
    sine = np.maximum(np.abs(sine), LEAST_SINE)
    near, far = half[at], half[at] + KERB_WIDTH + of_node[at]
    room = far / sine < street.length[edge[drive]]
    # The curves of both corners, and the drive itself, along the street.
    angle = np.arctan2(sine, cosine)  # to the arm ahead
    wide = network.half_width[edge[drive]] / sine + RAMP
    of_class = [RADIUS.get(word, LEAST_RADIUS) for word in street.kind[edge[other]].tolist()]
    radius = (np.array(of_class, float) + LEAST_RADIUS) / 2
    ahead = wide + radius / np.tan(angle / 2)
    behind = wide + radius * np.tan(angle / 2)
    way = bearing[other]
    along = np.column_stack([np.cos(way), np.sin(way)])
    found_all = _Mouths(network.node_position[at], along, away, cosine / sine, near, far, behind,
                        ahead)  # fmt: skip
    names = _Mouths.__dataclass_fields__
    return _Mouths(*(getattr(found_all, name)[room] for name in names))


def _squarest(
    node: IntArray, bearing: FloatArray, street: BoolArray, drive: IntArray
) -> tuple[IntArray, BoolArray]:
    """(k,) the arm of a street most square to each drive at its node, and whether there is one."""
    low = np.searchsorted(node, node[drive])
    size = np.searchsorted(node, node[drive], side="right") - low
    row = np.repeat(np.arange(len(drive)), size)
    arm = low[row] + np.arange(len(row)) - np.repeat(np.cumsum(size) - size, size)
    row, arm = row[street[arm]], arm[street[arm]]
    slant = np.abs(np.cos(bearing[arm] - bearing[drive[row]]))
    order = np.lexsort((arm, np.round(slant, 6), row))
    known, first = np.unique(row[order], return_index=True)
    other, found = np.zeros(len(drive), np.int64), np.zeros(len(drive), bool)
    other[known], found[known] = arm[order[first]], True
    return other, found


def _mouth_shapes(mouths: _Mouths, past: float) -> NDArray[Any]:
    """(m,) the walks before drives, `past` metres more along the street."""
    left = np.column_stack([-mouths.along[:, 1], mouths.along[:, 0]]) * mouths.away[:, None]
    corners = []
    for off, ends in ((mouths.near, (-1, 1)), (mouths.far, (1, -1))):
        for end in ends:
            reach = np.where(end < 0, -mouths.behind, mouths.ahead) + end * past
            along = off * mouths.slant + reach
            corners.append(mouths.place + left * off[:, None] + mouths.along * along[:, None])
    return np.asarray(shapely.polygons(np.stack(corners, axis=1)))


def along_rims(shapes: NDArray[Any], road: Carriageway, width: float) -> NDArray[Any]:
    """Cut shapes to what lies so near the rims of what is driven on, in metres."""
    driven = road.driven
    patch, row = shapely.STRtree(driven).query(shapes, predicate="dwithin", distance=width)
    with np.errstate(divide="ignore", invalid="ignore"):  # a needle's mitre is cut off
        grown = shapely.buffer(driven[row], width, join_style="mitre")
    near, of_patch = joined_by(grown, patch)
    whole = shapely.make_valid(shapes[of_patch])  # where a way bends its patch may cross itself
    return np.asarray(shapely.intersection(whole, near))


def patches(
    street: Street, zebras: Zebras, rows: IntArray, near: FloatArray, far: FloatArray,
    past: float = 0.0,
) -> NDArray[Any]:  # fmt: skip
    """Return strips across crossings between two distances left of the centreline, (k,).

    They reach ``past`` metres farther along the street than a dropped kerb.
    """
    edge = zebras.edge[rows]
    reach = zebras.depth[rows] / 2 + FREE_SIDE + past
    corners = []
    for step, sides in ((-reach, (near, far)), (reach, (far, near))):
        at, ahead = locate(street.lines, edge, zebras.along[rows] + step)
        left = np.column_stack([-ahead[:, 1], ahead[:, 0]])
        corners += [at + left * side[:, None] for side in sides]
    return np.asarray(shapely.polygons(np.stack(corners, axis=1)))
