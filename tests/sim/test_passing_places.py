"""Two robots that meet head on where a walk has room for one: one of them makes way."""

import json

import numpy as np
import pytest

from cityx.sim.baseline import rule_actions
from cityx.sim.kernels.one import world_at
from cityx.sim.kernels.people import set_on_route
from cityx.sim.kernels.tables import X, Y
from cityx.sim.options import WalkOptions
from cityx.sim.roamers import Roamers
from cityx.sim.travellers import TRAVELLER
from cityx.sim.walks import AREA, FITS, Walks

CELL, LONG = 0.2, 40.0  # metres: of a cell, and of a path along y = 0 from x = 0 on
ROBOT = TRAVELLER["robot"]
ENDS = 2.0  # metres of square at either end where there is room for both


@pytest.fixture
def path(two_lanes):
    """Return an engine of two robots on a path, who come from its two ends.

    The middle of a robot may be on the axis alone, at the ends, and in bays north of the path.
    """

    def made(*bays):
        columns, rows = round((LONG + 2 * ENDS) / CELL), round(8.0 / CELL)
        x = (np.arange(columns) + 0.5) * CELL - ENDS
        y = (np.arange(rows) + 0.5) * CELL - 4.0 + CELL / 2
        open_ = np.repeat(np.abs(y)[:, None] < CELL, columns, axis=1)
        open_[:, (x < ENDS) | (x > LONG - ENDS)] |= (np.abs(y) < ENDS)[:, None]
        for bay in bays:
            open_ |= (np.abs(x - bay) < 0.6) & (y[:, None] > 0) & (y[:, None] < 2.0)
        flags = np.where(open_, AREA | sum(FITS), AREA).astype(np.uint8)
        along = np.arange(0.0, LONG + 0.1, 0.5)
        point = np.column_stack([along, along * 0, along * 0, along])
        frame = np.array([-ENDS, -4.0 + CELL / 2, CELL, columns, rows])
        none, shape = np.zeros(0), (rows, columns)
        walks = Walks(
            frame, flags, np.zeros(shape, np.float32), np.zeros(shape, np.int16),
            none.astype(np.uint64), np.zeros((0, 2, 2)), none.astype(np.int32),
            np.zeros((0, 3), bool), np.array([0, len(point)]), point,
            np.zeros(len(point), np.int16), np.array([ROBOT], np.int32),
            np.zeros((1, 2), np.uint64), frame, np.zeros(shape, np.float32),
            np.zeros(shape, np.int32), np.zeros(1, np.uint64),
            np.array([json.dumps({"name": "path", "open_m2": [0, 0, 0], "doors": 2})]),
        )  # fmt: skip
        engine = Roamers(two_lanes, walks, WalkOptions(agents=2, people=0, traffic=0, goal_m=LONG))
        engine.seed(0)
        engine.begin()
        here = world_at(engine.state.batch, 0)
        for n in range(2):
            set_on_route(engine.paths, here, n, ROBOT, 0, 1 - n, 0.0)
        return engine

    return made


@pytest.mark.parametrize("bays", [(12.0,), (20.0,), (31.0,), ()])
def test_of_two_robots_head_on_one_lets_the_other_pass(path, bays):
    engine = path(*bays)
    arrived = set()
    for _ in range(1500):
        engine.step(rule_actions(engine), anew=False)
        for n in range(2):
            if engine.out.ended[0, n]:
                assert engine.out.event[0, n] == 1, "it touches, or leaves the path"
                arrived.add(n)
                engine.leave(0, n)
        if len(arrived) == 2:
            return
    raise AssertionError(engine.state.real[0][[X, Y]])
