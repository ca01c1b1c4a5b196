"""Checks of trees: no trunk in a lane, a wall or before a door; crowns end before facades."""

from __future__ import annotations

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.checks.check import Check, named
from cityx.city import City
from cityx.city.mesh import NO_VERTEX
from cityx.city.scene import Instances, Prototype
from cityx.city.section import KIND
from cityx.geometry.clearance import distance_within, near_any, spots_of

DOOR_ROOM = 1.0  # metres kept free before a door
WALL_ROOM = 0.3  # metres from a wall to the middle of a trunk
TOUCH = 0.1  # metres a leaf may reach past a facade
TRUNKLESS = ("shrub", "boxwood", "grove")  # prototypes that a wall or a door need not fear
NEAR_HOUSE = 8.0  # metres within which crowns meet facades
SECTORS = 16  # in which the outline of a crown is measured
PLANTED = ("median", "verge", "walk")  # bands of a street on which trees may stand


def check_trees(city: City) -> list[Check]:
    """Run every check on trees; none where there are no trees."""
    rows = city.scene.instances.get("trees")
    if rows is None or not rows.count:
        return []
    used, number = np.unique(rows.prototype, return_inverse=True)
    prototypes = [city.scene.prototypes[index] for index in used.tolist()]
    stemmed = np.array([not p.name.startswith(TRUNKLESS) for p in prototypes])[number]
    reach = np.array([_reach(p) for p in prototypes])[number] * rows.scale[:, :2].max(axis=1)
    xy = rows.position[:, :2]
    houses = city.layout.buildings.geometry.to_numpy()
    facade = distance_within(xy, houses, NEAR_HOUSE)
    inside = (reach > facade + TOUCH) & stemmed
    inside = _into_houses(rows, np.flatnonzero(inside), prototypes, number, houses)
    total = max(int(stemmed.sum()), 1)
    walled = (facade < WALL_ROOM) & stemmed
    checks = [
        Check("trees_in_walls", float(walled.sum()), 0,
              f"trunks nearer than {WALL_ROOM:g} m to a wall", ids=named(rows.object_id[walled])),
        Check("crowns_in_facades", len(inside) / total, 0.02,
              "share of trees whose crown, by its 99th percentile, reaches into a facade"),
    ]  # fmt: skip
    doors = city.scene.instances.get("doors")
    if doors is not None and doors.count:
        spots = shapely.points(doors.position[:, :2])
        # Trees of the map stand where they are; it is the doors that nobody mapped.
        ours = stemmed & ~np.isin(rows.object_id, city.layout.points["id"].to_numpy())
        before = near_any(xy[ours], spots, DOOR_ROOM)
        checks.append(Check("trees_before_doors", int(before.sum()), 0,
                            f"trunks of ours nearer than {DOOR_ROOM:g} m to a door",
                            ids=named(rows.object_id[ours][before])))  # fmt: skip
    if city.lanes is not None and city.lanes.count:
        hit = _in_lanes(city, xy)
        checks.append(Check("trees_in_lanes", float(hit.sum()), 0, "trunks in a lane",
                            ids=named(rows.object_id[hit])))  # fmt: skip
    return checks


def _reach(prototype: Prototype) -> float:
    """Return the radius that holds 99 % of a plant's vertices, metres."""
    corners = _corners(prototype)
    return float(np.quantile(np.hypot(corners[:, 0], corners[:, 1]), 0.99))


def _corners(prototype: Prototype) -> NDArray[np.float64]:
    faces = prototype.mesh.faces
    return np.asarray(prototype.mesh.vertices[faces[faces != NO_VERTEX]], float)


def _into_houses(
    rows: Instances,
    near: NDArray[np.int64],
    prototypes: list[Prototype],
    number: NDArray[np.int64],
    houses: NDArray[np.object_],
) -> NDArray[np.int64]:
    """Return those of the rows `near` whose crown, not round, does reach into a house."""
    if not len(near):
        return near
    table = {k: _outline(prototypes[k]) for k in np.unique(number[near]).tolist()}
    outline = np.array([table[k] for k in number[near].tolist()])  # (n, k, 2)
    x, y = np.moveaxis(outline * rows.scale[near, None, :2], 2, 0)
    turn = rows.rotation[near, 2].astype(float)[:, None]
    spread = np.stack([np.cos(turn) * x - np.sin(turn) * y,
                       np.sin(turn) * x + np.cos(turn) * y], axis=2)  # fmt: skip
    crowns = shapely.polygons(rows.position[near, None, :2] + spread)
    walls = shapely.buffer(houses, -TOUCH, join_style="mitre")
    met = shapely.STRtree(walls).query(crowns, predicate="intersects")[0]
    return np.asarray(near[np.unique(met)])


def _outline(prototype: Prototype) -> NDArray[np.float64]:
    """(k, 2) outline of a plant seen from above, metres: what holds 99 % of each sector of it."""
    corners = _corners(prototype)
    far = np.hypot(corners[:, 0], corners[:, 1])
    turn = np.arctan2(corners[:, 1], corners[:, 0])
    sector = np.round(turn / (2 * np.pi / SECTORS)).astype(int) % SECTORS
    reach = [np.quantile(far[sector == k], 0.99) if (sector == k).any() else 0.0
             for k in range(SECTORS)]  # fmt: skip
    angle = np.arange(SECTORS) * (2 * np.pi / SECTORS)
    return np.asarray(np.array(reach)[:, None] * np.column_stack([np.cos(angle), np.sin(angle)]))


def _in_lanes(city: City, xy: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Return which of (n, 2) points lie on lanes, parking lanes and shoulders."""
    graph = city.lanes
    assert graph is not None
    planted = np.isin(graph.kind, [KIND[name] for name in PLANTED])
    rows = np.flatnonzero(~planted & (np.diff(graph.point_start) > 1))
    lines = np.array([shapely.LineString(graph.lane_points(row)) for row in rows.tolist()], object)
    half = 0.5 * (graph.left - graph.right)[rows]
    return near_any(spots_of(xy), lines, half)
