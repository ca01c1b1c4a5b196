import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from cityx.city import Terrain, flat_terrain

SLOPE = Terrain((0.0, 0.0), 5.0, np.add.outer(np.arange(5) * 2.0, np.arange(7) * 1.0))


def test_flat_terrain_is_zero_everywhere():
    assert flat_terrain().is_flat
    assert flat_terrain().height_at([[1e6, -1e6]]).tolist() == [0.0]


@settings(max_examples=50, deadline=None, derandomize=True)
@given(st.floats(0, 30), st.floats(0, 20))
def test_a_plane_is_reproduced_between_nodes(x, y):
    assert abs(SLOPE.height_at([[x, y]])[0] - (x / 5 + 2 * y / 5)) < 1e-9


def test_heights_beyond_the_border_are_those_of_the_border():
    assert SLOPE.height_at([[-100, 0], [1000, 20]]).tolist() == [0.0, 14.0]
