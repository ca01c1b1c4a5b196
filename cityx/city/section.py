"""Cross-sections of roads as text: the bands from left to right, as one sees them along the road.

``walk 1.8 | parking 2.1 | drive 3.25 - | drive 3.25 + left;through | cycle 1.6 +`` is a sidewalk,
parked cars, a lane against the road's direction, one along it for left and through, a cycle lane.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from cityx.errors import UsageError, nearest

BAND_KINDS = ("drive", "bus", "cycle", "parking", "shoulder", "median", "verge", "walk")
KIND = {name: number for number, name in enumerate(BAND_KINDS)}
CARRIAGEWAY = ("drive", "bus", "cycle", "parking", "shoulder", "median")  # between the kerbs
TRAVELLED = ("drive", "bus", "cycle")  # something moves along them
TURNS = ("left", "through", "right", "reverse")
TURN = {name: 1 << number for number, name in enumerate(TURNS)}
SIGNS = {1: "+", -1: "-", 0: ""}
WIDEST = 30.0  # metres of one band
PARKING = 2.1  # metres of a lane of parked cars
NARROWEST_LANE = 2.4  # metres of a lane beside another


@dataclass(frozen=True)
class Band:
    """One band of a cross-section.

    Attributes
    ----------
    kind
        One of `BAND_KINDS`.
    width
        Metres.
    direction
        1 along the road, -1 against it, 0 for both or none.
    turns
        Bits of `TURN`: where its arrows point; 0 when nothing is painted.
    """

    kind: str
    width: float
    direction: int = 0
    turns: int = 0


def section_text(bands: Sequence[Band]) -> str:
    """Write a cross-section; `read_section` reads it back."""
    words = []
    for band in bands:
        turns = ";".join(name for name in TURNS if band.turns & TURN[name])
        parts = (band.kind, f"{band.width:g}", SIGNS[band.direction], turns)
        words.append(" ".join(part for part in parts if part))
    return " | ".join(words)


def read_section(text: str) -> tuple[Band, ...]:
    """Read a cross-section.

    Raises
    ------
    UsageError
        With every fault of the text.
    """
    bands, faults = [], []
    for number, piece in enumerate(text.split("|"), start=1):
        try:
            bands.append(_read_band(piece.split()))
        except ValueError as error:
            faults.append(f"band {number}, {piece.strip()!r}: {error}")
    if not faults and not any(band.kind in (*TRAVELLED, "shoulder") for band in bands):
        faults.append("nothing moves along it: there is no drive, bus or cycle band")
    if faults:
        raise UsageError(f"cross-section {text!r}: " + "; ".join(faults))
    return tuple(bands)


def _read_band(words: list[str]) -> Band:
    if len(words) < 2:
        raise ValueError("a band is a kind and a width in metres, as in 'drive 3.25 +'")
    kind, size, *rest = words
    if kind not in KIND:
        raise ValueError(f"there is no band of kind {kind!r}.{nearest(kind, BAND_KINDS)}")
    try:
        width = float(size)
    except ValueError:
        raise ValueError(f"{size!r} is no width in metres") from None
    if not (math.isfinite(width) and 0.0 < width <= WIDEST):
        raise ValueError(f"a width of {size} m lies outside 0 to {WIDEST:g} m")
    direction, turns = 0, 0
    for word in rest:
        if word in ("+", "-"):
            direction = 1 if word == "+" else -1
            continue
        for name in word.split(";"):
            if name not in TURN:
                raise ValueError(f"there is no turn {name!r}.{nearest(name, TURNS)}")
            turns |= TURN[name]
    return Band(kind, width, direction, turns)


def carriageway_width(bands: Sequence[Band]) -> float:
    """Metres from kerb to kerb."""
    return sum(band.width for band in bands if band.kind in CARRIAGEWAY)
