"""Parts of streets: a street is parted where a change of it begins and where it ends."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.ops import substring

from cityx.city import City
from cityx.ids import UInt64Array, hash_ids
from cityx.road.network.network import DRIVABLE

PURPOSE = "edit/parts_of_streets"
SHORTEST = 8.0  # metres; no part of a street is shorter
SNAP = 20.0  # metres along a street to a junction at which it is parted instead


def parted(city: City, ids: UInt64Array, region: Any) -> tuple[City, UInt64Array]:
    """Part streets at the border of a region, or at the junctions near to it.

    Parameters
    ----------
    city
        The city.
    ids
        Of the streets.
    region
        Ground that the part lies on.

    Returns
    -------
    city, inside
        With a row for each part; and the ids of those on the region. The first part of a street
        keeps its id.
    """
    roads = city.layout.roads
    rows: list[Any] = []
    inside: list[int] = []
    for row in roads.itertuples(index=False):
        lines, held = [row.geometry], [False]
        if np.uint64(row.id) in ids:
            lines, held = _cut(row.geometry, region, _junctions(roads, row.geometry))
        for number, (line, within) in enumerate(zip(lines, held, strict=True)):
            own = row.id if not number else hash_ids(0, PURPOSE, np.array([row.id], np.uint64),
                                                     np.array([number], np.uint64))[0]  # fmt: skip
            rows.append(row._replace(geometry=line, id=np.uint64(own)))
            inside += [int(own)] if within else []
    table = _table(roads, rows)
    return replace(city, layout=replace(city.layout, roads=table)), np.array(inside, np.uint64)


def _cut(line: Any, region: Any, junctions: NDArray[np.float64]) -> tuple[list[Any], list[bool]]:
    """Return the parts of a line, and which of them lies on a region."""
    held = shapely.intersection(line, region)
    if held.is_empty or not held.length:
        return [line], [False]
    at = shapely.line_locate_point(line, shapely.points(shapely.get_coordinates(held)))
    ends = [_snapped(end, junctions) for end in (float(at.min()), float(at.max()))]
    cuts = [0.0, *ends, float(line.length)]
    lines, within = [], []
    for number, (start, end) in enumerate(pairwise(cuts)):
        if end - start >= SHORTEST:
            lines.append(substring(line, start, end))
            within.append(number == 1)
    if not any(within):
        return [line], [False]
    whole = sum(part.length for part in lines) >= line.length - 1e-6
    return (lines, within) if whole else ([line], [True])


def _snapped(at: float, junctions: NDArray[np.float64]) -> float:
    near = junctions[np.abs(junctions - at) <= SNAP]
    return float(near[np.argmin(np.abs(near - at))]) if len(near) else at


def _junctions(roads: Any, line: Any) -> NDArray[np.float64]:
    """Return how far along a line other streets meet it, its ends with them."""
    kept = roads["kind"].isin(DRIVABLE).to_numpy()
    others = [one for one in roads.geometry.to_numpy()[kept] if one is not line]
    met = shapely.intersection(np.array(others, object), line) if others else np.zeros(0, object)
    points = shapely.points(shapely.get_coordinates(met))
    return np.sort([0.0, float(line.length), *shapely.line_locate_point(line, points)])


def _table(roads: Any, rows: list[Any]) -> Any:
    import geopandas as gpd

    made = gpd.GeoDataFrame(rows, columns=roads.columns, geometry="geometry", crs=roads.crs)
    made = made.astype({name: kind for name, kind in roads.dtypes.items() if name != "geometry"})
    return made.sort_values("id", kind="stable").reset_index(drop=True)
