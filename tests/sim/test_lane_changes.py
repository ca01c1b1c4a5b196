"""Traffic and the driver by rule get round what stands ahead, by a free lane beside their own."""

import numpy as np
import pytest

from cityx.sim.baseline import rule_actions
from cityx.sim.compile.lanes import _beside
from cityx.sim.engine import Engine
from cityx.sim.info import happened
from cityx.sim.kernels.tables import (
    ALIVE,
    ALONG,
    ASIDE,
    GOAL,
    GONE,
    LEAVES,
    PIECE,
    POINT,
    SPEED,
    STEER,
    WAITED,
    X,
    Y,
    Z,
)
from cityx.sim.options import options_of
from cityx.traffic.streets import Lane, Streets, Way

LONG, APART = 260.0, 3.2  # metres of the two lanes, and between them


@pytest.fixture
def road(two_lanes):
    """Return an engine on the two lanes, and what puts a mover on one of them."""

    def made(traffic):
        engine = Engine(two_lanes, options_of({"traffic": traffic, "goal_m": 200.0}))
        engine.seed(0)
        engine.begin()
        real, whole = engine.state.real[0], engine.state.whole[0]
        whole[ALIVE, 1:] = 0

        def put(n, lane, along, speed=0.0):
            real[[X, Y, Z], n] = along, lane * APART, 0.0
            real[[ALONG, GONE, SPEED], n] = along, 0.0, speed
            for row in (ASIDE, STEER, WAITED):
                real[row, n] = 0.0
            whole[[ALIVE, PIECE, LEAVES], n] = 1, lane, -1
            engine.state.path[0, n, 0] = lane
            whole[POINT, n] = two_lanes.point_start[lane] + int(along)

        return engine, put

    return made


def stepped(engine, put, standing, steps):
    """Drive by rule past those who stand; return (steps, N) metres aside of the right lane."""
    aside = []
    for _ in range(steps):
        for n, lane, along in standing:
            put(n, lane, along)
        engine.step(rule_actions(engine), anew=False)
        aside.append(engine.state.real[0, Y].copy())
        if engine.out.ended[0, 0] or engine.out.late[0, 0]:
            break
    return np.array(aside)


def test_the_driver_by_rule_passes_a_car_that_stands_and_comes_back(road):
    engine, put = road(1)
    put(0, 0, 10.0)
    engine.state.real[0, GOAL, 0] = 200.0
    aside = stepped(engine, put, [(1, 0, 70.0)], 600)[:, 0]
    assert happened(engine, 0, 0) == [{"event": "goal"}]
    assert aside.max() == pytest.approx(APART, abs=0.5)
    assert abs(aside[-1]) < 0.3


def test_the_driver_by_rule_waits_while_somebody_comes_beside_it(road):
    engine, put = road(2)
    put(0, 0, 50.0)
    aside = stepped(engine, put, [(1, 0, 70.0), (2, 1, 52.0)], 100)[:, 0]
    assert np.abs(aside).max() < 0.3
    assert engine.state.real[0, X, 0] < 66.0
    assert happened(engine, 0, 0) == []


def test_traffic_passes_an_agent_that_stands_without_touching_it(road):
    engine, put = road(1)
    put(1, 0, 10.0, 10.0)
    seen = []
    for _ in range(160):
        put(0, 0, 90.0)
        engine.step(np.array([[[0.0, -1.0]]]), anew=False)
        assert happened(engine, 0, 0) == []
        seen.append((engine.state.real[0, X, 1], engine.state.real[0, Y, 1]))
    x, y = np.array(seen).T
    assert y[-1] == pytest.approx(APART, abs=0.05)
    assert x[-1] > 110.0
    step = np.hypot(np.diff(x), np.diff(y))
    assert step.max() < 1.3, "it drove over, it did not jump"
    assert (np.abs(np.diff(y)) <= 0.26 * np.diff(x) + 1e-9).all(), "nobody slides aside"


def test_traffic_stays_behind_where_who_comes_beside_would_have_to_brake(road):
    engine, put = road(2)
    put(1, 0, 60.0, 8.0)
    put(2, 1, 40.0, 12.0)
    lanes = []
    for _ in range(25):
        put(0, 0, 90.0)
        engine.step(np.array([[[0.0, -1.0]]]), anew=False)
        lanes.append(tuple(engine.state.whole[0, PIECE, 1:]))
    assert (1, 1) not in lanes[:12], "nobody pulls out before a car that is faster and close"


def test_a_vehicle_that_changes_is_behind_who_is_ahead_on_either_lane(road):
    engine, put = road(3)
    put(1, 0, 10.0, 10.0)
    for _ in range(300):
        put(0, 0, 90.0)
        put(2, 1, 108.0)
        engine.step(np.array([[[0.0, -1.0]]]), anew=False)
        assert happened(engine, 0, 0) == []
    assert engine.state.real[0, X, 1] < 108.0 - 4.5, "it stands behind the one beside"
    assert engine.state.real[0, Y, 1] == pytest.approx(APART, abs=0.1)


def test_lanes_beside_are_told_by_hand_and_by_what_lies_between():
    def way(*apart):
        lanes = [Lane(row, "drive", 3.0, 10.0, np.array([[0.0, 3.0 * row, 0], [50, 3 * row, 0]]),
                      False) for row in range(3)]  # fmt: skip
        return Way("1", 0, 0, 1, 0, tuple(lanes), apart)

    rows = {(0, k): k for k in range(3)}

    def beside(left_hand, *apart):
        streets = Streets((way(*apart),), (), (), np.zeros((2, 3)), np.zeros(2, bool), left_hand)
        return _beside(streets, rows).tolist()

    assert beside(False, False, False) == [[1, -1], [2, 0], [-1, 1]]
    assert beside(True, False, False) == [[-1, 1], [0, 2], [1, -1]]
    assert beside(False, True, False) == [[-1, -1], [2, -1], [-1, 1]]
