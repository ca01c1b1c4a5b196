"""Sun, weather and air in the words and numbers of predicates."""

from __future__ import annotations

from math import degrees, log

from cityx.checks.predicates import words
from cityx.city import Environment


def times_of(environment: Environment) -> tuple[str, ...]:
    """Return every word of the day that holds for the sun and the clock."""
    height = degrees(environment.sun_elevation)
    azimuth = degrees(environment.sun_azimuth) % 360.0
    half = words.UP if azimuth < 180.0 else words.DOWN
    return tuple(
        word
        for word, moment in words.TIMES.items()
        if moment.sun[0] <= height <= moment.sun[1]
        and moment.half in ("", half)
        and moment.hours[0] <= environment.hour <= moment.hours[1]
    )


def weathers_of(environment: Environment) -> tuple[str, ...]:
    """Return every kind of weather that holds for the numbers of the air."""
    values = {
        "cloud": environment.cloud_cover, "snow": environment.snow,
        "visibility": environment.visibility, "rain": environment.rain,
        "snowfall": environment.snowfall, "wind": environment.wind,
    }  # fmt: skip
    return tuple(
        word
        for word, air in words.WEATHERS.items()
        if all(getattr(air, name)[0] <= value <= getattr(air, name)[1]
               for name, value in values.items())
    )  # fmt: skip


def season_of(environment: Environment, latitude: float) -> str:
    """Return the season of the calendar: winter from December to February, or half a year later."""
    month = int(environment.date[5:7]) if environment.date else 6
    quarter = (month % 12 // 3 + (2 if latitude < 0 else 0)) % 4
    return ("winter", "spring", "summer", "autumn")[quarter]


def fog_of(environment: Environment) -> float:
    """Return how thick the fog is: 0 at 10 km of visibility, 1 at 100 m, by its logarithm."""
    span = log(words.CLEAREST / words.THICKEST)
    thick = log(words.CLEAREST / max(environment.visibility, 1.0)) / span
    return min(max(thick, 0.0), 1.0)


def air_number(environment: Environment, key: str) -> float:
    """Return a number of the environment by its key in predicates, without "env."."""
    return {
        "sun_elev": degrees(environment.sun_elevation),
        "sun_azimuth": degrees(environment.sun_azimuth) % 360.0,
        "fog": fog_of(environment),
        "wetness": environment.wetness,
        "snow_cover": environment.snow,
        "cloud": environment.cloud_cover,
        "visibility": environment.visibility,
        "wind": environment.wind,
        "rain": environment.rain,
        "hour": environment.hour,
    }[key]
