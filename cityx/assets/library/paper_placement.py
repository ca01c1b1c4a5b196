"""Placement as the paper writes it: five steps, each formula to the letter.

Its scaling factor looks at the short sides alone, so a long asset overshoots its lot; and its
choice of the smallest factor takes the largest asset and shrinks it most. The module `fit` beside
it is the mode without those two faults; this one is kept so that they can be compared.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cityx.geometry.arrays import FloatArray, IntArray
from cityx.geometry.rectangles import rectangles_of

ASPECT = 0.15  # epsilon of step 3; the paper leaves it open
FOOTPRINT = 0.2  # share by which areas may differ and still be "about equal"; left open as well
NONE = -1


@dataclass(frozen=True)
class PaperPlacement:
    """Where assets go, n lots.

    Attributes
    ----------
    asset
        (n,) row of the asset, -1 where no asset qualifies.
    alpha
        (n,) scaling factor, NaN where there is none.
    theta
        (n,) turn about z, radians, counter-clockwise.
    offset
        (n, 2) shift after scaling and turning about the asset's origin, metres.
    """

    asset: IntArray
    alpha: FloatArray
    theta: FloatArray
    offset: FloatArray


def bounding_rectangle(lots: ArrayLike) -> tuple[FloatArray, FloatArray]:
    """Step 1: R = minBoundingRectangle(A), l = length(R), w = width(R); (n,) each, l >= w."""
    box = rectangles_of(lots)
    return box.length, box.width


def aspect_ratio(length: ArrayLike, width: ArrayLike) -> FloatArray:
    """Step 2: l / w, with l the long side."""
    first, second = np.asarray(length, float), np.asarray(width, float)
    return np.asarray(np.maximum(first, second) / np.minimum(first, second))


def qualifies(
    lot_area: ArrayLike,
    lot_aspect: ArrayLike,
    area: ArrayLike,
    aspect: ArrayLike,
    *,
    epsilon: float = ASPECT,
    tolerance: float = FOOTPRINT,
) -> NDArray[np.bool_]:
    """Step 3: footprint(s) ~ footprint(R) and aspectRatio(s) in [aspectRatio -+ epsilon]."""
    close = np.abs(np.asarray(area) / np.asarray(lot_area) - 1.0) <= tolerance
    return np.asarray(close & (np.abs(np.asarray(aspect) - np.asarray(lot_aspect)) <= epsilon))


def scaling_factor(
    length: ArrayLike, width: ArrayLike, length_i: ArrayLike, width_i: ArrayLike
) -> FloatArray:
    """Step 4: alpha_i = min(l, w) / min(l_i, w_i)."""
    return np.asarray(np.minimum(length, width) / np.minimum(length_i, width_i))


def rotation(angle: ArrayLike, angle_i: ArrayLike) -> FloatArray:
    """Step 5: theta = angle(R) - angle(s)."""
    return np.asarray(np.asarray(angle, float) - np.asarray(angle_i, float))


def place_as_paper(
    lots: ArrayLike,
    *,
    length: FloatArray,
    width: FloatArray,
    angle: FloatArray,
    centre: FloatArray,
    style: NDArray[np.str_] | None = None,
    wanted: str = "",
    score: FloatArray | None = None,
    epsilon: float = ASPECT,
    tolerance: float = FOOTPRINT,
) -> PaperPlacement:
    """Place assets on lots by the paper's five steps.

    Parameters
    ----------
    lots
        (n,) building areas A, metres.
    length, width, angle, centre
        Of m assets: sides, direction of the long side, and (m, 2) centre coordinates.
    style, wanted, score
        (m,) style tags, the style asked for, and (m,) agreement with the user's description. With
        a style, assets tagged with another one do not qualify; where untagged ones qualify, the one
        that scores best among them is taken, as CLIP picks it in the paper.
    epsilon, tolerance
        Of step 3.
    """
    box = rectangles_of(lots)
    count = len(box.length)
    area, aspect = length * width, aspect_ratio(length, width)
    lot_area = box.length * box.width
    lot_aspect = aspect_ratio(box.length, box.width)
    tag = np.full(len(length), "") if style is None else np.asarray(style, np.str_)
    open_rows = (tag == wanted) | (tag == "") if wanted else np.ones(len(length), bool)
    # Sorted by area, so that each lot looks at the assets of about its own area alone.
    order = np.flatnonzero(open_rows)
    order = order[np.lexsort((order, area[order]))]
    sorted_area = area[order]
    begin = np.searchsorted(sorted_area, lot_area * (1 - tolerance) * (1 - 1e-9))
    end = np.searchsorted(sorted_area, lot_area * (1 + tolerance) * (1 + 1e-9), side="right")
    chosen = np.full(count, NONE, np.int64)
    short = np.minimum(length, width)
    for lot in range(count):
        rows = order[begin[lot] : end[lot]]
        rows = rows[
            qualifies(lot_area[lot], lot_aspect[lot], area[rows], aspect[rows],
                      epsilon=epsilon, tolerance=tolerance)
        ]  # fmt: skip
        if not len(rows):
            continue
        free = rows[tag[rows] == ""]
        if score is not None and wanted and len(free):
            chosen[lot] = free[np.lexsort((free, -score[free]))[0]]
            continue
        # argmin of alpha: the lot's own side is the same for all, so it is the largest short side.
        chosen[lot] = rows[np.lexsort((rows, -short[rows]))[0]]
    found = chosen >= 0
    of = np.where(found, chosen, 0)
    if not len(length):
        nothing = np.full(count, np.nan)
        return PaperPlacement(chosen, nothing, nothing, np.full((count, 2), np.nan))
    alpha = scaling_factor(box.length, box.width, length[of], width[of])
    theta = rotation(box.angle, angle[of])
    cos, sin = np.cos(theta), np.sin(theta)
    turned = np.stack(
        [cos * centre[of, 0] - sin * centre[of, 1], sin * centre[of, 0] + cos * centre[of, 1]],
        axis=1,
    )
    offset = box.centre - alpha[:, None] * turned
    return PaperPlacement(
        chosen,
        np.where(found, alpha, np.nan),
        np.where(found, theta, np.nan),
        np.where(found[:, None], offset, np.nan),
    )
