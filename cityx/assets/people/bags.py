"""What people carry: backpacks, handbags and shopping bags, in body units."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cityx.assets.people.body import Body, Part, arm_centre, bound, heights, level, stacked
from cityx.assets.people.clothes import TRUNK_Y, trunk_rings
from cityx.assets.people.skeleton import rigid
from cityx.assets.shapes import Color, is_fine, loft, tube

FloatArray = NDArray[np.float64]
BAGS = ("backpack", "handbag", "shopping bag")


def bag(body: Body, kind: str, color: Color) -> list[Part]:
    """Make a bag, one of `BAGS`."""
    if kind == "backpack":
        return _backpack(body, color)
    return _carried(body, color, large=kind == "shopping bag")


def _backpack(body: Body, color: Color) -> list[Part]:
    """Backpack with a pocket and two straps; all of it moves with the chest."""
    back = float(body.trunk([0.73])[0, 2]) + TRUNK_Y
    small = 1.0 - 0.12 * body.child
    dark = (0.6 * color[0], 0.6 * color[1], 0.6 * color[2])
    chest = rigid("chest")
    parts = []
    for low, high, wide, deep, place, tint in (
        (0.595, 0.822, 0.074, 0.036, 0.036, color),
        (0.612, 0.705, 0.056, 0.016, 0.076, dark),
    ):
        z = heights(low, high, 4, 8)
        share = (z - low) / (high - low)
        full = np.sqrt(np.clip(1.0 - np.abs(2.0 * share - 0.9) ** 5, 0.25, 1.0))
        reach = np.array([wide, deep, deep]) * small * full[:, None]
        middle = np.column_stack([np.zeros(len(z)), back + place * small - 0.010 * share])
        rings = stacked(z, middle, reach, level(7, 16), power=3.6)
        parts.append(bound(loft(rings, "cloth", tint), chest))
    for side in (1.0, -1.0):
        path = _strap(body, side * 0.052 * body.shoulder)
        parts.append(bound(tube(path, 0.0095, "cloth", dark, sides=4), chest))
    return parts


def _strap(body: Body, x: float) -> FloatArray:
    """Middle line of a strap from the back over the shoulder to below the arm."""
    z = np.concatenate([np.linspace(0.780, 0.826, 3), [0.834], np.linspace(0.822, 0.655, 8)])
    behind = np.arange(len(z)) < 3
    rows = trunk_rings(body, z, 0.011, np.linspace(-np.pi, np.pi, 181))
    out = np.empty((len(z), 3))
    aside = x * np.concatenate([[1.0, 1.0, 1.0, 1.0], 1.0 + 0.85 * np.linspace(0.0, 1.0, 8) ** 2])
    aside = np.sign(aside) * np.minimum(np.abs(aside), rows[:, :, 0].max(axis=1) - 0.002)
    for number, ring in enumerate(rows):
        back = ring[:, 1] >= TRUNK_Y
        half = ring[back] if behind[number] else ring[~back]
        order = np.argsort(half[:, 0])
        y = np.interp(aside[number], half[order, 0], half[order, 1])
        out[number] = (aside[number], y if number != 3 else TRUNK_Y + 0.012, z[number])
    return out if is_fine() else out[[0, 3, 4, 11]]


def _carried(body: Body, color: Color, *, large: bool) -> list[Part]:
    """Bag with two handles that hangs from the left hand."""
    x, y = (arm_centre(body, np.array([0.481]))[0] - [0.008, 0.0]).tolist()
    wrist = rigid("left_grip")
    top, low = (0.345, 0.155) if large else (0.345, 0.225)
    z = heights(low, top, 2, 5)
    share = (z - low) / (top - low)
    flare = np.array([0.034, 0.088, 0.088]) if large else np.array([0.026, 0.080, 0.080])
    narrower = np.column_stack([1.0 - 0.55 * share, 1.0 - 0.1 * share, 1.0 - 0.1 * share])
    reach = np.asarray(flare * narrower, float)
    rings = stacked(z, np.array([x, y]), reach, level(6, 16), power=3.5)
    material = "cloth" if large else "leather"
    parts = [bound(loft(rings, material, color), wrist)]
    turn = np.linspace(0.0, np.pi, level(4, 9))
    for side in (-0.007, 0.007):
        path = np.column_stack([np.full(len(turn), x + side), y + 0.042 * np.cos(turn),
                                top - 0.01 + 0.080 * np.sin(turn) ** 0.8])  # fmt: skip
        parts.append(bound(tube(path, 0.0035, material, color, sides=4), wrist))
    return parts
