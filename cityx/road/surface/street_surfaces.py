"""The surfaces of streets, the same on the ground and on structures."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from cityx.city.layout import Layout
from cityx.city.roads import RoadNetwork
from cityx.ground.arrangement import Regions, join_regions
from cityx.places.painting import Painting
from cityx.road.ground.landcover import kerbed_areas
from cityx.road.markings.markings import marking_regions
from cityx.road.markings.marks import USUAL, painted_edges, street_of
from cityx.road.markings.zebras import joined, mouth_crossings, zebras_of
from cityx.road.network.medians import median_regions
from cityx.road.network.sections import bands_of
from cityx.road.surface.carriageway import Carriageway, build_carriageway
from cityx.road.surface.carriageway_regions import carriageway_regions
from cityx.road.surface.drops import drive_regions, dropped_regions
from cityx.road.surface.junction_paving import junction_paving, paved_mouths, setts_at
from cityx.road.surface.refuges import refuge_regions
from cityx.road.surface.roundabouts import roundabout_regions
from cityx.road.surface.strips import strip_regions, threshold_regions
from cityx.road.surface.verges import verge_regions


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
