"""Small things that a sentence can ask for: boards, machines, cameras, barriers, what farms have.

Front -y, foot at the origin; measures are usual ones.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType

import numpy as np

from cityx.assets.furniture.furniture_parts import (
    BLUE,
    BURIED,
    DARK,
    GREEN,
    PALE,
    RED,
    STONE,
    YELLOW,
    Shapes,
    post,
)
from cityx.assets.furniture.large_pieces import market_stall, rod
from cityx.assets.shapes import Color, box, cards, cylinder, disc, lathe, loft, prism, tube
from cityx.city.mesh import MeshBatch
from cityx.ids import rng_for

STRAW: Color = (0.86, 0.68, 0.30)


def billboard() -> Shapes:
    """Board of 6 by 3 m on two posts, with a poster, lamps and a catwalk."""
    parts: Shapes = [
        cylinder((x, 0.15, BURIED), (x, 0.15, 5.6), 0.13, "metal_dark", sides=8)
        for x in (-2.0, 2.0)
    ]
    parts += [
        box((-3.1, -0.06, 2.6), (3.1, 0.1, 5.7), "metal_grey"),
        box((-3.0, -0.08, 2.7), (3.0, -0.06, 5.6), "sign", PALE),
        box((-3.0, -0.085, 2.7), (0.2, -0.08, 5.6), "sign", (0.06, 0.32, 0.55)),
        disc((-1.4, -0.1, 4.2), 0.9, "sign", YELLOW, sides=20, thickness=0.012),
        box((0.6, -0.09, 4.6), (2.6, -0.08, 5.0), "sign", RED),
        box((0.6, -0.09, 4.0), (2.3, -0.08, 4.2), "sign", DARK),
        box((0.6, -0.09, 3.6), (2.5, -0.08, 3.8), "sign", DARK),
        box((-3.0, -0.75, 2.4), (3.0, -0.1, 2.45), "metal_dark"),
    ]
    for x in (-2.2, 0.0, 2.2):
        parts.append(rod([x, -0.1, 2.5], [x, -0.95, 2.5], 0.025, "metal_dark"))
        parts.append(box((x - 0.2, -1.05, 2.46), (x + 0.2, -0.9, 2.58), "lamp_glow"))
    return parts


def security_camera() -> Shapes:
    """Pole of 4 m with a camera in a housing, a dome and a small sign."""
    return [
        post(4.0, 0.055, sides=8),
        box((-0.16, -0.14, 0.3), (0.16, 0.1, 1.0), "metal_grey"),
        rod([0.0, 0.0, 3.8], [0.0, -0.55, 3.9], 0.03),
        box((-0.09, -0.95, 3.72), (0.09, -0.45, 3.88), "plastic", PALE),
        box((-0.11, -1.0, 3.87), (0.11, -0.4, 3.9), "plastic", PALE),
        cylinder((0, -0.97, 3.8), (0, -0.95, 3.8), 0.06, "car_glass", sides=10),
        rod([0.0, 0.0, 3.4], [0.35, 0.0, 3.4], 0.02),
        lathe([(0.0, 3.16), (0.12, 3.22), (0.14, 3.32), (0.1, 3.4)], "car_glass", sides=10,
              center=(0.4, 0.0)),
        box((-0.17, -0.075, 1.9), (0.17, -0.06, 2.35), "sign", YELLOW),
        box((-0.1, -0.08, 2.05), (0.1, -0.075, 2.25), "sign", DARK),
    ]  # fmt: skip


def speed_camera() -> Shapes:
    """Yellow box on a post that measures how fast one drives."""
    return [
        post(2.4, 0.08, sides=8),
        box((-0.32, -0.38, 2.4), (0.32, 0.38, 3.1), "car_paint", YELLOW),
        box((-0.36, -0.42, 3.1), (0.36, 0.42, 3.14), "metal_dark"),
        box((-0.22, -0.4, 2.75), (0.02, -0.38, 3.0), "car_glass"),
        box((0.08, -0.4, 2.75), (0.26, -0.38, 3.0), "car_glass"),
        box((-0.26, -0.39, 2.45), (0.26, -0.38, 2.6), "sign", DARK),
    ]


def parking_meter() -> Shapes:
    """Meter for one bay: a head with a dial window and a slot on a post."""
    return [
        post(1.15, 0.035, "metal_dark"),
        lathe([(0.08, 1.1), (0.13, 1.18), (0.14, 1.45), (0.09, 1.58), (0.0, 1.61)], "metal_grey",
              sides=10),
        box((-0.09, -0.15, 1.33), (0.09, -0.12, 1.5), "car_glass"),
        box((-0.03, -0.15, 1.22), (0.03, -0.13, 1.28), "metal_dark"),
        disc((0, -0.145, 1.15), 0.035, "sign", YELLOW, sides=8, thickness=0.01),
    ]  # fmt: skip


def charging_station() -> Shapes:
    """Charger for electric cars with two cables, a screen and a lit stripe."""
    parts: Shapes = [
        box((-0.42, -0.28, BURIED), (0.42, 0.28, 0.12), "concrete"),
        box((-0.32, -0.2, 0.12), (0.32, 0.2, 1.85), "car_paint", (0.88, 0.9, 0.9)),
        box((-0.33, -0.21, 1.62), (0.33, 0.21, 1.9), "car_paint", (0.05, 0.5, 0.32)),
        box((-0.2, -0.215, 1.2), (0.2, -0.2, 1.5), "pane", (0.2, 0.4, 0.5)),
        box((-0.3, -0.21, 0.3), (0.3, -0.2, 0.36), "neon_green"),
        prism([(-0.05, 0.6), (0.03, 0.6), (0.1, 0.86), (0.0, 0.84), (0.05, 1.06), (-0.1, 0.76),
               (0.0, 0.77)], -0.215, -0.2, "sign", (0.05, 0.5, 0.32)),
    ]  # fmt: skip
    for side in (-1.0, 1.0):
        parts.append(tube([[0.33 * side, 0.0, 1.4], [0.55 * side, -0.05, 0.9],
                           [0.5 * side, -0.1, 0.25], [0.4 * side, -0.12, 0.7],
                           [0.36 * side, -0.1, 1.15]], 0.022, "rubber", sides=5))  # fmt: skip
        parts.append(box((0.36 * side - 0.05, -0.2, 1.1), (0.36 * side + 0.05, -0.05, 1.28),
                         "plastic", DARK))  # fmt: skip
    return parts


def drinking_fountain() -> Shapes:
    """Fountain to drink from: a bowl on a cast column, a tap and a step."""
    return [
        box((-0.3, -0.55, BURIED), (0.3, -0.2, 0.14), "stone", STONE),
        lathe([(0.2, BURIED), (0.2, 0.1), (0.11, 0.2), (0.1, 0.75), (0.3, 0.9), (0.33, 1.0),
               (0.26, 1.0), (0.2, 0.92), (0.0, 0.9)], "car_paint", (0.06, 0.22, 0.16), sides=12),
        tube([[0.0, 0.22, 0.95], [0.0, 0.22, 1.25], [0.0, 0.05, 1.28], [0.0, 0.02, 1.2]], 0.022,
             "metal_grey", sides=6),
        lathe([(0.0, 0.945), (0.22, 0.95), (0.0, 0.955)], "water", sides=12),
    ]  # fmt: skip


def cash_machine() -> Shapes:
    """Cash machine in a column of its own, with a screen, keys and a lit sign."""
    return [
        box((-0.45, -0.35, BURIED), (0.45, 0.45, 1.95), "car_paint", (0.12, 0.2, 0.38)),
        box((-0.5, -0.5, 1.95), (0.5, 0.5, 2.3), "car_paint", (0.12, 0.2, 0.38)),
        box((-0.4, -0.52, 2.02), (0.4, -0.5, 2.24), "lamp_glow"),
        box((-0.28, -0.37, 1.25), (0.14, -0.35, 1.6), "pane", (0.25, 0.45, 0.6)),
        box((-0.36, -0.5, 1.02), (0.36, -0.35, 1.1), "metal_grey"),
        box((-0.12, -0.46, 1.1), (0.12, -0.38, 1.12), "metal_dark"),
        box((0.2, -0.37, 1.3), (0.34, -0.35, 1.36), "metal_dark"),
        box((-0.2, -0.37, 0.82), (0.2, -0.35, 0.88), "metal_dark"),
    ]


def spotting_scope() -> Shapes:
    """Coin telescope of a viewpoint on a pillar, turned to the front."""
    return [
        box((-0.3, -0.25, BURIED), (0.3, 0.35, 0.12), "concrete"),
        lathe([(0.16, 0.0), (0.1, 0.12), (0.08, 1.1), (0.13, 1.2)], "car_paint", (0.2, 0.3, 0.42),
              sides=10),
        lathe([(0.13, 1.2), (0.2, 1.3), (0.2, 1.5), (0.1, 1.62), (0.0, 1.64)], "metal_grey",
              sides=10),
        cylinder((-0.09, -0.42, 1.44), (-0.09, 0.3, 1.42), 0.075, "metal_grey", sides=10),
        cylinder((0.09, -0.42, 1.44), (0.09, 0.3, 1.42), 0.075, "metal_grey", sides=10),
        cylinder((-0.09, -0.44, 1.44), (-0.09, -0.42, 1.44), 0.06, "car_glass", sides=10),
        cylinder((0.09, -0.44, 1.44), (0.09, -0.42, 1.44), 0.06, "car_glass", sides=10),
        box((-0.05, 0.08, 1.02), (0.05, 0.14, 1.16), "metal_dark"),
    ]  # fmt: skip


def beehives() -> Shapes:
    """Three hives of painted boxes on a stand."""
    parts: Shapes = [box((-1.25, -0.3, 0.2), (1.25, 0.3, 0.28), "bench_wood")]
    for x in (-1.15, 0.0, 1.15):
        parts.append(box((x - 0.06, -0.28, BURIED), (x + 0.06, 0.28, 0.2), "bench_wood"))
    paints: tuple[Color, ...] = ((0.85, 0.75, 0.4), (0.35, 0.55, 0.66), (0.86, 0.86, 0.82))
    for k, tint in enumerate(paints):
        x = -0.8 + 0.8 * k
        for level in range(2 + k % 2):
            z = 0.28 + 0.25 * level
            parts.append(box((x - 0.26, -0.25, z), (x + 0.26, 0.25, z + 0.24), "car_paint", tint))
            parts.append(box((x - 0.08, -0.27, z + 0.12), (x + 0.08, -0.25, z + 0.16),
                             "bench_wood"))  # fmt: skip
        top = 0.28 + 0.25 * (2 + k % 2)
        parts.append(box((x - 0.3, -0.29, top), (x + 0.3, 0.29, top + 0.07), "metal_grey"))
        parts.append(box((x - 0.2, -0.36, 0.29), (x + 0.2, -0.25, 0.32), "bench_wood"))
    return parts


def scarecrow() -> Shapes:
    """Scarecrow of 1.9 m in a coat and a hat, on a cross of poles."""
    coat: Color = (0.30, 0.20, 0.14)
    return [
        rod([0, 0, BURIED], [0, 0, 1.7], 0.03, "bench_wood"),
        rod([-0.8, 0, 1.32], [0.8, 0, 1.36], 0.025, "bench_wood"),
        lathe([(0.3, 0.62), (0.24, 1.0), (0.2, 1.32), (0.08, 1.42)], "cloth", coat, sides=8),
        tube([[-0.72, 0, 1.3], [0.72, 0, 1.36]], 0.09, "cloth", coat, sides=6),
        lathe([(0.0, 1.4), (0.13, 1.46), (0.15, 1.58), (0.08, 1.7), (0.0, 1.71)], "cloth", STRAW,
              sides=8),
        lathe([(0.34, 1.66), (0.34, 1.68), (0.17, 1.69), (0.13, 1.9), (0.0, 1.92)], "cloth",
              (0.22, 0.16, 0.08), sides=10),
        _straw("scarecrow/left", (-0.92, -0.06, 1.24), (-0.7, 0.06, 1.38), 14),
        _straw("scarecrow/right", (0.7, -0.06, 1.28), (0.92, 0.06, 1.42), 14),
        box((-0.08, -0.16, 1.57), (-0.03, -0.13, 1.61), "plastic", DARK),
        box((0.03, -0.16, 1.57), (0.08, -0.13, 1.61), "plastic", DARK),
    ]  # fmt: skip


def _straw(name: str, low: tuple[float, ...], high: tuple[float, ...], count: int) -> MeshBatch:
    """Make loose stalks within a box."""
    rng = rng_for(0, f"assets/{name}", 1)
    a, b = np.array(low), np.array(high)
    centre = a + rng.uniform(0, 1, (count, 3)) * (b - a)
    along = rng.normal(size=(count, 3)) * [0.16, 0.04, 0.08]
    across = np.cross(along, rng.normal(size=(count, 3)))
    across *= 0.012 / np.linalg.norm(across, axis=1, keepdims=True)
    return cards(centre, along, across, "cloth", np.tile(STRAW, (count, 1)), fold=0.0)


def hay_bale() -> Shapes:
    """Round bale of hay of 1.3 m lying on its side, bound with net."""
    parts: Shapes = [
        cylinder((-0.62, 0, 0.62), (0.62, 0, 0.62), 0.65, "thatch", STRAW, sides=20),
    ]
    for far in (0.25, 0.45):
        for x in (-0.63, 0.63):
            ring = [[x, far * float(np.cos(a)), 0.62 + far * float(np.sin(a))]
                    for a in np.linspace(0.0, 2 * np.pi, 13)]  # fmt: skip
            parts.append(tube(ring, 0.022, "thatch", (0.7, 0.52, 0.2), sides=4,
                              caps=(False, False)))  # fmt: skip
    for x in (-0.4, 0.0, 0.4):
        ring = [[x, 0.655 * float(np.cos(a)), 0.62 + 0.655 * float(np.sin(a))]
                for a in np.linspace(0.0, 2 * np.pi, 21)]  # fmt: skip
        parts.append(tube(ring, 0.012, "cloth", PALE, sides=4, caps=(False, False)))
    return parts


def rock() -> Shapes:
    """Boulder of 2.4 m, half buried, with a smaller one beside it."""
    parts: Shapes = []
    for x, y, size, name in ((0.0, 0.0, 1.2, "rock"), (1.35, -0.5, 0.5, "rock/small")):
        rng = rng_for(0, f"assets/{name}", 1)
        turn = np.arange(11) * (2 * np.pi / 11)
        rings = []
        for far, z in ((0.95, BURIED / size), (1.0, 0.25), (0.85, 0.62), (0.5, 0.95), (0.15, 1.08)):
            reach = size * far * rng.uniform(0.84, 1.14, 11)
            rings.append(np.column_stack([
                x + reach * np.cos(turn), y + 0.8 * reach * np.sin(turn),
                size * (z + rng.uniform(-0.05, 0.05, 11) * (z > 0)),
            ]))  # fmt: skip
        parts.append(loft(np.stack(rings), "stone", (0.66, 0.64, 0.6)))
    return parts


def jersey_barrier() -> Shapes:
    """Concrete barrier of 3 m, wide at its foot, with a striped board."""
    outline = [(-0.3, 0.0), (0.3, 0.0), (0.3, 0.08), (0.14, 0.34), (0.09, 0.85), (-0.09, 0.85),
               (-0.14, 0.34), (-0.3, 0.08)]  # fmt: skip
    rings = [[[x, y, z] for y, z in outline] for x in (-1.5, 1.5)]
    parts: Shapes = [loft(np.array(rings), "road_concrete", (0.95, 0.94, 0.9))]
    for x in (-1.0, 0.7):
        parts.append(box((x, -0.36, -0.02), (x + 0.3, 0.36, 0.06), "rubber"))
    for k in range(6):
        low = -0.75 + 0.25 * k
        parts.append(box((low, -0.16, 0.5), (low + 0.25, -0.12, 0.75), "sign",
                         RED if k % 2 else PALE))  # fmt: skip
    return parts


def string_lights() -> Shapes:
    """Two poles of 4 m with a string of lamps between them, 8 m."""
    parts: Shapes = []
    for x in (-4.0, 4.0):
        parts.append(post(4.0, 0.045, "metal_dark", x=x))
        parts.append(lathe([(0.3, BURIED), (0.3, 0.12), (0.06, 0.2)], "metal_dark", sides=10,
                           center=(x, 0.0)))  # fmt: skip
    at = np.linspace(-4.0, 4.0, 17)
    sag = 3.95 - 0.7 * (1.0 - (at / 4.0) ** 2)
    line = np.column_stack([at, np.zeros(17), sag])
    parts.append(tube(line, 0.012, "rubber", sides=4))
    for x, z in zip(at[1:-1].tolist(), sag[1:-1].tolist(), strict=True):
        parts.append(cylinder((x, 0, z - 0.08), (x, 0, z), 0.025, "plastic", DARK, sides=6))
        parts.append(lathe([(0.0, z - 0.2), (0.05, z - 0.16), (0.045, z - 0.1), (0.02, z - 0.08)],
                           "lamp_glow", sides=6, center=(x, 0.0)))  # fmt: skip
    return parts


def bunting() -> Shapes:
    """Two poles of 4 m with a line of coloured pennants between them, 8 m."""
    parts: Shapes = []
    for x in (-4.0, 4.0):
        parts.append(post(4.0, 0.04, "bench_wood", x=x))
        parts.append(lathe([(0.28, BURIED), (0.28, 0.12), (0.06, 0.2)], "metal_dark", sides=10,
                           center=(x, 0.0)))  # fmt: skip
    at = np.linspace(-4.0, 4.0, 21)
    sag = 3.95 - 0.6 * (1.0 - (at / 4.0) ** 2)
    parts.append(tube(np.column_stack([at, np.zeros(21), sag]), 0.01, "cloth", PALE, sides=4))
    tints = (RED, YELLOW, BLUE, GREEN, PALE)
    for k in range(20):
        low, high = at[k] + 0.04, at[k + 1] - 0.04
        z = float((sag[k] + sag[k + 1]) / 2)
        parts.append(prism([(low, z), ((low + high) / 2, z - 0.42), (high, z)], -0.006, 0.006,
                           "cloth", tints[k % len(tints)]))  # fmt: skip
    return parts


def totem_sign() -> Shapes:
    """Totem of a shopping park or a station: a column of panels, 6 m, with arrows."""
    parts: Shapes = [
        box((-0.9, -0.25, BURIED), (0.9, 0.25, 0.4), "concrete"),
        box((-0.75, -0.18, 0.4), (0.75, 0.18, 6.0), "metal_panel", (0.16, 0.18, 0.22)),
    ]
    tints: tuple[Color, ...] = (RED, PALE, BLUE, (0.1, 0.42, 0.2), YELLOW)
    for side in (-1.0, 1.0):
        low, high = sorted((0.18 * side, 0.21 * side))
        for k, tint in enumerate(tints):
            z = 1.3 + 0.9 * k
            parts.append(box((-0.65, low, z), (0.65, high, z + 0.75), "sign", tint))
            line = sorted((0.21 * side, 0.22 * side))
            parts.append(box((-0.45, line[0], z + 0.28), (0.35, line[1], z + 0.46), "sign",
                             PALE if tint != PALE else DARK))  # fmt: skip
    return parts


def food_stall() -> Shapes:
    """Stall with an awning that sells what is cooked there: a grill, a menu and a gas bottle."""
    return [
        *market_stall(),
        box((-1.1, 0.2, 0.0), (0.3, 0.75, 0.9), "metal_grey"),
        box((-1.05, 0.22, 0.9), (0.25, 0.73, 0.93), "metal_dark"),
        cylinder((1.05, 0.5, 0.0), (1.05, 0.5, 0.85), 0.16, "car_paint", RED, sides=10),
        box((-1.75, -1.0, 0.3), (-1.7, -0.4, 1.4), "sign", DARK),
        box((-0.9, -1.27, 1.72), (0.9, -1.24, 2.0), "sign", YELLOW),
    ]


def clothes_bank() -> Shapes:
    """Container for old clothes with a flap and a sign."""
    return [
        box((-0.6, -0.55, BURIED), (0.6, 0.55, 1.75), "car_paint", (0.70, 0.48, 0.05)),
        box((-0.62, -0.57, 1.75), (0.62, 0.57, 1.82), "metal_grey"),
        box((-0.4, -0.6, 1.2), (0.4, -0.55, 1.55), "metal_grey"),
        rod([-0.3, -0.62, 1.2], [0.3, -0.62, 1.2], 0.02),
        box((-0.4, -0.56, 0.5), (0.4, -0.55, 1.0), "sign", PALE),
    ]


TOWN_MAKERS: Mapping[str, Callable[[], Shapes]] = MappingProxyType(
    {
        maker.__name__: maker
        for maker in (
            billboard, security_camera, speed_camera, parking_meter, charging_station,
            drinking_fountain, cash_machine, spotting_scope, beehives, scarecrow, hay_bale, rock,
            jersey_barrier, string_lights, bunting, totem_sign, food_stall, clothes_bank,
        )
    }
)  # fmt: skip
