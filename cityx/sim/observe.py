"""Observations: presets of vectors as data, with name, unit and scale of every field."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class Field:
    """A run of numbers of an observation.

    Attributes
    ----------
    name, size
        What it is, and how many numbers.
    meaning
        With unit, scale and frame; own frames have x ahead and y to the left.
    """

    name: str
    size: int
    meaning: str


@dataclass(frozen=True)
class Preset:
    """A vector of observations.

    Attributes
    ----------
    name
        By which it is chosen.
    number
        Of the kernel.
    low, high
        Bounds of every number.
    fields
        In order.
    """

    name: str
    number: int
    low: float
    high: float
    fields: tuple[Field, ...]

    @property
    def size(self) -> int:
        """How many numbers."""
        return sum(field.size for field in self.fields)

    def part(self, view: NDArray[np.float32], name: str) -> NDArray[np.float32]:
        """Return one field of observations, (..., size)."""
        at = 0
        for field in self.fields:
            if field.name == name:
                return view[..., at : at + field.size]
            at += field.size
        raise KeyError(name)


_STATE = (
    Field("speed", 1, "m/s / 30"),
    Field("steer", 1, "angle of the front wheels / the greatest; left is positive"),
    Field("aside", 1, "metres to the left of the route / 5"),
    Field("turned", 1, "sine of the angle to the route"),
    Field("limit", 1, "m/s that may be driven here / 30"),
    Field("signal", 1, "of the next way across a junction: 1 stop, 0 go, -1 no signal"),
    Field("line", 1, "metres to that way / 50"),
    Field("yield", 1, "1 if somebody it gives way to is on, or before, a way that crosses it"),
    Field("ahead", 20, "x, y / 60 m of the route 1, 3, 6, 10, 15, 21, 28, 37, 47, 58 m ahead"),
    Field("neighbours", 56, "the 8 nearest bodies within 50 m: x, y / 50 m, cosine and sine of the "
          "heading, m/s / 30, length / 20 m, width / 5 m; zeros where there are fewer"),
    Field("goal", 3, "x, y / 200 m, and metres of route left / those asked for"),
)  # fmt: skip
_METADRIVE = (
    Field("sides", 2, "metres from the left and the right edge of a road of two lanes / 16"),
    Field("turned", 1, "angle to the route, half a turn left 1, right 0"),
    Field("speed", 1, "(km/h + 1) / 81"),
    Field("steer", 1, "angle of the front wheels, 0 to 1"),
    Field("last_action", 2, "steer and pedals of the last step, 0 to 1"),
    Field("yaw_rate", 1, "radians per second, without sign"),
    Field("aside", 1, "metres to the left of the route, 5 m left 1, right 0"),
    Field("checkpoints", 10, "places 30 and 60 m ahead on the route: x, y, radius of the piece / "
          "60 m, clockwise, angle of the piece"),
    Field("rays", 240, "metres that are free / 50, the first straight ahead, then clockwise"),
)  # fmt: skip
_PUFFER = (
    Field("goal", 2, "x, y x 0.005 per metre"),
    Field("speed", 1, "m/s x 0.01"),
    Field("size", 2, "width / 15 m, length / 30 m"),
    Field("flags", 2, "collided and begun anew; 0, since such an episode ends here"),
    Field("partners", 441, "63 bodies within 50 m: x, y x 0.02, width / 15 m, length / 30 m, "
          "cosine and sine of the heading, m/s / 100"),
    Field("roads", 1400, "200 segments, nearer cells of 16 m first: middle x, y x 0.02, half "
          "length / 100 m, width / 100 m, cosine and sine of the direction, type (0 line of a "
          "lane, 2 side of something solid)"),
)  # fmt: skip

PRESETS: Mapping[str, Preset] = MappingProxyType(
    {
        "state": Preset("state", 0, -1.0, 1.0, _STATE),
        "metadrive": Preset("metadrive", 1, 0.0, 1.0, _METADRIVE),
        "puffer": Preset("puffer", 2, -100.0, 100.0, _PUFFER),
    }
)

_SELF = (
    Field("speed", 1, "m/s / the fastest"),
    Field("yaw_rate", 1, "radians per second / 3, left is positive"),
    Field("aside", 1, "metres to the left of the route / 5; 0 without one"),
    Field("turned", 2, "sine and cosine of the angle to the route; 0 without one"),
    Field("light", 1, "of the next crosswalk: 1 stop, 0 go, -1 no signal"),
    Field("crossing", 1, "metres to it / 20; 1 where there is none"),
    Field("on_crossing", 1, "1 on the roadway"),
    Field("busy", 1, "1 if a signal or a vehicle that comes forbids to step onto it"),
    Field("ground", 24, "metres along which it fits / 8, the first straight ahead, then clockwise"),
    Field("neighbours", 56, "the 8 nearest bodies within 25 m: x, y / 25 m, cosine and sine of the "
          "heading, m/s / 15, length / 20 m, width / 5 m; zeros where there are fewer"),
)  # fmt: skip
_WALK = (
    *_SELF,
    Field("ahead", 20, "x, y / 20 m of the route 0.5, 1, 2, 3, 4.5, 6, 8, 10, 13, 16 m ahead"),
    Field("goal", 3, "x, y / 200 m, and metres of route left / its length"),
)
_EXPLORE = (
    *_SELF,
    Field("explored", 49, "1 for each square of 4 m about that is explored, from the south-west"),
    Field("found", 1, "squares found / those asked for"),
)
_FLY = (
    Field("velocity", 3, "ahead, left and up, m/s / 8"),
    Field("yaw_rate", 1, "radians per second / 1.5"),
    Field("above", 1, "metres above what is below / 50"),
    Field("goal", 4, "ahead, left and up, metres / 200, and the straight way there / 400"),
    Field("tops", 60, "metres above what is there / 30, in 12 directions, the first ahead, then "
          "clockwise, each 3, 6, 12, 20 and 30 m away"),
)  # fmt: skip
WALKING: Mapping[str, Preset] = MappingProxyType(
    {
        "walk": Preset("walk", 3, -1.0, 1.0, _WALK),
        "explore": Preset("explore", 4, -1.0, 1.0, _EXPLORE),
    }
)
FLYING: Mapping[str, Preset] = MappingProxyType({"fly": Preset("fly", 5, -1.0, 1.0, _FLY)})
