"""Conditions: single numbers of the air over those of the weather, and how many rooms are lit."""

from __future__ import annotations

from dataclasses import replace
from math import pi, radians
from typing import Annotated, Any

from cityx.city import City
from cityx.geometry.turns import SIDES
from cityx.protocol import Choice, Port, Range, Serves, action

ACTION = "background/conditions-v1"
ASKED = (
    "visibility", "cloud", "wetness", "snow_cover", "wind", "wind_from", "moon", "windows",
)  # fmt: skip
TURNED = {name: radians(45.0 * k) for k, name in enumerate(
    ("north", "northeast", "east", "southeast", "south", "southwest", "west", "northwest")
)}  # fmt: skip


@action(
    ACTION,
    limits=["Another time or weather sets lit windows, clouds and all else anew."],
    requires=("layout",),
    after=("background/sun-v1", "background/weather-v1"),
    takes=(Port("environment", "scene_layout", role="weather"),),
    gives=(Port("environment", "scene_layout", role="conditions"),),
    serves=tuple(Serves(f"air.{name}", "!edit=set_lights") for name in ASKED),
    binds={name: f"air.{name}" for name in ASKED},
    labels=("visibility", "wind", "moon", "lit windows", "wet streets", "cloud cover"),
)
def conditions(
    city: City,
    *,
    visibility: Annotated[float | None, Range(5.0, 100_000.0)] = None,
    cloud: Annotated[float | None, Range(0.0, 1.0)] = None,
    wetness: Annotated[float | None, Range(0.0, 1.0)] = None,
    snow_cover: Annotated[float | None, Range(0.0, 1.0)] = None,
    rain: Annotated[float | None, Range(0.0, 120.0)] = None,
    snowfall: Annotated[float | None, Range(0.0, 20.0)] = None,
    wind: Annotated[float | None, Range(0.0, 60.0)] = None,
    wind_from: Annotated[str | None, Choice(*SIDES)] = None,
    moon: Annotated[float | None, Range(0.0, 1.0)] = None,
    windows: Annotated[float | None, Range(0.0, 1.0)] = None,
) -> City:
    """Set how far one sees, how wet and snowed-over all is, the wind, the moon and lit windows.

    Parameters
    ----------
    city
        City; nothing of it but the air changes, and what is left out stays.
    visibility
        Metres at which contrast falls to 2 %.
    cloud
        Share of the sky that is covered.
    wetness
        0 for dry streets to 1 for a film of water.
    snow_cover
        0 for none to 1 for snow on all that faces up.
    rain, snowfall
        What falls, mm of water per hour.
    wind
        Metres per second.
    wind_from
        Where it comes from.
    moon
        How much of the moon is lit: 0 for none to 1 for a full one.
    windows
        Share of all rooms that are lit.
    """
    asked = {
        "visibility": visibility, "cloud_cover": cloud, "wetness": wetness, "snow": snow_cover,
        "rain": rain, "snowfall": snowfall, "wind": wind, "moon": moon,
        **dict.fromkeys(("night_lights", "work_lights", "shop_lights"), windows),
    }  # fmt: skip
    told: dict[str, Any] = {name: value for name, value in asked.items() if value is not None}
    if wind_from is not None:
        told["wind_from"] = round(TURNED[wind_from.replace("_", "")] % (2 * pi), 6)
    return replace(city, environment=replace(city.environment, **told),
                   stages_done=city.stages_done | {"background"})  # fmt: skip
