"""Who is first at a line, and for how long nothing but others has kept it there."""

from __future__ import annotations

from typing import Any

LINE = 3.0  # metres before a junction at which the first of a lane waits
CLOSED = frozenset("ryu")  # states of a way across a junction while signals bar it


class Waiting:
    """Counts the seconds of those who stand at lines; a class since it knows since when."""

    def __init__(self, sumo: Any) -> None:
        self.sumo = sumo
        self.since: dict[str, float] = {}

    def step(self) -> dict[str, float]:
        """Return who stands at a line that no signal bars, and for how many seconds it has."""
        vehicle, now = self.sumo.vehicle, self.sumo.simulation.getTime()
        names = [name for name in vehicle.getIDList() if self._held(name)]
        self.since = {name: self.since.get(name, now) for name in names}
        return {name: now - since for name, since in self.since.items()}

    def _held(self, name: str) -> bool:
        vehicle = self.sumo.vehicle
        if vehicle.getWaitingTime(name) <= 0.0 or not before_line(self.sumo, name):
            return False
        links = vehicle.getNextLinks(name)
        return not links or links[0][5] not in CLOSED


def before_line(sumo: Any, name: str) -> bool:
    """Tell whether somebody is at the end of a lane before a junction."""
    lane = sumo.vehicle.getLaneID(name)
    if not lane or lane.startswith(":"):
        return False
    return bool(sumo.lane.getLength(lane) - sumo.vehicle.getLanePosition(name) <= LINE)
