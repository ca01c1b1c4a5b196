"""Signs at junctions: give way, stop, no entry, crossings, street names; barriers at railways."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city import City
from cityx.geometry.arrays import FloatArray
from cityx.geometry.clearance import near_any
from cityx.geometry.polylines import locate, pack
from cityx.ground.pieces import Pieces, join_pieces, pieces
from cityx.ids import hash_ids, uniform
from cityx.places.profiles import keeps_left, profile_of
from cityx.road.markings.marks import STRIPED, street_of
from cityx.road.network.network import DRIVABLE
from cityx.road.network.sections import bands_of
from cityx.road.network.signal_places import signal_places
from cityx.road.surface.kerbs import edge_lengths, yaw_facing

PURPOSE = "nature/signs"
# The lower gives way to the higher.
RANK = {"motorway": 6, "trunk": 6, "primary": 5, "secondary": 4, "tertiary": 3, "unclassified": 2,
        "residential": 2, "living_street": 1, "service": 0}  # fmt: skip
FROM_KERB = 0.45  # metres from the kerb to a pole
BEHIND = 0.8  # metres before the junction
BESIDE = 0.3  # metres from a zebra to a beacon
ZEBRA = 4.2  # metres that a zebra takes before the junction
SIGNALLED = 30.0  # metres from a mapped signal within which no sign rules
NAMED = 0.8  # share of the arms of junctions that tell their name
TRACKS = 20.0  # metres of street between tracks that one pair of barriers closes
BEFORE_TRACK = 5.0  # metres from the nearest track to a barrier
TOLD = 15.0  # metres from a mapped sign within which none is added


def junction_signs(city: City) -> tuple[Pieces, FloatArray]:
    """Draw the signs of every junction.

    Returns
    -------
    signs, outward
        The signs, and (n, 2) unit vectors from each away from the carriageway.
    """
    network = city.network
    if network is None or not network.edge_count:
        return join_pieces([]), np.zeros((0, 2))
    roads = city.layout.roads
    kind = roads["kind"].to_numpy().astype(str)[network.edge_road]
    rank = np.array([RANK.get(name.removesuffix("_link"), -1) for name in kind])
    oneway = roads["oneway"].to_numpy()[network.edge_road]
    flat = (roads["layer"].to_numpy() == 0) & ~roads["tunnel"].to_numpy()
    flat = (flat & ~roads["bridge"].to_numpy())[network.edge_road]
    roundabout = roads["roundabout"].to_numpy()[network.edge_road]
    top = np.full(len(network.node_position), -1)
    np.maximum.at(top, network.edge_nodes.ravel(), np.repeat(rank, 2))
    ring = np.zeros(len(top), bool)
    ring[network.edge_nodes[roundabout].ravel()] = True
    joint = network.node_degree >= 3
    points = city.layout.points
    what, where = points["kind"].to_numpy().astype(str), points.geometry.to_numpy()
    profile = profile_of(city.frame)
    painting, local = profile.painting, profile.streets
    street = street_of(city.layout, network, bands_of(city.layout, network), painting)
    signalled = near_any(network.node_position, signal_places(city.layout), SIGNALLED)
    told = near_any(network.node_position, where[np.isin(what, ("stop", "give_way"))], TOLD)
    drive = np.where(network.left_hand, -1.0, 1.0)
    length = edge_lengths(network)
    long = length > network.trim.sum(axis=1) + 8.0
    found: list[tuple[Pieces, FloatArray]] = []
    for end in (0, 1):
        node = network.edge_nodes[:, end]
        here = joint[node] & flat & long & (rank >= 0) & ~roundabout
        arrives = (end == 1) | ~oneway
        yields = here & arrives & ~signalled[node] & ~told[node]
        yields &= ((rank < top[node]) | ring[node]) & (rank >= 1)
        zebra = street.crossing[:, end] == STRIPED
        found.append(
            _at(network, local.minor_sign, np.flatnonzero(yields), end, BEHIND, drive, True)
        )
        entry = here & oneway & (end == 1)
        found.append(
            _at(network, "sign_no_entry", np.flatnonzero(entry), end, BEHIND + 1.5, -drive, False)
        )
        into = here & oneway & (end == 0)
        found.append(_at(network, "sign_one_way", np.flatnonzero(into), end, BEHIND, -drive, False))
        told_zebra = here & zebra & ~signalled[node] & local.zebra_signs
        if painting.beacons:
            rows = np.flatnonzero(told_zebra)
            off = (street.setback[:, end] + street.depth)[rows] + BESIDE
            sides = [_at(network, "belisha_beacon", rows, end, off, side * drive, True)
                     for side in (1.0, -1.0)]  # fmt: skip
            far = hash_ids(0, f"{PURPOSE}/far", sides[1][0].id)
            found += [sides[0], (replace(sides[1][0], id=far), sides[1][1])]
        else:
            rows = np.flatnonzero(told_zebra & arrives)
            found.append(_at(network, "sign_crossing", rows, end, ZEBRA, drive, True))
        named = here & (roads["name"].to_numpy().astype(str)[network.edge_road] != "")
        # Most arms tell their name.
        some = uniform(city.seed, f"{PURPOSE}/name", network.edge_id, end) < NAMED
        if local.name_signs:
            found.append(
                _at(network, "sign_name", np.flatnonzero(named & some), end, 0.3, -drive, True)
            )
    return join_pieces([f[0] for f in found]), np.concatenate([f[1] for f in found])


def level_crossing_posts(city: City) -> Pieces:
    """Set half barriers where streets cross railways on the ground, one for each way."""
    roads = city.layout.roads
    kind = roads["kind"].to_numpy().astype(str)
    ground = (roads["layer"] == 0).to_numpy() & ~(roads["bridge"] | roads["tunnel"]).to_numpy(bool)
    rails = np.flatnonzero(ground & np.isin(kind, ("rail", "light_rail", "narrow_gauge")))
    streets = np.flatnonzero(ground & np.isin(kind, DRIVABLE))
    lines, ids = roads.geometry.to_numpy(), roads["id"].to_numpy(np.uint64)
    of, track = shapely.STRtree(lines[rails]).query(lines[streets], predicate="intersects")
    if not len(of):
        return join_pieces([])
    street = streets[of]
    spots, pair = shapely.get_parts(
        shapely.intersection(lines[street], lines[rails[track]]), return_index=True
    )
    at = shapely.line_locate_point(lines[street[pair]], shapely.centroid(spots))
    order = np.lexsort((at, street[pair]))
    row, at = street[pair][order], at[order]
    first = np.flatnonzero((np.diff(row, prepend=-1) != 0) | (np.diff(at, prepend=-1e9) > TRACKS))
    last = np.append(first[1:], len(row)) - 1
    drive = -1.0 if keeps_left(city.frame) else 1.0
    half = np.nan_to_num(roads["width"].to_numpy()[row[first]]) / 2 + FROM_KERB
    packed = pack(lines[row[first]])
    every = np.arange(len(first))
    found = []
    for way, along in ((1.0, at[first] - BEFORE_TRACK), (-1.0, at[last] + BEFORE_TRACK)):
        arrives = (way > 0) | ~roads["oneway"].to_numpy(bool)[row[first]]
        position, ahead = locate(packed, every, along)
        travel = way * ahead
        right = np.column_stack([travel[:, 1], -travel[:, 0]]) * drive
        own = hash_ids(0, f"{PURPOSE}/level_crossing/{way:+.0f}", ids[row[first]], every)
        xy = position + half[:, None] * right
        found.append(pieces("level_crossing", xy, own, yaw_facing(-travel)).take(arrives))
    return join_pieces(found)


def _at(network: Any, name: str, edge: NDArray[np.int64], end: int, behind: Any,
        drive: FloatArray, facing: bool) -> tuple[Pieces, FloatArray]:  # fmt: skip
    """Poles beside the ends of edges, some metres `behind` the junction.

    They are `facing` the traffic that arrives, or who would enter.
    """
    lines = network.lines
    setback = network.trim[edge, end] + behind
    along = setback if end == 0 else edge_lengths(network)[edge] - setback
    position, ahead = locate(lines, edge, along)
    travel = ahead if end == 1 else -ahead
    out = np.column_stack([travel[:, 1], -travel[:, 0]]) * drive[edge][:, None]
    xy = position + out * (network.half_width[edge] + FROM_KERB)[:, None]
    ids = hash_ids(0, f"{PURPOSE}/{name}/{end}", network.edge_id[edge])
    if name == "sign_name":
        yaw = np.arctan2(ahead[:, 1], ahead[:, 0])
    else:
        yaw = yaw_facing(-travel if facing else travel)
    return pieces(name, xy, ids, yaw), out
