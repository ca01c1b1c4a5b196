"""Buildings are chosen by where they stand, and by whether a file has them."""

import numpy as np
import pytest
import shapely
from made import made_city

from cityx.checks.predicates import measure
from cityx.checks.predicates.parser import parse
from cityx.checks.predicates.whereabouts import is_in_part
from cityx.errors import UsageError


@pytest.mark.parametrize(
    ("choice", "count"),
    [
        # The fronts of the three houses are 68 m from the street at y = 100.
        ('building, type=house, near="69 m of road, class=residential"', 3),
        ('building, type=house, near="67 m of road, class=residential"', 0),
        ('building, near="53 m of building, type=tower"', 3),  # the towers themselves
        ("building, type=house, part=south", 3),
        ("building, type=house, part=north", 0),
        ("building, part=east", 1),
        ('building, near="2000 m of center"', 7),
        ('building, near="2000 m of border"', 7),
        ("building, added=true", 7),
        ("building, added=false", 0),
    ],
)
def test_buildings_are_chosen_by_where_they_stand(choice, count):
    found = measure(f"n({choice}) == {count}", made_city())
    assert found.met, found.evidence


def test_a_share_is_of_those_that_stand_there():
    share = measure("share(building, part=south, type=house, material=brick) >= 0", made_city())
    assert share.value == pytest.approx(1 / 3)


@pytest.mark.parametrize(
    ("predicate", "fault"),
    [
        (
            'n(building, near="river") >= 1',
            'near=river is no distance from a place; write near="50 m of river".',
        ),
        ('n(building, near="50 m of rivver") >= 1', "There is no kind rivver. Did you mean"),
        ("n(building, part=middle) >= 1", "part"),
        ('n(building, near="50 m of road, clas=main") >= 1', "clas"),
        ('n(building, near="50 m of road, class=mainn") >= 1', "class is never mainn"),
        ('share(building, near="9 m of rivver, width=3", roof=tile) >= 0.6', "rivver"),
    ],
)
def test_a_place_that_is_none_is_refused_by_name(predicate, fault):
    with pytest.raises(UsageError) as error:
        parse(predicate)
    assert fault in str(error.value)


def test_a_half_is_half_of_a_site_and_a_side_is_less():
    """Of 100 buildings in 10 rows 50 stand in the northern half, and 40 in the north."""
    steps = np.arange(5.0, 100.0, 10.0)
    x, y = (side.ravel() for side in np.meshgrid(steps, steps))
    shapes = shapely.box(x - 2, y - 2, x + 2, y + 2)
    extent = (0.0, 0.0, 100.0, 100.0)
    for side in ("north", "east", "south", "west"):
        assert is_in_part(shapes, f"{side}_half", extent).sum() == 50
        assert is_in_part(shapes, side, extent).sum() == 40
