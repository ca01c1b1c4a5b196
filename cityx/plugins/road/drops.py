"""Dropped kerbs: where a crossing or a drive meets the walk, with ribs and a ramp behind."""

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
from cityx.plugins.road.markings import Street, Zebras

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

RAMP = RAMP_SLOPE * (KERB_HEIGHT - DROPPED)  # metres
RIBS = 0.6  # metres of tactile paving behind the kerb (ISO 23599)
LEAST_WALK = 0.3  # metres left behind a ramp
FLARE = 0.5  # metres by which the kerb may bend away from its street within a crossing
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
    ribs = "tactile" if yellow else "tactile_pale"
    parts = []
    for sign, column in ((1.0, "sidewalk_left"), (-1.0, "sidewalk_right")):
        walk = table[column].to_numpy(float)
        kerb = half + KERB_WIDTH
        sloped = walk > RAMP + LEAST_WALK
        ribbed = walk > RIBS + RAMP + LEAST_WALK
        front = kerb + np.where(ribbed, RIBS, 0.0)
        everywhere = np.ones(len(walk), bool)
        for name, chosen, near, far in (
            ("kerb_dropped", everywhere, half, kerb + FLARE),
            (ribs, ribbed, kerb, front),
            ("ramp", sloped, front, front + RAMP),
        ):
            rows = np.flatnonzero(chosen)
            shapes = _patches(street, zebras, rows, sign * near[rows], sign * far[rows])
            if name == "kerb_dropped":
                shapes = along_rims(shapes, road)
            label = LABEL[name]
            parts.append(regions(shapes, label, SURFACES[label].priority))
    return join_regions(parts)


def along_rims(patches: NDArray[Any], road: Carriageway) -> NDArray[Any]:
    """Cut patches to the kerb stones along the rims of what is driven on."""
    driven = road.driven
    patch, row = shapely.STRtree(driven).query(patches, predicate="dwithin", distance=KERB_WIDTH)
    near, of_patch = joined_by(shapely.buffer(driven[row], KERB_WIDTH, join_style="mitre"), patch)
    return np.asarray(shapely.intersection(patches[of_patch], near))


def _patches(
    street: Street, zebras: Zebras, rows: IntArray, near: FloatArray, far: FloatArray
) -> NDArray[Any]:
    """Return strips beside crossings between two distances from the centreline, (k,)."""
    edge = zebras.edge[rows]
    reach = zebras.depth[rows] / 2 + FREE_SIDE
    corners = []
    for step, sides in ((-reach, (near, far)), (reach, (far, near))):
        at, ahead = locate(street.lines, edge, zebras.along[rows] + step)
        left = np.column_stack([-ahead[:, 1], ahead[:, 0]])
        corners += [at + left * side[:, None] for side in sides]
    return np.asarray(shapely.polygons(np.stack(corners, axis=1)))
