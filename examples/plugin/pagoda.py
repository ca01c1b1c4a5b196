"""A pagoda: tiers that shrink towards the top."""

from typing import Annotated

import shapely

from cityx.city import MeshBatch
from cityx.protocol import Range, action
from cityx.protocol.solid_blocks import block, one_object
from cityx.protocol.values import Footprint


@action("building/pagoda-v1", limits=["Courtyards are filled."])
def pagoda(footprint: Footprint, *, tiers: Annotated[int, Range(1, 9)] = 5) -> MeshBatch:
    """Raise every building into a pagoda whose tiers shrink towards the top.

    Parameters
    ----------
    footprint
        Outline of the building.
    tiers
        Number of tiers, each 4 m high.
    """
    step = (footprint.polygon.area / 3.2) ** 0.5 / 2 / tiers
    rings = [shapely.convex_hull(footprint.polygon).buffer(-step * i) for i in range(tiers)]
    kept = [(i, ring) for i, ring in enumerate(rings) if ring.area > 1]
    return one_object(block(r.exterior.coords[:-1], 4, base=4.0 * i) for i, r in kept)
