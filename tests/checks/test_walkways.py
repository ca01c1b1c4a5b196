"""How much of the pavement hangs together."""

import pytest
from crossing_town import crossing_town

from cityx.checks.walkway_checks import check_walkways


def share(**options):
    (check,) = check_walkways(crossing_town(plaza=False, **options))
    return check


def test_pavements_hang_together_over_crosswalks():
    assert share().value == pytest.approx(0.0)
    assert share().ok


def test_pavements_of_streets_that_nobody_can_cross_are_apart():
    wide = share(width=16.0)
    assert wide.value == pytest.approx(0.75, abs=0.02)
    assert not wide.ok
    assert "in 3 pieces" in wide.meaning


def test_a_footbridge_joins_what_it_leads_over():
    assert share(width=16.0, footbridge=True).value == pytest.approx(0.5, abs=0.05)
