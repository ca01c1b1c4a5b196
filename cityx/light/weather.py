"""The weather: each preset is a row of numbers, and there is weather between two rows."""

from __future__ import annotations

from dataclasses import asdict, replace
from typing import Annotated

from cityx.city import City, Environment
from cityx.errors import UsageError, nearest
from cityx.light.light import PRESET_TIMES, PRESETS, darkened, weather_row
from cityx.light.sun import sun_of
from cityx.protocol import Port, Range, Serves, Text, action

WEATHERS = tuple(PRESETS)
_OTHER = {
    "sunny": "clear", "sun": "clear", "fair": "clear", "clouds": "cloudy", "grey": "overcast",
    "gray": "overcast", "foggy": "fog", "mist": "fog", "misty": "fog", "hazy": "haze",
    "rainy": "rain", "wet": "rain", "stormy": "storm", "thunderstorm": "storm", "snowy": "snow",
    "winter": "snow", "sunrise": "dawn", "sunset": "dusk", "twilight": "dusk", "nighttime": "night",
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


def weather_words(text: str) -> tuple[str, str]:
    """Read "storm", "dusk" or "snow night" as a preset and a time; the time may be empty.

    Raises
    ------
    UsageError
        If a word is no weather, or two words name two kinds of weather or two times.
    """
    names = [weather_named(word) for word in text.replace("+", " ").replace(",", " ").split()]
    kinds = [name for name in names if name not in PRESET_TIMES]
    times = [name for name in names if name in PRESET_TIMES]
    if not names or len(kinds) > 1 or len(times) > 1:
        raise UsageError(
            f'"{text}" is not one weather and at most one time; one of {", ".join(WEATHERS)}.'
        )
    return (kinds or times)[0], times[0] if times else ""


def weather_of(environment: Environment, preset: str, strength: float = 1.0) -> Environment:
    """Return the environment under a preset; the sun stays where it is.

    Parameters
    ----------
    environment
        Its sun and hour stay.
    preset
        As of `weather_named`.
    strength
        0 for clear air to 1 for the preset in full.
    """
    name = weather_named(preset)
    row = asdict(weather_row(name, strength))
    del row["gloom"], row["exposure"]
    return darkened(replace(environment, weather=name, strength=strength, **row))


def lit_anew(
    environment: Environment, latitude: float, longitude: float, *, weather: str = "",
    time: str = "", strength: float = 1.0,
) -> Environment:  # fmt: skip
    """Return the environment under another weather, at another time, or both.

    Parameters
    ----------
    environment
        What holds where `weather` and `time` are silent.
    latitude, longitude
        Of the city, degrees.
    weather
        One or two words, such as "snow" or "storm dusk", or "".
    time
        Word, "HH:MM" or date and time, or ""; it goes before a time among the words of the
        weather.
    strength
        0 to 1, of the weather.

    Raises
    ------
    UsageError
        If a word is not known.
    """
    name, word = weather_words(weather) if weather else (environment.weather, "")
    if weather:
        environment = weather_of(environment, name, strength)
    if time or word:
        environment = sun_of(environment, latitude, longitude, time=time or word,
                             date=environment.date)  # fmt: skip
    return environment


@action(
    "background/weather-v1",
    limits=["Trees lose their leaves for snow only if they are planted after it."],
    requires=("layout",),
    after=("background/sun-v1",),
    gives=(Port("environment", "scene_layout", role="weather"),),
    serves=(Serves("edit=set_weather", "weather"),),
    binds={"preset": "weather"},
    labels=("sky", "rain", "fog", "snow", "clouds", "storm", "night"),
)
def weather(
    city: City,
    *,
    preset: Annotated[str, Text(30)] = "clear",
    strength: Annotated[float, Range(0.0, 1.0)] = 1.0,
) -> City:
    """Set sky, visibility, wetness, snow and what falls from a preset.

    Parameters
    ----------
    city
        The city.
    preset
        One of clear, cloudy, overcast, haze, fog, rain, storm, snow, dawn, dusk, night, or a common
        word for one; a weather and a time may be joined, as in "storm dusk".
    strength
        0 for clear air to 1 for the preset in full.
    """
    frame = city.frame
    environment = lit_anew(city.environment, frame.latitude, frame.longitude, weather=preset,
                           strength=strength)  # fmt: skip
    return replace(city, environment=environment, stages_done=city.stages_done | {"background"})
