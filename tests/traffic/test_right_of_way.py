"""Who goes first where several wait for each other."""

from types import SimpleNamespace

import numpy as np
import pytest
from lxml import etree

from cityx.traffic.conflicts import Conflicts, settle
from cityx.traffic.courtesy import AWARE, LET_IN, LONG, Courtesy

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


class Street:
    """What `Courtesy` asks of SUMO: one who waits at a line, and one who comes to its junction."""

    def __init__(self, far, speed, state="m"):
        self.waits, self.lane, self.mode = LONG + 1.0, "side_0", AWARE
        self.vehicle = SimpleNamespace(
            getIDList=lambda: ("main", "side"),
            getWaitingTime=lambda name: self.waits if name == "side" else 0.0,
            getLaneID=lambda name: self.lane if name == "side" else "main_0",
            getLanePosition=lambda name: 49.5 if name == "side" else 0.0,
            getNextLinks=lambda _: [("out_0", False, False, True, ":j1_0_0", state, "l", 9.0)],
            getJunctionFoes=lambda *_: [("main", 4.0, far, 9.0, far + 5.0)],
            getSpeed=lambda name: speed if name == "main" else 0.0,
            setSpeedMode=self.set_mode,
        )
        self.lane_of = SimpleNamespace(getLength=lambda _: 50.0)

    def set_mode(self, name, mode):
        assert name == "side"
        self.mode = mode

    def courtesy(self):
        return Courtesy(SimpleNamespace(vehicle=self.vehicle, lane=self.lane_of))


@pytest.mark.parametrize(
    ("far", "speed", "state", "mode"),
    [
        (80.0, 14.0, "m", LET_IN),  # it brakes in time
        (30.0, 14.0, "m", AWARE),  # it does not
        (6.0, 0.0, "m", LET_IN),  # it stands, and waits as well
        (80.0, 14.0, "r", AWARE),  # signals decide
    ],
)
def test_who_has_waited_long_is_let_in_by_those_who_can_brake(far, speed, state, mode):
    street = Street(far, speed, state)
    street.courtesy().step()
    assert street.mode == mode


def test_who_was_let_in_heeds_everybody_again():
    street = Street(80.0, 14.0)
    courtesy = street.courtesy()
    courtesy.step()
    street.waits, street.lane = 0.0, ":j1_0_0"
    courtesy.step()
    assert street.mode == LET_IN
    street.lane = "out_0"
    street.vehicle.getLanePosition = lambda _: 2.0
    courtesy.step()
    assert street.mode == AWARE
