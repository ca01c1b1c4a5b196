from datetime import UTC, datetime
from math import degrees

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from cityx.light.sun import hour_of_elevation, solar_position, sun_coordinates


def test_the_position_is_that_of_the_published_example():
    # Reda and Andreas, NREL/TP-560-34302 (2008), table A5.1: Golden, Colorado.
    when = datetime(2003, 10, 17, 19, 30, 30, tzinfo=UTC)
    elevation, azimuth = solar_position(39.742476, -105.1786, when)
    assert 90 - degrees(elevation) == pytest.approx(50.11162, abs=0.01)
    assert degrees(azimuth) == pytest.approx(194.34024, abs=0.01)


@pytest.mark.parametrize(
    ("moment", "declination"),
    [((2025, 3, 20, 9, 1), 0.0), ((2025, 6, 21, 2, 42), 23.437), ((2025, 12, 21, 15, 3), -23.437)],
)
def test_the_declination_at_equinox_and_solstices_is_the_almanacs(moment, declination):
    found, _ = sun_coordinates(datetime(*moment, tzinfo=UTC))
    assert degrees(found) == pytest.approx(declination, abs=0.01)


@pytest.mark.parametrize(("day", "minutes"), [((2025, 2, 11), -14.2), ((2025, 11, 3), 16.45)])
def test_the_equation_of_time_has_its_known_extremes(day, minutes):
    assert sun_coordinates(datetime(*day, 12, tzinfo=UTC))[1] == pytest.approx(minutes, abs=0.05)


def test_london_sunrise_at_midsummer_is_at_the_published_minute():
    # HM Nautical Almanac Office: 21 June, London, sunrise 03:43 UTC (upper limb, refraction).
    when = datetime(2025, 6, 21, 3, 43, tzinfo=UTC)
    elevation, _ = solar_position(51.5, -0.13, when, refraction=False)
    assert degrees(elevation) == pytest.approx(-0.833, abs=0.1)


@settings(max_examples=50, deadline=None, derandomize=True)
@given(st.floats(-66, 66), st.floats(-180, 180), st.integers(0, 364 * 24))
def test_elevation_and_azimuth_stay_in_their_ranges(latitude, longitude, hour):
    from datetime import timedelta

    when = datetime(2025, 1, 1, tzinfo=UTC) + timedelta(hours=hour)
    elevation, azimuth = solar_position(latitude, longitude, when)
    assert -90 <= degrees(elevation) <= 90
    assert 0 <= azimuth < 6.2832


def test_the_hour_of_an_elevation_leads_to_that_elevation():
    when = datetime(2025, 6, 21, 12, tzinfo=UTC)
    assert hour_of_elevation(0.0, 0.0, when, rising=True) == pytest.approx(6.0, abs=1e-6)
    assert hour_of_elevation(89.0, 0.0, when, rising=False) == pytest.approx(24.0)
