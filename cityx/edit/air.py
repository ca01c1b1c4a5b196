"""Edit the air of a city: more or less of its weather, wet streets, lying snow."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated

from cityx.city import City, Environment
from cityx.errors import UsageError
from cityx.light.light import PRESETS, darkened
from cityx.protocol import Choice, Port, Range, Serves, action

KINDS = ("fog", "haze", "rain", "snow", "storm", "clouds")
MORE, LESS = 2.0, 0.5  # times of it, where no number is said
DENSEST = 20.0  # metres of visibility; fog is hardly ever thicker
CLEAREST = PRESETS["clear"].visibility
MOST_RAIN = 120.0  # mm per hour, of a cloudburst
WET = 0.05  # of wetness per mm of rain per hour that is added, until all is wet


@action(
    "edit/air-v1",
    limits=["What there is none of becomes no more; set the weather for that."],
    requires=("layout",),
    takes=(Port("environment", "scene_layout", role="weather"),),
    gives=(Port("environment", "scene_layout", role="weather"),),
    serves=(
        Serves("edit=more_weather", factor=MORE),
        Serves("edit=less_weather", factor=LESS),
        Serves("edit=set_weather", "wetness=high", wetness=0.8),
        Serves("edit=set_weather", "wetness=low", wetness=0.0),
        Serves("edit=set_weather", "snow.cover=high", snow_cover=0.85),
    ),
    binds={"weather": "air", "factor": "factor"},
    labels=("thicker fog", "heavier rain", "wet streets", "snow on the ground"),
)
def air(
    city: City,
    *,
    weather: Annotated[str | None, Choice(*KINDS)] = None,
    factor: Annotated[float, Range(0.01, 100.0)] = MORE,
    wetness: Annotated[float | None, Range(0.0, 1.0)] = None,
    snow_cover: Annotated[float | None, Range(0.0, 1.0)] = None,
) -> City:
    """Strengthen or weaken the weather there is, or say how wet and how snowed-over all is.

    Parameters
    ----------
    city
        City; nothing of it but the air changes.
    weather
        What there is to be more or less of; nothing when left out.
    factor
        How many times as much of it: fog twice as thick lets one see half as far.
    wetness
        0 for dry streets to 1 for a film of water.
    snow_cover
        0 for none to 1 for snow on all that faces up.
    """
    now = city.environment
    made = now if weather is None else _scaled(now, weather, factor)
    if wetness is not None:
        made = replace(made, wetness=wetness)
    if snow_cover is not None:
        made = replace(made, snow=snow_cover)
    if made == now:
        return replace(
            city, notes=(*city.notes, "Nothing of this changes the air; it is so already.")
        )
    return replace(city, environment=darkened(made))


def _scaled(now: Environment, weather: str, factor: float) -> Environment:
    """Return more or less of a kind of weather.

    Raises
    ------
    UsageError
        If there is none of it.
    """
    amount = {
        "fog": CLEAREST - now.visibility, "haze": CLEAREST - now.visibility, "rain": now.rain,
        "storm": now.rain, "snow": now.snowfall + now.snow, "clouds": now.cloud_cover,
    }[weather]  # fmt: skip
    if amount <= 0:
        raise UsageError(f"There is no {weather} to begin with; ask for {weather} first.")
    if weather in ("fog", "haze"):
        seen = min(max(now.visibility / factor, DENSEST), CLEAREST)
        return replace(now, visibility=round(seen, 3))
    if weather == "clouds":
        return replace(now, cloud_cover=min(now.cloud_cover * factor, 1.0))
    if weather == "snow":
        return replace(now, snowfall=now.snowfall * factor, snow=min(now.snow * factor, 1.0))
    rain = min(now.rain * factor, MOST_RAIN)
    wetness = min(max(now.wetness + WET * (rain - now.rain), 0.0), 1.0)
    wind = now.wind * factor if weather == "storm" else now.wind
    return replace(now, rain=rain, wetness=wetness, wind=wind)
