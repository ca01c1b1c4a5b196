from math import degrees

import pytest

from cityx.city import City, Environment, Frame, Layout
from cityx.errors import UsageError
from cityx.plugins.background.sun import TIMES, sun, sun_of
from cityx.plugins.background.weather import WEATHERS, weather, weather_of

BERLIN = (52.52, 13.40)


def city():
    return City("c", Frame(*BERLIN), Layout((0.0, 0.0, 1.0, 1.0)),
                stages_done=frozenset({"layout"}))  # fmt: skip


def test_at_noon_of_midsummer_the_sun_stands_at_ninety_less_latitude_plus_tilt():
    light = sun_of(Environment(), *BERLIN, time="noon")
    assert degrees(light.sun_elevation) == pytest.approx(90 - 52.52 + 23.44, abs=0.1)
    assert degrees(light.sun_azimuth) == pytest.approx(180.0, abs=1.5)


def test_noon_is_solar_noon_at_every_longitude():
    lights = [sun_of(Environment(), 40.0, east, time="12:00") for east in (-120.0, 0.0, 139.0)]
    assert (
        max(light.sun_elevation for light in lights) - min(light.sun_elevation for light in lights)
        < 1e-3
    )


@pytest.mark.parametrize("word", TIMES)
def test_every_word_of_the_day_is_known_in_any_case(word):
    assert sun_of(Environment(), *BERLIN, time=f" {word.upper()} ") == sun_of(
        Environment(), *BERLIN, time=word
    )


def test_lights_are_on_at_night_and_off_by_day():
    assert sun_of(Environment(), *BERLIN, time="noon").night_lights == 0.0
    assert 0.15 < sun_of(Environment(), *BERLIN, time="23:30").night_lights < 0.45


def test_an_unknown_time_names_the_nearest():
    with pytest.raises(UsageError, match='Did you mean "morning"'):
        sun_of(Environment(), *BERLIN, time="mornin")


def test_a_day_that_does_not_exist_is_refused():
    with pytest.raises(UsageError, match="no day 31 in month 2"):
        sun(city(), month=2, day=31)


@pytest.mark.parametrize("word", WEATHERS)
def test_a_preset_sets_its_name_and_keeps_the_sun(word):
    before = Environment(sun_elevation=0.3, sun_azimuth=1.0)
    after = weather_of(before, word.title())
    assert after.weather == word
    assert (after.sun_elevation, after.sun_azimuth) == (0.3, 1.0)


def test_an_unknown_weather_names_the_nearest():
    with pytest.raises(UsageError, match='Did you mean "overcast"'):
        weather_of(Environment(), "overcost")


def test_sun_and_weather_may_be_set_in_either_order():
    one = weather(sun(city(), time="dusk"), preset="rain").environment
    other = sun(weather(city(), preset="rain"), time="dusk").environment
    assert one == other


def test_only_the_environment_changes():
    before = city()
    after = weather(before, preset="snow")
    assert after.environment.snow > 0.3
    assert after.scene is before.scene
    assert after.layout is before.layout
    assert "background" in after.stages_done
