"""Cyclists keep to the kerb of the lanes they share, and amid their own."""

from types import SimpleNamespace

import numpy as np
import pytest

from cityx.city.section import KIND
from cityx.traffic.kerbside import DOORS, EASE, KERB, asides, kept_aside
from cityx.traffic.streets import Lane, Link, Streets, Way

AHEAD = np.array([[0.0, 0.0, 0.0], [50.0, 0.0, 0.0]])
TURN = np.linspace(0.0, np.pi / 2, 9)
BEND = np.column_stack([5 * np.sin(TURN), 5 - 5 * np.cos(TURN), 0.0 * TURN])  # to the left


def lane(kind, row, width=3.5):
    return Lane(row, kind, width, 10.0, AHEAD, narrow=False)


def place(*, left_hand, bends=BEND, parked=False):
    """A way with a walk, two lanes, and one that leads across a junction; a cycle way beside."""
    ways = (
        Way("w", 0, 0, 1, 1, (lane("walk", 2), lane("drive", 0), lane("drive", 1)), (True, False)),
        Way("c", 1, 0, 1, 1, (lane("cycle", 3, 1.6), lane("drive", 4)), (False,)),
    )
    links = (Link((0, 1), (1, 0), bends),)
    streets = Streets(ways, links, (), np.zeros((2, 3)), np.zeros(2, bool), left_hand)
    network = SimpleNamespace(
        lanes={f"{'wc'[w]}_{n}": (w, n) for w in (0, 1) for n in range(len(ways[w].lanes))},
        links={":j_0": 0},
    )
    kind = [KIND[name] for name in ("drive", "drive", "parking" if parked else "shoulder")]
    graph = SimpleNamespace(
        count=5, edge=np.zeros(3, np.int32), kind=np.array(kind, np.uint8),
        left=np.array([3.5, 7.0, 0.0]), right=np.array([0.0, 3.5, -2.1]),
    )  # fmt: skip
    for name, blank in (("edge", 1), ("kind", KIND["walk"]), ("left", 99.0), ("right", 98.0)):
        setattr(graph, name, np.r_[getattr(graph, name), blank, blank])
    return graph, streets, network


@pytest.mark.parametrize(("left_hand", "side"), [(False, -1.0), (True, 1.0)])
def test_they_ride_at_the_kerb_of_a_shared_lane_and_amid_all_others(left_hand, side):
    names = np.array(["w_1", "w_2", "c_0", "c_1", "elsewhere"])
    found = asides(*place(left_hand=left_hand), names)
    assert found == pytest.approx([side * (1.75 - KERB), 0.0, 0.0, 0.0, 0.0])


def test_they_ride_clear_of_the_doors_of_parked_cars():
    found = asides(*place(left_hand=False, parked=True), np.array(["w_1"]))
    assert found == pytest.approx([-(1.75 - DOORS)])


@pytest.mark.parametrize(("left_hand", "held"), [(False, True), (True, False)])
def test_they_turn_round_a_kerb_amid_the_way_and_else_hold_their_side(left_hand, held):
    found = asides(*place(left_hand=left_hand), np.array([":j_0"]))
    assert np.isnan(found[0]) == held
    assert held or found[0] == 0.0


def test_they_get_aside_gently_each_by_themselves():
    gone = np.arange(0.0, 60.0, 0.5)
    xy = np.column_stack([gone, 0.0 * gone])
    wanted = np.where(gone < 30.0, 0.0, 1.0)
    wanted[(gone > 40.0) & (gone < 50.0)] = np.nan
    two = np.concatenate([xy, xy])
    mover = np.repeat([0, 1], len(gone))
    position, heading = kept_aside(two, np.zeros(len(two)), mover, np.r_[wanted, 0.0 * wanted])
    aside = position[: len(gone), 1]
    assert not position[len(gone) :, 1].any()
    assert not heading[len(gone) :].any()
    assert (np.diff(aside) >= -1e-9).all()
    assert aside[gone <= 29 - EASE] == pytest.approx(0.0, abs=1e-9)
    assert aside[gone >= 31 + EASE] == pytest.approx(1.0, abs=1e-9)
    assert aside[gone == 30.0] == pytest.approx(0.5, abs=0.03)
    steer = np.arctan2(np.gradient(aside), 0.5)
    assert heading[: len(gone)] == pytest.approx(steer, abs=0.02)
    assert position[:, 0] == pytest.approx(two[:, 0])


def test_who_stands_or_wants_nothing_stays():
    xy = np.zeros((4, 2))
    position, heading = kept_aside(xy, np.ones(4), np.zeros(4, np.int64), np.full(4, np.nan))
    assert (position == 0).all()
    assert (heading == 1).all()
    position, _ = kept_aside(xy, np.zeros(4), np.zeros(4, np.int64), np.full(4, -0.7))
    assert position[:, 1] == pytest.approx([-0.7] * 4)
