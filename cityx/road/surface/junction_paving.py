"""Paving that warns of pedestrians: setts across side-street mouths, coats on crossroads.

References
----------
Department for Transport, "Manual for Streets", 2007, 6.3.9: where a footway meets a side road the
kerb line stays tight and a table or another paving leads those on foot across the mouth.
National Police Agency of Japan, "Traffic regulation standard": coloured paving and a cross tell
amid narrow crossroads without signals that others come from the side.
"""

from __future__ import annotations

import numpy as np
import shapely

from cityx.city.ground import LABEL, SURFACES
from cityx.geometry.arrays import BoolArray, FloatArray, IntArray
from cityx.geometry.polylines import locate
from cityx.ground.arrangement import Regions, join_regions, regions
from cityx.places.painting import Painting
from cityx.road.markings.centre_marks import CROSS_ARMS, minor_junctions
from cityx.road.markings.crossing_places import dense_places
from cityx.road.markings.marks import PLAIN, Shapes, Street, boxes
from cityx.road.markings.zebras import Zebras
from cityx.road.network.through_roads import stems, through_roads
from cityx.road.surface.carriageway import Carriageway, joined_by
from cityx.road.surface.drops import FREE_SIDE

WIDEST = 9.5  # metres of a street that setts cross
AT_MOUTH = 5.0  # metres from where kerbs have curved to a crossing at a mouth
EDGE_ROW = 0.2  # metres of the row of stones on both sides of the setts
FROM_KERB = 0.02  # metres between what is paved and the rims of what is driven on
LEAST = 4.0  # square metres of what is paved
COAT_INSET = 0.3  # metres between a coat and the kerbs


def paved_mouths(street: Street, crossings: Zebras, painting: Painting) -> BoolArray:
    """(z,) crossings on setts: those without paint, in town, where a narrow street ends at a road.

    Parameters
    ----------
    street
        The network and what its marks share.
    crossings
        Crossings of the map and those of signals, and where walks go on across mouths.
    painting
        What the country paints.
    """
    edge, end, back = _ends(street, crossings)
    if not painting.paved_mouths or not len(edge):
        return np.zeros(len(edge), bool)
    network = street.network
    node = network.edge_nodes[edge, end]
    minor = street.rank[edge] > street.best[node]
    minor |= stems(street, through_roads(street))[edge, end]
    near = back - crossings.depth / 2 - street.mouth[edge, end] < AT_MOUTH
    narrow = 2 * network.half_width[edge] < WIDEST
    alone = np.bincount(street.cluster, minlength=len(street.cluster))[street.cluster[node]] == 1
    town = dense_places(street.layout, locate(street.lines, edge, crossings.along)[0])
    plain = (crossings.kind == PLAIN) & ~street.signalled[node]
    return np.asarray(plain & near & minor & narrow & alone & town)


def setts_at(street: Street, crossings: Zebras, chosen: BoolArray) -> FloatArray:
    """(e, 2, 2) metres from the nodes at both ends to where setts begin and end, else NaN."""
    found = np.full((street.network.edge_count, 2, 2), np.nan)
    edge, end, back = _ends(street, crossings)
    half = crossings.depth / 2 + FREE_SIDE + EDGE_ROW
    reach = np.column_stack([back - half, back + half])
    found[edge[chosen], end[chosen]] = reach[chosen]
    return found


def junction_paving(
    street: Street, crossings: Zebras, chosen: BoolArray, road: Carriageway, painting: Painting
) -> Regions:
    """Lay setts between rows of stones at the chosen crossings, and coats on crossroads.

    Parameters
    ----------
    street, road
        The network and its surfaces.
    crossings, chosen
        Crossings, and which of them lie on setts.
    painting
        What the country paints.
    """
    parts = [_across(street, crossings, chosen, road)]
    if painting.coated_crossroads:
        parts.append(_coats(street, road))
    return join_regions(parts)


def _ends(street: Street, crossings: Zebras) -> tuple[IntArray, IntArray, FloatArray]:
    """(z,) the edge of each crossing, its nearer end, and the metres from its node."""
    edge, along = crossings.edge, crossings.along
    rest = street.length[edge] - along
    return edge, (rest < along).astype(np.int64), np.minimum(along, rest)


def _across(street: Street, crossings: Zebras, chosen: BoolArray, road: Carriageway) -> Regions:
    rows = np.flatnonzero(chosen)
    if not len(rows):
        return Regions()
    edge, depth = crossings.edge[rows], crossings.depth[rows] + 2 * FREE_SIDE
    width = 2 * (street.network.half_width[edge] + crossings.flare[rows])

    def strips(size: FloatArray) -> Shapes:
        none = np.zeros(len(edge))
        shapes, _ = boxes(street.lines, edge, crossings.along[rows], none, size, width)
        return _on_road(shapes, road)

    whole, setts = strips(depth + 2 * EDGE_ROW), strips(depth)
    laid = shapely.area(setts) > LEAST
    edging = shapely.difference(whole[laid], setts[laid])
    rank = SURFACES[LABEL["mouth_setts"]].priority
    return join_regions([
        regions(setts[laid], LABEL["mouth_setts"], rank),
        regions(shapely.get_parts(edging), LABEL["threshold"], rank),
    ])  # fmt: skip


def _coats(street: Street, road: Carriageway) -> Regions:
    nodes = minor_junctions(street)
    nodes = nodes[street.network.node_degree[nodes] == CROSS_ARMS]
    here = np.isin(road.node, nodes)
    if not here.any():
        return Regions()
    at_corner = np.isin(road.curve_node, nodes)
    shapes = np.concatenate([road.stars[here], road.curves[at_corner]])
    node = np.concatenate([road.node[here], road.curve_node[at_corner]])
    whole, _ = joined_by(shapes, node)
    # The curves of corners go on along the arms, where coats end square.
    rows = np.flatnonzero(here)[np.argsort(road.node[here], kind="stable")]
    coats = shapely.intersection(
        shapely.buffer(whole, -COAT_INSET), shapely.convex_hull(road.stars[rows])
    )
    coats = shapely.get_parts(coats)
    label = LABEL["coat"]
    return regions(coats[shapely.area(coats) > LEAST], label, SURFACES[label].priority)


def _on_road(shapes: Shapes, road: Carriageway) -> Shapes:
    """Cut shapes to what is driven on, a hair within its rims."""
    driven = road.kerbed
    row, surface = shapely.STRtree(driven).query(shapes, predicate="intersects")
    paved, own = joined_by(driven[surface], row)
    found = np.full(len(shapes), shapely.Polygon(), object)
    found[own] = shapely.intersection(shapes[own], shapely.buffer(paved, -FROM_KERB))
    return found
