"""Seams: cutting and joining shapes so that what lay edge to edge still does."""

from __future__ import annotations

from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

NEEDLE = 2.0**-23  # metres (0.1 micrometre); shapes are rounded to it to find out what is rounding
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
