"""Street furniture at real size: lamps, benches, shelters, signs, signals.

Each maker below is named for a prototype and returns its shapes: z up, front -y (towards the road),
origin on the ground at the foot.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import lru_cache
from types import MappingProxyType

import numpy as np

from cityx.assets.furniture.animal_pieces import ANIMAL_MAKERS
from cityx.assets.furniture.drawn_pieces import DRAWN_MAKERS, looks_of
from cityx.assets.furniture.furniture_parts import (
    BLUE,
    BURIED,
    DARK,
    GREEN,
    RED,
    STONE,
    YELLOW,
    Shapes,
    post,
)
from cityx.assets.furniture.landmark_pieces import LANDMARK_MAKERS
from cityx.assets.furniture.large_pieces import LARGE_MAKERS
from cityx.assets.furniture.outside_pieces import StreetObject, read_pieces
from cityx.assets.furniture.park_pieces import PARK_MAKERS
from cityx.assets.furniture.potted_plants import POT_MAKERS
from cityx.assets.furniture.regional_pieces import REGIONAL_MAKERS
from cityx.assets.furniture.shore_pieces import SHORE_MAKERS
from cityx.assets.furniture.street_clutter import CLUTTER_MAKERS
from cityx.assets.furniture.street_pieces import STREET_MAKERS
from cityx.assets.furniture.town_pieces import TOWN_MAKERS
from cityx.assets.furniture.utility_poles import POLE_MAKERS
from cityx.assets.furniture.wall_pieces import WALL_MAKERS, YARD_MAKERS
from cityx.assets.kept_prototypes import kept
from cityx.assets.shapes import (
    Color,
    box,
    cards,
    cylinder,
    disc,
    fine_shapes,
    lathe,
    loft,
    moved,
    prism,
    prototype,
    tube,
)
from cityx.city.scene import Prototype
from cityx.ids import rng_for
from cityx.system.extensions import remembered

FINE = 3  # level of detail from which edges are chamfered and round things round


def street_lamp_mast() -> Shapes:
    """Mast of 8 m with an arm over the carriageway, for main roads."""
    arm = [[0, 0, 7.2], [0, -0.25, 7.75], [0, -0.8, 8.05], [0, -1.5, 8.15]]
    return [
        cylinder((0, 0, BURIED), (0, 0, 1.1), 0.11, "metal_grey", sides=8, caps=(False, True)),
        cylinder((0, 0, 1.1), (0, 0, 7.3), 0.085, "metal_grey", top=0.055, sides=8),
        tube(arm, [0.05, 0.045, 0.04, 0.035], "metal_grey", sides=6),
        prism([(-0.14, 8.10), (0.14, 8.10), (0.09, 8.22), (-0.09, 8.22)], -2.1, -1.4, "metal_grey"),
        box((-0.11, -2.05, 8.075), (0.11, -1.5, 8.10), "lamp_glow"),
    ]


def street_lamp_post() -> Shapes:
    """Post-top lamp of 4.5 m, for residential streets."""
    return [
        cylinder((0, 0, BURIED), (0, 0, 0.9), 0.08, "metal_dark", sides=8, caps=(False, True)),
        cylinder((0, 0, 0.9), (0, 0, 3.95), 0.05, "metal_dark", top=0.04, sides=8),
        lathe([(0.05, 3.93), (0.11, 3.98), (0.20, 4.38), (0.20, 4.40)], "lamp_glow", sides=10),
        lathe([(0.25, 4.39), (0.25, 4.42), (0.14, 4.50), (0.0, 4.56)], "metal_dark", sides=10),
    ]


def bench() -> Shapes:
    """Wooden bench with a back, 1.8 m wide."""
    parts: Shapes = []
    for y in (-0.24, -0.10, 0.04):
        parts.append(box((-0.9, y - 0.06, 0.43), (0.9, y + 0.06, 0.47), "bench_wood"))
    for z, y in ((0.60, 0.15), (0.76, 0.19)):
        parts.append(box((-0.9, y, z - 0.06), (0.9, y + 0.035, z + 0.06), "bench_wood"))
    for x in (-0.7, 0.7):
        parts.append(box((x - 0.03, -0.28, BURIED), (x + 0.03, -0.20, 0.43), "metal_dark"))
        parts.append(box((x - 0.03, 0.05, BURIED), (x + 0.03, 0.12, 0.43), "metal_dark"))
        parts.append(box((x - 0.03, -0.28, 0.39), (x + 0.03, 0.14, 0.43), "metal_dark"))
        parts.append(tube([[x, 0.10, 0.40], [x, 0.24, 0.86]], 0.03, "metal_dark", sides=4))
    return parts


def waste_basket() -> Shapes:
    """Litter bin on a post."""
    return [
        post(1.0, 0.035, "metal_dark", y=0.2),
        lathe([(0.17, 0.38), (0.20, 0.45), (0.20, 0.92), (0.21, 0.95)], "plastic",
              (0.95, 0.42, 0.05), sides=10),
        lathe([(0.21, 0.95), (0.17, 1.02), (0.08, 1.05)], "metal_dark", sides=10),
        box((-0.11, -0.215, 0.78), (0.11, -0.18, 0.88), "metal_dark"),
    ]  # fmt: skip


def bollard() -> Shapes:
    """Steel bollard with a bright band, 0.95 m."""
    return [
        lathe([(0.06, BURIED), (0.06, 0.74), (0.062, 0.74), (0.062, 0.84), (0.06, 0.84),
               (0.06, 0.90), (0.035, 0.95), (0.0, 0.96)], "metal_dark", sides=10),
        lathe([(0.064, 0.75), (0.064, 0.83)], "sign", STONE, sides=10),
    ]  # fmt: skip


def bus_stop() -> Shapes:
    """Shelter of glass with a seat and a stop pole, open to the road."""
    parts: Shapes = []
    for x in (-1.9, 0.0, 1.9):
        parts.append(box((x - 0.04, 0.62, BURIED), (x + 0.04, 0.70, 2.42), "metal_dark"))
    for x in (-1.9, 1.9):
        parts.append(box((x - 0.04, -0.50, BURIED), (x + 0.04, -0.42, 2.42), "metal_dark"))
        parts.append(box((x - 0.012, -0.40, 0.25), (x + 0.012, 0.60, 2.20), "glass"))
    for x in (-1.82, 0.08):
        parts.append(box((x, 0.65, 0.25), (x + 1.74, 0.67, 2.20), "glass"))
    parts.append(box((-2.1, -0.75, 2.42), (2.1, 0.80, 2.54), "metal_grey"))
    parts.append(box((-2.1, -0.77, 2.40), (2.1, -0.75, 2.56), "sign", YELLOW))
    parts.append(box((-1.4, 0.30, 0.44), (0.9, 0.60, 0.48), "bench_wood"))
    for x in (-1.2, 0.7):
        parts.append(box((x - 0.03, 0.42, BURIED), (x + 0.03, 0.48, 0.44), "metal_dark"))
    parts.append(box((1.0, 0.55, 0.8), (1.8, 0.60, 2.0), "sign", (0.9, 0.9, 0.88)))
    return parts + [moved(part, (2.9, -0.35, 0.0)) for part in bus_pole()]


def bus_pole() -> Shapes:
    """Stop pole with a round sign and a timetable case."""
    return [
        post(2.75, 0.035),
        moved(disc((0, 0, 2.55), 0.26, "sign", GREEN, thickness=0.03), (0, 0, 0), yaw=np.pi / 2),
        moved(disc((0, -0.008, 2.55), 0.21, "sign", YELLOW, thickness=0.046), yaw=np.pi / 2),
        box((-0.24, -0.06, 1.15), (0.24, -0.03, 1.75), "sign", (0.9, 0.9, 0.88)),
    ]


def _head() -> Shapes:
    """Head of three lights, facing -y; the red one burns unless it is known what is shown."""
    parts = [
        box((-0.16, -0.10, 2.30), (0.16, 0.12, 3.25), "plastic", DARK),
        box((-0.27, 0.10, 2.18), (0.27, 0.125, 3.37), "plastic", DARK),
    ]
    for z, light in ((3.08, "signal_stop"), (2.775, "signal_amber"), (2.47, "signal_green")):
        parts.append(disc((0, -0.115, z), 0.105, light, sides=10, thickness=0.016))
        hood = [(-0.12, z + 0.03), (0.12, z + 0.03), (0.07, z + 0.125), (-0.07, z + 0.125)]
        parts.append(prism(hood, -0.24, -0.10, "plastic", DARK))
    return parts


def traffic_signal() -> Shapes:
    """Pole with a head of three lights that faces -y and a push button."""
    return [
        cylinder((0, 0.2, BURIED), (0, 0.2, 3.5), 0.06, "metal_grey", sides=8, caps=(False, True)),
        box((-0.03, 0.1, 2.45), (0.03, 0.2, 2.52), "metal_grey"),
        box((-0.03, 0.1, 3.05), (0.03, 0.2, 3.12), "metal_grey"),
        box((-0.07, 0.10, 0.95), (0.07, 0.16, 1.22), "plastic", YELLOW),
        *_head(),
    ]


def traffic_signal_mast() -> Shapes:
    """Signal with a second head on an arm over the carriageway, for main roads.

    The arm reaches to -x, which is over the lanes where traffic keeps right.
    """
    arm = [[0, 0.2, 5.3], [-0.6, 0.2, 5.75], [-3.6, 0.2, 5.95]]
    return [
        cylinder((0, 0.2, BURIED), (0, 0.2, 5.4), 0.09, "metal_grey", top=0.07, sides=8,
                 caps=(False, True)),
        tube(arm, [0.07, 0.06, 0.045], "metal_grey", sides=6),
        box((-0.03, 0.1, 2.75), (0.03, 0.2, 2.85), "metal_grey"),
        box((-3.43, 0.1, 5.85), (-3.37, 0.2, 5.98), "metal_grey"),
        *_head(),
        *(moved(part, (-3.4, 0.0, 2.62)) for part in _head()),
    ]  # fmt: skip


def sign_stop() -> Shapes:
    """Octagonal stop sign."""
    return [
        post(2.75),
        disc((0, -0.055, 2.35), 0.40, "sign", (1, 1, 1), sides=8, thickness=0.02),
        disc((0, -0.065, 2.35), 0.375, "sign", RED, sides=8, thickness=0.02),
        *(box((x - 0.045, -0.07, 2.27), (x + 0.045, -0.06, 2.43), "sign")
          for x in (-0.21, -0.07, 0.07, 0.21)),
    ]  # fmt: skip


def sign_give_way() -> Shapes:
    """Triangle that stands on its tip."""

    def triangle(size: float) -> list[tuple[float, float]]:
        return [(0.0, 2.32 - 0.577 * 2 * size), (size, 2.32 + 0.577 * size),
                (-size, 2.32 + 0.577 * size)]  # fmt: skip

    return [
        post(2.7),
        prism(triangle(0.45), -0.055, -0.035, "sign", RED),
        prism(triangle(0.29), -0.062, -0.05, "sign"),
    ]


def sign_speed() -> Shapes:
    """Round sign with a red ring."""
    return [
        post(2.7),
        disc((0, -0.055, 2.38), 0.30, "sign", RED, sides=16, thickness=0.02),
        disc((0, -0.062, 2.38), 0.235, "sign", sides=16, thickness=0.02),
        box((-0.13, -0.068, 2.27), (-0.03, -0.06, 2.49), "sign", DARK),
        box((0.03, -0.068, 2.27), (0.13, -0.06, 2.49), "sign", DARK),
    ]


def fire_hydrant() -> Shapes:
    """Pillar hydrant with two outlets."""
    return [
        lathe([(0.17, BURIED), (0.17, 0.05), (0.11, 0.07), (0.11, 0.52), (0.14, 0.54), (0.14, 0.60),
               (0.11, 0.68), (0.05, 0.74), (0.05, 0.79), (0.0, 0.79)], "plastic", RED, sides=12),
        cylinder((-0.20, 0, 0.44), (0.20, 0, 0.44), 0.05, "plastic", RED, sides=8),
        cylinder((0, -0.19, 0.36), (0, 0, 0.36), 0.06, "plastic", RED, sides=8),
    ]  # fmt: skip


def post_box() -> Shapes:
    """Post box on a post, slot to the front."""
    return [
        box((-0.06, 0.0, BURIED), (0.06, 0.12, 0.75), "metal_dark"),
        box((-0.28, -0.16, 0.72), (0.28, 0.22, 1.28), "plastic", YELLOW),
        prism([(-0.30, 1.28), (0.30, 1.28), (0.22, 1.40), (-0.22, 1.40)], -0.18, 0.24, "plastic",
              YELLOW),
        box((-0.20, -0.175, 1.14), (0.20, -0.155, 1.19), "metal_dark"),
        box((-0.16, -0.17, 0.86), (0.16, -0.155, 1.04), "sign"),
    ]  # fmt: skip


def telephone() -> Shapes:
    """Telephone box of glass in a frame."""
    parts: Shapes = [
        box((-0.46, -0.46, BURIED), (0.46, 0.46, 0.12), "plastic", RED),
        box((-0.46, -0.46, 2.15), (0.46, 0.46, 2.42), "plastic", RED),
        prism([(-0.42, 2.42), (0.42, 2.42), (0.22, 2.56), (-0.22, 2.56)], -0.42, 0.42, "plastic",
              RED),
        box((-0.36, -0.475, 2.20), (0.36, -0.455, 2.36), "sign"),
        box((-0.14, 0.20, 1.05), (0.14, 0.38, 1.65), "metal_dark"),
        box((-0.40, 0.41, 0.12), (0.40, 0.43, 2.15), "glass"),
        box((-0.43, -0.40, 0.12), (-0.41, 0.40, 2.15), "glass"),
        box((0.41, -0.40, 0.12), (0.43, 0.40, 2.15), "glass"),
    ]  # fmt: skip
    for x in (-0.42, 0.42):
        for y in (-0.42, 0.42):
            parts.append(
                box((x - 0.04, y - 0.04, 0.12), (x + 0.04, y + 0.04, 2.15), "plastic", RED)
            )
    for z in (0.62, 1.13, 1.64):
        for x in (-0.42, 0.42):
            parts.append(box((x - 0.02, -0.4, z - 0.02), (x + 0.02, 0.4, z + 0.02), "plastic", RED))
    return parts


def bicycle_parking() -> Shapes:
    """Three tubular stands, one metre apart."""
    parts: Shapes = []
    for x in (-1.0, 0.0, 1.0):
        hoop = [[x, -0.38, BURIED], [x, -0.38, 0.62], [x, -0.26, 0.78], [x, 0.26, 0.78],
                [x, 0.38, 0.62], [x, 0.38, BURIED]]  # fmt: skip
        parts.append(tube(hoop, 0.025, "metal_grey", sides=6, caps=(False, False)))
    return parts


def fountain() -> Shapes:
    """Round basin of stone with a bowl and a column."""
    return [
        lathe([(2.0, BURIED), (2.05, 0.10), (1.95, 0.16), (1.95, 0.50), (2.10, 0.56), (2.10, 0.64),
               (1.80, 0.64), (1.78, 0.20), (0.0, 0.20)], "stone", STONE, sides=16),
        lathe([(1.79, 0.50), (0.0, 0.505)], "water", sides=16),
        lathe([(0.45, 0.2), (0.38, 0.4), (0.20, 0.7), (0.18, 1.3), (0.30, 1.42), (0.85, 1.62),
               (0.90, 1.70), (0.82, 1.70), (0.30, 1.60), (0.0, 1.60)], "stone", STONE, sides=12),
        lathe([(0.80, 1.67), (0.0, 1.675)], "water", sides=12),
        lathe([(0.13, 1.55), (0.10, 2.1), (0.16, 2.2), (0.10, 2.36), (0.0, 2.45)], "stone", STONE,
              sides=8),
    ]  # fmt: skip


def advertising_column() -> Shapes:
    """Round column with bills, 3.4 m."""
    parts: Shapes = [
        lathe([(0.72, BURIED), (0.72, 0.35), (0.65, 0.38), (0.65, 2.85)], "concrete", sides=16),
        lathe([(0.78, 2.85), (0.80, 3.0), (0.70, 3.1), (0.35, 3.30), (0.06, 3.38), (0.0, 3.5)],
              "metal_dark", sides=16),
    ]  # fmt: skip
    bills: tuple[Color, ...] = (
        RED,
        (0.9, 0.85, 0.7),
        BLUE,
        YELLOW,
        (0.85, 0.9, 0.9),
        (0.2, 0.5, 0.4),
    )
    for index, color in enumerate(bills):
        a = 2 * np.pi * (index + np.array([0.06, 0.5, 0.94])) / len(bills)
        arc = np.column_stack([np.cos(a), np.sin(a)])
        low, high = 0.6 + 0.12 * (index % 3), 2.35 + 0.1 * (index % 4)
        ring = np.vstack([arc * 0.675, arc[::-1] * 0.66])
        rings = [np.column_stack([ring, np.full(6, z)]) for z in (low, high)]
        parts.append(loft(np.stack(rings), "sign", color))
    return parts


def power_pole() -> Shapes:
    """Wooden pole of 9 m with a cross-arm and insulators."""
    parts: Shapes = [
        cylinder((0, 0, -0.4), (0, 0, 9.0), 0.15, "bark", (1.3, 1.25, 1.2), top=0.10, sides=8),
        box((-1.1, -0.06, 8.4), (1.1, 0.06, 8.52), "bench_wood"),
    ]
    for x in (-0.95, -0.4, 0.4, 0.95):
        parts.append(cylinder((x, 0, 8.52), (x, 0, 8.72), 0.045, "plastic", (0.4, 0.25, 0.15),
                              top=0.03, sides=6))  # fmt: skip
    return parts


def statue() -> Shapes:
    """Standing figure of bronze on a plinth."""
    bronze: Color = (0.12, 0.17, 0.13)
    return [
        box((-0.8, -0.8, BURIED), (0.8, 0.8, 0.3), "stone", STONE),
        box((-0.55, -0.55, 0.3), (0.55, 0.55, 1.7), "stone", STONE),
        box((-0.65, -0.65, 1.7), (0.65, 0.65, 1.85), "stone", STONE),
        lathe([(0.34, 1.85), (0.30, 2.2), (0.24, 2.75), (0.22, 2.85), (0.28, 3.25), (0.27, 3.35),
               (0.09, 3.45), (0.08, 3.52)], "plastic", bronze, sides=10),
        lathe([(0.05, 3.50), (0.115, 3.58), (0.12, 3.68), (0.06, 3.79), (0.0, 3.80)], "plastic",
              bronze, sides=8),
        tube([[0.27, 0, 3.30], [0.36, -0.10, 2.95], [0.22, -0.32, 2.80]], [0.08, 0.07, 0.05],
             "plastic", bronze, sides=6),
        tube([[-0.27, 0, 3.30], [-0.38, 0.02, 2.95], [-0.34, -0.10, 2.65]], [0.08, 0.07, 0.05],
             "plastic", bronze, sides=6),
    ]  # fmt: skip


def vending_machine() -> Shapes:
    """Drinks machine with a lit front."""
    parts: Shapes = [
        box((-0.5, -0.35, 0.0), (0.5, 0.38, 1.83), "plastic", (0.75, 0.06, 0.05)),
        box((-0.44, -0.365, 0.95), (0.44, -0.345, 1.74), "sign"),
        box((-0.32, -0.37, 0.18), (0.32, -0.345, 0.38), "metal_dark"),
        box((0.22, -0.37, 0.55), (0.42, -0.345, 0.85), "metal_grey"),
    ]
    for row in range(3):
        for column in range(6):
            x, z = -0.36 + 0.144 * column, 1.02 + 0.25 * row
            color = (RED, GREEN, BLUE, YELLOW, (0.3, 0.15, 0.05))[(column + 2 * row) % 5]
            parts.append(box((x - 0.035, -0.40, z), (x + 0.035, -0.36, z + 0.15), "plastic", color))
    return parts


def recycling() -> Shapes:
    """Pair of domed containers."""
    parts: Shapes = []
    for x, color in ((-0.85, GREEN), (0.85, (0.85, 0.87, 0.85))):
        parts.append(
            lathe([(0.62, 0.05), (0.75, 0.15), (0.75, 0.9), (0.68, 1.25), (0.42, 1.52),
                   (0.10, 1.6)], "plastic", color, sides=12, center=(x, 0.0))
        )  # fmt: skip
        parts.append(cylinder((x, -0.80, 1.12), (x, 0, 1.12), 0.13, "metal_dark", sides=8))
        parts.append(box((x - 0.25, -0.77, 0.5), (x + 0.25, -0.70, 0.8), "sign"))
    return parts


def flagpole() -> Shapes:
    """Pole of 9 m with a hanging flag."""
    wave = np.linspace(0.0, 1.5, 7)
    z = 8.6 - 0.10 * wave**1.5
    side = 0.08 * np.sin(3.5 * wave)
    edge = [np.column_stack([0.06 + wave, side + s, z]) for s in (-0.006, 0.006)]
    ring = [np.vstack([e - [0, 0, 0.95], e[::-1]]) for e in edge]
    parts: Shapes = [
        cylinder((0, 0, BURIED), (0, 0, 9.0), 0.07, "metal_grey", top=0.035, sides=8),
        lathe([(0.0, 8.98), (0.07, 9.05), (0.0, 9.12)], "metal_grey", sides=6),
    ]
    front, back = ring[0], ring[1]
    for piece in range(6):
        pick = [piece, piece + 1, 12 - piece, 13 - piece]
        parts.append(loft(np.stack([back[pick], front[pick]]), "cloth", (0.75, 0.12, 0.10)))
    return parts


def fence_segment() -> Shapes:
    """Two metres of steel fence with pickets."""
    parts: Shapes = [
        box((x - 0.025, -0.025, BURIED), (x + 0.025, 0.025, 1.15), "metal_dark") for x in (-1, 1)
    ]
    for z in (0.18, 1.05):
        parts.append(box((-1, -0.015, z - 0.02), (1, 0.015, z + 0.02), "metal_dark"))
    for x in np.linspace(-0.86, 0.86, 13):
        parts.append(box((x - 0.008, -0.008, 0.1), (x + 0.008, 0.008, 1.12), "metal_dark"))
    return parts


def wall_segment() -> Shapes:
    """Two metres of garden wall with a coping."""
    return [
        box((-1, -0.12, -0.3), (1, 0.12, 1.1), "brick", (0.62, 0.34, 0.26)),
        box((-1, -0.16, 1.1), (1, 0.16, 1.18), "concrete"),
    ]


def hedge_segment() -> Shapes:
    """Two metres of clipped hedge: a body in the shade and a skin of leaves."""
    rng = rng_for(0, "assets/hedge", 1)
    count = 440
    side = rng.choice(3, count, p=[0.37, 0.37, 0.26])  # front, back, top
    x, s = rng.uniform(-1.02, 1.02, count), rng.uniform(-1, 1, count)
    # Clipped, but not ruled: the face swells and sinks by a few centimetres.
    swell = 0.025 * np.sin(5.1 * x + 2.3 * s) + 0.02 * rng.normal(size=count)
    y = np.select([side == 0, side == 1], [-0.32 - swell, 0.32 + swell], 0.33 * s)
    z = np.where(side == 2, 1.21 + swell, 0.08 + 0.57 * (s + 1))
    normal = np.stack([np.zeros(count), np.sign(y) * (side < 2), 1.0 * (side == 2)], axis=1)
    normal = normal + 0.42 * rng.normal(size=(count, 3)) + [0, 0, 0.25]
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    along = np.cross(normal, rng.normal(size=(count, 3)))
    along *= 0.086 / np.linalg.norm(along, axis=1, keepdims=True)
    tint = rng.uniform(0.55, 1.10, (count, 1)) * (0.62 + 0.33 * z[:, None]) * [0.9, 0.9, 0.85]
    centre = np.column_stack([x, y, z])
    leaves = cards(centre, along, 0.7 * np.cross(normal, along), "leaf", tint)
    return [box((-1, -0.30, -0.2), (1, 0.30, 1.19), "hedge", (0.5, 0.5, 0.5)), leaves]


def bus() -> Shapes:
    """City bus of 12 m; front -y."""
    parts: Shapes = [
        box((-1.25, -6.0, 0.32), (1.25, 6.0, 1.15), "car_paint"),
        box((-1.24, -5.98, 1.15), (1.24, 5.98, 2.55), "car_glass"),
        box((-1.25, -6.0, 2.55), (1.25, 6.0, 3.05), "car_paint"),
        box((-1.0, -3.5, 3.05), (1.0, 2.5, 3.22), "car_paint"),
        box((-0.8, -6.02, 2.62), (0.8, -5.99, 2.92), "lamp_glow"),
    ]
    for y in (-4.6, -2.4, -0.2, 2.0, 4.2):
        for x in (-1.25, 1.25):
            parts.append(box((x - 0.01, y - 0.06, 1.15), (x + 0.01, y + 0.06, 2.55), "car_paint"))
    for y in (-3.3, 3.0):
        for x in (-1.24, 1.24):
            inner = x - 0.28 * np.sign(x)
            low, high = min(inner, x + 0.02 * np.sign(x)), max(inner, x + 0.02 * np.sign(x))
            parts.append(cylinder((low, y, 0.48), (high, y, 0.48), 0.48, "rubber", sides=12))
    for x in (-0.9, 0.9):
        parts.append(box((x - 0.18, -6.03, 0.62), (x + 0.18, -5.99, 0.82), "lamp_glow"))
        parts.append(box((x - 0.12, 5.99, 0.62), (x + 0.12, 6.03, 0.95), "signal_red"))
    return parts


MAKERS: Mapping[str, Callable[[], Shapes]] = MappingProxyType(
    {
        maker.__name__: maker
        for maker in (
            street_lamp_mast, street_lamp_post, bench, waste_basket, bollard, bus_stop, bus_pole,
            traffic_signal, traffic_signal_mast, sign_stop, sign_give_way, sign_speed, fire_hydrant,
            post_box, telephone, bicycle_parking, fountain, advertising_column, power_pole, statue,
            vending_machine, recycling, flagpole, fence_segment, wall_segment, hedge_segment, bus,
        )
    }
    | dict(STREET_MAKERS)
    | dict(POLE_MAKERS)
    | dict(CLUTTER_MAKERS)
    | dict(WALL_MAKERS)
    | dict(PARK_MAKERS)
    | dict(SHORE_MAKERS)
    | dict(YARD_MAKERS)
    | dict(POT_MAKERS)
    | dict(REGIONAL_MAKERS)
    | dict(LARGE_MAKERS)
    | dict(LANDMARK_MAKERS)
    | dict(TOWN_MAKERS)
    | dict(DRAWN_MAKERS)
    | dict(ANIMAL_MAKERS)
)  # fmt: skip

# Pieces of which there are several looks -> the names of all of them.
VARIANTS: Mapping[str, tuple[str, ...]] = MappingProxyType(
    looks_of([*DRAWN_MAKERS]) | looks_of([*ANIMAL_MAKERS]) | {"tent": ("tent", "tent_orange")}
)


@remembered
def outside_pieces() -> Mapping[str, StreetObject]:
    """Return the street objects that installed packages add, by name."""
    return read_pieces(MAKERS.__contains__)


def furniture(name: str, *, detail: int = 2) -> Prototype:
    """Make one piece of street furniture, by its name in `MAKERS` or `outside_pieces`.

    Raises
    ------
    KeyError
        If there is no such piece.
    """
    if name in MAKERS:
        return _built_in(name, detail=detail)
    return prototype(name, "furniture", [outside_pieces()[name].draw()])


@lru_cache(maxsize=256)
@kept("furniture", least=2)
def _built_in(name: str, *, detail: int = 2) -> Prototype:
    kind = "vehicle" if name == "bus" else "furniture"
    if detail >= FINE:
        with fine_shapes():
            return prototype(f"{name}_fine", kind, MAKERS[name]())
    return prototype(name, kind, MAKERS[name]())
