"""Plots of buildings: what massing needs to know of the footprint, the street and the roof."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.building.facade.fronts import STREETS
from cityx.building.massing.massing import Plot
from cityx.geometry.arrays import FloatArray, IntArray

if TYPE_CHECKING:
    from cityx.city.layout import Layout

STREET_REACH = 120.0  # metres; a street further away gives a building no front


def plots_of(layout: Layout, rows: IntArray, part_rows: IntArray, seed: int) -> list[Plot]:
    """Gather what massing needs to know of buildings.

    Parameters
    ----------
    rows, part_rows
        (k,) rows of the buildings and of their single parts.
    """
    buildings, parts = layout.buildings, layout.parts
    ids = buildings["id"].to_numpy(np.uint64)[rows]
    tags = buildings["tags"].to_numpy(str)[rows]
    said = np.char.find(tags, '"roof:shape"') >= 0
    plans = parts.geometry.to_numpy()[part_rows]
    top = parts["top"].to_numpy(float)[part_rows]
    levels = parts["levels"].to_numpy(int)[part_rows]
    shape = parts["roof_shape"].to_numpy(str)[part_rows]
    rise = parts["roof_height"].to_numpy(float)[part_rows]
    front = _fronts(layout, plans)
    boxes = boxes_of(plans)
    return [
        Plot(
            plans[i], float(top[i]), max(int(levels[i]), 1), int(ids[i]), seed,
            (float(front[i, 0]), float(front[i, 1])), str(shape[i]), float(rise[i]), bool(said[i]),
            box=boxes[i],
        )
        for i in range(len(rows))
    ]  # fmt: skip


def boxes_of(plans: NDArray[Any]) -> list[tuple[tuple[float, float], ...]]:
    """Return the corners of the smallest box around each plan, () for a plan without one."""
    boxes = shapely.oriented_envelope(plans)
    good = (shapely.get_type_id(boxes) == 3) & ~shapely.is_empty(boxes)
    corner = shapely.get_coordinates(boxes[good]).reshape(-1, 5, 2)[:, :4].tolist()
    found: list[tuple[tuple[float, float], ...]] = [()] * len(plans)
    for row, ring in zip(np.flatnonzero(good).tolist(), corner, strict=True):
        found[row] = tuple((x, y) for x, y in ring)
    return found


def _fronts(layout: Layout, plans: NDArray[Any]) -> FloatArray:
    """Return unit vectors from buildings to the nearest street, else zeros, (k, 2)."""
    front = np.zeros((len(plans), 2))
    kinds = layout.roads["kind"].to_numpy(str)
    blocked = layout.roads["tunnel"].to_numpy(bool) | layout.roads["passage"].to_numpy(bool)
    streets = layout.roads.geometry.to_numpy()[np.isin(kinds, list(STREETS)) & ~blocked]
    if not len(streets) or not len(plans):
        return front
    middle = shapely.centroid(plans)
    tree = shapely.STRtree(streets)
    row, road = tree.query_nearest(middle, max_distance=STREET_REACH, all_matches=False)
    line = shapely.get_coordinates(shapely.shortest_line(middle[row], streets[road]))
    vector = line[1::2] - line[::2]
    length = np.hypot(*vector.T)
    front[row] = vector / np.maximum(length, 1e-9)[:, None]
    return front
