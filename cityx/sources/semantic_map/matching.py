"""Matching: which legend a picture follows, and which class each of its pixels has."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cityx.sources.semantic_map.legends import PRESETS, Legend
from cityx.sources.semantic_map.picture import Picture

FloatArray = NDArray[np.float64]

REJECT = 20.0  # CIELab; about the distance of two colours that nobody would name alike
REJECT_EXACT = 4.0  # where no compression blurred the colours
MODE = 5  # pixels, edge of the window in which the most frequent class wins after compression
FITS = 0.97  # share of pixels that a legend must explain
NEARLY = 0.01  # shares of pixels closer than this are the same


@dataclass(frozen=True)
class Match:
    """How well a legend explains a picture.

    Attributes
    ----------
    legend
        The legend.
    share
        Of the pixels that say something, those that have a colour or value of it.
    seen
        Number of its entries that the picture shows.
    """

    legend: Legend
    share: float
    seen: int

    def text(self) -> str:
        """Return the evidence as words."""
        return (
            f'"{self.legend.name}" explains {100 * self.share:.1f} % of the pixels with '
            f"{self.seen} of its {len(self.legend.entries)} classes"
        )


def unpacked(keys: NDArray[np.int64]) -> NDArray[np.uint8]:
    """Return (n, 3) colours of (n,) 0xRRGGBB."""
    channels = [keys >> 16, (keys >> 8) & 255, keys & 255]
    return np.asarray(np.stack(channels, axis=-1), np.uint8)


def to_lab(colors: NDArray[np.uint8]) -> FloatArray:
    """Return (n, 3) CIELab of (n, 3) sRGB colours."""
    from skimage.color import rgb2lab

    return np.asarray(rgb2lab(colors.reshape(-1, 1, 3) / 255.0).reshape(-1, 3))


def nearest_entry(keys: NDArray[np.int64], legend: Legend, reject: float) -> NDArray[np.int64]:
    """Return the entry of a legend that (n,) keys mean, -1 for none.

    Colours are compared in CIELab, values must be equal.
    """
    wanted = np.array([entry.key for entry in legend.entries])
    if legend.by_value:
        order = np.argsort(wanted)
        place = np.minimum(np.searchsorted(wanted[order], keys), len(wanted) - 1)
        return np.where(wanted[order][place] == keys, order[place], -1)
    from scipy.spatial import cKDTree

    far, entry = cKDTree(to_lab(unpacked(wanted))).query(to_lab(unpacked(keys)))
    return np.where(far <= reject, entry, -1)


def match(picture: Picture, legend: Legend) -> Match:
    """Measure how well a legend explains a picture."""
    reject = REJECT if picture.lossy else REJECT_EXACT
    if legend.by_value and picture.values is None:
        return Match(legend, 0.0, 0)
    keys, index = picture.distinct(by_value=legend.by_value)
    entry = nearest_entry(keys, legend, reject)
    count = np.bincount(index[~picture.void], minlength=len(keys))
    share = float(count[entry >= 0].sum() / max(count.sum(), 1))
    # A colour of a handful of pixels is a stain, not a class.
    shown = entry[(entry >= 0) & (count > 1e-4 * count.sum())]
    return Match(legend, share, len(np.unique(shown)))


def fitting(picture: Picture, presets: Mapping[str, Legend] = PRESETS) -> list[Match]:
    """Return the presets that explain a picture, best first.

    A picture without any second class says nothing, so two classes are asked for.
    """
    found = [match(picture, legend) for legend in presets.values()]
    return sorted(
        (item for item in found if item.share >= FITS and item.seen >= 2),
        key=lambda item: (-round(item.share, 3), len(item.legend.entries) - item.seen),
    )


def labelled(picture: Picture, legend: Legend) -> NDArray[np.uint8]:
    """Return the (rows, columns) entries of a legend; the number of entries where there is none.

    After lossy compression each pixel takes the most frequent entry around it.
    """
    keys, index = picture.distinct(by_value=legend.by_value)
    entry = nearest_entry(keys, legend, REJECT if picture.lossy else REJECT_EXACT)
    none = len(legend.entries)
    labels = np.where(entry < 0, none, entry).astype(np.uint8)[index]
    labels[picture.void] = none
    return most_frequent(labels, none + 1) if picture.lossy else labels


def most_frequent(labels: NDArray[Any], count: int, window: int = MODE) -> NDArray[np.uint8]:
    """Return the most frequent label in a square window around each pixel, the lowest of equals."""
    from scipy.ndimage import uniform_filter

    best = np.zeros(labels.shape, np.float32)
    found = np.zeros(labels.shape, np.uint8)
    for label in range(count):
        share = uniform_filter((labels == label).astype(np.float32), window, mode="nearest")
        more = share > best + 1e-4  # sums in single precision differ by less
        best[more], found[more] = share[more], label
    return found
