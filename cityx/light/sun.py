"""The sun of a date and a time of day.

References
----------
NOAA Global Monitoring Laboratory, "Solar calculation details", after Meeus, "Astronomical
Algorithms", 2nd edition, 1998. Good to 0.01 degrees between 1900 and 2100, refraction apart.
"""

from __future__ import annotations

import re
from dataclasses import replace
from datetime import UTC, datetime, timedelta
from math import acos, asin, atan2, cos, degrees, pi, radians, sin, tan
from typing import Annotated

from cityx.city import City, Environment
from cityx.errors import UsageError, nearest
from cityx.light.light import darkened
from cityx.protocol import Choice, Port, Text, action

# A fixed day keeps results reproducible; the seasons hardly move between years.
YEAR = 2025
MIDSUMMER = {"north": (6, 21), "south": (12, 21)}  # month and day by hemisphere
_DATE = re.compile(r"(?:(\d{4})-)?(\d{1,2})-(\d{1,2})(?:[t ]+|$)")

# Words of the day by solar hour, or by the sun's elevation in degrees (rising or setting).
_HOURS = {"noon": 12.0, "morning": 9.0, "afternoon": 15.0, "midnight": 0.0, "night": 23.5}
_ELEVATIONS = {
    "sunrise": (0.5, True),
    "first_light": (-3.0, True),
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
_MORNING = ("first_light", "dawn", "sunrise", "morning")
_EVENING = ("golden", "sunset", "evening", "dusk")
LOW = (3.0, 12.0)  # degrees of a sun that is called low; shadows are five to twenty times as long
ASIDE = 20.0  # degrees from a point of the compass within which the sun stands there
WEIGHT = 4.0  # degrees aside that count as one too high or too low
STEPS = 12  # moments of an hour that are looked at
COMPASS = {name: 45.0 * number for number, name in enumerate(
    ("north", "northeast", "east", "southeast", "south", "southwest", "west", "northwest")
)}  # fmt: skip
EPOCH = datetime(2000, 1, 1, 12, tzinfo=UTC)  # J2000.0
CENTURY = 36_525 * 86_400.0  # seconds


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


def clock_towards(
    latitude: float, longitude: float, time: str, date: str, *, towards: str = "", low: bool = False
) -> tuple[str, str]:
    """Return the time, and the date, at which the sun stands where it is asked to.

    Parameters
    ----------
    latitude, longitude
        Degrees.
    time, date
        As of `sun`. A clock stays what it is; a word keeps its half of the day, and a date its day.
        Without a date the day is that of midsummer, or where the sun does not stand so then, the
        middle of the month in which it comes nearest.
    towards
        Point of the compass, "" for any.
    low
        Whether it is to stand so low that shadows are long.
    """
    given, clock = moment_of(time)
    word = _OTHER.get(clock, clock)
    if re.match(r"\d", word) or word in ("noon", "night", "midnight"):
        return time, date
    rising = word in _MORNING
    half = (0.0, 12.0) if rising else (12.0, 24.0) if word in _EVENING else (0.0, 24.0)
    days = (
        [given or date] if given or date else ["", *(f"{month:02d}-15" for month in range(1, 13))]
    )
    best: tuple[float, str, float] | None = None
    for day in days:
        miss, hour = _nearest_hour(latitude, longitude, day, half, towards, low=low)
        if best is None or miss < best[0] - 1.0:
            best = (miss, day, hour)
        if miss <= 0:
            break
    assert best is not None
    minutes = round(best[2] * 60) % (24 * 60)
    return f"{minutes // 60:02d}:{minutes % 60:02d}", best[1]


def _nearest_hour(
    latitude: float, longitude: float, date: str, half: tuple[float, float], towards: str, *,
    low: bool,
) -> tuple[float, float]:  # fmt: skip
    """Return by how many degrees the sun misses what is asked of it on a day, and the best hour."""
    midday = day_of(date, latitude)
    least, most = LOW if low else (LOW[0], 90.0)
    best = (1e9, 12.0)
    for step in range(24 * STEPS):
        hour = step / STEPS
        if not half[0] <= hour <= half[1]:
            continue
        when = midday + timedelta(hours=hour - 12.0 - longitude / 15.0)
        elevation, azimuth = (degrees(x) for x in solar_position(latitude, longitude, when))
        off = abs((azimuth - COMPASS.get(towards, azimuth) + 180.0) % 360.0 - 180.0)
        over = max(least - elevation, elevation - most, 0.0)
        side = max(off - ASIDE, 0.0) if towards else 0.0
        miss = side + WEIGHT * over
        tie = 0.01 * off + (0.001 * (24.0 - hour) if low else 0.0)
        if miss + tie < best[0]:
            best = (miss + tie, hour)
    return (best[0] if best[0] > 0.5 else 0.0), best[1]


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
    binds={"time": "time", "date": "date", "towards": "sun.towards", "low": "sun.low"},
    labels=("time of day", "light", "daylight", "date", "season"),
)
def sun(
    city: City,
    *,
    time: Annotated[str, Text(40)] = "afternoon",
    date: Annotated[str, Text(10)] = "",
    towards: Annotated[str | None, Choice(*COMPASS)] = None,
    low: bool = False,
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
    towards
        Where the sun is to stand; the time is that at which it does, in the half of the day that
        `time` tells by a word.
    low
        Whether it is to stand so low that shadows are long.
    """
    frame = city.frame
    if towards is not None or low:
        time, date = clock_towards(frame.latitude, frame.longitude, time, date,
                                   towards=towards or "", low=low)  # fmt: skip
    environment = sun_of(city.environment, frame.latitude, frame.longitude, time=time, date=date)
    return replace(city, environment=environment, stages_done=city.stages_done | {"background"})


def sun_coordinates(when: datetime) -> tuple[float, float]:
    """Return declination (radians) and equation of time (minutes) at a moment with a time zone."""
    t = (when - EPOCH).total_seconds() / CENTURY
    mean_longitude = radians((280.46646 + t * (36000.76983 + 0.0003032 * t)) % 360.0)
    anomaly = radians(357.52911 + t * (35999.05029 - 0.0001537 * t))
    eccentricity = 0.016708634 - t * (0.000042037 + 0.0000001267 * t)
    center = (
        sin(anomaly) * (1.914602 - t * (0.004817 + 0.000014 * t))
        + sin(2 * anomaly) * (0.019993 - 0.000101 * t)
        + sin(3 * anomaly) * 0.000289
    )
    node = radians(125.04 - 1934.136 * t)
    apparent = mean_longitude + radians(center - 0.00569 - 0.00478 * sin(node))
    seconds = 21.448 - t * (46.8150 + t * (0.00059 - 0.001813 * t))
    obliquity = radians(23.0 + (26.0 + seconds / 60.0) / 60.0 + 0.00256 * cos(node))
    declination = asin(sin(obliquity) * sin(apparent))
    y = tan(obliquity / 2) ** 2
    equation = (
        y * sin(2 * mean_longitude)
        - 2 * eccentricity * sin(anomaly)
        + 4 * eccentricity * y * sin(anomaly) * cos(2 * mean_longitude)
        - 0.5 * y * y * sin(4 * mean_longitude)
        - 1.25 * eccentricity * eccentricity * sin(2 * anomaly)
    )
    return declination, 4.0 * degrees(equation)


def solar_position(
    latitude: float, longitude: float, when: datetime, *, refraction: bool = True
) -> tuple[float, float]:
    """Return the sun's elevation and azimuth.

    Parameters
    ----------
    latitude, longitude
        Degrees, north and east positive.
    when
        The moment; it must have a time zone.
    refraction
        Whether the air lifts the sun, as one sees it.

    Returns
    -------
    elevation, azimuth
        Radians; azimuth clockwise from north, in [0, 2 pi).
    """
    declination, equation = sun_coordinates(when)
    utc = when.astimezone(UTC)
    minutes = utc.hour * 60.0 + utc.minute + (utc.second + utc.microsecond / 1e6) / 60.0
    hour_angle = radians((minutes + equation + 4.0 * longitude) / 4.0 - 180.0)
    phi = radians(latitude)
    up = sin(phi) * sin(declination) + cos(phi) * cos(declination) * cos(hour_angle)
    elevation = pi / 2 - acos(max(-1.0, min(1.0, up)))
    azimuth = atan2(
        -cos(declination) * sin(hour_angle),
        cos(phi) * sin(declination) - sin(phi) * cos(declination) * cos(hour_angle),
    )
    if refraction:
        elevation += _refraction(elevation)
    return elevation, azimuth % (2 * pi)


def _refraction(elevation: float) -> float:
    """Atmospheric refraction after NOAA's piecewise fit, radians."""
    h = degrees(elevation)
    if h > 85.0:
        return 0.0
    slope = tan(elevation)
    if h > 5.0:
        seconds = 58.1 / slope - 0.07 / slope**3 + 0.000086 / slope**5
    elif h > -0.575:
        seconds = 1735.0 + h * (-518.2 + h * (103.4 + h * (-12.79 + h * 0.711)))
    else:
        seconds = -20.774 / slope
    return radians(seconds / 3600.0)


def hour_of_elevation(latitude: float, elevation: float, when: datetime, *, rising: bool) -> float:
    """Return the solar hour (12 = the sun due south or north) at which it stands at an elevation.

    Where the sun never gets there that day, the hour of its nearest pass is returned.
    """
    declination, _ = sun_coordinates(when)
    phi = radians(latitude)
    scale = cos(phi) * cos(declination)
    cosine = (sin(elevation) - sin(phi) * sin(declination)) / max(scale, 1e-9)
    hours = degrees(acos(max(-1.0, min(1.0, cosine)))) / 15.0
    return 12.0 - hours if rising else 12.0 + hours
