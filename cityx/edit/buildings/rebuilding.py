"""Rebuilding: rebuild some buildings from the layout, and keep all others."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.building.design import raised
from cityx.building.facade.frontage import REACH
from cityx.building.facade.fronts import QUARTER, trade_of
from cityx.building.splicing import (
    SHELLS,
    with_rows,
    with_shells,
    without,
    without_owned,
)
from cityx.city.city import City
from cityx.city.layout import Layout
from cityx.city.rows import take_rows
from cityx.city.scene import Scene

if TYPE_CHECKING:
    from geopandas import GeoDataFrame

Ids = NDArray[np.uint64]

BESIDE = REACH + 3.0  # metres to the farthest building that what is built of another depends on
AROUND = 60.0  # metres round those buildings to the farthest street or water their walls look at


def rebuilt(city: City, ids: Ids) -> City:
    """Rebuild buildings as their rows of the layout say, and nothing else.

    What a build would make of them depends on the buildings near by, which are looked at and stay
    as they are, byte for byte.

    Parameters
    ----------
    city
        With the layout as it shall be.
    ids
        (k,) uint64 of buildings; those that are no longer in the layout are taken away.
    """
    failures = tuple(one for one in city.failures if np.uint64(one.object_id) not in ids)
    wanted = np.isin(city.layout.buildings["id"].to_numpy(np.uint64), ids)
    if not wanted.any():
        return replace(city, scene=without(city.scene, ids), failures=failures)
    made = _raised_alone(city, wanted)
    shells = made.scene.meshes[SHELLS]
    fresh = shells.take(np.flatnonzero(np.isin(shells.object_id, ids)))
    scene = without_owned(with_shells(city.scene, ids, fresh), ids)
    for layer, rows in made.scene.instances.items():
        mine = np.isin(rows.owner, ids)
        if mine.any():
            scene = with_rows(scene, layer, made.scene.prototypes, take_rows(rows, mine))
    failed = tuple(one for one in made.failures if np.uint64(one.object_id) in ids)
    return replace(city, scene=scene, failures=failures + failed)


def _raised_alone(city: City, wanted: NDArray[np.bool_]) -> City:
    """Build a city of some buildings and of those beside them."""
    layout = city.layout
    shapes = layout.buildings.geometry.to_numpy()
    away = _distance(shapes, shapes[wanted])
    trade = _trade_around(city, away <= QUARTER)
    near = _some(layout, away <= BESIDE)
    xmin, ymin, xmax, ymax = near.buildings.total_bounds.tolist()
    window = shapely.box(xmin - AROUND, ymin - AROUND, xmax + AROUND, ymax + AROUND)
    near = replace(near, **{name: _touching(getattr(layout, name), window)
                            for name in ("roads", "areas", "points")})  # fmt: skip
    of_part = np.array([trade.get(one, 1.0) for one in near.parts["id"].tolist()])
    alone = replace(city, layout=near, scene=Scene(), failures=(), notes=())
    return raised(alone, of_part)


def _distance(shapes: NDArray[Any], wanted: NDArray[Any]) -> NDArray[np.float64]:
    """(n,) metres from each shape to the nearest of those wanted, inf beyond a quarter."""
    away = np.full(len(shapes), np.inf)
    tree = shapely.STRtree(wanted)
    row, _ = tree.query(shapes, predicate="dwithin", distance=QUARTER)
    near = np.unique(row)
    _, least = tree.query_nearest(shapes[near], return_distance=True, all_matches=False)
    away[near] = least
    return away


def _trade_around(city: City, quarter: NDArray[np.bool_]) -> dict[int, float]:
    """Map parts to the trade around them, correct for the buildings in the middle."""
    around = _some(city.layout, quarter)
    values = trade_of(around, city.seed).tolist()
    return dict(zip(around.parts["id"].tolist(), values, strict=True))


def buildings_of(layout: Layout, ids: Ids) -> Layout:
    """Return a layout with some of its buildings, by id, and their parts."""
    return _some(layout, np.isin(layout.buildings["id"].to_numpy(np.uint64), ids))


def _some(layout: Layout, kept: NDArray[np.bool_]) -> Layout:
    buildings = _rows(layout.buildings, kept)
    own = np.isin(layout.parts["building"].to_numpy(np.uint64), buildings["id"].to_numpy(np.uint64))
    return replace(layout, buildings=buildings, parts=_rows(layout.parts, own))


def _touching(table: GeoDataFrame, window: Any) -> GeoDataFrame:
    return _rows(table, shapely.intersects(table.geometry.to_numpy(), window))


def _rows(table: GeoDataFrame, kept: NDArray[np.bool_]) -> GeoDataFrame:
    return table.iloc[np.flatnonzero(kept)].reset_index(drop=True)
