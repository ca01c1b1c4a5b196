"""What stands on fields and yards: masts, turbines, cranes, stalls, graves, containers, vines.

Front -y, foot at the origin; measures are usual ones.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from itertools import pairwise
from types import MappingProxyType

import numpy as np

from cityx.assets.furniture.furniture_parts import BLUE, BURIED, STONE, YELLOW, Shapes, post
from cityx.assets.shapes import Color, box, cards, cylinder, lathe, loft, moved, prism, tube
from cityx.city.mesh import MeshBatch
from cityx.ids import rng_for

WHITE: Color = (0.9, 0.91, 0.92)
# Across, above the foot: where the wires of a pylon hang; metres. The topmost is the earth wire.
HANGERS = ((-4.6, 18.6), (4.6, 18.6), (-6.6, 22.6), (6.6, 22.6), (-4.2, 26.6), (4.2, 26.6),
           (0.0, 30.0))  # fmt: skip


def rod(a: list[float], b: list[float], radius: float, material: str = "metal_grey",
        tint: Color = (1.0, 1.0, 1.0)) -> MeshBatch:  # fmt: skip
    """Make a thin bar between two places."""
    return tube([a, b], radius, material, tint, sides=4)


def lattice(levels: list[tuple[float, float]], radius: float, material: str = "metal_grey",
             tint: Color = (1.0, 1.0, 1.0)) -> Shapes:  # fmt: skip
    """Make a square lattice mast through (height, half width) levels."""
    corners = ((-1, -1), (1, -1), (1, 1), (-1, 1))
    parts: Shapes = []
    for (low, wide), (high, slim) in pairwise(levels):
        for (x, y), (u, v) in zip(corners, (*corners[1:], corners[0]), strict=True):
            foot, head = [x * wide, y * wide, low], [x * slim, y * slim, high]
            parts.append(rod(foot, head, radius, material, tint))
            over = [u * slim, v * slim, high]
            parts.append(rod(foot, over, 0.6 * radius, material, tint))
            parts.append(rod(head, over, 0.6 * radius, material, tint))
    return parts


def pylon() -> Shapes:
    """Lattice tower of 30 m for six wires and an earth wire; the line runs along y."""
    parts = lattice([(BURIED, 2.6), (6.0, 2.0), (11.5, 1.5), (16.0, 1.1), (20.0, 0.8),
                      (24.0, 0.65), (28.0, 0.45)], 0.09)  # fmt: skip
    parts.append(rod([0, 0, 27.9], [0, 0, 30.0], 0.08))
    for x, z in HANGERS[:-1]:
        foot = z + 1.4
        for y in (-0.5, 0.5):
            parts.append(rod([0, y, foot], [x, 0, foot + 0.1], 0.07))
            parts.append(rod([0, y, foot + 1.2], [x, 0, foot + 0.1], 0.05))
        parts.append(cylinder((x, 0, z), (x, 0, foot), 0.07, "plastic", (0.35, 0.2, 0.13), sides=6))
    return parts


def wind_turbine() -> Shapes:
    """Turbine of 88 m to the tip of a blade: a tower of 60 m and a rotor of 56 m."""
    hub = np.array([0.0, -2.6, 60.5])
    parts: Shapes = [
        cylinder((0, 0, BURIED), (0, 0, 0.5), 3.0, "concrete", sides=12),
        cylinder((0, 0, 0.5), (0, 0, 59.0), 1.75, "car_paint", WHITE, top=1.1, sides=16),
        box((-1.2, -2.2, 59.0), (1.2, 4.8, 62.0), "car_paint", WHITE),
        tube([[0, -2.0, 60.5], [0, -3.4, 60.5], [0, -4.1, 60.5]], [1.15, 0.95, 0.25], "car_paint",
             WHITE, sides=12),
    ]  # fmt: skip
    for turn in np.radians([90.0, 210.0, 330.0]):
        way = np.array([np.cos(turn), 0.0, np.sin(turn)])
        side = np.array([-np.sin(turn), 0.0, np.cos(turn)])
        rings = []
        for far, half, thick in ((0.6, 0.5, 0.5), (5.0, 1.1, 0.35), (27.0, 0.28, 0.06)):
            at = hub + far * way
            edge, back = half * side, np.array([0.0, thick, 0.0])
            rings.append([at - edge - back, at + edge - back, at + edge + back, at - edge + back])
        parts.append(loft(np.array(rings), "car_paint", WHITE))
    return parts


def solar_table() -> Shapes:
    """Table of panels, 6 m long, tilted towards -y."""
    low, high = 0.75, 2.35
    parts: Shapes = [
        prism([(-3.0, 0.0), (3.0, 0.0), (3.0, 0.06), (-3.0, 0.06)], -1.4, 1.4, "metal_grey")
    ]
    tilt = np.arctan2(high - low, 2.7)
    face = box((-2.98, -1.42, 0.06), (2.98, 1.42, 0.09), "pane", (0.12, 0.16, 0.34))
    lines = [box((x - 0.02, -1.42, 0.09), (x + 0.02, 1.42, 0.10), "metal_grey")
             for x in np.linspace(-2.98, 2.98, 7).tolist()]  # fmt: skip
    lines.append(box((-2.98, -0.02, 0.09), (2.98, 0.02, 0.10), "metal_grey"))
    parts = [_tilted(part, tilt, 0.5 * (low + high)) for part in (*parts, face, *lines)]
    for x in (-2.2, 2.2):
        parts.append(post(low + 0.1, 0.05, x=x, y=-1.1))
        parts.append(post(high - 0.1, 0.05, x=x, y=1.1))
    return parts


def _tilted(part: MeshBatch, angle: float, rise: float) -> MeshBatch:
    """Turn a flat piece about the x axis and lift it."""
    x, y, z = part.vertices.T
    up = np.column_stack([
        x, y * np.cos(angle) - z * np.sin(angle), y * np.sin(angle) + z * np.cos(angle) + rise
    ])  # fmt: skip
    return replace(part, vertices=up)


def tower_crane() -> Shapes:
    """Tower crane of 38 m with a jib of 24 m to the front."""
    paint = ("car_paint", YELLOW)
    parts: Shapes = [box((-2.2, -2.2, BURIED), (2.2, 2.2, 0.5), "concrete")]
    levels = [(0.5 + 3.0 * k, 0.8) for k in range(12)]
    parts += lattice(levels, 0.09, *paint)
    parts.append(box((-1.0, -1.0, 33.5), (1.0, 1.0, 34.2), *paint))
    parts.append(box((0.9, -1.9, 32.0), (2.1, -0.4, 34.0), "car_glass"))
    parts.append(rod([0, 0, 34.0], [0, 0, 38.0], 0.14, *paint))
    for x in (-0.6, 0.6):
        parts.append(rod([x, 8.5, 34.6], [x, -24.0, 34.6], 0.08, *paint))
    parts.append(rod([0, 8.5, 35.8], [0, -23.0, 35.8], 0.08, *paint))
    for k in range(16):
        y = 8.0 - 2.0 * k
        for x in (-0.6, 0.6):
            parts.append(rod([x, y, 34.6], [0, y - 1.0, 35.8], 0.045, *paint))
            parts.append(rod([0, y - 1.0, 35.8], [x, y - 2.0, 34.6], 0.045, *paint))
    for y in (7.5, -15.0):
        parts.append(rod([0, 0, 38.0], [0, y, 35.8], 0.03, "metal_dark"))
    parts.append(box((-0.9, 6.6, 32.4), (0.9, 8.4, 34.6), "concrete"))
    parts.append(box((-0.5, -14.6, 34.2), (0.5, -13.4, 34.6), "metal_dark"))
    parts.append(rod([0, -14.0, 34.3], [0, -14.0, 12.0], 0.03, "metal_dark"))
    parts.append(box((-0.3, -14.3, 11.2), (0.3, -13.7, 12.0), *paint))
    return parts


def scaffold() -> Shapes:
    """Bay of a scaffold before a wall, 2.6 m wide, with four decks; the wall is at the back."""
    parts: Shapes = []
    for x in (-1.3, 1.3):
        for y in (-0.5, 0.5):
            parts.append(post(8.3, 0.024, x=x, y=y))
    for deck in range(4):
        z = 2.0 * (deck + 1)
        parts.append(box((-1.3, -0.5, z - 0.06), (1.3, 0.5, z), "bench_wood"))
        for over in (0.5, 1.0) if deck < 3 else ():
            parts.append(rod([-1.3, -0.5, z + over], [1.3, -0.5, z + over], 0.02))
        parts.append(rod([-1.3, -0.5, z - 2.0], [1.3, -0.5, z], 0.02))
    return parts


def helipad() -> Shapes:
    """Landing pad of 15 m: a disc with a ring and an H."""
    top = 0.05
    gray: Color = (0.42, 0.46, 0.44)
    parts: Shapes = [
        lathe([(radius, BURIED), (radius, rim), (0.0, rim)], material, tint, sides=32)
        for radius, rim, material, tint in (
            (7.5, top - 0.02, "concrete", gray), (6.9, top - 0.01, "marking_yellow", WHITE),
            (6.4, top, "concrete", gray),
        )
    ]  # fmt: skip
    for low, high in (((-1.9, -2.4), (-1.1, 2.4)), ((1.1, -2.4), (1.9, 2.4)),
                      ((-1.1, -0.4), (1.1, 0.4))):  # fmt: skip
        parts.append(box((*low, top), (*high, top + 0.012), "marking_white"))
    return parts


def grave() -> Shapes:
    """Headstone with a bed before it."""
    outline = [(-0.38, BURIED), (0.38, BURIED), (0.38, 0.72), (0.22, 0.92), (0.0, 0.98),
               (-0.22, 0.92), (-0.38, 0.72)]  # fmt: skip
    return [
        prism(outline, 0.62, 0.80, "stone", (0.62, 0.62, 0.62)),
        box((-0.45, -0.95, BURIED), (0.45, 0.62, 0.10), "stone", STONE),
        box((-0.36, -0.86, 0.10), (0.36, 0.55, 0.14), "soil"),
    ]


def grave_cross() -> Shapes:
    """Stone cross on a plinth, with a bed before it."""
    return [
        box((-0.32, 0.55, BURIED), (0.32, 0.95, 0.35), "stone", STONE),
        box((-0.09, 0.68, 0.35), (0.09, 0.84, 1.35), "stone", STONE),
        box((-0.36, 0.68, 0.88), (0.36, 0.84, 1.06), "stone", STONE),
        box((-0.45, -0.95, BURIED), (0.45, 0.55, 0.08), "stone", (0.7, 0.7, 0.7)),
        box((-0.38, -0.88, 0.08), (0.38, 0.5, 0.12), "gravel"),
    ]


def grave_slab() -> Shapes:
    """Slab that lies over a grave, with a low stone."""
    dark: Color = (0.16, 0.16, 0.17)
    return [
        box((-0.46, -0.95, BURIED), (0.46, 0.85, 0.16), "stone", dark),
        box((-0.40, 0.66, 0.16), (0.40, 0.84, 0.62), "stone", dark),
    ]


def _stall(tint: Color) -> Shapes:
    parts: Shapes = []
    for x in (-1.4, 1.4):
        parts.append(post(2.1, 0.03, x=x, y=-0.9))
        parts.append(post(2.6, 0.03, x=x, y=0.9))
    for k in range(8):
        x = -1.6 + 0.4 * k
        ring = np.array([[x, -1.25, 2.0], [x + 0.4, -1.25, 2.0], [x + 0.4, 1.1, 2.7],
                         [x, 1.1, 2.7]])  # fmt: skip
        parts.append(
            loft(np.stack([ring, ring + np.array([0, 0, 0.04])]), "cloth", tint if k % 2 else WHITE)
        )
    parts.append(box((-1.35, -0.85, 0.75), (1.35, 0.1, 0.82), "bench_wood"))
    parts.append(box((-1.33, -0.84, 0.0), (1.33, -0.80, 0.75), "cloth", tint))
    goods: tuple[Color, ...] = ((0.75, 0.12, 0.08), (0.85, 0.5, 0.06), (0.2, 0.42, 0.1),
                                (0.8, 0.72, 0.2), (0.45, 0.25, 0.1))  # fmt: skip
    for k, color in enumerate(goods):
        x = -1.2 + 0.5 * k
        parts.append(box((x, -0.75, 0.82), (x + 0.4, -0.05, 0.98), "plastic", color))
    return parts


def market_stall() -> Shapes:
    """Stall with a red awning, goods to the front."""
    return _stall((0.62, 0.07, 0.05))


def market_stall_green() -> Shapes:
    """Stall with a green awning."""
    return _stall((0.06, 0.30, 0.12))


def _container(z: float, tint: Color) -> Shapes:
    parts: Shapes = [
        box((-6.05, -1.2, z + 0.05), (6.05, 1.2, z + 2.55), "car_paint", tint),
        *(box((x - 0.07, -1.22, z), (x + 0.07, 1.22, z + 2.59), "car_paint", tint)
          for x in (-6.02, 6.02)),
    ]  # fmt: skip
    for x in np.linspace(-5.6, 5.6, 29).tolist():
        for y in (-1.215, 1.215):
            parts.append(
                box((x - 0.1, min(y, 0.99 * y), z + 0.2), (x + 0.1, max(y, 0.99 * y), z + 2.4),
                    "car_paint", tint)
            )  # fmt: skip
    return parts


def yard_container() -> Shapes:
    """Container of 40 feet."""
    return _container(0.0, BLUE)


def yard_container_pair() -> Shapes:
    """Two containers, one on the other."""
    return [*_container(0.0, (0.45, 0.10, 0.05)), *_container(2.6, (0.10, 0.30, 0.16))]


def yard_container_stack() -> Shapes:
    """Three containers, one on the other."""
    tints: tuple[Color, ...] = ((0.5, 0.5, 0.5), (0.55, 0.28, 0.05), (0.05, 0.16, 0.35))
    return [part for k, tint in enumerate(tints) for part in _container(2.6 * k, tint)]


def site_hut() -> Shapes:
    """Hut of a building site, of sheet metal."""
    return [
        box((-3.0, -1.2, 0.15), (3.0, 1.2, 2.75), "car_paint", (0.75, 0.74, 0.68)),
        box((-3.05, -1.25, 0.0), (3.05, 1.25, 0.15), "metal_dark"),
        box((-3.05, -1.25, 2.75), (3.05, 1.25, 2.85), "metal_grey"),
        box((-2.2, -1.22, 0.2), (-1.3, -1.19, 2.2), "metal_grey"),
        box((0.2, -1.22, 1.1), (1.6, -1.19, 2.1), "glass"),
    ]


def material_pile() -> Shapes:
    """Stacked boards, pipes and a heap of sand."""
    parts: Shapes = [
        lathe([(1.5, BURIED), (1.5, 0.02), (0.9, 0.55), (0.3, 0.95), (0.0, 1.0)], "sand", sides=12,
              center=(1.4, 0.4)),
        *(box((-2.2, -1.2 + 0.02 * k, 0.12 * k), (0.0, -0.4 + 0.02 * k, 0.12 * k + 0.1),
              "bench_wood") for k in range(6)),
    ]  # fmt: skip
    for k, (y, z) in enumerate(((0.1, 0.2), (0.5, 0.2), (0.9, 0.2), (0.3, 0.55), (0.7, 0.55))):
        parts.append(cylinder((-2.4 + 0.1 * k, y, z), (-0.4, y, z), 0.19, "concrete", sides=10))
    return parts


def allotment() -> Shapes:
    """Plot of a gardener: hut, beds, a water butt."""
    green: Color = (0.10, 0.24, 0.14)
    parts: Shapes = [
        box((-1.2, 1.2, BURIED), (1.2, 3.2, 2.0), "bench_wood", (0.85, 0.75, 0.65)),
        prism([(-1.4, 1.95), (1.4, 1.95), (0.0, 2.75)], 1.05, 3.35, "roof_metal",
              (0.35, 0.25, 0.2)),
        box((-0.45, 1.17, 0.0), (0.35, 1.2, 1.85), "car_paint", green),
        cylinder((1.7, 2.6, BURIED), (1.7, 2.6, 0.95), 0.32, "plastic", green, sides=10),
    ]  # fmt: skip
    rng = rng_for(0, "assets/allotment", 1)
    for x in (-2.4, 0.0, 2.4):
        parts.append(box((x - 0.85, -3.4, BURIED), (x + 0.85, 0.4, 0.12), "soil"))
        spots = np.column_stack([
            rng.uniform(x - 0.7, x + 0.7, 40), rng.uniform(-3.2, 0.2, 40), rng.uniform(0.2, 0.5, 40)
        ])  # fmt: skip
        turn = rng.uniform(0, 2 * np.pi, 40)
        way = 0.16 * np.column_stack([np.cos(turn), np.sin(turn), 0.8 * np.ones(40)])
        across = 0.11 * np.column_stack([-np.sin(turn), np.cos(turn), np.zeros(40)])
        parts.append(cards(spots, way, across, "leaf", np.tile([[0.8, 1.0, 0.6]], (40, 1))))
    return parts


def vine() -> Shapes:
    """Stretch of a row of vines along x, 2.4 m."""
    rng = rng_for(0, "assets/vine", 1)
    spots = np.column_stack([
        rng.uniform(-1.2, 1.2, 110), rng.normal(0.0, 0.13, 110), rng.uniform(0.55, 1.75, 110)
    ])  # fmt: skip
    turn = rng.uniform(0, 2 * np.pi, 110)
    way = 0.13 * np.column_stack([np.cos(turn), np.sin(turn), rng.uniform(-0.6, 0.6, 110)])
    across = 0.11 * np.column_stack([-np.sin(turn), np.cos(turn), np.zeros(110)])
    tint = np.column_stack([rng.uniform(0.8, 1.2, 110), np.ones(110), np.full(110, 0.6)])
    parts: Shapes = [cards(spots, way, across, "leaf", tint)]
    parts.append(post(1.8, 0.035, "bench_wood"))
    for x in (-0.8, 0.8):
        parts.append(rod([x, 0, BURIED], [x + 0.05, 0, 0.9], 0.03, "bark"))
    for z in (0.7, 1.2, 1.7):
        parts.append(rod([-1.2, 0, z], [1.2, 0, z], 0.006))
    return parts


def shelter() -> Shapes:
    """Shelter of a bus station: a roof on two posts over a bench and a sign."""
    parts: Shapes = [
        box((-3.0, -1.3, 2.7), (3.0, 1.3, 2.82), "metal_grey"),
        box((-3.0, -1.32, 2.66), (3.0, -1.30, 2.86), "sign", BLUE),
        box((-1.4, 0.1, 0.44), (1.4, 0.5, 0.48), "bench_wood"),
        box((-2.6, 0.58, 0.3), (2.6, 0.60, 2.2), "glass"),
        box((1.7, -0.02, 1.5), (2.5, 0.02, 2.1), "sign", (0.9, 0.9, 0.88)),
    ]
    for x in (-2.7, 2.7):
        parts.append(post(2.7, 0.06, x=x, y=0.6))
    for x in (-1.2, 1.2):
        parts.append(box((x - 0.03, 0.2, BURIED), (x + 0.03, 0.4, 0.44), "metal_dark"))
    parts.append(moved(post(2.7, 0.05, "car_paint"), (2.1, 0.0, 0.0)))
    return parts


def wall_tower() -> Shapes:
    """Round tower of a city wall, 9 m to its merlons, with a pointed roof."""
    stone: Color = (0.74, 0.70, 0.63)
    parts: Shapes = [
        lathe([(2.5, -0.4), (2.3, 0.6), (2.2, 7.6), (2.5, 8.0), (2.5, 9.0), (2.1, 9.0), (2.1, 8.2),
               (0.0, 8.2)], "stone", stone, sides=16),
        lathe([(2.35, 9.5), (1.2, 11.4), (0.0, 13.4)], "roof_tiles", (0.62, 0.3, 0.2), sides=16),
    ]  # fmt: skip
    for turn in np.linspace(0.0, 2 * np.pi, 8, endpoint=False).tolist():
        x, y = 2.3 * np.cos(turn), 2.3 * np.sin(turn)
        parts.append(cylinder((x, y, 9.0), (x, y, 9.6), 0.28, "stone", stone, sides=6))
    for turn in (0.0, np.pi / 2, np.pi, 1.5 * np.pi):
        slit = box((-0.08, -2.27, 4.6), (0.08, -2.1, 6.0), "metal_dark")
        parts.append(moved(slit, (0.0, 0.0, 0.0), yaw=turn))
    return parts


def tram_stop() -> Shapes:
    """Stop of a tram: a pole with a square sign, a bench and a screen of glass."""
    return [
        post(2.9, 0.04, x=1.6),
        box((1.35, -0.03, 2.4), (1.85, 0.03, 2.9), "sign", BLUE),
        box((1.42, -0.04, 1.2), (1.78, -0.02, 1.8), "sign", (0.9, 0.9, 0.88)),
        box((-1.2, 0.0, 0.44), (0.6, 0.36, 0.48), "bench_wood"),
        *(box((x - 0.03, 0.1, BURIED), (x + 0.03, 0.2, 0.44), "metal_dark") for x in (-1.0, 0.4)),
        box((-1.4, 0.40, 0.3), (0.9, 0.42, 2.1), "glass"),
        *(post(2.2, 0.03, x=x, y=0.41) for x in (-1.4, 0.9)),
    ]


def level_crossing() -> Shapes:
    """Half barrier of a level crossing, raised, with a St Andrew's cross; traffic comes from -y."""
    parts: Shapes = [
        post(3.2, 0.06),
        box((-0.25, 0.1, BURIED), (0.25, 0.7, 1.1), "metal_grey"),
        box((-0.22, -0.08, 1.7), (0.22, -0.04, 2.2), "plastic", (0.06, 0.065, 0.07)),
        *(cylinder((x, -0.13, 1.95), (x, -0.08, 1.95), 0.09, "signal_red", sides=8)
          for x in (-0.11, 0.11)),
    ]  # fmt: skip
    for side in (-1.0, 1.0):
        parts.append(rod([-0.5 * side, -0.06, 2.5], [0.5 * side, -0.06, 3.1], 0.06, "sign"))
    for k in range(5):
        foot = [-0.1 - 0.07 * k, 0.4, 1.0 + 0.75 * k]
        head = [-0.17 - 0.07 * k, 0.4, 1.75 + 0.75 * k]
        tint: Color = (0.8, 0.05, 0.04) if k % 2 else (0.95, 0.95, 0.95)
        parts.append(rod(foot, head, 0.06, "sign", tint))
    return parts


LARGE_MAKERS: Mapping[str, Callable[[], Shapes]] = MappingProxyType(
    {
        maker.__name__: maker
        for maker in (
            pylon, wind_turbine, solar_table, tower_crane, scaffold, helipad, grave, grave_cross,
            grave_slab, market_stall, market_stall_green, yard_container, yard_container_pair,
            yard_container_stack, site_hut, material_pile, allotment, vine, shelter,
            wall_tower, tram_stop, level_crossing,
        )
    }
)  # fmt: skip
