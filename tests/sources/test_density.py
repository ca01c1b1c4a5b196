"""How densely a place is built does not hang on where its site begins."""

import numpy as np
import pytest

from cityx.sources.features.density import measure_density

WIDE = 800.0


def measured(box, rng):
    centres = np.round(rng.uniform(-WIDE, WIDE, (1500, 2)), 2)
    areas, levels = rng.uniform(50, 600, 1500), rng.integers(1, 14, 1500).astype(float)
    inside = ((centres >= box[:2]) & (centres <= box[2:])).all(axis=1)
    return measure_density(box, centres[inside], areas[inside], levels[inside], np.zeros(0, object))


@pytest.mark.parametrize("corner", [(-700.0, -650.0), (-333.3, -271.9), (-312.0, -420.7)])
def test_a_place_is_as_dense_in_every_window(corner):
    whole = measured((-WIDE, -WIDE, WIDE, WIDE), np.random.default_rng(3))
    window = measured((*corner, 341.5, 288.2), np.random.default_rng(3))
    spots = np.random.default_rng(4).uniform(-100, 100, (500, 2))
    assert (window.place(spots) == whole.place(spots)).all()
    assert window.at(spots) == pytest.approx(whole.at(spots), abs=1e-9)


def test_the_border_of_a_site_counts_as_what_lies_within():
    box = (3.0, 7.0, 173.0, 177.0)
    x, y = (axis.ravel() for axis in np.meshgrid(np.arange(5.0, 173, 10), np.arange(9.0, 177, 10)))
    areas, levels = np.full(len(x), 30.0), np.full(len(x), 2.0)
    found = measure_density(box, np.column_stack([x, y]), areas, levels, np.zeros(0, object))
    assert found.coverage == pytest.approx(
        np.full(found.coverage.shape, 0.3), abs=0.025
    )  # houses stand on the lines between cells
