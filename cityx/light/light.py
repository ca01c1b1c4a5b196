"""How light follows from sun and weather: presets, lit windows, lamps, exposure."""

from __future__ import annotations

from dataclasses import astuple, dataclass, replace
from math import degrees, exp, log

import numpy as np

from cityx.city.environment import Environment
from cityx.system.tables import table


@dataclass(frozen=True)
class Weather:
    """One kind of weather; the fields are those of `Environment`.

    Attributes
    ----------
    cloud_cover, cloud_contrast, visibility, fog_height, wetness, snow, rain, snowfall, wind,
    sky_strength
        As in `Environment`.
    exposure
        Stops added to those of the sun.
    gloom
        0 to 1, how dark it is inside by day: how many rooms are lit of those lit at night.
    """

    cloud_cover: float = 0.0
    cloud_contrast: float = 0.0
    visibility: float = 40_000.0
    fog_height: float = 400.0
    wetness: float = 0.0
    snow: float = 0.0
    rain: float = 0.0
    snowfall: float = 0.0
    wind: float = 0.0
    sky_strength: float = 0.12
    exposure: float = 0.0
    gloom: float = 0.0


# Visibility after the meteorologists' classes: fog under 1 km, mist to 5 km, clear above 20 km.
# Radiation fog is some tens of metres deep; rain and snow dim the air up to the clouds.
PRESETS = table("light/weather", Weather)
LIGHTEST = 0.3  # strength of rain and snow from which the sky is as closed as in full
# Presets that are hours of the day too.
PRESET_TIMES = ("dawn", "dusk", "night")

# Share of rooms in use that are lit, by hour, if it is dark: people come home in the evening and
# sleep by midnight; offices empty at six; shops close at eight and leave some windows lit.
_HOMES = ((0, 0.26), (1, 0.14), (3, 0.06), (5, 0.08), (6, 0.22), (7, 0.34), (9, 0.25), (16, 0.28),
          (18, 0.44), (20, 0.46), (22, 0.42), (23.5, 0.32), (24, 0.26))  # fmt: skip
_WORK = ((0, 0.06), (5, 0.06), (7, 0.35), (9, 0.75), (17, 0.70), (19, 0.30), (21, 0.12), (24, 0.06))
_SHOPS = ((0, 0.45), (6, 0.45), (8, 0.90), (20, 0.90), (22, 0.60), (24, 0.45))
# Stops by degrees of the sun: most at the end of dusk, fewer once lamps take over from the sky.
_STOPS = ((-7.0, 3.6), (-3.0, 5.3), (0.0, 2.6), (6.0, 1.4), (20.0, 0.2), (30.0, 0.0))
DAYLIGHT, DARK = 5.0, -4.0  # degrees of the sun at which the first and all such rooms are lit
LAMPS_ON = -0.5  # degrees of the sun at which street lamps go on; EN 13201 asks for about 35 lx
GLOOMY_LAMPS_ON = 10.0  # the same under the darkest clouds


def mixed(first: Weather, second: Weather, share: float) -> Weather:
    """Return weather between two kinds: `share` 0 is the first, 1 the second."""
    values = [a + (b - a) * share for a, b in zip(astuple(first), astuple(second), strict=True)]
    made = Weather(*values)
    # What the eye sees of air is its density, which spans three powers of ten.
    between = exp(log(first.visibility) * (1 - share) + log(second.visibility) * share)
    return replace(made, visibility=round(between, 3))


def weather_row(name: str, strength: float) -> Weather:
    """Return the numbers of a preset at a strength, 0 for clear to 1."""
    preset = PRESETS.get(name, PRESETS["clear"])
    made = mixed(PRESETS["clear"], preset, strength)
    if not (preset.rain or preset.snowfall):
        return made
    return replace(made, cloud_cover=preset.cloud_cover * min(strength / LIGHTEST, 1.0))


def darkness_of(elevation: float) -> float:
    """Return how dark rooms are by the sun's elevation (radians): 0 by day, 1 at night."""
    t = min(max((DAYLIGHT - degrees(elevation)) / (DAYLIGHT - DARK), 0.0), 1.0)
    return t * t * (3 - 2 * t)


def lights_of(elevation: float, hour: float, gloom: float = 0.0) -> tuple[float, float, float]:
    """Return the shares of lit windows in homes, at work and of shopfronts.

    Parameters
    ----------
    elevation
        Of the sun, radians.
    hour
        Local solar time.
    gloom
        0 to 1, how dark the weather makes it inside by day.
    """
    dark = darkness_of(elevation)
    needs = (max(dark, gloom), max(dark, gloom), max(dark, min(1.0, 2 * gloom)))
    home, work, shop = (
        round(float(np.interp(hour, *np.array(table, float).T)) * need, 4)
        for table, need in zip((_HOMES, _WORK, _SHOPS), needs, strict=True)
    )
    return home, work, shop


def exposure_of(elevation: float) -> float:
    """Return the stops a camera opens when the sun is low or gone."""
    return round(float(np.interp(degrees(elevation), *np.array(_STOPS).T)), 4)


def darkened(environment: Environment) -> Environment:
    """Return the environment with exposure, lit windows and lamps for its sun and its weather."""
    row = weather_row(environment.weather, environment.strength)
    elevation = environment.sun_elevation
    home, work, shop = lights_of(elevation, environment.hour, row.gloom)
    on = LAMPS_ON + (GLOOMY_LAMPS_ON - LAMPS_ON) * row.gloom
    return replace(
        environment,
        night_lights=home,
        work_lights=work,
        shop_lights=shop,
        lamps=float(degrees(elevation) < on),
        exposure=round(exposure_of(elevation) + row.exposure, 4),
    )
