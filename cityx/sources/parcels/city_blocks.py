"""Buildings of inner towns on plots: blocks around courts, and towers on podiums."""

from __future__ import annotations

from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.geometry.parcels.plots import Plots, pads_in
from cityx.geometry.polygons import FloatArray
from cityx.geometry.seams import unite
from cityx.sources.parcels.built import (
    Built,
    building_tags,
    built,
    habitable,
    heights_of,
)

BLOCK_DEPTH = (10.0, 13.5)  # metres of a house with light from two sides
RING_SHARE = 0.9  # of the wanted ground that houses along the street take; wings take the rest
WING = 5.8  # metres; a wing along the party wall has rooms to one side
SHORTEST_WING, LONGEST_WING = 4.0, 18.0  # metres
NEWTON = 4  # steps until the area of a base is right to a thousandth
COURT = 4.0  # metres that a wing keeps from the rear border
USUAL_DEPTH = 34.0  # metres; what lies further back counts for no wing
TOWER_FROM = 30.0  # metres; a lower building of the core is all of a piece
SMALLEST_TOWER, LARGEST_TOWER = 15.0, 38.0  # metres a side
PODIUM_LEVELS = (3.0, 5.0)
STOREY = 4.0  # metres, of a podium
FAR = 500.0  # metres; wider than any parcel


def perimeter_blocks(plots: Plots, target: float, *, seed: int) -> list[Built]:
    """Raise houses along the streets, wall to wall around a court, with wings into it."""
    depth = _ring_depth(plots, RING_SHARE * target)
    front = plots.within(plots.street_margin(depth))
    front = _largest(front)
    counted = np.minimum(plots.area, USUAL_DEPTH * shapely.length(plots.street))
    missing = target * counted - shapely.area(front)
    room = plots.high[:, 1] - COURT - depth
    reach = np.minimum(np.clip(missing / WING, 0.0, LONGEST_WING), room)
    left = plots.draw("wing-side", 0, 1, seed=seed) < 0.5
    x0 = np.where(left, -FAR, plots.high[:, 0] - WING)
    x1 = np.where(left, plots.low[:, 0] + WING, FAR)
    wing = plots.within(plots.boxes(x0, depth - 1.0, x1, depth + reach))
    fits = (reach > SHORTEST_WING) & (shapely.get_type_id(wing) == 3) & habitable(wing)
    house = front.copy()
    rows = np.flatnonzero(fits)
    house[rows] = unite(front[rows], wing[rows])
    broken = (shapely.get_type_id(house) != 3) | ~habitable(house)
    house = np.where(broken, front, house)
    levels = 3.6 + 2.4 * plots.density + plots.draw("levels", -0.7, 0.7, seed=seed)
    tags = building_tags(plots, "apartments", levels)
    return [built("house", house, tags, habitable(house))]


def _ring_depth(plots: Plots, target: float) -> FloatArray:
    """Return how deep houses around the court of each block are to take a share of its ground."""
    block = np.unique(plots.block_id, return_inverse=True)[1]
    area = np.bincount(block, plots.area)[block]
    street = np.bincount(block, shapely.length(plots.street))[block]
    # A ring of depth t takes street * t - 4 t^2 of a block with four corners.
    root = np.sqrt(np.maximum(street**2 - 16 * target * area, 0.0))
    return np.asarray(np.clip(np.round((street - root) / 8, 2), *BLOCK_DEPTH))


def _largest(shapes: NDArray[Any]) -> NDArray[Any]:
    """Return the largest polygon of each shape."""
    parts, row = shapely.get_parts(shapes, return_index=True)
    order = np.lexsort((-np.round(shapely.area(parts), 6), row))
    parts, row = parts[order], row[order]
    largest = np.full(len(shapes), shapely.Polygon(), object)
    kept, first = np.unique(row, return_index=True)
    largest[kept] = parts[first]
    return largest


def core_towers(plots: Plots, target: float, *, seed: int) -> list[Built]:
    """Raise podiums with towers on them, plazas around."""
    base = _scaled(plots, target)
    stands = habitable(base)
    pads = pads_in(plots, shapely.buffer(base, -2.5, join_style="mitre"))
    levels = 5.0 + 26.0 * plots.density**2 * plots.draw("levels", 0.5, 1.5, seed=seed)
    height = heights_of(plots, "office", levels)
    side = plots.draw("tower", 22.0, LARGEST_TOWER, seed=seed)
    half_x, half_y = np.minimum(pads.width, side) / 2, np.minimum(pads.depth, side) / 2
    x, y = (pads.x0 + pads.x1) / 2, (pads.y0 + pads.y1) / 2
    tower = plots.boxes(x - half_x, y - half_y, x + half_x, y + half_y)
    slim = np.minimum(half_x, half_y) * 2
    towering = stands & (height >= TOWER_FROM) & (slim >= SMALLEST_TOWER)
    low = np.rint(plots.draw("podium", *PODIUM_LEVELS, seed=seed))
    tags = building_tags(plots, "office", levels)
    parts, podiums = [], []
    for metres, storeys, own in zip(height.tolist(), low.tolist(), tags, strict=True):
        own["height"] = f"{metres:.1f}"
        parts.append({
            "building:part": "yes", "height": own["height"],
            "building:levels": own["building:levels"], "roof:shape": "flat",
        })  # fmt: skip
        podiums.append({
            "building:part": "yes", "height": f"{storeys * STOREY:.1f}",
            "building:levels": str(int(storeys)), "roof:shape": "flat",
        })  # fmt: skip
    rest = shapely.difference(base, tower)
    return [
        built("house", base, tags, stands),
        built("podium", rest, podiums, towering),
        built("tower", tower, parts, towering),
    ]


def _scaled(plots: Plots, target: float) -> NDArray[Any]:
    """Return the parcels less a margin all around that leaves a share of their area."""
    distance = np.zeros(plots.count)
    for _ in range(NEWTON):  # a step of Newton's method; a margin changes the area by its length
        left = shapely.buffer(plots.shapes, -distance, join_style="mitre")
        length = np.maximum(shapely.length(left), 1.0)
        distance = np.maximum(distance + _error(left, plots.area, target) / length, 0.0)
    return _largest(shapely.buffer(plots.shapes, -distance, join_style="mitre"))


def _error(shapes: NDArray[Any], whole: FloatArray, target: float) -> FloatArray:
    return np.asarray(shapely.area(shapes) - target * whole)
