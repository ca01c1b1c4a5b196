"""Sun, sky and weather."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Environment:
    """The light and air of a city, engine-neutral.

    Attributes
    ----------
    sun_elevation, sun_azimuth
        Radians; azimuth clockwise from north. Elevation may be negative (night).
    day
        Day of the year, 1 to 366; the leaves of trees follow it.
    weather
        Name of the preset the numbers came from.
    cloud_cover
        Share of the sky covered, 0 to 1.
    visibility
        Metres at which contrast falls to 2 %.
    wetness, snow
        0 to 1, how wet or snowed-over surfaces are.
    rain
        Rain rate, mm per hour.
    night_lights
        Share of windows lit, 0 to 1; above 0 lamps are on.
    sky_strength
        Factor on the physical sky, so that a middle exposure suits the scene.
    exposure
        Stops added at the camera.
    """

    sun_elevation: float = 0.698
    sun_azimuth: float = 3.491
    weather: str = "clear"
    cloud_cover: float = 0.0
    visibility: float = 40_000.0
    wetness: float = 0.0
    snow: float = 0.0
    rain: float = 0.0
    night_lights: float = 0.0
    sky_strength: float = 0.12
    exposure: float = 0.0
    day: int = 172
