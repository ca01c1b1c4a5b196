"""Drivers keep to lanes, reroute around gridlock, and are inserted where streets lack them."""

from __future__ import annotations

from collections import Counter, deque
from collections.abc import Mapping, Sequence, Set
from heapq import heappop, heappush
from math import inf
from typing import Any

from cityx.traffic.waiting import lanes_of

LONG = frozenset(("bus", "truck"))  # classes that do not fit round every corner
CORNER = 40.0  # metres that a junction is worth to who looks for another way
LATEST = 25.0  # metres before its end at which nobody leaves a lane for another any more
PACE = 4.0  # metres per second of those who change lanes; slower they would slide aside
FORESEEN = 3  # ways that drivers see ahead
TIRED = 6.0  # seconds at a line before a full exit after which drivers take another one
WARNED = 6  # ways ahead of which drivers know that they are jammed
DETOUR = 300.0  # metres that a jammed way or a lane that ends is worth to who looks for another
HOPELESS = 20.0  # seconds there after which those whom only the filling has put there are taken out
NEARER, SLOW = 0.5, 1.0  # share of an exit where nobody stands, slower than so many m/s
STARVED = 60.0  # seconds for which others keep off an exit that somebody could not get onto
GAP = 2.5  # metres that are left free behind who stands on an exit
FREE, HELD = 1621, 512  # modes of changing lanes: as drivers like, and not at all
AHEAD = 2  # vehicles that may wait to come in by one way before no more are sent there
DRIVER = "passenger"  # a class that all lanes for cars are open to
PLACE = 7.5  # metres of a lane that a standing car takes
MEMORY = 60.0  # seconds over which queues are counted, one cycle of signals
SET = 0.7  # of the vehicles are put into the streets at once, the others come as they do later
JAMMED = 0.25  # of a way's places taken by who stands, from which on nobody more is sent there
CONTROL = 1.0  # seconds between looks at how full the streets are


class Drivers:
    """Keeps drivers to lanes; a class since it knows what each lane leads to.

    Vehicles of SUMO change lanes sideways when they are slow, which no vehicle can. So those who
    are slow, or near the end, stay in the lane where they are, and take the way that it leads.
    """

    def __init__(self, sumo: Any, tight: list[str], bound: Sequence[str] = ()) -> None:
        self.sumo = sumo
        self.bound = frozenset(bound)  # who goes to a place, rather than out of the site
        self.tight = frozenset(tight)
        self.edge: dict[str, str] = {}  # lane -> edge
        self.length: dict[str, float] = {}
        self.allowed: dict[str, frozenset[str]] = {}
        self.after: dict[str, list[tuple[str, frozenset[str]]]] = {}  # lanes led to, and whom
        self.exits: set[str] = set()
        self.ends: set[str] = set()  # lanes that lead nowhere, beside others that do
        self.beside: set[str] = set()  # lanes with another one beside them
        self.jammed: Set[str] = frozenset()
        self.spare: Set[str] = frozenset()
        self.wanted: dict[str, float] = {}  # edge -> until when who waits for it goes first
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
        blind = {name for name in driven if not self.after[name]}
        if blind == set(driven):
            self.exits.update([edge] if driven else [])
        else:
            self.ends |= blind
        if len(driven) > 1:
            self.beside.update(driven)

    def step(
        self, waiting: Mapping[str, float], jammed: Set[str] = frozenset(), *,
        spare: Set[str] = frozenset(), lanes: Mapping[str, str] | None = None,
    ) -> None:  # fmt: skip
        """Update every vehicle that nears a junction or has another lane beside it.

        Parameters
        ----------
        waiting
            Who stands at a line that no signal bars, and for how many seconds.
        jammed
            Edges to be gone round where there is another way.
        spare
            Vehicles that are taken out where they come to the end of a lane that leads nowhere, or
            stand before full exits alone: the streets are filled at random, as no traffic does.
        lanes
            Of all vehicles, as of `lanes_of`; None asks for them.
        """
        now = self.sumo.simulation.getTime()
        self.wanted = {edge: until for edge, until in self.wanted.items() if until > now}
        self.jammed, self.spare = jammed | self.wanted.keys(), spare
        vehicle = self.sumo.vehicle
        for name, lane in (lanes_of(self.sumo) if lanes is None else lanes).items():
            known = self.seen.get(name) == lane
            if lane not in self.edge or (
                known and lane not in self.beside and name not in waiting
            ):  # fmt: skip
                continue
            left = self.length[lane] - vehicle.getLanePosition(name)
            if lane in self.beside:
                free = left > LATEST and vehicle.getSpeed(name) >= PACE
                mode = FREE if free else HELD
                if self.mode.get(name, FREE) != mode:
                    self.mode[name] = mode
                    vehicle.setLaneChangeMode(name, mode)
            if left <= LATEST and not known:
                self.seen[name] = lane
                self._lead_on(name, lane)
            elif waiting.get(name, 0.0) >= TIRED:
                self._lead_off(name, lane, hopeless=waiting[name] >= HOPELESS)

    def _lead_on(self, name: str, lane: str) -> None:
        """Send a vehicle where its lane leads, if that is not where it wants to go."""
        vehicle = self.sumo.vehicle
        route, kind = vehicle.getRoute(name), vehicle.getVehicleClass(name)
        place = vehicle.getRouteIndex(name)
        ahead = route[place + 1 : place + 1 + FORESEEN]
        if place < 0 or not ahead:
            return
        if lane in self.ends and name in self.spare:
            vehicle.remove(name)
            return
        if self._leads(lane, ahead, kind) and self._goes_on(name, lane):
            full = self._filling(lane)
            onto = {goal for goal, _ in self.after[lane] if self.edge.get(goal) == ahead[0]}
            if onto <= full or not self.jammed.isdisjoint(route[place + 1 : place + 1 + WARNED]):
                edges = self.way(lane, route[-1], kind, full)
                if edges and edges[-1] == route[-1]:
                    self._try(name, lane, edges)
            return
        # Who fits round no corner ahead takes one that is tight rather than stand for ever.
        edges = self.way(lane, route[-1], kind)
        if not edges or (name in self.bound and edges[-1] != route[-1]):
            edges = self.way(lane, route[-1], DRIVER)
        if len(edges) > 1:
            vehicle.setRoute(name, edges)

    def _filling(self, lane: str) -> set[str]:
        """Return the exits of a lane that have others, on whose nearer half somebody stands."""
        exits = {goal for goal, _ in self.after[lane]}
        if len(exits) < 2:
            return set()
        speed = self.sumo.vehicle.getSpeed
        return {
            goal for goal in exits
            if any(self.sumo.vehicle.getLanePosition(name) < self.length[goal] * NEARER
                   and speed(name) < SLOW for name in self.sumo.lane.getLastStepVehicleIDs(goal))
        }  # fmt: skip

    def _lead_off(self, name: str, lane: str, *, hopeless: bool) -> None:
        """Send a vehicle that stands before a full exit to another one of its lane, if any.

        Where there is none others are led round that exit for a time; where that is `hopeless` it
        is taken out, if it may be.
        """
        vehicle = self.sumo.vehicle
        links, need = vehicle.getNextLinks(name), vehicle.getLength(name) + GAP
        if not links or self._room(links[0][0]) >= need:
            return
        full = {exit_ for exit_, _ in self.after[lane] if self._room(exit_) < need}
        kind = vehicle.getVehicleClass(name)
        if any(kind in who for exit_, who in self.after[lane] if exit_ not in full):
            self._try(name, lane, self.way(lane, vehicle.getRoute(name)[-1], kind, full))
            return
        self.wanted[self.edge[links[0][0]]] = self.sumo.simulation.getTime() + STARVED
        if hopeless and name in self.spare:
            vehicle.remove(name)

    def _room(self, lane: str) -> float:
        """Return the metres of a lane behind the last vehicle on it."""
        vehicle = self.sumo.vehicle
        ends = [vehicle.getLanePosition(name) - vehicle.getLength(name)
                for name in self.sumo.lane.getLastStepVehicleIDs(lane)]  # fmt: skip
        return min(ends, default=inf)

    def _try(self, name: str, lane: str, edges: list[str]) -> None:
        """Send a vehicle along other edges, unless SUMO would stop it at the end of its lane."""
        vehicle = self.sumo.vehicle
        if len(edges) < 2:
            return
        before = vehicle.getRoute(name)[vehicle.getRouteIndex(name) :]
        vehicle.setRoute(name, edges)
        if not self._goes_on(name, lane):
            vehicle.setRoute(name, before)

    def _goes_on(self, name: str, lane: str) -> bool:
        """Return whether SUMO has an onward connection at the end of a vehicle's lane.

        It does not where lanes far ahead have to be changed over a line that bars it; what it
        tells as the next lane then is any, such as a walk.
        """
        onward = {goal for goal, _ in self.after[lane]}
        best = self.sumo.vehicle.getBestLanes(name)
        return any(each[0] == lane and not onward.isdisjoint(each[5][1:2]) for each in best)

    def _leads(self, lane: str, edges: Sequence[str], kind: str) -> bool:
        """Return whether a vehicle that stays in its lane follows some edges.

        In dense traffic nobody gets out of a lane that ends, so these count on the last one alone.
        """
        there = {lane}
        for number, edge in enumerate(edges):
            if number:
                there |= {other for each in there for other in self._changes(each, kind)}
            there = {
                goal for each in there for goal, who in self.after[each]
                if self.edge.get(goal) == edge and kind in who
                and (goal not in self.ends or edge == edges[-1])
            }  # fmt: skip
        return bool(there)

    def way(
        self, start: str, target: str, kind: str, full: Set[str] = frozenset()
    ) -> list[str]:  # fmt: skip
        """Return the edges from a lane to an edge, or out of the site where none lead there.

        They lead round what is jammed and round lanes that end, if that is not too far, and do
        not begin with the `full` ones of the lanes that the first one leads to.
        """
        cost, before, todo = {start: 0.0}, {start: ""}, [(0.0, start)]
        found = ""
        while todo:
            spent, lane = heappop(todo)
            if spent > cost[lane]:
                continue
            edge = self.edge[lane]
            if edge in self.exits and not found:
                found = lane
            if edge == target:
                found = lane
                break
            onward = [
                goal for goal, who in self.after[lane]
                if kind in who and not (lane == start and goal in full)
            ]  # fmt: skip
            for each in [*onward, *(self._changes(lane, kind) if lane != start else ())]:
                more = spent + self.length[each] + CORNER
                if self.edge[each] in self.jammed or (
                    each in self.ends and self.edge[each] != target
                ):  # fmt: skip
                    more += DETOUR
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
