"""Checks of trees: no trunk in a lane, a wall or before a door; crowns end before facades."""

from __future__ import annotations

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.checks.check import Check, named
from cityx.city import City
from cityx.city.mesh import NO_VERTEX
from cityx.city.scene import Prototype
from cityx.city.section import KIND
from cityx.geometry.clearance import distance_within, near_any, spots_of

DOOR_ROOM = 1.0  # metres kept free before a door
WALL_ROOM = 0.3  # metres from a wall to the middle of a trunk
TOUCH = 0.1  # metres a leaf may reach past a facade
TRUNKLESS = ("shrub", "boxwood", "grove")  # prototypes that a wall or a door need not fear
NEAR_HOUSE = 8.0  # metres within which crowns meet facades
PLANTED = ("median", "verge", "walk")  # bands of a street on which trees may stand


def check_trees(city: City) -> list[Check]:
    """Run every check on trees; none where there are no trees."""
    rows = city.scene.instances.get("trees")
    if rows is None or not rows.count:
        return []
    used, number = np.unique(rows.prototype, return_inverse=True)
    prototypes = [city.scene.prototypes[index] for index in used.tolist()]
    stemmed = np.array([not p.name.startswith(TRUNKLESS) for p in prototypes])[number]
    reach = np.array([_reach(p) for p in prototypes])[number] * rows.scale[:, 0]
    xy = rows.position[:, :2]
    houses = city.layout.buildings.geometry.to_numpy()
    facade = distance_within(xy, houses, NEAR_HOUSE)
    inside = (reach > facade + TOUCH) & stemmed
    total = max(int(stemmed.sum()), 1)
    walled = (facade < WALL_ROOM) & stemmed
    checks = [
        Check("trees_in_walls", float(walled.sum()), 0,
              f"trunks nearer than {WALL_ROOM:g} m to a wall", ids=named(rows.object_id[walled])),
        Check("crowns_in_facades", np.count_nonzero(inside) / total, 0.02,
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
    faces = prototype.mesh.faces
    corners = prototype.mesh.vertices[faces[faces != NO_VERTEX]]
    return float(np.quantile(np.hypot(corners[:, 0], corners[:, 1]), 0.99))


def _in_lanes(city: City, xy: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Tell which of (n, 2) points lie on lanes, parking lanes and shoulders."""
    graph = city.lanes
    assert graph is not None
    planted = np.isin(graph.kind, [KIND[name] for name in PLANTED])
    rows = np.flatnonzero(~planted & (np.diff(graph.point_start) > 1))
    lines = np.array([shapely.LineString(graph.lane_points(row)) for row in rows.tolist()], object)
    half = 0.5 * (graph.left - graph.right)[rows]
    return near_any(spots_of(xy), lines, half)
