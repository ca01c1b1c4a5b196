"""A closed mesh is cut into slabs: upright walls, and slopes on them as roofs."""

import numpy as np
import pytest
import shapely

from cityx.geometry.mesh_sections import slabs_of
from cityx.protocol.solid_blocks import block, one_object

SQUARE = [(0.0, 0.0), (10.0, 0.0), (10.0, 10.0), (0.0, 10.0)]


def told(mesh):
    slabs = slabs_of(mesh.vertices, mesh.faces)
    return [(slab.low, slab.high, slab.rise, round(slab.plan.area, 2)) for slab in slabs]


def roofed(height, peak):
    """A block with a pyramid on it, one solid."""
    points = [*((x, y, 0.0) for x, y in SQUARE), *((x, y, height) for x, y in SQUARE), (5, 5, peak)]
    sides = [(i, (i + 1) % 4, 4 + (i + 1) % 4, 4 + i) for i in range(4)]
    slopes = [(4 + i, 4 + (i + 1) % 4, 8, -1) for i in range(4)]
    return np.array(points, float), np.array([(3, 2, 1, 0), *sides, *slopes], np.int32)


@pytest.mark.parametrize(("height", "rise"), [(2.0, 1.0), (17.3, 20.0), (50.0, 3.7)])
def test_a_pyramid_on_walls_is_their_roof(height, rise):
    (slab,) = slabs_of(*roofed(height, height + rise))
    assert (slab.low, slab.high) == pytest.approx((0.0, height + rise))
    assert slab.rise == pytest.approx(rise)
    assert slab.plan.area == pytest.approx(100.0)


def test_stacked_blocks_are_slabs_of_their_own_and_courts_stay_open():
    court = [(3.0, 3.0), (7.0, 3.0), (7.0, 7.0), (3.0, 7.0)]
    low = block(SQUARE, 3.0, holes=[court])
    high = block([*SQUARE[:2], (10.0, 2.0), (0.0, 2.0)], 4.0, base=3.0)
    assert told(one_object([low, high])) == [(0.0, 3.0, 0.0, 84.0), (3.0, 7.0, 0.0, 20.0)]


def test_legs_are_slabs_each():
    legs = [
        block(shapely.box(x, y, x + 1, y + 1).exterior.coords[:-1], 4.0)
        for x in (0, 9)
        for y in (0, 9)
    ]
    body = block(SQUARE, 9.0, base=4.0)
    assert told(one_object([*legs, body])) == [(0.0, 4.0, 0.0, 1.0)] * 4 + [(4.0, 13.0, 0.0, 100.0)]


def test_what_is_thin_belongs_to_what_bears_it():
    slab = block(SQUARE, 0.2, base=6.0)
    assert told(one_object([block(SQUARE, 6.0), slab])) == [(0.0, 6.2, 0.0, 100.0)]
