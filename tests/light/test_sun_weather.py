from datetime import UTC, datetime
from math import asin, atan2, cos, degrees, radians, sin, tan

import pytest

from cityx.city import City, Environment, Frame, Layout
from cityx.errors import UsageError
from cityx.light.light import PRESETS, lights_of, mixed, weather_row
from cityx.light.sun import TIMES, sun, sun_of
from cityx.light.weather import WEATHERS, lit_anew, weather, weather_of

BERLIN = (52.52, 13.40)


def city():
    return City("c", Frame(*BERLIN), Layout((0.0, 0.0, 1.0, 1.0)),
                stages_done=frozenset({"layout"}))  # fmt: skip


def test_at_noon_of_midsummer_the_sun_stands_at_ninety_less_latitude_plus_tilt():
    light = sun_of(Environment(), *BERLIN, time="noon")
    assert degrees(light.sun_elevation) == pytest.approx(90 - 52.52 + 23.44, abs=0.1)
    assert degrees(light.sun_azimuth) == pytest.approx(180.0, abs=1.5)


def test_without_a_date_it_is_summer_in_both_hemispheres():
    assert sun_of(Environment(), *BERLIN, time="noon").date.endswith("-06-21")
    sydney = sun_of(Environment(), -33.9, 151.2, time="noon")
    assert sydney.date.endswith("-12-21")
    assert degrees(sydney.sun_elevation) == pytest.approx(90 - 33.9 + 23.44, abs=0.1)
    assert sun_of(Environment(), -33.9, 151.2, time="2026-06-21T17:00").date == "2026-06-21"


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
    with pytest.raises(UsageError, match="no day 31 in month 2 of 2026"):
        sun(city(), date="2026-02-31")
    with pytest.raises(UsageError, match='"21 June" is no date; write YYYY-MM-DD or MM-DD'):
        sun(city(), date="21 June")


def almanac_azimuth(latitude, longitude, when):
    """Azimuth by the low-precision formulas of the Astronomical Almanac, page C5, in degrees."""
    n = (when - datetime(2000, 1, 1, 12, tzinfo=UTC)).total_seconds() / 86_400
    mean = radians((280.460 + 0.9856474 * n) % 360)
    anomaly = radians((357.528 + 0.9856003 * n) % 360)
    ecliptic = mean + radians(1.915) * sin(anomaly) + radians(0.020) * sin(2 * anomaly)
    tilt = radians(23.439 - 0.0000004 * n)
    ascension = atan2(cos(tilt) * sin(ecliptic), cos(ecliptic))
    declination = asin(sin(tilt) * sin(ecliptic))
    sidereal = radians((280.46061837 + 360.98564736629 * n) % 360)
    angle = sidereal + radians(longitude) - ascension
    phi = radians(latitude)
    east, north = (
        -cos(declination) * sin(angle),
        sin(declination) * cos(phi) - cos(declination) * sin(phi) * cos(angle),
    )
    return degrees(atan2(east, north)) % 360


@pytest.mark.parametrize(("latitude", "longitude"), [(60.2, 24.9), (35.7, 139.7), (-33.9, -70.6)])
@pytest.mark.parametrize("date", ["2026-12-21", "2026-03-20", "2025-06-21"])
def test_shadows_fall_as_the_almanac_says(latitude, longitude, date):
    for hour in (8, 10, 12, 14, 16):
        light = sun_of(Environment(), latitude, longitude, time=f"{date} {hour:02d}:00")
        if degrees(light.sun_elevation) > 85:
            continue
        universal = datetime.fromisoformat(f"{date}T00:00+00:00").timestamp()
        universal += (hour - longitude / 15) * 3600
        expected = almanac_azimuth(latitude, longitude, datetime.fromtimestamp(universal, UTC))
        found = degrees(light.sun_azimuth)
        assert abs((found - expected + 180) % 360 - 180) < 2.0


def test_a_date_may_stand_before_the_time():
    winter = sun_of(Environment(), *BERLIN, time="2026-12-21 12:00")
    assert winter == sun_of(Environment(), *BERLIN, time="noon", date="2026-12-21")
    assert winter.date == "2026-12-21"
    assert degrees(winter.sun_elevation) == pytest.approx(90 - 52.52 - 23.44, abs=0.2)
    assert sun_of(Environment(), *BERLIN, time="12-21 dusk").sun_elevation < 0


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


def test_half_a_storm_lies_between_clear_air_and_a_storm():
    half = weather_of(Environment(), "storm", 0.5)
    assert half.rain == pytest.approx(PRESETS["storm"].rain / 2)
    assert PRESETS["storm"].visibility < half.visibility < PRESETS["clear"].visibility
    assert weather_of(Environment(), "storm", 0.0).rain == 0.0
    assert mixed(PRESETS["fog"], PRESETS["rain"], 1.0) == PRESETS["rain"]


@pytest.mark.parametrize(("word", "lamps"), [("dawn", 0.0), ("dusk", 1.0), ("night", 1.0)])
def test_an_hour_may_be_named_as_weather(word, lamps):
    after = weather(city(), preset=word).environment
    assert after.weather == word
    assert after.sun_elevation == sun_of(after, *BERLIN, time=word).sun_elevation
    assert after.lamps == lamps


def test_dawn_throws_long_shadows():
    elevation = weather(city(), preset="dawn").environment.sun_elevation
    assert 8 < 1 / tan(elevation) < 30


def test_weather_and_hour_are_combined_in_one_word_or_two():
    one = weather(city(), preset="storm dusk").environment
    other = sun(weather(city(), preset="storm"), time="dusk").environment
    assert one == other
    assert one == lit_anew(Environment(), *BERLIN, weather="dusk+storm")
    assert lit_anew(one, *BERLIN, time="noon").rain == one.rain
    with pytest.raises(UsageError, match='"rain fog" is not one weather'):
        weather(city(), preset="rain fog")


def test_the_time_goes_before_the_hour_in_the_weather():
    light = lit_anew(Environment(), *BERLIN, weather="night", time="noon")
    assert light.sun_elevation > 1.0
    assert light.weather == "night"


def test_lamps_burn_from_sunset_and_under_a_storm_earlier():
    assert sun_of(Environment(), *BERLIN, time="noon").lamps == 0.0
    assert sun_of(Environment(), *BERLIN, time="dusk").lamps == 1.0
    evening = lit_anew(Environment(), *BERLIN, time="20:00")
    assert (evening.lamps, lit_anew(evening, *BERLIN, weather="storm").lamps) == (0.0, 1.0)


def test_homes_are_lit_in_the_evening_offices_in_the_afternoon_few_at_three():
    dark = radians(-20)
    homes, offices, shops = zip(*(lights_of(dark, hour) for hour in (17, 20, 3)), strict=True)
    assert homes[1] > homes[0] > homes[2]
    assert offices[0] > 2 * offices[1] > 2 * offices[2]
    assert shops[1] > shops[2] > homes[2]
    assert lights_of(radians(30), 12) == (0.0, 0.0, 0.0)


def test_only_the_environment_changes():
    before = city()
    after = weather(before, preset="snow")
    assert after.environment.snow > 0.3
    assert after.scene is before.scene
    assert after.layout is before.layout
    assert "background" in after.stages_done


@pytest.mark.parametrize("word", ["rain", "snow"])
def test_light_rain_and_snow_fall_from_a_closed_sky(word):
    light, full = weather_row(word, 0.4), weather_row(word, 1.0)
    assert light.cloud_cover == full.cloud_cover
    assert light.rain + light.snowfall == pytest.approx(0.4 * (full.rain + full.snowfall))
    assert weather_row(word, 0.0) == weather_row("clear", 1.0)
