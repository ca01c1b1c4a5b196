"""The time of a city that exists: another hour, some hours later, another season."""

from __future__ import annotations

from dataclasses import replace
from datetime import timedelta
from typing import Annotated

from cityx.city import City, Environment
from cityx.errors import UsageError
from cityx.light.sun import COMPASS, clock_towards, day_of, sun_of
from cityx.protocol import Choice, Port, Range, Serves, Text, action

# Season -> month and day in its middle, north and south of the equator.
SEASONS = {
    "spring": ("04-20", "10-20"), "summer": ("06-21", "12-21"), "autumn": ("10-15", "04-15"),
    "winter": ("01-10", "07-10"),
}  # fmt: skip
HOURS = 24.0


@action(
    "edit/time-v1",
    limits=["Times are local mean solar time.", "Trees keep the leaves of the day they grew on."],
    requires=("layout",),
    takes=(Port("environment", "scene_layout", role="light"),),
    gives=(Port("environment", "scene_layout", role="light"),),
    serves=(
        Serves("edit=set_time"),
        Serves("edit=set_season"),
        Serves("edit=shift_time"),
        Serves("edit=set_weather", "time"),
        Serves("edit=set_weather", "date"),
        Serves("edit=set_weather", "sun.towards"),
        Serves("edit=set_weather", "sun.low"),
        Serves("edit=set_weather", "season"),
    ),
    binds={
        "time": "time",
        "later": "hours",
        "season": "season",
        "date": "date",
        "towards": "sun.towards",
        "low": "sun.low",
    },
    labels=("time of day", "later", "earlier", "season", "sunset"),
)
def moment(
    city: City,
    *,
    time: Annotated[str | None, Text(40)] = None,
    later: Annotated[float | None, Range(-8784.0, 8784.0)] = None,
    season: Annotated[str | None, Choice(*SEASONS)] = None,
    date: Annotated[str | None, Text(10)] = None,
    towards: Annotated[str | None, Choice(*COMPASS)] = None,
    low: bool = False,
) -> City:
    """Move the sun to another time; what is not said, hour or day, stays as it is.

    Parameters
    ----------
    city
        City whose frame says where it lies; nothing of it but the light changes.
    time
        "HH:MM" local solar time, or a word such as noon, dusk or night; a date may stand before it.
    later
        Hours from now; negative to go back. The day changes at midnight.
    season
        Season of the hemisphere, of which the middle day is taken.
    date
        Day, "YYYY-MM-DD" or "MM-DD".
    towards
        Where the sun is to stand on that day, in the half of it that `time` tells.
    low
        Whether it is to stand so low that shadows are long.
    """
    if not low and all(one is None for one in (time, later, season, date, towards)):
        raise UsageError("Say a time, a number of hours or a season.")
    frame, now, said = city.frame, city.environment, date
    date = now.date
    if season is not None:
        date = SEASONS[season][frame.latitude < 0]
    date = said or date
    clock = time or ("" if towards or low else clock_text(now.hour))
    if towards or low:
        clock, date = clock_towards(frame.latitude, frame.longitude, clock, date,
                                    towards=towards or "", low=low)  # fmt: skip
    made = sun_of(now, frame.latitude, frame.longitude, time=clock, date=date)
    if later is not None:
        made = _shifted(made, frame.latitude, frame.longitude, later)
    return replace(city, environment=made)


def _shifted(now: Environment, latitude: float, longitude: float, hours: float) -> Environment:
    """Return the light some hours later; the day changes at midnight."""
    passed = now.hour + hours
    day = day_of(now.date, latitude) + timedelta(days=passed // HOURS)
    return sun_of(now, latitude, longitude, time=clock_text(passed % HOURS),
                  date=f"{day:%Y-%m-%d}")  # fmt: skip


def clock_text(hour: float) -> str:
    """Write an hour, [0, 24), as HH:MM."""
    minutes = round(hour * 60) % (24 * 60)
    return f"{minutes // 60:02d}:{minutes % 60:02d}"
