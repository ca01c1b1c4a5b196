"""A pagoda: tiers that shrink towards the top."""

from typing import Annotated

from cityx.city import MeshBatch
from cityx.protocol import Range
from cityx.protocol.plugged import generator
from cityx.protocol.solid_blocks import block, one_object
from cityx.protocol.values import Footprint


@generator("building/pagoda-v1", labels=["stupa"], styles={"chinese": 1}, like="shop_house")
def pagoda(footprint: Footprint, *, tiers: Annotated[int, Range(1, 9)] = 5) -> MeshBatch:
    """Raise a building into a pagoda whose tiers shrink towards the top.

    Parameters
    ----------
    footprint
        Outline of the building.
    tiers
        Number of tiers, each 4 m high.
    """
    step = (footprint.polygon.area / 3.2) ** 0.5 / 2 / tiers
    plans = [footprint.polygon.buffer(-step * i, join_style="mitre") for i in range(tiers)]
    blocks = ((4.0 * i, p) for i, plan in enumerate(plans) for p in getattr(plan, "geoms", [plan]))
    return one_object(
        block(p.exterior.coords[:-1], 4, base=low, holes=[h.coords[:-1] for h in p.interiors])
        for low, p in blocks
        if p.area > 1
    )
