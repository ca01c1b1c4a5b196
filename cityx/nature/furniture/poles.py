"""Service poles with wires along the narrow streets of Japan."""

from __future__ import annotations

import numpy as np
import shapely

from cityx.city import City, MeshBatch
from cityx.city.ground import ROADWAY
from cityx.city.mesh import empty_batch
from cityx.geometry.arrays import FloatArray
from cityx.geometry.clearance import near_any
from cityx.geometry.polylines import Polylines
from cityx.ground.pieces import Pieces, heights, inside_extent, join_pieces, pieces
from cityx.ids import choose, hash_ids
from cityx.nature.land.barriers import joined_by_id, sweep
from cityx.road.surface.kerbs import KerbPlaces, edge_lengths, join_places, places_along, yaw_facing

PURPOSE = "nature/poles"
STREETS = ("residential", "unclassified", "tertiary", "living_street", "service")
WIDEST = 4.2  # metres of half carriageway; wider streets have their cables below ground
SHORTEST = 45.0  # metres of street
SPACING = 30.0  # metres between poles
FROM_KERB = 0.28  # metres from the edge of the carriageway to the middle of a pole
LEAST_WALK = 1.7  # metres
FACADE = 0.12  # metres to houses
LONGEST = 45.0  # metres of a span; where poles are missing, so are the wires
# Across the line, above the foot, sag at the middle and thickness; metres.
WIRES = ((-0.9, 9.8, 0.55, 0.012), (-0.35, 9.8, 0.5, 0.012), (0.9, 9.8, 0.6, 0.012),
         (-0.6, 8.75, 0.6, 0.016), (0.6, 8.75, 0.65, 0.016), (0.0, 6.3, 0.7, 0.035),
         (0.12, 5.9, 0.8, 0.028))  # fmt: skip
# Poles and how many of them there are: bare, and with advertisements.
KINDS = {"utility_pole": 4.0, "utility_pole_wrapped": 3.0, "utility_pole_board": 2.0}
PIECES = 8  # straight pieces of a span


def utility_poles(city: City, blocked: FloatArray) -> tuple[Pieces, MeshBatch]:
    """Set poles along one side of narrow streets and hang their wires.

    Parameters
    ----------
    city
        City with a road network.
    blocked
        (k, 2) places at which something stands already.

    Returns
    -------
    poles, wires
        The poles, and the wires as closed solids, one object per edge.
    """
    network, roads = city.network, city.layout.roads
    if network is None or not network.edge_count or city.ground is None:
        return join_pieces([]), empty_batch()
    row = network.edge_road
    narrow = np.isin(roads["kind"].to_numpy().astype(str), STREETS)
    narrow &= ~(roads["bridge"].to_numpy() | roads["tunnel"].to_numpy())
    narrow &= (roads["layer"].to_numpy() == 0) & ~roads["passage"].to_numpy()
    edges = np.flatnonzero(
        narrow[row] & (network.half_width < WIDEST) & (edge_lengths(network) > SHORTEST)
    )
    # The poles of a street keep to one side, which the whole way draws; a narrow walk has none.
    side = np.where(choose(city.seed, PURPOSE, roads["id"].to_numpy()[row[edges]], (1, 1)), 1, -1)
    walk = np.where(side > 0, roads["sidewalk_left"].to_numpy()[row[edges]],
                    roads["sidewalk_right"].to_numpy()[row[edges]])  # fmt: skip
    fits = (walk == 0) | (walk >= LEAST_WALK)
    edges, side = edges[fits], side[fits]
    places = join_places(*(
        places_along(network, edges[side == sign], sign, spacing=SPACING, beyond=FROM_KERB,
                     margin=4.0)
        for sign in (1, -1)
    ))  # fmt: skip
    free = inside_extent(city, places.xy, 0.5)
    free &= ~near_any(places.xy, city.layout.buildings.geometry.to_numpy(), FACADE)
    free &= ~near_any(places.xy, shapely.points(blocked), 1.0)
    free &= ~city.ground.on(places.xy, *ROADWAY)
    places = places.take(free)
    if not len(places.xy):
        return join_pieces([]), empty_batch()
    ids = hash_ids(0, PURPOSE, network.edge_id[places.edge], places.number)
    # The arms reach across the street's direction.
    kind = np.array(list(KINDS), object)[choose(city.seed, PURPOSE, ids, list(KINDS.values()))]
    poles = pieces(kind, places.xy, ids, yaw_facing(places.ahead))
    return poles, _wires(city, places)


def _wires(city: City, places: KerbPlaces) -> MeshBatch:
    """Hang wires between neighbours along an edge, as parabolas."""
    network = city.network
    assert network is not None
    order = np.lexsort((places.number, places.edge))
    a, b = order[:-1], order[1:]
    span = places.xy[b] - places.xy[a]
    hung = (places.edge[a] == places.edge[b]) & (np.hypot(*span.T) < LONGEST)
    a, b = a[hung], b[hung]
    if not len(a):
        return empty_batch()
    z = heights(city, places.xy)
    share = np.linspace(0.0, 1.0, PIECES + 1)
    start = np.arange(len(a) + 1) * (PIECES + 1)
    ids = hash_ids(0, f"{PURPOSE}/wires", network.edge_id[places.edge[a]])
    found = []
    for across, above, sag, thick in WIRES:
        ends = [
            places.xy[at] + across * np.column_stack([-places.ahead[at][:, 1],
                                                      places.ahead[at][:, 0]])
            for at in (a, b)
        ]  # fmt: skip
        way = ends[0][:, None] + share[:, None] * (ends[1] - ends[0])[:, None]
        foot = z[a][:, None] + share * (z[b] - z[a])[:, None]
        level = foot + above - 4 * sag * share * (1 - share)
        lines = Polylines(way.reshape(-1, 2), start)
        half = thick / 2
        profile = np.array([[half, 0.0], [0.0, thick], [-half, 0.0]])[::-1]
        size = np.ones((len(a), 2))
        tint = np.ones((len(a), 3))
        found.append(sweep(lines, ids, level.ravel(), profile, size, "rubber", tint))
    return joined_by_id(found)
