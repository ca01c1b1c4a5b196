"""Dropped kerbs: where a crossing meets the walk, or the walk a drive, with a ramp behind."""

from __future__ import annotations

from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city.ground import DROPPED, KERB_HEIGHT, KERB_WIDTH, LABEL, SURFACES
from cityx.geometry.arrangement import Regions, join_regions, regions
from cityx.geometry.drape import RAMP_SLOPE
from cityx.geometry.polylines import locate
from cityx.plugins.road.carriageway import Carriageway, joined_by
from cityx.plugins.road.corners import LEAST_RADIUS
from cityx.plugins.road.marks import Street
from cityx.plugins.road.zebras import Zebras

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

RAMP = RAMP_SLOPE * (KERB_HEIGHT - DROPPED)  # metres
RIBS = 0.6  # metres of tactile paving behind the kerb (ISO 23599)
LEAST_WALK = 0.3  # metres left behind a ramp
FLARE = 0.5  # metres by which the kerb may bend away from its street within a crossing
END_STONES = SURFACES[LABEL["kerb_dropped"]].priority - 1  # over the kerb, under what is dropped
FREE_SIDE = 0.2  # metres that a drop reaches beyond the bars at both ends


def dropped_regions(street: Street, zebras: Zebras, road: Carriageway, *, yellow: bool) -> Regions:
    """Lower the kerbs on both sides of crossings, with ribs and a ramp where there is a walk.

    Parameters
    ----------
    street
        The network and what its marks share.
    zebras
        The crossings.
    road
        The surfaces along whose rims the kerbs run.
    yellow
        Whether the ribs are yellow.
    """
    if not len(zebras.edge):
        return Regions()
    table = street.layout.roads.iloc[street.network.edge_road[zebras.edge]]
    half = street.network.half_width[zebras.edge]
    every = np.arange(len(half))
    ribs = "tactile" if yellow else "tactile_pale"
    parts = []
    for sign, column in ((1.0, "sidewalk_left"), (-1.0, "sidewalk_right")):
        walk = table[column].to_numpy(float)
        kerb = half + KERB_WIDTH
        sloped = walk > RAMP + LEAST_WALK
        ribbed = walk > RIBS + RAMP + LEAST_WALK
        front = kerb + np.where(ribbed, RIBS, 0.0)
        # The walk falls towards the crossing from three sides, and so do the kerb's end stones.
        lowered = patches(street, zebras, every, sign * half, sign * (kerb + FLARE))
        ends = patches(street, zebras, every, sign * half, sign * (kerb + FLARE), RAMP)
        ribbon = patches(street, zebras, every, sign * kerb, sign * front)
        slope = patches(street, zebras, every, sign * kerb, sign * (front + RAMP), RAMP)
        # Where a way bends, patches may cross themselves.
        rest = shapely.difference(shapely.make_valid(slope), shapely.make_valid(ribbon))
        slope = np.where(ribbed, rest, slope)
        for name, rank, shapes in (
            ("kerb_dropped", 0, along_rims(lowered, road, KERB_WIDTH)),
            ("ramp", END_STONES, along_rims(ends[sloped], road, KERB_WIDTH)),
            (ribs, 0, ribbon[ribbed]),
            ("ramp", 0, slope[sloped]),
        ):
            parts.append(regions(shapes, LABEL[name], rank or SURFACES[LABEL[name]].priority))
    return join_regions(parts)


def drive_regions(street: Street, road: Carriageway) -> Regions:
    """Lower the kerbs at both sides of service ways where they cross the walk of a street.

    Round the corners of the drive the walk rises along the street's kerb, too.
    """
    drives, walk = _drives(street)
    rows = np.flatnonzero(walk > 0)
    if not len(rows):
        return Regions()
    half = street.network.half_width[drives.edge[rows]]
    parts = []
    for sign in (1.0, -1.0):
        far = half + LEAST_RADIUS + RAMP
        shapes = patches(street, drives, rows, sign * half, sign * far)
        ends = patches(street, drives, rows, sign * half, sign * (far + 2 * RAMP))
        for name, rank, where, width in (
            ("kerb_dropped", 0, shapes, KERB_WIDTH),
            ("ramp", END_STONES, ends, KERB_WIDTH),
            ("ramp", 0, ends, KERB_WIDTH + RAMP),
        ):
            priority = rank or SURFACES[LABEL[name]].priority
            parts.append(regions(along_rims(where, road, width), LABEL[name], priority))
    return join_regions(parts)


def _drives(street: Street) -> tuple[Zebras, FloatArray]:
    """Places where service ways cross the walks of streets, and the width of these walks."""
    network = street.network
    table = street.layout.roads.iloc[network.edge_road]
    walk = np.maximum(
        table["sidewalk_left"].to_numpy(float), table["sidewalk_right"].to_numpy(float)
    )
    service = street.kind == "service"
    nodes = network.edge_nodes
    of_node, half = np.zeros(len(network.node_position)), np.zeros(len(network.node_position))
    for column in nodes[~service].T:
        np.maximum.at(of_node, column, walk[~service])
        np.maximum.at(half, column, network.half_width[~service])
    edge, end = np.nonzero(service[:, None] & (of_node[nodes] > RAMP + LEAST_WALK))
    node = nodes[edge, end]
    depth = of_node[node] - FREE_SIDE
    back = half[node] + KERB_WIDTH + of_node[node] / 2
    room = back + depth / 2 < street.length[edge]
    along = np.where(end == 0, back, street.length[edge] - back)
    return Zebras(edge, along, depth), np.where(room, depth, 0.0)


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
