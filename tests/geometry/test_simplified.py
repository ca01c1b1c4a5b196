"""Simplifying a ring changes nothing far away."""

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from cityx.geometry.simplified import simplified


def wavy(seed, holes=0):
    """A band of 400 m with many points, and holes."""
    rng = np.random.default_rng(seed)
    x = np.sort(np.round(rng.uniform(-200, 200, 900), 2))
    line = shapely.LineString(np.column_stack([x, 6 * np.sin(x / 9)]))
    spots = shapely.points(rng.uniform(-150, 150, holes), np.zeros(holes))
    return shapely.difference(
        shapely.buffer(line, 8.0), shapely.union_all(shapely.buffer(spots, 1.0))
    )


@settings(max_examples=20, deadline=None)
@given(seed=st.integers(0, 10**6), cut=st.floats(40, 150), tolerance=st.sampled_from([0.01, 0.1]))
def test_what_is_cut_off_far_away_leaves_the_rest_as_it_was(seed, cut, tolerance):
    whole = wavy(seed)
    part = shapely.intersection(whole, shapely.box(-190, -50, cut, 50))
    inner = shapely.box(-120, -50, cut - 40, 50)
    one, other = (
        shapely.intersection(shapely.union_all(simplified(each, tolerance)), inner)
        for each in (whole, part)
    )
    assert shapely.normalize(one).equals(shapely.normalize(other))


@settings(max_examples=20, deadline=None)
@given(seed=st.integers(0, 10**6), holes=st.integers(0, 9))
def test_the_outline_stays_within_the_tolerance(seed, holes):
    whole = wavy(seed, holes)
    (found,) = simplified(whole, 0.05)
    assert found.is_valid
    assert len(found.interiors) == len(whole.interiors)
    assert shapely.hausdorff_distance(found.boundary, whole.boundary, densify=0.2) < 0.051
    assert shapely.get_num_coordinates(found) < 0.8 * shapely.get_num_coordinates(whole)


def test_a_small_ring_stays_as_it_is():
    box = shapely.box(0, 0, 1, 1)
    assert simplified(box, 5.0)[0].equals(box)
    assert len(simplified(shapely.MultiPolygon(), 0.1)) == 0
    assert shapely.area(simplified([box, shapely.Point(9, 9).buffer(2)], 0.01)) == pytest.approx(
        [1.0, 12.5], abs=0.1
    )
