"""The process in which SUMO runs: it keeps the streets as full as asked, and writes who is where.

SUMO keeps global state and may end its process, so nothing else happens here. Run as
``python -m cityx.traffic.worker JOB``, a JSON file as `cityx.traffic.simulation` writes it.
"""

from __future__ import annotations

import json
import sys
from collections import Counter, deque
from collections.abc import Sequence
from heapq import heappop, heappush
from math import inf
from pathlib import Path
from typing import Any

import numpy as np

from cityx.traffic.courtesy import Courtesy

ATTRIBUTES = "id,x,y,angle,speed,pos,lane,edge"
HISTORY = 10.0  # seconds before the tracks that poses go back, for the way each has come
NOBODY = "custom1"  # a class that no vehicle has
CONTROL = 1.0  # seconds between looks at how full the streets are
AHEAD = 5  # vehicles that may wait to come in before no more are sent
DRIVER = "passenger"  # a class that all lanes for cars are open to
LONG = frozenset(("bus", "truck"))  # classes that do not fit round every corner
CORNER = 40.0  # metres that a junction is worth to who looks for another way
IMPATIENT = "8"  # seconds of waiting after which drivers let others brake for them
PLACE = 7.5  # metres of a lane that a standing car takes
MEMORY = 60.0  # seconds over which queues are counted, one cycle of signals
SET = 0.7  # of the vehicles are put into the streets at once, the others come as they do later
JAMMED = 0.25  # of a way's places taken by who stands, from which on nobody more is sent there
LOOK = 0.5  # seconds between looks at who is in which lane
LATEST = 25.0  # metres before its end at which nobody leaves a lane for another any more
PACE = 4.0  # metres per second of those who change lanes; slower they would slide aside
FORESEEN = 3  # ways that drivers see ahead
FREE, HELD = 1621, 512  # modes of changing lanes: as drivers like, and not at all


def _options(job: dict[str, Any]) -> list[str]:
    return [
        "sumo", "--net-file", job["net"], "--route-files", job["routes"],
        "--step-length", str(job["step"]), "--seed", str(job["seed"]),
        "--fcd-output", job["poses"], "--fcd-output.attributes", ATTRIBUTES,
        "--device.fcd.begin", str(max(0.0, job["warm"] - HISTORY)),
        "--collision-output", job["collisions"], "--collision.action", "warn",
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


class _Filling:
    """Keeps groups of streets as full as asked; a class since it counts what it has sent."""

    def __init__(self, sumo: Any, groups: list[dict[str, Any]]) -> None:
        self.sumo = sumo
        self.groups = groups
        self.waiting = [deque(group["trips"]) for group in groups]
        self.room = {
            edge: sumo.lane.getLength(f"{edge}_0") / PLACE
            * sum(DRIVER in sumo.lane.getAllowed(f"{edge}_{index}")
                  for index in range(sumo.edge.getLaneNumber(edge)))
            for group in groups for edge in group["edges"]
        }  # fmt: skip
        self.total = sum(int(group["target"]) for group in groups)
        self.queue = dict.fromkeys(self.room, 0.0)

    def first(self) -> None:
        """Put vehicles where they would be had traffic gone on for long."""
        for group, trips in zip(self.groups, self.waiting, strict=True):
            for _ in range(min(round(SET * int(group["target"])), len(trips))):
                trip = trips.popleft()
                self._send(trip, trip["route"][trip["entry"] :], position="random_free")

    def renew(self, others: int) -> None:
        """Send as many as are missing, from where vehicles come into the streets.

        `others` of the vehicles there are not its own.
        """
        for edge, queue in self.queue.items():
            standing = self.sumo.edge.getLastStepHaltingNumber(edge)
            self.queue[edge] = queue + (standing - queue) * CONTROL / MEMORY
        jammed = {edge for edge, queue in self.queue.items() if queue > JAMMED * self.room[edge]}
        pending = len(self.sumo.simulation.getPendingVehicles())
        amid = self._amid_junctions()
        # Where a queue fills one class of streets, the others do not make it longer.
        room = self.total - (self.sumo.vehicle.getIDCount() - others) - pending
        for group, trips in zip(self.groups, self.waiting, strict=True):
            on_ways = sum(map(self.sumo.edge.getLastStepVehicleNumber, group["edges"]))
            missing = int(group["target"]) - on_ways - sum(amid[edge] for edge in group["edges"])
            for _ in range(min(missing, room, AHEAD - pending, len(trips))):
                trip = trips.popleft()
                if not jammed.isdisjoint(trip["route"]):
                    trips.append(trip)  # nobody sets out for a jam; another one does
                    continue
                self._send(trip, trip["route"], position="base")
                pending += 1
                room -= 1

    def _amid_junctions(self) -> Counter[str]:
        """Count who is on a junction by the way that each comes from."""
        vehicle = self.sumo.vehicle
        amid = [name for name in vehicle.getIDList() if vehicle.getRoadID(name).startswith(":")]
        places = [(vehicle.getRoute(name), vehicle.getRouteIndex(name)) for name in amid]
        return Counter(route[at] for route, at in places if 0 <= at < len(route))

    def _send(self, trip: dict[str, Any], route: list[str], *, position: str) -> None:
        name = trip["id"]
        self.sumo.route.add(name, route)
        self.sumo.vehicle.add(
            name, name, typeID=trip["type"], departPos=position, departLane="best",
            departSpeed="max" if position == "random_free" or trip["rolling"] else "0",
        )  # fmt: skip


class _Lanes:
    """Keeps drivers to lanes; a class since it knows what each lane leads to.

    Vehicles of SUMO change lanes sideways when they are slow, which no vehicle can. So those who
    are slow, or near the end, stay in the lane where they are, and take the way that it leads.
    """

    def __init__(self, sumo: Any, tight: list[str]) -> None:
        self.sumo = sumo
        self.tight = frozenset(tight)
        self.edge: dict[str, str] = {}  # lane -> edge
        self.length: dict[str, float] = {}
        self.allowed: dict[str, frozenset[str]] = {}
        self.after: dict[str, list[tuple[str, frozenset[str]]]] = {}  # lanes led to, and whom
        self.exits: set[str] = set()
        self.beside: set[str] = set()  # lanes with another one beside them
        self.mode: dict[str, int] = {}
        self.seen: dict[str, str] = {}  # vehicle -> lane that is known to lead where it wants to go
        for edge in sumo.edge.getIDList():
            if not edge.startswith(":"):
                self._add(edge)

    def _add(self, edge: str) -> None:
        lane = self.sumo.lane
        own = [f"{edge}_{index}" for index in range(self.sumo.edge.getLaneNumber(edge))]
        driven = []
        for name in own:
            self.edge[name], self.length[name] = edge, lane.getLength(name)
            self.allowed[name] = frozenset(lane.getAllowed(name))
            self.after[name] = [
                (link[0], frozenset(lane.getAllowed(link[0])) - (LONG if link[4] in self.tight
                                                                else frozenset()))
                for link in lane.getLinks(name)
            ]  # fmt: skip
            if DRIVER in self.allowed[name]:
                driven.append(name)
        if driven and not any(self.after[name] for name in driven):
            self.exits.add(edge)
        if len(driven) > 1:
            self.beside.update(driven)

    def step(self) -> None:
        """Look at everybody who comes near a junction or is beside another lane."""
        vehicle = self.sumo.vehicle
        for name in vehicle.getIDList():
            lane = vehicle.getLaneID(name)
            known = self.seen.get(name) == lane
            if lane not in self.edge or (known and lane not in self.beside):
                continue
            left = self.length[lane] - vehicle.getLanePosition(name)
            if left <= LATEST and not known:
                self.seen[name] = lane
                self._lead_on(name, lane)
            if lane in self.beside:
                free = left > LATEST and vehicle.getSpeed(name) >= PACE
                mode = FREE if free else HELD
                if self.mode.get(name, FREE) != mode:
                    self.mode[name] = mode
                    vehicle.setLaneChangeMode(name, mode)

    def _lead_on(self, name: str, lane: str) -> None:
        """Send a vehicle where its lane leads, if that is not where it wants to go."""
        vehicle = self.sumo.vehicle
        route, kind = vehicle.getRoute(name), vehicle.getVehicleClass(name)
        place = vehicle.getRouteIndex(name)
        ahead = route[place + 1 : place + 1 + FORESEEN]
        if place < 0 or not ahead or (self._leads(lane, ahead, kind) and self._goes_on(name, lane)):
            return
        # Who fits round no corner ahead takes one that is tight rather than stand for ever.
        edges = self.way(lane, route[-1], kind) or self.way(lane, route[-1], DRIVER)
        if len(edges) > 1:
            vehicle.setRoute(name, edges)

    def _goes_on(self, name: str, lane: str) -> bool:
        """Tell whether SUMO lets a vehicle drive on at the end of its lane.

        It does not where lanes far ahead have to be changed over a line that bars it.
        """
        best = self.sumo.vehicle.getBestLanes(name)
        return any(each[0] == lane and len(each[5]) > 1 for each in best)

    def _leads(self, lane: str, edges: Sequence[str], kind: str) -> bool:
        """Tell whether one who stays in a lane comes along some edges."""
        there = {lane}
        for number, edge in enumerate(edges):
            if number:
                there |= {other for each in there for other in self._changes(each, kind)}
            there = {
                goal for each in there for goal, who in self.after[each]
                if self.edge.get(goal) == edge and kind in who
            }  # fmt: skip
        return bool(there)

    def way(self, start: str, goal: str, kind: str) -> list[str]:
        """Return the edges from a lane to an edge, or out of the site where none lead there."""
        cost, before, todo = {start: 0.0}, {start: ""}, [(0.0, start)]
        found = ""
        while todo:
            spent, lane = heappop(todo)
            if spent > cost[lane]:
                continue
            edge = self.edge[lane]
            if edge in self.exits and not found:
                found = lane
            if edge == goal:
                found = lane
                break
            onward = [goal for goal, who in self.after[lane] if kind in who]
            for each in [*onward, *(self._changes(lane, kind) if lane != start else ())]:
                more = spent + self.length[each] + CORNER
                if more < cost.get(each, inf):
                    cost[each], before[each] = more, lane
                    heappush(todo, (more, each))
        edges: list[str] = []
        while found:
            if not edges or edges[-1] != self.edge[found]:
                edges.append(self.edge[found])
            found = before[found]
        return edges[::-1]

    def _changes(self, lane: str, kind: str) -> list[str]:
        """Return the lanes beside one that its drivers may get to."""
        edge, _, index = lane.rpartition("_")
        found = []
        for step in (-1, 1):
            other = f"{edge}_{int(index) + step}"
            if kind in self.allowed.get(other, ()):
                open_to = self.sumo.lane.getChangePermissions(lane, step)
                if not open_to or kind in open_to:
                    found.append(other)
        return found


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
                self.sumo.person.moveToXY(name, self.edges[edge], x, y, angle, 2)
            else:
                self.sumo.vehicle.moveToXY(name, "", -1, x, y, angle, 2)

    def _add(self, name: str, walks: bool, kind: str, edge: str) -> None:
        if walks:
            self.sumo.person.add(name, edge, 0.0)
            self.sumo.person.appendWaitingStage(name, 1e6)
        else:
            self.sumo.vehicle.add(name, "", typeID=kind)


def run(job: dict[str, Any]) -> dict[str, Any]:
    """Run a job; return what happened besides the poses."""
    import libsumo

    libsumo.start(_options(job))
    for way in job["barred"]:
        for index in range(libsumo.edge.getLaneNumber(way)):
            if "pedestrian" not in libsumo.lane.getAllowed(f"{way}_{index}"):
                libsumo.lane.setAllowed(f"{way}_{index}", [NOBODY])
    haunting = _Haunting(libsumo, job["ghosts"])
    teleported: dict[str, float] = {}
    filling = _Filling(libsumo, job["groups"])
    keeping = _Lanes(libsumo, job["tight"])
    courtesy = Courtesy(libsumo)
    steps = round((job["warm"] + job["duration"]) / job["step"]) + 1
    look = max(1, round(LOOK / job["step"]))
    every = max(1, round(CONTROL / job["step"]))
    filling.first()
    for number in range(steps):
        haunting.step(number)
        libsumo.simulationStep()
        if number % look == 0:
            keeping.step()
            courtesy.step()
        if number % every == 0:
            filling.renew(haunting.vehicles)
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
        "left_over": [len(trips) for trips in filling.waiting],
    }  # fmt: skip


def main(path: str) -> int:
    """Carry out the job of a file; its answer lies where the job says."""
    job = json.loads(Path(path).read_text())
    answer = run(job)
    Path(job["answer"]).write_text(json.dumps(answer))
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
