import numpy as np
import pytest

from cityx.sim.engine import Engine
from cityx.sim.options import options_of
from cityx.sim.places import walks_of, world_of


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
