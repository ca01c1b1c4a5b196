"""What the makers of street furniture share: colours, posts, how deep things reach."""

from __future__ import annotations

from cityx.assets.shapes import Color, cylinder
from cityx.city.mesh import MeshBatch

Shapes = list[MeshBatch]
BURIED = -0.15  # metres below ground to which posts reach, against gaps on slopes

RED: Color = (0.80, 0.05, 0.04)
YELLOW: Color = (1.00, 0.72, 0.06)
BLUE: Color = (0.04, 0.16, 0.55)
GREEN: Color = (0.05, 0.26, 0.10)
DARK: Color = (0.06, 0.065, 0.07)
GREY: Color = (0.45, 0.46, 0.47)
STONE: Color = (0.95, 0.93, 0.88)
PALE: Color = (0.9, 0.9, 0.88)


def post(height: float, radius: float = 0.03, material: str = "metal_grey",
         *, x: float = 0.0, y: float = 0.0, sides: int = 6) -> MeshBatch:  # fmt: skip
    """Make a round post that stands in the ground."""
    return cylinder((x, y, BURIED), (x, y, height), radius, material, sides=sides,
                    caps=(False, True))  # fmt: skip
