import numpy as np
import shapely

from cityx.building.massing import rules as massing_rules
from cityx.building.massing.massing import Plot, grow


def plot_of(levels=12, noise=0.0):
    return Plot(shapely.box(0, 0, 30, 20), 3.0 * levels, levels, 977, noise=noise)


def test_bands_are_cut_at_floors_from_below_and_above():
    rule = massing_rules.banded((2, -1), symbols=("", "", ""), zones=("foot", None, "head"))
    masses = grow(plot_of(), {"lot": rule})
    assert [(m.low, m.high, m.zone) for m in masses] == [
        (0.0, 6.0, "foot"), (6.0, 33.0, ""), (33.0, 36.0, "head"),
    ]  # fmt: skip


def test_bands_that_do_not_fit_leave_the_volume_whole():
    rule = massing_rules.banded((2, -2), symbols=("", "", ""))
    assert grow(plot_of(levels=3), {"lot": rule}) == (plot_of(levels=3).body,)


def test_a_band_may_be_drawn_in():
    rule = massing_rules.banded((4,), symbols=("", ""), insets=(0.0, 1.5))
    lower, upper = grow(plot_of(), {"lot": rule})
    assert np.isclose(lower.plan.area, 600)
    assert np.isclose(upper.plan.area, 27 * 17)


def test_what_hangs_over_grows_to_the_whole_plan():
    masses = grow(plot_of(), {"lot": massing_rules.overhung(3, 1.0)})
    areas = [mass.plan.area for mass in masses]
    assert len(areas) == 4
    assert areas == sorted(areas)
    assert np.isclose(areas[-1], 600)
    assert [m.low for m in masses[1:]] == [m.high for m in masses[:-1]]


def test_a_rule_that_does_not_fit_passes_the_volume_on():
    rules = {
        "lot": massing_rules.otherwise(massing_rules.bundled(9, 9), "next"),
        "next": massing_rules.banded((4,), symbols=("", "")),
    }
    assert len(grow(plot_of(), rules)) == 2
