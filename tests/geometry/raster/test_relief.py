import numpy as np
import pytest

from cityx.geometry.raster.grid import Grid
from cityx.geometry.raster.relief import (
    ground_below,
    split_at_steps,
    street_ground,
    tell_apart,
    unevenness,
)
from cityx.geometry.raster.roof_measures import heights_over_ring, measure_roofs

shapely = pytest.importorskip("shapely")
GRID = Grid(200, 200, 1.0, 0.0, 200.0)


def hill():
    """Ground that rises by 10 % to the east, 200 x 200 cells of a metre."""
    return np.tile(np.arange(200) / 10, (200, 1))


def town():
    """Four blocks of houses 12 m high with streets 16 m wide between them."""
    above = np.zeros((200, 200))
    for row in (20, 108):
        for column in (20, 108):
            above[row : row + 72, column : column + 72] = 12
            above[row + 15 : row + 57, column + 15 : column + 57] = 0  # the yard
    return above


def test_the_ground_is_found_below_houses_on_a_slope():
    ground = ground_below(hill() + town(), 1.0)
    assert np.abs(ground - hill()).max() < 1.0
    assert np.abs(ground - hill())[town() == 0].max() < 0.5


def test_the_ground_lies_nowhere_above_the_surface():
    noise = np.random.default_rng(0).normal(0, 0.3, (200, 200))
    surface = hill() + town() + noise
    assert (ground_below(surface, 1.0) <= surface).all()


def test_planes_are_even_whatever_their_slope_and_height():
    row, column = np.mgrid[0:20, 0:20]
    plane = 900 + 2.0 * row - 0.7 * column
    assert unevenness(plane)[1:-1, 1:-1].max() < 1e-3
    spike = plane.copy()
    spike[10, 10] += 3
    assert unevenness(spike)[9:12, 9:12].min() > 0.4


def test_even_tops_are_houses_and_ragged_ones_trees():
    above = town()
    crowns = np.random.default_rng(1).uniform(4, 12, (14, 14))
    above[60:74, 60:74] = crowns  # in a yard
    houses, trees = tell_apart(above, 1.0)
    assert not houses[60:74, 60:74].any()
    assert trees[60:74, 60:74].all()
    assert houses[town() > 0].all()
    assert not (houses & trees).any()


def test_roofs_end_at_steps_and_small_ones_join_the_next():
    above = np.zeros((40, 60))
    above[5:35, 5:30], above[5:35, 30:55] = 8, 15
    above[10:13, 10:13] = 14  # a lift shaft
    roofs = split_at_steps(above > 0, above, 1.0)
    assert len(np.unique(roofs[above > 0])) == 2
    assert len(np.unique(roofs[5:35, 5:30])) == 1
    assert (roofs[above == 0] == 0).all()


def test_streets_lie_between_blocks_and_not_in_yards():
    above = town()
    ground = street_ground(above > 0, above, 1.0)
    assert ground[100, 30:170].all()
    assert ground[30:170, 100].all()
    assert not ground[40:70, 40:70].any()
    assert not (ground & (above > 0)).any()
    assert not street_ground(np.zeros((9, 9), bool), np.zeros((9, 9)), 1.0).any()


def gable(x, y):
    """A roof over (50, 50) to (90, 70), eaves at 6 m, ridge at 11 m along x."""
    inside = (x > 50) & (x < 90) & (y > 50) & (y < 70)
    return np.where(inside, 6 + 5 * (1 - np.abs(y - 60) / 10), 0.0)


def test_roofs_are_measured():
    row, column = np.mgrid[0:200, 0:200]
    x, y = column + 0.5, 200 - row - 0.5
    above = gable(x, y)
    hip = np.minimum.reduce([x - 120, 160 - x, y - 120, 150 - y])
    above[hip > 0] = 5 + 0.5 * hip[hip > 0]
    above[(x > 20) & (x < 40) & (y > 120) & (y < 140)] = 9
    shapes = np.array([
        shapely.box(50, 50, 90, 70), shapely.box(120, 120, 160, 150), shapely.box(20, 120, 40, 140),
        shapely.box(300, 0, 310, 10),
    ])  # fmt: skip
    roofs = measure_roofs(shapes, above, GRID)
    assert roofs.shape.tolist() == ["gabled", "hipped", "flat", ""]
    assert roofs.height[:3] == pytest.approx([11, 12.5, 9], abs=0.6)
    assert roofs.rise[:3] == pytest.approx([5, 7.5, 0], abs=0.8)
    assert np.isnan(roofs.height[3])
    assert not roofs.across.any()


def test_noise_has_no_form():
    above = np.random.default_rng(2).uniform(5, 12, (200, 200))
    roofs = measure_roofs(np.array([shapely.box(50, 50, 90, 70)]), above, GRID)
    assert roofs.shape.tolist() == [""]


def test_the_foot_of_a_house_is_sought_round_it():
    above = town() + 0.7  # the ground was found too low
    block = shapely.box(20, 108, 92, 180).difference(shapely.box(35, 123, 77, 165))
    top, foot = heights_over_ring(np.array([block]), above, GRID)
    assert top[0] - foot[0] == pytest.approx(12)
