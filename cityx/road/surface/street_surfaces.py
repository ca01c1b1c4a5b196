"""The surfaces of streets, the same on the ground and on structures."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from cityx.city.ground import KERB_WIDTH
from cityx.city.layout import Layout
from cityx.city.roads import RoadNetwork
from cityx.city.section import KIND
from cityx.ground.arrangement import Regions, join_regions
from cityx.places.painting import Painting
from cityx.road.ground.landcover import kerbed_areas
from cityx.road.markings.markings import marking_regions
from cityx.road.markings.marks import USUAL, painted_edges, street_of
from cityx.road.markings.zebras import joined, mouth_crossings, zebras_of
from cityx.road.network.medians import median_regions
from cityx.road.network.sections import Bands, bands_of
from cityx.road.surface.carriageway import Carriageway, build_carriageway
from cityx.road.surface.carriageway_regions import carriageway_regions
from cityx.road.surface.drops import drive_regions, dropped_regions
from cityx.road.surface.junction_paving import junction_paving, paved_mouths, setts_at
from cityx.road.surface.refuges import refuge_regions
from cityx.road.surface.roundabouts import roundabout_regions
from cityx.road.surface.strips import BEFORE, edge_strips, strip_regions, threshold_regions

# Verges: green strips of a cross-section between the carriageway and the sidewalk or the land.

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
