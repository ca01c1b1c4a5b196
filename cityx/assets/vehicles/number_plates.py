"""Number plates in the shapes and colours of their countries; what they say is invented.

No plate says what an authority may have issued: every series is one that the country has not, as
letters before the wrong number of figures.

References
----------
Council Regulation (EC) 2411/98, recognition of the distinguishing sign of a member state.
The Road Vehicles (Display of Registration Marks) Regulations 2001 (United Kingdom).
Ministry of Land, Infrastructure, Transport and Tourism, form of number plates: 330 by 165 mm.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cityx.assets.shapes import bevelled, box, is_fine, moved
from cityx.assets.shops.lettering import word
from cityx.city.mesh import MeshBatch
from cityx.ids import hash_ids
from cityx.system.tables import load, table

DEEP = 0.02  # metres
BAND = "plate_blue"


@dataclass(frozen=True)
class Plate:
    """Plates of a country.

    Attributes
    ----------
    size
        Breadth and height, metres.
    front, rear
        Material of the ground.
    ink
        Material of what is written.
    rows
        What is written: lines from above, 0 for any figure and X for any of `LETTERS`.
    band
        Whether a blue band runs down its left end.
    small
        Plates of small cars, where they differ.
    """

    size: tuple[float, float]
    front: str
    rear: str
    ink: str
    rows: tuple[str, ...]
    band: bool = False
    small: str = ""


LETTERS = load("assets/number_plates", str, "letters")
PLATES = table("assets/number_plates", Plate, "plates")


def inscription(country: str, number: int) -> tuple[str, ...]:
    """Return the lines of the plate of a number, a pure function of it.

    Parameters
    ----------
    country
        A key of `PLATES`.
    number
        Of the registration.
    """
    found = []
    for row, line in enumerate(PLATES[country].rows):
        draw = hash_ids(0, f"number_plate/{country}/{row}", number, np.arange(len(line)))
        signs = zip(line, draw.tolist(), strict=True)
        found.append("".join(_drawn(sign, value) for sign, value in signs))
    return tuple(found)


def _drawn(sign: str, value: int) -> str:
    """Return what stands for a sign of a row: a figure, a letter or itself."""
    if sign == "0":
        return str(value % 10)
    return LETTERS[value % len(LETTERS)] if sign == "X" else sign


def number_plate(
    country: str, number: int, y: float, z: float, *, rear: bool = False, kei: bool = False
) -> list[MeshBatch]:
    """Make a plate that looks ahead, or to the rear.

    Parameters
    ----------
    country
        A key of `PLATES`.
    number
        Of the registration; see `inscription`.
    y, z
        Metres: the face that it is fixed on, and its middle.
    rear
        Whether it is the one behind.
    kei
        Whether it is that of a small car, which Japan tells apart.
    """
    key = PLATES[country].small or country if kei else country
    style = PLATES[key]
    wide, high = style.size[0] / 2, style.size[1] / 2
    face, ground = -abs(y) - 0.012, style.rear if rear else style.front
    low, top = (-wide, face, z - high), (wide, face + DEEP, z + high)
    parts = [bevelled(low, top, ground, bevel=0.003) if is_fine() else box(low, top, ground)]
    if is_fine():
        start = -wide
        if style.band:
            start += 0.045
            low, top = (
                (-wide + 0.003, face - 0.0015, z - high + 0.003),
                (start, face, z + high - 0.003),
            )
            parts.append(box(low, top, BAND))
        parts += _written(style, inscription(key, number), (start, wide), z, face)
    return [moved(part, yaw=np.pi) for part in parts] if rear else parts


def _written(
    style: Plate, lines: tuple[str, ...], span: tuple[float, float], z: float, face: float
) -> list[MeshBatch]:
    """Write the lines of a plate: one fills it, of two the lower is the larger."""
    high = style.size[1] / 2
    edges = [(z - 0.72 * high, z + 0.72 * high)]
    if len(lines) == 2:
        edges = [(z + 0.36 * high, z + 0.86 * high), (z - 0.84 * high, z + 0.20 * high)]
    middle, reach = (span[0] + span[1]) / 2, 0.44 * (span[1] - span[0])
    made = []
    for text, (low, top) in zip(lines, edges, strict=True):
        for letter in word(text, reach, low, top, face, style.ink, deep=0.002):
            made.append(moved(letter, (middle, 0.0, 0.0)))
    return made
