"""Volumes of buildings whose mesh another package makes: their parts are read from the mesh.

A part of the zone `MESH` is a slab of such a mesh. It says where walls are upright and how high, so
that windows hang on them and checks know what stands there; the shell is the mesh itself.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.assets.styles.materials import MATERIALS
from cityx.building.catalogue import generators
from cityx.building.massing.massing import Mass
from cityx.city.layout import BARE, MESH, Layout, is_mesh
from cityx.city.mesh import NO_VERTEX, MeshBatch, concatenate
from cityx.city.mesh_measures import check_closed, volume
from cityx.errors import nearest
from cityx.geometry.mesh_sections import slabs_of
from cityx.geometry.solids import area_vectors
from cityx.ids import uniform
from cityx.protocol.actions import WHICH
from cityx.protocol.isolation import is_inside, meshes_apart
from cityx.protocol.layer_mapping import Made, footprints, meshes_of
from cityx.protocol.values import Footprint

if TYPE_CHECKING:
    from cityx.assets.styles.generators import Generator
    from cityx.assets.styles.palettes import Finishes

ORDER = "cityx:mesh"  # tag of a building that holds the arguments its mesh was made with
OUTSIDE = 0.5  # metres that a mesh may reach over its footprint, as eaves do
SPILL = 0.1  # square metres beyond that
ON_GROUND = 0.05  # metres from z = 0 within which a mesh must begin
DARKEST = 0.8  # of the lightness of a mesh's colours
ROOF = 0.5  # vertical part of a normal from which a face is a roof
HIGHEST = 1000.0  # metres
STOREY = 2.2  # metres, the least
KEPT = 20_000  # meshes remembered of one process
_MADE: dict[Any, Made] = {}


@dataclass(frozen=True)
class Order:
    """What a generator was asked for: its arguments, and what its footprint says of the size."""

    args: Mapping[str, Any]
    height: float
    levels: int

    def text(self) -> str:
        """Return it as the text of a tag."""
        said = {"args": dict(self.args), "tall": round(self.height, 3), "floors": self.levels}
        return json.dumps(said, sort_keys=True)


def order_of(tags: str) -> Order | None:
    """Return the order in the tags of a building, None where there is none."""
    if ORDER not in tags:
        return None
    said = json.loads(json.loads(tags)[ORDER])
    return Order(said["args"], float(said["tall"]), int(said["floors"]))


def with_order(tags: str, order: Order | None, *, height: bool = True) -> str:
    """Return tags with another order, or without one.

    Parameters
    ----------
    height
        Whether a height that is said stays.
    """
    own = json.loads(tags or "{}")
    own.pop(ORDER, None)
    if not height:
        own.pop("height", None)
    if order is not None:
        own[ORDER] = order.text()
    return json.dumps(own, sort_keys=True)


def made_meshes(
    kind: Generator, layout: Layout, rows: Iterable[int], orders: list[Order], seed: int,
    *, apart: bool = True,
) -> list[Made]:  # fmt: skip
    """Return the meshes of buildings, or why there is none, as their generator makes them.

    What a generator makes of a footprint is remembered for the process. Other packages run in a
    process of their own; see `cityx.protocol.isolation`.

    Parameters
    ----------
    kind
        A generator with a mesh.
    rows, orders
        Rows of the buildings, and what is asked of each.
    """
    assert kind.outside is not None
    record, function = kind.outside.record, kind.outside.function
    outlines = [
        replace(outline, height=order.height, levels=order.levels)
        for outline, order in zip(footprints(layout, list(rows)), orders, strict=True)
    ]
    keys = [_key(record.id, one, order, seed) for one, order in zip(outlines, orders, strict=True)]
    groups: dict[str, list[int]] = {}
    for at, (key, order) in enumerate(zip(keys, orders, strict=True)):
        if key not in _MADE:
            groups.setdefault(json.dumps(dict(order.args), sort_keys=True), []).append(at)
    fresh: dict[Any, Made] = {}
    for text, places in groups.items():
        some = [outlines[at] for at in places]
        args = record.arguments(json.loads(text))
        args = {name: value for name, value in args.items() if name not in WHICH}
        if apart and kind.outside.package and not is_inside():
            made = meshes_apart(record, some, args, seed, package=kind.outside.package)
        else:
            made = meshes_of(record, function, some, args, seed)
        for at, outline, one in zip(places, some, made, strict=True):
            fault = one if isinstance(one, str) else mesh_fault(one, outline)
            fresh[keys[at]] = fault or one
    found = [fresh[key] if key in fresh else _MADE[key] for key in keys]
    if len(_MADE) + len(fresh) > KEPT:
        _MADE.clear()
    _MADE.update(fresh)
    return found


def _key(action: str, outline: Footprint, order: Order, seed: int) -> Any:
    rings = tuple(ring.tobytes() for ring in (outline.ring, *outline.holes))
    return action, order.text(), seed, outline.object_id, rings


def mesh_fault(mesh: MeshBatch, outline: Footprint) -> str:
    """Return why a mesh is no building on its footprint, "" where it is one."""
    unknown = [name for name in mesh.materials if name not in MATERIALS]
    if unknown:
        return f'there is no material "{unknown[0]}".{nearest(unknown[0], MATERIALS)}'
    low, high = float(mesh.vertices[:, 2].min()), float(mesh.vertices[:, 2].max())
    if abs(low) > ON_GROUND:
        return f"its lowest point is at z = {low:.2f} m; a building stands on z = 0"
    if high > HIGHEST:
        return f"it is {high:.0f} m high, more than {HIGHEST:.0f} m"
    if not check_closed(mesh).all():
        return "its mesh is not closed: every edge must be shared by two faces that run against it"
    if volume(mesh)[0] <= 0:
        return "its faces look inwards: their corners must run counter-clockwise from outside"
    covers = shapely.union_all([slab.plan for slab in slabs_of(mesh.vertices, mesh.faces)])
    left = shapely.difference(covers, shapely.buffer(outline.polygon, OUTSIDE)).area
    if left > SPILL:
        return (
            f"it covers {left:.1f} m2 beyond its footprint; an overhang of {OUTSIDE:g} m is allowed"
        )
    return ""


def masses_of(mesh: MeshBatch, kind: Generator) -> list[Mass]:
    """Return the volumes of a mesh, from the ground up."""
    zone = BARE if kind.outside is not None and kind.outside.traits.bare else MESH
    return [
        Mass(slab.plan, 0.0 if slab.low < ON_GROUND else slab.low, slab.high, zone,
             "pyramidal" if slab.rise else "flat", slab.rise)
        for slab in slabs_of(mesh.vertices, mesh.faces)
    ]  # fmt: skip


def ordered(layout: Layout, rows: Iterable[int], args: Mapping[str, Any]) -> list[Order]:
    """Return what is asked of buildings: the arguments, and what the layout says of their size."""
    at = list(rows)
    height = layout.buildings["height"].to_numpy(float)[at]
    levels = layout.buildings["levels"].to_numpy(int)[at]
    return [Order(args, h, n) for h, n in zip(height.tolist(), levels.tolist(), strict=True)]


def mesh_shells(
    layout: Layout, seed: int, finishes: Finishes,
    ground: NDArray[np.float64], low: NDArray[np.float64],
) -> tuple[list[MeshBatch], dict[int, str]]:  # fmt: skip
    """Make the shells of the buildings whose parts are slabs of a mesh.

    Materials and colours are the mesh's own but where the layout says others; a building is up to a
    fifth darker than another, as no two are of one pot of paint.

    Parameters
    ----------
    finishes
        Of every part.
    ground, low
        (n,) metres, of every part: the level that its heights count from, and the foot of a shell.

    Returns
    -------
    shells, lost
        One object each, and why there is none, by the id of the building.
    """
    parts, buildings = layout.parts, layout.buildings
    mine = np.flatnonzero(is_mesh(layout))
    owner = parts["building"].to_numpy(np.uint64)[mine]
    ids = buildings["id"].to_numpy(np.uint64)
    rows = np.flatnonzero(np.isin(ids, owner))
    names = buildings["generator"].to_numpy(str)[rows]
    tags = buildings["tags"].to_numpy(str)[rows]
    shells: list[MeshBatch] = []
    lost: dict[int, str] = {}
    for name in sorted(set(names.tolist())):
        kind = generators().get(name)
        of = [int(row) for row, own in zip(rows, names, strict=True) if own == name]
        if kind is None or kind.outside is None:
            why = f'the package of its generator "{name}" is not installed'
            lost |= {int(ids[row]): why for row in of}
            continue
        said = [order_of(text) for text, own in zip(tags, names, strict=True) if own == name]
        orders = [order or Order({}, 0.0, 0) for order in said]
        made = made_meshes(kind, layout, of, orders, seed)
        for row, one in zip(of, made, strict=True):
            own = mine[owner == ids[row]]
            if isinstance(one, str):
                lost[int(ids[row])] = one
                continue
            top = float(parts["top"].to_numpy(float)[own].max())
            mesh = _placed(one, top, float(ground[own].max()), float(low[own].min()))
            shade = DARKEST + (1 - DARKEST) * uniform(seed, "mesh/shade", ids[row : row + 1])
            mesh = replace(mesh, tint=(mesh.tint * shade).astype(np.float32))
            shells.append(_painted(mesh, parts.iloc[own[0]], finishes, int(own[0])))
    return shells, lost


def _painted(mesh: MeshBatch, part: Any, finishes: Finishes, row: int) -> MeshBatch:
    """Give walls and roofs the materials and colours that the layout says."""
    rise = area_vectors(mesh.vertices, mesh.faces)
    rise = rise[:, 2] / np.maximum(np.linalg.norm(rise, axis=1), 1e-12)
    for what, faces in (("wall", np.abs(rise) < ROOF), ("roof", rise >= ROOF)):
        if not part[f"{what}_material"] and part[f"{what}_color"] < 0:
            continue
        names = (*mesh.materials, str(getattr(finishes, f"{what}_material")[row]))
        tint = np.where(faces[:, None], getattr(finishes, f"{what}_tint")[row], mesh.tint)
        material = np.where(faces, len(names) - 1, mesh.material).astype(np.int16)
        mesh = concatenate(
            [replace(mesh, materials=names, material=material, tint=tint.astype(np.float32))]
        )
    return mesh


def _placed(mesh: MeshBatch, top: float, ground: float, low: float) -> MeshBatch:
    """Stand a mesh on its ground, as high as its layout says, on a plinth down to a level.

    Parameters
    ----------
    top
        Metres above the ground.
    ground, low
        Metres.
    """
    points = mesh.vertices * [1.0, 1.0, top / float(mesh.vertices[:, 2].max())]
    faces = mesh.faces
    used = np.where(faces == NO_VERTEX, faces[:, :1], faces)
    foot = np.flatnonzero((mesh.vertices[used, 2] < ON_GROUND).all(axis=1))
    # The underside moves down, and quads join its border with where it was.
    inner = np.unique(used[foot])
    number = np.full(len(points), -1, np.int32)
    number[inner] = len(points) + np.arange(len(inner), dtype=np.int32)
    sunk = points[inner].copy()
    sunk[:, 2] = low - ground
    quads, beside = _skirt(faces, foot, number)
    moved = faces.copy()
    moved[foot] = np.where(faces[foot] == NO_VERTEX, NO_VERTEX, number[faces[foot]])
    vertices = np.concatenate([points, sunk])
    length = np.hypot(*(points[quads[:, 2]] - points[quads[:, 3]])[:, :2].T)
    depth = points[quads[:, 2], 2] - (low - ground)
    zero = np.zeros(len(quads))
    uv = np.stack([np.stack([zero, -depth], 1), np.stack([length, -depth], 1),
                   np.stack([length, zero], 1), np.stack([zero, zero], 1)], axis=1)  # fmt: skip
    whole = np.concatenate([moved, quads])
    kept, place = np.unique(whole, return_inverse=True)  # the first is `NO_VERTEX`, if there is any
    first = int(kept[0] == NO_VERTEX)
    return replace(
        mesh,
        vertex_start=np.array([0, len(kept) - first], np.int64),
        face_start=np.array([0, len(whole)], np.int64),
        vertices=vertices[kept[first:]] + [0.0, 0.0, ground],
        faces=(place.reshape(whole.shape) - first).astype(np.int32),
        material=np.concatenate([mesh.material, mesh.material[beside]]),
        uv=np.concatenate([mesh.uv, uv.astype(np.float32)]),
        tint=np.concatenate([mesh.tint, mesh.tint[beside]]),
    )


def _skirt(
    faces: NDArray[np.int32], foot: NDArray[np.int64], number: NDArray[np.int32]
) -> tuple[NDArray[np.int32], NDArray[np.int64]]:
    """Return the quads below the border of an underside, and the face above each.

    Parameters
    ----------
    faces
        (f, 4) of a closed mesh.
    foot
        Rows of its underside.
    number
        Vertex to its copy below.
    """
    edges: dict[tuple[int, int], int] = {}
    under = set(foot.tolist())
    for row, corners in enumerate(faces.tolist()):
        ring = [corner for corner in corners if corner != NO_VERTEX]
        edges |= dict.fromkeys(zip(ring, [*ring[1:], ring[0]], strict=True), row)
    border = [
        (a, b, edges[b, a])
        for (a, b), row in edges.items()
        if row in under and edges[b, a] not in under
    ]
    # Seen from outside the wall above runs from b to a.
    quads = [(int(number[b]), int(number[a]), a, b) for a, b, _ in border]
    return (
        np.array(quads, np.int32).reshape(-1, 4),
        np.array([row for _, _, row in border], np.int64),
    )
