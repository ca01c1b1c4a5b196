"""Volumes of buildings as rows of the parts of a layout."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import shapely

from cityx.building.massing.massing import Mass
from cityx.building.stated_forms import stated_forms
from cityx.city.bounds import bounds_of
from cityx.city.layout import is_mesh
from cityx.geometry.arrays import FloatArray, IntArray
from cityx.ids import hash_ids
from cityx.sources.features.parts import body_ids

if TYPE_CHECKING:
    from geopandas import GeoDataFrame

    from cityx.city.layout import Layout

STRETCH = 0.001  # of a height that is said, by which what is built may miss it


def with_masses(
    layout: Layout, gone: list[int], sources: list[int], masses: list[Mass], numbers: list[int],
    storey: FloatArray | None = None,
) -> Layout:  # fmt: skip
    """Put volumes in the place of parts.

    Parameters
    ----------
    gone
        Rows of the parts that are replaced.
    sources, numbers
        Of each volume: the row of the part it comes from, and its number among those of that part.
    storey
        Metres of a storey of each volume; those of its part when left out.
    """
    import pandas as pd

    buildings, parts = layout.buildings, layout.parts
    ids = buildings["id"].to_numpy(np.uint64)
    fresh = parts.iloc[sources].copy()
    own = fresh["id"].to_numpy(np.uint64)
    k = np.array(numbers, np.int64)
    storey = _storeys(fresh) if storey is None else storey
    fresh["id"] = np.where(k > 0, hash_ids(0, "building/mass", own, k), own)
    fresh["zone"] = [mass.zone for mass in masses]
    fresh["base"] = [mass.low for mass in masses]
    fresh["top"] = [mass.high for mass in masses]
    fresh["roof_shape"] = [mass.roof for mass in masses]
    fresh["roof_height"] = [mass.rise for mass in masses]
    fresh["roof_direction"] = [mass.direction for mass in masses]
    fresh["roof_across"] = [mass.across for mass in masses]
    fresh["walls"] = [mass.walls for mass in masses]
    tall = np.array([mass.height - mass.rise for mass in masses])
    of = np.searchsorted(ids, fresh["building"].to_numpy(np.uint64))
    most = bounds_of(buildings, "levels").most[of]
    fresh["levels"] = np.clip(np.round(tall / storey), 1, most).astype(np.int16)
    plans = np.array([mass.plan for mass in masses], object)
    fresh = fresh.set_geometry(shapely.orient_polygons(plans))
    rest = parts.drop(index=parts.index[gone])
    joined = sorted_parts(pd.concat([rest, fresh], ignore_index=True))
    height = buildings["height"].to_numpy(float).copy()
    height[of] = 0.0
    np.maximum.at(height, of, fresh["top"].to_numpy(float))
    buildings = buildings.copy()
    buildings["height"] = height
    return replace(layout, parts=joined, buildings=buildings)


class Aim(NamedTuple):
    """How high a building shall be, metres: as it is said, nan where nothing is; and its bounds."""

    said: float = math.nan
    least: float = 0.0
    most: float = math.inf

    def height(self, grown: float) -> float:
        """Return how high a building shall be that was grown so high."""
        return min(max(grown, self.least), self.most) if math.isnan(self.said) else self.said


def aims_of(buildings: GeoDataFrame, rows: IntArray) -> list[Aim]:
    """Return (k,) heights that the map, a wish or a bound says."""
    known = ~np.isnan(stated_forms(buildings.iloc[rows]).height)
    said = np.where(known, buildings["height"].to_numpy(float)[rows], np.nan)
    bounds = bounds_of(buildings.iloc[rows], "height")
    return [Aim(*one) for one in zip(said.tolist(), *map(np.ndarray.tolist, bounds), strict=True)]


def highest_of(masses: list[Mass]) -> float:
    """Return the metres of the highest of some volumes, 0 of none."""
    return max((mass.high for mass in masses), default=0.0)


def as_high_as(masses: list[Mass], aim: Aim) -> list[Mass]:
    """Stretch the volumes of a building so that the highest ends where it shall."""
    highest = highest_of(masses)
    factor = aim.height(highest) / highest if highest > 0.0 else 1.0
    if not abs(factor - 1.0) > STRETCH and highest * factor <= aim.most:
        return masses
    return [
        replace(mass, low=mass.low * factor, high=mass.high * factor, rise=mass.rise * factor)
        for mass in masses
    ]


def plain_rows(layout: Layout) -> IntArray:
    """Row of the only part of each building that is one plain volume, else -1; (n,)."""
    ids = layout.buildings["id"].to_numpy(np.uint64)
    parts = layout.parts
    owner = parts["building"].to_numpy(np.uint64)
    if not len(ids) or not len(parts):
        return np.full(len(ids), -1, np.int64)
    row = np.minimum(np.searchsorted(ids, owner), len(ids) - 1)
    known = ids[row] == owner
    number = np.bincount(row[known], minlength=len(ids))
    only = np.full(len(ids), -1, np.int64)
    only[row[known]] = np.flatnonzero(known)
    standing = (parts["base"].to_numpy(float) < 0.05) & parts["walls"].to_numpy(bool)
    standing &= (shapely.area(parts.geometry.to_numpy()) > 8.0) & ~is_mesh(layout)
    # A single part of the map that makes up the whole building is described too.
    standing &= np.isin(parts["id"].to_numpy(np.uint64), [*ids, *body_ids(ids)])
    return np.where((number == 1) & standing[only], only, -1)


def _storeys(fresh: Any) -> FloatArray:
    """Metres of a storey of each new part's building, (k,)."""
    levels = np.maximum(fresh["levels"].to_numpy(float), 1.0)
    tall = fresh["top"].to_numpy(float) - fresh["roof_height"].to_numpy(float)
    return np.asarray(np.maximum(tall / levels, 2.2))


def sorted_parts(parts: Any) -> GeoDataFrame:
    """Return the parts in the order of their ids."""
    return parts.sort_values("id", kind="stable", ignore_index=True)
