"""Who may step onto a crosswalk without a signal."""

import numpy as np
import pytest

from cityx.sim.kernels.one import world_at
from cityx.sim.kernels.paths import may_cross
from cityx.sim.kernels.tables import ALIVE, HEADING, SPEED, X, Y, Z
from cityx.sim.options import WalkOptions
from cityx.sim.roamers import Roamers


@pytest.fixture
def road(placed):
    """An engine with one vehicle, whose crosswalks have no signals, and one of these."""
    engine = Roamers(*placed, WalkOptions(people=0, traffic=1))
    engine.seed(1)
    engine.begin()
    engine.state.whole[0, ALIVE, 1] = 1
    engine.paths = engine.paths._replace(signal=np.full_like(engine.paths.signal, -1))
    return engine, 1


def let_go(road, away, speed, up=0.0):
    """Whether one may step out before a vehicle so many metres from the crosswalk."""
    engine, crossing = road
    one, other = engine.paths.ends[crossing - 1]
    middle, along = (one + other) / 2, (other - one) / np.hypot(*(other - one))
    side = np.array([-along[1], along[0]])
    real = engine.state.real[0]
    half = np.hypot(*(other - one)) / 2
    real[[X, Y], 1] = middle + side * (away + half + 3.0)
    real[Z, 1] = real[Z, 0] + up
    real[HEADING, 1], real[SPEED, 1] = np.arctan2(-side[1], -side[0]), speed
    here = world_at(engine.state.batch, 0)
    return may_cross(engine.map, engine.paths, here, 0, 1, crossing)


@pytest.mark.parametrize(
    ("away", "speed", "up", "goes"),
    [
        (60.0, 12.0, 0.0, True),  # it stops in comfort
        (25.0, 12.0, 0.0, False),  # it does not
        (25.0, 4.0, 0.0, True),
        (2.0, 4.0, 0.0, False),
        (2.0, 0.0, 0.0, True),  # it stands
        (2.0, 12.0, 6.0, True),  # it passes overhead
    ],
)
def test_who_can_still_stop_is_not_waited_for(road, away, speed, up, goes):
    assert let_go(road, away, speed, up) == goes
