"""Checks of street furniture and trees: foot on the ground, nothing in a lane, a way past them.

Both are measured from what stands in the scene: the outlines of the prototypes as they are placed,
the lanes of the lane graph, and the faces of the ground.
"""

from __future__ import annotations

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.checks.check import Check, named
from cityx.city import City
from cityx.city.ground import LABEL, SURFACES
from cityx.city.mesh import NO_VERTEX
from cityx.city.scene import Instances, Prototype
from cityx.city.section import KIND
from cityx.city.thing_outlines import FURNITURE, placed_outlines
from cityx.geometry.arrays import FloatArray
from cityx.geometry.clearance import distance_within, near_any, spots_of
from cityx.ground.standing import earth_over, stand_on, surfaces_at
from cityx.ground.walking.passage import FREE, WITHIN, crowding, in_lanes

LET_PASS = 2  # pieces of which a small map has few
CROWDED = 0.05  # share of the things on walks that may leave less, as in corners of yards
# Layers of things whose origin is their foot; those on walls, rails and in water have another.
LAYERS = ("trees", "street_furniture", "street_pieces", "park_pieces", "vehicles")
BELOW = 2.5  # metres under the terrain from which a thing stands in a tunnel
OFF_GROUND = 0.3  # metres over or under the ground; a kerb between foot and origin is less
DOOR_ROOM = 1.0  # metres kept free before a door
WALL_ROOM = 0.3  # metres from a wall to the middle of a trunk
TOUCH = 0.1  # metres a leaf may reach past a facade
TRUNKLESS = ("shrub", "boxwood", "grove")  # prototypes that a wall or a door need not fear
NEAR_HOUSE = 8.0  # metres within which crowns meet facades
SECTORS = 16  # in which the outline of a crown is measured
PLANTED = ("median", "verge", "walk")  # bands of a street on which trees may stand


def check_furniture(city: City) -> list[Check]:
    """Run both checks; none where nothing stands."""
    outlines, xy, ids = placed_outlines(city.scene)
    if not len(outlines) or city.ground is None:
        return []
    rows, tight = crowding(city, outlines, xy)
    # What the map shows stands where the map has it.
    tight = tight[~np.isin(ids[rows], city.layout.points["id"].to_numpy())]
    crowded = max(int(tight.sum()) - LET_PASS, 0)
    hindering = in_lanes(city, outlines, xy, over=WITHIN)
    if hindering.any():
        hindering[hindering] = ~_in_tunnels(city, xy[hindering], ids[hindering])
    return [
        Check("furniture_in_lanes", float(hindering.sum()), 0,
              "pieces of furniture whose outline reaches into a lane or a carriageway",
              ids=named(ids[hindering])),
        Check("furniture_on_walkway", crowded / max(len(tight), 1), CROWDED,
              f"share of the pieces on walks that leave less than {FREE} m to pass, "
              f"{LET_PASS} let pass"),
    ]  # fmt: skip


def _in_tunnels(city: City, xy: FloatArray, ids: NDArray[np.uint64]) -> NDArray[np.bool_]:
    """(n,) whether things stand so deep below the terrain that no lane on it meets them."""
    height = dict.fromkeys(ids.tolist(), np.inf)
    for table in (city.scene.instances[name] for name in FURNITURE if name in city.scene.instances):
        own = np.isin(table.object_id, ids)
        height.update(zip(table.object_id[own].tolist(), table.position[own, 2], strict=True))
    z = np.array([height[number] for number in ids.tolist()])
    return np.asarray(z < city.terrain.height_at(xy) - BELOW)


def check_standing(city: City) -> list[Check]:
    """Run the check; none where nothing stands or there is no ground to stand on."""
    layers = [rows for name, rows in city.scene.instances.items() if name in LAYERS and rows.count]
    if not layers or "ground" not in city.scene.meshes:
        return []
    gap = ground_gaps(city, np.concatenate([rows.position for rows in layers]), OFF_GROUND)
    off = gap > OFF_GROUND
    ids = np.concatenate([rows.object_id for rows in layers])
    return [
        Check("things_off_ground", float(off.sum()), 0,
              f"trees, furniture and vehicles over {OFF_GROUND:g} m above or below any ground",
              ids=named(ids[off]))
    ]  # fmt: skip


def ground_gaps(city: City, positions: FloatArray, enough: float = 0.0) -> FloatArray:
    """Return (n,) metres from (n, 3) places to the ground, deck or earth at them, NaN over none.

    Where the ground is not further off than `enough`, nothing nearer is looked for.
    """
    meshes, (xy, z) = city.scene.meshes, (positions[:, :2], positions[:, 2])
    gap: FloatArray = np.abs(z - stand_on(meshes.get("ground"), xy).z)
    rows = np.flatnonzero(~(gap <= enough))
    left, xy, z = gap[rows], xy[rows], z[rows]
    np.fmin(left, np.abs(z - earth_over(meshes.get("structures"), xy)), out=left)
    spot, height = surfaces_at(meshes.get("decks"), xy)
    np.fmin.at(left, spot, np.abs(z[spot] - height))
    if city.heights is not None:  # tunnels have floors where nobody sees them
        np.fmin(left, np.abs(z - city.heights.z_at(xy)), out=left)
    if city.ground is not None:  # the mesh of the ground is open under houses
        floor = city.terrain.height_at(xy) + SURFACES[LABEL["building"]].offset
        indoors = city.ground.on(xy, "building") & ~np.isnan(left)
        left[indoors] = np.fmin(left, np.abs(z - floor))[indoors]
    gap[rows] = left
    return gap


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
