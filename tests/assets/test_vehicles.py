import numpy as np
import pytest

from cityx.assets.materials import MATERIALS
from cityx.assets.vehicles import BODIES, BODY_SHARES, PAINT_SHARES, PAINTS, car


@pytest.mark.parametrize("name", BODIES)
def test_a_car_has_real_size_and_stands_on_its_wheels(name):
    mesh = car(name).mesh
    low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
    assert 3.9 < high[1] - low[1] < 5.3
    assert 1.6 < high[0] - low[0] < 2.25
    assert 1.35 < high[2] < 2.1
    assert low[2] == pytest.approx(0.0, abs=0.01)


@pytest.mark.parametrize("name", BODIES)
def test_a_car_has_paint_glass_rubber_and_a_bounded_mesh(name):
    mesh = car(name).mesh
    assert {"car_paint", "car_glass", "rubber"} <= set(mesh.materials) <= set(MATERIALS)
    assert 300 <= mesh.triangle_count <= 1500


@pytest.mark.parametrize("name", BODIES)
def test_a_car_is_the_same_left_and_right(name):
    x = car(name).mesh.vertices[:, 0]
    assert x.min() == pytest.approx(-x.max(), abs=1e-4)


def test_shares_are_of_a_whole_and_colours_physical():
    assert PAINT_SHARES.sum() == pytest.approx(1.0)
    assert BODY_SHARES.sum() == pytest.approx(1.0)
    assert PAINT_SHARES[:4].sum() > 0.7  # white, black, grey and silver
    assert np.all((PAINTS >= 0) & (PAINTS * 0.8 <= 1.0))
