import json

import numpy as np
import pytest

from cityx.sim.blocks import SIDE
from cityx.sim.compile.rasters import BIT
from cityx.sim.engine import Engine
from cityx.sim.options import options_of
from cityx.sim.places import walks_of, world_of
from cityx.sim.world import World, read_world, write_kept

LONG, APART = 260.0, 3.2  # metres of two lanes, and between them; lane 0 is the right one


@pytest.fixture(scope="session")
def town(built_town):
    """The folder of the small town, at the level of detail that the simulator builds."""
    return built_town(lod=1)


@pytest.fixture(scope="session")
def world(town):
    return world_of(town)


@pytest.fixture(scope="session")
def placed(town):
    """The world and the walks of the small town."""
    return walks_of(town)


@pytest.fixture(scope="session")
def two_lanes(tmp_path_factory):
    """Return the world of two lanes eastwards with nothing between, on a plain of asphalt."""
    count = round(LONG) + 1
    x = np.arange(count, dtype=float)
    rest = np.zeros(count)
    point = np.concatenate([np.column_stack([x, rest + y, rest, rest, x, rest])
                            for y in (0.0, APART)])  # fmt: skip
    none = np.full(2, -1, np.int32)
    start, empty = np.zeros(3, np.int32), np.zeros(0, np.int32)
    frame = np.array([-20.0, -20.0, 0.5, 600.0, 100.0])
    grid = np.array([-20.0, -20.0, 8.0, 38.0, 7.0])
    world = World(
        np.array([1, 2], np.uint64), np.zeros(2, np.uint64), none, np.full(2, 12.0),
        np.full(2, APART / 2), np.ones(2, bool), np.zeros(2, bool), np.full(2, 4),
        np.zeros((2, 4), np.uint64), none, np.array([0, count, 2 * count]), point, start, empty,
        np.array([[1, -1], [-1, 0]], np.int32), start, empty, np.zeros(0, bool), np.zeros(0),
        np.zeros(1, np.int64), np.zeros(0), np.zeros(0, np.uint8), frame,
        *(each for value in (BIT["roadway"], 255)
          for each in (np.zeros((2, 10), np.int32), np.full((1, SIDE, SIDE), value, np.uint8))),
        np.zeros((0, 6), np.float32), np.zeros(0, np.uint64), grid,
        np.zeros(38 * 7 + 1, np.int32), empty,
        np.array([json.dumps({"name": "two lanes", "hash": "0" * 64})]),
    )  # fmt: skip
    path = tmp_path_factory.mktemp("lanes") / "world.npz"
    write_kept(world, path)
    return read_world(path)


@pytest.fixture
def engine(world):
    """Return an engine on the small town, seeded and begun."""

    def made(worlds=1, seed=0, threads=1, **options):
        found = Engine(
            world, options_of({"goal_m": 60.0, "traffic": 4, **options}), worlds, threads
        )
        found.seed(seed)
        found.begin()
        return found

    return made


@pytest.fixture
def actions():
    """Return actions that drive on, more or less, (steps, E, A, 2)."""

    def drawn(steps, worlds, agents=1, seed=0):
        found = np.random.default_rng(seed).uniform(-1, 1, (steps, worlds, agents, 2))
        return found * [0.15, 0.5] + [0.0, 0.3]

    return drawn
