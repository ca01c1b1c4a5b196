"""What is put on plots: shapes, whose they are and what they are."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.geometry.parcels.plots import Pads, Plots
from cityx.geometry.polygons import FloatArray, IntArray
from cityx.geometry.seams import moved
from cityx.ids import UInt64Array, id_text
from cityx.sources.features.building_heights import TYPE_OF_USE, height_of_levels, levels_of_height
from cityx.sources.features.tagged import Owner, Tagged, Tags

LEAST_ROOM = 4.2  # metres; no building is narrower
LOST = 0.25  # of a building, how much may be corners too narrow for a room
LEAST_AREA = 30.0  # square metres; nor smaller


@dataclass(frozen=True)
class Built:
    """k shapes of one sort on plots, at most one for each plot.

    Attributes
    ----------
    name
        What tells them from other shapes of the same plots: "house".
    row
        (k,) plot.
    shapes
        (k,) where they lie in the frames of the plots, before ``Plots.shift``.
    tags
        (k,) their tags.
    """

    name: str
    row: IntArray
    shapes: NDArray[Any]
    tags: list[Tags]

    def of(self, rows: IntArray) -> Built:
        """Return the same on plots of which these are some: `rows` are their numbers."""
        return Built(self.name, rows[self.row], self.shapes, self.tags)


def built(
    name: str, shapes: NDArray[Any], tags: Tags | Sequence[Tags], where: NDArray[np.bool_]
) -> Built:
    """Put a shape on each of the plots marked, with its own tags or with the same for all."""
    row = np.flatnonzero(where & ~shapely.is_empty(shapes))
    own = [dict(tags) if isinstance(tags, dict) else tags[i] for i in row.tolist()]
    return Built(name, row, shapes[row], own)


def habitable(shapes: NDArray[Any]) -> NDArray[np.bool_]:
    """Return which shapes are single polygons wide and large enough to live in."""
    good = (shapely.get_type_id(shapes) == 3) & (shapely.area(shapes) >= LEAST_AREA)
    rows = np.flatnonzero(good)
    inner = shapely.buffer(shapes[rows], -LEAST_ROOM / 2 + 0.01, join_style="mitre")
    # Nothing that a room's width does not reach into may be more than a corner of the shape.
    opened = shapely.buffer(inner, LEAST_ROOM / 2, join_style="mitre")
    lost = shapely.area(shapely.difference(shapes[rows], opened))
    good[rows] = ~shapely.is_empty(inner) & (lost < LOST * shapely.area(shapes[rows]))
    return np.asarray(good, bool)


def building_tags(plots: Plots, use: str, levels: FloatArray, **more: str) -> list[Tags]:
    """Return tags of buildings: levels as drawn, or those of the height that is wanted."""
    types = np.full(plots.count, TYPE_OF_USE.get(use, 0))
    wanted = ~np.isnan(plots.height)
    fitting = levels_of_height(np.where(wanted, plots.height, 3.0), types)
    storeys = np.where(wanted, fitting, np.maximum(np.rint(levels), 1)).astype(int)
    found = []
    for count, height in zip(storeys.tolist(), plots.height.tolist(), strict=True):
        tags = {"building": use, "building:levels": str(count), **more}
        if height == height:
            tags["height"] = f"{height:.1f}"
        found.append(tags)
    return found


def heights_of(plots: Plots, use: str, levels: FloatArray) -> FloatArray:
    """Return metres of buildings: as wanted, or as high as their levels."""
    types = np.full(plots.count, TYPE_OF_USE.get(use, 0))
    usual = height_of_levels(np.maximum(np.rint(levels), 1), types)
    return np.where(np.isnan(plots.height), usual, plots.height)


def pad_box(plots: Plots, pads: Pads, width: Any, depth: Any, *, at: Any = 0.5) -> NDArray[Any]:
    """Return rectangles at the front of pads; `at` 0 is their left end, 1 their right one."""
    x0 = pads.x0 + at * np.maximum(pads.width - width, 0.0)
    return plots.boxes(x0, pads.y0, x0 + np.minimum(width, pads.width),
                       pads.y0 + np.minimum(depth, pads.depth))  # fmt: skip


def tagged_of(found: Iterable[Built], ids: UInt64Array, shift: FloatArray) -> Tagged:
    """Give shapes their owners and move them to where the plots lie, plot by plot."""
    owners: list[Owner] = []
    shapes: list[NDArray[Any]] = []
    rows: list[IntArray] = []
    for some in found:
        names = [id_text(one) for one in ids[some.row].tolist()]
        owners += [
            Owner(("parcel", name), tags, (some.name,))
            for name, tags in zip(names, some.tags, strict=True)
        ]
        shapes.append(some.shapes)
        rows.append(some.row)
    if not owners:
        return Tagged(np.zeros(0, object), np.zeros(0, np.int64), np.zeros(0, np.int64), [])
    row = np.concatenate(rows)
    order = np.argsort(row, kind="stable")
    placed = moved(np.concatenate(shapes)[order], shift[row[order]])
    return Tagged(
        placed,
        np.arange(len(owners)),
        np.zeros(len(owners), np.int64),
        [owners[index] for index in order.tolist()],
    )
