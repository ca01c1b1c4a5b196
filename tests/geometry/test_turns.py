import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from cityx.geometry.turns import euler_of, matrices

ANGLES = np.random.default_rng(5).uniform(-3, 3, (50, 3))


def test_matrices_turn_about_x_first():
    np.testing.assert_allclose(
        matrices(ANGLES), Rotation.from_euler("xyz", ANGLES).as_matrix(), atol=1e-12
    )


def test_angles_of_matrices_stand_for_the_same_turns():
    np.testing.assert_allclose(matrices(euler_of(matrices(ANGLES))), matrices(ANGLES), atol=1e-9)


@pytest.mark.parametrize("quarter", [np.pi / 2, -np.pi / 2])
def test_a_quarter_turn_in_the_middle_keeps_its_meaning(quarter):
    locked = matrices([(0.7, quarter, 0.2)])
    np.testing.assert_allclose(matrices(euler_of(locked)), locked, atol=1e-9)


def test_no_turns_are_no_angles():
    assert euler_of(np.zeros((0, 3, 3))).shape == (0, 3)
    assert matrices(np.zeros((0, 3))).shape == (0, 3, 3)
