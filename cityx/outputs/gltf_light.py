"""The sun of a city as glTF carries it: a directional light."""

from __future__ import annotations

from math import cos, degrees, exp, pi, sin
from typing import Any

from cityx.city.environment import Environment

EXTENSION = "KHR_lights_punctual"
# Illuminance of the sun before the air, and what one thickness of clear air takes (CIE 1989).
SOLAR_LUX, CLEAR_AIR = 128_000.0, 0.21
# glTF means lux, but most viewers take the number as it is beside an exposure of one: a light of pi
# makes a white surface white. The lux are in the extras.
LUX_TO_INTENSITY = pi / 100_000.0
_NOON, _LOW = (1.0, 0.96, 0.90), (1.0, 0.58, 0.30)  # linear colour of sunlight, high and at sunset


def illuminance_of(environment: Environment) -> float:
    """Return the illuminance of a surface that faces the sun, lux; 0 when it is down or hidden."""
    height = degrees(environment.sun_elevation)
    if height <= 0:
        return 0.0
    # Thickness of the air towards the sun, after Kasten and Young 1989.
    air = 1 / (sin(environment.sun_elevation) + 0.50572 * (height + 6.07995) ** -1.6364)
    return SOLAR_LUX * exp(-CLEAR_AIR * air) * (1 - environment.cloud_cover) ** 2


def sun_light(environment: Environment) -> dict[str, Any]:
    """Return the light as an item of the extension's list."""
    low = max(0.0, 1 - degrees(environment.sun_elevation) / 20.0)
    color = [round(a * (1 - low) + b * low, 4) for a, b in zip(_NOON, _LOW, strict=True)]
    lux = illuminance_of(environment)
    return {
        "name": "sun",
        "type": "directional",
        "color": color,
        "intensity": round(lux * LUX_TO_INTENSITY, 4),
        "extras": {"illuminance_lux": round(lux, 1)},
    }


def sun_rotation(environment: Environment) -> list[float]:
    """Return the quaternion (x, y, z, w) of a node, y up, that shines along its own -z."""
    half_turn = (pi - environment.sun_azimuth) / 2
    half_lift = environment.sun_elevation / 2
    sy, cy, sx, cx = sin(half_turn), cos(half_turn), sin(half_lift), cos(half_lift)
    return [round(value, 7) for value in (-cy * sx, sy * cx, sy * sx, cy * cx)]
