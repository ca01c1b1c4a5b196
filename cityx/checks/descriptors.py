"""Descriptors: what a building looks like, as numbers: silhouette, facade, roof and colour.

They read the built scene alone, not the names of styles or of prototypes, so they measure what a
viewer could measure in pictures.
"""

from __future__ import annotations

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.assets.styles.materials import MATERIALS
from cityx.city import City
from cityx.city.mesh import NO_VERTEX
from cityx.city.scene import Instances
from cityx.geometry.arrays import FloatArray

LEVELS = (0.1, 0.3, 0.5, 0.7, 0.9)  # shares of the height at which the plan is measured
STEEP, LEVEL = 0.15, 0.98  # upward component of the normals of walls and of level roofs
RIDGE = 0.05  # added to the shared covariance of standardised descriptors
LAYERS = ("windows", "doors", "shopfronts", "trims", "roof_furniture")


def descriptors(city: City) -> tuple[NDArray[np.uint64], FloatArray]:
    """Describe every building of a built city.

    Returns
    -------
    ids, table
        (k,) ids and (k, d) numbers of comparable size.
    """
    batch = city.scene.meshes["buildings"]
    ids = batch.object_id
    columns = [*_silhouette(city, ids), *_surfaces(city)]
    wall = np.maximum(columns[-1], 1.0)  # square metres of walls, the last of the surfaces
    height = np.exp(columns[0])
    for layer in LAYERS:
        rows = city.scene.instances.get(layer)
        columns += _things(city, rows, ids, wall, height)
    return ids, np.column_stack(columns)


def _silhouette(city: City, ids: NDArray[np.uint64]) -> list[FloatArray]:
    parts = city.layout.parts
    row = np.searchsorted(ids, parts["building"].to_numpy(np.uint64))
    plan = parts.geometry.to_numpy()
    area = shapely.area(plan)
    base, top = parts["base"].to_numpy(float), parts["top"].to_numpy(float)
    count = len(ids)
    height = np.zeros(count)
    np.maximum.at(height, row, top)
    grounded = np.where(base < 0.5, area, 0.0)
    footprint = np.maximum(np.bincount(row, grounded, minlength=count), 1.0)
    hull = shapely.oriented_envelope(_union(plan, row, count))
    corner = shapely.get_coordinates(hull).reshape(-1, 5, 2)
    side = np.linalg.norm(np.diff(corner[:, :3], axis=1), axis=2)
    long, short = side.max(axis=1), side.min(axis=1)
    found = [
        np.log(height), np.log(footprint), np.log(long / short), np.log(height / short),
        footprint / (long * short), np.log(np.bincount(row, minlength=count)),
    ]  # fmt: skip
    for level in LEVELS:
        z = level * height[row]
        there = np.where((base <= z) & (top > z), area, 0.0)
        found.append(np.bincount(row, there, minlength=count) / footprint)
    rise = parts["roof_height"].to_numpy(float)
    found.append(np.bincount(row, rise * area, minlength=count) / (footprint * height))
    return found


def _union(plan: NDArray[np.object_], row: NDArray[np.int64], count: int) -> NDArray[np.object_]:
    points, of = shapely.get_coordinates(plan, return_index=True)
    order = np.argsort(row[of], kind="stable")
    return np.asarray(
        shapely.multipoints(points[order], indices=row[of][order], out=np.empty(count, object))
    )


def _surfaces(city: City) -> list[FloatArray]:
    """Return shares of materials, mean colours and slopes of walls and roofs of each building."""
    batch = city.scene.meshes["buildings"]
    corner = batch.vertices[np.where(batch.faces == NO_VERTEX, batch.faces[:, :1], batch.faces)]
    normal = np.cross(corner[:, 2] - corner[:, 0], corner[:, 3] - corner[:, 1])
    triangle = batch.faces[:, 3] == NO_VERTEX
    flat = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
    normal = np.where(triangle[:, None], flat, normal)
    size = np.linalg.norm(normal, axis=1)
    up = normal[:, 2] / np.maximum(size, 1e-12)
    area = size / 2
    owner = np.repeat(np.arange(batch.count), np.diff(batch.face_start))

    def total(weight: FloatArray) -> FloatArray:
        return np.bincount(owner, weight, minlength=batch.count).astype(float)

    base = np.array([MATERIALS[name].color for name in batch.materials])
    color = batch.tint * base[batch.material]
    walls, roofs = np.abs(up) < STEEP, up >= STEEP
    number = {name: row for row, name in enumerate(batch.materials)}
    found: list[FloatArray] = []
    for kind in (walls, roofs):
        weight = np.where(kind, area, 0.0)
        whole = np.maximum(total(weight), 1e-6)
        mean = [total(weight * channel) / whole for channel in color.T]
        bright = sum(mean)
        found += [np.sqrt(bright), mean[0] / bright, mean[2] / bright]
        found += [
            total(weight * (batch.material == number.get(name, -1))) / whole
            for name in sorted(MATERIALS)
        ]
    pitched = np.where(roofs & (up < LEVEL), area, 0.0)
    found.append(total(pitched) / np.maximum(total(np.where(roofs, area, 0.0)), 1e-6))
    found.append(total(pitched * up) / np.maximum(total(pitched), 1e-6))
    found.append(total(np.where(walls, area, 0.0)))
    return found


def _things(
    city: City,
    rows: Instances | None,
    ids: NDArray[np.uint64],
    wall: FloatArray,
    height: FloatArray,
) -> list[FloatArray]:
    """Return number, size, spread and colour of the things of one layer on each building."""
    count = len(ids)
    if rows is None or not rows.count:
        return [np.zeros(count)] * 9
    row = np.minimum(np.searchsorted(ids, rows.owner), count - 1)
    extents = np.array([_extent(p.mesh.vertices) for p in city.scene.prototypes])
    size = extents[rows.prototype] * rows.scale
    number = np.bincount(row, minlength=count)
    some = np.maximum(number, 1)

    def mean(values: FloatArray) -> FloatArray:
        return np.asarray(np.bincount(row, values, minlength=count) / some)

    wide, deep, tall = np.log1p(size).T
    level = rows.position[:, 2]
    spread = mean(level**2) - mean(level) ** 2
    face = np.bincount(row, size[:, 0] * size[:, 2], minlength=count) / wall
    return [
        np.log1p(number), np.log1p(100 * number / wall), mean(wide), mean(deep), mean(tall),
        mean(wide / np.maximum(tall, 0.05)), face, mean(level) / height,
        np.sqrt(np.maximum(spread, 0.0)) / height,
    ]  # fmt: skip


def _extent(vertices: FloatArray) -> FloatArray:
    return np.asarray(np.ptp(vertices, axis=0)) if len(vertices) else np.zeros(3)


def classified(table: FloatArray, label: NDArray[np.int64], test: FloatArray) -> NDArray[np.int64]:
    """Classify by linear discriminants: one Gaussian per kind, one shared covariance.

    Parameters
    ----------
    table, label
        (n, d) descriptors to learn from, and (n,) their kinds, 0 to k - 1.
    test
        (m, d) descriptors.

    Returns
    -------
    label
        (m,) kind of each row of `test`.
    """
    middle, spread = table.mean(axis=0), table.std(axis=0) + 1e-6
    table, test = (table - middle) / spread, (test - middle) / spread
    means = np.array([table[label == kind].mean(axis=0) for kind in range(label.max() + 1)])
    rest = table - means[label]
    inverse = np.linalg.inv(rest.T @ rest / len(rest) + RIDGE * np.eye(table.shape[1]))
    score = test @ inverse @ means.T - 0.5 * np.einsum("ij,jk,ik->i", means, inverse, means)
    return np.asarray(score.argmax(axis=1))
