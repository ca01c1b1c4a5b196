"""SUMO step by step, among bodies that somebody else moves, for a simulator that asks."""

from __future__ import annotations

import json
import math
import sys
from collections.abc import Callable, Mapping
from hashlib import sha256
from typing import Any

from cityx.traffic.worker import Driven, options_of

KIND = "somebody_else"  # type of vehicles that are moved from outside
TYPE = f'<vType id="{KIND}" vClass="passenger" length="4.500" width="1.800" minGap="1.0"/>'
ANSWER = "cityx: "  # what a line with an answer begins with; SUMO prints others
ANYWHERE = 2  # bits of moveToXY: off the network too


class Live:
    """SUMO while it runs; a class for who of those that are moved from outside is there.

    Parameters
    ----------
    job
        As `cityx.traffic.simulation.job_of` makes it.
    places
        Name of a lane to the ids of the lane, and of the one that a way across leads into, or 0.
    """

    def __init__(self, job: dict[str, Any], places: Mapping[str, tuple[int, int]]) -> None:
        import libsumo

        self._sumo, self._job, self._places = libsumo, job, places
        self._driven: Driven | None = None
        self._there: set[str] = set()
        self._turns = 0  # times that trips have begun anew

    def begin(self, seed: int) -> None:
        """Begin anew, and drive until there are queues."""
        if self._driven is not None:
            self._sumo.close()
        self._job["seed"] = seed % (1 << 31)
        self._sumo.start(options_of(self._job))
        self._driven, self._there = Driven(self._sumo, self._job), set()
        self._turns = 0
        for _ in range(round(self._job["warm"] / self._job["step"])):
            self._driven.step(0)

    def step(self, others: list[list[float]]) -> list[list[Any]]:
        """Go on by a step.

        Parameters
        ----------
        others
            x, y, heading and length of each who is moved from outside, metres and radians.

        Returns
        -------
        vehicles
            Name, x, y and z of the middle, heading, m/s, length, width, height, and two lanes.
        """
        assert self._driven is not None
        vehicle = self._sumo.vehicle
        names = {f"other{number}" for number in range(len(others))}
        for name in sorted(names - self._there):
            vehicle.add(name, "", typeID=KIND)
        for name in sorted(self._there - names):
            vehicle.remove(name)
        for number, (x, y, heading, length) in enumerate(others):
            name = f"other{number}"
            if name not in self._there:
                vehicle.setLength(name, length)
            front = (x + length / 2 * math.cos(heading), y + length / 2 * math.sin(heading))
            vehicle.moveToXY(name, "", -1, *front, 90.0 - math.degrees(heading), ANYWHERE)
        self._there = names
        self._refill()
        self._driven.step(len(names))
        self._there &= set(vehicle.getIDList())
        return [self._told(name) for name in sorted(vehicle.getIDList()) if name not in names]

    def _refill(self) -> None:
        """Let trips be made again, under other names, where all have been made."""
        assert self._driven is not None
        for waiting, group in zip(self._driven.filling.waiting, self._job["groups"], strict=True):
            if not waiting and group["trips"]:
                self._turns += 1
                again = sha256(f"{self._turns}".encode()).digest()[:8]
                turn = int.from_bytes(again, "big") & ~1
                waiting.extend({**trip, "id": f"{int(trip['id'], 16) ^ turn:x}"}
                               for trip in group["trips"])  # fmt: skip

    def _told(self, name: str) -> list[Any]:
        vehicle = self._sumo.vehicle
        x, y, z = vehicle.getPosition3D(name)
        heading = math.radians(90.0 - vehicle.getAngle(name))
        length = vehicle.getLength(name)
        lane, onto = self._places.get(vehicle.getLaneID(name), (0, 0))
        return [
            int(name, 16) >> 1, x - length / 2 * math.cos(heading),
            y - length / 2 * math.sin(heading), z, heading, vehicle.getSpeed(name), length,
            vehicle.getWidth(name), vehicle.getHeight(name), str(lane), str(onto),
        ]  # fmt: skip


def serve(live: Live, read: Callable[[], str]) -> None:
    """Answer lines of JSON until there are none: a seed begins, a list of others is a step."""
    while line := read():
        asked = json.loads(line)
        answer: Any = None
        if isinstance(asked, int):
            live.begin(asked)
        else:
            answer = live.step(asked)
        say(answer)


def say(answer: Any) -> None:
    """Write an answer."""
    sys.stdout.write(f"{ANSWER}{json.dumps(answer)}\n")
    sys.stdout.flush()
