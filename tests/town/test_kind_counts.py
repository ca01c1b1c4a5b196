"""So many buildings of a kind."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
import shapely

from cityx.checks.predicates.measuring import rows_of
from cityx.city import City, Frame, Layout
from cityx.city.city import City as Whole
from cityx.errors import ActionFailed, UsageError
from cityx.sources.features.tagged import Owner
from cityx.town.quarter_kinds import COUNTED_KINDS, HOUSES, KINDS
from cityx.town.rebuilding import with_buildings
from cityx.town.town import town
from cityx.town.wishes.counting import buildings_count
from cityx.town.wishes.kind_counts import kind_count


@cache
def site(zone="suburb", size=300.0):
    city = City("Town", Frame(50.0, 10.0), Layout((0.0, 0.0, 1.0, 1.0)), seed=3)
    return town(city, width=size, depth=size, zone=zone)


def numbers(city: Whole) -> dict[str, int]:
    return {kind: len(rows_of(KINDS[kind].chosen, city)) for kind in COUNTED_KINDS}


@pytest.mark.parametrize("kind", COUNTED_KINDS)
def test_there_are_exactly_so_many_of_each_kind(kind, check_goals):
    city = kind_count(site(), kind=kind, count=7)
    assert numbers(city)[kind] == 7
    check_goals(city)
    again = kind_count(site(), kind=kind, count=7)
    assert again.layout.buildings.equals(city.layout.buildings)


def test_kinds_that_are_counted_one_after_the_other_keep_their_numbers(check_goals):
    city = buildings_count(site(), count=30)
    wanted = {"office": 4, "shop": 3, "apartment": 5, "villa": 6}
    for kind, count in wanted.items():
        city = kind_count(city, kind=kind, count=count)
    city = kind_count(city, kind="house", count=18)  # villas are houses, too
    found = numbers(city)
    assert {kind: found[kind] for kind in wanted} == wanted
    assert found["house"] == 18
    check_goals(city)


def test_bounds_change_no_more_than_they_must():
    before = site()
    has = numbers(before)["house"]
    assert has > 5
    least = kind_count(before, kind="house", least=5)
    assert numbers(least)["house"] == has
    assert numbers(kind_count(before, kind="house", most=4))["house"] == 4
    changed = least.layout.buildings["use"].to_numpy() != before.layout.buildings["use"].to_numpy()
    assert not np.any(changed)


def test_what_no_building_has_room_for_is_refused_with_what_fits():
    with pytest.raises(ActionFailed, match=r"500 more are to be shop, .* only \d+ have"):
        kind_count(site(), kind="shop", count=500)
    with pytest.raises(UsageError, match="least = 5 is more than most = 2"):
        kind_count(site(), kind="shop", least=5, most=2)


def test_every_kind_of_house_is_measured_as_a_house():
    for kind in HOUSES:
        city = kind_count(site(), kind=kind, count=5)
        assert set(rows_of(KINDS[kind].chosen, city)) <= set(rows_of("building, type=house", city))


def houses_with_sheds(houses: int, sheds: int, beside: int) -> Whole:
    """Return a site of houses, of sheds far from each, and of sheds beside the first ones."""
    shapes = [shapely.box(40 * k, 0, 40 * k + 20, 12 + k) for k in range(houses)]
    shapes += [shapely.box(40 * k, 100, 40 * k + 5, 105) for k in range(sheds)]
    shapes += [shapely.box(40 * k + 5, -12, 40 * k + 10, -7) for k in range(beside)]
    city = City("Site", Frame(50.0, 10.0), Layout((-50.0, -50.0, 250.0, 250.0)), seed=3)
    owners = [Owner(("parcel", k), {"building": "yes"}) for k in range(len(shapes))]
    return replace(city, layout=with_buildings(city, city.layout, shapes, owners))


def sizes(city: Whole) -> tuple[int, int]:
    area = shapely.area(city.layout.buildings.geometry.to_numpy())
    return int((area >= 45.0).sum()), int((area < 45.0).sum())


@pytest.mark.parametrize(
    ("count", "left"), [(4, (4, 5)), (3, (3, 5)), (2, (2, 4)), (6, (6, 5))]
)  # fmt: skip
def test_sheds_are_not_counted_and_go_with_their_house_alone(count, left, check_goals):
    before = houses_with_sheds(houses=3, sheds=4, beside=1)
    assert sizes(before) == (3, 5)
    city = buildings_count(before, count=count, with_sheds=False)
    assert sizes(city) == left
    assert all("area >= 45" in goal.predicate for goal in city.goals)
    check_goals(city)


def test_a_building_larger_than_ten_thousand_square_metres_is_counted(check_goals):
    city = City("Site", Frame(50.0, 10.0), Layout((-50.0, -50.0, 250.0, 250.0)), seed=3)
    owner = Owner(("parcel", 0), {"building": "yes"})
    layout = with_buildings(city, city.layout, [shapely.box(0, 0, 150, 80)], [owner])
    check_goals(buildings_count(replace(city, layout=layout), count=1, with_sheds=False))
