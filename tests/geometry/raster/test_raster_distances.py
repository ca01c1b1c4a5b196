"""Distances in rasters are exact, as far as they are asked for and where."""

import numpy as np
import pytest
from scipy.ndimage import distance_transform_edt

from cityx.geometry.raster.distances import squares_to_closed
from cityx.ground.walking.walkable import CELL, clearance_of


@pytest.mark.parametrize(("share", "reach"), [(0.6, 60), (0.995, 16), (0.9995, 60)])
def test_distances_are_those_of_the_whole_transform(share, reach):
    free = np.random.default_rng(1).random((211, 173)) < share
    found = squares_to_closed(free, free, reach)
    whole = np.rint(distance_transform_edt(free) ** 2)
    assert np.array_equal(found, np.minimum(whole, reach**2))


def test_only_wanted_cells_are_measured():
    rng = np.random.default_rng(2)
    free, wanted = rng.random((90, 120)) < 0.97, rng.random((90, 120)) < 0.3
    every, some = squares_to_closed(free, free, 20), squares_to_closed(free, wanted, 20)
    assert np.array_equal(some, np.where(wanted, every, 0))


def test_where_all_is_free_there_is_as_much_room_as_is_told_apart():
    free = np.ones((30, 40), bool)
    assert (squares_to_closed(free, free, 7) == 49).all()
    assert (clearance_of(free) == 12.0).all()
    assert (clearance_of(free, free, 3.2) == np.float16(3.2)).all()


def test_clearance_is_the_distance_in_metres():
    free = np.random.default_rng(0).random((150, 130)) < 0.99
    whole = np.minimum(distance_transform_edt(free) * CELL, 12.0).astype(np.float16)
    assert np.array_equal(clearance_of(free), whole)
