"""Body parts: towers, spires, domes, minarets and chimneys, told by the volumes of a building.

Nothing becomes a tower by being called one: a volume is, by its measures (`words.BODY_PARTS`),
whatever map or wish it comes from. Heights and colours are those of the shell, where it stands.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.checks.predicates.words import BODY_PARTS, BodyForm
from cityx.city import Layout
from cityx.geometry.arrays import FloatArray, IntArray

STACKED = 0.5  # of the smaller plan that two volumes share of which one stands on the other
BESIDE = 0.3  # metres between volumes that touch
LARGER = 1.0  # times the plan of a part that what it stands out of has at least
SHAFT, STACK = 5.2, 7.0  # metres of a chimney; its height over them
DOMED = ("dome", "onion")
POINTED = ("pyramidal", "cone", "dome", "onion", "hipped", "gabled", "crosspitched")


@dataclass(frozen=True)
class BodyPart:
    """A tower, dome, ... of a building.

    Attributes
    ----------
    building
        Id.
    outline
        Its plan, scene frame, metres.
    foot
        Metres above the ground from which it stands out of what it touches.
    top
        Metres above the ground.
    rows
        (k,) of the table of parts, those that it consists of.
    """

    building: int
    outline: Any
    foot: float
    top: float
    rows: IntArray


def body_parts(layout: Layout, word: str, buildings: NDArray[np.uint64]) -> Iterator[BodyPart]:
    """Yield the parts of a kind of some buildings.

    Parameters
    ----------
    word
        A key of `words.BODY_PARTS`.
    buildings
        Ids.
    """
    table = layout.parts
    owner = table["building"].to_numpy(np.uint64)
    order = np.argsort(owner, kind="stable")
    first = np.searchsorted(owner[order], buildings)
    last = np.searchsorted(owner[order], buildings, side="right")
    form = BODY_PARTS[word]
    for number, low, high in zip(buildings.tolist(), first.tolist(), last.tolist(), strict=True):
        if high > low:
            yield from _of_one(layout, form, number, order[low:high])


def _of_one(layout: Layout, form: BodyForm, building: int, rows: IntArray) -> Iterator[BodyPart]:
    table = layout.parts.iloc[rows]
    shapes, top = table.geometry.to_numpy(), table["top"].to_numpy(float)
    roof, walls = table["roof_shape"].to_numpy(str), table["walls"].to_numpy(bool)
    area = shapely.area(shapes)
    slim = walls & (_sides(shapes)[1] <= form.width[1])
    if form.domed:
        slim &= np.isin(roof, DOMED)
    for own in _stacks(shapes, np.flatnonzero(slim)):
        outline = shapely.union_all(shapes[own])
        beside = shapely.dwithin(shapes, outline, BESIDE)
        beside[own] = False
        large = beside & (area >= LARGER * float(outline.area))
        if not large.any():
            large = beside
        foot = float(top[large].max(initial=0.0))
        highest = int(own[np.argmax(top[own])])
        short, long = (float(side[0]) for side in _sides(np.array([outline], object)))
        total = float(top[highest])
        rise = float(table["roof_height"].iloc[highest])
        point = rise / max(float(_sides(shapes[[highest]])[1][0]), 0.1)
        if _is(form, (short, long), total, foot, str(roof[highest]), point):
            foot = min(foot, total) if not form.domed else float(table["base"].iloc[own].min())
            yield BodyPart(building, outline, foot, total, rows[own])


def _is(
    form: BodyForm, sides: tuple[float, float], top: float, foot: float, roof: str, point: float
) -> bool:
    """Return whether volumes measure what a part must."""
    short, long = sides
    if short < form.width[0] or long > form.width[1] or long > form.oblong * short:
        return False
    if form.domed:
        return roof in DOMED
    if top < form.slender[0] * long or top > form.slender[1] * long or top < form.over * foot:
        return False
    if not form.blunt and roof == "flat" and short < SHAFT and top >= STACK * long:
        return False  # a chimney
    if form.pointed and (roof not in POINTED or point < form.pointed):
        return False
    return not form.blunt or roof == "flat"


def _sides(shapes: NDArray[Any]) -> tuple[FloatArray, FloatArray]:
    """Return the shorter and the longer side of the smallest box around each shape, metres."""
    boxes = shapely.oriented_envelope(shapes)
    short, long = np.zeros(len(shapes)), np.zeros(len(shapes))
    good = (shapely.get_type_id(boxes) == 3) & ~shapely.is_empty(boxes)
    corner = shapely.get_coordinates(boxes[good]).reshape(-1, 5, 2)
    length = np.linalg.norm(np.diff(corner[:, :3], axis=1), axis=2)
    short[good], long[good] = length.min(axis=1), length.max(axis=1)
    return short, long


def _stacks(shapes: NDArray[Any], rows: IntArray) -> Iterator[IntArray]:
    """Yield the rows that stand on one another, each stack by itself."""
    left = list(rows.tolist())
    while left:
        own = [left.pop(0)]
        for at in own:
            for other in list(left):
                shared = shapely.area(shapely.intersection(shapes[at], shapes[other]))
                if shared >= STACKED * min(shapes[at].area, shapes[other].area):
                    own.append(other)
                    left.remove(other)
        yield np.array(sorted(own), np.int64)
