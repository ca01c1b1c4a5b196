"""The engine: worlds stepped by kernels, in as many threads as are asked for."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor, wait
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cityx.errors import UsageError
from cityx.geometry.arrays import BoolArray, FloatArray
from cityx.sim.dynamics import DRIVEN, VEHICLE, VEHICLES, fits_as, vehicle_table
from cityx.sim.kernels import observe as observing
from cityx.sim.kernels import pursuit
from cityx.sim.kernels import step as stepping
from cityx.sim.kernels.paths import Paths
from cityx.sim.kernels.rasters import grid_cells
from cityx.sim.kernels.reach import reach_of
from cityx.sim.kernels.tables import (
    ALIVE,
    AT,
    EVENTS,
    JERK,
    PEDALS,
    SIZE,
    TARGET,
    TERMS,
    Map,
    Outcome,
)
from cityx.sim.observe import PRESETS, Preset
from cityx.sim.options import RULES, DriveOptions, Options
from cityx.sim.others import Others, Source
from cityx.sim.scenery import Scenery
from cityx.sim.state import DT, LONGEST, State, new_state
from cityx.sim.travellers import TRAVELLERS, traveller_table
from cityx.sim.walks import Walks
from cityx.sim.world import World

VERSION = 5  # of the kernels; rises whenever they move the same state otherwise
TOP = 80.0 / 3.6  # m/s at which the reward for speed is whole
LANE_CELL = 16.0  # metres of the cells of the lines that are observed
EVERY = 4  # points of a lane between the ends of what is observed of it
SHORTEST = 1.0  # metres of a side that is observed
FARTHEST = 1200.0  # metres of a way on that are told
ROAD_LINE, ROAD_EDGE = 0.0, 2.0  # types of segments of roads
CROSSES = 1.2  # m/s at which it is reckoned when a crosswalk has been crossed


def map_of(world: World, *, narrow: bool = True) -> Map:
    """Return the arrays of a world as kernels take them, and what follows from them.

    Parameters
    ----------
    world
        The world.
    narrow
        Whether agents are led along lanes on which others come against them.
    """
    length = world.piece_length
    usable, start, reach = [], [], []
    for number, vehicle in enumerate(DRIVEN):
        led = world.fits(fits_as(number)) & world.piece_public
        if not narrow:
            led &= ~world.piece_narrow
        usable.append(led.astype(np.uint8) + _for_traffic(world, led))
        reach.append(reach_of(world.next_start, world.next, length, led, FARTHEST))
        offered = led & ~world.across & (reach[-1] > 1.5 * vehicle.length)
        start.append(np.cumsum(np.where(offered, length, 0.0)))
    lane, grid, lane_start, lane_row = _roads(world)
    state = np.where(world.signal_state == 0, 5, world.signal_state).astype(np.uint8)  # off: go
    return Map(
        world.point_start, world.point, world.next_start, world.next, length, world.piece_speed,
        world.across, np.stack(usable, axis=1), np.stack(reach, axis=1), np.stack(start),
        world.piece_beside, world.conflict_start, world.conflict, world.conflict_yields,
        world.piece_signal,
        world.signal_cycle, world.signal_start, world.signal_time, state, world.flags,
        world.clear, world.raster_frame, world.segment, world.cell_start,
        world.cell_segment, world.cell_frame, vehicle_table(DRIVEN), lane, grid,
        lane_start, lane_row,
    )  # fmt: skip


def _for_traffic(world: World, led: BoolArray) -> BoolArray:
    """(n,) pieces that the traffic takes: none on which others come against it.

    Nor a way across that leads only onto such, on which it would end in the middle of a junction.
    """
    own = led & ~world.piece_narrow
    source = np.repeat(np.arange(world.count), np.diff(world.next_start))
    leads = np.zeros(world.count, bool)
    leads[source[own[world.next]]] = True
    return np.asarray(own & (leads | ~world.across))


def paths_of(walks: Walks) -> Paths:
    """Return the arrays of walks as kernels take them, and what follows from them."""
    length = np.hypot(*(walks.crossing_ends[:, 1] - walks.crossing_ends[:, 0]).T)
    first = np.searchsorted(walks.route_kind, np.arange(len(TRAVELLERS) + 1))
    return Paths(
        walks.cell_frame, walks.cell_flags, walks.cell_height, walks.cell_crossing,
        walks.crossing_signal, length / CROSSES, walks.crossing_ends, walks.route_start,
        walks.route_point, walks.route_crossing, walks.route_length, first.astype(np.int64),
        traveller_table(), walks.top_height, walks.top_frame,
    )  # fmt: skip


def _roads(world: World) -> tuple[NDArray[Any], ...]:
    """Return the lines of lanes and sides of solids that are observed, by cells."""
    count = np.diff(world.point_start)
    owner = np.repeat(np.arange(world.count), count)
    within = np.arange(len(owner)) - world.point_start[owner]
    last = within == count[owner] - 1
    kept = np.flatnonzero((within % EVERY == 0) | last)
    one, other = kept[:-1], kept[1:]
    same = owner[one] == owner[other]
    one, other = one[same], other[same]
    lines = np.column_stack([world.point[one, :2], world.point[other, :2], world.point[one, 2],
                             np.full(len(one), ROAD_LINE)])  # fmt: skip
    side = world.segment
    side = side[np.hypot(side[:, 2] - side[:, 0], side[:, 3] - side[:, 1]) > SHORTEST]
    edges = np.column_stack([side[:, :4], side[:, 4], np.full(len(side), ROAD_EDGE)])
    lane = np.concatenate([lines, edges]).astype(np.float32)
    west, south, cell, columns, rows = world.raster_frame
    grid = np.array([west, south, LANE_CELL, np.ceil(columns * cell / LANE_CELL),
                     np.ceil(rows * cell / LANE_CELL)])  # fmt: skip
    return lane, grid, *grid_cells(lane, grid)


def rules_of(options: DriveOptions) -> FloatArray:
    """Return the options as kernels take them, `cityx.sim.kernels.tables.NUMBERS`."""
    weights = options.weights
    control = {"pedals": PEDALS, "target": TARGET, "jerk": JERK}[options.control]
    return np.array([
        DT, options.horizon, options.goal_m, options.red_light_ends, TOP,
        *(weights[name] for name in TERMS), control, VEHICLE[options.vehicle],
        options.agents == 1, options.people, 0.0, options.source != RULES,
    ], float)  # fmt: skip


class Engine:
    """E worlds of A agents and their traffic; a class for the state that it steps.

    World e of a batch with the seed s is, bit by bit, the only world of a batch with the seed
    s + e, whatever the number of threads.

    Attributes
    ----------
    view, final
        (E, A, d) float32: what agents observe, and what those whose episode ended observed last.
    out
        What the last step came to.
    threads
        That step the worlds.
    shown_m
        Metres that a picture of an agent shows.

    Parameters
    ----------
    world
        Where they drive.
    options
        What is observed, rewarded and driven.
    worlds, threads
        E, and how many threads step them.
    walks
        Of the same city, where the options have people.
    source
        Of the traffic, where that comes from outside.

    Raises
    ------
    UsageError
        If the vehicle fits along no lane of the world, or people are asked for where none walk.
    """

    events: tuple[str, ...] = EVENTS  # names of the bits of `out.event`
    terms: tuple[str, ...] = TERMS  # names of the rows of `out.term`
    ways_to_end: tuple[str, ...] = (
        "crash_human", "crash_vehicle", "crash_object", "off_road", "off_route", "late",
        "red_light",
    )  # fmt: skip
    action_size = 2
    people = 0
    others: Others | None = None
    options: Options
    preset: Preset

    shown_m = 60.0

    def __init__(
        self, world: World, options: DriveOptions, worlds: int = 1, threads: int = 1,
        walks: Walks | None = None, source: Source | None = None,
    ) -> None:  # fmt: skip
        if (source is None) != (options.source == RULES):
            raise UsageError(
                f'source is "{options.source}"; only cars of one place take traffic from outside.'
            )
        if source is not None and options.traffic is not None:
            raise UsageError(
                f'source is "{options.source}" and traffic is {options.traffic}; how many there '
                "are is told by the source. Leave traffic out."
            )
        self.world, self.options, self.worlds = world, options, worlds
        self.agents = options.agents
        self.map = map_of(world)
        vehicle = VEHICLE[options.vehicle]
        if self.map.start[vehicle, -1] <= 0:
            raise UsageError(fits_nowhere(world, self.map, options.vehicle))
        self.traffic = (
            traffic_of(world, options.traffic, options.density) if source is None else source.most
        )
        self.people = options.people
        if source is not None:
            self.others = Others(source, world, self.agents + self.people)
        self.paths = self._paths_of(walks)
        self.rules = rules_of(options)
        self.preset = PRESETS[options.observation]
        self._make_room(worlds, threads, self.agents + self.people + self.traffic)

    def _paths_of(self, walks: Walks | None) -> Paths | None:
        """Return the walks as kernels take them; None where nobody is on foot."""
        if self.people == 0:
            return None
        name = self.world.facts["name"]
        if walks is None:
            raise UsageError(
                f'people is {self.people}; the world of "{name}" was given without its walks.'
            )
        paths = paths_of(walks)
        if paths.first[1] == paths.first[0]:
            raise UsageError(
                f'people is {self.people}; no two doors of "{name}" are joined by a walk.'
            )
        return paths

    def _make_room(self, worlds: int, threads: int, movers: int, longest: int = LONGEST) -> None:
        """Make the arrays of the state and of what comes of a step, and the threads."""
        self.state: State = new_state(worlds, movers, longest)
        shape = (worlds, self.agents)
        self.out = Outcome(
            np.zeros(shape), np.zeros((len(TERMS), *shape)), np.zeros(shape),
            np.zeros(shape, np.int64), np.full(shape, -1, np.int64), np.zeros(shape, bool),
            np.zeros(shape, bool), np.zeros(shape),
        )  # fmt: skip
        self.view = np.zeros((*shape, self.preset.size), np.float32)
        self.final = np.zeros_like(self.view)
        self._no_final = self.final[:0]
        self._batch = self.state.batch
        self.threads = max(min(threads, worlds), 1)
        self._pool = ThreadPoolExecutor(self.threads) if self.threads > 1 else None
        cuts = np.linspace(0, worlds, self.threads + 1).round().astype(int).tolist()
        self._parts = list(pairwise(cuts))

    def seed(self, seed: int) -> None:
        """Give world e the seed `seed` + e; its next episode is its first."""
        self.state.seed[:] = np.arange(self.worlds).astype(np.uint64) + np.uint64(
            seed & 0xFFFFFFFFFFFFFFFF
        )
        self.state.episode[:] = 0

    def begin(self, chosen: BoolArray | None = None) -> None:
        """Begin the next episode of chosen worlds, (E,), and write what is observed to `view`."""
        if chosen is None:
            chosen = np.ones(self.worlds, bool)
        self._begin(chosen)
        if self.others is not None:
            self.others.begin(self.state, chosen, self.agents)
        self.observe()

    def _begin(self, chosen: BoolArray) -> None:
        stepping.begin_worlds(self.map, self.paths, self._batch, self.rules, self.agents, chosen)

    def observe(self) -> None:
        """Write what the agents observe to `view`."""
        observing.observe(self.map, self._batch, self.rules, self.preset.number, self.view,
                          self.agents, 0, self.worlds)  # fmt: skip

    def step(self, action: FloatArray, *, anew: bool = True) -> None:
        """Step all worlds; what came of it is in `out`, what is observed in `view`.

        Parameters
        ----------
        action
            (E, A, a) float64; beyond -1 and 1 it is as at these.
        anew
            Whether agents whose episode ended begin another one at once; `final` has what they
            observed before.
        """
        if self.others is not None:
            self.others.step(self.state, self.agents)
        self._step_all(action, self.final if anew else self._no_final)
        if self.others is not None and (begun := self.others.begun_anew(self.state)).any():
            self.others.begin(self.state, begun, self.agents)
            self.observe()

    def _step_all(self, action: FloatArray, final: NDArray[np.float32]) -> None:
        if self._pool is None:
            self._step(action, final, 0, self.worlds)
            return
        jobs = [self._pool.submit(self._step, action, final, low, high)
                for low, high in self._parts]  # fmt: skip
        wait(jobs)
        for job in jobs:
            job.result()

    def _step(self, action: FloatArray, final: NDArray[np.float32], low: int, high: int) -> None:
        stepping.step_worlds(
            self.map, self.paths, self._batch, self.rules, action, self.out, self.preset.number,
            self.view, final, self.agents, low, high,
        )  # fmt: skip

    def act_by_rule(self) -> FloatArray:
        """Return what the baseline does, (E, A, a); the state is only read."""
        action = np.zeros((self.worlds, self.agents, self.action_size))
        pursuit.pursue(self.map, self._batch, self.rules, action, self.agents, 0, self.worlds)
        return action

    def leave(self, world: int, agent: int) -> None:
        """Take an agent out of its world until the next episode; nobody meets it any more."""
        self.state.whole[world, ALIVE, agent] = 0

    def events_of(self, agent: int) -> tuple[str, ...]:  # noqa: ARG002
        """Return the names of the bits of `out.event` of an agent."""
        return self.events

    def terms_of(self, agent: int) -> tuple[str, ...]:  # noqa: ARG002
        """Return the names of the rows of `out.term` of an agent."""
        return self.terms

    def struck(self, touched: int, agent: int = 0) -> int:  # noqa: ARG002
        """Return the id of the object that a row of `out.touched` of an agent is."""
        return int(self.world.segment_object[touched])

    def way_m(self, world: int, agent: int) -> float:
        """Return the metres of the route of an agent."""
        return float(self.state.row("goal")[world, agent])

    def scenery(self) -> Scenery | None:
        """Return what cameras see of a world that is one of several; None where a place says it."""
        return None

    def route_of(self, world: int, agent: int) -> FloatArray:
        """Return (k, 2) metres of the route of an agent, from where it is on."""
        whole, place = self.state.whole[world], self.world
        pieces = self.state.path[world, agent, whole[AT, agent] : whole[SIZE, agent]].tolist()
        parts = [place.point[place.point_start[k] : place.point_start[k + 1], :2] for k in pieces]
        return np.concatenate([np.zeros((0, 2)), *parts])

    def close(self) -> None:
        """Let its threads go, and what moves the traffic."""
        if self.others is not None:
            self.others.source.close()
        if self._pool is not None:
            self._pool.shutdown()


def fits_nowhere(world: World, arrays: Map, vehicle: str) -> str:
    """Return the sentence that a vehicle fits along no lane, and which one does."""
    largest = [each.name for number, each in enumerate(VEHICLES) if arrays.start[number, -1] > 0]
    return f'A {vehicle} fits along no lane of "{world.facts["name"]}"' + (
        f"; a {largest[-1]} does." if largest else ", nor does any other vehicle."
    )


def traffic_of(world: World, traffic: int | None, density: float) -> int:
    """Return how many vehicles the traffic of one world has, asked for or by the kilometre."""
    if traffic is not None:
        return traffic
    open_to_all = ~world.across & world.piece_public & ~world.piece_narrow & world.fits(1)
    return int(min(density * float(world.piece_length[open_to_all].sum()) / 1000.0, 250))
