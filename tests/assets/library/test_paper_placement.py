import numpy as np
import pytest
import shapely
from shapely.affinity import rotate

from cityx.assets.library.paper_placement import (
    aspect_ratio,
    bounding_rectangle,
    place_as_paper,
    qualifies,
    rotation,
    scaling_factor,
)

LOT = shapely.box(0, 0, 20, 10)


def placed(lots, sizes, **more):
    length, width = np.array(sizes, float).T
    count = len(length)
    given = {"angle": np.zeros(count), "centre": np.zeros((count, 2))} | more
    return place_as_paper(lots, length=length, width=width, **given)


def test_step_1_the_rectangle_is_the_smallest_and_l_is_its_long_side():
    lots = np.array([LOT, rotate(shapely.box(0, 0, 10, 20), 30)], object)
    length, width = bounding_rectangle(lots)
    assert np.allclose(length, 20)
    assert np.allclose(width, 10)


def test_step_2_the_ratio_is_the_long_side_over_the_short_one():
    assert aspect_ratio([20.0, 10.0], [10.0, 20.0]).tolist() == [2.0, 2.0]


def test_step_3_takes_about_equal_footprints_of_a_ratio_within_epsilon():
    area = np.array([200.0, 239.0, 241.0, 200.0, 200.0])
    ratio = np.array([2.0, 2.15, 2.0, 2.16, 1.86])
    assert qualifies(200.0, 2.0, area, ratio).tolist() == [True, True, False, False, True]


def test_step_4_alpha_is_the_ratio_of_the_short_sides():
    assert scaling_factor(20.0, 10.0, 25.0, 8.0) == 10 / 8
    assert scaling_factor(10.0, 20.0, 8.0, 25.0) == 10 / 8


def test_step_4_the_smallest_alpha_wins_which_is_the_largest_asset():
    found = placed(np.array([LOT], object), [(20, 10), (21, 10.5), (19, 9.5)])
    assert found.asset.tolist() == [1]
    assert found.alpha[0] == pytest.approx(10 / 10.5)


def test_step_5_theta_is_the_difference_of_the_angles_and_centres_meet():
    assert rotation(0.5, 0.2) == pytest.approx(0.3)
    lot = rotate(LOT, 25)
    centre = np.array([[158.5, 165.0]])
    found = placed(np.array([lot], object), [(20, 10)], angle=np.array([0.1]), centre=centre)
    assert found.theta[0] == pytest.approx(np.radians(25) - 0.1)
    cos, sin = np.cos(found.theta[0]), np.sin(found.theta[0])
    turned = np.array([[cos, -sin], [sin, cos]]) @ centre[0]
    middle = found.alpha[0] * turned + found.offset[0]
    assert np.abs(middle - shapely.get_coordinates(lot.centroid)).max() < 1e-6


def test_a_lot_that_no_asset_fits_stays_empty():
    found = placed(np.array([LOT], object), [(40, 10), (5, 2)])
    assert found.asset.tolist() == [-1]
    assert np.isnan(found.alpha[0])


def test_undefined_style_tags_are_chosen_among_by_their_score():
    found = placed(
        np.array([LOT], object), [(21, 10.5), (20, 10), (20, 10)], wanted="modern",
        style=np.array(["gothic", "", ""]), score=np.array([0.9, 0.1, 0.4]),
    )  # fmt: skip
    assert found.asset.tolist() == [2]
