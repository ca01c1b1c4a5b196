"""Engines of those who go on walks, and of those who fly; see `cityx.sim.engine`."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cityx.errors import UsageError
from cityx.geometry.arrays import BoolArray, FloatArray
from cityx.sim.engine import Engine, map_of, paths_of, traffic_of
from cityx.sim.kernels import fly, roam, roam_rule
from cityx.sim.kernels.paths import ROUTE
from cityx.sim.kernels.roam_look import EXPLORED
from cityx.sim.kernels.tables import FLY_EVENTS, FLY_TERMS, TARGET, WALK_EVENTS, WALK_TERMS, X, Y
from cityx.sim.observe import FLYING, WALKING, Preset
from cityx.sim.options import ExploreOptions, FlyOptions, Options, WalkOptions
from cityx.sim.state import DT, LONGEST
from cityx.sim.travellers import TRAVELLER, TRAVELLERS
from cityx.sim.walks import Walks
from cityx.sim.world import World

ROOM = 1024  # cells that one agent can find


def _rules(options: Options, top: float, red: bool, kind: int, more: tuple[int, int]) -> FloatArray:
    """Return the options as kernels take them, `cityx.sim.kernels.tables.NUMBERS`."""
    weights = options.weights
    return np.array([
        DT, options.horizon, options.goal_m, red, top, *(weights[name] for name in options.terms),
        TARGET, kind, options.agents == 1, *more, 0.0,
    ], float)  # fmt: skip


class Roamers(Engine):
    """Worlds of agents on walks, with people and traffic about them.

    Parameters
    ----------
    world, walks
        Where they go.
    options, worlds, threads
        As of `Engine`.

    Raises
    ------
    UsageError
        If there is no route that such a traveller fits along.
    """

    events, terms = WALK_EVENTS, WALK_TERMS
    ways_to_end = ("crash_mover", "crash_object", "off_walk", "fall", "late", "red_light")
    options: WalkOptions

    shown_m = 24.0

    def __init__(
        self, world: World, walks: Walks, options: WalkOptions, worlds: int = 1, threads: int = 1
    ) -> None:
        self.world, self.walks, self.options, self.worlds = world, walks, options, worlds
        self.agents, self.people = options.agents, options.people
        self.map, self.paths = map_of(world), paths_of(walks)
        kind = TRAVELLER[options.vehicle]
        if self.paths.first[kind] == self.paths.first[kind + 1]:
            raise UsageError(
                f'No two doors of "{world.facts["name"]}" are joined by a way that a '
                f"{options.vehicle} fits along; a person fits along "
                f"{self.paths.first[1] - self.paths.first[0]} ways there."
            )
        self.traffic = traffic_of(world, options.traffic, options.density)
        cells = options.cells if isinstance(options, ExploreOptions) else 0
        self.rules = _rules(options, TRAVELLERS[kind].top, options.red_light_ends, kind,
                            (options.people, cells))  # fmt: skip
        self.preset = self._preset_of(options)
        longest = ROOM + EXPLORED if cells else LONGEST
        self._make_room(worlds, threads, self.agents + self.people + self.traffic, longest)

    def _preset_of(self, options: WalkOptions) -> Preset:
        """Return what is observed."""
        return WALKING[options.observation]

    def _begin(self, chosen: BoolArray) -> None:
        roam.begin_worlds(self.map, self.paths, self._batch, self.rules, self.agents, chosen)

    def observe(self) -> None:
        """Write what the agents observe to `view`."""
        roam.observe(self.map, self.paths, self._batch, self.rules, self.view, self.agents)

    def _step(self, action: FloatArray, final: NDArray[np.float32], low: int, high: int) -> None:
        roam.step_worlds(
            self.map, self.paths, self._batch, self.rules, action, self.out, self.view, final,
            self.agents, low, high,
        )  # fmt: skip

    def act_by_rule(self) -> FloatArray:
        """Return what the baseline does, (E, A, 2); the state is only read."""
        action = np.zeros((self.worlds, self.agents, 2))
        roam_rule.rule(self.map, self.paths, self._batch, self.rules, action, self.agents, 0,
                       self.worlds)  # fmt: skip
        return action

    def route_of(self, world: int, agent: int) -> FloatArray:
        """Return (k, 2) metres of the route of an agent; none where it explores."""
        if isinstance(self.options, ExploreOptions):
            return np.zeros((0, 2))
        route = int(self.state.path[world, agent, ROUTE])
        start, end = self.walks.route_start[route : route + 2]
        return np.asarray(self.walks.route_point[start:end, :2])


class Flyers(Engine):
    """Worlds of agents that fly over and between what stands; see `Roamers`."""

    events, terms = FLY_EVENTS, FLY_TERMS
    ways_to_end = ("crash_mover", "crash_object", "out_of_bounds", "late")
    action_size = 4
    options: FlyOptions

    def __init__(
        self, world: World, walks: Walks, options: FlyOptions, worlds: int = 1, threads: int = 1
    ) -> None:
        self.world, self.walks, self.options, self.worlds = world, walks, options, worlds
        self.agents, self.traffic = options.agents, 0
        self.rules = _rules(options, fly.TOP, False, 0, (0, 0))
        self.preset = FLYING[options.observation]
        self._over = walks.top_height, walks.top_frame
        self._make_room(worlds, threads, self.agents)

    def _begin(self, chosen: BoolArray) -> None:
        fly.begin_worlds(*self._over, self._batch, self.rules, self.agents, chosen)

    def observe(self) -> None:
        """Write what the agents observe to `view`."""
        fly.observe(*self._over, self._batch, self.view, self.agents)

    def _step(self, action: FloatArray, final: NDArray[np.float32], low: int, high: int) -> None:
        top, frame = self._over
        fly.step_worlds(
            top, self.walks.top_row, frame, self._batch, self.rules, action, self.out, self.view,
            final, self.agents, low, high,
        )  # fmt: skip

    def act_by_rule(self) -> FloatArray:
        """Return what the baseline does, (E, A, 4); the state is only read."""
        action = np.zeros((self.worlds, self.agents, 4))
        fly.rule(*self._over, self._batch, action, self.agents, 0, self.worlds)
        return action

    def struck(self, touched: int, agent: int = 0) -> int:  # noqa: ARG002
        """Return the id of what is in a row of tops."""
        return int(self.walks.top_object[touched])

    def route_of(self, world: int, agent: int) -> FloatArray:
        """Return (k, 2) metres of the straight way to the goal of an agent."""
        real = self.state.real[world, :, agent]
        return np.asarray(np.linspace(real[[X, Y]], real[[fly.GX, fly.GY]], 60), float)
