import math

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from cityx.building.massing.massing import Plot, carve, disc, remainder, site_of, widest

ANGLES = st.floats(0, math.pi)


def plot_of(length, width, angle=0.0, front=(0.0, -1.0)):
    plan = shapely.affinity.rotate(shapely.box(0, 0, length, width), angle, use_radians=True)
    return Plot(plan, 9.0, 3, 5, front=front)


@settings(max_examples=25, deadline=None, derandomize=True)
@given(length=st.floats(10, 80), width=st.floats(8, 60), angle=ANGLES, turn=ANGLES)
def test_a_site_looks_to_the_front_and_goes_back_to_its_place(length, width, angle, turn):
    front = (math.cos(turn), math.sin(turn))
    plot = plot_of(length, width, angle, front)
    site = site_of(plot)
    assert site.axes.across @ np.array(front) >= math.cos(math.pi / 4) - 1e-6
    back = site.axes.place(site.plan)
    assert back.symmetric_difference(plot.plan).area < 0.05 * (length + width)
    half, deep = site.half
    assert site.plan.bounds == pytest.approx((-half, -deep, half, deep), abs=0.03)


def test_a_turned_site_is_mirrored_and_keeps_its_plan():
    plot = plot_of(30.0, 12.0, 0.4)
    site = site_of(plot, facing=False)
    other = site.turned()
    assert np.allclose(other.axes.along, -site.axes.along)
    assert other.axes.place(other.plan).symmetric_difference(plot.plan).area < 1.0


@settings(max_examples=25, deadline=None, derandomize=True)
@given(x=st.floats(-5, 45), y=st.floats(-5, 30), size=st.floats(0.5, 40))
def test_carving_divides_a_plan_without_loss_or_slivers(x, y, size):
    plan = shapely.box(0, 0, 40, 25)
    inside, rest = carve(plan, shapely.box(x, y, x + size, y + size))
    assert inside.area + rest.area == pytest.approx(plan.area, abs=0.5)
    assert inside.intersection(rest).area < 0.01
    assert all(part.area >= 4.0 for part in shapely.get_parts(rest))


def test_a_disc_touches_its_circle_from_outside():
    ring = disc(3.0, 4.0, 5.0, 12)
    assert ring.exterior.distance(shapely.Point(3.0, 4.0)) == pytest.approx(5.0)
    assert len(ring.exterior.coords) == 13


def test_the_widest_circle_of_an_ell_lies_in_its_corner():
    ell = shapely.union_all([shapely.box(0, 0, 40, 10), shapely.box(0, 0, 10, 40)])
    x, y, radius = widest(ell)
    assert 5.0 <= radius < 6.2
    assert ell.buffer(0.3).covers(shapely.Point(x, y).buffer(radius))


def test_the_remainder_covers_what_volumes_left_open():
    plot = plot_of(30.0, 12.0)
    site = site_of(plot)
    half = site.masses(shapely.box(-15, -6, 0, 6), 0.0, 9.0)
    left = remainder(site, half, 3.0, "low")
    assert [mass.zone for mass in left] == ["low"]
    assert left[0].plan.area == pytest.approx(180.0, rel=0.01)
    assert remainder(site, [*half, *left], 3.0) == []
