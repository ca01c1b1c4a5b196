"""Keep streets at the density asked for: insert vehicles where they are missing."""

from __future__ import annotations

from collections import Counter, deque
from typing import Any

AHEAD = 2  # vehicles that may wait to come in by one way before no more are sent there
DRIVER = "passenger"  # a class that all lanes for cars are open to
PLACE = 7.5  # metres of a lane that a standing car takes
MEMORY = 60.0  # seconds over which queues are counted, one cycle of signals
SET = 0.7  # of the vehicles are put into the streets at once, the others come as they do later
JAMMED = 0.25  # of a way's places taken by who stands, from which on nobody more is sent there
CONTROL = 1.0  # seconds between looks at how full the streets are


class Filling:
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
        self.jammed: set[str] = set()
        self.sent: set[str] = set()

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
        self.jammed = {
            edge for edge, queue in self.queue.items() if queue > JAMMED * self.room[edge]
        }  # fmt: skip
        pending = self.sumo.simulation.getPendingVehicles()
        routes = map(self.sumo.vehicle.getRoute, pending)
        before = Counter(start for route in routes for start in route[:1])
        amid = self._amid_junctions()
        # Where a queue fills one class of streets, the others do not make it longer.
        room = self.total - (self.sumo.vehicle.getIDCount() - others) - len(pending)
        for group, trips in zip(self.groups, self.waiting, strict=True):
            on_ways = sum(map(self.sumo.edge.getLastStepVehicleNumber, group["edges"]))
            missing = int(group["target"]) - on_ways - sum(amid[edge] for edge in group["edges"])
            for _ in range(min(missing, room, len(trips))):
                trip = trips.popleft()
                start = trip["route"][0]
                if before[start] >= AHEAD or not self.jammed.isdisjoint(trip["route"]):
                    trips.append(trip)  # nobody sets out for a jam, or in one; another one does
                    continue
                self._send(trip, trip["route"], position="base")
                before[start] += 1
                room -= 1

    def _amid_junctions(self) -> Counter[str]:
        """Count who is on a junction by the way that each comes from."""
        vehicle = self.sumo.vehicle
        amid = [name for name in vehicle.getIDList() if vehicle.getRoadID(name).startswith(":")]
        places = [(vehicle.getRoute(name), vehicle.getRouteIndex(name)) for name in amid]
        return Counter(route[at] for route, at in places if 0 <= at < len(route))

    def _send(self, trip: dict[str, Any], route: list[str], *, position: str) -> None:
        name = trip["id"]
        self.sent.add(name)
        self.sumo.route.add(name, route)
        self.sumo.vehicle.add(
            name, name, typeID=trip["type"], departPos=position, departLane=trip["lane"],
            departSpeed="max" if position == "random_free" or trip["rolling"] else "0",
        )  # fmt: skip
