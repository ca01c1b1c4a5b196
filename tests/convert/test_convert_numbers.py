import math

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from cityx.convert.numbers import (
    boolean_to_number_conversion,
    cube_generation,
    face_generation,
    line_generation,
    number_to_boolean_conversion,
    number_to_noise_conversion,
    number_to_string_conversion,
    point_generation,
    string_to_number_conversion,
)
from cityx.errors import ActionFailed

quick = settings(max_examples=40, deadline=None, derandomize=True)


@quick
@given(edge=st.floats(0.1, 50), gap=st.floats(0, 20), heading=st.floats(0, 6.28))
def test_cubes_stand_in_a_row_with_the_gap_between(edge, gap, heading):
    boxes = cube_generation(edge, count=4, gap=gap, heading=heading)
    assert np.all(boxes.size == edge)
    steps = np.linalg.norm(np.diff(boxes.base, axis=0), axis=1)
    assert steps == pytest.approx(edge + gap)


@quick
@given(seed=st.integers(0, 10**6), count=st.integers(1, 200))
def test_points_lie_in_their_rectangle_and_grow_by_addition(seed, count):
    points = point_generation(seed, count=count, width=30, depth=10, x=100, y=-5)
    assert np.all(np.abs(points.position[:, :2] - [100, -5]) <= [15, 5])
    more = point_generation(seed, count=count + 7, width=30, depth=10, x=100, y=-5)
    assert np.array_equal(more.position[:count], points.position)


@quick
@given(length=st.floats(0.1, 900), heading=st.floats(0, 6.28), turn=st.floats(-3, 3))
def test_lines_have_the_length_asked(length, heading, turn):
    (line,) = line_generation(length, heading=heading, turn=turn, segments=20).geometry
    assert line.length == pytest.approx(length)
    assert shapely.get_num_points(line) == 21


def test_a_turn_to_the_right_bends_to_the_right():
    (line,) = line_generation(10.0, heading=0.0, turn=math.pi / 2).geometry
    x, y = line.coords[-1]
    assert x > 0
    assert y > 0


@quick
@given(length=st.floats(1, 90), width=st.floats(1, 90), heading=st.floats(0, 6.28))
def test_faces_have_the_sides_asked_and_run_counter_clockwise(length, width, heading):
    (face,) = face_generation(length, width=width, x=3, y=4, heading=heading).geometry
    assert face.area == pytest.approx(length * width)
    assert face.exterior.is_ccw
    assert (face.centroid.x, face.centroid.y) == pytest.approx((3, 4))


def test_numbers_texts_and_truths_convert():
    assert string_to_number_conversion(number_to_string_conversion(0.1)) == 0.1
    assert number_to_boolean_conversion(boolean_to_number_conversion(True))
    assert not number_to_boolean_conversion(boolean_to_number_conversion(False))
    for text in ("three", "nan", "1e999", ""):
        with pytest.raises(ActionFailed) as caught:
            string_to_number_conversion(text)
        assert str(caught.value) == f'"{text}" is no decimal number.'


def test_noise_is_smooth_bounded_and_keyed_by_its_seed():
    noise = number_to_noise_conversion(5, scale=50.0)
    xy = np.random.default_rng(0).uniform(-1e4, 1e4, (5000, 2))
    values = noise(xy)
    assert np.abs(values).max() <= 1
    assert values.std() > 0.1
    assert np.abs(noise(xy + 1e-4) - values).max() < 1e-3
    assert np.array_equal(values, number_to_noise_conversion(5, scale=50.0)(xy))
    assert not np.array_equal(values, number_to_noise_conversion(6, scale=50.0)(xy))
