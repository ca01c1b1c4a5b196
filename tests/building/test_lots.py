import math

import numpy as np
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from cityx.building.massing.lots import lot_of, slope_of
from cityx.building.massing.massing import Plot

SIZES = st.floats(4, 40)
ANGLES = st.floats(0, 2 * math.pi)


def plot_of(length, width, angle, front=(0.3, -1.0), **more):
    plan = shapely.affinity.rotate(shapely.box(0, 0, length, width), angle, use_radians=True)
    return Plot(plan, 6.0, 2, 977, front=front, **more)


@settings(max_examples=30, deadline=None, derandomize=True)
@given(length=SIZES, width=SIZES, angle=ANGLES, street=ANGLES)
def test_y_of_a_lot_looks_at_the_street_and_its_frame_is_right_handed(length, width, angle, street):
    lot = lot_of(plot_of(length, width, angle, (math.cos(street), math.sin(street))))
    assert lot.front @ [math.cos(street), math.sin(street)] >= math.cos(math.pi / 4) - 1e-6
    assert np.isclose(lot.right[0] * lot.front[1] - lot.right[1] * lot.front[0], 1.0)
    assert np.isclose(lot.length * lot.depth, length * width)


@settings(max_examples=30, deadline=None, derandomize=True)
@given(length=SIZES, width=SIZES, angle=ANGLES)
def test_the_corners_of_a_lot_are_those_of_its_plan(length, width, angle):
    lot = lot_of(plot_of(length, width, angle))
    (whole,) = lot.outlines([(-lot.x, -lot.y, lot.x, lot.y)])
    assert whole.symmetric_difference(lot.plan).area < 1e-6 * lot.plan.area


def test_rectangles_end_at_the_outline_of_a_plan_that_is_no_box():
    ell = shapely.union_all([shapely.box(0, 0, 20, 8), shapely.box(0, 0, 8, 16)])
    lot = lot_of(Plot(ell, 6.0, 2, 977))
    (whole,) = lot.outlines([(-lot.x, -lot.y, lot.x, lot.y)])
    assert not lot.boxy
    assert whole.symmetric_difference(ell).area < 1e-6


def test_a_lot_may_follow_its_longer_side_wherever_the_street_lies():
    plot = plot_of(20, 8, 0.0, front=(1.0, 0.0))
    assert lot_of(plot).length < lot_of(plot).depth
    assert lot_of(plot, lengthwise=True).length > 19.9


def test_the_compass_of_a_lot_is_that_of_the_scene():
    lot = lot_of(plot_of(20, 8, 0.0, front=(0.0, -1.0)))
    assert np.isclose(abs(lot.along()), math.pi)  # down to the south, where the street is
    assert np.isclose(lot.compass(-1.0, 0.0), math.pi / 2)


def test_the_slope_of_a_lot_follows_from_its_roof():
    plot = plot_of(20, 8, 0.4, rise=3.0)
    assert np.isclose(slope_of(plot, lot_of(plot)), 3.0 / 4.0)
