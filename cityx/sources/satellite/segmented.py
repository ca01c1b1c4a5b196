"""Segmented images: what a segmenter says of a whole image, tile by tile, in bounded memory."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cityx.sources.satellite.segmenter import Segmenter

FloatArray = NDArray[np.float32]
IntArray = NDArray[np.int64]

OVERLAP = 64  # pixels that neighbouring tiles share; half of it is left unused at each side
SURE = 255  # the byte for a confidence of 1
FLIPS = ((slice(None), slice(None)), (slice(None), slice(None, None, -1)))
ALL_FLIPS = (*FLIPS, *((slice(None, None, -1), columns) for _, columns in FLIPS))


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
