"""Seams: cutting and joining shapes so that what lay edge to edge still does."""

from __future__ import annotations

from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.geometry.polygons import FloatArray

NEEDLE = 2.0**-23  # metres (0.1 micrometre); shapes are rounded to it to find out what is rounding
FINE = 2.0**30  # steps per metre of what is cut; such places keep every bit up to 8,000 km away
RETURN = 4 * NEEDLE  # metres within which corners go back to where they were


def subtract(shapes: Any, cut: Any) -> Any:
    """Take a shape, or (n,) shapes, from others, without the needles that rounding leaves."""
    rest = shapely.set_precision(shapely.difference(shapes, cut), NEEDLE)
    rest = shapely.set_precision(rest, 0.0)
    return shapely.snap(shapely.snap(rest, cut, RETURN), shapes, RETURN)


def unite(a: NDArray[Any], b: NDArray[Any]) -> NDArray[Any]:
    """Unite shapes, (n,) with (n,), whose common edges may have corners on one side only."""
    both = shapely.set_precision(shapely.union(a, b, grid_size=NEEDLE), 0.0)
    corners = shapely.geometrycollections(np.column_stack([a, b]))
    return np.asarray(shapely.snap(both, corners, RETURN), object)


def moved(shapes: NDArray[Any], shift: FloatArray, decimals: int | None = None) -> NDArray[Any]:
    """Move each shape by its own shift, (n, 2) metres, and round it to decimals of metres."""
    points, row = shapely.get_coordinates(shapes, return_index=True)
    points = points + shift[row]
    points = points if decimals is None else np.round(points, decimals)
    return np.asarray(shapely.set_coordinates(shapes.copy(), points + 0.0), object)


def on_grid(shapes: NDArray[Any]) -> NDArray[Any]:
    """Put corners on a binary grid, on which adding an origin of whole metres is exact.

    Shapes with needles thinner than the grid lose them, and are rounded to `NEEDLE`.
    """
    points = shapely.get_coordinates(shapes)
    snapped = shapely.set_coordinates(shapes.copy(), np.round(points * FINE) / FINE)
    broken = np.flatnonzero(~shapely.is_valid(snapped))
    snapped[broken] = shapely.set_precision(shapely.set_precision(shapes[broken], NEEDLE), 0.0)
    return np.asarray(snapped, object)
