import numpy as np
import pytest

from cityx.geometry.scatter import nearby_order, spread


@pytest.mark.parametrize("count", [16, 100, 1000])
def test_any_beginning_of_a_sequence_fills_the_interval(count):
    gaps = np.diff(np.sort(spread(3, "test", np.arange(count))[:, 0]), prepend=0.0, append=1.0)
    assert gaps.max() < 3.0 / count


def test_points_of_a_square_are_spread_better_than_by_chance():
    points = spread(1, "test", np.arange(256), 2)
    cell = (points * 8).astype(int) @ [8, 1]
    assert np.bincount(cell, minlength=64).min() >= 2  # 4 on average; by chance 1 or 0
    assert np.bincount(cell, minlength=64).max() <= 6


def test_a_point_depends_on_its_number_alone():
    whole = spread(2, "test", np.arange(50), 3)
    assert spread(2, "test", [7, 41], 3) == pytest.approx(whole[[7, 41]], abs=0)
    assert not np.allclose(spread(3, "test", [7, 41], 3), whole[[7, 41]])


def test_neighbours_stay_together():
    x, y = np.meshgrid(np.arange(16.0), np.arange(16.0))
    places = np.column_stack([x.ravel(), y.ravel()])
    order = nearby_order(places)
    assert sorted(order) == list(range(256))
    steps = np.linalg.norm(np.diff(places[order], axis=0), axis=1)
    rows = np.linalg.norm(np.diff(places, axis=0), axis=1)
    assert np.median(steps) == 1.0
    assert steps.max() <= rows.max()
    four = places[order].reshape(-1, 4, 2)
    assert np.ptp(four, axis=1).max() == 1.0  # every four lie in a square


def test_no_points_have_no_order():
    assert len(nearby_order(np.zeros((0, 2)))) == 0
