"""What a height file shows: bare ground, a surface with houses, or heights above the ground."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from cityx.city.frame import Frame
from cityx.geometry.arrays import FloatArray
from cityx.geometry.raster.relief import HIGH, WINDOW, bends, ground_below, unevenness
from cityx.sources.heights.height_field import filled_voids
from cityx.sources.heights.height_files import HeightFile
from cityx.sources.heights.height_mosaic import (
    Raster,
    corners,
    spacing,
    strays_of,
    without,
)

COARSE = 6.0  # metres; cells larger than this show no house
LARGEST = 1500  # cells of a side of the middle of a file that is looked at
BEND = 1.0  # metres off the mean of its neighbours: a cell at a wall or in a crown
# Share of all cells that stand high and bend so. Measured: surfaces 2.6 to 21 %, ground 0.1 % at
# most, be it rock or whole metres.
SHARP = 0.004
GROUND = 0.5  # metres; heights above the ground have their ground below this, nearly everywhere
MOSTLY = 95.0  # per cent
CROWNS = 0.65  # metres of unevenness in the middle of things; measured: roofs 0.07 to 0.43, crowns
# 0.87 and 0.93.


class Shows(StrEnum):
    """What the numbers of a height file are."""

    TERRAIN = "terrain"
    SURFACE = "surface"
    ABOVE = "above ground"
    CANOPY = "canopy"


@dataclass(frozen=True)
class HeightKind:
    """What a height file shows, and why it is thought so."""

    shows: Shows
    evidence: str


def kind_of(file: HeightFile, pixel: float | None = None) -> HeightKind:
    """Return the kind of a height file, from the middle of it.

    Parameters
    ----------
    pixel
        Metres of a cell of a file that does not say where it lies; without it that is terrain.
    """
    if file.to_cell is None and pixel is None:
        return HeightKind(Shows.TERRAIN, "its cells are not measured; --pixel says their metres")
    cell = pixel if file.to_cell is None and pixel else cell_size(file)
    if cell > COARSE:
        return HeightKind(Shows.TERRAIN, f"cells of {cell:.3g} m show no house")
    heights = _middle(file)
    if np.isnan(heights).all():
        return HeightKind(Shows.TERRAIN, "its middle is void")
    heights = filled_voids(heights)
    ground = ground_below(heights, cell)
    high = heights - ground > HIGH
    sharp = float((high & (bends(heights) > BEND)).mean())
    text = f"{100 * sharp:.2g} % of its cells are walls or crowns"
    if sharp < SHARP:
        return HeightKind(Shows.TERRAIN, text)
    if float(np.percentile(np.abs(_lowest_near(heights, cell)), MOSTLY)) > GROUND:
        return HeightKind(Shows.SURFACE, text)
    inner = _inner(high)
    rough = float(np.median(unevenness(heights)[inner if inner.any() else high]))
    text = f"{text}, its ground is 0 m, its tops are uneven by {rough:.2f} m"
    return HeightKind(Shows.CANOPY if rough > CROWNS else Shows.ABOVE, text)


def _lowest_near(heights: FloatArray, cell: float) -> FloatArray:
    """Return the lowest height of the window round each cell, which holds some ground."""
    from scipy import ndimage

    return np.asarray(ndimage.minimum_filter(heights, max(3, int(WINDOW / cell) | 1)))


def _inner(high: NDArray[np.bool_]) -> NDArray[np.bool_]:
    from scipy import ndimage

    return np.asarray(ndimage.binary_erosion(high, np.ones((3, 3))))


def _middle(file: HeightFile) -> FloatArray:
    span = [
        slice(max(0, (size - LARGEST) // 2), min(size, (size + LARGEST) // 2))
        for size in file.shape
    ]
    heights = file.read((span[0], span[1]))
    return without(heights, strays_of(heights))


def cell_size(file: HeightFile, default: float = 1.0) -> float:
    """Return the metres between the cells of a file, `default` when it does not say."""
    if file.to_cell is None:
        return default
    if not file.located:
        return abs(1 / file.to_cell[0])
    longitude, latitude = corners(file).mean(axis=0)
    if not np.isfinite([longitude, latitude]).all() or abs(latitude) > 90:
        return default
    frame = Frame(float(latitude), float(longitude))
    return spacing(Raster(np.zeros((0, 0)), file.to_cell, file.crs), frame, (-1, -1, 1, 1))
