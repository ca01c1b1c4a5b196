"""Prevent head-on conflicts: no vehicle enters a junction against one in the same narrow lane."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import sqrt
from typing import Any

from cityx.traffic.waiting import lanes_of

BRAKING = 2.5  # metres per second squared at which drivers brake for who comes towards them
HARDEST = 4.0  # metres per second squared; who would have to brake harder drives on
REACTION = 0.5  # seconds between two looks
STANDS = 0.3  # metres before the line at which one stands
FREE = -1.0  # speed by which SUMO drives as it likes


class Facing:
    """Holds vehicles that would meet another head-on at the line; remembers who is on junctions.

    Parameters
    ----------
    sumo
        SUMO.
    against
        Lane across a junction to those that nobody may begin while somebody is on it.
    """

    def __init__(self, sumo: Any, against: Mapping[str, Sequence[str]]) -> None:
        self.sumo = sumo
        self.against = {lane: frozenset(others) for lane, others in against.items()}
        self.on: dict[str, str] = {}  # vehicle -> lane across a junction that it is on
        self.held: set[str] = set()
        self.length: dict[str, float] = {}
        self.leads: dict[str, frozenset[str]] = {}  # lane -> lanes across, of those that are held
        barred = frozenset().union(*self.against.values())
        for lane in sumo.lane.getIDList() if barred else ():
            onto = frozenset(link[4] for link in sumo.lane.getLinks(lane)) & barred
            if onto:
                self.leads[lane], self.length[lane] = onto, sumo.lane.getLength(lane)

    def step(self, lanes: Mapping[str, str] | None = None) -> None:
        """Hold who comes to such a way, and let go whom nothing hinders any more.

        Parameters
        ----------
        lanes
            Of all vehicles, as of `lanes_of`; None asks for them.
        """
        if not self.against:
            return
        vehicle = self.sumo.vehicle
        lanes = lanes_of(self.sumo) if lanes is None else lanes
        self.on = {name: lane for name, lane in self.on.items() if name in lanes}
        for name, lane in lanes.items():
            if lane in self.against:
                self.on[name] = lane
            elif name in self.on and (
                lane.startswith(":") or vehicle.getLanePosition(name) >= vehicle.getLength(name)
            ):  # fmt: skip
                del self.on[name]
        taken = {*self.on.values(), *self._entered(lanes)}
        barred = frozenset().union(*(self.against[lane] for lane in taken))
        held = {
            name for name, lane in lanes.items()
            if not barred.isdisjoint(self.leads.get(lane, ())) and self._hold(name, lane, barred)
        }  # fmt: skip
        for name in sorted(self.held - held):
            if name in lanes:
                vehicle.setSpeed(name, FREE)
        self.held = held

    def _entered(self, lanes: Mapping[str, str]) -> set[str]:
        """Return the lanes across junctions onto which somebody comes who cannot stop any more."""
        vehicle, found = self.sumo.vehicle, set()
        for name, lane in lanes.items():
            if lane not in self.leads or name in self.held:
                continue
            speed = vehicle.getSpeed(name)
            left = self.length[lane] - vehicle.getLanePosition(name)
            if speed > 0.0 and left < speed * REACTION + speed**2 / (2 * HARDEST):
                links = vehicle.getNextLinks(name)
                if links and links[0][1] and links[0][4] in self.against:
                    found.add(links[0][4])
        return found

    def _hold(self, name: str, lane: str, barred: frozenset[str]) -> bool:
        """Brake somebody before the line, if it is on its way there and still can."""
        vehicle = self.sumo.vehicle
        left = max(self.length[lane] - vehicle.getLanePosition(name) - STANDS, 0.0)
        speed = vehicle.getSpeed(name)
        slow = sqrt((BRAKING * REACTION) ** 2 + 2 * BRAKING * left) - BRAKING * REACTION
        if (speed < slow and left > STANDS) or speed**2 > 2 * HARDEST * (left + STANDS):
            return False
        links = vehicle.getNextLinks(name)
        if not links or links[0][4] not in barred:
            return False
        vehicle.setSpeed(name, slow)
        return True
