"""Vehicles that would touch make way for each other, each on its own way."""

from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest

from cityx.traffic.making_way import ASIDE, Bodies, beside, interpolated, made_way

LONG, WIDE = 4.5, 1.8


def driving(*ways, steps=200, size=(LONG, WIDE)):
    """Bodies of vehicles that start at a place and go some metres with every step."""
    parts = []
    for mover, (start, step) in enumerate(ways):
        at = np.array(start) + np.arange(steps)[:, None] * np.array(step)
        heading = np.full(steps, np.arctan2(step[1], step[0]))
        parts.append((np.full(steps, mover), np.arange(steps), at, heading))
    mover, step, xy, heading = (np.concatenate(part) for part in zip(*parts, strict=True))
    half = np.tile(np.array(size) / 2, (len(mover), 1))
    return Bodies(mover, step, np.column_stack([xy, np.zeros(len(xy))]), heading, half)


def moved(bodies, at):
    return Bodies(bodies.mover, bodies.step, interpolated(bodies.position, at),
                  interpolated(bodies.heading, at), bodies.half)  # fmt: skip


def together(bodies, others):
    """Bodies, and others that are movers after them."""
    later = replace(others, mover=others.mover + bodies.mover.max() + 1)
    return Bodies(*(np.concatenate([getattr(each, name) for each in (bodies, later)])
                    for name in Bodies.__dataclass_fields__))  # fmt: skip


def least_gap(bodies, first=0, second=1):
    """Least distance between the bodies of two movers, 0 where they touch."""
    import shapely

    u = np.column_stack([np.cos(bodies.heading), np.sin(bodies.heading)]) * bodies.half[:, :1]
    v = np.column_stack([-np.sin(bodies.heading), np.cos(bodies.heading)]) * bodies.half[:, 1:]
    xy = bodies.position[:, :2]
    boxes = shapely.polygons(np.stack([xy - u - v, xy + u - v, xy + u + v, xy - u + v], axis=1))
    one, other = boxes[bodies.mover == first], boxes[bodies.mover == second]
    return float(shapely.distance(one, other).min())


CROSSING = driving(((-50.0, 0.0), (1.0, 0.0)), ((0.0, -54.0), (0.0, 1.0)))


def test_two_who_would_touch_on_a_crossing_part_on_their_own_ways():
    at, aside = made_way(CROSSING, 0)
    assert not aside.any()
    after = moved(CROSSING, at)
    assert least_gap(CROSSING) == 0.0
    assert least_gap(after) > 0.0
    assert np.ptp(after.position[after.mover == 0, 1]) == 0.0  # nobody leaves its way
    assert np.ptp(after.position[after.mover == 1, 0]) == 0.0


def test_who_makes_way_never_goes_back_and_is_where_it_was_before_and_after():
    at, aside = made_way(CROSSING, 0)
    assert not aside.any()
    for mover in (0, 1):
        rows = np.flatnonzero(CROSSING.mover == mover)
        assert (np.diff(at[rows]) > 0.0).all()
        assert at[rows[0]] == rows[0]
        assert at[rows[-1]] == rows[-1]


def test_who_touches_nobody_is_left_alone():
    bodies = driving(((-50.0, 0.0), (1.0, 0.0)), ((-50.0, 5.0), (1.0, 0.0)))
    at, aside = made_way(bodies, 0)
    assert np.array_equal(at, np.arange(len(bodies.mover)))
    assert not aside.any()


def test_bodies_over_a_bridge_do_not_meet_those_under_it():
    high = CROSSING.position + np.where(CROSSING.mover == 1, 6.0, 0.0)[:, None] * [0.0, 0.0, 1.0]
    bodies = Bodies(CROSSING.mover, CROSSING.step, high, CROSSING.heading, CROSSING.half)
    at, aside = made_way(bodies, 0)
    assert np.array_equal(at, np.arange(len(bodies.mover)))
    assert not aside.any()


def test_those_who_were_there_before_stay_as_they_were():
    own = CROSSING.mover == 0
    parts = [
        Bodies(CROSSING.mover[k] * 0, CROSSING.step[k], CROSSING.position[k], CROSSING.heading[k],
               CROSSING.half[k])
        for k in (own, ~own)
    ]  # fmt: skip
    at, _ = made_way(parts[0], 0, parts[1])
    assert len(at) == own.sum()
    after = moved(parts[0], at)
    assert least_gap(together(after, parts[1])) > 0.0


@pytest.mark.parametrize("behind", [1, 2, 3])
def test_who_cannot_make_way_since_others_follow_closely_does_so_with_them(behind):
    each = LONG + 0.1  # metres, bumper to bumper behind one that passes just before the other
    file = [((-155.0 - each * place, 0.0), (1.0, 0.0)) for place in range(-1, behind + 1)]
    crossing = driving(((0.0, -157.0), (0.0, 1.0)), steps=300)
    bodies = driving(*file, steps=300)
    assert least_gap(together(bodies, crossing), 0, len(file)) > 0.0
    assert least_gap(together(bodies, crossing), 1, len(file)) == 0.0
    at, aside = made_way(bodies, 0, crossing)
    assert not aside.any()
    after = moved(bodies, at)
    pairs = combinations(range(len(file) + 1), 2)
    assert all(least_gap(together(after, crossing), *pair) > 0.0 for pair in pairs)
    last = bodies.mover == len(file) - 1
    assert (at != np.arange(len(at)))[last].any()


def test_who_passes_somebody_half_way_in_its_lane_keeps_aside_there_alone():
    standing = 1.75  # metres beside the middle of the lane, by 0.05 less than the two need
    bodies = driving(((-100.0, 0.0), (1.0, 0.0)), ((0.0, standing), (1e-9, 0.0)))
    at, aside = made_way(bodies, 0)
    assert np.array_equal(at, np.arange(len(bodies.mover)))
    own = bodies.mover == 0
    assert not aside[~own].any()
    assert aside.min() in ASIDE
    assert not aside[own & (np.abs(bodies.position[:, 0]) > 20.0)].any()
    position = beside(bodies.position, bodies.heading, aside)
    assert least_gap(bodies) == 0.0
    assert least_gap(Bodies(bodies.mover, bodies.step, position, bodies.heading, bodies.half)) > 0.0
