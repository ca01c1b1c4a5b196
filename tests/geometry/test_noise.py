import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from cityx.geometry.noise import gradient_noise, gradient_noise_at


@settings(max_examples=30, deadline=None, derandomize=True)
@given(st.integers(0, 2**31), st.integers(1, 5))
def test_noise_stays_within_one_and_is_smooth(seed, octaves):
    x = np.linspace(-5, 5, 400)
    values = gradient_noise(seed, np.column_stack([x, 0.3 * x]), octaves=octaves)
    assert np.abs(values).max() <= 1.0
    assert np.abs(np.diff(values)).max() < 0.5
    assert (values == gradient_noise(seed, np.column_stack([x, 0.3 * x]), octaves=octaves)).all()


def test_noise_is_nothing_on_the_lattice_and_something_between():
    assert np.abs(gradient_noise(3, [[0, 0], [2, 5]])).max() < 1e-12
    assert np.abs(gradient_noise(3, np.random.default_rng(0).random((50, 2)))).max() > 0.1


def test_noise_at_one_place_is_that_of_the_table():
    for x, y in np.random.default_rng(1).uniform(-50, 50, (20, 2)).tolist():
        one = gradient_noise_at(7, x, y, octaves=3)
        assert np.isclose(one, gradient_noise(7, [[x, y]], octaves=3)[0], atol=1e-12)
