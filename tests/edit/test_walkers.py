"""People who walk to a place, leave it or go from one to another, and vehicles nobody counts."""

import numpy as np
import pytest
from crossing_town import crossing_town

from cityx.checks.movement_checks import check_movement
from cityx.checks.predicates import measure
from cityx.city.content import content_hash
from cityx.edit.life.stopped import stopped_vehicles
from cityx.edit.life.walkers import walkers
from cityx.ids import id_text


@pytest.fixture(scope="module")
def town():
    return crossing_town()


@pytest.fixture(scope="module")
def house(town):
    return id_text(int(town.layout.buildings["id"].iloc[0]))


@pytest.fixture(scope="module")
def to_the_house(town, house):
    return walkers(town, goal=(house,), count=6, who="child", wears="hi_vis")


def test_as_many_as_asked_come_nearer_and_wear_what_is_asked_for(town, house, to_the_house):
    asked = f'pedestrian, age=child, wears=hi_vis, to="{house}"'
    assert measure(f"gained({asked}) == 6", to_the_house, before=town).met
    assert not measure(f'n(pedestrian, from="{house}") >= 1', to_the_house).met
    assert not any(check.value > check.limit for check in check_movement(to_the_house))


def test_who_leaves_a_house_goes_away_from_it_at_the_pace_asked_for(town, house):
    city = walkers(town, origin=(house,), count=5, speed=1.0)
    assert measure(f'n(pedestrian, from="{house}") == 5', city).met
    assert not measure(f'n(pedestrian, to="{house}") >= 1', city).met
    moving = city.tracks.speed[city.tracks.speed > 0.5]
    assert np.median(moving) == pytest.approx(1.0, abs=0.1)


def test_the_same_call_gives_the_same_bytes(town, house, to_the_house):
    again = walkers(town, goal=(house,), count=6, who="child", wears="hi_vis")
    assert content_hash(again).total == content_hash(to_the_house).total


def test_a_choice_in_quotes_is_a_place(to_the_house):
    assert measure('n(pedestrian, to="building, area in [1, 100000]") >= 1', to_the_house).met
    assert measure('n(pedestrian, to="no such, thing = 1") == 6', to_the_house).met is None


def test_vehicles_that_nobody_counts_are_as_many_as_there_is_room_for(river):
    few = stopped_vehicles(river)
    assert measure("gained(vehicle, moves=false) >= 2", few, before=river).met


def test_the_blue_lights_of_police_cars_are_lit_and_cars_have_none(river):
    city = stopped_vehicles(river, kind="police", count=1)
    city = stopped_vehicles(city, kind="car", count=1)
    assert measure("share(vehicle, type=police, beacons=true) == 1", city).met
    assert measure("gained(vehicle, beacons=true) == 1", city, before=river).met
