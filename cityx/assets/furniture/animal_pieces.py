"""Animals that stand about: four-legged ones and birds, each drawn from a row of measures.

Front -y, feet at z = 0, metres; the rows are `cityx/data/assets/animal_pieces.toml`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from types import MappingProxyType

import numpy as np

from cityx.assets.furniture.drawn_pieces import ball
from cityx.assets.furniture.furniture_parts import Shapes
from cityx.assets.shapes import Color, loft, tube
from cityx.city.mesh import MeshBatch
from cityx.geometry.arrays import FloatArray
from cityx.system.tables import load

COAT, WOOL, BARE = "hair", "cloth", "skin"  # materials
HOOF: Color = (0.06, 0.055, 0.05)
HORN: Color = (0.70, 0.64, 0.52)
PINK: Color = (0.80, 0.52, 0.48)
RED: Color = (0.75, 0.05, 0.04)
DARK: Color = (0.02, 0.02, 0.02)
SUNK = 0.35  # of its depth by which a bird that swims lies in the water


@dataclass(frozen=True)
class Legged:
    """An animal on four legs.

    Attributes
    ----------
    high, long
        Metres from the ground to the withers, and from breast to rump.
    deep, wide
        Metres from back to belly, and how often that it is as wide.
    leg
        Metres of the radius of a leg below the knee.
    neck, rise
        Metres of the neck, and the share of its length by which it climbs.
    skull
        Metres from the poll to the muzzle.
    coat, face, patch, mane
        Colours; patch and mane only where it has such.
    horns, antlers, ears, tail
        Metres of each, 0 for none; ears are as the skull asks for without a number.
    fleece, udder, beard, snout
        Whether it has such.
    pose
        "stand", "graze" or "lie".
    """

    high: float
    long: float
    deep: float
    wide: float
    leg: float
    neck: float
    skull: float
    coat: Color
    face: Color
    rise: float = 0.35
    patch: Color | None = None
    mane: Color | None = None
    horns: float = 0.0
    antlers: float = 0.0
    ears: float = 0.0
    tail: float = 0.0
    fleece: bool = False
    udder: bool = False
    beard: bool = False
    snout: bool = False
    pose: str = "stand"


@dataclass(frozen=True)
class Winged:
    """A bird.

    Attributes
    ----------
    long, deep
        Metres of the body with its tail, and from back to belly.
    neck, bill, leg
        Metres of each.
    coat, breast, head, beak
        Colours.
    comb
        Whether it has a red comb.
    afloat, pecks
        Whether it swims, and whether its head is at the ground.
    """

    long: float
    deep: float
    neck: float
    coat: Color
    breast: Color
    head: Color
    beak: Color
    bill: float
    leg: float = 0.0
    comb: bool = False
    afloat: bool = False
    pecks: bool = False


def legged(row: Legged) -> Shapes:
    """Draw an animal on four legs."""
    lies = row.pose == "lie"
    top = row.deep * 1.02 if lies else row.high
    middle = top - row.deep / 2
    half = row.long / 2
    coat = WOOL if row.fleece else COAT
    parts: Shapes = [_trunk(row, middle, coat), *_head(row, middle)]
    parts += _folded(row) if lies else _legs(row, middle)
    if row.patch is not None:
        x = 0.43 * row.deep * row.wide
        for side, y, z, size in ((1, 0.2, 0.1, 0.3), (-1, 0.28, 0.05, 0.26), (1, -0.22, -0.02, 0.2),
                                 (-1, -0.12, 0.12, 0.28)):  # fmt: skip
            size *= row.deep
            parts.append(ball((side * x, 2 * half * y, middle + row.deep * z, 0.07 * row.deep,
                               1.25 * size, size), coat, row.patch))  # fmt: skip
    if row.tail:
        end = max(middle + 0.25 * row.deep - row.tail, 0.08)
        rump = [0.0, half * 0.97, middle + 0.3 * row.deep]
        path = [
            rump,
            [0.0, half + 0.1 * row.deep, rump[2] - 0.1],
            [0.0, half + 0.12 * row.deep, end],
        ]
        tint = row.mane or row.coat
        thick = 0.05 * row.deep
        parts.append(tube(path, [thick, thick, (2.2 if row.mane or row.udder else 1.0) * thick],
                          COAT, tint, sides=6))  # fmt: skip
    if row.udder and not lies:
        parts.append(
            ball((0.0, 0.52 * half, middle - 0.45 * row.deep, 0.16, 0.2, 0.15), BARE, PINK)
        )
    return parts


def _trunk(row: Legged, middle: float, coat: str) -> MeshBatch:
    """Draw the trunk, of rings from the breast to the rump."""
    along = np.array([-1.0, -0.93, -0.7, -0.3, 0.2, 0.65, 0.92, 1.0]) * row.long / 2
    round_ = np.array([0.35, 0.72, 0.93, 1.0, 1.0, 0.97, 0.7, 0.3]) * row.deep / 2
    lift = np.array([0.1, 0.06, 0.0, -0.02, -0.02, 0.02, 0.08, 0.1]) * row.deep
    turn = np.linspace(0.0, 2 * np.pi, 12, endpoint=False)
    rings = np.stack([
        row.wide * round_[:, None] * np.cos(turn),
        np.broadcast_to(along[:, None], (8, 12)),
        middle + lift[:, None] - round_[:, None] * np.sin(turn),
    ], axis=-1)  # fmt: skip
    if row.fleece:  # locks
        swell = 1.0 + 0.05 * np.cos(np.arange(8)[:, None] * 2.1 + 3 * np.arange(12) * np.pi / 2)
        rings[..., 0] *= swell
        rings[..., 2] = middle + (rings[..., 2] - middle) * swell
    return loft(rings, coat, row.coat)


def _legs(row: Legged, middle: float) -> Shapes:
    parts: Shapes = []
    half, x = row.long / 2, 0.3 * row.deep * row.wide
    for side in (-1.0, 1.0):
        for hind, y in ((False, -0.68 * half), (True, 0.74 * half)):
            step = 0.06 * row.long * side * (1.0 if hind else -1.0)
            knee = [side * x, y + step * 0.5 + (0.05 * row.high if hind else 0.0), 0.42 * middle]
            path = [[side * x, y, middle - 0.1 * row.deep], knee,
                    [side * x, y + step, 0.06 * row.high],
                    [side * x, y + step - 0.01, 0.0]]  # fmt: skip
            thigh = (3.0 if hind else 2.4) * row.leg
            tint = row.face if row.fleece else row.coat
            parts.append(tube(path[:3], [thigh, 1.25 * row.leg, row.leg], COAT, tint, sides=7))
            parts.append(tube(path[2:], [1.1 * row.leg, 1.4 * row.leg], COAT, HOOF, sides=7))
    return parts


def _folded(row: Legged) -> Shapes:
    """Draw legs that are folded under a lying animal."""
    half, x = row.long / 2, 0.42 * row.deep * row.wide
    tint = row.face if row.fleece else row.coat
    parts: Shapes = []
    for side in (-1.0, 1.0):
        for low, high in ((-1.05, -0.6), (0.35, 0.85)):
            path = [[side * x, low * half, row.leg], [side * x, high * half, 1.6 * row.leg]]
            parts.append(tube(path, [row.leg, 1.8 * row.leg], COAT, tint, sides=6))
    return parts


def _head(row: Legged, middle: float) -> Shapes:
    """Draw neck, skull and what is on it."""
    half = row.long / 2
    root = np.array([0.0, -0.86 * half, middle + 0.2 * row.deep])
    if row.pose == "graze":
        poll = root + np.array([0.0, -0.55 * row.neck, 0.0])
        poll[2] = max(0.75 * row.skull, root[2] - 0.85 * row.neck)
        ahead = np.array([0.0, -0.35, -0.94])
    else:
        poll = root + row.neck * np.array([0.0, -np.sqrt(1 - row.rise**2), row.rise])
        ahead = np.array([0.0, -0.86, -0.5])
    if row.pose == "graze":
        ahead *= min(1.0, 0.97 * poll[2] / (0.94 * row.skull))
    thick = 0.42 * row.skull
    parts: Shapes = [
        tube([root, (root + poll) / 2 + [0, 0, 0.03], poll],
             [0.36 * row.deep, 0.27 * row.deep, 0.9 * thick * 0.6], WOOL if row.fleece else COAT,
             row.coat, sides=10),
        tube([poll - 0.12 * row.skull * ahead, poll + 0.25 * row.skull * ahead,
              poll + 0.75 * row.skull * ahead, poll + row.skull * ahead],
             [0.3 * thick, 0.6 * thick, 0.44 * thick, 0.3 * thick], COAT, row.face, sides=9),
    ]  # fmt: skip
    if row.snout:
        tip = poll + row.skull * ahead
        parts.append(tube([tip, tip + 0.05 * ahead], 0.3 * thick, BARE, PINK, sides=9))
    ear = row.ears or 0.36 * row.skull
    for side in (-1.0, 1.0):
        base = poll + np.array([side * 0.4 * thick, 0.0, 0.35 * thick])
        out = np.array([side * 0.55, 0.15, 0.8]) if row.ears or row.mane else (
            np.array([side * 0.95, 0.1, 0.05]))  # fmt: skip
        parts.append(tube([base, base + 0.5 * ear * out, base + ear * out],
                          [0.1 * ear, 0.22 * ear, 0.03 * ear], COAT, row.face,
                          sides=6))  # fmt: skip
        eye = poll + 0.3 * row.skull * ahead + np.array([side * 0.52 * thick, 0.0, 0.12 * thick])
        parts.append(ball((*eye.tolist(), 0.02, 0.03, 0.03), BARE, DARK, sides=6))
        if row.horns:
            foot = poll + np.array([side * 0.3 * thick, 0.02, 0.5 * thick])
            path = [foot, foot + row.horns * np.array([side * 0.5, 0.1, 0.45]),
                    foot + row.horns * np.array([side * 0.45, 0.25, 1.0])]  # fmt: skip
            parts.append(tube(path, [0.1 * thick + 0.01, 0.08 * thick, 0.01], COAT, HORN, sides=6))
        if row.antlers:
            parts += _antler(
                poll + np.array([side * 0.25 * thick, 0.0, 0.5 * thick]), row.antlers, side
            )
    if row.beard:
        chin = poll + 0.85 * row.skull * ahead
        parts.append(
            tube(
                [chin, chin + np.array([0.0, 0.02, -0.14])], [0.03, 0.008], COAT, row.coat, sides=5
            )
        )
    if row.mane is not None:
        crest = [poll + np.array([0.0, 0.02, 0.45 * thick]),
                 (root + poll) / 2 + [0.0, 0.03, 0.3 * row.deep],
                 root + np.array([0.0, 0.12, 0.33 * row.deep])]  # fmt: skip
        parts.append(tube(crest, [0.04, 0.06, 0.03], COAT, row.mane, sides=6))
    return parts


def _antler(foot: FloatArray, size: float, side: float) -> Shapes:
    beam = [foot, foot + size * np.array([side * 0.3, 0.15, 0.45]),
            foot + size * np.array([side * 0.35, 0.0, 1.0])]  # fmt: skip
    parts: Shapes = [tube(beam, [0.022, 0.018, 0.006], COAT, HORN, sides=5)]
    for share in (0.2, 0.6):
        start = foot + share * (beam[1] - foot) * 1.5
        parts.append(tube([start, start + size * np.array([side * 0.1, -0.3, 0.15])],
                          [0.014, 0.004], COAT, HORN, sides=5))  # fmt: skip
    return parts


def winged(row: Winged) -> Shapes:
    """Draw a bird."""
    sunk = SUNK * row.deep if row.afloat else 0.0
    low = row.leg - sunk
    middle = low + row.deep / 2
    half, r = row.long / 2, row.deep / 2
    body = [[0, -0.62 * half, middle + 0.15 * r], [0, -0.5 * half, middle + 0.1 * r],
            [0, -0.1 * half, middle], [0, 0.35 * half, middle + 0.05 * r],
            [0, 0.7 * half, middle + 0.3 * r], [0, half, middle + 0.45 * r]]  # fmt: skip
    parts: Shapes = [
        tube(body, [0.3 * r, 0.75 * r, r, 0.85 * r, 0.35 * r, 0.12 * r], WOOL, row.coat,
             sides=10),
        ball((0.0, -0.4 * half, middle - 0.05 * r, 0.78 * r, 0.3 * half, 0.8 * r), WOOL,
             row.breast),
    ]  # fmt: skip
    for side in (-1.0, 1.0):
        parts.append(ball((side * 0.78 * r, 0.25 * half, middle + 0.3 * r, 0.24 * r, 0.62 * half,
                           0.55 * r), WOOL, row.coat))  # fmt: skip
        if row.leg:
            x = side * 0.45 * r
            parts.append(tube([[x, 0.05 * half, middle - 0.6 * r], [x, 0.0, 0.012]],
                              0.07 * r + 0.003, BARE, row.beak, sides=5))  # fmt: skip
            parts.append(ball((x, -0.08 * half, 0.012, 0.22 * r, 0.3 * r + 0.01, 0.012), BARE,
                              row.beak, sides=6))  # fmt: skip
    return parts + _bird_head(row, middle)


def _bird_head(row: Winged, middle: float) -> Shapes:
    half, r = row.long / 2, row.deep / 2
    root = np.array([0.0, -0.5 * half, middle + 0.3 * r])
    skull = 0.05 + 0.09 * row.deep if row.deep > 0.2 else 0.3 * row.deep
    if row.pecks:
        face = np.array([0.0, root[1] - 0.75 * row.neck - skull, 1.2 * skull + 0.6 * row.bill])
        nod = np.array([0.0, -0.5, -0.86])
    else:
        face = root + np.array([0.0, -0.25 * row.neck, row.neck])
        nod = np.array([0.0, -0.98, -0.18])
    bend = (root + face) / 2 + [0.0, (-0.1 if row.pecks else -0.28) * row.neck, 0.0]
    parts: Shapes = [
        tube([root, bend, face], [0.5 * r, 0.75 * skull, 0.8 * skull], WOOL,
             row.head, sides=8),
        ball((*face.tolist(), skull, 1.2 * skull, skull), WOOL, row.head),
        tube([face + 0.9 * skull * nod, face + (1.1 * skull + row.bill) * nod],
             [0.4 * skull, 0.15 * skull], BARE, row.beak, sides=6),
    ]  # fmt: skip
    for side in (-1.0, 1.0):
        parts.append(ball((side * 0.85 * skull, float(face[1]) - 0.5 * skull,
                           float(face[2]) + 0.25 * skull, 0.2 * skull, 0.2 * skull, 0.2 * skull),
                          BARE, DARK, sides=6))  # fmt: skip
    if row.comb:
        parts.append(ball((0.0, float(face[1]), float(face[2]) + 1.1 * skull, 0.15 * skull, skull,
                           0.5 * skull), BARE, RED, sides=6))  # fmt: skip
    return parts


_LEGGED = load("assets/animal_pieces", dict[str, Legged], "legged")
_WINGED = load("assets/animal_pieces", dict[str, Winged], "winged")
ANIMAL_MAKERS: Mapping[str, Callable[[], Shapes]] = MappingProxyType(
    {
        **{name: partial(legged, row) for name, row in _LEGGED.items()},
        **{name: partial(winged, row) for name, row in _WINGED.items()},
    }
)
# Birds that swim, by the names of their pieces.
SWIMMERS = frozenset(name for name, row in _WINGED.items() if row.afloat)
