from dataclasses import replace

import pytest
import shapely

from cityx.building.massing.massing import Plot, grow
from cityx.building.massing.rules import chamfered, courtyard

DEEP = shapely.box(0, 0, 40, 36)


def plot(plan=DEEP, **more):
    return Plot(plan, 20.0, 5, 7, front=(0.0, -1.0), noise=0.0, **more)


@pytest.mark.parametrize("closed", [True, False])
def test_a_courtyard_leaves_wings_around_low_ground(closed):
    masses = grow(plot(), {"lot": courtyard(12.0, closed=closed)}, depth=1)
    low = [mass for mass in masses if mass.zone == "yard"]
    assert [mass.high for mass in low] == [4.0]
    assert low[0].plan.bounds == pytest.approx((12, 12, 28, 24 if closed else 36))
    assert sum(mass.plan.area for mass in masses) == pytest.approx(DEEP.area)


def test_wings_of_a_courtyard_keep_the_roof_of_the_whole():
    given = plot(roof="gabled", rise=3.0)
    wings = [m for m in grow(given, {"lot": courtyard(12.0)}, depth=1) if m.zone == ""]
    assert [(m.roof, m.rise, m.high) for m in wings] == [("gabled", 3.0, 20.0)]


def test_no_courtyard_opens_where_it_would_be_a_shaft():
    narrow = plot(shapely.box(0, 0, 28, 40))
    assert grow(narrow, {"lot": courtyard(12.0)}, depth=1) == (narrow.body,)
    low = replace(plot(), levels=1, height=4.0)
    assert grow(low, {"lot": courtyard(12.0)}, depth=1) == (low.body,)


def test_a_chamfer_takes_a_triangle_off_one_corner():
    cut = chamfered(DEEP, (40.0, 36.0), 2.0)
    assert cut.area == pytest.approx(DEEP.area - 2.0)
    assert len(cut.exterior.coords) == 6
