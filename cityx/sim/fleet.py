"""Fleets of mixed bodies: cars, buses, bicycles, robots, people and drones in one world."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cityx.errors import UsageError
from cityx.geometry.arrays import BoolArray, FloatArray
from cityx.sim.dynamics import VEHICLE
from cityx.sim.engine import Engine, fits_nowhere, map_of, paths_of, rules_of, traffic_of
from cityx.sim.kernels import fleet, fly
from cityx.sim.kernels.paths import ROUTE
from cityx.sim.kernels.tables import (
    CONTROL,
    FLY_EVENTS,
    FLY_TERMS,
    TARGET,
    TOP_REWARD,
    WALK_EVENTS,
    WALK_TERMS,
    X,
    Y,
)
from cityx.sim.kernels.tables import VEHICLE as KIND_ASKED
from cityx.sim.observe import FLYING, PRESETS, WALKING, Preset
from cityx.sim.options import BODIES, DRONE, FleetOptions
from cityx.sim.travellers import TRAVELLER, TRAVELLERS
from cityx.sim.walks import Walks
from cityx.sim.world import World

DRIVES, FLIES, WALKS = range(3)


def names_of(options: FleetOptions) -> list[str]:
    """Return the agents of a fleet in the order of `BODIES`: ``car_0``, ``car_1``, ``drone_0``."""
    return [f"{body}_{number}" for body in BODIES for number in range(options.bodies.get(body, 0))]


class Mixed(Engine):
    """Worlds of agents of all kinds, with people and traffic about them; see `Engine`.

    Nobody is led along lanes on which two cannot pass, where agents would meet head on for good.
    Those who drive have the rules and the observation of Drive, those on walks of Deliver and Walk,
    drones of Fly. Who meets whom is told apart by the heights of their bodies.

    Attributes
    ----------
    order
        (A,) row of the state of each agent, in the order of `names_of`.
    flying, walking
        Rows of the state of those who fly, and who are on walks.

    Parameters
    ----------
    world, walks, options, worlds
        As of `cityx.sim.roamers.Roamers`.

    Raises
    ------
    UsageError
        If a body fits nowhere.
    """

    options: FleetOptions
    action_size = 4

    def __init__(self, world: World, walks: Walks, options: FleetOptions, worlds: int = 1) -> None:
        self.world, self.walks, self.options, self.worlds = world, walks, options, worlds
        self.map = map_of(world, narrow=False)
        self.paths = self._ways = paths_of(walks)
        bodies = [name.rsplit("_", 1)[0] for name in names_of(options)]
        realm = np.array([DRIVES if body in VEHICLE else FLIES if body == DRONE else WALKS
                          for body in bodies])  # fmt: skip
        rows = np.argsort(realm, kind="stable")
        self.order = np.argsort(rows, kind="stable")
        self._realm = realm[rows].tolist()
        self._body = [bodies[k] for k in rows.tolist()]
        self.agents, self.people = len(bodies), options.people
        count = np.bincount(realm, minlength=3)
        self._cuts = np.cumsum(count).astype(np.int64)
        self.flying = np.arange(self._cuts[0], self._cuts[1])
        self.walking = np.arange(self._cuts[1], self._cuts[2])
        self._check()
        self.traffic = traffic_of(world, options.traffic, options.density)
        self.rules = np.array([self._rules_of(body) for body in self._body])
        self.preset = PRESETS[options.observation]
        self._make_room(worlds, 1, self.agents + self.people + self.traffic)
        self._views = [np.zeros((worlds, number, self._presets[kind].size), np.float32)
                       for kind, number in enumerate(count.tolist())]  # fmt: skip

    def _check(self) -> None:
        """Refuse bodies that fit nowhere."""
        name = self.world.facts["name"]
        for body in dict.fromkeys(self._body):
            if body in VEHICLE and self.map.start[VEHICLE[body], -1] <= 0:
                raise UsageError(fits_nowhere(self.world, self.map, body))
            if body in TRAVELLER:
                first, last = self._ways.first[TRAVELLER[body] : TRAVELLER[body] + 2]
                if first == last:
                    raise UsageError(
                        f'No two doors of "{name}" are joined by a way that a {body} fits along.'
                    )

    @property
    def _presets(self) -> tuple[Preset, Preset, Preset]:
        return self.preset, FLYING["fly"], WALKING["walk"]

    def _rules_of(self, body: str) -> FloatArray:
        """Return the options as kernels take them of one agent."""
        found = rules_of(self.options)
        if body in VEHICLE:
            found[KIND_ASKED] = VEHICLE[body]
        elif body in TRAVELLER:
            found[KIND_ASKED] = TRAVELLER[body]
            found[TOP_REWARD], found[CONTROL] = TRAVELLERS[TRAVELLER[body]].top, TARGET
        else:
            found[KIND_ASKED], found[TOP_REWARD], found[CONTROL] = 0, fly.TOP, TARGET
        return found

    def preset_of(self, agent: int) -> Preset:
        """Return what an agent, by its row, observes."""
        return self._presets[self._realm[agent]]

    def actions_of(self, agent: int) -> int:
        """Return how many numbers an action of an agent, by its row, has."""
        return 4 if self._realm[agent] == FLIES else 2

    def view_of(self, world: int, agent: int) -> NDArray[np.float32]:
        """Return what an agent, by its row, observed, (d,) of its own."""
        realm = self._realm[agent]
        first = 0 if realm == DRIVES else int(self._cuts[realm - 1])
        return np.asarray(self._views[realm][world, agent - first].copy())

    def events_of(self, agent: int) -> tuple[str, ...]:
        """Return the names of the bits of `out.event` of an agent."""
        return (self.events, FLY_EVENTS, WALK_EVENTS)[self._realm[agent]]

    def terms_of(self, agent: int) -> tuple[str, ...]:
        """Return the names of the rows of `out.term` of an agent."""
        return (self.terms, FLY_TERMS, WALK_TERMS)[self._realm[agent]]

    def _begin(self, chosen: BoolArray) -> None:
        fleet.begin_worlds(self.map, self.paths, self._batch, self.rules, self._cuts, chosen)

    def observe(self) -> None:
        """Take in what the agents observe."""
        fleet.observe(self.map, self.paths, self._batch, self.rules, self._cuts,
                      self.preset.number, *self._views)  # fmt: skip

    def step(self, action: FloatArray, *, anew: bool = False) -> None:
        """Step all worlds; what came of it is in `out`. Agents never begin anew by themselves.

        Parameters
        ----------
        action
            (E, A, 4) float64 by rows; who drives or walks takes the first two.
        anew
            False.
        """
        if anew:
            raise UsageError("Agents of a fleet leave one by one; a new episode begins for all.")
        fleet.step_worlds(
            self.map, self.paths, self.walks.top_row, self._batch, self.rules, self._cuts, action,
            self.out, 0, self.worlds,
        )  # fmt: skip
        self.observe()

    def act_by_rule(self) -> FloatArray:
        """Return what the baselines do, (E, A, 4) by rows; the state is only read."""
        action = np.zeros((self.worlds, self.agents, 4))
        fleet.rule(self.map, self.paths, self._batch, self.rules, self._cuts, action)
        return action

    def struck(self, touched: int, agent: int = 0) -> int:
        """Return the id of the object that a row of `out.touched` of an agent is."""
        if self._realm[agent] == FLIES:
            return int(self.walks.top_object[touched])
        return int(self.world.segment_object[touched])

    def route_of(self, world: int, agent: int) -> FloatArray:
        """Return (k, 2) metres of the route of an agent, by its row; of a drone a straight line."""
        if self._realm[agent] == DRIVES:
            return super().route_of(world, agent)
        if self._realm[agent] == FLIES:
            real = self.state.real[world, :, agent]
            return np.asarray(np.linspace(real[[X, Y]], real[[fly.GX, fly.GY]], 60), float)
        route = int(self.state.path[world, agent, ROUTE])
        start, end = self.walks.route_start[route : route + 2]
        return np.asarray(self.walks.route_point[start:end, :2])
