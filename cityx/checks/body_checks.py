"""Check of bodies: what can be pushed about stands free of walls and of other things."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.assets.colliders import collider_of, motion_of
from cityx.assets.vehicles.car_parts import PART
from cityx.checks.check import Check, named
from cityx.city import City
from cityx.city.bodies import Colliders, colliders_of
from cityx.city.levels import ground_levels
from cityx.city.scene import Instances, Prototype
from cityx.city.thing_outlines import placed_rings
from cityx.geometry.arrays import FloatArray

LAYERS = ("street_furniture", "street_pieces", "park_pieces", "vehicles")
DEEP = 0.05  # metres that one thing may reach into another: bumpers touch, bins lean on walls
OVER = 0.01  # metres of height that two share who are beside, not on top of each other
LEAVES = ("parasol", "reeds", "flower_bed", "hedge_segment")  # what yields to a thing beside it
SHARE = 0.02  # of what can be pushed about: plots of maps are drawn roughly
ROOM, AROUND = 0.15, 0.02  # metres, and share of a thing, by which a collider may exceed its mesh
LET_PASS = 2  # things, of which a small map has few


@dataclass(frozen=True)
class Outlines:
    """Plans of the parts of colliders, p of them.

    Attributes
    ----------
    shape
        (p,) polygons, drawn in by half of `DEEP`; empty for what is thinner.
    low, high
        (p,) float64, metres.
    object_id
        (p,) uint64.
    movable
        (p,) bool.
    """

    shape: NDArray[Any]
    low: FloatArray
    high: FloatArray
    object_id: NDArray[np.uint64]
    movable: NDArray[np.bool_]


def check_bodies(city: City) -> list[Check]:
    """Run the check; none where nothing can be pushed about."""
    boxes = _boxes(city)
    movable = np.unique(boxes.object_id[boxes.movable])
    if not len(movable):
        return []
    doubtful = np.union1d(_in_each_other(boxes), _in_buildings(city, boxes))
    parts = outlines_of(city, _beside(boxes, doubtful))
    caught = np.union1d(_in_each_other(parts), _in_buildings(city, parts))
    # What the map shows stands where the map has it.
    caught = np.setdiff1d(caught, city.layout.points["id"].to_numpy(np.uint64))
    beyond = max(len(caught) - LET_PASS, 0)
    return [
        Check("bodies_interpenetrating", beyond / len(movable), SHARE,
              f"share of the things that can be pushed about which reach over {DEEP:g} m into a "
              f"wall or another thing, {LET_PASS} let pass", ids=named(caught))
    ]  # fmt: skip


def outlines_of(city: City, among: NDArray[np.uint64] | None = None) -> Outlines:
    """Return the plans of what stands outdoors by itself, of some ids or of all."""
    prototypes = city.scene.prototypes
    found = []
    for number, rows, of in _standing(city, among):
        collider = colliders_of([tuple(collider_of(prototypes[number]))])
        found.append(_placed(collider, rows, of, motion_of(prototypes[number]) == "free"))
    return _joined(found)


def _standing(
    city: City, among: NDArray[np.uint64] | None = None
) -> Iterator[tuple[int, Instances, NDArray[np.int64]]]:
    """Yield prototypes of what stands outdoors by itself, their layers, and rows of these."""
    scene = city.scene
    for rows in (rows for name, rows in scene.instances.items() if name in LAYERS):
        wanted = np.ones(rows.count, bool) if among is None else np.isin(rows.object_id, among)
        for number in np.unique(rows.prototype[wanted]).tolist():
            one = scene.prototypes[number]
            if one.kind != PART and len(one.mesh.vertices) and not one.name.startswith(LEAVES):
                yield number, rows, np.flatnonzero(wanted & (rows.prototype == number))


def _joined(found: Sequence[Outlines]) -> Outlines:
    empty = Outlines(
        np.zeros(0, object), np.zeros(0), np.zeros(0), np.zeros(0, np.uint64), np.zeros(0, bool)
    )
    columns = zip(*(vars(table).values() for table in [empty, *found]), strict=True)
    return Outlines(*(np.concatenate(column) for column in columns))


def _placed(
    shapes: Colliders, rows: Instances, of: NDArray[np.int64], movable: bool
) -> Outlines:  # fmt: skip
    """Return the plans of a collider at some rows of a layer, upright ones turned by yaw."""
    size = rows.scale[of].astype(float)
    polygons, low, high = [], [], []
    for part in range(len(shapes.form)):
        corners = shapes.corners(part)
        ring = shapely.get_coordinates(shapely.convex_hull(shapely.multipoints(corners[:, :2])))
        turned = placed_rings(ring, rows.position[of, :2], rows.rotation[of, 2], size)
        polygons.append(shapely.buffer(shapely.polygons(turned), -DEEP / 2))
        low.append(rows.position[of, 2] + corners[:, 2].min() * size[:, 2])
        high.append(rows.position[of, 2] + corners[:, 2].max() * size[:, 2])
    count = len(shapes.form)
    return Outlines(
        np.concatenate(polygons),
        np.concatenate(low),
        np.concatenate(high),
        np.tile(rows.object_id[of], count),
        np.full(len(of) * count, movable),
    )


def _boxes(city: City) -> Outlines:
    """Return boxes that hold the colliders of what stands outdoors by itself, one each."""
    found = []
    for number, rows, of in _standing(city):
        one = city.scene.prototypes[number]
        ring, low, high = box_of(one)
        size = rows.scale[of].astype(float)
        placed = placed_rings(ring, rows.position[of, :2], rows.rotation[of, 2], size)
        z, deep = rows.position[of, 2], size[:, 2]
        found.append(
            Outlines(shapely.polygons(placed), z + low * deep, z + high * deep,
                     rows.object_id[of], np.full(len(of), motion_of(one) == "free"))
        )  # fmt: skip
    return _joined(found)


def box_of(one: Prototype) -> tuple[FloatArray, float, float]:
    """Return a box that holds the collider of a prototype: (4, 2) corners, lowest and highest z."""
    low, high = one.mesh.vertices.min(axis=0), one.mesh.vertices.max(axis=0)
    more = ROOM + AROUND * (high - low)
    (a, b, _), (c, d, _) = low - more, high + more
    ring = np.array([(a, b), (c, b), (c, d), (a, d)])
    return ring, min(low[2], 0.0) - more[2], max(high[2], 0.0) + more[2]


def _beside(boxes: Outlines, ids: NDArray[np.uint64]) -> NDArray[np.uint64]:
    """Return some ids with those of all things whose boxes meet theirs."""
    own = boxes.shape[np.isin(boxes.object_id, ids)]
    near = shapely.STRtree(boxes.shape).query(own, predicate="intersects")[1]
    return np.asarray(np.union1d(ids, boxes.object_id[near]))


def _in_each_other(parts: Outlines) -> NDArray[np.uint64]:
    """Return the ids of movable things that reach into another."""
    tree = shapely.STRtree(parts.shape)
    one, other = tree.query(parts.shape[parts.movable], predicate="intersects")
    one = np.flatnonzero(parts.movable)[one]
    high = np.minimum(parts.high[one], parts.high[other])
    deep = high - np.maximum(parts.low[one], parts.low[other]) > OVER
    apart = parts.object_id[one] != parts.object_id[other]
    return np.asarray(np.unique(parts.object_id[one[deep & apart]]))


def _in_buildings(city: City, parts: Outlines) -> NDArray[np.uint64]:
    """Return the ids of movable things that reach into a building with walls."""
    table = city.layout.parts
    level = ground_levels(city.layout, city.terrain)
    walled = table["walls"].to_numpy(bool)
    movable = np.flatnonzero(parts.movable)
    shapes = table.geometry.to_numpy()[walled]
    low = (level + table["base"].to_numpy(float))[walled]
    low = np.where(table["base"].to_numpy(float)[walled] > 0, low, -np.inf)
    high = (level + table["top"].to_numpy(float))[walled]
    row, part = shapely.STRtree(shapes).query(parts.shape[movable], predicate="intersects")
    row = movable[row]
    deep = np.minimum(parts.high[row], high[part]) - np.maximum(parts.low[row], low[part]) > OVER
    return np.asarray(np.unique(parts.object_id[row[deep]]))
