"""Who waits at the line while somebody comes towards it."""

import numpy as np
import pytest
from made_sumo import Car, Sumo

from cityx.traffic.conflicts import Conflicts, facing
from cityx.traffic.facing import FREE, Facing
from cityx.traffic.streets import Link, Streets

LINE = np.array([[0.0, 0.0, 0.0], [20.0, 0.0, 0.0]])
BESIDE = np.array([0.0, 3.0, 0.0])


def narrow(at, speed):
    """One who comes to a junction, and one who is on it and comes the other way."""
    there = Car(":j_1_0", ("back", "home"), at=3.0, waited=0.0, speed=5.0)
    comes = Car("to_0", ("to", "on"), at=at, waited=0.0, speed=speed)
    sumo = Sumo({"to_0": ("on_0",), "back_0": ("home_0",)}, {"there": there, "comes": comes})
    return sumo, Facing(sumo, {":j_1_0": (":j_0_0",)})


@pytest.mark.parametrize(
    ("at", "speed", "braked"),
    [(40.0, 10.0, False), (92.0, 6.0, True), (99.8, 0.0, True), (98.0, 10.0, False)],
)
def test_nobody_who_can_brake_drives_on_towards_somebody(at, speed, braked):
    sumo, held = narrow(at, speed)
    held.step()
    wanted = sumo.cars["comes"].wanted
    assert (wanted is not None) == braked
    assert not braked or wanted <= speed


def test_who_was_held_drives_on_once_the_rear_of_the_other_is_off_the_junction():
    sumo, held = narrow(99.8, 0.0)
    there, comes = sumo.cars["there"], sumo.cars["comes"]
    held.step()
    there.lane, there.at = "home_0", 2.0
    held.step()
    assert comes.wanted < 0.1
    there.at = there.length + 1.0
    held.step()
    assert comes.wanted == FREE


def test_of_two_who_come_at_once_the_one_who_cannot_stop_any_more_goes():
    sumo, held = narrow(94.0, 6.0)
    there = sumo.cars["there"]
    there.lane, there.at, there.speed = "back_0", 99.0, 6.0
    sumo.links["back_0"] = ("other_0", "home_0")  # by :j_1_0
    held.step()
    assert sumo.cars["comes"].wanted < 6.0
    assert there.wanted is None


@pytest.mark.parametrize(
    ("shape", "told"),
    [
        (LINE[::-1], True),
        (LINE[::-1] + BESIDE, False),  # they pass each other
        (LINE, False),  # the same way
        (np.array([[10.0, 10.0, 0.0], [10.0, -10.0, 0.0]]), False),  # they cross
    ],
)
def test_ways_through_one_lane_against_each_other_are_told(shape, told):
    links = tuple(Link((way, 0), (way, 1), line) for way, line in enumerate((LINE, shape)))
    streets = Streets((), links, (), np.zeros((0, 3)), np.zeros(0, bool), False)
    none = np.zeros(2)
    pairs = facing(streets, Conflicts(np.array([0]), np.array([1]), none, none.astype(int)))
    assert pairs.tolist() == ([[0, 1]] if told else [])
