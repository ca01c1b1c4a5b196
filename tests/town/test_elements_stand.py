"""Elements stand to others as asked: at the end of a pier, at a street, so far away, large."""

import pytest
import shapely

from cityx.checks.predicates import measure
from cityx.city import City, Frame, Layout
from cityx.errors import ActionFailed
from cityx.town.coast import coast
from cityx.town.lots import size_of
from cityx.town.town import town
from cityx.town.wishes.elements import elements


@pytest.fixture(scope="module")
def bare():
    start = City("Town", Frame(50.0, 10.0), Layout((0.0, 0.0, 1.0, 1.0)), seed=3)
    return town(start, width=520.0, depth=520.0)


@pytest.fixture(scope="module")
def pier(bare):
    return elements(coast(bare, side="south", share=0.25, quay=42.0), kind="pier", most=1)


def only(city, kind):
    own = city.layout.buildings["source"].str.startswith(f"made/{kind}/").to_numpy()
    return city.layout.buildings.geometry.to_numpy()[own]


def test_a_lighthouse_stands_at_the_end_of_a_pier_in_the_water(pier):
    city = elements(pier, kind="lighthouse", near="pier", relation="end")
    (house,) = only(city, "lighthouse")
    areas = city.layout.areas
    sea = shapely.union_all(areas.geometry[areas["kind"] == "sea"].to_numpy())
    piers = areas.geometry[areas["kind"] == "pier"].to_numpy()
    assert shapely.contains(sea, house)
    assert len(piers) == 1
    assert shapely.contains(piers[0], house)
    assert all(measure(goal.predicate, city).met for goal in city.goals)
    ashore = elements(pier, kind="lighthouse")
    assert not measure("at_end(building, tag=lighthouse, pier)", ashore).met


def test_a_church_stands_at_the_end_of_the_main_street(bare):
    city = elements(bare, kind="church", near="main_street", relation="end")
    assert measure("at_end(building, tag=church, road, class=main)", city).met
    middle = elements(bare, kind="church", side="middle")
    assert not measure("at_end(building, tag=church, road, class=main)", middle).met


@pytest.mark.parametrize(("near", "metres"), [("main_street", 50.0), ("corner", 25.0)])
def test_what_stands_at_a_street_or_a_corner_is_close(bare, near, metres):
    city = elements(bare, kind="bar", near=near, relation="at")
    assert measure(city.goals[-1].predicate, city).met
    assert measure(city.goals[-1].predicate, city).value <= metres


def test_distances_hold_on_both_sides(bare):
    city = elements(bare, kind="school")
    far = elements(city, kind="bar", near="school", nearest=150.0)
    close = elements(city, kind="bar", near="school", farthest=60.0)
    (school,) = only(city, "school")
    assert shapely.distance(only(far, "bar")[0], school) >= 150.0
    assert shapely.distance(only(close, "bar")[0], school) <= 60.0
    with pytest.raises(ActionFailed, match="at least 900 m from a school"):
        elements(city, kind="bar", near="school", nearest=900.0)


@pytest.mark.parametrize("kind", ["clinic", "parking_lot", "school"])
def test_sizes_are_told_by_the_ground(bare, kind):
    for size in ("large", "small"):
        city = elements(bare, kind=kind, size=size)
        other = "small" if size == "large" else "large"
        assert measure(size_of(kind, size), city).met
        assert not measure(size_of(kind, other), city).met
