"""How light follows from sun and weather: presets, lit windows, exposure."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from math import degrees
from types import MappingProxyType

from cityx.city.environment import Environment


@dataclass(frozen=True)
class Weather:
    """One kind of weather; the fields are those of `Environment`.

    Attributes
    ----------
    cloud_cover, visibility, wetness, snow, rain, sky_strength
        As in `Environment`.
    exposure
        Stops added to those of the sun.
    lights
        Share of windows lit by day because it is dark inside.
    """

    cloud_cover: float
    visibility: float
    wetness: float
    snow: float
    rain: float
    sky_strength: float
    exposure: float
    lights: float


# Visibility after the meteorologists' classes: fog under 1 km, mist to 5 km, clear above 20 km.
PRESETS: Mapping[str, Weather] = MappingProxyType(
    {
        "clear": Weather(0.0, 40_000.0, 0.0, 0.0, 0.0, 0.12, 0.0, 0.0),
        "cloudy": Weather(0.45, 30_000.0, 0.0, 0.0, 0.0, 0.12, 0.05, 0.0),
        "overcast": Weather(1.0, 15_000.0, 0.0, 0.0, 0.0, 0.11, 0.5, 0.03),
        "haze": Weather(0.15, 6_000.0, 0.0, 0.0, 0.0, 0.12, 0.1, 0.0),
        "fog": Weather(0.9, 350.0, 0.25, 0.0, 0.0, 0.11, 0.4, 0.10),
        "rain": Weather(1.0, 5_000.0, 0.85, 0.0, 4.0, 0.10, 0.6, 0.10),
        "storm": Weather(1.0, 2_500.0, 1.0, 0.0, 25.0, 0.07, 0.8, 0.20),
        "snow": Weather(0.95, 3_000.0, 0.15, 0.85, 0.0, 0.11, 0.1, 0.08),
    }
)


def night_lights_of(elevation: float) -> float:
    """Return the share of lit windows by the sun's elevation (radians), 0 by day."""
    h = degrees(elevation)
    if h >= 3.0:
        return 0.0
    return round(min(0.38, 0.38 * (3.0 - h) / 9.0), 4)


def exposure_of(elevation: float) -> float:
    """Return the stops a camera opens when the sun is low or gone."""
    h = degrees(elevation)
    if h >= 20.0:
        return 0.0
    if h >= 0.0:
        return round(0.9 * (20.0 - h) / 20.0, 4)
    return round(min(0.9 + 0.35 * -h, 3.2), 4)


def darkened(environment: Environment) -> Environment:
    """Return the environment with exposure and lit windows for its sun and its weather."""
    preset = PRESETS.get(environment.weather, PRESETS["clear"])
    elevation = environment.sun_elevation
    return replace(
        environment,
        night_lights=max(night_lights_of(elevation), preset.lights),
        exposure=round(exposure_of(elevation) + preset.exposure, 4),
    )
