"""Verges: green strips of a cross-section between the carriageway and the sidewalk or the land."""

from __future__ import annotations

import numpy as np

from cityx.city.ground import KERB_WIDTH
from cityx.city.roads import RoadNetwork
from cityx.city.section import KIND
from cityx.ground.arrangement import Regions, join_regions
from cityx.road.network.sections import Bands
from cityx.road.surface.strips import BEFORE, edge_strips

PRIORITY = 52  # above the sidewalk and its strip for furniture
UNDER_KERB = 51  # where there is no kerb, grass begins at the carriageway


def verge_regions(network: RoadNetwork, bands: Bands) -> Regions:
    """Return the verges of edges, short of junctions and crossings.

    Parameters
    ----------
    network
        The road network.
    bands
        Its cross-sections.
    """
    found = []
    verges = bands.take(bands.kind == KIND["verge"])
    for sign in (1.0, -1.0):
        rows = verges.take(sign * verges.middle > 0)
        for size in np.unique(np.round(rows.width, 3)).tolist():
            chosen = rows.take(np.round(rows.width, 3) == size)
            inner, edges = np.zeros(network.edge_count), chosen.edge
            inner[edges] = sign * np.where(sign > 0, chosen.right, -chosen.left)
            for at, wide, priority in (
                (size / 2, size, PRIORITY),
                (-KERB_WIDTH / 2, KERB_WIDTH, UNDER_KERB),
            ):
                lateral = inner + sign * at
                found.append(edge_strips(network, edges, lateral, wide, "grass", priority, BEFORE))
    return join_regions(found)
