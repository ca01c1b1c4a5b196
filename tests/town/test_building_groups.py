"""So many buildings of a kind in one place, or added to a map."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from cityx.checks.predicates.measuring import measure, rows_of
from cityx.city import City, Frame, Layout
from cityx.errors import ActionFailed, UsageError
from cityx.town.building_groups import BuildingGroup, group_of
from cityx.town.town import town
from cityx.town.wishes.building_group import building_group
from cityx.town.wishes.river import river


@cache
def site(zone="midrise"):
    city = City("Town", Frame(50.0, 10.0), Layout((0.0, 0.0, 1.0, 1.0)), seed=3)
    return river(town(city, width=350.0, depth=350.0, zone=zone), side="middle")


def number(city, group):
    return len(rows_of(group.chosen, city))


@pytest.mark.parametrize(
    ("group", "count"),
    [
        (BuildingGroup("house", near="river", within=50), 20),
        (BuildingGroup("villa", part="north"), 8),
        (BuildingGroup("villa", part="north_half"), 8),
        (BuildingGroup("apartment", part="east"), 4),
        (BuildingGroup("warehouse", near="river", within=60), 3),
        (BuildingGroup("shop", near="main_street"), 6),
    ],
)
def test_there_are_so_many_in_the_place_and_always_the_same(group, count, check_goals):
    told = {"kind": group.kind, "least": count, "most": count}
    told |= {"part": group.part} if group.part else {"near": group.near, "within": group.within}
    city = building_group(site(), **told)
    assert number(city, group) == count
    check_goals(city)
    again = building_group(site(), **told)
    assert again.layout.buildings.equals(city.layout.buildings)


def test_storeys_are_of_the_group_alone():
    city = building_group(
        site(), kind="apartment", part="east", least=3, least_floors=9, most_floors=9
    )
    east = BuildingGroup("apartment", part="east").chosen
    assert measure(f"stat({east}, floors, min) == 9", city).met
    before, after = (one.layout.buildings for one in (site(), city))
    west = after["geometry"].centroid.x < 0
    kept = np.isin(before["id"], after["id"][west])
    assert (before["levels"][kept].to_numpy() == after["levels"][west].to_numpy()).all()


def test_those_that_are_too_many_go():
    city = building_group(site("suburb"), kind="house", near="river", within=60, most=2)
    assert number(city, BuildingGroup("house", near="river", within=60)) == 2


def test_what_is_added_takes_no_building_of_a_map_away():
    table = site("suburb").layout.buildings
    mapped = table.assign(source=[f"osm/way/{n}" for n in range(len(table))])
    before = replace(site("suburb"), layout=replace(site("suburb").layout, buildings=mapped))
    told = {"kind": "cottage", "added": True, "least": 3, "most": 3, "most_floors": 1}
    city = building_group(before, **told)
    after = city.layout.buildings
    assert np.isin(table["id"], after["id"]).all()
    assert len(after) == len(table) + 3
    assert number(city, BuildingGroup("cottage", added=True)) == 3
    again = building_group(before, **told)
    assert again.layout.buildings.equals(after)


def test_a_place_that_is_not_there_is_told():
    with pytest.raises(ActionFailed, match=r"no church for a house to be within 60 m of"):
        building_group(site(), kind="house", near="church", least=3)
    with pytest.raises(UsageError, match="which of them are meant"):
        building_group(site(), kind="house", least=3)
    with pytest.raises(UsageError, match="least = 5 is more than most = 2"):
        building_group(site(), kind="house", part="east", least=5, most=2)


def test_room_that_is_short_is_told_in_numbers():
    with pytest.raises(ActionFailed, match=r"^There are \d+ of factory within 20 m of river, but"):
        building_group(site(), kind="factory", near="river", within=20, least=60)


@pytest.mark.parametrize(
    "group",
    [
        BuildingGroup("house", "north"),
        BuildingGroup("villa", "", "main_street", 35, added=True),
        BuildingGroup("building", near="river"),
        BuildingGroup("office", "center", "plaza", 90),
    ],
)
def test_a_group_is_read_as_it_is_written(group):
    assert group_of(f"{group.text}.floors.max") == group


@pytest.mark.parametrize("key", ["house.count", "house in moon.count", "tower in north.count"])
def test_other_keys_are_of_no_group(key):
    assert group_of(key) is None
