"""Waiting times: the first vehicle at a stop line, and how long others alone have held it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

LINE = 3.0  # metres before a junction at which the first of a lane waits
CLOSED = frozenset("ryu")  # states of a way across a junction while signals bar it


def lanes_of(sumo: Any) -> dict[str, str]:
    """Return the lane of every vehicle; it is asked for once a look, and shared."""
    lane = sumo.vehicle.getLaneID
    return {name: lane(name) for name in sumo.vehicle.getIDList()}


class Waiting:
    """Counts the seconds of those who stand at lines; a class since it knows since when."""

    def __init__(self, sumo: Any) -> None:
        self.sumo = sumo
        self.since: dict[str, float] = {}

    def step(self, lanes: Mapping[str, str] | None = None) -> dict[str, float]:
        """Return who stands at a line that no signal bars, and for how many seconds it has.

        Parameters
        ----------
        lanes
            Of all vehicles, as of `lanes_of`; None asks for them.
        """
        now = self.sumo.simulation.getTime()
        lanes = lanes_of(self.sumo) if lanes is None else lanes
        names = [name for name, lane in lanes.items() if self._held(name, lane)]
        self.since = {name: self.since.get(name, now) for name in names}
        return {name: now - since for name, since in self.since.items()}

    def _held(self, name: str, lane: str) -> bool:
        vehicle = self.sumo.vehicle
        if not lane or lane.startswith(":") or vehicle.getWaitingTime(name) <= 0.0:
            return False
        if not before_line(self.sumo, name):
            return False
        links = vehicle.getNextLinks(name)
        return not links or links[0][5] not in CLOSED


def before_line(sumo: Any, name: str) -> bool:
    """Return whether a vehicle is at the end of a lane before a junction."""
    lane = sumo.vehicle.getLaneID(name)
    if not lane or lane.startswith(":"):
        return False
    return bool(sumo.lane.getLength(lane) - sumo.vehicle.getLanePosition(name) <= LINE)
