"""Gap acceptance: let in vehicles that waited long before a stream without gaps."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from cityx.traffic.waiting import LINE, before_line

LONG = 8.0  # seconds of waiting after which the others let one in
HARD = 3.0  # metres per second squared at which others brake for who is let in
REACTION = 1.5  # seconds until they do
SPACE = 4.0  # metres that they then keep
GIVES_WAY = "mg"  # ways across a junction that give way to others, without signals and on green
AWARE = 31  # mode of speed: heeds everybody
LET_IN = 23  # heeds all but those who come to the junction and are not on it yet


class Courtesy:
    """Lets vehicles into a junction one by one; a class since it remembers those let in."""

    def __init__(self, sumo: Any) -> None:
        self.sumo = sumo
        self.turn: dict[str, str] = {}  # junction -> who is let in there
        # Lane behind where one waits amid a junction -> the lane before it, and that lane's own.
        self.amid: dict[str, tuple[str, str]] = {}
        for source in sumo.lane.getIDList():
            for link in () if source.startswith(":") else sumo.lane.getLinks(source):
                for after in sumo.lane.getLinks(link[4]) if link[4] else ():
                    if after[4]:
                        self.amid[after[4]] = (source, link[4])

    def step(self, waiting: Mapping[str, float]) -> None:
        """Let in those who may enter, and reset those who have passed the junction.

        Parameters
        ----------
        waiting
            Who stands at a line that no signal bars, and for how many seconds.
        """
        vehicle = self.sumo.vehicle
        present = set(vehicle.getIDList())
        for junction, name in list(self.turn.items()):
            if name not in present:
                del self.turn[junction]
            elif vehicle.getWaitingTime(name) > 0.0 or self._past(name):
                vehicle.setSpeedMode(name, AWARE)
                del self.turn[junction]
        long = [name for name, seconds in waiting.items() if seconds >= LONG and name in present]
        for name in sorted(long, key=lambda name: (-waiting[name], name)):
            if name not in self.turn.values():
                self._let_in(name)

    def _past(self, name: str) -> bool:
        """Return whether a vehicle that was let in has left the junction."""
        lane = self.sumo.vehicle.getLaneID(name)
        return not lane.startswith(":") and not before_line(self.sumo, name)

    def _let_in(self, name: str) -> None:
        vehicle = self.sumo.vehicle
        links = vehicle.getNextLinks(name)
        if not links or links[0][5] not in GIVES_WAY:
            return
        junction = links[0][4][1:].rsplit("_", 2)[0]
        if junction in self.turn:
            return
        foes = [(foe, far) for foe, _, far, *_ in vehicle.getJunctionFoes(name, LINE)]
        for foe, far in foes + self._turning(links[0][4]):
            speed = vehicle.getSpeed(foe)
            if 0.0 <= far < SPACE + speed * REACTION + speed**2 / (2 * HARD) and speed > 0.0:
                return
        self.turn[junction] = name
        vehicle.setSpeedMode(name, LET_IN)

    def _turning(self, across: str) -> list[tuple[str, float]]:
        """Return oncoming vehicles that may wait inside the junction, and how far.

        As long as they have to, SUMO does not count them among the foes.
        """
        vehicle, lane = self.sumo.vehicle, self.sumo.lane
        found = []
        for source, first in (
            self.amid[foe] for foe in lane.getInternalFoes(across) if foe in self.amid
        ):
            for name in lane.getLastStepVehicleIDs(source):
                links = vehicle.getNextLinks(name)
                if links and links[0][4] == first:
                    found.append((name, lane.getLength(source) - vehicle.getLanePosition(name)))
        return found
