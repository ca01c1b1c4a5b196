"""Checks of facades: blind windows, doors at the sidewalk, neighbours that look alike."""

from __future__ import annotations

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.checks.check import Check, named
from cityx.city import City
from cityx.city.ground import KERB_HEIGHT
from cityx.city.layout import BARE, is_mesh
from cityx.city.levels import ground_levels
from cityx.city.scene import Instances
from cityx.ground.standing import stand_on
from cityx.ids import hash_ids

RAY = (0.08, 0.35)  # metres before a window between which nothing may stand
RAY_HEIGHT = 0.6  # metres above the lower edge of a window
SAMPLE = 20_000  # windows; more say nothing new
STREET_NEAR = 4.0  # metres between a building and a sidewalk that make it a street building
LEAST_HOUSE = 30.0  # square metres; smaller ones are sheds
LEAST_TALL = 2.6  # metres; lower ones are no houses
STEP = 0.2  # metres between a door and the pavement before it
THRESHOLD = 0.3  # metres that a building may float over or be buried in the ground at its door
DOOR_AT = 0.4  # metres before the wall where the pavement is measured
DOORLESS = 0.005  # of the houses at a sidewalk; towns and maps have none
DOOR_ROOM = 1.5  # metres of free wall that a door needs
NEIGHBOURS = 8
NEAR = 120.0  # metres; a house further away is no neighbour
COLOR_GRID = 0.03  # linear light; colours closer than that look alike


def check_facades(city: City) -> list[Check]:
    """Run every check on facades; none at levels of detail without them."""
    windows = city.scene.instances.get("windows")
    doors = city.scene.instances.get("doors")
    if windows is None or doors is None or "buildings" not in city.scene.meshes:
        return []
    checks = [_blind(city, windows), _doors(city, doors), _alike(city, windows)]
    return [*checks, _thresholds(city, doors)] if doors.count else checks


def outward_of(rows: Instances) -> NDArray[np.float64]:
    """Return the direction that things on walls face, (k, 2)."""
    yaw = rows.rotation[:, 2].astype(float)
    return np.column_stack([np.sin(yaw), -np.cos(yaw)])


def blind_windows(city: City, windows: Instances) -> NDArray[np.int64]:
    """Return the sampled windows before which something stands, by rays; rows of `windows`."""
    rows = np.arange(windows.count)
    if windows.count > SAMPLE:
        rows = np.sort(np.argsort(hash_ids(0, "check/window", windows.object_id))[:SAMPLE])
    at = windows.position[rows]
    out = outward_of(windows)[rows]
    rays = shapely.linestrings(np.stack([at[:, :2] + reach * out for reach in RAY], axis=1))
    parts = city.layout.parts
    shapes = np.where(parts["walls"].to_numpy(bool), parts.geometry.to_numpy(), shapely.Polygon())
    ground = ground_levels(city.layout, city.terrain)
    base = ground + parts["base"].to_numpy(float)
    eave = ground + parts["top"].to_numpy(float) - parts["roof_height"].to_numpy(float)
    ray, part = shapely.STRtree(shapes).query(rays, predicate="intersects")
    z = at[ray, 2] + RAY_HEIGHT * windows.scale[rows[ray], 2]
    hidden = (z > base[part]) & (z < eave[part])
    return np.asarray(rows[np.unique(ray[hidden])])


def _blind(city: City, windows: Instances) -> Check:
    blind = blind_windows(city, windows)
    return Check(
        "windows_on_blind_walls",
        float(len(blind)),
        0,
        f"windows, of up to {SAMPLE:,} sampled, that look at a wall less than {RAY[1]:g} m away",
        ids=named(windows.object_id[blind]),
    )


def street_buildings(city: City) -> NDArray[np.uint64]:
    """Return the ids of houses that stand at a sidewalk, (k,)."""
    if city.ground is None:
        return np.zeros(0, np.uint64)
    triangles = city.ground.triangles_of("sidewalk")
    if not len(triangles):
        return np.zeros(0, np.uint64)
    surface = shapely.STRtree(shapely.polygons(city.ground.vertices[triangles][..., :2]))
    parts = city.layout.parts
    house = parts["walls"].to_numpy(bool) & (parts["base"].to_numpy(float) < 0.5)
    house &= parts["zone"].to_numpy(str) != BARE  # a mesh from elsewhere that has no openings
    house &= shapely.area(parts.geometry.to_numpy()) > LEAST_HOUSE
    house &= (parts["top"] - parts["base"] - parts["roof_height"]).to_numpy(float) > LEAST_TALL
    shapes = parts.geometry.to_numpy()[house]
    near = surface.query(shapes, predicate="dwithin", distance=STREET_NEAR)[0]
    return np.asarray(np.unique(parts["building"].to_numpy(np.uint64)[house][near]))


def _doors(city: City, doors: Instances) -> Check:
    ids = street_buildings(city)
    at = doors.position[:, :2] + DOOR_AT * outward_of(doors)
    gap = np.abs(doors.position[:, 2] - city.terrain.height_at(at) - KERB_HEIGHT)
    served = np.isin(ids, doors.owner[gap <= STEP])
    open_ids = np.concatenate([ids[served], _reachable(city, ids[~served])])
    missing = 1.0 - served.sum() / len(open_ids) if len(open_ids) else 0.0
    return Check(
        "street_doors_missing",
        missing,
        DOORLESS,
        f"share of houses at a sidewalk without a door within {STEP:g} m of the pavement's height; "
        "those that neighbours enclose are left out",
        ids=named(open_ids[served.sum() :]),
    )


def _reachable(city: City, ids: NDArray[np.uint64]) -> NDArray[np.uint64]:
    """Return those of some houses that neighbours leave a piece of wall with room for a door."""
    parts = city.layout.parts
    owner = parts["building"].to_numpy(np.uint64)
    standing = parts["walls"].to_numpy(bool) & (parts["base"].to_numpy(float) < LEAST_TALL)
    shapes = np.where(standing, parts.geometry.to_numpy(), shapely.Polygon())
    tree = shapely.STRtree(shapes)
    found = []
    for number in ids.tolist():
        own = shapely.union_all(shapes[owner == number])
        near = tree.query(own, predicate="dwithin", distance=DOOR_AT)
        others = shapely.union_all(shapes[near[owner[near] != number]])
        free = shapely.difference(own.boundary, shapely.buffer(others, DOOR_AT))
        pieces = shapely.get_parts(shapely.line_merge(free))
        found.append(bool((shapely.length(pieces) > DOOR_ROOM).any()))
    return np.asarray(ids[np.array(found, bool)])


def threshold_gaps(city: City, doors: Instances) -> NDArray[np.float64]:
    """Return (k,) metres from the foot of each door to the ground before it, NaN without ground."""
    at = doors.position[:, :2] + DOOR_AT * outward_of(doors)
    under = stand_on(city.scene.meshes.get("ground"), at)
    return np.asarray(np.abs(doors.position[:, 2] - under.z))


def _thresholds(city: City, doors: Instances) -> Check:
    gap = np.nan_to_num(threshold_gaps(city, doors))
    return Check(
        "door_off_ground",
        float(gap.max()),
        THRESHOLD,
        "largest height of a door's foot over or under the ground before it, metres",
        ids=named(doors.owner[gap > THRESHOLD]),
    )


def _alike(city: City, windows: Instances) -> Check:
    return Check(
        "identical_neighbours",
        identical_share(city, windows),
        0.01,
        f"share of pairs of a house and its {NEIGHBOURS} nearest that share generator, storeys, "
        "size, roof, colours and windows",
    )


def identical_share(city: City, windows: Instances) -> float:
    """Return the share of pairs of neighbours that look the same."""
    from scipy.spatial import cKDTree

    middle, own = _looks(city, windows)
    if len(middle) < 2:
        return 0.0
    count = min(NEIGHBOURS + 1, len(middle))
    distance, other = cKDTree(middle).query(middle, k=count)
    same = (own[other[:, 1:]] == own[:, None]).all(axis=2)
    near = distance[:, 1:] < NEAR
    return float(same[near].mean()) if near.any() else 0.0


def repeated_share(city: City, windows: Instances, reach: float) -> float:
    """Return the share of houses that look like another one within `reach` metres."""
    from scipy.spatial import cKDTree

    middle, own = _looks(city, windows)
    if not len(middle):
        return 0.0
    pairs = cKDTree(middle).query_pairs(reach, output_type="ndarray")
    alike = pairs[(own[pairs[:, 0]] == own[pairs[:, 1]]).all(axis=1)]
    return len(np.unique(alike)) / len(middle)


def _looks(city: City, windows: Instances) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return (n, 2) middles of houses and (n, k) what tells how they look; sheds are left out."""
    buildings = city.layout.buildings
    ids = buildings["id"].to_numpy(np.uint64)
    shapes = buildings.geometry.to_numpy()
    large = shapely.area(shapes) > LEAST_HOUSE
    looks = np.column_stack([*_facts(city, ids), *_finish(city, ids), _window_of(windows, ids)])
    return shapely.get_coordinates(shapely.centroid(shapes[large])), looks[large]


def _facts(city: City, ids: NDArray[np.uint64]) -> list[NDArray[np.float64]]:
    """Return generator, storeys, size of footprint and roof of each building, as numbers."""
    buildings, parts = city.layout.buildings, city.layout.parts
    _, generator = np.unique(buildings["generator"].to_numpy(str), return_inverse=True)
    _, roof = np.unique(parts["roof_shape"].to_numpy(str), return_inverse=True)
    first = np.full(len(ids), -1.0)
    row = np.minimum(np.searchsorted(ids, parts["building"].to_numpy(np.uint64)), len(ids) - 1)
    first[row[::-1]] = roof[::-1]
    area = np.round(shapely.area(buildings.geometry.to_numpy()), -1)
    own = np.isin(ids, parts["building"].to_numpy(np.uint64)[is_mesh(city.layout)])
    tall = np.where(own, np.round(buildings["height"].to_numpy(float)), 0.0)  # as its mesh is
    return [generator.astype(float), buildings["levels"].to_numpy(float), area, first, tall]


def _finish(city: City, ids: NDArray[np.uint64]) -> list[NDArray[np.float64]]:
    """Return material and colour of the first and the last face of each building's mesh."""
    batch = city.scene.meshes["buildings"]
    row = np.minimum(np.searchsorted(batch.object_id, ids), max(batch.count - 1, 0))
    columns: list[NDArray[np.float64]] = []
    for face in (batch.face_start[:-1], batch.face_start[1:] - 1):
        columns.append(batch.material[face][row].astype(float))
        columns += list(np.round(batch.tint[face][row] / COLOR_GRID).astype(float).T)
    return columns


def _window_of(windows: Instances, ids: NDArray[np.uint64]) -> NDArray[np.float64]:
    """Return the prototype of the first window of each building and its width."""
    found = np.full(len(ids), -1.0)
    if windows.count:
        row = np.minimum(np.searchsorted(ids, windows.owner), len(ids) - 1)
        known = ids[row] == windows.owner
        width = np.round(windows.scale[:, 0].astype(float) * 20)
        value = windows.prototype // 4 * 1000 + width
        found[row[known][::-1]] = value[known][::-1]
    return found
