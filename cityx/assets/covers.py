"""Covers in the carriageway: manholes and street gullies at real size, flush with the asphalt."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType

import numpy as np

from cityx.assets.shapes import Color, box, lathe, prototype
from cityx.city.mesh import MeshBatch
from cityx.city.scene import Prototype

Shapes = list[MeshBatch]
IRON: Color = (0.75, 0.72, 0.70)
RIM: Color = (1.6, 1.6, 1.6)
DARK: Color = (0.2, 0.2, 0.2)
BURIED = -0.05  # metres
TOP = 0.008  # metres above the asphalt, so that it shows


def manhole() -> Shapes:
    """Round cover of 62 cm in a frame of concrete, with raised bars."""
    shapes: Shapes = [
        lathe([(0.40, BURIED), (0.40, TOP - 0.003), (0.0, TOP - 0.003)], "concrete", RIM, sides=20),
        lathe([(0.34, BURIED), (0.34, TOP), (0.0, TOP)], "metal_dark", IRON, sides=20),
    ]
    for y in np.linspace(-0.22, 0.22, 5):
        half = float(np.sqrt(0.29**2 - y**2))
        shapes.append(box((-half, y - 0.02, 0.0), (half, y + 0.02, TOP + 0.004), "metal_dark", IRON,
                          bottom=False))  # fmt: skip
    return shapes


def gully() -> Shapes:
    """Grate of 50 by 35 cm before the kerb, its bars across the flow."""
    shapes: Shapes = [box((-0.25, -0.175, BURIED), (0.25, 0.175, TOP - 0.006), "metal_dark", DARK)]
    for x in np.linspace(-0.235, 0.235, 9):
        shapes.append(box((x - 0.014, -0.175, 0.0), (x + 0.014, 0.175, TOP), "metal_dark", IRON,
                          bottom=False))  # fmt: skip
    for y in (-0.165, 0.145):
        shapes.append(box((-0.25, y, 0.0), (0.25, y + 0.02, TOP), "metal_dark", IRON, bottom=False))
    return shapes


MAKERS: Mapping[str, Callable[[], Shapes]] = MappingProxyType(
    {maker.__name__: maker for maker in (manhole, gully)}
)


def cover(name: str) -> Prototype:
    """Make one cover; `name` is a key of `MAKERS`."""
    return prototype(name, "street_cover", MAKERS[name]())
