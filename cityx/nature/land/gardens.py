"""Garden paths from doors to the street, laid over the lawn.

They are slabs on the ground and no faces of it: a path needs the door, which facades place after
the ground is arranged, and a slab may end where a step or a plinth begins.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city import City, MeshBatch
from cityx.city.ground import LABEL
from cityx.city.mesh import NO_VERTEX
from cityx.geometry.arrays import FloatArray
from cityx.geometry.polylines import Polylines, pack
from cityx.ground.pieces import front, heights, room_along, walk_rims
from cityx.ground.standing import WALKED, stand_on
from cityx.ids import hash_ids, uniform
from cityx.nature.land.lawn_edges import LAYER as EDGING
from cityx.nature.land.lawn_edges import lawn_edges
from cityx.protocol import Port, action

ACTION = "nature/gardens-v1"
LAYER = "garden_paths"
SOFT = ("block", "grass", "park", "meadow", "bare")
PAVED = (
    *WALKED,
    "carriageway",
    "setts",
    "gutter",
    "parking_lane",
    "mouth_setts",
    "gravel_road",
    "parking",
    "junction",
)
REACH = 28.0  # metres a path is long at most
LEAST = 1.0  # metres; a door nearer to the pavement needs none
SIDES = 5  # directions that are tried, the door's own first
SPREAD = 0.5  # radians between them
# Half widths in metres by what lies at the door.
DOOR_HALF, GARAGE_HALF = 0.6, 1.35
STEP = 1.0  # metres between the slabs' joints, at which a path follows the ground
OVER = 0.015  # metres above the lawn
LEVEL = 1.5  # metres between the foot of a door and the garden before it
DRIVES = ("door_garage", "door_carriage", "door_roller")
KINDS = (("paving", (0.95, 0.93, 0.90), 5.0), ("gravel", (1.0, 0.97, 0.92), 2.0),
         ("brick", (0.62, 0.36, 0.28), 1.5), ("asphalt_light", (1.0, 1.0, 1.0), 1.0))  # fmt: skip


def _clear(starts: FloatArray, ends: FloatArray, houses: NDArray[np.object_]) -> NDArray[np.bool_]:
    """(n,) whether straight ways of a path's width pass no house."""
    lines = shapely.linestrings(np.stack([starts, ends], axis=1))
    blocked = np.zeros(len(lines), bool)
    if len(houses):
        blocked[shapely.STRtree(houses).query(lines, predicate="dwithin", distance=0.3)[0]] = True
    return np.asarray(~blocked)


def _strips(
    city: City, lines: Polylines, half: FloatArray, chosen: NDArray[np.int64],
    ids: NDArray[np.uint64],
) -> MeshBatch:  # fmt: skip
    """Lay slabs along straight lines, an object each; ``half`` to ``ids`` are (n,) per line."""
    owner = lines.line_of_point()
    first = lines.points[lines.start[:-1]]
    way = lines.points[lines.start[1:] - 1] - first
    way /= np.maximum(np.hypot(*way.T), 1e-9)[:, None]
    left = np.column_stack([-way[:, 1], way[:, 0]])[owner] * half[owner][:, None]
    sides = np.stack([lines.points + left, lines.points - left], axis=1).reshape(-1, 2)
    vertices = np.column_stack([sides, heights(city, sides) + OVER])
    segment = np.flatnonzero(owner[1:] == owner[:-1])
    here = 2 * segment[:, None, None]
    corners = np.array([[0, 1, 3], [0, 3, 2]])  # of the two triangles of a slab
    faces = (here + corners).reshape(-1, 3)
    kind = np.repeat(chosen[owner[segment]], 2)
    uv = np.zeros((len(faces), 4, 2), np.float32)
    uv[:, :3] = vertices[faces][:, :, :2]
    tint = np.array([color for _, color, _ in KINDS])[kind]
    table = np.column_stack([faces, np.full(len(faces), NO_VERTEX)]).astype(np.int32)
    starts = 2 * (lines.start - np.arange(len(lines.start)))  # each line has a segment less
    batch = MeshBatch(
        ids, 2 * lines.start, starts, vertices, table, kind.astype(np.int16),
        tuple(name for name, _, _ in KINDS), uv, tint.astype(np.float32),
    )  # fmt: skip
    return batch.take(np.argsort(ids, kind="stable"))


def _with_paths(city: City) -> tuple[City, NDArray[np.object_]]:
    """Return the city with paths and drives, and their outlines."""
    doors, ground = city.scene.instances.get("doors"), city.ground
    mesh = city.scene.meshes.get("ground")
    none = np.zeros(0, object)
    if doors is None or not doors.count or ground is None or mesh is None:
        return city, none
    out = front(doors.rotation[:, 2])
    foot = doors.position[:, :2] + 0.12 * out
    before = stand_on(mesh, foot + 0.5 * out)
    soft = np.isin(before.label, [LABEL[name] for name in SOFT])
    soft &= np.abs(np.nan_to_num(before.z, nan=1e9) - doors.position[:, 2]) < LEVEL
    rows = np.flatnonzero(soft)
    if not len(rows):
        return city, none
    rims = walk_rims(ground, PAVED)
    houses = city.layout.buildings.geometry.to_numpy()
    best, end = np.full(len(rows), np.inf), np.zeros((len(rows), 2))
    for number in range(SIDES):
        turn = SPREAD * ((number + 1) // 2) * (-1.0) ** number
        c, s = np.cos(turn), np.sin(turn)
        way = out[rows] @ np.array([[c, s], [-s, c]])
        start = foot[rows] + 0.2 * out[rows]
        room = room_along(start, way, rims, REACH)
        # A little beyond, so that the slab ends under the paving's edge.
        far = start + (room + 0.05)[:, None] * way
        cost = room * (1.0 + 0.6 * abs(turn))
        good = (room < REACH) & (cost < best) & _clear(start, far, houses)
        # Water and tracks are rims of nothing one could arrive at.
        arrives = stand_on(mesh, start + (room + 0.3)[:, None] * way).label
        good &= np.isin(arrives, [LABEL[name] for name in PAVED])
        best, end = np.where(good, cost, best), np.where(good[:, None], far, end)
    keep = np.isfinite(best) & (best > LEAST)
    rows, end = rows[keep], end[keep]
    if not len(rows):
        return city, none
    names = np.array([p.name.removesuffix("_fine") for p in city.scene.prototypes], object)
    drive = np.isin(names[doors.prototype[rows]], DRIVES)
    half = np.where(drive, GARAGE_HALF, DOOR_HALF)
    # All paths of a house are laid with one material.
    share = np.cumsum([weight for _, _, weight in KINDS])
    draw = uniform(city.seed, f"{ACTION}/kind", doors.owner[rows]) * share[-1]
    chosen = np.searchsorted(share, draw, side="right")
    shapes = shapely.segmentize(shapely.linestrings(np.stack([foot[rows], end], axis=1)), STEP)
    ids = hash_ids(0, ACTION, doors.object_id[rows])
    batch = _strips(city, pack(shapes), half, chosen, ids)
    ways = shapely.buffer(shapes, half + 0.02, cap_style="square")
    return replace(city, scene=city.scene.with_mesh(LAYER, batch)), ways


@action(
    ACTION,
    limits=["Paths are straight; a house that hides the street from its door has none."],
    requires=("layout",),
    after=("building/facade-v1",),
    takes=(Port("ground", "surface", role="ground", optional=True),),
    gives=(Port("paths", "complex_geometry", "garden_paths"),),
    labels=("garden paths", "driveways", "front gardens"),
)
def gardens(city: City) -> City:
    """Lay paths from doors across lawns to the pavement, drives to garages, and stones round lawns.

    Parameters
    ----------
    city
        City with its ground; facades tell where doors are.
    """
    city = replace(city, stages_done=city.stages_done | {"nature"})
    if city.lod < 2 or city.ground is None or "ground" not in city.scene.meshes:
        return city
    city, ways = _with_paths(city)
    stones = lawn_edges(city, ways)
    return city if stones is None else replace(city, scene=city.scene.with_mesh(EDGING, stones))
