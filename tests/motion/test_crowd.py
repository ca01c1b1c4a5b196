"""Crowds: nobody walks into anybody, whatever they want."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.distance import pdist

from cityx.motion.crowd import APART, CREEP, NO_BOXES, NO_ZONES, SQUEEZED, Crowd, Floor, stepped

STEP = 0.1
NOBODY = np.zeros((0, 2))


CELL = 0.2


def floor(west=-60.0, south=-60.0, east=60.0, north=60.0, zone=None):
    """Cells that are free within a rectangle; `zone` is one of them that needs leave."""
    size = round((north - south) / CELL) + 2, round((east - west) / CELL) + 2
    free, number = np.zeros(size, bool), np.zeros(size, np.int16)
    free[1:-1, 1:-1] = True
    if zone is not None:
        first, last = (round((x - west) / CELL) + 1 for x in zone)
        number[:, first:last] = 1
    return Floor(free, number, number, west - CELL, north + CELL, CELL)


ANYWHERE = floor()


def crowd(position, target, pace=1.4, apart=APART, leave=0, awaits=1):
    count = len(position)
    paces = np.broadcast_to(np.asarray(pace, float), count)
    return Crowd(
        np.asarray(position, float), np.asarray(target, float), paces.copy(),
        np.full(count, CREEP * 1.4), np.ones(count), np.full(count, apart),
        np.full(count, leave), np.full(count, awaits),
    )  # fmt: skip


def run(position, target, steps, floor=ANYWHERE, boxes=NO_BOXES, shut=NO_ZONES, **how):
    position = np.asarray(position, float)
    track = [position]
    for _ in range(steps):
        made = crowd(track[-1], target, **how)
        track.append(stepped(made, NOBODY, STEP, floor, boxes, shut))
    return np.stack(track)


def test_one_alone_walks_straight_at_the_pace():
    track = run([(0.0, 0.0)], [(100.0, 0.0)], 50)
    assert track[-1, 0] == pytest.approx([1.4 * 5.0, 0.0])


def test_two_who_meet_pass_each_other():
    track = run([(0.0, 0.0), (8.0, 0.02)], [(50.0, 0.0), (-50.0, 0.0)], 100)
    assert track[-1, 0, 0] > 10.0
    assert track[-1, 1, 0] < -2.0
    assert min(pdist(at)[0] for at in track) >= APART - 1e-9


def test_who_follows_keeps_a_gap_to_somebody_who_stands():
    at = np.array([(0.0, 0.0)])
    for _ in range(100):
        at = stepped(crowd(at, [(5.0, 0.0)]), np.array([[5.0, 0.0]]), STEP, ANYWHERE)
    assert np.hypot(*(at[0] - [5.0, 0.0])) >= APART - 1e-9


def test_nobody_steps_where_nobody_may_be():
    track = run([(0.0, 0.0)], [(10.0, 0.0)], 60, floor=floor(east=3.0))
    assert 2.5 < track[:, 0, 0].max() < 3.0


def test_a_zone_is_entered_with_leave_alone_and_left_without():
    ruled = floor(zone=(3.0, 6.0))
    kept_off = run([(0.0, 0.0)], [(10.0, 0.0)], 60, floor=ruled)
    assert 2.5 < kept_off[:, 0, 0].max() < 3.0
    let = run([(0.0, 0.0)], [(10.0, 0.0)], 60, floor=ruled, leave=1)
    assert let[:, 0, 0].max() > 6.0
    caught = run([(4.5, 0.0)], [(10.0, 0.0)], 60, floor=ruled)
    assert caught[:, 0, 0].max() > 6.0


def test_the_rim_of_a_zone_is_passed_over_unless_the_zone_is_shut():
    ground = floor(zone=(3.0, 6.0))
    wide = floor(zone=(2.6, 6.0)).rim
    ground = replace(ground, rim=wide)  # cells before the zone that it reaches into
    shut = np.array([False, True])
    # Two abreast go by along the zone; between them and a third there is no room but the rim.
    start = [(2.4, 0.0), (2.4, 0.9), (2.2, 0.45)]
    target = [(2.75, 20.0)] * 3
    passing = {"floor": ground, "awaits": 0}
    pushed = run(start, target, 80, **passing)
    kept_off = run(start, target, 80, shut=shut, **passing)
    assert pushed[:, :, 0].max() > 2.6
    assert kept_off[:, :, 0].max() <= 2.6
    assert kept_off[-1, :, 1].min() > 5.0  # they get on all the same
    along = run([(2.9, 0.0)], [(2.95, 20.0)], 40, shut=shut, **passing)
    assert along[:, 0, 0].max() < 2.9 + 1e-9  # nobody comes nearer to the zone
    on_it = run([(2.9, 0.0)], [(0.0, 0.0)], 20, shut=shut, **passing)
    assert on_it[-1, 0, 0] < 1.0


def test_those_who_wait_let_others_off_a_roadway():
    # A row of people at the kerb of a narrow walk, shoulder to shoulder, and one who comes off.
    waiting = [(0.0, y) for y in (-0.8, -0.25, 0.3, 0.85)]
    start = [*waiting, (-3.0, 0.02)]
    target = [(-10.0, y) for _, y in waiting] + [(10.0, 0.0)]
    kerb = floor(west=-4.0, south=-1.4, north=1.4, zone=(-4.0, -0.4))
    pace = [0.0] * 4 + [1.4]
    track = run(start, target, 120, floor=kerb, pace=pace)
    assert track[-1, 4, 0] > 2.0
    assert (track[:, :4, 0] > -0.4).all()  # nobody is pushed onto the roadway
    assert min(pdist(at).min() for at in track) >= APART - 1e-9


def test_nobody_steps_in_front_of_a_vehicle_and_who_is_in_its_way_leaves_it():
    car = np.array([[5.0, 0.0, 0.0, 1.0, 2.5, 1.2]])  # heads north
    stops = run([(0.0, 0.0)], [(10.0, 0.0)], 60, boxes=car)
    assert 3.0 < stops[-1, 0, 0] <= 3.8
    leaves = run([(4.6, 1.0)], [(10.0, 1.0)], 8, boxes=car)
    assert leaves[-1, 0, 0] < 3.8
    stays = run([(5.0, 6.0)], [(5.0, 6.0)], 8, boxes=car, pace=0.0)
    assert stays[-1, 0] == pytest.approx([5.0, 6.0])


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 10_000), st.integers(2, 60))
def test_people_never_come_nearer_than_they_keep_apart(seed, count):
    rng = np.random.default_rng(seed)
    grid = np.stack(np.meshgrid(np.arange(8), np.arange(8)), axis=-1).reshape(-1, 2) * 0.6
    start = grid[rng.permutation(64)[:count]]
    target = rng.uniform(-5, 10, (count, 2))
    track = run(start, target, 30)
    assert min(pdist(at).min() for at in track) >= APART - 1e-9
    squeezed = run(start, target, 30, apart=SQUEEZED)
    assert min(pdist(at).min() for at in squeezed) >= SQUEEZED - 1e-9


def test_order_of_people_changes_nothing():
    rng = np.random.default_rng(5)
    start, target = rng.uniform(0, 12, (20, 2)), rng.uniform(0, 12, (20, 2))
    turn = rng.permutation(20)
    plain, turned = run(start, target, 20)[-1], run(start[turn], target[turn], 20)[-1]
    assert turned == pytest.approx(plain[turn], abs=1e-9)
