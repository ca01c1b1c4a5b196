"""Seams: cutting and joining shapes so that what lay edge to edge still does."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.geometry.arrays import FloatArray

NEEDLE = 2.0**-23  # metres (0.1 micrometre); shapes are rounded to it to find out what is rounding
FINE = 2.0**30  # steps per metre of what is cut; such places keep every bit up to 8,000 km away
RETURN = 4 * NEEDLE  # metres within which corners go back to where they were


def common(shapes: NDArray[Any], others: NDArray[Any]) -> NDArray[Any]:
    """Return what shapes, (n,), have in common with others, (n,)."""
    return _cut(shapely.intersection, shapes, others)


def _cut(operation: Callable[..., Any], shapes: NDArray[Any], others: NDArray[Any]) -> NDArray[Any]:
    """Cut shapes by others, (n,) by (n,), those that GEOS refuses on the grid of `NEEDLE`."""
    try:
        return np.asarray(operation(shapes, others), object)
    except shapely.errors.GEOSException:
        pass  # one bad outline stops the whole array, so it is looked for
    found = np.full(len(shapes), shapely.Polygon(), object)
    for row, (shape, other) in enumerate(zip(shapes, others, strict=True)):
        try:
            found[row] = operation(shape, other)
        except shapely.errors.GEOSException:
            valid = shapely.make_valid([shape, other], method="structure", keep_collapsed=False)
            found[row] = shapely.set_precision(operation(*valid, grid_size=NEEDLE), 0.0)
    return found


def subtract(shapes: NDArray[Any], cut: NDArray[Any]) -> NDArray[Any]:
    """Take shapes, (n,), from others, without the needles that rounding leaves."""
    rest = shapely.set_precision(_cut(shapely.difference, shapes, cut), NEEDLE)
    rest = shapely.set_precision(rest, 0.0)
    return np.asarray(shapely.snap(shapely.snap(rest, cut, RETURN), shapes, RETURN), object)


def unite(a: NDArray[Any], b: NDArray[Any]) -> NDArray[Any]:
    """Join shapes, (n,) with (n,), whose common edges may have corners on one side only."""
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
