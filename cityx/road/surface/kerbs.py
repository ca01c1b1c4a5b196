"""Places along kerbs: where lamps, street trees and parked cars stand."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cityx.city.roads import RoadNetwork
from cityx.geometry.arrays import FloatArray
from cityx.geometry.polylines import arc_lengths, every, locate, values_along

GROUNDED = 0.05  # metres; a street that is farther off the ground lies on a bridge or in a cutting


@dataclass(frozen=True)
class KerbPlaces:
    """n places beside carriageways.

    Attributes
    ----------
    xy
        (n, 2) float, metres.
    ahead
        (n, 2) float, unit vectors in the direction of the edge.
    edge
        (n,) int, edge of the network.
    side
        (n,) int, +1 left of the edge's direction, -1 right.
    number
        (n,) int, place along its side, from 0.
    """

    xy: FloatArray
    ahead: FloatArray
    edge: NDArray[np.int64]
    side: NDArray[np.int64]
    number: NDArray[np.int64]

    @property
    def toward_road(self) -> FloatArray:
        """(n, 2) unit vectors square to the kerb, towards the carriageway."""
        left = np.column_stack([-self.ahead[:, 1], self.ahead[:, 0]])
        return np.asarray(-left * self.side[:, None])

    def take(self, rows: ArrayLike) -> KerbPlaces:
        """Return some of the places, by mask or by index."""
        index = np.asarray(rows)
        return KerbPlaces(self.xy[index], self.ahead[index], self.edge[index], self.side[index],
                          self.number[index])  # fmt: skip


def edge_lengths(network: RoadNetwork) -> FloatArray:
    """(e,) length of each edge, metres."""
    return arc_lengths(network.lines)[1]


def places_along(
    network: RoadNetwork,
    edges: ArrayLike,
    side: int,
    *,
    spacing: float,
    beyond: float,
    margin: ArrayLike,
    phase: float = 0.0,
) -> KerbPlaces:
    """List places at a regular spacing along one side of edges, clear of the junctions.

    Parameters
    ----------
    network
        The road network.
    edges
        (k,) int, the edges.
    side
        +1 for the left side of the edge's direction, -1 for the right.
    spacing
        Metres along the centreline.
    beyond
        Metres from the kerb outwards; negative inside the carriageway.
    margin
        Metres kept free behind the trims at both ends, or (k, 2) at the start and the end of each.
    phase
        Share of the spacing by which all places are moved ahead.
    """
    chosen = np.asarray(edges, np.int64)
    lines = network.lines
    length = arc_lengths(lines)[1]
    free = (length - network.trim.sum(axis=1))[chosen]
    first, last = np.broadcast_to(np.asarray(margin, float), (len(chosen), 2)).T
    row, along = every(free - first - last, spacing)
    along = along + first[row]
    if phase:
        along = along + phase * spacing
        keep = along <= (free - last)[row]
        row, along = row[keep], along[keep]
    number = np.arange(len(row)) - np.searchsorted(row, row)
    edge = chosen[row]
    at = along + network.trim[edge, 0]
    # What stands beside a street stands on the ground.
    level = np.abs(values_along(lines, network.lift, edge, at)) < GROUNDED
    edge, at = edge[level], at[level]
    position, ahead = locate(lines, edge, at)
    left = np.column_stack([-ahead[:, 1], ahead[:, 0]])
    offset = side * (network.half_width[edge] + beyond)
    sides = np.full(len(edge), side, np.int64)
    return KerbPlaces(position + left * offset[:, None], ahead, edge, sides,
                      number[level])  # fmt: skip


def join_places(*groups: KerbPlaces) -> KerbPlaces:
    """Join lists of places."""
    return KerbPlaces(
        np.concatenate([g.xy for g in groups]), np.concatenate([g.ahead for g in groups]),
        np.concatenate([g.edge for g in groups]), np.concatenate([g.side for g in groups]),
        np.concatenate([g.number for g in groups]),
    )  # fmt: skip


def yaw_facing(direction: ArrayLike) -> FloatArray:
    """(n,) turn about z that makes a prototype, front -y, face (n, 2) directions."""
    way = np.asarray(direction, float).reshape(-1, 2)
    return np.arctan2(way[:, 0], -way[:, 1])


def yaw_of_compass(angle: ArrayLike) -> FloatArray:
    """(n,) turn about z that makes a prototype, front -y, face a compass angle (radians)."""
    return np.pi - np.asarray(angle, float)
