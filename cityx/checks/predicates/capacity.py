"""How much floor a city has, and for how many people it is."""

from __future__ import annotations

import numpy as np
import shapely

from cityx.checks.predicates.building_predicates import Buildings
from cityx.checks.predicates.facts import Facts
from cityx.checks.predicates.finding import Measured
from cityx.geometry.arrays import FloatArray

# Square metres of dwelling that a person has, as in most of western Europe, and the share of the
# floors of a house that is dwelling and no wall, stair or cellar.
PER_PERSON, NET = 40.0, 0.8
HOMES = ("flats", "house")  # uses of buildings that people live in


def floor_areas(facts: Facts) -> FloatArray:
    """Return the square metres of all storeys above ground of each building, (n,)."""
    layer = facts.layer("building")
    return np.asarray(shapely.area(layer.shapes) * layer.number("floors"))


def residents(facts: Facts) -> Measured:
    """Estimate how many people live in the houses and flats."""
    layer = facts.layer("building")
    assert isinstance(layer, Buildings)
    homes = np.any([layer.has("use", use) for use in HOMES], axis=0)
    floors = float(floor_areas(facts)[homes].sum())
    people = NET * floors / PER_PERSON
    return Measured(
        people,
        f"{int(homes.sum())} houses and blocks of flats with {floors:,.0f} m2 of floors are for "
        f"{people:,.0f} people",
    )


def plot_ratio(facts: Facts) -> Measured:
    """Measure the floors of all buildings over the ground of the site."""
    xmin, ymin, xmax, ymax = facts.city.layout.extent
    site, floors = (xmax - xmin) * (ymax - ymin), float(floor_areas(facts).sum())
    return Measured(floors / site, f"{floors:,.0f} m2 of floors stand on {site:,.0f} m2")
