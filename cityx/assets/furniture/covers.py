"""Covers in carriageways and walks, at real size and flush with what they lie in."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType

import numpy as np

from cityx.assets.shapes import Color, box, lathe, prototype
from cityx.city.mesh import MeshBatch
from cityx.city.scene import Prototype

Shapes = list[MeshBatch]
IRON: Color = (0.75, 0.72, 0.70)
RIM: Color = (0.42, 0.41, 0.40)
DARK: Color = (0.2, 0.2, 0.2)
BURIED = -0.05  # metres
SLAB: Color = (0.52, 0.50, 0.47)
COLLAR: Color = (0.60, 0.58, 0.56)
WALK_TOP = 0.006  # metres above a walk
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


def inspection_cover() -> Shapes:
    """Cover of 60 by 45 cm in two leaves, of ribbed iron, for cables under a walk."""
    shapes: Shapes = [
        box(
            (-0.33, -0.25, BURIED), (0.33, 0.25, WALK_TOP - 0.003), "concrete", COLLAR, bottom=False
        )
    ]
    for x in (-0.152, 0.152):
        shapes.append(box((x - 0.146, -0.22, 0.0), (x + 0.146, 0.22, WALK_TOP), "metal_dark", IRON,
                          bottom=False))  # fmt: skip
        for y in (-0.14, 0.0, 0.14):
            shapes.append(box((x - 0.12, y - 0.012, 0.0), (x + 0.12, y + 0.012, WALK_TOP + 0.003),
                              "metal_dark", IRON, bottom=False))  # fmt: skip
    return shapes


def recessed_cover() -> Shapes:
    """Frame of steel, 62 cm square, filled with a slab as the walk about it."""
    shapes: Shapes = [
        box((-0.29, -0.29, BURIED), (0.29, 0.29, WALK_TOP - 0.002), "concrete", SLAB, bottom=False)
    ]
    for a, b in ((-0.31, -0.29), (0.29, 0.31)):
        shapes.append(box((a, -0.31, 0.0), (b, 0.31, WALK_TOP), "metal_grey", bottom=False))
        shapes.append(box((-0.29, a, 0.0), (0.29, b, WALK_TOP), "metal_grey", bottom=False))
    return shapes


def stop_tap() -> Shapes:
    """Lid of 16 cm over the tap of a water pipe, in a collar of concrete."""
    return [
        box((-0.14, -0.14, BURIED), (0.14, 0.14, WALK_TOP - 0.003), "concrete", COLLAR,
            bottom=False),
        lathe([(0.08, BURIED), (0.08, WALK_TOP), (0.0, WALK_TOP)], "metal_dark", IRON, sides=10),
        box((-0.05, -0.008, 0.0), (0.05, 0.008, WALK_TOP + 0.003), "metal_dark", IRON,
            bottom=False),
    ]  # fmt: skip


def walk_patch() -> Shapes:
    """Strip of 88 by 55 cm in which slabs gave way to asphalt, after somebody dug there."""
    size = (0.44, 0.275)
    return [box((-size[0], -size[1], BURIED), (*size, WALK_TOP - 0.002), "asphalt", bottom=False)]


MAKERS: Mapping[str, Callable[[], Shapes]] = MappingProxyType(
    {
        maker.__name__: maker
        for maker in (manhole, gully, inspection_cover, recessed_cover, stop_tap, walk_patch)
    }
)


def cover(name: str) -> Prototype:
    """Make one cover; `name` is a key of `MAKERS`."""
    return prototype(name, "street_cover", MAKERS[name]())
