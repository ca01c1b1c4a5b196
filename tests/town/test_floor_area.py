"""Towns for so many people, of a plot ratio, of a mean height: built, and measured."""

import pytest

from cityx.checks.predicates import measure
from cityx.city import City, Frame, Layout
from cityx.errors import ActionFailed, UsageError
from cityx.town.town import town
from cityx.town.wishes.floor_area import floor_area
from cityx.town.wishes.limits import building_limits


@pytest.fixture(scope="module")
def city():
    bare = City("Town", Frame(50.0, 10.0), Layout((0.0, 0.0, 1.0, 1.0)), seed=5)
    return town(bare, width=400.0, depth=400.0, zone="midrise")


@pytest.mark.parametrize(
    "args",
    [{"people": 2500.0}, {"people": 4500.0}, {"ratio": 0.7}, {"ratio": 1.8}, {"floors": 3.0},
     {"floors": 7.0}, {"height": 12.0}, {"height": 25.0}],
)  # fmt: skip
def test_a_town_has_as_much_floor_as_is_asked_for(city, args):
    changed = floor_area(city, **args)
    found = measure(changed.goals[-1].predicate, changed)
    assert found.met, found.evidence
    again = floor_area(city, **args)
    assert changed.layout.buildings.equals(again.layout.buildings)


def test_bounds_of_storeys_are_kept_and_houses_go_where_they_are_too_many(city):
    bounded = building_limits(city, least_floors=4, most_floors=5)
    changed = floor_area(bounded, people=1500.0)
    levels = changed.layout.buildings["levels"]
    assert set(levels[changed.layout.buildings.geometry.area > 45.0]) <= {4, 5}
    assert len(levels) < len(bounded.layout.buildings)
    with pytest.raises(ActionFailed, match="cannot be had"):
        floor_area(bounded, people=20_000.0)


def test_nothing_asked_is_refused(city):
    with pytest.raises(UsageError, match="how many people"):
        floor_area(city)


@pytest.mark.parametrize(
    "text",
    [
        "A quarter for about 2,000 residents with four to five storeys",
        "A small town with a plot ratio of about 1.2",
        "A town of 400 m by 400 m whose buildings are 18 m high on average",
        "A suburb for 400 people",
        "A town of 400 x 400 m with a mean height of four floors",
    ],
)
def test_a_sentence_about_density_is_built(check_sentence, text):
    check_sentence(text)
