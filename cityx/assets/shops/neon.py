"""Neon signs and lines of light on buildings.

Frame: as of fittings, x along the wall, -y out of it, z up, metres; a line lies along x, 1 m long.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from contextlib import nullcontext
from functools import lru_cache
from types import MappingProxyType

import numpy as np

from cityx.assets.openings.frames import Shapes, slab
from cityx.assets.shapes import fine_shapes, moved, prototype, tube
from cityx.assets.shops.lettering import word
from cityx.city.scene import Prototype

COLORS = ("red", "amber", "green", "cyan", "blue", "violet", "pink")
# Of a board and of the blade at its end.
WORDS = {
    "red": ("OPEN", "HOTEL"), "amber": ("NOODLES", "GRILL"), "green": ("PHARMACY", "24H"),
    "cyan": ("KARAOKE", "CLUB"), "blue": ("CINEMA", "JAZZ"), "violet": ("ARCADE", "GAMES"),
    "pink": ("COCKTAILS", "BAR"),
}  # fmt: skip
PEN = 0.012  # metres, radius of a tube: 24 mm is the widest that is blown
LINE = 0.05  # metres, radius of a line of light along the edges of a tower
FINE = 3  # level of detail from which tubes are round


def _frame(x: float, low: float, high: float, y: float, material: str) -> Shapes:
    """Run a tube round a board from -x to x."""
    corners = [(-x, low), (x, low), (x, high), (-x, high)]
    pairs = zip(corners, corners[1:] + corners[:1], strict=True)
    return [tube([[a[0], y, a[1]], [b[0], y, b[1]]], PEN, material, sides=6) for a, b in pairs]


def board(material: str) -> Shapes:
    """Board over a shop, 3.4 m wide, its lower edge at z = 0, with a word and a tube round it."""
    return [
        slab(-1.7, 1.7, 0.0, 0.62, -0.14, "metal_dark"),
        *_frame(1.62, 0.07, 0.55, -0.17, material),
        *word(WORDS[material.removeprefix("neon_")][0], 1.35, 0.17, 0.45, -0.14, material),
    ]


def blade(material: str) -> Shapes:
    """Upright board that stands out from the wall, 3.6 m high, its lower edge at z = 0."""
    shapes: Shapes = [
        slab(-0.03, 0.03, 0.5, 0.56, -0.30, "metal_grey"),
        slab(-0.03, 0.03, 3.0, 3.06, -0.30, "metal_grey"),
        slab(-0.09, 0.09, 0.0, 3.6, -1.05, "metal_dark", back=-0.28),
    ]
    for x in (-0.11, 0.11):
        corners = [(-0.98, 0.08), (-0.98, 3.52), (-0.35, 3.52), (-0.35, 0.08), (-0.98, 0.08)]
        shapes.append(tube([[x, y, z] for y, z in corners], PEN, material, sides=6))
    for side in (-1.0, 1.0):
        text = WORDS[material.removeprefix("neon_")][1]
        letters = word(text, 0.27, 0.3, 3.3, -0.09, material, upright=True)
        # Turned to one side of the board, and out to its middle.
        shapes += [moved(part, (0.0, -0.66, 0.0), yaw=side * np.pi / 2) for part in letters]
    return shapes


def line(material: str) -> Shapes:
    """Straight light, 1 m long from the origin along x."""
    return [tube([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]], LINE, material, sides=6)]


FORMS: Mapping[str, Callable[[str], Shapes]] = MappingProxyType(
    {maker.__name__: maker for maker in (board, blade, line)}
)


@lru_cache(maxsize=64)
def neon(form: str, color: str, *, detail: int = 2) -> Prototype:
    """Make a neon light; `form` is a key of `FORMS`, `color` one of `COLORS`."""
    with fine_shapes() if detail >= FINE else nullcontext():
        shapes = FORMS[form](f"neon_{color}")
    fine = "_fine" if detail >= FINE else ""
    return prototype(f"neon_{form}_{color}{fine}", "neon", shapes)
