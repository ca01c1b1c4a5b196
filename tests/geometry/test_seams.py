"""Seams: shapes are cut also where GEOS refuses to."""

from __future__ import annotations

import numpy as np
import pytest
import shapely

from cityx.geometry import seams
from cityx.geometry.seams import common, subtract

WHOLE = shapely.box(0, 0, 10, 10)
HALF = shapely.box(-5, -5, 5, 20)


def array(*shapes):
    return np.array(shapes, object)


def test_what_is_taken_and_what_is_left_make_up_the_whole():
    taken, left = (cut(array(WHOLE), array(HALF))[0] for cut in (common, subtract))
    assert taken.area == pytest.approx(50)
    assert left.area == pytest.approx(50)
    assert shapely.intersection(taken, left).area == 0


@pytest.mark.parametrize(("cut", "area"), [(common, 50), (subtract, 50)])
def test_a_shape_that_geos_refuses_does_not_stop_the_others(monkeypatch, cut, area):
    refused = shapely.box(100, 0, 110, 10)

    def stubborn(operation):
        def run(one, other, **options):
            if not options and refused in np.atleast_1d(one):
                raise shapely.errors.GEOSException("found non-noded intersection")
            return operation(one, other, **options)

        return run

    for name in ("intersection", "difference"):
        monkeypatch.setattr(seams.shapely, name, stubborn(getattr(shapely, name)))
    found = cut(array(WHOLE, refused), array(HALF, shapely.box(100, 0, 105, 10)))
    assert shapely.area(found) == pytest.approx([area, area])
