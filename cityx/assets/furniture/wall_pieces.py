"""Things at the walls of narrow walks and in yards: troughs, meters, crates, sheds, bin stores.

Each maker is named for a prototype and returns its shapes: z up, front -y (away from the wall),
origin on the ground at the foot. None is deeper than 0.4 m; baskets hang over heads, and covers
lie in the walk.

Each maker is named for a prototype and returns its shapes: z up, front -y (away from the wall),
origin on the ground at the foot.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType

import numpy as np

from cityx.assets.furniture.furniture_parts import (
    BLUE,
    BURIED,
    DARK,
    GREY,
    PALE,
    RED,
    YELLOW,
    Shapes,
    post,
)
from cityx.assets.furniture.potted_plants import GLAZE, ivy, net_of_vines, pot, slim_tree, trough
from cityx.assets.furniture.potted_plants import PALE as POTTERY
from cityx.assets.furniture.street_pieces import leaf_mound
from cityx.assets.shapes import Color, box, cylinder, moved, prism, tinted, tube

TERRACOTTA: Color = (0.55, 0.22, 0.12)
BLOSSOM: Color = (2.2, 0.6, 1.1)
# Metres from the wall to the middle of each, and half its length.
GAPS: Mapping[str, float] = MappingProxyType(
    {"wall_trough": 0.15, "wall_pots": 0.17, "furled_banner": 0.16, "wall_meters": 0.16,
     "wall_crates": 0.18, "broom_and_pail": 0.15, "wall_tree": 0.2, "wall_olive": 0.2,
     "green_curtain": 0.18, "wall_ivy": 0.1, "hanging_basket": 0.2, "drain_cover": 0.2}
)  # fmt: skip
HALVES: Mapping[str, float] = MappingProxyType(
    {"wall_trough": 0.55, "wall_pots": 0.5, "furled_banner": 0.18, "wall_meters": 0.3,
     "wall_crates": 0.4, "broom_and_pail": 0.3, "wall_tree": 0.82, "wall_olive": 0.8,
     "green_curtain": 0.85, "wall_ivy": 1.3, "hanging_basket": 0.24, "drain_cover": 0.25}
)  # fmt: skip
TIMBER: Color = (0.85, 0.80, 0.72)
BROWN: Color = (0.25, 0.16, 0.08)
WASHING: tuple[Color, ...] = (
    (0.75, 0.74, 0.70), (0.20, 0.28, 0.45), (0.62, 0.20, 0.18), (0.70, 0.62, 0.35),
)  # fmt: skip


def wall_trough() -> Shapes:
    """Two troughs of flowers in a row, 1.1 m long."""
    parts: Shapes = []
    for number, x in enumerate((-0.28, 0.28)):
        parts.append(box((x - 0.26, -0.12, 0.0), (x + 0.26, 0.12, 0.2), "plastic", TERRACOTTA))
        parts.append(box((x - 0.24, -0.1, 0.2), (x + 0.24, 0.1, 0.205), "soil"))
        leaves = leaf_mound(f"trough {number}", (x - 0.26, -0.1, 0.2), (x + 0.26, 0.1, 0.44), 80,
                            size=0.045)  # fmt: skip
        flowers = leaf_mound(f"blossom {number}", (x - 0.24, -0.1, 0.3), (x + 0.24, 0.1, 0.46), 22,
                             size=0.035)  # fmt: skip
        parts += [leaves, tinted(flowers, BLOSSOM if number else (3.2, 2.6, 0.6))]
    return parts


def wall_pots() -> Shapes:
    """Four slender pots with plants up to a metre high."""
    parts: Shapes = []
    for number, (x, high, leaves) in enumerate(
        ((-0.38, 0.26, 0.35), (-0.13, 0.32, 0.70), (0.13, 0.22, 0.25), (0.37, 0.28, 0.50))
    ):
        color = (DARK, TERRACOTTA, GREY)[number % 3]
        parts.append(cylinder((x, 0, 0), (x, 0, high), 0.085, "plastic", color, top=0.12, sides=8))
        parts.append(leaf_mound(f"slender {number}", (x - 0.12, -0.12, high - 0.03),
                                (x + 0.12, 0.12, high + leaves), 60, size=0.045))  # fmt: skip
    return parts


def wall_tree() -> Shapes:
    """Maple of 2.6 m in a glazed pot, its crown flat to the wall."""
    return [
        *pot(0.0, 0.0, 0.17, 0.44, GLAZE),
        *slim_tree("wall maple", 0.41, 2.2, (0.95, 0.95, 0.5), 0.19),
    ]


def wall_olive() -> Shapes:
    """Olive of 2.3 m in a pale pot, flowers at its foot."""
    return [
        *pot(0.0, 0.0, 0.17, 0.4, POTTERY),
        *slim_tree("wall olive", 0.37, 1.95, (0.85, 0.92, 0.85), 0.19),
        *pot(0.4, 0.0, 0.12, 0.24, TERRACOTTA),
        tinted(leaf_mound("olive pot", (0.26, -0.13, 0.2), (0.54, 0.13, 0.44), 60, size=0.04),
               BLOSSOM),
    ]  # fmt: skip


def green_curtain() -> Shapes:
    """Net from a trough up to the lintel, grown over by gourds that shade the window behind."""
    return [
        *trough((-0.75, -0.14, 0.0), (0.75, 0.14, 0.24), PALE),
        *net_of_vines("green curtain", 0.7, 0.04, 0.24, 2.7),
    ]


def wall_ivy() -> Shapes:
    """Ivy that climbs a wall from a crack at its foot, 3.4 m high and wider towards its top."""
    return ivy("wall ivy", 1.2, 0.05, 3.4)


def furled_banner() -> Shapes:
    """Banner of a shop rolled round its pole, in a foot filled with water."""
    return [
        box((-0.17, -0.15, 0.0), (0.17, 0.15, 0.13), "plastic", PALE),
        post(2.3, 0.013),
        cylinder((0.0, 0.0, 0.75), (0.0, 0.0, 2.2), 0.055, "cloth", RED, top=0.04, sides=7),
        tube([[0, 0, 2.22], [0.12, 0, 2.2]], 0.01, "metal_grey", sides=4),
        cylinder((0.0, 0.0, 1.42), (0.0, 0.0, 1.46), 0.06, "cloth", PALE, sides=7),
    ]


def wall_meters() -> Shapes:
    """Meters of gas, power and water on a wall, their pipes going into the ground."""
    parts: Shapes = [
        box((-0.25, -0.06, 1.2), (-0.01, 0.14, 1.56), "plastic", PALE),
        box((-0.2, -0.065, 1.36), (-0.06, -0.06, 1.5), "glass"),
        box((0.04, -0.08, 0.55), (0.28, 0.12, 0.85), "plastic", (0.62, 0.64, 0.62)),
        box((0.08, -0.085, 0.68), (0.24, -0.08, 0.78), "sign"),
        box((-0.22, -0.02, 0.25), (0.0, 0.12, 0.5), "plastic", (0.3, 0.42, 0.55)),
    ]
    for x, top in ((0.09, 0.55), (0.23, 0.55), (-0.13, 1.2), (-0.05, 2.4)):
        parts.append(tube([[x, 0.1, -0.1], [x, 0.1, top]], 0.018, "metal_grey", sides=5))
    return parts


def wall_crates() -> Shapes:
    """Two piles of crates for bottles."""
    parts: Shapes = []
    for x, count, color in ((-0.2, 3, YELLOW), (0.2, 2, RED)):
        for row in range(count):
            low = 0.31 * row
            parts.append(box((x - 0.185, -0.17, low + 0.01), (x + 0.185, 0.16, low + 0.3),
                             "plastic", color))  # fmt: skip
            parts.append(box((x - 0.09, -0.175, low + 0.19), (x + 0.09, -0.17, low + 0.24),
                             "plastic", DARK))  # fmt: skip
    return parts


def broom_and_pail() -> Shapes:
    """Broom, dustpan and pail beside a door."""
    return [
        tube([[-0.15, -0.06, 0.1], [-0.17, 0.13, 1.3]], 0.012, "bench_wood", sides=5),
        box((-0.27, -0.11, 0.0), (-0.04, -0.04, 0.13), "bench_wood", (0.9, 0.75, 0.4)),
        cylinder((0.13, 0.0, 0.0), (0.13, 0.0, 0.28), 0.105, "plastic", BLUE, top=0.135, sides=9),
        box((-0.02, 0.08, 0.0), (0.0, 0.13, 0.6), "plastic", RED),
    ]


def hanging_basket() -> Shapes:
    """Basket of flowers on a bracket, over heads."""
    high = 2.35
    return [
        box((-0.03, 0.18, high), (0.03, 0.2, high + 0.5), "metal_dark"),
        tube([[0, 0.19, high + 0.45], [0, -0.02, high + 0.45]], 0.012, "metal_dark", sides=4),
        tube([[0, 0.0, high + 0.45], [0, 0.0, high + 0.05]], 0.006, "metal_dark", sides=4),
        cylinder((0, 0, high - 0.12), (0, 0, high + 0.08), 0.06, "bench_wood", top=0.15, sides=9),
        leaf_mound("basket", (-0.18, -0.16, high - 0.18), (0.18, 0.13, high + 0.24), 110,
                   size=0.045),
        tinted(leaf_mound("basket blossom", (-0.17, -0.15, high - 0.1), (0.17, 0.12, high + 0.24),
                          45, size=0.035), BLOSSOM),
    ]  # fmt: skip


def drain_cover() -> Shapes:
    """Lid of a drain in its frame, flush with the walk."""
    return [
        box((-0.25, -0.15, -0.05), (0.25, 0.15, 0.004), "metal_grey"),
        box((-0.22, -0.12, 0.0), (0.22, 0.12, 0.008), "metal_dark"),
        *(box((x, -0.1, 0.0), (x + 0.025, 0.1, 0.012), "metal_grey")
          for x in (-0.15, -0.05, 0.05, 0.14)),
    ]  # fmt: skip


# What takes no room of a walk.
ROOMLESS = ("hanging_basket", "drain_cover", "wall_ivy")
WALL_MAKERS: Mapping[str, Callable[[], Shapes]] = MappingProxyType(
    {
        maker.__name__: maker
        for maker in (
            wall_trough, wall_pots, wall_tree, wall_olive, green_curtain, wall_ivy, furled_banner,
            wall_meters, wall_crates, broom_and_pail, hanging_basket, drain_cover,
        )
    }
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
