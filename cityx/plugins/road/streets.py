"""The surfaces of streets, the same on the ground and on structures."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from cityx.city.layout import Layout
from cityx.city.roads import RoadNetwork
from cityx.geometry.arrangement import Regions, join_regions
from cityx.plugins.road.carriageway import Carriageway, build_carriageway
from cityx.plugins.road.carriageway_regions import carriageway_regions
from cityx.plugins.road.drops import drive_regions, dropped_regions
from cityx.plugins.road.junction_paving import junction_paving, paved_mouths, setts_at
from cityx.plugins.road.landcover import kerbed_areas
from cityx.plugins.road.markings import marking_regions
from cityx.plugins.road.marks import USUAL, painted_edges, street_of
from cityx.plugins.road.medians import median_regions
from cityx.plugins.road.painting import Painting
from cityx.plugins.road.refuges import refuge_regions
from cityx.plugins.road.roundabouts import roundabout_regions
from cityx.plugins.road.sections import bands_of
from cityx.plugins.road.strips import strip_regions, threshold_regions
from cityx.plugins.road.verges import verge_regions
from cityx.plugins.road.zebras import joined, mouth_crossings, zebras_of


def street_regions(
    layout: Layout, network: RoadNetwork, painting: Painting = USUAL
) -> tuple[Regions, Carriageway]:
    """Return carriageways, junctions, kerbs, walks and markings of all edges of a network.

    Parameters
    ----------
    layout
        The layout.
    network
        Its roads, or pieces of them.
    painting
        What the country paints.
    """
    chosen = np.ones(network.edge_count, bool)
    road = build_carriageway(layout, network, chosen)
    road = replace(road, drawn=kerbed_areas(layout, network, road))
    bands = bands_of(layout, network)
    street = street_of(layout, network, bands, painting)
    painted = painted_edges(street, chosen)
    zebras = zebras_of(street, painted, road)
    mouths = mouth_crossings(street, painted, road)
    crossings = joined(zebras, mouths)
    setts = paved_mouths(street, crossings, painting)
    ends = setts_at(street, crossings, setts)
    found = join_regions([
        carriageway_regions(layout, network, chosen, road),
        strip_regions(layout, network, bands, chosen, gutters=painting.gutters),
        threshold_regions(layout, network, chosen),
        verge_regions(network, bands),
        marking_regions(street, zebras, painted, road, painting, ends),
        junction_paving(street, crossings, setts, road, painting),
        dropped_regions(street, zebras, mouths, road, painting.ribs),
        drive_regions(street, road),
        refuge_regions(street, zebras, painting.ribs),
        median_regions(layout, network, chosen),
        roundabout_regions(layout, network, chosen),
    ])  # fmt: skip
    return found, road
