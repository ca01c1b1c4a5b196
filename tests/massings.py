"""What every massing owes: volumes inside the plot, apart from one another, over all its ground."""

from itertools import combinations

import shapely


def awkward():
    """Return plans that break simple rules: a yard, an L, a sharp triangle, a sliver, a depth."""
    yard = shapely.box(0, 0, 44, 40).difference(shapely.box(13, 13, 31, 27))
    ell = shapely.union_all([shapely.box(0, 0, 50, 16), shapely.box(0, 0, 16, 50)])
    return [yard, ell, shapely.Polygon([(0, 0), (44, 4), (6, 36)]), shapely.box(0, 0, 60, 3),
            shapely.box(0, 0, 60, 45)]  # fmt: skip


def assert_sound(plot, masses):
    assert masses
    for mass in masses:
        assert mass.plan.geom_type == "Polygon"
        assert mass.plan.is_valid
        assert mass.height > 0.4
        assert mass.plan.difference(plot.plan.buffer(0.1)).area < 0.01
    for a, b in combinations(masses, 2):
        if min(a.high, b.high) - max(a.low, b.low) > 1e-6:
            assert a.plan.intersection(b.plan).area < 0.5
    ground = shapely.union_all([mass.plan for mass in masses if mass.low < 0.05])
    assert ground.area > 0.97 * plot.plan.area
