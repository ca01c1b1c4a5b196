"""What shops and utilities put on pavements: cabinets, ticket machines, stalls, banners, scooters.

Each maker is named for a prototype and returns its shapes: z up, front -y (towards the road),
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
    GREEN,
    GREY,
    PALE,
    RED,
    Shapes,
    post,
)
from cityx.assets.furniture.street_pieces import leaf_mound
from cityx.assets.shapes import Color, box, cylinder, moved, prism, tinted, tube
from cityx.assets.vehicles.two_wheelers import TWO_WHEELERS

CABINET: Color = (0.30, 0.34, 0.31)
CARDBOARD: Color = (0.62, 0.42, 0.24)
FRUIT: tuple[Color, ...] = (
    (0.85, 0.22, 0.04), (0.75, 0.05, 0.03), (0.25, 0.42, 0.05), (0.85, 0.62, 0.06),
    (0.30, 0.05, 0.20), (0.10, 0.28, 0.05),
)  # fmt: skip
GARMENTS: tuple[Color, ...] = (
    (0.65, 0.62, 0.56), (0.08, 0.12, 0.28), (0.45, 0.06, 0.07), (0.06, 0.06, 0.065),
    (0.50, 0.36, 0.14), (0.16, 0.30, 0.26), (0.75, 0.72, 0.70),
)  # fmt: skip
PETALS: tuple[Color, ...] = (
    (2.6, 0.5, 1.2), (4.5, 2.2, 0.3), (3.5, 3.0, 3.5), (3.8, 0.4, 0.3), (2.0, 0.9, 4.0),
)  # fmt: skip


def street_cabinet() -> Shapes:
    """Cabinet of a telephone or power network, 1.2 m wide, with two doors."""
    parts: Shapes = [
        box((-0.62, -0.19, BURIED), (0.62, 0.19, 0.10), "concrete"),
        box((-0.60, -0.17, 0.10), (0.60, 0.17, 1.24), "plastic", CABINET),
        box((-0.64, -0.21, 1.24), (0.64, 0.21, 1.30), "plastic", CABINET),
        box((-0.004, -0.174, 0.16), (0.004, -0.17, 1.2), "plastic", DARK),
        box((0.05, -0.19, 0.62), (0.08, -0.17, 0.76), "metal_dark"),
        box((-0.52, -0.176, 0.86), (-0.24, -0.17, 1.1), "sign", PALE),
        box((0.26, -0.176, 0.52), (0.46, -0.17, 0.82), "sign", (0.75, 0.5, 0.1)),
    ]
    for z in (0.2, 0.25, 0.3):
        parts.append(box((-0.5, -0.176, z), (-0.12, -0.17, z + 0.02), "plastic", DARK))
    return parts


def ticket_machine() -> Shapes:
    """Machine that sells parking tickets, with its sign."""
    return [
        box((-0.15, -0.12, BURIED), (0.15, 0.12, 1.45), "plastic", (0.16, 0.19, 0.22)),
        box((-0.17, -0.15, 1.45), (0.17, 0.14, 1.55), "plastic", GREY),
        box((-0.10, -0.13, 1.12), (0.10, -0.12, 1.28), "sign", (0.35, 0.5, 0.42)),
        box((-0.10, -0.13, 0.86), (0.02, -0.12, 1.02), "metal_grey"),
        post(2.25, 0.025, y=0.09),
        box((-0.15, 0.05, 1.95), (0.15, 0.07, 2.35), "sign", BLUE),
        box((-0.06, 0.04, 2.03), (-0.02, 0.05, 2.27), "sign"),
        box((-0.02, 0.04, 2.14), (0.07, 0.05, 2.27), "sign"),
    ]


def fruit_stand() -> Shapes:
    """Tiers of crates with fruit before a shop, 1.8 m wide."""
    parts: Shapes = [
        prism([(-0.9, 0.0), (0.9, 0.0), (0.9, 0.36), (-0.9, 0.36)], -0.34, 0.3, "bench_wood")
    ]
    for row, (y, z) in enumerate(((-0.2, 0.40), (0.14, 0.62))):
        parts.append(box((-0.9, y - 0.17, z - 0.3), (0.9, y + 0.17, z), "bench_wood"))
        for column in range(4):
            x = -0.675 + 0.45 * column
            for wall in (-0.2, 0.2):
                parts.append(
                    box((x + wall - 0.01, y - 0.16, z), (x + wall + 0.01, y + 0.16, z + 0.12),
                        "bench_wood")
                )  # fmt: skip
            color = FRUIT[(column + 3 * row) % len(FRUIT)]
            parts.append(box((x - 0.19, y - 0.15, z), (x + 0.19, y + 0.15, z + 0.1), "sign", color))
    return parts


def clothes_rail() -> Shapes:
    """Rail of garments before a shop, 1.5 m wide."""
    parts: Shapes = [tube([[-0.75, 0, 1.5], [0.75, 0, 1.5]], 0.015, "metal_grey", sides=5)]
    for x in (-0.75, 0.75):
        parts.append(tube([[x, 0, 0.08], [x, 0, 1.5]], 0.015, "metal_grey", sides=5))
        parts.append(box((x - 0.02, -0.25, 0.0), (x + 0.02, 0.25, 0.09), "metal_grey"))
    for number, x in enumerate(np.linspace(-0.66, 0.66, 13)):
        low = 0.62 + 0.09 * (number * 7 % 4)
        color = GARMENTS[number * 5 % len(GARMENTS)]
        parts.append(box((x - 0.03, -0.21, low), (x + 0.03, 0.21, 1.45), "cloth", color))
    return parts


def flower_stand() -> Shapes:
    """Buckets of cut flowers on a step, 1.5 m wide."""
    parts: Shapes = [box((-0.75, 0.0, 0.0), (0.75, 0.32, 0.28), "bench_wood")]
    for row, (y, z) in enumerate(((-0.16, 0.0), (0.16, 0.28))):
        for column in range(4):
            x = -0.56 + 0.375 * column
            foot = (x, y, z)
            parts.append(cylinder(foot, (x, y, z + 0.3), 0.10, "metal_grey", top=0.13, sides=8))
            mound = leaf_mound(f"flowers {row}{column}", (x - 0.17, y - 0.15, z + 0.28),
                               (x + 0.17, y + 0.15, z + 0.58), 26, size=0.06)  # fmt: skip
            parts.append(tinted(mound, PETALS[(column + 2 * row) % len(PETALS)])
                         if (row + column) % 3 else mound)  # fmt: skip
    return parts


def _banner(color: Color) -> Shapes:
    parts: Shapes = [
        cylinder((0, 0, 0), (0, 0, 0.12), 0.2, "plastic", PALE, sides=8),
        post(2.5, 0.014, "metal_grey"),
        tube([[0, 0, 2.45], [0.62, 0, 2.45]], 0.01, "metal_grey", sides=4),
        box((0.02, -0.006, 0.68), (0.6, 0.006, 2.43), "cloth", color),
    ]
    for row in range(5):  # writing, seen from both sides
        z = 2.12 - 0.29 * row
        wide = (0.16, 0.20, 0.13, 0.18, 0.15)[row]
        parts.append(box((0.31 - wide, -0.009, z), (0.31 + wide, 0.009, z + 0.05), "cloth", PALE))
        parts.append(box((0.29, -0.009, z - 0.1), (0.33, 0.009, z + 0.13), "cloth", PALE))
    return parts


def banner_red() -> Shapes:
    """Upright banner of a shop on a pole, 2.5 m, red."""
    return _banner((0.75, 0.07, 0.05))


def banner_blue() -> Shapes:
    """Upright banner of a shop on a pole, 2.5 m, blue."""
    return _banner((0.05, 0.16, 0.45))


def cartons() -> Shapes:
    """Pile of boxes and a bag that wait for the dustmen."""
    parts: Shapes = [
        box((-0.5, -0.22, 0.0), (-0.02, 0.22, 0.34), "cloth", CARDBOARD),
        moved(box((-0.22, -0.2, 0.34), (0.2, 0.2, 0.62), "cloth", CARDBOARD), (-0.26, 0.0, 0.0),
              yaw=0.2),
        moved(box((-0.28, -0.02, 0.0), (0.28, 0.02, 0.8), "cloth", CARDBOARD), (0.32, 0.18, 0.0)),
    ]  # fmt: skip
    for x, y, r in ((0.2, -0.06, 0.24), (0.5, -0.02, 0.2)):
        parts.append(cylinder((x, y, 0.0), (x, y, 1.7 * r), r, "plastic", DARK, top=0.5 * r,
                              sides=7))  # fmt: skip
    return parts


def _scooter(color: Color) -> Shapes:
    model = TWO_WHEELERS["scooter"]
    parts = [tinted(part, color) if part.materials == ("car_paint",) else part
             for part in model.parts(model)]  # fmt: skip
    for _, y, z in model.wheel_places():
        for wide, radius, material in ((0.05, model.wheel, "rubber"), (0.056, 0.13, "metal_grey")):
            parts.append(cylinder((-wide, y, z), (wide, y, z), radius, material, sides=12))
    return [*parts, tube([[0.0, 0.05, 0.26], [0.16, 0.1, 0.0]], 0.014, "metal_dark", sides=4)]


def motor_scooter() -> Shapes:
    """Parked motor scooter, 1.8 m long, along y; pale."""
    return _scooter((0.85, 0.85, 0.82))


def motor_scooter_red() -> Shapes:
    """Parked motor scooter, red."""
    return _scooter(RED)


def motor_scooter_dark() -> Shapes:
    """Parked motor scooter, dark green."""
    return _scooter(GREEN)


CLUTTER_MAKERS: Mapping[str, Callable[[], Shapes]] = MappingProxyType(
    {
        maker.__name__: maker
        for maker in (
            street_cabinet, ticket_machine, fruit_stand, clothes_rail, flower_stand, banner_red,
            banner_blue, cartons, motor_scooter, motor_scooter_red, motor_scooter_dark,
        )
    }
)  # fmt: skip
