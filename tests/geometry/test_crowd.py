"""Crowds: nobody walks into anybody, whatever they want."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.distance import pdist

from cityx.geometry.crowd import APART, SQUEEZED, Crowd, stepped

STEP = 0.1
NOBODY = np.zeros((0, 2))


def anywhere(rows, _to):
    return np.ones(len(rows), bool)


def crowd(position, target, pace=1.4, apart=APART):
    count = len(position)
    return Crowd(
        np.asarray(position, float), np.asarray(target, float), np.full(count, pace),
        np.ones(count), np.full(count, apart),
    )  # fmt: skip


def run(position, target, steps, may=anywhere, **how):
    position = np.asarray(position, float)
    track = [position]
    for _ in range(steps):
        track.append(stepped(crowd(track[-1], target, **how), NOBODY, STEP, may))
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
        at = stepped(crowd(at, [(5.0, 0.0)]), np.array([[5.0, 0.0]]), STEP, anywhere)
    assert np.hypot(*(at[0] - [5.0, 0.0])) >= APART - 1e-9


def test_nobody_steps_where_nobody_may_be():
    def left(_rows, to):
        return to[:, 0] < 3.0

    track = run([(0.0, 0.0)], [(10.0, 0.0)], 60, may=left)
    assert track[:, 0, 0].max() < 3.0


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
