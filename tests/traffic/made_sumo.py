"""Streets and vehicles that answer as SUMO does, for tests of what its process does with them."""

from types import SimpleNamespace

CARS = ("passenger", "bus")
FOOT = ("pedestrian",)


class Car:
    """A vehicle on a lane, on its way along edges; it has stood before the end of the lane."""

    def __init__(self, lane, route, *, at=99.0, kind="passenger", waited=30.0, speed=0.0):
        self.lane, self.route, self.at, self.kind = lane, tuple(route), at, kind
        self.waited, self.speed, self.length = waited, speed, 4.5
        self.mode = self.speed_mode = self.wanted = None


class Sumo:
    """Lanes of 100 m that lead to others, and cars on them.

    `links` says of each lane which others it leads to; `best` of a vehicle what SUMO tells of its
    lanes ahead, else it is that each lane leads where the way goes.
    """

    def __init__(self, links, cars, *, state="G", length=None, walks=(), changes=()):
        self.links, self.cars, self.state = links, dict(cars), state
        self.length, self.walks, self.changes = length or {}, set(walks), set(changes)
        self.lanes = sorted({*links, *(goal for goals in links.values() for goal in goals), *walks})
        self.best, self.foes, self.crossed, self.now = {}, {}, {}, 0.0
        self.edge = SimpleNamespace(
            getIDList=lambda: sorted({lane.rpartition("_")[0] for lane in self.lanes}),
            getLaneNumber=lambda edge: len(self._of(edge)),
            getLastStepHaltingNumber=lambda edge: len(self._on(*self._of(edge))),
            getLastStepVehicleNumber=lambda edge: len(self._on(*self._of(edge))),
        )
        self.lane = SimpleNamespace(
            getIDList=lambda: self.lanes,
            getInternalFoes=lambda lane: self.crossed.get(lane, ()),
            getLength=lambda lane: self.length.get(lane, 100.0),
            getAllowed=lambda lane: FOOT if lane in self.walks else CARS,
            getLinks=self._links,
            getLastStepVehicleIDs=lambda lane: self._on(lane),
            getChangePermissions=lambda lane, side: () if (lane, side) in self.changes else FOOT,
        )
        car = self.cars
        self.vehicle = SimpleNamespace(
            getIDList=lambda: sorted(car),
            getLaneID=lambda name: car[name].lane,
            getRoadID=lambda name: car[name].lane.rpartition("_")[0],
            getLanePosition=lambda name: car[name].at,
            getLength=lambda name: car[name].length,
            getSpeed=lambda name: car[name].speed,
            getWaitingTime=lambda name: car[name].waited,
            getVehicleClass=lambda name: car[name].kind,
            getRoute=lambda name: car[name].route,
            getRouteIndex=lambda name: car[name].route.index(car[name].lane.rpartition("_")[0]),
            getBestLanes=self._best,
            getNextLinks=self._next,
            getJunctionFoes=lambda name, _: self.foes.get(name, ()),
            getIDCount=lambda: len(car),
            setRoute=lambda name, edges: setattr(car[name], "route", tuple(edges)),
            setLaneChangeMode=lambda name, mode: setattr(car[name], "mode", mode),
            setSpeed=lambda name, speed: setattr(car[name], "wanted", speed),
            setSpeedMode=lambda name, mode: setattr(car[name], "speed_mode", mode),
            remove=lambda name: car.pop(name),
        )
        self.simulation = SimpleNamespace(getTime=lambda: self.now)

    def _of(self, edge):
        return [lane for lane in self.lanes if lane.rpartition("_")[0] == edge]

    def _on(self, *lanes):
        return tuple(sorted(name for name, car in self.cars.items() if car.lane in lanes))

    def _links(self, lane):
        return [(goal, True, True, False, f":j_{n}_0", self.state, "s", 9.0)
                for n, goal in enumerate(self.links.get(lane, ()))]  # fmt: skip

    def _ahead(self, name, lane):
        """Return the lanes ahead as far as the way of a vehicle goes on from a lane."""
        car, chain = self.cars[name], [lane]
        for edge in car.route[car.route.index(lane.rpartition("_")[0]) + 1 :]:
            onto = [goal for goal in self.links.get(chain[-1], ()) if goal.startswith(f"{edge}_")]
            if not onto:
                break
            chain.append(onto[0])
        return tuple(chain)

    def _best(self, name):
        if name in self.best:
            return self.best[name]
        own = self._of(self.cars[name].lane.rpartition("_")[0])
        return [(lane, 100.0, 0.0, 0, True, self._ahead(name, lane)) for lane in own]

    def _next(self, name):
        chain = self._ahead(name, self.cars[name].lane)
        return [link for link in self._links(chain[0]) if link[0] in chain[1:2]]
