"""Segmented images: what a segmenter says of a whole image, tile by tile, in bounded memory.

Plants are green, water is smooth, dark and blue, streets are grey and even strips, roofs stand out
from what lies around them. Good enough to start from where no network can run; far less sure.

References
----------
Woebbecke et al., "Color indices for weed identification", 1995 (excess green).
Sato et al., "Three-dimensional multi-scale line filter", 1998 (strips).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cityx.geometry.arrays import IntArray
from cityx.sources.map_classes import class_of
from cityx.sources.satellite.segmenter import Segmenter

FloatArray = NDArray[np.float32]

OVERLAP = 64  # pixels that neighbouring tiles share; half of it is left unused at each side
SURE = 255  # the byte for a confidence of 1
FLIPS = ((slice(None), slice(None)), (slice(None), slice(None, None, -1)))
ALL_FLIPS = (*FLIPS, *((slice(None, None, -1), columns) for _, columns in FLIPS))
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


@dataclass(frozen=True)
class Segmented:
    """What lies where, and how sure that is.

    Attributes
    ----------
    labels
        (rows, columns) uint8 channel of the likeliest class.
    confidence
        (rows, columns) uint8, the probability of that class times `SURE`.
    """

    labels: NDArray[np.uint8]
    confidence: NDArray[np.uint8]


def segment(image: NDArray[np.uint8], segmenter: Segmenter, *, flips: bool = False) -> Segmented:
    """Segment an image.

    Parameters
    ----------
    image
        (rows, columns, 3) sRGB.
    segmenter
        Given squares of at most its `tile`, mirrored at the borders of the image.
    flips
        Whether each square is also seen mirrored both ways, for four times the work.
    """
    shape = image.shape[0], image.shape[1]
    labels = np.zeros(shape, np.uint8)
    confidence = np.zeros(shape, np.uint8)
    for rows, columns, inner in squares(shape, segmenter.tile, segmenter.stride):
        square = image[np.ix_(rows, columns)].transpose(2, 0, 1).astype(np.float32) / 255
        chance = _chance(segmenter.run, square, ALL_FLIPS if flips else FLIPS[:1])
        chance = chance[:, inner[0], inner[1]]
        where = np.ix_(rows[inner[0]], columns[inner[1]])
        labels[where] = chance.argmax(axis=0)
        confidence[where] = np.rint(chance.max(axis=0) * SURE)
    return Segmented(labels, confidence)


def _chance(
    run: Callable[[FloatArray], FloatArray],
    image: FloatArray,
    flips: tuple[tuple[slice, slice], ...],
) -> FloatArray:
    """Return (classes, h, w) probabilities, the mean over mirrored views."""
    total = np.float32(0)
    for flip in flips:
        view = (slice(None), *flip)
        logits = run(np.ascontiguousarray(image[view]))[view]
        chance = np.exp(logits - logits.max(axis=0))
        total = total + chance / chance.sum(axis=0)
    return np.asarray(total / len(flips), np.float32)


def squares(
    shape: tuple[int, int], tile: int, stride: int
) -> Iterator[tuple[IntArray, IntArray, tuple[slice, slice]]]:
    """Cut a raster into squares that overlap.

    Parameters
    ----------
    shape
        Rows and columns.
    tile
        Most pixels of a side.
    stride
        Of which sides are multiples.

    Yields
    ------
    rows, columns
        (h,) and (w,) pixels of the raster that a square shows; they turn back at the borders.
    inner
        Part of the square that is its own: together these cover the raster, each pixel once.
    """
    tracks = [list(_spans(size, tile, stride)) for size in shape]
    for rows, inner_rows in tracks[0]:
        for columns, inner_columns in tracks[1]:
            yield rows, columns, (inner_rows, inner_columns)


def _spans(size: int, tile: int, stride: int) -> Iterator[tuple[IntArray, slice]]:
    margin = OVERLAP // 2
    count = -(-size // (tile - OVERLAP))
    side = min(tile, -(-(-(-size // count) + OVERLAP) // stride) * stride)  # all of one size
    own = side - OVERLAP
    for start in range(0, size, own):
        wanted = np.arange(start - margin, start - margin + side)
        yield _mirrored(wanted, size), slice(margin, margin + min(own, size - start))


def _mirrored(index: IntArray, size: int) -> IntArray:
    """Fold (n,) indices beyond a raster back into it."""
    if size == 1:
        return np.zeros_like(index)
    period = 2 * (size - 1)
    folded = np.abs(index) % period
    return np.asarray(np.minimum(folded, period - folded))


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
