"""The process in which SUMO runs: it keeps the streets as full as asked, and writes who is where.

SUMO keeps global state and may end its process, so nothing else happens here. Run as
``python -m cityx.traffic.worker JOB``, a JSON file as `cityx.traffic.simulation` writes it.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

import numpy as np

from cityx.traffic.courtesy import Courtesy
from cityx.traffic.drivers import CONTROL, Drivers, Filling
from cityx.traffic.facing import Facing
from cityx.traffic.waiting import Waiting, lanes_of

ATTRIBUTES = "id,x,y,angle,speed,pos,lane,edge"
HISTORY = 10.0  # seconds before the tracks that poses go back, for the way each has come
NOBODY = "custom1"  # a class that no vehicle has
IMPATIENT = "8"  # seconds of waiting after which drivers let others brake for them
ABOUT = 15.0  # metres about what moves already in which the lane that it is on is looked for
LOOK = 0.5  # seconds between looks at who is in which lane


def options_of(job: dict[str, Any]) -> list[str]:
    """Return the command line of SUMO for a job; one without poses writes none."""
    written = [
        "--fcd-output", job["poses"], "--fcd-output.attributes", ATTRIBUTES,
        "--device.fcd.begin", str(max(0.0, job["warm"] - HISTORY)),
        "--collision-output", job["collisions"],
    ] if job["poses"] else []  # fmt: skip
    return [
        "sumo", "--net-file", job["net"], "--route-files", job["routes"],
        "--step-length", str(job["step"]), "--seed", str(job["seed"]), *written,
        "--collision.action", "warn",
        "--collision.check-junctions", "--collision.mingap-factor", "0",
        "--intermodal-collision.action", "warn",
        "--time-to-teleport", str(job["patience"]), "--time-to-teleport.remove",
        "--lanechange.duration", "3", "--max-depart-delay", "30",
        "--time-to-impatience", IMPATIENT,
        "--pedestrian.model", "striping", "--pedestrian.striping.jamtime", "60",
        "--no-step-log", "--no-warnings", "--xml-validation", "never",
        "--xml-validation.net", "never", "--xml-validation.routes", "never",
        "--precision", "4", "--default.speeddev", "0.1",
    ]  # fmt: skip


class _Haunting:
    """Moves what moves already; a class since it knows who is there."""

    def __init__(self, sumo: Any, path: str) -> None:
        self.sumo = sumo
        self.held = np.load(path) if path else None
        self.there: dict[int, bool] = {}  # row -> whether it is somebody on foot
        if self.held is not None:
            self.names = self.held["name"].tolist()
            self.types = self.held["sumo_type"].tolist()
            self.edges = self.held["edges"].tolist()
            self.start = self.held["step_start"].tolist()
            self.rows = list(zip(*(self.held[key].tolist() for key in
                                   ("row", "x", "y", "angle", "edge")), strict=True))  # fmt: skip

    @property
    def vehicles(self) -> int:
        """How many vehicles are there."""
        return sum(not walks for walks in self.there.values())

    def step(self, number: int) -> None:
        """Put everybody where they are in a step."""
        if self.held is None or number + 1 >= len(self.start):
            return
        now = self.rows[self.start[number] : self.start[number + 1]]
        for row in set(self.there) - {each[0] for each in now}:
            walks = self.there.pop(row)
            (self.sumo.person if walks else self.sumo.vehicle).remove(self.names[row])
        for row, x, y, angle, edge in now:
            walks = not self.types[row]
            name = self.names[row]
            if row not in self.there:
                self.there[row] = walks
                self._add(name, walks, self.types[row], self.edges[edge] if walks else "")
            if walks:
                self.sumo.person.moveToXY(name, self.edges[edge], x, y, angle, 2, ABOUT)
            else:
                self.sumo.vehicle.moveToXY(name, "", -1, x, y, angle, 2, ABOUT)

    def _add(self, name: str, walks: bool, kind: str, edge: str) -> None:
        if walks:
            self.sumo.person.add(name, edge, 0.0)
            self.sumo.person.appendWaitingStage(name, 1e6)
        else:
            self.sumo.vehicle.add(name, "", typeID=kind)


class Driven:
    """Streets while they are driven in; a class for all that looks after them.

    Parameters
    ----------
    sumo
        Which has begun.
    job
        As `cityx.traffic.simulation.job_of` makes it.
    """

    def __init__(self, sumo: Any, job: dict[str, Any]) -> None:
        for way in job["barred"]:
            for index in range(sumo.edge.getLaneNumber(way)):
                if "pedestrian" not in sumo.lane.getAllowed(f"{way}_{index}"):
                    sumo.lane.setAllowed(f"{way}_{index}", [NOBODY])
        self._sumo, self._job, self._number = sumo, job, 0
        self.filling = Filling(sumo, job["groups"])
        self._drivers = Drivers(sumo, job["tight"], job["bound"])
        self._waiting, self._courtesy = Waiting(sumo), Courtesy(sumo)
        self._facing = Facing(sumo, job["facing"])
        self._look = max(1, round(LOOK / job["step"]))
        self._every = max(1, round(CONTROL / job["step"]))
        self.filling.first()

    def step(self, others: int) -> None:
        """Go on by a step; `others` of the vehicles there are no traffic."""
        self._sumo.simulationStep()
        if self._number % self._look == 0:
            lanes = lanes_of(self._sumo)
            held = self._waiting.step(lanes)
            unseen = self._number * self._job["step"] < self._job["warm"] - HISTORY
            spare = self.filling.sent if unseen else frozenset()
            self._drivers.step(held, self.filling.jammed, spare=spare, lanes=lanes)
            self._courtesy.step(held)
            self._facing.step(None if unseen else lanes)  # drivers take out who is spare
        if self._number % self._every == 0:
            self.filling.renew(others)
        self._number += 1


def run(job: dict[str, Any]) -> dict[str, Any]:
    """Run a job; return what happened besides the poses."""
    import libsumo

    libsumo.start(options_of(job))
    haunting = _Haunting(libsumo, job["ghosts"])
    teleported: dict[str, float] = {}
    driven = Driven(libsumo, job)
    for number in range(round((job["warm"] + job["duration"]) / job["step"]) + 1):
        haunting.step(number)
        driven.step(haunting.vehicles)
        for name in libsumo.simulation.getStartingTeleportIDList():
            teleported[name] = libsumo.simulation.getTime() - job["warm"]
    halted = {
        name: libsumo.vehicle.getWaitingTime(name)
        for name in libsumo.vehicle.getIDList()
        if libsumo.vehicle.getWaitingTime(name) >= job["stuck"]
    }
    version = libsumo.getVersion()[1]
    libsumo.close()
    return {
        "teleported": teleported, "halted": halted, "version": version,
        "left_over": [len(trips) for trips in driven.filling.waiting],
    }  # fmt: skip


def main(path: str) -> int:
    """Carry out the job of a file; its answer lies where the job says."""
    job = json.loads(Path(path).read_text())
    answer = run(job)
    Path(job["answer"]).write_text(json.dumps(answer))
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
