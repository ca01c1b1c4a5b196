"""How much of the pavement hangs together."""

import pytest
from crossing_town import crossing_town

from cityx.checks.walkway_checks import check_walkways
from cityx.city import City, Frame
from cityx.road.ground.ground_surface import ground
from cityx.road.network.network import network
from cityx.town.bounded_town import layout_of_site
from cityx.town.plane import Plan


def share(**options):
    (check,) = check_walkways(crossing_town(plaza=False, **options))
    return check


def test_pavements_hang_together_over_crosswalks():
    assert share().value == pytest.approx(0.0)
    assert share().ok


def test_pavements_hang_together_over_wide_streets_where_kerbs_are_lowered():
    assert share(width=16.0).value == pytest.approx(0.0)


def test_pavements_of_wide_roads_without_lowered_kerbs_are_apart():
    wide = share(width=16.0, main=True)
    assert wide.value == pytest.approx(0.5, abs=0.02)
    assert not wide.ok
    assert "in 1 pieces" in wide.meaning


def test_a_footbridge_joins_what_it_leads_over():
    assert share(width=16.0, main=True, footbridge=True).value == pytest.approx(0.0, abs=0.01)


@pytest.mark.parametrize("pattern", ["mixed", "organic", "superblock"])
def test_pavements_of_towns_hang_together(pattern):
    frame = Frame(50.0, 10.0)
    layout = layout_of_site((-200.0, -200.0, 200.0, 200.0), Plan(pattern), 3, frame=frame)
    (check,) = check_walkways(ground(network(City("town", frame, layout, lod=1))))
    assert check.value < 0.1
