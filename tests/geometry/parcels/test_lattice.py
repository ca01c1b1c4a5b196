import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from cityx.geometry.parcels.lattice import PER_METRE, Lattice, lattice_cell, lattice_cells

FAR = st.integers(-(10**8), 10**8)


@settings(max_examples=15, deadline=None, derandomize=True)
@given(seed=st.integers(0, 2**40), i=FAR, j=FAR)
def test_neighbours_agree_on_the_side_between_them(seed, i, j):
    lattice = Lattice(seed, 330.0, 0.35, 0.4, joined=80.0)
    cell = lattice_cell(lattice, (i, j))
    assert len(cell.beyond) > 2
    for m, beyond in enumerate(cell.beyond):
        other = lattice_cell(lattice, beyond)
        n = other.beyond.index(cell.key)
        own = [cell.corners[m], cell.corners[(m + 1) % len(cell.corners)]]
        theirs = [other.corners[(n + 1) % len(other.corners)], other.corners[n]]
        assert own == theirs
        places = cell.places[[m, (m + 1) % len(cell.corners)]]
        assert (places == other.places[[(n + 1) % len(other.corners), n]]).all()


def test_corners_are_joined_and_no_side_is_short():
    lattice = Lattice(5, 400.0, 0.35, joined=90.0)
    sides = []
    for i in range(4):
        for j in range(4):
            places = lattice_cell(lattice, (i, j)).places / PER_METRE
            sides += np.hypot(*(np.roll(places, -1, axis=0) - places).T).tolist()
    assert min(sides) > 60.0


@pytest.mark.parametrize("base", [0, 10**4, 10**8])
def test_a_cell_holds_its_point_and_no_other(base):
    lattice = Lattice(3, 500.0, 0.3)
    for i in range(3):
        key = (base + i, -base)
        cell = lattice_cell(lattice, key)
        assert tuple(lattice.nearest(cell.site[None])[0].tolist()) == key
        middle = cell.places.mean(axis=0).astype(np.int64)
        assert tuple(lattice.nearest(middle[None])[0].tolist()) == key


def test_every_point_within_reach_of_a_box_is_found():
    lattice = Lattice(1, 300.0, 0.35, angle=0.6)
    keys = np.array(lattice.keys_near((0.0, 0.0, 900.0, 600.0), 0.0))
    wide = np.array(lattice.keys_near((0.0, 0.0, 900.0, 600.0), 1500.0))
    sites = lattice.sites(wide) / PER_METRE
    inside = ((sites >= 0.0) & (sites <= [900.0, 600.0])).all(axis=1)
    assert inside.sum() >= 5
    assert {tuple(key) for key in wide[inside].tolist()} <= {tuple(key) for key in keys.tolist()}


@settings(max_examples=8, deadline=None, derandomize=True)
@given(seed=st.integers(0, 2**40), i=FAR, j=FAR, jitter=st.sampled_from([0.08, 0.26, 0.35]))
def test_cells_made_together_are_those_made_alone(seed, i, j, jitter):
    lattice = Lattice(seed, 330.0, jitter, 0.4, joined=80.0)
    keys = [(i + a, j + b) for a in (0, 1, 5) for b in (0, 2)]
    for key, cell in zip(keys, lattice_cells(lattice, keys), strict=True):
        alone = lattice_cell(lattice, key)
        assert (cell.key, cell.corners, cell.beyond) == (key, alone.corners, alone.beyond)
        assert (cell.site == alone.site).all()
        assert (cell.places == alone.places).all()
