"""Outlines of buildings in the layout, drawn elsewhere, turned or larger."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import shapely

from cityx.city.layout import Layout
from cityx.geometry.arrays import BoolArray, FloatArray
from cityx.ids import UInt64Array

Reshape = Callable[[FloatArray], FloatArray]


def rows_of(layout: Layout, ids: UInt64Array) -> tuple[BoolArray, BoolArray]:
    """Return which rows of `buildings` and of `parts` are of some buildings."""
    own = np.isin(layout.buildings["id"].to_numpy(np.uint64), ids)
    return own, np.isin(layout.parts["building"].to_numpy(np.uint64), ids)


def redrawn(layout: Layout, ids: UInt64Array, moved: Reshape, *, turn: float = 0.0) -> Layout:
    """Return a layout with other outlines of some buildings and of their parts.

    Parameters
    ----------
    layout
        The layout.
    ids
        Of the buildings.
    moved
        Takes (n, 2) points to where they shall be.
    turn
        Radians counter-clockwise by which that turns; the directions of roofs turn along.
    """
    own, of_part = rows_of(layout, ids)
    buildings, parts = layout.buildings.copy(), layout.parts.copy()
    for table, rows in ((buildings, own), (parts, of_part)):
        shapes = table.geometry.to_numpy().copy()
        shapes[rows] = shapely.transform(shapes[rows], moved)
        table.geometry = shapes
    direction = parts["roof_direction"]
    parts["roof_direction"] = np.where(of_part, (direction - turn) % (2 * np.pi), direction)
    return replace(layout, buildings=buildings, parts=parts)
