import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from cityx.ground.grades import evened, fall_to, graded, rise_to, slopes_of


def chain(rises):
    pairs = np.column_stack([np.arange(len(rises)), np.arange(1, len(rises) + 1)])
    return slopes_of(pairs, rises)


def steepest(slopes, z):
    return (np.abs(z[slopes.pairs[:, 0]] - z[slopes.pairs[:, 1]]) - slopes.rise).max()


def test_one_wanted_height_makes_a_tent():
    wanted = np.array([-np.inf, -np.inf, 5.0, -np.inf, -np.inf])
    assert np.allclose(rise_to(chain([1.0] * 4), wanted), [3, 4, 5, 4, 3])
    assert np.allclose(fall_to(chain([1.0] * 4), -np.where(wanted > 0, wanted, -np.inf)),
                       [-3, -4, -5, -4, -3])  # fmt: skip


def test_nothing_wanted_is_minus_infinity():
    assert np.isneginf(rise_to(chain([1.0]), [-np.inf, -np.inf])).all()


def test_the_least_of_two_rises_counts():
    slopes = slopes_of([[0, 1], [1, 0], [1, 1]], [3.0, 1.0, 0.5])
    assert slopes.pairs.tolist() == [[0, 1]]
    assert slopes.rise.tolist() == [1.0]


@given(
    st.lists(st.floats(-20, 20), min_size=2, max_size=30),
    st.lists(st.floats(0.01, 3), min_size=29, max_size=29),
)
def test_graded_heights_keep_every_grade_and_even_heights_stay(heights, rises):
    slopes = chain(rises[: len(heights) - 1])
    z = graded(slopes, heights)
    assert steepest(slopes, z) < 1e-6
    assert np.allclose(graded(slopes, z), z, atol=1e-6)
    over = rise_to(slopes, heights)
    assert (over >= np.array(heights) - 1e-9).all()
    assert steepest(slopes, over) < 1e-6


def test_one_steep_place_moves_nothing_out_of_its_reach():
    heights = np.zeros(41)
    heights[20] = 4.0
    z = graded(chain([0.25] * 40), heights)
    assert 1.9 < z[20] < 2.2
    assert np.abs(z[:11]).max() == 0.0
    assert np.abs(z[30:]).max() == 0.0


def test_evening_flattens_a_crest_and_leaves_what_is_held():
    z = np.array([0.0, 1.0, 2.0, 1.0, 0.0])
    free = np.array([False, True, True, True, False])
    found = evened(chain([1.0] * 4), z, free, 3)
    assert found[2] < 2.0
    assert found[0] == 0.0
    assert np.abs(np.diff(found)).max() <= 1.0
