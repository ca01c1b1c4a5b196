"""Streets for a traffic simulator: one-way edges between junctions, and links."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from cityx.geometry.arrays import BoolArray, FloatArray, IntArray
from cityx.ground.walking.mapped_crossings import MappedCrossings


@dataclass(frozen=True)
class Halts:
    """Where traffic halts before junctions, and what rules them.

    Attributes
    ----------
    gap
        (e, 2) float64, metres from where the lanes of an edge begin and end, at its start and its
        end, to the line before which one halts there.
    signals
        (n,) bool, whether signals rule a node of the network.
    rank
        (e,) int64, the higher the more important; traffic from lower ranks gives way.
    zebra
        (e, 2) bool, whether people cross an edge near its start and its end.
    zebra_at
        (e, 2) float64, metres from that end to the middle of where they cross.
    zebra_width
        (e,) float64, metres along the street that they cross on.
    bare, bare_gap
        (e, 2) whether people cross there where nothing is painted, and what is `gap` then.
    between
        Where the map has crossings on the streets.
    """

    gap: FloatArray
    signals: BoolArray
    rank: IntArray
    zebra: BoolArray
    zebra_at: FloatArray
    zebra_width: FloatArray
    bare: BoolArray
    bare_gap: FloatArray
    between: MappedCrossings

    def with_bare(self) -> Halts:
        """Return the halts before all crossings, painted or not."""
        gap = np.where(self.bare, self.bare_gap, self.gap)
        return replace(self, gap=gap, zebra=self.zebra | self.bare)


@dataclass(frozen=True)
class Lane:
    """A lane as the simulator has it.

    Attributes
    ----------
    row
        Of the lane graph.
    kind
        One of `cityx.city.section.BAND_KINDS`.
    width
        Metres.
    speed
        Metres per second.
    shape
        (k, 3) float64, its middle in the direction of travel.
    narrow
        Whether it is driven in both directions and two cars cannot pass each other on it.
    closed
        Whether nobody drives on it, since it lies on a lane of another street or in a house.
    tight
        Whether walls leave no room for lorries and buses.
    local
        "private" or "destination" where cars drive only that belong there or stop there, else "".
    """

    row: int
    kind: str
    width: float
    speed: float
    shape: FloatArray
    narrow: bool
    closed: bool = False
    tight: bool = False
    local: str = ""

    @property
    def public(self) -> bool:
        """Whether any car may drive on it."""
        return self.kind == "drive" and not self.closed and not self.local

    @cached_property
    def length(self) -> float:
        """Metres."""
        return float(np.linalg.norm(np.diff(self.shape, axis=0), axis=1).sum())


@dataclass(frozen=True)
class Way:
    """One direction of an edge of the network.

    Attributes
    ----------
    name
        Id of the edge of the network, with a minus where it is driven against it.
    edge
        Row of the network.
    source, target
        Junctions it leads from and to.
    rank
        As of `Halts`.
    lanes
        From the kerb to the middle of the road; walks come first.
    apart
        For each lane but the last, whether something lies between it and the next.
    """

    name: str
    edge: int
    source: int
    target: int
    rank: int
    lanes: tuple[Lane, ...]
    apart: tuple[bool, ...]

    @property
    def driven(self) -> bool:
        """Whether it has more than a walk."""
        return any(lane.kind != "walk" for lane in self.lanes)

    @cached_property
    def length(self) -> float:
        """Metres, the mean of its lanes."""
        return float(np.mean([lane.length for lane in self.lanes]))


@dataclass(frozen=True)
class Link:
    """A way across a junction from one lane to another.

    Attributes
    ----------
    source, target
        Way and lane on it.
    shape
        (k, 3) float64, from the end of the one lane to the start of the other.
    tight
        Whether lorries and buses would sweep over the lanes or the walls beside it.
    """

    source: tuple[int, int]
    target: tuple[int, int]
    shape: FloatArray
    tight: bool = False


@dataclass(frozen=True)
class Crossing:
    """A place where people cross a street before a junction.

    Attributes
    ----------
    edge, end
        Of the network, and which end of it, 0 or 1.
    junction
        That it belongs to.
    ways
        Ways that are crossed, with more than a walk.
    width
        Metres along the street.
    shape
        (2, 3) float64, from kerb to kerb, counter-clockwise round the junction.
    first
        Whether vehicles let people go first.
    """

    edge: int
    end: int
    junction: int
    ways: tuple[int, ...]
    width: float
    shape: FloatArray
    first: bool = True


@dataclass(frozen=True)
class Streets:
    """What a simulator knows of the streets of a city.

    Attributes
    ----------
    ways
        The ways.
    links
        The links between their lanes.
    crossings
        Where people cross.
    place
        (j, 3) float64, the junctions.
    signals
        (j,) bool, whether signals rule them.
    left_hand
        Whether traffic keeps to the left.
    undriven
        Ways across junctions that are left out, since a simulator rules no more at one.
    """

    ways: tuple[Way, ...]
    links: tuple[Link, ...]
    crossings: tuple[Crossing, ...]
    place: FloatArray
    signals: BoolArray
    left_hand: bool
    undriven: int = 0
