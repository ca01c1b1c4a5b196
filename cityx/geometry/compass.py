"""The compass: words of sides, and the ways there."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

# Word of a side -> the way there, east and north.
SIDES: Mapping[str, tuple[float, float]] = MappingProxyType(
    {
        "north": (0.0, 1.0), "east": (1.0, 0.0), "south": (0.0, -1.0), "west": (-1.0, 0.0),
        "northeast": (1.0, 1.0), "southeast": (1.0, -1.0),
        "southwest": (-1.0, -1.0), "northwest": (-1.0, 1.0),
    }
)  # fmt: skip
