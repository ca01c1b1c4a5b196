"""Symbols painted on lanes: arrows, words, bicycles, triangles; metres, x ahead and y left."""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city.section import TURN
from cityx.geometry.arrays import FloatArray

STROKE = 0.15  # metres
LENGTH = 5.0  # metres of an arrow
LETTER = (2.4, 0.5)  # metres, long and wide: letters are drawn long for eyes that look along them
WORD = 2.2  # metres, the widest word
SIGN, SIGN_GAP = (1.4, 1.2), 0.4  # metres, of Japanese signs, long and wide, and between two
FIGURE = (3.0, 0.6, 0.35, 0.16)  # metres: long and wide, between two, and of strokes
TRIANGLE = (3.75, 1.25, 0.15)  # metres, long and wide, and of its rim
DIAMOND = (5.0, 1.5, 0.25)  # metres, long and wide, and of its rim
WHEEL = 0.34  # metres, radius
FEATHER = (1.5, 0.75, 0.9)  # metres, long and wide, and of its sides


def _stroke(*points: tuple[float, float], width: float = STROKE) -> Any:
    line = shapely.LineString(points)
    return shapely.buffer(line, width / 2, cap_style="flat", join_style="mitre")


def _head(tip: tuple[float, float], back: tuple[float, float], broad: float) -> Any:
    """Triangle with its tip at a point, its base at another."""
    axis = np.array(tip) - back
    aside = np.array([-axis[1], axis[0]]) / np.hypot(*axis) * broad / 2
    return shapely.Polygon([tip, np.array(back) + aside, np.array(back) - aside])


@lru_cache(maxsize=16)
def arrow(turns: int) -> Any:
    """Return the arrow for bits of `TURN`, its foot at the origin."""
    shapes = []
    if turns & TURN["through"]:
        shapes += [_stroke((0.0, 0.0), (3.5, 0.0)), _head((LENGTH, 0.0), (3.4, 0.0), 0.75)]
    for name, side in (("left", 1.0), ("right", -1.0)):
        if turns & TURN[name]:
            bend = 1.6 if turns & TURN["through"] else 2.6
            shapes.append(_stroke((0.0, 0.0), (bend, 0.0), (bend + 0.9, 0.55 * side)))
            foot = (bend + 0.75, 0.42 * side)
            shapes.append(_head((bend + 1.9, 0.95 * side), foot, 0.95))
    if turns & TURN["reverse"]:
        shapes.append(_stroke((0.0, 0.0), (2.6, 0.0), (2.6, 0.7), (1.6, 0.7)))
        shapes.append(_head((0.5, 0.7), (1.7, 0.7), 0.6))
    return shapely.union_all(shapes)


# Strokes of letters: up 0 to 1, and 0 to 1 from the left to the right of the reader.
GLYPHS: dict[str, tuple[tuple[tuple[float, float], ...], ...]] = {
    "A": (((0, 0), (1, 0.5), (0, 1)), ((0.35, 0.18), (0.35, 0.82))),
    "E": (((1, 1), (1, 0), (0, 0), (0, 1)), ((0.5, 0), (0.5, 0.8))),
    "L": (((1, 0), (0, 0), (0, 1)),),
    "R": (((0, 0), (1, 0), (1, 0.85), (0.75, 1), (0.5, 0.85), (0.5, 0)), ((0.5, 0.5), (0, 1))),
    "B": (((0, 0), (1, 0), (1, 0.8), (0.5, 1), (0, 0.8), (0, 0)), ((0.5, 0), (0.5, 1))),
    "O": (((0, 0.15), (0, 0.85), (0.15, 1), (0.85, 1), (1, 0.85), (1, 0.15), (0.85, 0), (0.15, 0),
           (0, 0.15)),),
    "P": (((0, 0), (1, 0), (1, 0.85), (0.75, 1), (0.5, 0.85), (0.5, 0)),),
    "S": (((0, 0), (0, 1), (0.5, 1), (0.5, 0), (1, 0), (1, 1)),),
    "T": (((0, 0.5), (1, 0.5)), ((1, 0), (1, 1))),
    "U": (((1, 0), (0.1, 0), (0, 0.5), (0.1, 1), (1, 1)),),
    "0": (((0, 0.15), (0, 0.85), (0.1, 1), (0.9, 1), (1, 0.85), (1, 0.15), (0.9, 0), (0.1, 0),
           (0, 0.15)),),
    "1": (((0, 0.5), (1, 0.5), (0.85, 0.2)),),
    "2": (((0.9, 0), (1, 0.2), (1, 0.8), (0.9, 1), (0.65, 1), (0, 0), (0, 1)),),
    "3": (((0.9, 0), (1, 0.15), (1, 0.85), (0.9, 1), (0.6, 1), (0.52, 0.7), (0.52, 0.4)),
          ((0.52, 0.7), (0.44, 1), (0.1, 1), (0, 0.85), (0, 0.15), (0.1, 0))),
    "4": (((0, 0.75), (1, 0.75), (0.3, 0), (0.3, 1.0)),),
    "5": (((1, 1), (1, 0), (0.58, 0), (0.62, 0.8), (0.54, 1), (0.1, 1), (0, 0.8), (0, 0.2),
           (0.1, 0)),),
    "6": (((0.92, 1), (1, 0.8), (1, 0.2), (0.9, 0), (0.1, 0), (0, 0.2), (0, 0.8), (0.1, 1),
           (0.45, 1), (0.55, 0.8), (0.55, 0)),),
    "8": (((0, 0.15), (0, 0.85), (0.1, 1), (0.45, 1), (0.55, 0.8), (0.9, 0.9), (1, 0.75),
           (1, 0.25), (0.9, 0.1), (0.55, 0.2), (0.45, 0), (0.1, 0), (0, 0.15)),),
    "止": (((0, 0), (0, 1)), ((0, 0.55), (1, 0.55)), ((0.55, 0.55), (0.55, 0.95)),
           ((0, 0.2), (0.5, 0.2))),
    "ま": (((0.82, 0.1), (0.82, 0.9)), ((0.6, 0.1), (0.6, 0.9)),
           ((1, 0.5), (0.1, 0.5), (0.05, 0.25), (0.2, 0.15), (0.28, 0.5), (0.05, 0.95))),
    "れ": (((1, 0.25), (0, 0.25)), ((0.75, 0), (0.75, 0.35), (0.25, 0.0)),
           ((0.45, 0.25), (0.8, 0.6), (0.7, 0.72), (0.15, 0.68), (0.05, 0.8), (0.2, 1))),
}  # fmt: skip
COLUMNS = ("止まれ",)


@lru_cache(maxsize=1)
def diamond() -> Any:
    """Return the lozenge that announces a crossing, its foot at the origin."""
    long, wide, rim = DIAMOND
    shape = shapely.Polygon([(0, 0), (long / 2, wide / 2), (long, 0), (long / 2, -wide / 2)])
    return shapely.difference(shape, shapely.buffer(shape, -rim, join_style="mitre"))


@lru_cache(maxsize=16)
def figures(number: int) -> Any:
    """Return the figures of a speed limit as drivers read them, their foot at the origin."""
    text = str(number)
    long, wide, gap, stroke = FIGURE
    left = (len(text) * (wide + gap) - gap) / 2
    shapes = [
        _stroke(*[(x * long, left - n * (wide + gap) - y * wide) for x, y in line], width=stroke)
        for n, digit in enumerate(text)
        for line in GLYPHS[digit]
    ]
    return shapely.union_all(shapes)


@lru_cache(maxsize=8)
def word(text: str) -> Any:
    """Return a word of letters of `GLYPHS` as drivers read it, its foot at the origin.

    Letters stand beside each other, Japanese signs behind each other, the first the farthest.
    """
    if text in COLUMNS:
        (long, wide), gap = SIGN, SIGN_GAP
        feet = [((long + gap) * (len(text) - 1 - n), wide / 2) for n in range(len(text))]
    else:
        long, wide = LETTER[0], min(LETTER[1], WORD / (1.6 * len(text) - 0.6))
        feet = [(0.0, wide * (0.8 * len(text) - 0.3 - 1.6 * n)) for n in range(len(text))]
    shapes = [
        _stroke(*[(foot + x * long, left - y * wide) for x, y in line], width=0.12)
        for (foot, left), letter in zip(feet, text, strict=True)
        for line in GLYPHS[letter]
    ]
    return shapely.union_all(shapes)


@lru_cache(maxsize=1)
def give_way_triangle() -> Any:
    """Return the triangle before give-way lines, its tip at the origin (TSRGD 2016, 1023)."""
    outer = _head((0.0, 0.0), (TRIANGLE[0], 0.0), TRIANGLE[1])
    return outer.difference(shapely.buffer(outer, -TRIANGLE[2], join_style="mitre"))


@lru_cache(maxsize=1)
def feather() -> Any:
    """Return the arrowhead that marks where bicycles ride, its middle at the origin."""
    long, wide, side = FEATHER
    tip, notch, half = long / 2, side - long / 2, wide / 2
    return shapely.Polygon([(tip, 0.0), (notch, half), (-tip, half), (tip - side, 0.0),
                            (-tip, -half), (notch, -half)])  # fmt: skip


@lru_cache(maxsize=1)
def bicycle() -> Any:
    """Return a bicycle seen from its side, 1.9 m long, its foot at the origin."""
    rear, front = (0.0, 0.55), (0.0, -0.55)
    ring = [
        shapely.buffer(shapely.Point(*at), WHEEL, quad_segs=3).difference(
            shapely.buffer(shapely.Point(*at), WHEEL - 0.1, quad_segs=3)
        )
        for at in (rear, front)
    ]
    crank, seat, head = (0.05, 0.05), (0.75, 0.22), (0.75, -0.38)
    lines = [(rear, crank), (crank, seat), (seat, rear), (crank, head), (seat, head), (front, head),
             (head, (0.95, -0.3))]  # fmt: skip
    shapes = [_stroke(*line, width=0.08) for line in lines]
    return shapely.union_all([*ring, *shapes])


def placed(
    outline: Any, position: FloatArray, ahead: FloatArray, lateral: FloatArray
) -> NDArray[Any]:
    """Put an outline at places: (k, 2) positions and unit directions, (k,) metres to the left."""
    count = len(position)
    if not count:
        return np.zeros(0, object)
    points, ring = shapely.get_coordinates(
        shapely.get_rings(shapely.get_parts(outline)), return_index=True
    )
    left = np.column_stack([-ahead[:, 1], ahead[:, 0]])
    foot = position + left * lateral[:, None]
    moved = (
        foot[:, None]
        + points[None, :, :1] * ahead[:, None]
        + points[None, :, 1:] * left[:, None]
    )  # fmt: skip
    rings = int(ring.max()) + 1
    number = (np.arange(count)[:, None] * rings + ring[None]).ravel()
    made = shapely.linearrings(moved.reshape(-1, 2), indices=number)
    return _polygons(outline, np.asarray(made, object).reshape(count, rings))


def _polygons(outline: Any, rings: NDArray[Any]) -> NDArray[Any]:
    """Assemble moved rings into the polygons of an outline, (k * parts,)."""
    _, owner = shapely.get_rings(shapely.get_parts(outline), return_index=True)
    made = []
    for part in range(int(owner.max()) + 1):
        own = np.flatnonzero(owner == part)
        holes = rings[:, own[1:]] if len(own) > 1 else None
        made.append(shapely.polygons(rings[:, own[0]], holes=holes))
    return np.asarray(np.stack(made, axis=1).ravel(), object)
