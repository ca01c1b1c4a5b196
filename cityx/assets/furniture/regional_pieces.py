"""Street furniture that each region builds in its own way: hydrants, post boxes, bins, posts.

Each maker is named for a prototype and returns its shapes: z up, front -y (towards the road),
origin on the ground at the foot. Profiles of places tell which stands for the usual piece.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from cityx.assets.furniture.furniture_parts import (
    BLUE,
    BURIED,
    DARK,
    PALE,
    RED,
    YELLOW,
    Shapes,
    post,
)
from cityx.assets.shapes import Color, box, cylinder, disc, lathe, loft, moved, prism, tube
from cityx.assets.shops.lettering import word

GOLD: Color = (0.62, 0.44, 0.10)
CRIMSON: Color = (0.62, 0.025, 0.02)
MAGENTA: Color = (0.72, 0.02, 0.22)
STEEL: Color = (1.0, 1.0, 1.0)


def fire_hydrant_cover() -> Shapes:
    """Oval iron lid of a hydrant below the pavement, with a plate on a short post behind it."""
    return [
        lathe([(0.21, -0.05), (0.21, 0.006), (0.0, 0.006)], "concrete", (1.2, 1.2, 1.2), sides=16),
        lathe([(0.17, -0.05), (0.17, 0.012), (0.0, 0.012)], "metal_dark", sides=16),
        post(1.15, 0.024, y=0.12),
        box((-0.10, 0.08, 0.92), (0.10, 0.095, 1.17), "sign", RED),
        box((-0.085, 0.074, 0.935), (0.085, 0.082, 1.155), "sign", PALE),
        box((-0.05, 0.07, 1.05), (0.05, 0.075, 1.07), "sign", DARK),
        box((-0.05, 0.07, 0.98), (0.05, 0.075, 1.0), "sign", DARK),
    ]


def fire_hydrant_plate() -> Shapes:
    """Short post of concrete with a yellow plate and its H, a lid before it."""
    return [
        box((-0.17, -0.30, -0.05), (0.17, -0.06, 0.010), "metal_dark"),
        box((-0.075, 0.06, BURIED), (0.075, 0.16, 0.62), "concrete", (1.2, 1.18, 1.12)),
        box((-0.11, 0.045, 0.34), (0.11, 0.062, 0.60), "sign", YELLOW),
        box((-0.07, 0.036, 0.37), (-0.045, 0.047, 0.57), "sign", DARK),
        box((0.045, 0.036, 0.37), (0.07, 0.047, 0.57), "sign", DARK),
        box((-0.07, 0.036, 0.46), (0.07, 0.047, 0.485), "sign", DARK),
    ]


def fire_hydrant_sign() -> Shapes:
    """Round red sign on a red post, beside the square lid of a hydrant below the pavement."""
    return [
        box((-0.25, -0.20, -0.05), (0.25, 0.18, 0.008), "metal_dark"),
        box((-0.22, -0.17, 0.0), (0.22, 0.15, 0.012), "sign", YELLOW),
        box((-0.18, -0.13, 0.0), (0.18, 0.11, 0.015), "metal_dark"),
        cylinder((0.32, 0.1, BURIED), (0.32, 0.1, 2.95), 0.035, "sign", RED, sides=8,
                 caps=(False, True)),
        disc((0.32, 0.055, 2.62), 0.29, "sign", PALE, sides=18, thickness=0.02),
        disc((0.32, 0.042, 2.62), 0.27, "sign", RED, sides=18, thickness=0.02),
        box((0.21, 0.025, 2.58), (0.43, 0.04, 2.66), "sign", PALE),
        box((0.12, 0.06, 2.08), (0.52, 0.075, 2.26), "sign", RED),
    ]  # fmt: skip


def post_box_pillar() -> Shapes:
    """Round pillar of cast iron, red with a black foot."""
    return [
        lathe([(0.27, BURIED), (0.27, 0.16), (0.245, 0.2), (0.245, 0.3)], "plastic", DARK,
              sides=16),
        lathe([(0.245, 0.3), (0.24, 1.36), (0.285, 1.39), (0.285, 1.47), (0.24, 1.53),
               (0.10, 1.60), (0.0, 1.62)], "plastic", RED, sides=16),
        box((-0.13, -0.262, 1.24), (0.13, -0.225, 1.28), "metal_dark"),
        box((-0.09, -0.255, 0.95), (0.09, -0.225, 1.14), "sign", PALE),
    ]  # fmt: skip


def post_box_red() -> Shapes:
    """Red box with two slots on a post of steel."""
    return [
        cylinder((0, 0, BURIED), (0, 0, 0.62), 0.08, "metal_grey", sides=10, caps=(False, False)),
        box((-0.27, -0.22, 0.60), (0.27, 0.22, 1.30), "plastic", RED),
        box((-0.28, -0.23, 1.30), (0.28, 0.23, 1.34), "plastic", (0.6, 0.04, 0.03)),
        box((-0.23, -0.235, 1.12), (-0.02, -0.215, 1.17), "metal_dark"),
        box((0.02, -0.235, 1.12), (0.23, -0.215, 1.17), "metal_dark"),
        box((-0.16, -0.23, 0.72), (0.16, -0.215, 0.98), "sign", PALE),
    ]


def post_box_blue() -> Shapes:
    """Blue collection box with a rounded top on four legs."""
    arch = np.linspace(0, np.pi, 7)
    round_top = [(0.26 * np.cos(a), 0.98 + 0.26 * np.sin(a)) for a in arch]
    parts: Shapes = [prism([(-0.26, 0.18), (0.26, 0.18), *round_top], -0.26, 0.26, "plastic", BLUE)]
    parts += [box((x - 0.03, y - 0.03, BURIED), (x + 0.03, y + 0.03, 0.2), "metal_dark")
              for x in (-0.22, 0.22) for y in (-0.22, 0.22)]  # fmt: skip
    parts.append(box((-0.2, -0.275, 0.9), (0.2, -0.255, 1.06), "metal_grey"))
    parts.append(box((-0.14, -0.27, 0.45), (0.14, -0.258, 0.7), "sign", PALE))
    return parts


def waste_basket_black() -> Shapes:
    """Bin of cast iron with a golden band and openings below its hood."""
    return [
        lathe([(0.25, BURIED), (0.27, 0.08), (0.27, 0.78), (0.24, 0.80)], "plastic", DARK,
              sides=14),
        lathe([(0.275, 0.66), (0.275, 0.70)], "plastic", GOLD, sides=14),
        lathe([(0.17, 0.78), (0.17, 0.98)], "metal_dark", sides=10),
        lathe([(0.28, 0.98), (0.28, 1.02), (0.20, 1.12), (0.0, 1.16)], "plastic", DARK, sides=14),
    ]  # fmt: skip


def waste_basket_mesh() -> Shapes:
    """Drum of steel slats with a ring at its mouth."""
    parts: Shapes = [
        lathe([(0.25, 0.02), (0.25, 0.10)], "metal_dark", sides=14),
        lathe([(0.27, 0.84), (0.30, 0.87), (0.27, 0.90)], "metal_dark", sides=14),
        lathe([(0.22, 0.05), (0.22, 0.80)], "plastic", DARK, sides=10),
    ]
    for a in np.arange(14) * (2 * np.pi / 14):
        x, y = 0.255 * np.cos(a), 0.255 * np.sin(a)
        parts.append(tube([[x, y, 0.03], [x, y, 0.86]], 0.014, "metal_dark", sides=4))
    return parts


def bollard_steel() -> Shapes:
    """Slender post of steel with two bands that shine back, 0.85 m."""
    return [
        lathe([(0.045, BURIED), (0.045, 0.82), (0.03, 0.85), (0.0, 0.855)], "metal_grey", STEEL,
              sides=10),
        lathe([(0.048, 0.66), (0.048, 0.72)], "sign", YELLOW, sides=10),
        lathe([(0.048, 0.50), (0.048, 0.56)], "sign", YELLOW, sides=10),
    ]  # fmt: skip


def bollard_stone() -> Shapes:
    """Short post of granite, 0.6 m, with a rounded head."""
    return [
        lathe([(0.13, BURIED), (0.13, 0.46), (0.115, 0.54), (0.07, 0.59), (0.0, 0.605)],
              "kerb_stone", (0.9, 0.88, 0.85), sides=12),
    ]  # fmt: skip


def telephone_post() -> Shapes:
    """Slim column of a public telephone, open on all sides."""
    return [
        box((-0.16, -0.10, BURIED), (0.16, 0.12, 2.15), "metal_grey"),
        box((-0.17, -0.11, 1.85), (0.17, 0.13, 2.2), "plastic", MAGENTA),
        box((-0.12, -0.20, 1.05), (0.12, -0.10, 1.55), "metal_dark"),
        box((-0.40, -0.30, 1.85), (0.40, 0.14, 1.89), "metal_grey"),
        box((-0.40, -0.26, 0.95), (-0.385, 0.10, 1.85), "glass"),
        box((0.385, -0.26, 0.95), (0.40, 0.10, 1.85), "glass"),
    ]


def telephone_kiosk() -> Shapes:
    """Red kiosk of cast iron with a domed crown, its word on four sides and panes on three."""
    parts: Shapes = [
        box((-0.46, -0.46, BURIED), (0.46, 0.46, 0.08), "plastic", DARK),
        box((-0.45, -0.45, 0.08), (0.45, 0.45, 0.30), "plastic", CRIMSON),
        box((-0.45, -0.45, 2.02), (0.45, 0.45, 2.32), "plastic", CRIMSON),
        loft(_ring(0.48, 2.32, 0.48, 2.36), "plastic", CRIMSON),
        loft(_ring(0.42, 2.36, 0.33, 2.50), "plastic", CRIMSON),
        loft(_ring(0.33, 2.50, 0.12, 2.58), "plastic", CRIMSON),
        box((-0.40, 0.36, 0.30), (0.40, 0.43, 2.02), "plastic", (0.75, 0.73, 0.68)),
        box((-0.18, 0.18, 1.05), (0.18, 0.36, 1.62), "metal_dark"),
        box((-0.06, 0.10, 1.28), (0.02, 0.18, 1.50), "plastic", DARK),
        box((-0.38, -0.36, 0.30), (0.38, 0.36, 0.33), "concrete"),
    ]
    for turn in range(4):
        yaw = turn * np.pi / 2
        side: Shapes = [
            box((-0.45, -0.45, 0.30), (-0.37, -0.37, 2.02), "plastic", CRIMSON),
            box((-0.33, -0.462, 2.08), (0.33, -0.45, 2.25), "sign", (1.1, 1.06, 0.95)),
            *word("TELEPHONE", 0.30, 2.11, 2.22, -0.462, "metal_dark", deep=0.004),
        ]
        if turn != 2:  # glazed but at the back
            side.append(box((-0.37, -0.425, 0.30), (0.37, -0.42, 2.02), "pane"))
            side += [box((x - 0.012, -0.44, 0.30), (x + 0.012, -0.405, 2.02), "plastic", CRIMSON)
                     for x in (-0.23, 0.23)]  # fmt: skip
            side += [box((-0.37, -0.44, z - 0.011), (0.37, -0.405, z + 0.011), "plastic", CRIMSON)
                     for z in np.linspace(0.515, 1.805, 7)]  # fmt: skip
        parts += [moved(shape, (0.0, 0.0, 0.0), yaw=yaw) for shape in side]
    return parts


def _ring(half: float, low: float, half_above: float, high: float) -> NDArray[np.float64]:
    """Corners of two squares, one over the other."""
    square = np.array([(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)])
    return np.stack([np.column_stack([square * size, np.full(4, z)])
                     for size, z in ((half, low), (half_above, high))])  # fmt: skip


def wheel_stop() -> Shapes:
    """Two low blocks of concrete at the end of a parking bay, along x."""
    ring = [(-0.07, 0.0), (0.07, 0.0), (0.05, 0.11), (-0.05, 0.11)]
    parts: Shapes = []
    for x in (-0.55, 0.55):
        block = [(x - 0.28, -0.07), (x + 0.28, -0.07), (x + 0.28, 0.07), (x - 0.28, 0.07)]
        low, high = ring[0][1] - 0.02, ring[2][1]
        parts.append(box((block[0][0], block[0][1], low), (block[2][0], block[2][1], high),
                         "concrete", (1.15, 1.15, 1.1)))  # fmt: skip
    return parts


def parking_board() -> Shapes:
    """Yellow board of a car park that is paid by coins, on a post, with its machine below."""
    return [
        post(3.1, 0.05, "metal_grey"),
        box((-0.45, -0.08, 2.0), (0.45, 0.0, 3.2), "sign", YELLOW),
        box((-0.30, -0.095, 2.55), (-0.16, -0.08, 3.1), "sign", DARK),
        box((-0.16, -0.095, 2.99), (0.18, -0.08, 3.1), "sign", DARK),
        box((-0.16, -0.095, 2.72), (0.18, -0.08, 2.83), "sign", DARK),
        box((0.10, -0.095, 2.72), (0.22, -0.08, 3.1), "sign", DARK),
        box((-0.38, -0.09, 2.08), (0.38, -0.08, 2.4), "sign", PALE),
        box((0.55, -0.2, BURIED), (0.95, 0.2, 1.45), "plastic", PALE),
        box((0.60, -0.215, 0.95), (0.90, -0.2, 1.3), "metal_dark"),
    ]


def traffic_signal_japan() -> Shapes:
    """Pole with three lights in a row on an arm over the lanes, and a head for walkers.

    The arm reaches to +x, over the lanes where traffic keeps left. Red is the outermost light of
    the row, on the right of whoever arrives.
    """
    grey: Color = (1.15, 1.15, 1.12)
    lid: Color = (0.86, 0.87, 0.86)
    z, x, lamp = 5.25, 2.45, 0.15  # metres: middle of the row, and radius of a light
    parts = [
        cylinder((0, 0.2, BURIED), (0, 0.2, 6.1), 0.095, "metal_grey", grey, top=0.075, sides=10,
                 caps=(False, True)),
        tube([[0, 0.2, 5.75], [0.9, 0.2, 5.72], [x + 0.55, 0.2, 5.62]], [0.06, 0.05, 0.04],
             "metal_grey", grey, sides=6),
        tube([[0, 0.2, 5.0], [1.55, 0.2, 5.12]], [0.035, 0.03], "metal_grey", grey, sides=6),
        box((x - 0.64, -0.06, z - 0.21), (x + 0.64, 0.12, z + 0.21), "metal_grey", grey),
    ]  # fmt: skip
    for side in (-0.42, 0.42):
        parts.append(box((x + side - 0.025, 0.12, z), (x + side + 0.025, 0.22, 5.68), "metal_grey",
                         grey))  # fmt: skip
    for side, light in ((-0.42, "signal_green"), (0.0, "signal_amber"), (0.42, "signal_stop")):
        parts += [
            # From behind: the lid of each light, its hinge, and the gap between two.
            box((x + side - 0.185, 0.12, z - 0.175), (x + side + 0.185, 0.14, z + 0.175),
                "metal_grey", lid),
            box((x + side - 0.06, 0.14, z - 0.16), (x + side + 0.06, 0.155, z - 0.13),
                "metal_dark"),
            disc((x + side, -0.062, z), lamp + 0.025, "plastic", DARK, sides=14, thickness=0.02),
            disc((x + side, -0.075, z), lamp, light, sides=14, thickness=0.016),
            prism([(x + side - 0.17, z + 0.02), (x + side + 0.17, z + 0.02),
                   (x + side + 0.10, z + 0.19), (x + side - 0.10, z + 0.19)], -0.30, -0.06,
                  "metal_grey", grey),
        ]  # fmt: skip
    # Walkers cross beside the pole, and see red above green from the other side.
    parts += [
        box((0.10, 0.05, 2.38), (0.24, 0.35, 3.02), "plastic", DARK),
        box((0.24, 0.09, 2.73), (0.25, 0.31, 2.97), "walk_red"),
        box((0.24, 0.09, 2.43), (0.25, 0.31, 2.67), "walk_green"),
        box((0.05, 0.17, 2.66), (0.10, 0.23, 2.74), "metal_grey", grey),
        box((-0.08, 0.09, 0.95), (0.08, 0.13, 1.20), "plastic", YELLOW),
    ]
    return parts


REGIONAL_MAKERS: Mapping[str, Callable[[], Shapes]] = MappingProxyType(
    {
        maker.__name__: maker
        for maker in (
            fire_hydrant_cover, fire_hydrant_plate, fire_hydrant_sign, post_box_pillar,
            post_box_red, post_box_blue, waste_basket_black, waste_basket_mesh, bollard_steel,
            bollard_stone, telephone_post, telephone_kiosk, wheel_stop, parking_board,
            traffic_signal_japan,
        )
    }
)  # fmt: skip
