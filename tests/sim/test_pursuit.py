"""The driver by rule keeps to its line in bends."""

from dataclasses import replace

import numpy as np
import pytest

from cityx.sim.baseline import rule_actions
from cityx.sim.engine import Engine
from cityx.sim.kernels.tables import ASIDE
from cityx.sim.options import options_of


@pytest.mark.parametrize("radius", [7.0, 12.0])
@pytest.mark.parametrize("side", [1, -1])
def test_the_driver_does_not_cut_a_bend(two_lanes, radius, side):
    point = two_lanes.point.copy()
    count = len(point) // 2
    angle = point[:count, 4] / radius
    point[:count, 0] = 30.0 + radius * np.sin(angle)
    point[:count, 1] = side * radius * (1.0 - np.cos(angle)) + (5.0 - side * radius)
    point[:count, 3] = side * angle
    none = np.full((2, 2), -1, np.int32)
    alone = np.array([4, 0])  # vehicles fit along the circle alone
    world = replace(two_lanes, point=point, piece_beside=none, piece_vehicle=alone,
                    piece_speed=np.full(2, 4.0))  # fmt: skip
    engine = Engine(world, options_of({"traffic": 0, "goal_m": 150.0, "control": "target"}), 4)
    engine.seed(0)
    engine.begin()
    aside = []
    for step in range(200):
        engine.step(rule_actions(engine), anew=False)
        assert not (engine.out.event & ~1).any()
        if step > 60:
            aside.append(np.abs(engine.state.real[:, ASIDE, 0]))
    assert np.max(aside) < 0.1
