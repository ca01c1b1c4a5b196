"""Things in yards: sheds, bin stores, dryers, vegetable beds.

Each maker is named for a prototype and returns its shapes: z up, front -y (away from the wall),
origin on the ground at the foot.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType

import numpy as np

from cityx.assets.furniture.furniture_parts import BLUE, BURIED, DARK, Shapes, post
from cityx.assets.furniture.street_pieces import leaf_mound
from cityx.assets.shapes import Color, box, moved, prism, tube

TIMBER: Color = (0.85, 0.80, 0.72)
BROWN: Color = (0.25, 0.16, 0.08)
WASHING: tuple[Color, ...] = (
    (0.75, 0.74, 0.70), (0.20, 0.28, 0.45), (0.62, 0.20, 0.18), (0.70, 0.62, 0.35),
)  # fmt: skip


def garden_shed() -> Shapes:
    """Timber shed, 2.2 m by 1.6 m, under a felted roof."""
    gable = [(-1.1, BURIED), (1.1, BURIED), (1.1, 1.85), (0.0, 2.31), (-1.1, 1.85)]
    parts: Shapes = [prism(gable, -0.8, 0.8, "bench_wood", TIMBER)]
    for side in (-1, 1):
        slope = [(0.0, 2.31), (1.25 * side, 1.79), (1.25 * side, 1.86), (0.0, 2.38)]
        parts.append(prism(slope[::-side], -0.95, 0.95, "bitumen", (0.5, 0.5, 0.5)))
    parts += [
        box((-0.42, -0.83, 0.06), (0.42, -0.8, 1.78), "bench_wood", (0.6, 0.55, 0.5)),
        box((0.30, -0.85, 0.85), (0.35, -0.83, 1.0), "metal_dark"),
        box((0.58, -0.82, 1.05), (0.98, -0.8, 1.45), "glass"),
    ]
    return parts


def bin_store() -> Shapes:
    """Three bins on wheels behind a screen of slats, 2.2 m wide, open to the front."""
    parts: Shapes = []
    for x in (-1.1, 1.1):
        for y in (-0.45, 0.4):
            parts.append(box((x - 0.04, y - 0.04, BURIED), (x + 0.04, y + 0.04, 1.3), "bench_wood"))
        for z in np.arange(0.1, 1.25, 0.16):
            parts.append(box((x - 0.015, -0.42, z), (x + 0.015, 0.4, z + 0.11), "bench_wood"))
    for z in np.arange(0.1, 1.25, 0.16):
        parts.append(box((-1.08, 0.42, z), (1.08, 0.45, z + 0.11), "bench_wood"))
    for x, lid in ((-0.72, BLUE), (0.0, BROWN), (0.72, (0.65, 0.5, 0.05))):
        parts.append(box((x - 0.26, -0.3, 0.04), (x + 0.26, 0.3, 0.98), "plastic", DARK))
        parts.append(box((x - 0.28, -0.33, 0.98), (x + 0.28, 0.32, 1.05), "plastic", lid))
    return parts


def clothes_dryer() -> Shapes:
    """Rotary dryer of four arms with some washing."""
    parts: Shapes = [post(1.95, 0.025, "metal_grey")]
    for number in range(4):
        turn = np.pi / 2 * number + 0.4
        c, s = np.cos(turn), np.sin(turn)
        parts.append(tube([[0, 0, 1.45], [1.3 * c, 1.3 * s, 1.9]], 0.012, "metal_grey", sides=4))
        d, e = np.cos(turn + np.pi / 2), np.sin(turn + np.pi / 2)
        for reach in (0.6, 0.95, 1.25):
            z = 1.45 + 0.35 * reach
            ends = [[reach * c, reach * s, z], [reach * d, reach * e, z]]
            parts.append(tube(ends, 0.003, "metal_grey", sides=3))
        sheet = box((-0.3, -0.006, -0.7), (0.3, 0.006, 0.0), "cloth", WASHING[number])
        middle = 0.5 * 1.25 * np.array([c + d, s + e])
        parts.append(moved(sheet, (middle[0], middle[1], 1.88), yaw=turn + 3 * np.pi / 4))
    return parts


def vegetable_bed() -> Shapes:
    """Bed of boards, raised, 2.4 m long, with three rows of greens."""
    parts: Shapes = [box((-1.15, -0.5, BURIED), (1.15, 0.5, 0.30), "soil")]
    for y in (-0.53, 0.53):
        parts.append(box((-1.2, y - 0.03, BURIED), (1.2, y + 0.03, 0.36), "bench_wood"))
    for x in (-1.17, 1.17):
        parts.append(box((x - 0.03, -0.5, BURIED), (x + 0.03, 0.5, 0.36), "bench_wood"))
    for row, (y, high) in enumerate(((-0.3, 0.18), (0.0, 0.42), (0.3, 0.28))):
        parts.append(leaf_mound(f"vegetables {row}", (-1.05, y - 0.12, 0.28),
                                (1.05, y + 0.12, 0.30 + high), 130, size=0.06))  # fmt: skip
    return parts


YARD_MAKERS: Mapping[str, Callable[[], Shapes]] = MappingProxyType(
    {maker.__name__: maker for maker in (garden_shed, bin_store, clothes_dryer, vegetable_bed)}
)
