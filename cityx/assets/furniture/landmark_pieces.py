"""Large things that stand by themselves: wheels, tents, masts, arches, pavilions, memorials.

Front -y, foot at the origin; measures are usual ones.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from itertools import pairwise
from types import MappingProxyType

import numpy as np
from numpy.typing import ArrayLike

from cityx.assets.furniture.furniture_parts import (
    BLUE,
    BURIED,
    DARK,
    GREY,
    PALE,
    RED,
    STONE,
    YELLOW,
    Shapes,
    post,
)
from cityx.assets.furniture.large_pieces import lattice, rod
from cityx.assets.shapes import Color, box, cylinder, disc, lathe, loft, moved, prism, tube
from cityx.geometry.arrays import FloatArray

WHITE: Color = (0.9, 0.91, 0.92)
ROOF: Color = (0.34, 0.12, 0.09)
GAY = (RED, YELLOW, BLUE, (0.10, 0.42, 0.20))  # paint of fairs


def _around(count: int, radius: float, start: float = 0.0) -> list[tuple[float, float]]:
    """Return places on a circle."""
    turn = start + np.arange(count) * (2 * np.pi / count)
    return [(radius * float(np.cos(a)), radius * float(np.sin(a))) for a in turn]


def _circle(radius: float, y: float, z: float, count: int = 25) -> list[list[float]]:
    """Return the points of an upright ring that closes."""
    turn = np.linspace(0.0, 2 * np.pi, count)
    return [[radius * float(np.cos(a)), y, z + radius * float(np.sin(a))] for a in turn]


def _cloth(outline: ArrayLike, thick: float) -> FloatArray:
    """Return the rings of a cloth: an outline, (k, 3) float, and the same a little higher."""
    rise = np.array([0.0, thick])[:, None, None] * [0.0, 0.0, 1.0]  # (2, 1, 3)
    return np.asarray(np.asarray(outline, float) + rise)


def ferris_wheel() -> Shapes:
    """Wheel of 40 m with sixteen cabins on two A-frames; the wheel faces the front."""
    hub, radius = 22.0, 18.5
    parts: Shapes = [
        box((-9.0, -4.0, BURIED), (9.0, 4.0, 0.35), "concrete"),
        cylinder((0, -3.2, hub), (0, 3.2, hub), 0.75, "car_paint", WHITE, sides=12),
    ]
    for y in (-3.0, 3.0):
        for x in (-8.0, 8.0):
            parts.append(tube([[x, y, 0.0], [0.0, y, hub]], [0.5, 0.35], "car_paint", WHITE,
                              sides=8))  # fmt: skip
        parts.append(rod([-5.0, y, 8.3], [5.0, y, 8.3], 0.18, "car_paint", WHITE))
    for y in (-1.4, 1.4):
        for far, thick in ((radius, 0.2), (radius - 1.6, 0.12), (0.55 * radius, 0.08)):
            parts.append(tube(_circle(far, y, hub, 33), thick, "car_paint", WHITE, sides=6,
                              caps=(False, False)))  # fmt: skip
    for k, (x, z) in enumerate(_around(16, 1.0)):
        for y in (-1.4, 1.4):
            parts.append(rod([0.0, 0.6 * y, hub], [radius * x, y, hub + radius * z], 0.06,
                             "metal_grey"))  # fmt: skip
        parts.append(rod([radius * x, -1.4, hub + radius * z],
                         [radius * x, 1.4, hub + radius * z], 0.1, "metal_grey"))  # fmt: skip
        cx, cz = radius * x, hub + radius * z - 2.5
        paint = GAY[k % len(GAY)]
        parts.append(box((cx - 0.9, -0.95, cz), (cx + 0.9, 0.95, cz + 0.9), "car_paint", paint))
        parts.append(box((cx - 0.85, -0.9, cz + 0.9), (cx + 0.85, 0.9, cz + 1.8), "car_glass"))
        parts.append(loft(
            [[[cx - s, -s, z_], [cx + s, -s, z_], [cx + s, s, z_], [cx - s, s, z_]]
             for s, z_ in ((1.0, cz + 1.8), (0.25, cz + 2.3))], "car_paint", paint))  # fmt: skip
    parts.append(box((-2.2, -6.4, BURIED), (2.2, -4.0, 0.55), "concrete"))
    parts.append(box((2.6, -6.2, BURIED), (4.8, -4.4, 2.5), "plastic", RED))
    parts.append(box((2.4, -6.4, 2.5), (5.0, -4.2, 2.7), "plastic", WHITE))
    return parts


def carousel() -> Shapes:
    """Roundabout of 10 m with horses under a striped roof."""
    parts: Shapes = [
        lathe([(5.0, BURIED), (5.0, 0.35), (0.0, 0.35)], "bench_wood", sides=20),
        cylinder((0, 0, 0.35), (0, 0, 4.0), 1.1, "car_paint", (0.75, 0.62, 0.4), sides=10),
        lathe([(5.1, 3.4), (5.1, 4.1), (4.9, 4.1)], "car_paint", (0.72, 0.52, 0.16), sides=20),
        cylinder((0, 0, 6.2), (0, 0, 7.2), 0.05, "metal_dark", sides=5),
        prism([(0.05, 6.7), (0.9, 6.95), (0.05, 7.2)], -0.02, 0.02, "cloth", RED),
    ]
    ring = _around(20, 5.1)
    for k in range(20):
        (ax, ay), (bx, by) = ring[k], ring[(k + 1) % 20]
        low = [[ax, ay, 4.05], [bx, by, 4.05], [0.0, 0.0, 6.3]]
        parts.append(loft(_cloth(low, 0.06), "cloth",
                          RED if k % 2 else WHITE))  # fmt: skip
    for k, (x, y) in enumerate(_around(10, 3.9)):
        parts.append(cylinder((x, y, 0.35), (x, y, 3.9), 0.035, "car_paint", YELLOW, sides=6))
        rise = 1.15 + 0.25 * (k % 2)
        turn = np.arctan2(y, x) + np.pi / 2
        c, s = float(np.cos(turn)), float(np.sin(turn))
        coat = (WHITE, (0.36, 0.2, 0.1), (0.12, 0.12, 0.13))[k % 3]
        parts.append(tube([[x - 0.55 * c, y - 0.55 * s, rise], [x + 0.5 * c, y + 0.5 * s, rise]],
                          [0.24, 0.22], "car_paint", coat, sides=8))  # fmt: skip
        parts.append(tube([[x + 0.45 * c, y + 0.45 * s, rise], [x + 0.75 * c, y + 0.75 * s,
                           rise + 0.55], [x + 1.0 * c, y + 1.0 * s, rise + 0.4]],
                          [0.17, 0.12, 0.08], "car_paint", coat, sides=6))  # fmt: skip
        for along in (-0.45, 0.4):
            for aside in (-0.12, 0.12):
                px, py = x + along * c - aside * s, y + along * s + aside * c
                parts.append(rod([px, py, rise], [px + 0.15 * c, py + 0.15 * s, rise - 0.65], 0.05,
                                 "car_paint", coat))  # fmt: skip
        parts.append(box((x - 0.18, y - 0.18, rise + 0.2), (x + 0.18, y + 0.18, rise + 0.3),
                         "car_paint", GAY[k % len(GAY)]))  # fmt: skip
    return parts


def circus_tent() -> Shapes:
    """Big top of 28 m: striped walls and roof on four masts, an entrance to the front."""
    count, wide, wall = 24, 14.0, 3.6
    parts: Shapes = []
    outer, inner = _around(count, wide), _around(count, 4.5)
    for k in range(count):
        (ax, ay), (bx, by) = outer[k], outer[(k + 1) % count]
        (cx, cy), (dx, dy) = inner[(k + 1) % count], inner[k]
        tint = RED if k % 2 else WHITE
        if k not in (count * 3 // 4, count * 3 // 4 - 1):  # the way in
            rings = [
                [[far * ax, far * ay, BURIED], [far * ax, far * ay, wall],
                 [far * bx, far * by, wall], [far * bx, far * by, BURIED]]
                for far in (1.0, 0.98)
            ]  # fmt: skip
            parts.append(loft(np.array(rings), "cloth", tint))
        slope = np.array([[1.03 * ax, 1.03 * ay, wall - 0.3], [1.03 * bx, 1.03 * by, wall - 0.3],
                          [cx, cy, 9.0], [dx, dy, 9.0]])  # fmt: skip
        parts.append(loft(_cloth(slope, 0.1), "cloth", tint))
        top = np.array([[dx, dy, 9.0], [cx, cy, 9.0], [0.0, 0.0, 12.5]])
        parts.append(loft(_cloth(top, 0.1), "cloth", tint))
        parts.append(rod([1.02 * ax, 1.02 * ay, wall], [1.22 * ax, 1.22 * ay, 0.0], 0.03, "cloth",
                         PALE))  # fmt: skip
    for x, y in _around(4, 4.5, np.pi / 4):
        parts.append(cylinder((x, y, BURIED), (x, y, 12.0), 0.15, "metal_grey", sides=6))
        parts.append(prism([(x, 11.2), (x + 1.5, 11.6), (x, 12.0)], y - 0.02, y + 0.02, "cloth",
                           YELLOW))  # fmt: skip
    parts.append(box((-2.2, -15.6, 3.2), (2.2, -13.6, 3.9), "sign", BLUE))
    for x in (-2.1, 2.1):
        parts.append(post(3.4, 0.08, x=x, y=-15.5))
    return parts


def radio_mast() -> Shapes:
    """Guyed lattice mast of 60 m with red and white bands, dishes and a hut at its foot."""
    parts: Shapes = [box((-1.6, -1.6, BURIED), (1.6, 1.6, 0.4), "concrete")]
    for k in range(20):
        low = 0.4 + 2.98 * k
        tint = RED if (k // 3) % 2 == 0 else WHITE
        parts += lattice([(low, 0.6), (low + 2.98, 0.6)], 0.06, "car_paint", tint)
    parts.append(cylinder((0, 0, 60.0), (0, 0, 66.0), 0.07, "car_paint", RED, sides=6))
    parts.append(cylinder((0, 0, 66.0), (0, 0, 66.3), 0.12, "lens_red", sides=6))
    for x, y in _around(4, 20.0, np.pi / 4):
        parts.append(box((x - 0.7, y - 0.7, BURIED), (x + 0.7, y + 0.7, 0.5), "concrete"))
        for high in (20.0, 40.0, 58.0):
            parts.append(rod([0.0, 0.0, high], [x, y, 0.4], 0.025, "metal_dark"))
    for z, turn in ((30.0, 0.3), (33.0, 2.4), (47.0, 4.4), (50.0, 1.2)):
        c, s = float(np.cos(turn)), float(np.sin(turn))
        parts.append(tube([[0.6 * c, 0.6 * s, z], [0.9 * c, 0.9 * s, z], [1.15 * c, 1.15 * s, z]],
                          [0.15, 0.5, 0.75], "car_paint", WHITE, sides=12))  # fmt: skip
    for turn in (0.5, 2.6, 4.7):
        c, s = float(np.cos(turn)), float(np.sin(turn))
        parts.append(box((1.0 * c - 0.15, 1.0 * s - 0.15, 54.0),
                         (1.0 * c + 0.15, 1.0 * s + 0.15, 56.2), "plastic", WHITE))  # fmt: skip
    parts.append(box((2.6, -1.5, BURIED), (5.4, 1.5, 2.6), "concrete_painted", PALE))
    parts.append(box((2.4, -1.7, 2.6), (5.6, 1.7, 2.75), "metal_dark"))
    parts.append(box((3.5, -1.53, 0.1), (4.4, -1.5, 2.1), "metal_grey"))
    return parts


def triumphal_arch() -> Shapes:
    """Arch of stone, 14 m wide and 13 m high, with columns, an attic and bronze figures."""
    half, deep, spring, radius = 7.0, 2.8, 5.2, 2.6
    tone: Color = (0.9, 0.86, 0.77)
    parts: Shapes = []
    for side in (-1.0, 1.0):
        low, high = sorted((side * radius, side * half))
        parts.append(box((low, -deep, BURIED), (high, deep, 10.0), "stone", tone))
        parts.append(box((low - 0.2, -deep - 0.25, BURIED), (high + 0.2, deep + 0.25, 1.1), "stone",
                         STONE))  # fmt: skip
        for x in (side * 3.4, side * 6.2):
            for y in (-deep - 0.55, deep + 0.55):
                parts.append(box((x - 0.5, y - 0.5, BURIED), (x + 0.5, y + 0.5, 1.3), "stone",
                                 STONE))  # fmt: skip
                parts.append(lathe([(0.42, 1.3), (0.38, 1.6), (0.34, 7.3), (0.5, 7.9)], "stone",
                                   STONE, sides=12, center=(x, y)))  # fmt: skip
                parts.append(box((x - 0.55, y - 0.55, 7.9), (x + 0.55, y + 0.55, 8.3), "stone",
                                 STONE))  # fmt: skip
    steps = 10
    for k in range(steps):  # voussoirs between the curve and the beam over it
        a, b = (np.pi * n / steps for n in (k, k + 1))
        ring = [(radius * np.cos(a), spring + radius * np.sin(a)),
                (radius * np.cos(a), 8.3), (radius * np.cos(b), 8.3),
                (radius * np.cos(b), spring + radius * np.sin(b))]  # fmt: skip
        parts.append(prism(ring, -deep, deep, "stone", tone))
    parts += [
        box((-radius, -deep, 8.3), (radius, deep, 10.0), "stone", tone),
        box((-half - 0.6, -deep - 1.1, 8.3), (half + 0.6, -deep, 9.0), "stone", STONE),
        box((-half - 0.6, deep, 8.3), (half + 0.6, deep + 1.1, 9.0), "stone", STONE),
        box((-half - 0.4, -deep - 0.3, 9.8), (half + 0.4, deep + 0.3, 10.2), "stone", STONE),
        box((-half + 0.3, -deep + 0.3, 10.2), (half - 0.3, deep - 0.3, 12.6), "stone", tone),
        box((-half, -deep, 12.6), (half, deep, 13.0), "stone", STONE),
        box((-3.6, -deep + 0.25, 10.6), (3.6, -deep + 0.3, 12.2), "stone", (0.72, 0.68, 0.6)),
        box((-0.45, -deep - 0.15, 7.5), (0.45, -deep, 8.6), "stone", STONE),
    ]
    for x in (-1.2, 0.0, 1.2):
        parts.append(lathe([(0.5, 13.0), (0.35, 13.5), (0.4, 14.3), (0.18, 14.7), (0.24, 15.0),
                            (0.0, 15.3)], "copper", sides=8, center=(x, 0.0)))  # fmt: skip
    return parts


def obelisk() -> Shapes:
    """Obelisk of 16 m on a stepped plinth, with a gilded tip."""

    def square(half: float, z: float) -> list[list[float]]:
        return [[-half, -half, z], [half, -half, z], [half, half, z], [-half, half, z]]

    return [
        box((-3.0, -3.0, BURIED), (3.0, 3.0, 0.3), "stone", STONE),
        box((-2.4, -2.4, 0.3), (2.4, 2.4, 0.6), "stone", STONE),
        box((-1.5, -1.5, 0.6), (1.5, 1.5, 2.6), "stone", (0.8, 0.74, 0.66)),
        box((-1.65, -1.65, 2.6), (1.65, 1.65, 2.9), "stone", STONE),
        box((-1.1, -1.52, 1.0), (1.1, -1.5, 2.2), "stone", (0.5, 0.46, 0.4)),
        loft([square(1.0, 2.9), square(0.66, 14.6)], "stone", (0.84, 0.70, 0.6)),
        loft([square(0.66, 14.6), square(0.02, 15.9)], "car_paint", (0.75, 0.55, 0.14)),
    ]


def war_memorial() -> Shapes:
    """Cross of stone on an octagonal shaft and steps, with a bronze sword, tablets and wreaths."""
    parts: Shapes = [
        lathe([(radius, BURIED), (radius, top), (0.0, top)], "stone", STONE, sides=8)
        for radius, top in ((2.6, 0.2), (2.1, 0.4), (1.6, 0.6))
    ]
    parts += [
        box((-0.75, -0.75, 0.6), (0.75, 0.75, 1.8), "stone", (0.82, 0.8, 0.75)),
        box((-0.85, -0.85, 1.8), (0.85, 0.85, 2.0), "stone", STONE),
        box((-0.55, -0.78, 0.85), (0.55, -0.75, 1.65), "copper_painted", (0.16, 0.12, 0.08)),
        lathe([(0.42, 2.0), (0.26, 5.0), (0.22, 6.4)], "stone", STONE, sides=8),
        box((-1.15, -0.18, 5.1), (1.15, 0.18, 5.5), "stone", STONE),
        box((-0.05, -0.34, 2.9), (0.05, -0.28, 5.9), "copper_painted", (0.16, 0.12, 0.08)),
        box((-0.4, -0.34, 5.2), (0.4, -0.28, 5.32), "copper_painted", (0.16, 0.12, 0.08)),
    ]
    for x in (-0.7, 0.0, 0.7):
        ring = [[x + 0.22 * float(np.cos(a)), -1.0 + 0.1 * float(np.sin(a)),
                 0.86 + 0.22 * float(np.sin(a))]
                for a in np.linspace(0, 2 * np.pi, 13)]  # fmt: skip
        parts.append(tube(ring, 0.06, "cloth", RED, sides=6, caps=(False, False)))
    return parts


def market_cross() -> Shapes:
    """Butter cross: an octagonal roof on eight columns round a stone shaft, on two steps."""
    parts: Shapes = [
        lathe([(3.4, BURIED), (3.4, 0.18), (0.0, 0.18)], "stone", STONE, sides=8),
        lathe([(3.0, 0.18), (3.0, 0.36), (0.0, 0.36)], "stone", STONE, sides=8),
        lathe([(0.7, 0.36), (0.7, 0.8), (0.4, 0.9), (0.34, 3.4)], "stone", STONE, sides=8),
        lathe([(3.0, 2.95), (3.0, 3.5), (2.6, 3.5), (2.6, 2.95)], "stone", STONE, sides=8),
        lathe([(3.3, 3.45), (1.2, 5.0), (0.5, 6.6), (0.0, 6.8)], "slate", sides=8),
        lathe([(0.18, 6.5), (0.14, 7.4), (0.0, 7.5)], "stone", STONE, sides=8),
        box((-0.5, -0.07, 7.0), (0.5, 0.07, 7.16), "stone", STONE),
    ]
    for x, y in _around(8, 2.75):
        parts.append(lathe([(0.3, 0.36), (0.22, 0.6), (0.2, 2.6), (0.32, 2.95)], "stone", STONE,
                           sides=8, center=(x, y)))  # fmt: skip
    return parts


def _pavilion(radius: float, floor: float, eave: float, top: float, paint: Color,
              cover: Color) -> Shapes:  # fmt: skip
    """Make an open pavilion of eight sides, open to the front, with rails on the other sides."""
    parts: Shapes = [
        lathe([(radius + 0.15, BURIED), (radius + 0.15, floor), (0.0, floor)], "concrete",
              sides=8),
        lathe([(radius + 0.02, floor), (radius + 0.02, floor + 0.03), (0.0, floor + 0.03)],
              "bench_wood", sides=8),
        lathe([(radius + 0.05, eave - 0.35), (radius + 0.05, eave), (radius - 0.15, eave),
               (radius - 0.15, eave - 0.35)], "car_paint", paint, sides=8),
        lathe([(radius + 0.55, eave - 0.05), (0.55 * radius, eave + 0.6 * (top - eave)),
               (0.12, top)], "metal_panel", cover, sides=8),
        lathe([(0.12, top - 0.1), (0.2, top + 0.25), (0.05, top + 0.5), (0.0, top + 0.9)],
              "car_paint", paint, sides=8),
    ]  # fmt: skip
    ring = _around(8, radius - 0.1, np.pi / 8)
    for k in range(8):
        (ax, ay), (bx, by) = ring[k], ring[(k + 1) % 8]
        parts.append(cylinder((ax, ay, floor), (ax, ay, eave - 0.2), 0.08, "car_paint", paint,
                              sides=8))  # fmt: skip
        for end in ((bx - ax, by - ay), (ring[k - 1][0] - ax, ring[k - 1][1] - ay)):
            parts.append(rod([ax, ay, eave - 0.75], [ax + 0.22 * end[0], ay + 0.22 * end[1],
                              eave - 0.3], 0.04, "car_paint", paint))  # fmt: skip
        if (ay + by) / 2 < -0.8 * radius:
            continue  # the way in
        for z in (floor + 0.95, floor + 0.2):
            parts.append(rod([ax, ay, z], [bx, by, z], 0.035, "car_paint", paint))
        for t in np.linspace(0.1, 0.9, 9).tolist():
            x, y = ax + t * (bx - ax), ay + t * (by - ay)
            parts.append(rod([x, y, floor + 0.2], [x, y, floor + 0.95], 0.014, "car_paint", paint))
    return parts


def bandstand() -> Shapes:
    """Bandstand of 8 m on a plinth: iron columns, railings and a domed roof, steps in front."""
    parts = _pavilion(3.8, 0.9, 4.1, 6.0, (0.72, 0.76, 0.70), (0.22, 0.40, 0.34))
    for k in range(4):
        parts.append(box((-1.1, -4.0 - 0.32 * (4 - k), BURIED), (1.1, -3.5, 0.22 * (k + 1)),
                         "stone", STONE))  # fmt: skip
    return parts


def gazebo() -> Shapes:
    """Garden pavilion of 4.4 m of white timber with benches along its sides."""
    parts = _pavilion(2.1, 0.25, 2.9, 4.2, WHITE, (0.25, 0.2, 0.18))
    for k, (x, y) in enumerate(_around(8, 1.6, 0.0)):
        if k != 6:
            parts.append(box((x - 0.28, y - 0.28, 0.62), (x + 0.28, y + 0.28, 0.68), "bench_wood"))
            parts.append(box((x - 0.05, y - 0.05, 0.25), (x + 0.05, y + 0.05, 0.62), "bench_wood"))
    return parts


def well() -> Shapes:
    """Draw well of stone with a shingled roof, a windlass and a bucket."""
    parts: Shapes = [
        lathe([(0.95, BURIED), (0.95, 0.85), (0.7, 0.85), (0.7, 0.3), (0.0, 0.3)], "stone",
              (0.7, 0.67, 0.6), sides=14),
        lathe([(1.0, 0.85), (1.0, 0.95), (0.66, 0.95), (0.66, 0.85)], "stone", STONE, sides=14),
        cylinder((-0.8, 0, 1.75), (0.95, 0, 1.75), 0.07, "bench_wood", sides=8),
        tube([[0.95, 0, 1.75], [0.95, -0.28, 1.75], [1.15, -0.28, 1.75]], 0.02, "metal_dark",
             sides=5),
        rod([0.0, -0.07, 1.75], [0.0, -0.07, 1.25], 0.012, "bench_wood"),
        lathe([(0.12, 0.98), (0.15, 1.25), (0.13, 1.25)], "bench_wood", sides=10,
              center=(0.0, -0.07)),
    ]  # fmt: skip
    for x in (-0.82, 0.82):
        parts.append(box((x - 0.07, -0.07, 0.3), (x + 0.07, 0.07, 2.3), "bench_wood"))
    for k in range(4):
        y, z = 0.95 - 0.25 * k, 2.15 + 0.19 * k
        for side in (-1.0, 1.0):
            low, high = sorted((side * y, side * (y - 0.3)))
            parts.append(box((-1.15, low, z), (1.15, high, z + 0.2), "bench_wood",
                             (0.6, 0.55, 0.5)))  # fmt: skip
    parts.append(box((-1.17, -0.14, 2.85), (1.17, 0.14, 2.95), "bench_wood"))
    return parts


def amphitheatre() -> Shapes:
    """Open-air theatre: eight rows of stone seats round half a stage of 10 m, stairs between."""
    parts: Shapes = [
        lathe([(5.2, BURIED), (5.2, 0.02), (0.0, 0.02)], "paving", sides=24),
        box((-6.0, -4.6, BURIED), (6.0, -1.6, 0.9), "stone", STONE),
        box((-5.6, -5.4, BURIED), (5.6, -4.6, 3.4), "stone", (0.82, 0.78, 0.7)),
    ]
    for x in (-4.6, -1.6, 1.6, 4.6):
        parts.append(lathe([(0.3, 0.9), (0.25, 3.4), (0.36, 3.7)], "stone", STONE, sides=8,
                           center=(x, -4.0)))  # fmt: skip
    parts.append(box((-5.6, -4.6, 3.7), (5.6, -3.6, 4.1), "stone", STONE))
    turn = np.linspace(0.0, np.pi, 19)
    way = np.column_stack([np.cos(turn), np.sin(turn)])
    for k in range(8):
        inner, outer, top = 5.4 + 0.85 * k, 6.25 + 0.85 * k, 0.42 * (k + 1)
        rings = [
            [[r * x, r * y, z] for r, z in ((inner, BURIED), (outer, BURIED), (outer, top),
                                            (inner, top))]
            for x, y in way[::-1].tolist()
        ]  # fmt: skip
        parts.append(loft(np.array(rings), "stone", STONE if k % 2 else (0.88, 0.86, 0.8)))
        for angle in np.radians([45.0, 90.0, 135.0]).tolist():
            c, s = float(np.cos(angle)), float(np.sin(angle))
            low = np.array([[inner * c - 0.5 * s, inner * s + 0.5 * c],
                            [inner * c + 0.5 * s, inner * s - 0.5 * c],
                            [(inner + 0.45) * c + 0.5 * s, (inner + 0.45) * s - 0.5 * c],
                            [(inner + 0.45) * c - 0.5 * s, (inner + 0.45) * s + 0.5 * c]
                            ])  # fmt: skip
            z = top - 0.42
            parts.append(loft([[[x, y, h] for x, y in low.tolist()] for h in (z, z + 0.21)],
                              "stone", (0.75, 0.72, 0.66)))  # fmt: skip
    return [moved(part, (0.0, -3.4, 0.0)) for part in parts]


def town_clock() -> Shapes:
    """Clock of a square: four dials on a fluted iron column, 5 m."""
    iron: Color = (0.05, 0.16, 0.11)
    parts: Shapes = [
        lathe([(0.5, BURIED), (0.5, 0.25), (0.32, 0.4), (0.26, 0.9), (0.16, 1.1), (0.12, 3.3),
               (0.22, 3.5), (0.1, 3.7)], "car_paint", iron, sides=10),
        box((-0.52, -0.52, 3.7), (0.52, 0.52, 4.74), "car_paint", iron),
        loft([[[-s, -s, z], [s, -s, z], [s, s, z], [-s, s, z]]
              for s, z in ((0.6, 4.74), (0.14, 5.15))], "car_paint", iron),
        lathe([(0.1, 5.1), (0.14, 5.25), (0.02, 5.6)], "car_paint", (0.7, 0.52, 0.16), sides=8),
    ]  # fmt: skip
    faces = [
        disc((0, -0.545, 4.22), 0.44, "sign", sides=20, thickness=0.025),
        box((-0.02, -0.56, 4.22), (0.02, -0.548, 4.56), "sign", DARK),
        box((0.0, -0.565, 4.19), (0.26, -0.55, 4.25), "sign", DARK),
    ]
    for k in range(12):
        a = np.pi * k / 6
        x, z = 0.38 * float(np.sin(a)), 4.22 + 0.38 * float(np.cos(a))
        faces.append(box((x - 0.022, -0.555, z - 0.022), (x + 0.022, -0.547, z + 0.022), "sign",
                         DARK))  # fmt: skip
    for turn in range(4):
        parts += [moved(face, yaw=turn * np.pi / 2) for face in faces]
    return parts


def _tent(tint: Color, inner: Color) -> Shapes:
    """Make a ridge tent of 3 m with a porch to the front."""
    ring = [(-1.1, 0.0), (1.1, 0.0), (0.0, 1.55)]
    parts: Shapes = [
        prism(ring, -0.9, 1.5, "cloth", tint),
        prism([(-1.0, 0.02), (1.0, 0.02), (0.0, 1.4)], -0.92, -0.9, "cloth", inner),
        prism([(-0.12, 0.02), (0.12, 0.02), (0.03, 1.3), (-0.03, 1.3)], -0.94, -0.92, "cloth",
              tint),
    ]  # fmt: skip
    for x in (-1.1, 1.1):
        for y in (-0.9, 0.3, 1.5):
            parts.append(rod([0.8 * x, y, 0.42], [1.45 * x, y, 0.0], 0.008, "cloth", PALE))
    for x in (-0.75, 0.75):
        parts.append(rod([x, -1.8, BURIED], [x, -1.8, 1.25], 0.02))
    canopy = np.array([[-0.85, -1.85, 1.2], [0.85, -1.85, 1.2], [0.5, -0.85, 1.0],
                       [0.0, -0.85, 1.56], [-0.5, -0.85, 1.0]])  # fmt: skip
    parts.append(loft(_cloth(canopy, 0.02), "cloth", tint))
    return parts


def tent() -> Shapes:
    """Ridge tent of a camper, green."""
    return _tent((0.16, 0.34, 0.14), (0.5, 0.46, 0.3))


def tent_orange() -> Shapes:
    """Ridge tent of a camper, orange."""
    return _tent((0.85, 0.32, 0.05), (0.6, 0.5, 0.3))


def marquee() -> Shapes:
    """White tent of 6 by 9 m for a feast, with scalloped eaves and open sides to the front."""
    parts: Shapes = []
    for x in (-3.0, 3.0):
        for y in (-4.5, -1.5, 1.5, 4.5):
            parts.append(post(2.6, 0.05, x=x, y=y))
    parts.append(prism([(-3.2, 2.5), (3.2, 2.5), (0.0, 4.3)], -4.6, 4.6, "cloth", WHITE))
    for x in (-3.12, 3.06):
        parts.append(box((x, -4.6, 2.2), (x + 0.06, 4.6, 2.55), "cloth", WHITE))
    for low, high in ((-4.5, -1.5), (1.5, 4.5)):
        for x in (-3.03, 2.98):
            parts.append(box((x, low + 0.05, 0.05), (x + 0.05, high - 0.05, 2.5), "cloth", WHITE))
    parts.append(box((-3.0, 4.48, 0.05), (3.0, 4.54, 2.5), "cloth", WHITE))
    for y in (-2.4, 0.4, 3.0):
        parts.append(box((-1.6, y - 0.35, 0.7), (1.6, y + 0.35, 0.75), "bench_wood"))
        for x in (-1.4, 1.4):
            parts.append(box((x - 0.03, y - 0.3, 0.0), (x + 0.03, y + 0.3, 0.7), "metal_dark"))
        for side in (-0.75, 0.75):
            parts.append(box((-1.6, y + side - 0.14, 0.4), (1.6, y + side + 0.14, 0.44),
                             "bench_wood"))  # fmt: skip
    return parts


def caravan() -> Shapes:
    """Touring caravan of 5.6 m: rounded ends, windows, a door, a drawbar and an awning."""
    outline = [(-2.7, 0.55), (2.7, 0.55), (2.8, 1.2), (2.55, 2.35), (2.1, 2.62), (-2.2, 2.62),
               (-2.65, 2.2)]  # fmt: skip
    parts: Shapes = [
        prism(outline, -1.1, 1.1, "car_paint", WHITE),
        box((-2.62, -1.115, 0.95), (2.66, -1.1, 1.1), "car_paint", BLUE),
        box((-2.62, 1.1, 0.95), (2.66, 1.115, 1.1), "car_paint", BLUE),
        box((0.5, -1.12, 0.6), (1.15, -1.1, 2.4), "car_paint", PALE),
        box((2.62, -0.75, 1.35), (2.72, 0.75, 2.1), "car_glass"),
        box((-2.95, -0.75, 1.35), (-2.6, 0.75, 1.95), "car_glass"),
        tube([[2.7, 0.0, 0.5], [3.9, 0.0, 0.45]], 0.05, "metal_dark", sides=6),
        cylinder((3.6, 0, BURIED), (3.6, 0, 0.45), 0.04, "metal_dark", sides=6),
        box((-0.8, -3.1, 2.3), (1.9, -1.1, 2.36), "cloth", (0.7, 0.66, 0.5)),
        post(2.3, 0.025, x=-0.75, y=-3.05),
        post(2.3, 0.025, x=1.85, y=-3.05),
    ]
    for low, high in ((-2.1, -1.0), (1.5, 2.3)):
        for y in (-1.12, 1.1):
            parts.append(box((low, y, 1.4), (high, y + 0.02, 2.1), "car_glass"))
    for x in (-0.35, 0.35):
        parts.append(cylinder((x, -1.08, 0.33), (x, 1.08, 0.33), 0.33, "rubber", sides=12))
    return parts


def food_truck() -> Shapes:
    """Van that sells food: an open hatch with an awning, a menu and a counter to the front."""
    parts: Shapes = [
        box((-2.4, -1.0, 0.5), (2.4, 1.0, 2.75), "car_paint", (0.12, 0.45, 0.42)),
        box((2.4, -0.95, 0.5), (3.3, 0.95, 1.45), "car_paint", (0.12, 0.45, 0.42)),
        prism([(2.4, 1.45), (3.3, 1.45), (2.75, 2.35), (2.4, 2.35)], -0.9, 0.9, "car_glass"),
        box((-2.45, -1.05, 2.75), (2.45, 1.05, 2.85), "car_paint", WHITE),
        box((-1.9, -1.01, 1.25), (1.3, -0.2, 2.35), "plastic", DARK),
        box((-1.95, -1.35, 1.15), (1.35, -1.0, 1.22), "metal_grey"),
        box((1.5, -1.03, 1.2), (2.2, -1.0, 2.4), "sign", DARK),
        box((-1.9, -1.02, 2.42), (1.9, -1.0, 2.68), "sign", YELLOW),
        box((-2.4, -1.02, 0.85), (2.4, -1.0, 1.0), "car_paint", YELLOW),
        cylinder((-0.9, 0.2, 2.85), (-0.9, 0.2, 3.2), 0.12, "metal_grey", sides=8),
        box((3.28, -0.8, 0.75), (3.33, -0.5, 0.95), "lens_white"),
        box((3.28, 0.5, 0.75), (3.33, 0.8, 0.95), "lens_white"),
    ]
    for k in range(8):
        x = -1.95 + 0.4125 * k
        slope = np.array([[x, -2.0, 2.25], [x + 0.4125, -2.0, 2.25], [x + 0.4125, -1.0, 2.55],
                          [x, -1.0, 2.55]])  # fmt: skip
        parts.append(loft(_cloth(slope, 0.04), "cloth",
                          RED if k % 2 else WHITE))  # fmt: skip
    for x in (-1.5, 2.7):
        parts.append(cylinder((x, -0.98, 0.38), (x, 0.98, 0.38), 0.38, "rubber", sides=12))
    for k, tint in enumerate((RED, YELLOW, PALE)):
        parts.append(box((-1.4 + 0.4 * k, -1.25, 1.22), (-1.28 + 0.4 * k, -1.13, 1.42), "plastic",
                         tint))  # fmt: skip
    return parts


def skate_ramp() -> Shapes:
    """Quarter pipe of 4 m with its deck and rail; one rides towards it from the front."""
    curve = [(-1.0 + 1.8 * float(np.sin(a)), 1.8 - 1.8 * float(np.cos(a)))
             for a in np.linspace(0.0, np.radians(80.0), 8)]  # fmt: skip
    parts: Shapes = []
    for (ay, az), (by, bz) in pairwise(curve):
        section = [
            [[-2.0, y, BURIED], [-2.0, y, z + 0.03], [2.0, y, z + 0.03], [2.0, y, BURIED]]
            for y, z in ((ay, az), (by, bz))
        ]
        parts.append(loft(np.array(section), "concrete"))
    far, top = curve[-1]
    parts.append(box((-2.0, far, BURIED), (2.0, far + 1.2, top), "concrete"))
    parts.append(cylinder((-2.0, far, top), (2.0, far, top), 0.04, "metal_grey", sides=8))
    for x in (-1.95, 0.0, 1.95):
        parts.append(cylinder((x, far + 1.15, top), (x, far + 1.15, top + 1.0), 0.025,
                              "metal_grey", sides=6))  # fmt: skip
    parts.append(rod([-1.95, far + 1.15, top + 1.0], [1.95, far + 1.15, top + 1.0], 0.025))
    return parts


def skate_box() -> Shapes:
    """Pyramid with a ledge and a rail, for tricks."""

    def flat(x: float, y: float, z: float) -> list[list[float]]:
        return [[-x, -y, z], [x, -y, z], [x, y, z], [-x, y, z]]

    parts: Shapes = [
        loft([flat(2.6, 2.0, BURIED), flat(2.6, 2.0, 0.0), flat(1.1, 0.8, 0.6)], "concrete"),
        box((-1.0, 0.2, 0.6), (1.0, 0.7, 0.9), "concrete", (0.75, 0.4, 0.3)),
        rod([-2.2, -1.5, 0.75], [2.2, -1.5, 0.45], 0.035),
    ]
    for x, z in ((-1.9, 0.73), (1.9, 0.47)):
        parts.append(rod([x, -1.5, 0.0], [x, -1.5, z], 0.03))
    return parts


def agility_hurdle() -> Shapes:
    """Hurdle for dogs, with striped bars."""
    parts: Shapes = []
    for x in (-0.75, 0.75):
        parts.append(box((x - 0.04, -0.35, BURIED), (x + 0.04, 0.35, 0.1), "bench_wood"))
        parts.append(box((x - 0.04, -0.05, 0.0), (x + 0.04, 0.05, 1.0), "plastic", WHITE))
    for z in (0.25, 0.5):
        for k in range(5):
            low = -0.75 + 0.3 * k
            parts.append(cylinder((low, 0, z), (low + 0.3, 0, z), 0.025, "plastic",
                                  RED if k % 2 else WHITE, sides=6))  # fmt: skip
    return parts


def agility_tunnel() -> Shapes:
    """Tube of 3 m through which dogs run."""
    parts: Shapes = [
        tube([[-1.5, 0.0, 0.36], [0.0, 0.25, 0.36], [1.5, 0.0, 0.36]], 0.36, "cloth", BLUE,
             sides=12, caps=(False, False)),
    ]  # fmt: skip
    for x in (-1.5, 1.5):
        ring = [[x, 0.37 * float(np.cos(a)), 0.37 + 0.37 * float(np.sin(a))]
                for a in np.linspace(0.0, 2 * np.pi, 13)]  # fmt: skip
        parts.append(tube(ring, 0.03, "cloth", YELLOW, sides=5, caps=(False, False)))
    return parts


def transformer() -> Shapes:
    """Oil transformer of a substation with cooling fins, bushings and a gantry over it."""
    parts: Shapes = [
        box((-2.4, -1.8, BURIED), (2.4, 1.8, 0.25), "concrete"),
        box((-1.6, -1.0, 0.25), (1.6, 1.0, 2.5), "metal_panel", GREY),
        cylinder((-1.2, 0.6, 2.9), (1.2, 0.6, 2.9), 0.32, "metal_panel", GREY, sides=10),
    ]
    for x in np.linspace(-1.4, 1.4, 9).tolist():
        for y in (-1.55, 1.0):
            parts.append(box((x - 0.05, y, 0.6), (x + 0.05, y + 0.55, 2.2), "metal_panel", GREY))
    for x in (-0.9, 0.0, 0.9):
        foot = (x, -0.4)
        parts.append(lathe([(0.14, 2.5), (0.2, 2.6), (0.12, 2.75), (0.19, 2.9), (0.11, 3.05),
                            (0.17, 3.2), (0.05, 3.6)], "plastic", (0.35, 0.14, 0.08), sides=8,
                           center=foot))  # fmt: skip
        parts.append(rod([x, -0.4, 3.6], [x, -0.4, 6.6], 0.02, "metal_dark"))
    for x in (-3.0, 3.0):
        parts += [
            moved(one, (x, 0.0, 0.0))
            for one in lattice([(BURIED, 0.3), (3.4, 0.25), (6.8, 0.2)], 0.04)
        ]
    for z in (6.3, 6.8):
        parts.append(rod([-3.0, 0.0, z], [3.0, 0.0, z], 0.05))
    for k in range(8):
        x = -3.0 + 0.75 * k
        parts.append(rod([x, 0.0, 6.3], [x + 0.75, 0.0, 6.8], 0.025))
    return parts


def rubble_heap() -> Shapes:
    """Heap of broken stone, 6 m across."""
    rings = []
    turn = np.arange(14) * (2 * np.pi / 14)
    for k, (far, z) in enumerate(((3.1, BURIED), (2.6, 0.7), (1.6, 1.6), (0.5, 2.3))):
        wave = 1.0 + 0.08 * np.sin(3 * turn + k) + 0.05 * np.cos(5 * turn - k)
        rings.append(np.column_stack([far * wave * np.cos(turn), far * wave * np.sin(turn),
                                      np.full(14, z)]))  # fmt: skip
    parts: Shapes = [loft(np.stack(rings), "gravel", (0.85, 0.82, 0.76))]
    for k, (x, y) in enumerate(_around(7, 3.0, 0.4)):
        size = 0.25 + 0.12 * (k % 3)
        parts.append(lathe([(size, -0.1), (1.1 * size, 0.4 * size), (0.5 * size, size),
                            (0.0, 1.1 * size)], "stone", (0.7, 0.66, 0.6), sides=6,
                           center=(x, y)))  # fmt: skip
    return parts


def excavator() -> Shapes:
    """Excavator on tracks, its arm lowered to the front."""
    parts: Shapes = [
        box((-0.95, -1.2, 0.75), (0.95, 1.7, 1.25), "car_paint", YELLOW),
        box((-0.95, 0.5, 1.25), (0.95, 1.75, 2.0), "car_paint", YELLOW),
        box((-0.95, -1.1, 1.25), (-0.05, 0.45, 2.7), "car_glass"),
        box((-0.98, -1.13, 2.7), (-0.02, 0.48, 2.8), "car_paint", DARK),
    ]
    for x in (-1.35, 0.75):
        ring = [(-1.75, 0.35), (-1.45, 0.0), (1.45, 0.0), (1.75, 0.35), (1.45, 0.75),
                (-1.45, 0.75)]  # fmt: skip
        track = np.array([[[x + aside, y, z] for y, z in ring] for aside in (0.0, 0.6)])
        parts.append(loft(track, "rubber"))
    parts += [
        tube([[0.4, -1.0, 1.4], [0.4, -2.6, 3.2], [0.4, -4.2, 2.9]], [0.2, 0.22, 0.16], "car_paint",
             YELLOW, sides=4),
        tube([[0.4, -4.2, 2.9], [0.4, -4.9, 0.8]], [0.16, 0.1], "car_paint", YELLOW, sides=4),
        tube([[0.4, -1.3, 1.3], [0.4, -2.7, 2.6]], 0.06, "metal_grey", sides=6),
        tube([[0.4, -2.9, 3.35], [0.4, -4.25, 3.2]], 0.05, "metal_grey", sides=6),
        loft([[[-0.1, -4.6, 0.75], [0.9, -4.6, 0.75], [0.9, -5.0, 0.85], [-0.1, -5.0, 0.85]],
              [[-0.1, -4.1, 0.3], [0.9, -4.1, 0.3], [0.9, -4.7, 0.05], [-0.1, -4.7, 0.05]]],
             "metal_dark"),
    ]  # fmt: skip
    return parts


LANDMARK_MAKERS: Mapping[str, Callable[[], Shapes]] = MappingProxyType(
    {
        maker.__name__: maker
        for maker in (
            ferris_wheel, carousel, circus_tent, radio_mast, triumphal_arch, obelisk, war_memorial,
            market_cross, bandstand, gazebo, well, amphitheatre, town_clock, tent, tent_orange,
            marquee, caravan, food_truck, skate_ramp, skate_box, agility_hurdle, agility_tunnel,
            transformer, rubble_heap, excavator,
        )
    }
)  # fmt: skip
