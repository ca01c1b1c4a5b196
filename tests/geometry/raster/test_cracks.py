import numpy as np
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from scipy import ndimage

from cityx.geometry.raster.cracks import OUTSIDE, arcs, find_cracks, rings

MASKS = arrays(bool, st.tuples(st.integers(1, 9), st.integers(1, 9)))
LABELS = arrays(
    np.int64, st.tuples(st.integers(1, 8), st.integers(1, 8)), elements=st.integers(0, 3)
)


def ring_points(cracks, chains):
    start = cracks.points(cracks.start)[chains.crack]
    return [start[a:b] for a, b in zip(chains.begin[:-1], chains.begin[1:], strict=True)]


def test_one_pixel_has_four_cracks_and_lies_on_their_left():
    labels = np.zeros((3, 3), int)
    labels[1, 1] = 1
    cracks, chains = rings(labels)
    (ring,) = ring_points(cracks, chains)
    ring = ring * [1, -1]  # y up, as on the ground
    assert shapely.LinearRing(ring).is_ccw
    assert shapely.Polygon(ring).equals(shapely.box(1, -2, 2, -1))


def test_diagonal_pixels_have_rings_of_their_own():
    _, chains = rings(np.array([[1, 0], [0, 2]]))
    assert np.diff(chains.begin).tolist() == [4, 4]


def test_a_ring_that_touches_itself_does_not_cross():
    # The middle and the outside meet at a corner, so they are one outside.
    mask = np.array([[1, 1, 1], [1, 0, 1], [1, 1, 0]])
    _, chains = rings(mask)
    assert chains.closed.all()
    assert np.diff(chains.begin).tolist() == [16]


@given(MASKS)
@settings(max_examples=200, deadline=None)
def test_rings_enclose_exactly_the_pixels(mask):
    labels = ndimage.label(mask)[0]
    if not labels.any():
        return
    cracks, chains = rings(labels)
    assert chains.closed.all()
    area = 0.0
    for ring in ring_points(cracks, chains):
        x, y = ring.T
        area -= (x * np.roll(y, -1) - np.roll(x, -1) * y).sum() / 2  # y runs down
    assert area == mask.sum()


@given(LABELS)
@settings(max_examples=200, deadline=None)
def test_every_crack_is_in_one_arc_between_two_labels(labels):
    cracks = find_cracks(labels)
    chains = arcs(cracks)
    assert sorted(chains.crack.tolist()) == list(range(len(cracks.start)))
    for a, b in zip(chains.begin[:-1], chains.begin[1:], strict=True):
        run = chains.crack[a:b]
        assert (cracks.end[run[:-1]] == cracks.start[run[1:]]).all()
        assert len(np.unique(cracks.left[run])) == len(np.unique(cracks.right[run])) == 1
    sides = np.count_nonzero(np.diff(np.pad(labels, 1, constant_values=OUTSIDE), axis=0)) + (
        np.count_nonzero(np.diff(np.pad(labels, 1, constant_values=OUTSIDE), axis=1))
    )
    assert len(cracks.start) == sides
