"""The weather: each preset is a row of numbers."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated

from cityx.city import City, Environment
from cityx.errors import UsageError, nearest
from cityx.plugins.background.light import PRESETS, darkened
from cityx.protocol import Port, Text, action

WEATHERS = tuple(PRESETS)
_OTHER = {
    "sunny": "clear", "sun": "clear", "fair": "clear", "clouds": "cloudy", "grey": "overcast",
    "gray": "overcast", "foggy": "fog", "mist": "fog", "misty": "fog", "hazy": "haze",
    "rainy": "rain", "wet": "rain", "stormy": "storm", "thunderstorm": "storm", "snowy": "snow",
    "winter": "snow",
}  # fmt: skip


def weather_named(word: str) -> str:
    """Return the preset a word means.

    Raises
    ------
    UsageError
        If there is none; the message names the nearest.
    """
    name = word.strip().lower()
    name = _OTHER.get(name, name)
    if name not in PRESETS:
        raise UsageError(
            f'"{word}" is no weather; one of {", ".join(WEATHERS)}.{nearest(name, WEATHERS)}'
        )
    return name


def weather_of(environment: Environment, preset: str) -> Environment:
    """Return the environment under a preset; the sun stays where it is."""
    name = weather_named(preset)
    row = PRESETS[name]
    return darkened(
        replace(
            environment,
            weather=name,
            cloud_cover=row.cloud_cover,
            visibility=row.visibility,
            wetness=row.wetness,
            snow=row.snow,
            rain=row.rain,
            sky_strength=row.sky_strength,
        )
    )


@action(
    "background/weather-v1",
    limits=["Trees lose their leaves for snow only if they are planted after it."],
    requires=("layout",),
    gives=(Port("environment", "scene_layout", role="weather"),),
    labels=("sky", "rain", "fog", "snow", "clouds"),
)
def weather(city: City, *, preset: Annotated[str, Text(20)] = "clear") -> City:
    """Set sky, visibility, wetness and snow from a preset.

    Parameters
    ----------
    city
        The city.
    preset
        One of clear, cloudy, overcast, haze, fog, rain, storm, snow, or a common word for one.
    """
    return replace(
        city,
        environment=weather_of(city.environment, preset),
        stages_done=city.stages_done | {"background"},
    )
