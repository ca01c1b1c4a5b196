"""Lettering: words in real letters, for signs, and the same in neon.

`cityx.assets.shops.fonts` draws them. One em is 1 m; a letter stands on its baseline in the plane
of x and z and looks along -y. Of neon, x runs along the wall, -y out of it, z up, metres, as of
fittings; a line lies along x, 1 m long.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from contextlib import nullcontext
from dataclasses import dataclass, replace
from functools import lru_cache
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from cityx.assets.openings.frames import Shapes, slab
from cityx.assets.shapes import fine_shapes, moved, prototype, tube
from cityx.assets.shops.fonts import CAP, FIRST_EAST_ASIAN, has, letter_of
from cityx.city.mesh import NO_VERTEX, MeshBatch, one_mesh
from cityx.city.scene import Prototype

FINE = 3  # level of detail from which letters have sides
GAP, SPACE = 0.085, 0.27  # em between letters and between words
GLYPH = "sign_glyph_"  # names of prototypes of letters begin so
DEEP = 1.0  # metres that a prototype stands out; its instances are squeezed to some centimetres
COLORS = ("red", "amber", "green", "cyan", "blue", "violet", "pink")
# Of a board and of the blade at its end.
WORDS = {
    "red": ("OPEN", "HOTEL"), "amber": ("NOODLES", "GRILL"), "green": ("PHARMACY", "24H"),
    "cyan": ("KARAOKE", "CLUB"), "blue": ("CINEMA", "JAZZ"), "violet": ("ARCADE", "GAMES"),
    "pink": ("COCKTAILS", "BAR"),
}  # fmt: skip
PEN = 0.012  # metres, radius of a tube: 24 mm is the widest that is blown
LINE = 0.05  # metres, radius of a line of light along the edges of a tower


def is_known(text: str) -> bool:
    """Return whether there are outlines of all letters of a text."""
    return bool(text.strip()) and all(has(letter) for letter in text if letter != " ")


@lru_cache(maxsize=4096)
def span(letter: str) -> tuple[float, float]:
    """Return where a letter begins and ends, em; those of East Asia fill a square."""
    across = letter_of(letter).points[:, 0]
    low, high = (float(across.min()), float(across.max())) if len(across) else (np.nan, np.nan)
    if ord(letter) >= FIRST_EAST_ASIAN:  # its outline stands in the middle of its square
        return (low + high) / 2 - 0.5, (low + high) / 2 + 0.5
    return low, high


@dataclass(frozen=True)
class Line:
    """A text set in one line.

    Attributes
    ----------
    letters
        Characters that show, k of them.
    middle
        (k,) em from the middle of the line to that of each.
    width
        Em.
    """

    letters: tuple[str, ...]
    middle: NDArray[np.float64]
    width: float


@lru_cache(maxsize=4096)
def line_of(text: str) -> Line:
    """Set a text, whose letters must all be known, in one line."""
    pen, letters, middles = 0.0, [], []
    for letter in text:
        if letter == " ":
            pen += SPACE
            continue
        low, high = span(letter)
        letters.append(letter)
        middles.append(pen + (high - low) / 2)
        pen += high - low + (GAP if ord(letter) < FIRST_EAST_ASIAN else 0.06)
    width = max(pen - GAP, 0.0)
    return Line(tuple(letters), np.array(middles) - width / 2, width)


def glyph_name(letter: str) -> str:
    """Return the name of the prototype of a letter; signs shine at night by their first word."""
    return f"{GLYPH}{ord(letter):04x}"


@lru_cache(maxsize=2048)
def glyph(letter: str, *, detail: int = 2) -> Prototype:
    """Make the prototype of a letter: 1 em high, `DEEP` deep, its middle over the origin."""
    shape = _raised(letter, "sign", sides=detail >= FINE)
    fine = "_fine" if detail >= FINE else ""
    return prototype(glyph_name(letter) + fine, "trim", [shape])


def _raised(letter: str, material: str, *, sides: bool) -> MeshBatch:
    """Raise a letter by `DEEP` towards -y, without its back."""
    shape = letter_of(letter)
    low, high = span(letter)
    at = shape.points - [(low + high) / 2, 0.0]
    count = len(at)
    front = np.column_stack([at[:, 0], np.full(count, -DEEP), at[:, 1]])
    quads = np.column_stack([shape.triangles, np.full(len(shape.triangles), NO_VERTEX)])
    if not sides:
        return one_mesh(0, front, quads, materials=(material,))
    back = np.column_stack([at[:, 0], np.zeros(count), at[:, 1]])
    here = np.arange(count)
    after = here + 1
    after[shape.start[1:] - 1] = shape.start[:-1]
    around = np.column_stack([count + here, count + after, after, here])
    return one_mesh(0, np.vstack([front, back]), np.vstack([quads, around]), materials=(material,))


def word(
    text: str, reach: float, low: float, high: float, front: float, material: str = "lamp_glow",
    *, deep: float = 0.03, upright: bool = False,
) -> list[MeshBatch]:  # fmt: skip
    """Make a word that is part of a thing, as large as its field admits.

    Parameters
    ----------
    text
        Of known letters.
    reach
        Half the width that it may take, metres.
    low, high
        Lower and upper edge of the field, metres.
    front
        y of the face that it is fixed on, metres.
    material
        What it is made of.
    deep
        Metres that it stands out.
    upright
        Whether the letters stand one above the other.
    """
    line = line_of(text)
    count = len(line.letters)
    if upright:
        size = min(2 * reach / 0.95, (high - low) / max(count, 1))
        step = (high - low) / max(count, 1)
        places = [(0.0, high - (k + 0.5) * step - 0.37 * size) for k in range(count)]
    else:
        size = min((high - low) / CAP, 2 * reach / max(line.width, 0.1))
        foot = (low + high - CAP * size) / 2
        places = [(size * x, foot) for x in line.middle.tolist()]
    made = []
    for letter, (x, z) in zip(line.letters, places, strict=True):
        shape = _raised(letter, material, sides=True)
        points = shape.vertices * [size, deep / DEEP, size] + [x, front, z]
        made.append(replace(shape, vertices=points))
    return made


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
