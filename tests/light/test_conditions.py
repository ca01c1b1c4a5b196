"""Single numbers of the air, and times at which the sun stands where it is asked to."""

from dataclasses import replace

import pytest

from cityx.checks.predicates import measure
from cityx.city import City
from cityx.city.frame import Frame
from cityx.city.layout import Layout
from cityx.light.conditions import conditions
from cityx.light.sun import sun


@pytest.fixture
def town():
    return City("town", Frame(52.5, 13.4), Layout((-50.0, -50.0, 50.0, 50.0)))


@pytest.mark.parametrize(
    ("asked", "predicate"),
    [
        ({"visibility": 80.0}, "env.visibility == 80"), ({"cloud": 0.5}, "env.cloud == 0.5"),
        ({"wetness": 0.8}, "env.wetness == 0.8"), ({"snow_cover": 0.3}, "env.snow_cover == 0.3"),
        ({"wind": 12.0, "wind_from": "north"}, "env.wind == 12"), ({"moon": 0.0}, "env.moon == 0"),
        ({"wind_from": "southwest"}, "env.wind_from == southwest"),
    ],
)  # fmt: skip
def test_what_is_said_of_the_air_is_measured_and_the_rest_stays(town, asked, predicate):
    made = conditions(town, **asked)
    assert measure(predicate, made).met
    assert not measure(predicate, town).met
    kept = replace(made.environment, **{
        name: getattr(town.environment, name) for name in
        ("visibility", "cloud_cover", "wetness", "snow", "wind", "wind_from", "moon")
    })  # fmt: skip
    assert kept == town.environment


def test_nothing_said_changes_nothing(town):
    assert conditions(town).environment == town.environment


@pytest.mark.parametrize("side", ["east", "southeast", "south", "southwest", "west"])
@pytest.mark.parametrize("low", [False, True])
def test_the_sun_stands_where_it_is_asked_to(town, side, low):
    made = sun(town, towards=side, low=low)
    assert measure(f"env.sun_side == {side}", made).met
    assert measure("env.sun_elev >= 2", made).met
    assert measure("env.sun_elev in [1, 15]", made).met == low or not low


def test_a_word_for_the_time_keeps_its_half_of_the_day_and_a_date_its_day(town):
    morning, evening = (sun(town, time=word, low=True) for word in ("morning", "evening"))
    assert morning.environment.hour < 12 < evening.environment.hour
    dated = sun(town, date="03-20", low=True)
    assert measure("env.day in [78, 80]", dated).met


def test_a_clock_goes_before_where_the_sun_would_stand(town):
    assert sun(town, time="09:30", towards="west").environment.hour == 9.5
