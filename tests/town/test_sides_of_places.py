"""What stands on a side of a place, or across a river from it, is built and measured there."""

import pytest

from cityx.checks.predicates import measure
from cityx.checks.predicates.relations import lies
from cityx.city import City, Frame, Layout
from cityx.errors import UsageError
from cityx.light.sun import clock_of, day_of
from cityx.town.town import town
from cityx.town.wishes.elements import elements
from cityx.town.wishes.quarters import quarter
from cityx.town.wishes.river import river


@pytest.fixture(scope="module")
def by_river():
    start = City("Town", Frame(50.0, 10.0), Layout((0.0, 0.0, 1.0, 1.0)), seed=3)
    return river(town(start, width=520.0, depth=520.0))


def test_things_stand_on_both_sides_of_a_river(by_river):
    city = elements(by_river, kind="school", near="river", relation="north")
    city = elements(city, kind="hotel", near="river", relation="south")
    assert all(measure(goal.predicate, city).met for goal in city.goals)
    assert not measure("near(building, tag=school, river, side=south) >= 1", city).met


def test_a_thing_stands_across_the_river_from_another(by_river):
    city = elements(by_river, kind="church")
    city = elements(city, kind="bank", near="church", relation="across", second="river")
    assert measure("across(building, tag=bank, building, tag=church, river)", city).met
    with pytest.raises(UsageError, match="across"):
        elements(city, kind="cafe", near="church", relation="across")


def test_quarters_lie_on_both_sides_of_a_river(by_river):
    city = quarter(by_river, kind="warehouse", near="river", side="north", within=1000.0)
    city = quarter(city, kind="apartment", near="river", side="south", within=1000.0)
    assert all(measure(goal.predicate, city).met for goal in city.goals)
    south = "near_share(building, type=warehouse, river, within=1000, side=south) >= 0.1"
    assert not measure(south, city).met


def test_bus_stops_stand_where_they_are_asked_for(by_river):
    city = elements(by_river, kind="school")
    city = elements(city, kind="bus_stop", near="school", relation="before")
    points = city.layout.points
    stops = points.geometry[points["kind"] == "bus_stop"].to_numpy()
    school = city.layout.buildings["source"].str.startswith("made/school/").to_numpy()
    streets = city.layout.roads.geometry.to_numpy()
    (place,) = city.layout.buildings.geometry.to_numpy()[school]
    assert lies("before", stops, place, streets).tolist() == [True]


def test_first_light_comes_before_the_sun():
    day = day_of("", 50.0)
    assert clock_of("first_light", 50.0, day) < clock_of("sunrise", 50.0, day)
