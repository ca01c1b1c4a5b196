"""Concrete poles that carry wires along the streets of Japan, and the boards on them.

Each maker is named for a prototype and returns its shapes: z up, front -y (along the street),
origin on the ground at the foot.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Mapping
from types import MappingProxyType

import numpy as np

from cityx.assets.furniture.furniture_parts import BLUE, BURIED, DARK, GREEN, PALE, YELLOW, Shapes
from cityx.assets.shapes import Color, box, cylinder, is_fine, loft, moved
from cityx.assets.shops.lettering import word

HEIGHT, FOOT_RADIUS, TOP_RADIUS = 10.2, 0.17, 0.11  # metres
CONCRETE: Color = (0.95, 0.95, 0.93)
STEEL = 0.006  # metres of a band about the pole
SLEEVE, STRIPES, SLANT = (0.35, 1.55), 6, 0.22  # metres of the sleeve that tells it to drivers
WRAP = (1.85, 3.15)  # metres above the ground of an advertisement about a pole
BOARD = (4.55, 5.75)  # the same of one that stands out from it
OUT = (0.24, 0.70)  # metres of that from the middle of the pole
DOCTOR, DENTIST = "内科", "みどり歯科"


def _radius(z: float) -> float:
    """Metres from the middle of the pole to its side."""
    return FOOT_RADIUS + (TOP_RADIUS - FOOT_RADIUS) * max(z, 0.0) / HEIGHT


def _band(low: float, high: float, more: float, material: str, tint: Color) -> Shapes:
    """Wrap something about the pole, so much thicker than it."""
    return [cylinder((0, 0, low), (0, 0, high), _radius(low) + more, material, tint,
                     top=_radius(high) + more, sides=12)]  # fmt: skip


def _pole() -> Shapes:
    parts: Shapes = [
        cylinder((0, 0, -0.4), (0, 0, HEIGHT), FOOT_RADIUS, "concrete", CONCRETE, top=TOP_RADIUS,
                 sides=12),
        box((-1.0, -0.05, 9.5), (1.0, 0.05, 9.6), "metal_grey"),
        box((-0.75, -0.05, 8.7), (0.75, 0.05, 8.8), "metal_grey"),
        cylinder((0.42, 0.0, 7.3), (0.42, 0.0, 8.25), 0.27, "metal_grey", sides=10),
        box((0.0, -0.04, 7.5), (0.3, 0.04, 7.6), "metal_grey"),
        box((-0.3, -0.14, 5.4), (0.3, -0.08, 5.55), "metal_dark"),
    ]  # fmt: skip
    for x in (-0.9, -0.35, 0.9):
        parts.append(cylinder((x, 0, 9.6), (x, 0, 9.82), 0.05, "plastic", PALE, top=0.03, sides=6))
    # Steps to climb by turn from side to side, above where children reach.
    for k, z in enumerate(np.arange(3.6, 8.4, 0.45)):
        near, far = ((0.1, 0.3), (-0.3, -0.1))[k % 2]
        parts.append(box((near, -0.01, z), (far, 0.01, z + 0.02), "metal_dark"))
    if is_fine():
        for z in (3.35, 5.45, 5.9, 6.3, 7.45, 8.1, 8.75, 9.55):
            parts += _band(z, z + 0.06, STEEL, "metal_grey", PALE)
        parts += _earth_wire()
    # The number of the pole, above eye level.
    parts.append(box((-0.07, -_radius(3.2) - 0.012, 3.22), (0.07, -0.1, 3.32), "sign", PALE))
    return parts


def _earth_wire() -> Shapes:
    """Wire down the pole, in a pipe as far up as hands reach."""
    foot, head = (FOOT_RADIUS + 0.02) / np.sqrt(2), _radius(7.2) / np.sqrt(2)
    return [
        cylinder((foot, foot, BURIED), (foot, foot, 2.6), 0.025, "plastic", DARK, sides=6),
        cylinder((foot, foot, 2.6), (head, head, 7.2), 0.012, "metal_dark", sides=6),
    ]


def _sleeve() -> Shapes:
    """Bands of yellow and black that run aslant about the pole, level at both ends."""
    turn = np.linspace(0, 2 * np.pi, 16, endpoint=False)
    share = np.linspace(0.0, 1.0, STRIPES + 1)
    low, high = SLEEVE
    slant = SLANT * np.minimum(1.0, 2.0 * np.minimum(share, 1.0 - share) * STRIPES / 2)
    rings = [
        np.column_stack([
            (_radius(z) + 2 * STEEL) * np.cos(turn), (_radius(z) + 2 * STEEL) * np.sin(turn),
            z + tilt / 2 * np.cos(turn),
        ])
        for z, tilt in zip(low + (high - low) * share, slant, strict=True)
    ]  # fmt: skip
    return [loft(np.stack(pair), "sign", YELLOW if k % 2 == 0 else DARK, caps=(False, False))
            for k, pair in enumerate(itertools.pairwise(rings))]  # fmt: skip


def _word(
    text: str, reach: float, low: float, high: float, front: float, material: str, *, deep: float
) -> Shapes:  # fmt: skip
    """Return the letters of a word from above to below; from afar nobody reads them."""
    if not is_fine():
        return []
    return word(text, reach, low, high, front, material, deep=deep, upright=True)


def utility_pole() -> Shapes:
    """Concrete pole of 10 m with cross-arms, a transformer, steps, and a sleeve for drivers."""
    return [*_pole(), *_sleeve()]


def utility_pole_wrapped() -> Shapes:
    """Pole without a sleeve that has the advertisement of a dentist about it."""
    low, high = WRAP
    foot = low + 0.22
    letters = _word(DENTIST, 0.12, foot + 0.03, high - 0.05, 0.045 - _radius(low), "metal_dark",
                    deep=0.06)  # fmt: skip
    return [
        *_pole(), *_band(low, foot, 2 * STEEL, "sign", GREEN),
        *_band(foot, high, 2 * STEEL, "sign", PALE),
        *letters, *(moved(letter, (0.0, 0.0, 0.0), yaw=np.pi) for letter in letters),
    ]  # fmt: skip


def utility_pole_board() -> Shapes:
    """Pole with a sleeve and the board of a doctor that stands out from it."""
    low, high = BOARD
    middle = (OUT[0] + OUT[1]) / 2
    parts = [*_pole(), *_sleeve(), box((OUT[0], -0.03, low), (OUT[1], 0.03, high), "sign", BLUE)]
    for z in (low + 0.1, high - 0.1):
        parts.append(box((0.0, -0.015, z - 0.02), (OUT[0], 0.015, z + 0.02), "metal_grey"))
    letters = _word(DOCTOR, 0.19, low + 0.1, high - 0.1, -0.03, "sign", deep=0.008)
    for yaw in (0.0, np.pi):
        parts += [moved(letter, (middle, 0.0, 0.0), yaw=yaw) for letter in letters]
    return parts


POLE_MAKERS: Mapping[str, Callable[[], Shapes]] = MappingProxyType(
    {maker.__name__: maker for maker in (utility_pole, utility_pole_wrapped, utility_pole_board)}
)
