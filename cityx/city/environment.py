"""Sun, sky, weather and lights."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import date as calendar

OPENING = (8.0, 20.0)  # hours between which shops are open by day
AFTER_DARK = 0.5  # share of the light in shops that is left to see once lamps are on


@dataclass(frozen=True)
class Environment:
    """The light and air of a city, engine-neutral.

    Attributes
    ----------
    sun_elevation, sun_azimuth
        Radians; azimuth clockwise from north. Elevation may be negative (night).
    date, hour
        Day as YYYY-MM-DD and local mean solar time in hours; people light their rooms by it.
    weather, strength
        Name of the preset the numbers came from, and how much of it there is, 0 to 1.
    cloud_cover
        Share of the sky covered, 0 to 1.
    cloud_contrast
        0 to 1, how much a closed cloud layer varies in brightness.
    visibility
        Metres at which contrast falls to 2 %.
    fog_height
        Metres over which fog thins out to a third above the ground.
    wetness, snow
        0 to 1, how wet or snowed-over surfaces are.
    rain, snowfall
        What falls, mm of water per hour.
    wind
        Metres per second, which slants rain and drives flakes.
    wind_from
        Radians clockwise from north, of where the wind comes from.
    moon
        How much of the moon is lit, 0 for none to 1 for a full one.
    night_lights, work_lights, shop_lights
        Share of windows lit in homes and at work, and of shopfronts, 0 to 1.
    lamps
        0 or 1, whether street lamps are on.
    sky_strength
        Factor on the physical sky, so that a middle exposure suits the scene.
    exposure
        Stops added at the camera.
    """

    sun_elevation: float = 0.698
    sun_azimuth: float = 3.491
    date: str = ""
    hour: float = 15.0
    weather: str = "clear"
    strength: float = 1.0
    cloud_cover: float = 0.0
    cloud_contrast: float = 0.0
    visibility: float = 40_000.0
    fog_height: float = 400.0
    wetness: float = 0.0
    snow: float = 0.0
    rain: float = 0.0
    snowfall: float = 0.0
    wind: float = 0.0
    night_lights: float = 0.0
    work_lights: float = 0.0
    shop_lights: float = 0.0
    lamps: float = 0.0
    sky_strength: float = 0.12
    exposure: float = 0.0
    wind_from: float = 4.712389
    moon: float = 1.0

    @property
    def day(self) -> int:
        """Day of the year, 1 to 366, that of midsummer without a date; leaves follow it."""
        day = calendar.fromisoformat(self.date) if self.date else calendar(2025, 6, 21)
        return day.timetuple().tm_yday

    @property
    def rooms_lit(self) -> tuple[float, float, float]:
        """Shares of windows lit by use of the room: homes, work, shops."""
        return self.night_lights, self.work_lights, self.shop_lights

    @property
    def shop_glow(self) -> float:
        """Brightness of the rooms of shops, as a share of that of an open shop by day.

        Under lamps cameras open by some stops, so that less of it looks as bright.
        """
        if self.lamps > 0:
            return AFTER_DARK * self.shop_lights
        return 1.0 if OPENING[0] <= self.hour < OPENING[1] else 0.0
