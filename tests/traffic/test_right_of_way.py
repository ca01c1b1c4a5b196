"""Who goes first where several wait for each other."""

from types import SimpleNamespace

import numpy as np
import pytest
from lxml import etree
from made_sumo import Car, Sumo

from cityx.traffic.conflicts import Conflicts, conflicts_of, settle
from cityx.traffic.courtesy import AWARE, LET_IN, LONG, Courtesy
from cityx.traffic.waiting import Waiting

# Three ways across a junction: 0 gives way to 1, 1 to 2, and nobody says of 2 and 0.
JUNCTION = """<net><junction id="j" type="{kind}">
<request index="0" response="010" foes="010"/>
<request index="1" response="100" foes="101"/>
<request index="2" response="000" foes="010"/></junction>{ways}</net>"""
WAYS = "".join(f'<connection from="{k}" to="d" via=":j_{k}_0"/>' for k in range(3))
NAMES = {0: ":j_0_0", 1: ":j_1_0", 2: ":j_2_0"}


def settled(kind, turn):
    root = etree.fromstring(JUNCTION.format(kind=kind, ways=WAYS))
    one, other = np.array([0]), np.array([2])  # by their shapes 2 gives way to 0
    settle(root, Conflicts(one, other, np.zeros(3), np.array(turn)), NAMES)
    rows = [request.get("response")[::-1] for request in root.iter("request")]
    return {(i, j) for i, row in enumerate(rows) for j, bit in enumerate(row) if bit == "1"}


@pytest.mark.parametrize("turn", [(0, 1, 2), (2, 0, 1), (1, 2, 0)])
def test_nobody_gives_way_in_a_circle(turn):
    gives_way = settled("priority", turn)
    assert gives_way == {(i, j) for i in range(3) for j in range(3) if turn[i] > turn[j]}


def test_signals_part_those_who_would_wait_in_a_circle():
    assert settled("traffic_light", (0, 1, 2)) == {(0, 1), (1, 2), (2, 0)}


@pytest.mark.parametrize(
    ("gap", "target", "met"), [(1.5, 2, True), (2.5, 2, False), (1.5, 1, True), (2.5, 1, False)]
)
def test_ways_of_lanes_side_by_side_meet_where_they_have_no_room_for_two(gap, target, met):
    shapes = [np.array([[0.0, 0.0, 0.0], [20.0, 0.0, 0.0]]),
              np.array([[0.0, gap, 0.0], [20.0, gap + 9.0, 0.0]])]  # fmt: skip
    links = tuple(
        SimpleNamespace(source=(0, lane), target=(onto, 0), shape=shape)
        for lane, onto, shape in zip((0, 1), (1, target), shapes, strict=True)
    )
    ways = tuple(SimpleNamespace(target=0, rank=0) for _ in range(3))
    conflicts = conflicts_of(SimpleNamespace(links=links, ways=ways))
    assert list(zip(conflicts.first, conflicts.second, strict=True)) == ([(0, 1)] if met else [])


def side_street(far, speed, state="m"):
    """One who waits at a line, and one who comes to its junction."""
    main = Car("main_0", ("main",), at=0.0, waited=0.0, speed=speed)
    sumo = Sumo({"side_0": ("out_0",), "main_0": ()},
                {"side": Car("side_0", ("side", "out")), "main": main}, state=state)  # fmt: skip
    sumo.foes["side"] = [("main", 4.0, far, 9.0, far + 5.0)]
    return sumo


@pytest.mark.parametrize(
    ("far", "speed", "state", "mode"),
    [
        (80.0, 14.0, "m", LET_IN),  # it brakes in time
        (30.0, 14.0, "m", None),  # it does not
        (6.0, 0.0, "m", LET_IN),  # it stands, and waits as well
        (-2.0, 9.0, "m", LET_IN),  # it is on the junction already, and heeded there
        (80.0, 14.0, "g", LET_IN),  # who turns on green waits for a gap as well
        (80.0, 14.0, "r", None),  # signals decide
    ],
)
def test_who_has_waited_long_is_let_in_by_those_who_can_brake(far, speed, state, mode):
    sumo = side_street(far, speed, state)
    Courtesy(sumo).step({"side": LONG + 1.0})
    assert sumo.cars["side"].speed_mode == mode


@pytest.mark.parametrize(("at", "mode"), [(95.0, None), (20.0, LET_IN)])
def test_nobody_is_let_in_before_one_who_turns_and_may_wait_amid_the_junction(at, mode):
    turns = Car("main_0", ("main", "out"), at=at, waited=0.0, speed=4.0)
    sumo = Sumo({"side_0": ("out_0",), "main_0": ("gone_0", "out_0"), ":j_1_0": ("out_0",)},
                {"side": Car("side_0", ("side", "out")), "main": turns}, state="m")  # fmt: skip
    courtesy = Courtesy(sumo)
    courtesy.amid = {":j_9_0": ("main_0", ":j_1_0")}
    sumo.crossed[":j_0_0"] = (":j_9_0",)
    courtesy.step({"side": LONG + 1.0})
    assert sumo.cars["side"].speed_mode == mode


def test_who_was_let_in_heeds_everybody_again():
    sumo = side_street(80.0, 14.0)
    courtesy, side = Courtesy(sumo), sumo.cars["side"]
    courtesy.step({"side": LONG + 1.0})
    side.waited, side.lane = 0.0, ":j_0_0"
    courtesy.step({})
    assert side.speed_mode == LET_IN
    side.lane, side.at = "out_0", 2.0
    courtesy.step({})
    assert side.speed_mode == AWARE


def test_seconds_under_a_red_signal_are_no_waiting_for_others():
    sumo = side_street(80.0, 14.0, "r")
    waiting = Waiting(sumo)
    seen = []
    for sumo.now, sumo.state in ((0.0, "r"), (30.0, "r"), (31.0, "g"), (36.0, "g"), (40.0, "y")):
        seen.append(waiting.step())
    assert seen == [{}, {}, {"side": 0.0}, {"side": 5.0}, {}]
