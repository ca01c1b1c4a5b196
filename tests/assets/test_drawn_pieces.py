"""Pieces that rows of data draw, and the looks that each may have."""

import numpy as np
import pytest

from cityx.assets.furniture.animal_pieces import ANIMAL_MAKERS, SWIMMERS
from cityx.assets.furniture.drawn_pieces import DRAWN_MAKERS, looks_of
from cityx.assets.furniture.street_furniture import VARIANTS, furniture

NAMES = [*DRAWN_MAKERS, *ANIMAL_MAKERS]


@pytest.mark.parametrize("name", NAMES)
def test_a_drawn_piece_stands_on_the_ground(name):
    low = furniture(name).mesh.vertices[:, 2].min()
    assert -0.35 <= low <= 0.1


@pytest.mark.parametrize("name", sorted(VARIANTS))
def test_looks_of_a_piece_are_of_one_size_and_differ(name):
    looks = [furniture(one).mesh for one in VARIANTS[name]]
    assert len({mesh.vertices.tobytes() + mesh.tint.tobytes() for mesh in looks}) == len(looks)
    spans = np.array([np.ptp(mesh.vertices, axis=0).max() for mesh in looks])
    assert spans.max() < 1.7 * spans.min()


def test_looks_are_told_by_the_beginning_of_their_names():
    assert looks_of(["cow", "cow_lying", "crow"]) == {"cow": ("cow", "cow_lying")}


def test_birds_that_swim_lie_in_the_water():
    assert {"duck", "swan"} <= SWIMMERS
    assert all(furniture(name).mesh.vertices[:, 2].min() < 0 for name in SWIMMERS)
