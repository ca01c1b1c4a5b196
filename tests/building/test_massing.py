import math
from dataclasses import replace

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from cityx.building.massing import massing
from cityx.building.massing import rules as massing_rules
from cityx.building.massing.massing import Plot, grow

RULES = {
    "setback": massing_rules.setback(3.0, 0.4, then="setback"),
    "podium": massing_rules.podium(2, 0.5, then="setback"),
    "court": massing_rules.light_court(8.0, then="end", above=6.0),
    "comb": massing_rules.combed(3, 7.0, 8.0, then="end", above=3.5),
    "notch": massing_rules.notched(3.0, then="setback"),
    "slices": massing_rules.sliced(
        (2, 1, 2), symbols=("notch", "", "setback"), heights=(0.7, 1.0, 0.5)
    ),
    "bundle": massing_rules.bundled(2, 2, then="end"),
    "twist": massing_rules.twisted(0.6, 5, shrink=0.8, then="end"),
    "steps": massing_rules.stepped(3, 4.0),
    "crown": massing_rules.crowned(2.0, 9.0, roof="pyramidal"),
}
ANGLES = st.floats(0, math.pi)


def plot_of(length=40.0, width=28.0, angle=0.3, levels=16, **more):
    plan = shapely.affinity.rotate(shapely.box(0, 0, length, width), angle, use_radians=True)
    return Plot(plan, 3.5 * levels, levels, 977, **{"front": (0.2, -1.0), **more})


def awkward():
    yard = shapely.box(0, 0, 40, 40).difference(shapely.box(12, 12, 28, 28))
    ell = shapely.union_all([shapely.box(0, 0, 40, 12), shapely.box(0, 0, 12, 40)])
    return [yard, ell, shapely.Polygon([(0, 0), (30, 0), (0, 25)]), shapely.box(0, 0, 60, 3)]


def shared_volume(masses):
    total = 0.0
    for i, a in enumerate(masses):
        for b in masses[i + 1 :]:
            overlap = min(a.high, b.high) - max(a.low, b.low)
            if overlap > 1e-6:
                total += overlap * a.plan.intersection(b.plan).area
    return total


@pytest.mark.parametrize("word", RULES)
@settings(max_examples=12, deadline=None, derandomize=True)
@given(length=st.floats(12, 80), width=st.floats(8, 60), angle=ANGLES, levels=st.integers(2, 40))
def test_what_grows_stays_inside_and_shares_no_interior(word, length, width, angle, levels):
    plot = plot_of(length, width, angle, levels)
    masses = grow(plot, RULES, start=word, depth=4)
    assert masses
    volume = sum(mass.plan.area * mass.height for mass in masses)
    assert volume <= plot.plan.area * plot.height * 1.002
    assert shared_volume(masses) < 0.01 * volume
    for mass in masses:
        assert mass.plan.is_valid
        assert mass.height > 0
        assert mass.high <= plot.height + 1e-6
        assert mass.plan.difference(plot.plan.buffer(0.05)).area < 0.1


@pytest.mark.parametrize("word", RULES)
def test_rules_cope_with_awkward_plans(word):
    for plan in awkward():
        masses = grow(replace(plot_of(), plan=plan), RULES, start=word, depth=3)
        assert masses
        assert shared_volume(masses) < 1.0


def test_the_same_seed_grows_the_same_and_another_seed_another():
    first, again = (grow(plot_of(), RULES, start="setback", depth=4) for _ in range(2))
    assert first == again
    assert grow(plot_of(seed=5), RULES, start="setback", depth=4) != first


def test_depth_changes_the_topology():
    counts = [len(grow(plot_of(), RULES, start="setback", depth=depth)) for depth in range(4)]
    assert counts == sorted(counts)
    assert counts[0] == 1
    assert counts[3] > counts[1] > 1


def test_without_noise_a_tower_is_regular():
    still = plot_of(noise=0.0)
    tiers = grow(still, {"lot": massing_rules.setback(4.0, 0.5, then="")}, depth=1)
    width = [massing.axes_of(mass.plan).width for mass in tiers]
    assert np.isclose(width[0] - width[1], 8.0, atol=0.05)
    bundle = grow(still, {"lot": massing_rules.bundled(2, 2)}, depth=1)
    assert len({round(mass.high, 6) for mass in bundle}) == 2


def test_storeys_are_not_cut():
    plot = plot_of()
    masses = grow(plot, RULES, start="setback", depth=4)
    assert masses
    for mass in masses:
        assert abs(mass.low / plot.storey - round(mass.low / plot.storey)) < 1e-6


def test_the_front_of_the_axes_looks_at_the_street():
    axes = plot_of(front=(0.0, 1.0)).axes()
    assert axes.across[1] > 0
    assert np.isclose(np.cross(axes.along, axes.across), 1.0)
