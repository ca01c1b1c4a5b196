"""Segmenting without learning: what colour and texture alone say of an image from above.

Plants are green, water is smooth, dark and blue, streets are grey and even strips, roofs stand out
from what lies around them. Good enough to start from where no network can run; far less sure.

References
----------
Woebbecke et al., "Color indices for weed identification", 1995 (excess green).
Sato et al., "Three-dimensional multi-scale line filter", 1998 (strips).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cityx.sources.map_classes import class_of
from cityx.sources.satellite.segmenter import Segmenter

FloatArray = NDArray[np.float32]

PIXEL = 1.0  # metres for which the filters below are made
FINE, WIDE = 1.0, 12.0  # metres: grain of surfaces, and the surroundings of a house
STREETS = (2.5, 4.0, 6.0)  # metres, deviations of strips from a lane to an avenue
GREEN = 0.04  # excess green from which something is a plant
BLUE = 0.10  # the same of blue over red, from which something may be water
DARK = 0.17  # brightness below which something may be water
DIM = 0.12  # brightness below which colours are noise
SMOOTH = 0.02  # deviation of brightness over the grain of a calm surface
STANDS_OUT = 0.10  # brightness or saturation by which a roof differs from its surroundings
STEEP = 2.0  # logits for a quantity of twice its limit
BARE = 0.4  # logit of the class that needs no evidence


def unlearned_segmenter() -> Segmenter:
    """Return the segmenter of colours and textures."""
    words = ("building", "road", "vegetation", "water", "bare")
    return Segmenter(
        "colour and texture (no learning)",
        tuple(class_of(word) for word in words),
        _logits,
        pixel=PIXEL,
        tile=1024,
        stride=1,
    )


def _logits(image: FloatArray) -> FloatArray:
    """Return (5, h, w) logits of (3, h, w) RGB from 0 to 1."""
    from scipy import ndimage

    def even(plane: FloatArray, metres: float) -> FloatArray:
        return np.asarray(ndimage.gaussian_filter(plane, metres / PIXEL), np.float32)

    red, green, blue = (even(plane, FINE) for plane in image)
    bright = (red + green + blue) / 3
    total = np.maximum(3 * bright, 1e-3)
    vivid = np.maximum(np.maximum(red, green), blue) - np.minimum(np.minimum(red, green), blue)
    excess = (2 * green - red - blue) / total
    bluish = (blue - red) / total
    raw = image.mean(axis=0)
    grain = np.sqrt(np.maximum(even(raw * raw, 2 * FINE) - even(raw, 2 * FINE) ** 2, 0))
    calm = _over(SMOOTH - grain, SMOOTH)
    plant = np.where(bright > DIM, _over(excess - GREEN, GREEN), -1)
    blue = np.where(bright > DIM, _over(bluish - BLUE, BLUE), -1)
    water = np.minimum(np.maximum(_over(DARK - bright, DARK), blue), calm)
    water = even(water, 3 * FINE)  # shadows are dark too, but small
    strip = _strips(bright)
    grey = _over(0.10 - vivid, 0.10)
    road = strip + np.minimum(grey, 0) + 0.5 * np.clip(calm, -1, 1)
    apart = np.abs(bright - even(bright, WIDE)) + np.abs(vivid - even(vivid, WIDE))
    roof = even(_over(apart - STANDS_OUT, STANDS_OUT), FINE) - np.maximum(strip, 0)
    bare = np.full_like(bright, BARE / STEEP) - np.maximum(water, 0)
    found = np.stack([roof, road, plant, 2 * water, bare])
    return np.asarray(STEEP * np.clip(found, -2, 2), np.float32)


def _over(excess: FloatArray, limit: float) -> FloatArray:
    """Return excess over a limit in units of that limit, from -1 to 1."""
    return np.asarray(np.clip(excess / limit, -1, 1), np.float32)


def _strips(bright: FloatArray) -> FloatArray:
    """Return from -1 to 1 how much each pixel looks like a part of a long, even strip."""
    from skimage.feature import hessian_matrix, hessian_matrix_eigvals

    best = np.zeros_like(bright)
    for deviation in STREETS:
        bends = hessian_matrix(
            bright, sigma=deviation / PIXEL, order="rc", use_gaussian_derivatives=False
        )
        curves = hessian_matrix_eigvals(bends)
        across = np.abs(curves).max(axis=0)
        along = np.abs(curves).min(axis=0)
        best = np.maximum(best, (across - 2 * along) * (deviation / PIXEL) ** 2)
    return _over(best - 0.02, 0.02)
