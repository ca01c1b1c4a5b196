"""The sun of a date and a time of day."""

from __future__ import annotations

import re
from dataclasses import replace
from datetime import UTC, datetime, timedelta
from math import radians
from typing import Annotated

from cityx.city import City, Environment
from cityx.errors import UsageError, nearest
from cityx.geometry.solar import hour_of_elevation, solar_position
from cityx.light.light import darkened
from cityx.protocol import Port, Text, action

# A fixed day keeps results reproducible; the seasons hardly move between years.
YEAR = 2025
MIDSUMMER = {"north": (6, 21), "south": (12, 21)}  # month and day by hemisphere
_DATE = re.compile(r"(?:(\d{4})-)?(\d{1,2})-(\d{1,2})(?:[t ]+|$)")

# Words of the day by solar hour, or by the sun's elevation in degrees (rising or setting).
_HOURS = {"noon": 12.0, "morning": 9.0, "afternoon": 15.0, "midnight": 0.0, "night": 23.5}
_ELEVATIONS = {
    "sunrise": (0.5, True),
    "dawn": (4.0, True),  # the first rays: shadows are fourteen times as long as things are high
    "evening": (-1.5, False),
    "golden": (6.0, False),
    "sunset": (0.5, False),
    "dusk": (-3.0, False),
    "blue": (-5.5, False),
}
TIMES = tuple(sorted({**_HOURS, **_ELEVATIONS}))
_OTHER = {
    "golden hour": "golden", "golden-hour": "golden", "goldenhour": "golden",
    "blue hour": "blue", "blue-hour": "blue", "twilight": "dusk", "midday": "noon", "day": "noon",
    "daytime": "noon",
}  # fmt: skip


def clock_of(time: str, latitude: float, day: datetime) -> float:
    """Return the solar hour, [0, 24), of a word of the day or of "HH:MM".

    Raises
    ------
    UsageError
        If it is neither; the message names the nearest words.
    """
    word = " ".join(time.strip().lower().split())
    word = _OTHER.get(word, word)
    match = re.fullmatch(r"(\d{1,2})[:.h](\d{2})", word)
    if match and int(match.group(1)) < 24 and int(match.group(2)) < 60:
        return int(match.group(1)) + int(match.group(2)) / 60.0
    if word in _HOURS:
        return _HOURS[word]
    if word in _ELEVATIONS:
        height, rising = _ELEVATIONS[word]
        return hour_of_elevation(latitude, radians(height), day, rising=rising)
    hint = nearest(word, TIMES)
    raise UsageError(f'"{time}" is no time of day; write HH:MM or one of {", ".join(TIMES)}.{hint}')


def day_of(date: str, latitude: float) -> datetime:
    """Return the midday of "YYYY-MM-DD" or "MM-DD"; of the place's midsummer when it is empty.

    Raises
    ------
    UsageError
        If it is no date, or no day of the calendar.
    """
    if not date.strip():
        month, day = MIDSUMMER["north" if latitude >= 0 else "south"]
        return datetime(YEAR, month, day, 12, tzinfo=UTC)
    match = _DATE.fullmatch(date.strip())
    if match is None:
        raise UsageError(f'"{date}" is no date; write YYYY-MM-DD or MM-DD.')
    year, month, day = (int(word) if word else YEAR for word in match.groups())
    try:
        return datetime(year, month, day, 12, tzinfo=UTC)
    except ValueError:
        raise UsageError(f"There is no day {day} in month {month} of {year}.") from None


def moment_of(text: str) -> tuple[str, str]:
    """Split "2026-12-21 16:00", "12-21 dusk" or "noon" into date and time; either may be empty."""
    text = " ".join(text.strip().lower().split())
    match = _DATE.match(text)
    return (match.group().strip(" t"), text[match.end() :]) if match else ("", text)


def sun_of(environment: Environment, latitude: float, longitude: float, *, time: str,
           date: str = "") -> Environment:  # fmt: skip
    """Return the environment with the sun of a place, a date and a local solar time.

    Parameters
    ----------
    environment
        Its weather stays.
    latitude, longitude
        Degrees.
    time
        Word or "HH:MM", perhaps after a date.
    date
        Day, where `time` names none.
    """
    given, clock = moment_of(time)
    midday = day_of(given or date, latitude)
    hour = clock_of(clock or "noon", latitude, midday)
    # Mean solar time: noon is when the mean sun culminates, whatever the legal clock says.
    when = midday + timedelta(hours=hour - 12.0 - longitude / 15.0)
    elevation, azimuth = solar_position(latitude, longitude, when)
    return darkened(
        replace(
            environment,
            sun_elevation=round(elevation, 6),
            sun_azimuth=round(azimuth, 6),
            date=f"{midday:%Y-%m-%d}",
            hour=round(hour % 24.0, 4),
        )
    )


@action(
    "background/sun-v1",
    limits=["Times are local mean solar time; legal time zones are not known."],
    requires=("layout",),
    gives=(Port("environment", "scene_layout", role="light"),),
    binds={"time": "time", "date": "date"},
    labels=("time of day", "light", "daylight", "date", "season"),
)
def sun(
    city: City,
    *,
    time: Annotated[str, Text(40)] = "afternoon",
    date: Annotated[str, Text(10)] = "",
) -> City:
    """Set the sun for a date and a time of day at the city's place on Earth.

    Parameters
    ----------
    city
        City whose frame says where it lies.
    time
        "HH:MM" local solar time, or a word such as noon, morning, golden, dusk or night; a date
        may stand before it, as in "2026-12-21 16:00".
    date
        "YYYY-MM-DD" or "MM-DD", where the time names none; midsummer of the hemisphere
        when empty: 21 June in the north, 21 December in the south.
    """
    frame = city.frame
    environment = sun_of(city.environment, frame.latitude, frame.longitude, time=time, date=date)
    return replace(city, environment=environment, stages_done=city.stages_done | {"background"})
