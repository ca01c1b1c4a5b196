"""Painted images: pictures from above that were drawn or rendered, in a few even colours.

A network that learned from photographs is lost in them. But what is of one colour is of one class,
and the shapes tell which: streets are long and hang together, houses are many and compact, land has
the colour of what grows on it.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from cityx.sources.map_classes import class_of
from cityx.sources.satellite.segmenter import Segmenter
from cityx.sources.semantic_map.legends import to_lab, unpacked
from cityx.sources.semantic_map.picture import Picture, packed
from cityx.sources.semantic_map.proposal import PALE, propose

FloatArray = NDArray[np.float32]

WINDOW = 5  # pixels of the window whose median takes grain away
APART, STEP = 4, 4  # pixels between two that are compared, and steps of 255 they may differ by
# Share of such pairs that are alike in a painting, and of pixels that have one of its few colours;
# the first is 0.2 to 0.5 in photographs.
EVEN = 0.8
LOOKED_AT = 512  # pixels of a side of the middle, at which that is measured
DISTINCT = 10.0  # CIELab between two paints, at least
SHADES = 12.0  # CIELab without lightness, within which vivid colours are shades of one paint
DEEP = 32.0  # CIELab lightness below which what is bluish is water
SURE = 0.2  # logits per unit of CIELab


def painted_segmenter(picture: Picture) -> Segmenter | None:
    """Return a segmenter of a painting by its own colours; None for a photograph."""
    if not _is_even(picture.colors):
        return None
    smooth = _without_grain(picture.colors)
    even = Picture(None, smooth, picture.void, lossy=True)
    legend, _ = propose(even, apart=DISTINCT)
    centres = to_lab(unpacked(np.array([entry.key for entry in legend.entries])))
    named = _seen_from_above([entry.meaning.word for entry in legend.entries], centres)
    words = list(dict.fromkeys(named))
    known, count = np.unique(packed(smooth[::APART, ::APART]), return_counts=True)
    away = np.linalg.norm(to_lab(unpacked(known))[:, None] - centres, axis=2).min(axis=1)
    few = float(count[away < DISTINCT / 2].sum()) >= EVEN * float(count.sum())
    if not few or not {"road", "building"} & set(words) or len(words) < 2:
        return None
    channel = np.array([words.index(word) for word in named])

    def run(image: FloatArray) -> FloatArray:
        colors = np.rint(image.transpose(1, 2, 0) * 255).astype(np.uint8)
        known, index = np.unique(packed(_without_grain(colors)), return_inverse=True)
        away = np.linalg.norm(to_lab(unpacked(known))[:, None] - centres, axis=2)  # (k, entries)
        logits = np.full((len(words), len(known)), -np.inf, np.float32)
        np.maximum.at(logits, channel, -SURE * away.T)
        return logits[:, index.reshape(colors.shape[:2])]

    return Segmenter("the colours of a painting", tuple(map(class_of, words)), run, stride=1)


def _seen_from_above(words: Sequence[str], lab: NDArray[np.float64]) -> list[str]:
    """Correct the classes of colours, (n, 3) CIELab, of a map for how the land itself looks."""
    roof = lab[words.index("building")] if "building" in words else np.zeros(3)
    found = []
    for word, color in zip(words, lab, strict=True):
        shade = np.hypot(*roof[1:]) > PALE and np.hypot(*(color - roof)[1:]) < SHADES
        if word == "wood":
            word = "vegetation"  # in maps dark green is trees; seen from above grass is dark too
        elif word in ("ground", "bare") and color[0] < DEEP and color[2] < 0:
            word = "water"
        elif word in ("ground", "bare") and shade:
            word = "building"
        found.append(word)
    return found


def _is_even(colors: NDArray[np.uint8]) -> bool:
    """Return whether colours hardly change from pixel to pixel once grain is taken away."""
    rows, columns = (max(0, (size - LOOKED_AT) // 2) for size in colors.shape[:2])
    middle = _without_grain(colors[rows : rows + LOOKED_AT, columns : columns + LOOKED_AT])
    step = np.abs(np.diff(middle[:, ::APART].astype(np.int16), axis=1)).max(axis=2)
    return bool(step.size) and float((step <= STEP).mean()) >= EVEN


def _without_grain(colors: NDArray[np.uint8]) -> NDArray[np.uint8]:
    from PIL import Image, ImageFilter

    smooth = Image.fromarray(np.ascontiguousarray(colors)).filter(ImageFilter.MedianFilter(WINDOW))
    return np.asarray(smooth)
