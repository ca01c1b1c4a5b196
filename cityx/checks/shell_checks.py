"""Checks of shells against the layout, and of every mesh: finite numbers, known prototypes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.checks.check import Check, named
from cityx.city import City
from cityx.city.layout import is_mesh
from cityx.city.levels import ground_levels, terrain_at_walls
from cityx.city.mesh import MeshBatch
from cityx.city.mesh_measures import plan_middle
from cityx.geometry.arrays import FloatArray, IntArray
from cityx.ground.building_passages import open_ways

TOP_ERROR = 0.3  # metres; parapets and ridges end within a tenth of it
PLINTH = 0.8  # metres below the lowest ground: half a metre of plinth, and what may be missed
FOOT = 0.05  # metres over the lowest vertex that are its foot
PLACE_ERROR = 0.5  # metres; posts and plinths move the middle of a plan by less


@dataclass(frozen=True)
class Wanted:
    """What the layout asks of the shells it describes, k of them.

    Attributes
    ----------
    row
        (k,) int64, object of the batch.
    top, lowest
        (k,) float64, metres: top of the highest part, lowest terrain at the walls.
    middle
        (k, 2) float64, middle of the plan, metres.
    """

    row: IntArray
    top: FloatArray
    lowest: FloatArray
    middle: FloatArray


def check_shells(city: City) -> list[Check]:
    """Run every check on shells against the layout; none where no building has a shell."""
    batch = city.scene.meshes.get("buildings")
    if batch is None or not batch.count or not len(city.layout.parts):
        return []
    wanted = wanted_of(city, batch)
    ids = batch.object_id[wanted.row]
    bottom, top = (values[wanted.row] for values in _reach(batch))
    off = np.abs(top - wanted.top)
    deep = wanted.lowest - bottom
    middle = plan_middle(batch, below=undersides_of(city, batch))
    away = np.hypot(*(middle[wanted.row] - wanted.middle).T)
    high, sunk, astray = off > TOP_ERROR, deep > PLINTH, away > PLACE_ERROR
    return [
        Check("building_height_off", float(high.sum()), 0,
              f"buildings whose top is over {TOP_ERROR:g} m from that of their layout",
              ids=named(ids[high])),
        Check("building_buried", float(sunk.sum()), 0,
              f"buildings whose foot is over {PLINTH:g} m below the lowest ground at their walls",
              ids=named(ids[sunk])),
        Check("building_displaced", float(astray.sum()), 0,
              f"buildings whose plan has its middle over {PLACE_ERROR:g} m from their layout's",
              ids=named(ids[astray])),
    ]  # fmt: skip


def _reach(batch: MeshBatch) -> tuple[FloatArray, FloatArray]:
    """Return the lowest and the highest vertex of every object, (n,) metres, NaN without any."""
    full = np.diff(batch.vertex_start) > 0
    low, high = np.full(batch.count, np.nan), np.full(batch.count, np.nan)
    starts = batch.vertex_start[:-1][full]
    if len(starts):
        low[full] = np.minimum.reduceat(batch.vertices[:, 2], starts)
        high[full] = np.maximum.reduceat(batch.vertices[:, 2], starts)
    return low, high


def on_plan(city: City) -> NDArray[np.bool_]:
    """(n,) which parts count to the plan of their building.

    All do, but of a mesh from another package those that stand on the ground: it need not close
    every slab by a floor of its own.
    """
    parts = city.layout.parts
    return np.asarray(~is_mesh(city.layout) | (parts["base"].to_numpy(float) < FOOT))


@dataclass(frozen=True)
class Undersides:
    """Level undersides that the layout asks of the shells: of every part, and beside passages.

    Attributes
    ----------
    building
        (m,) uint64.
    shapes
        (m,) polygons.
    area
        (m,) square metres that count to the plan of the building.
    """

    building: NDArray[np.uint64]
    shapes: NDArray[Any]
    area: FloatArray


def wanted_undersides(city: City) -> Undersides:
    """Return the undersides of parts; a house has two over each other beside a way through it."""
    parts = city.layout.parts
    shapes, owner = parts.geometry.to_numpy(), parts["building"].to_numpy(np.uint64)
    ways = open_ways(city.layout)
    rows = np.flatnonzero(~shapely.is_empty(ways))
    beside = shapely.difference(shapes[rows], ways[rows])
    area = np.concatenate([shapely.area(shapes) * on_plan(city), shapely.area(beside)])
    return Undersides(np.concatenate([owner, owner[rows]]), np.concatenate([shapes, beside]), area)


def undersides_of(city: City, batch: MeshBatch) -> FloatArray:
    """Return the height below which undersides count to a plan, (k,) metres; see `on_plan`."""
    owner = city.layout.parts["building"].to_numpy(np.uint64)
    outside = np.isin(batch.object_id, owner[is_mesh(city.layout)])
    return np.where(outside, _reach(batch)[0] + FOOT, np.inf)


def wanted_of(city: City, batch: MeshBatch) -> Wanted:
    """Return what the layout asks of the shells that it describes."""
    parts = city.layout.parts
    order = np.argsort(batch.object_id)
    own = parts["building"].to_numpy(np.uint64)
    place = np.minimum(np.searchsorted(batch.object_id[order], own), batch.count - 1)
    of_part = order[place]
    known = (batch.object_id[of_part] == own) & ~shapely.is_empty(parts.geometry.to_numpy())
    row, of_known = np.unique(of_part[known], return_inverse=True)
    top = np.full(len(row), -np.inf)
    level = ground_levels(city.layout, city.terrain) + parts["top"].to_numpy(float)
    np.maximum.at(top, of_known, level[known])
    lowest = np.full(len(row), np.inf)
    np.minimum.at(lowest, of_known, terrain_at_walls(city.layout, city.terrain)[0][known])
    under = wanted_undersides(city)
    at = np.searchsorted(batch.object_id[order], under.building).clip(max=batch.count - 1)
    held = batch.object_id[order[at]] == under.building
    held &= np.isin(order[at], row) & (under.area > 0)
    of = np.searchsorted(row, order[at[held]])
    area = under.area[held]
    spot = shapely.get_coordinates(shapely.centroid(under.shapes[held])) * area[:, None]
    total = np.maximum(np.bincount(of, area, minlength=len(row)), 1e-9)
    middle = [np.bincount(of, axis, minlength=len(row)) / total for axis in spot.T]
    return Wanted(row, top, lowest, np.column_stack(middle))


def check_meshes(city: City) -> list[Check]:
    """Count values that are not finite in meshes and instances."""
    arrays: list[NDArray[np.floating[Any]]] = [
        batch.vertices for batch in city.scene.meshes.values()
    ]
    arrays += [prototype.mesh.vertices for prototype in city.scene.prototypes]
    for rows in city.scene.instances.values():
        arrays += [rows.position, rows.rotation, rows.scale]
    bad = sum(int(np.count_nonzero(~np.isfinite(values))) for values in arrays)
    return [Check("not_finite", bad, 0, "coordinates that are NaN or infinite")]


def triangle_counts(city: City) -> dict[str, int]:
    """Return ``unique`` (stored) and ``instanced`` (as seen, every instance counted) triangles."""
    shells = sum(batch.triangle_count for batch in city.scene.meshes.values())
    sizes = np.array([p.mesh.triangle_count for p in city.scene.prototypes] or [0], np.int64)
    placed = sum(int(sizes[rows.prototype].sum()) for rows in city.scene.instances.values())
    return {"unique": int(shells + sizes.sum()), "instanced": int(shells + placed)}
