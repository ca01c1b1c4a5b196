"""Images of a site mirrored across its borders: where they lie and what stands in them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from math import ceil

import numpy as np
from numpy.typing import NDArray

from cityx.geometry.arrays import FloatArray

Box = tuple[float, float, float, float]  # xmin, ymin, xmax, ymax

REACH = 600.0  # metres beyond the site at which the last images stand
MOST_RINGS = 2  # of images round a small site
STRADDLING = 0.5  # metres beyond the border from which a thing would meet its own image


@dataclass(frozen=True)
class Image:
    """One image of the site: x' = sign * x + shift, for x and for y.

    Attributes
    ----------
    sign, shift
        (2,) float64; -1 where the axis is mirrored, and metres.
    """

    sign: FloatArray
    shift: FloatArray

    def placed(self, boxes: FloatArray) -> FloatArray:
        """Return (n, 4) boxes xmin, ymin, xmax, ymax where this image shows them."""
        corners = boxes.reshape(-1, 2, 2) * self.sign + self.shift
        return np.concatenate([corners.min(axis=1), corners.max(axis=1)], axis=1)


def images(extent: Box, reach: float = REACH) -> Iterator[Image]:
    """Yield the images of a site round it, each the mirror image of its neighbours.

    Parameters
    ----------
    extent
        (xmin, ymin, xmax, ymax) of the site, metres.
    reach
        Metres beyond the site that are covered, if two rings of images suffice.
    """
    low, high = np.array(extent[:2]), np.array(extent[2:])
    size = np.maximum(high - low, 1.0)
    rings = [min(MOST_RINGS, ceil(reach / float(side))) for side in size]
    for i in range(-rings[0], rings[0] + 1):
        for j in range(-rings[1], rings[1] + 1):
            if i or j:
                step = np.array([i, j])
                odd = step % 2 == 1
                shift = step * size + np.where(odd, low + high, 0.0)
                yield Image(np.where(odd, -1.0, 1.0), shift)


def near(image: Image, boxes: FloatArray, extent: Box, reach: float = REACH) -> NDArray[np.bool_]:
    """(n,) whether the image of each box lies within reach of the site.

    What stands across a border is left out, since it would meet its own image there.

    Parameters
    ----------
    image
        Where it shows the site.
    boxes
        (n, 4) xmin, ymin, xmax, ymax on the site, metres.
    extent
        Of the site.
    """
    low, high = np.array(extent[:2]), np.array(extent[2:])
    whole = (boxes[:, :2] > low - STRADDLING).all(axis=1)
    whole &= (boxes[:, 2:] < high + STRADDLING).all(axis=1)
    shown = image.placed(boxes)
    gap = np.maximum(np.maximum(low - shown[:, 2:], shown[:, :2] - high), 0.0)
    return np.asarray(whole & (np.hypot(*gap.T) < reach))
