"""Every check of what moves fires on what is planted for it, and on nothing else."""

from dataclasses import replace

import numpy as np
import pytest
from crossing_town import crossing_town

from cityx.checks.movement_checks import check_movement
from cityx.city.signals import STATE, Signals
from cityx.city.tracks import GAIT, MOVER, Tracks, join_tracks
from cityx.ids import id_text
from cityx.motion.feasible import ground_height

LENGTHS = {"car": (4.5, 1.8, 1.5), "pedestrian": (0.3, 0.46, 1.75)}


@pytest.fixture(scope="module")
def town():
    return crossing_town()


def mover(town, points, times, *, kind="car", number=1, place=None, lift=0.0, gait="ride"):
    """Somebody who goes straight from point to point."""
    points = np.array(points, float)
    ahead = np.diff(points, axis=0, append=points[-1:])
    ahead[-1] = ahead[-2]
    heading = np.arctan2(ahead[:, 1], ahead[:, 0])
    count = len(points)
    z = ground_height(town, points) + lift
    return Tracks(
        np.array([number], np.uint64), np.array([MOVER[kind]], np.uint8), np.array(["look"]),
        np.array(["test"]), np.ones((1, 3), np.float32), np.array([LENGTHS[kind]], np.float32),
        np.array([0, count]), np.array(times, float), np.column_stack([points, z]), heading,
        np.ones(count, np.float32), np.full(count, GAIT[gait], np.uint8),
        np.zeros(count, np.uint64) if place is None else np.array(place, np.uint64),
    )  # fmt: skip


def lane_of(town, edge, direction):
    graph = town.lanes
    (row, *_) = np.flatnonzero((graph.edge == edge) & (graph.direction == direction)
                               & graph.travelled)  # fmt: skip
    return graph.lane_id[row], graph.lane_points(row)


def failing(town, *tracks, **changed):
    city = replace(town, tracks=join_tracks(tracks), **changed)
    return {check.name: check.ids for check in check_movement(city) if not check.ok}


def driven(town, shift=0.0, **how):
    """A car on the lane of the first edge, shifted to the left of it."""
    own, points = lane_of(town, 0, 1)
    ahead = (points[-1] - points[0]) / np.hypot(*(points[-1] - points[0]))
    points = points + shift * np.array([-ahead[1], ahead[0]])
    return mover(town, points[[0, -1]], [0.0, 10.0], place=[own, own], **how)


def walker(town, points, times, **how):
    return mover(town, points, times, kind="pedestrian", gait="walk", **how)


def test_a_city_in_which_nothing_moves_has_no_such_checks(town):
    assert check_movement(town) == []


def test_a_car_on_its_lane_and_a_walker_on_the_plaza_pass(town):
    on_plaza = walker(town, [(10, 10), (30, 30)], [0.0, 20.0], number=2)
    assert failing(town, driven(town), on_plaza) == {}


def test_a_car_beside_its_lane_is_named(town):
    assert failing(town, driven(town, 1.0)) == {}  # half a lane is 1.5 m
    assert failing(town, driven(town, 2.2)) == {"vehicles_off_lane": (id_text(1),)}


def test_a_walker_in_the_roadway_is_named(town):
    along = walker(town, [(20, 0), (40, 0)], [0.0, 15.0], number=7)
    assert failing(town, along) == {"pedestrians_off_walkable": (id_text(7),)}


def test_two_who_walk_through_each_other_are_named(town):
    one = walker(town, [(10, 10), (30, 30)], [0.0, 20.0], number=2)
    other = walker(town, [(30, 30), (10, 10)], [0.0, 20.0], number=3)
    late = walker(town, [(10, 10), (30, 30)], [25.0, 45.0], number=4)
    assert failing(town, one, other, late) == {"movers_overlapping": (id_text(2), id_text(3))}


def test_a_car_in_a_walker_is_named(town):
    own, points = lane_of(town, 0, 1)
    stands = walker(town, [points[0] + 5.0 * (points[-1] - points[0]) / 40.0] * 2, [0.0, 9.0],
                    number=3)  # fmt: skip
    assert set(failing(town, driven(town), stands)) == {
        "movers_overlapping", "pedestrians_off_walkable",
    }  # fmt: skip
    assert own > 0


def test_who_walks_through_a_house_is_named(town):
    through = walker(town, [(-21, 6.0), (-21, 30.0)], [0.0, 20.0], number=2)
    found = failing(town, through)
    assert found["movers_in_buildings"] == (id_text(2),)


@pytest.mark.parametrize("lift", [0.2, -0.2])
def test_who_floats_or_wades_is_named(town, lift):
    floating = walker(town, [(10, 10), (30, 30)], [0.0, 20.0], lift=lift, number=2)
    assert failing(town, floating) == {"movers_off_ground": (id_text(2),)}
    assert failing(town, walker(town, [(10, 10), (30, 30)], [0.0, 20.0], lift=0.03)) == {}


def test_a_jump_is_named(town):
    jumps = walker(town, [(10, 10), (12, 10), (35, 10), (37, 10)], [0.0, 2.0, 2.1, 4.0], number=2)
    assert failing(town, jumps) == {"movers_teleported": (id_text(2),)}


def test_who_sways_on_the_spot_is_stuck_and_who_stands_is_not(town):
    times = np.arange(0.0, 90.0, 1.0)
    sway = np.column_stack([20 + 0.3 * np.sin(times), np.full(len(times), 20.0)])
    stuck = walker(town, sway, times, number=2)
    assert failing(town, stuck) == {"movers_stuck": (id_text(2),)}
    stands = mover(town, [(20, 20), (20, 20)], [0.0, 90.0], kind="pedestrian", gait="still")
    assert failing(town, stands) == {}


def test_a_car_that_runs_a_red_light_is_named(town):
    graph = town.lanes
    arriving, leaving = graph.connection[0]
    a, b = graph.lane_points(arriving), graph.lane_points(leaving)
    ids = graph.lane_id[[arriving, leaving]]
    curve = graph.curve[graph.curve_start[0] : graph.curve_start[1]]
    points = np.concatenate([a[[0, -1]], curve[1:-1], b[[0, -1]]])
    far = np.r_[0.0, np.cumsum(np.hypot(*np.diff(points, axis=0).T))]
    place = [ids[0], ids[0], *[0] * (len(curve) - 2), ids[1], ids[1]]
    car = mover(town, points, far / 8.0, place=place)
    signals = Signals(
        np.array([9], np.uint64), ids[:1], ids[1:], np.zeros(1, np.uint64), np.zeros((1, 3)),
        np.zeros(1), np.array([90.0]), np.array([0, 1]), np.zeros(1),
        np.array([STATE["red"]], np.uint8),
    )  # fmt: skip
    assert failing(town, car, signals=signals) == {"ran_red": (id_text(1),)}
    green = replace(signals, state=np.array([STATE["green"]], np.uint8))
    assert failing(town, car, signals=green) == {}
