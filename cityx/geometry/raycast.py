"""Rays against meshes and their instances: one caster for cameras, LiDAR and the eyes of agents.

Two levels of trees (`cityx.geometry.bvh`): one per mesh, and one over the instances of meshes, so
that a street of a thousand equal windows costs the memory of one. Coordinates of meshes are float32
in the mesh's own frame, all arithmetic is float64: a hit is as exact as the vertices are.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cityx.geometry.arrays import FloatArray
from cityx.system.cores import in_threads

BLOCK = 8192  # rays that a thread casts at a time
FLAT = 1e-18  # volume of what was of volume 1 below which an instance is flattened


@dataclass(frozen=True)
class Masks:
    """Which parts of triangles stop rays, for meshes with cut-out materials.

    Attributes
    ----------
    mask
        (t,) int32 per triangle of all meshes, into ``images``; -1 for a solid one.
    uv
        (t, 3, 2) float32, corners on the image, which is repeated beyond 0 to 1; v upwards.
    images
        (rows, columns) bool each, True where a ray is stopped; the first row is the upper one.
    """

    mask: NDArray[np.int32]
    uv: NDArray[np.float32]
    images: tuple[NDArray[np.bool_], ...]


@dataclass(frozen=True)
class Shapes:
    """m meshes with a tree each, t triangles in all; those of a leaf follow each other.

    Attributes
    ----------
    first
        (m + 1,) int64, first triangle of each mesh.
    root
        (m,) int64, code of its root.
    box, child
        Nodes, see `cityx.geometry.bvh`.
    corners
        (t, 3, 3) float32.
    number
        (t,) int32, number of each triangle in its mesh as it was given.
    row
        (t,) int64, the row above of each triangle in the order in which they were given.
    bounds
        (m, 6) float32, lower and upper corner of each mesh.
    mask, uv, mask_start, mask_size, mask_bits
        Cut-outs, see `Masks`.
    """

    first: NDArray[np.int64]
    root: NDArray[np.int64]
    box: NDArray[np.float32]
    child: NDArray[np.int64]
    corners: NDArray[np.float32]
    number: NDArray[np.int32]
    row: NDArray[np.int64]
    bounds: NDArray[np.float32]
    mask: NDArray[np.int32]
    uv: NDArray[np.float32]
    mask_start: NDArray[np.int64]
    mask_size: NDArray[np.int64]
    mask_bits: NDArray[np.bool_]

    @property
    def count(self) -> int:
        """Number of meshes."""
        return len(self.root)


@dataclass(frozen=True)
class RayScene:
    """n instances of meshes with a tree over them; scenes may follow each other (`joined`).

    Attributes
    ----------
    shapes
        The meshes.
    mesh
        (n,) int32, mesh of each instance.
    transform, inverse
        (n, 3, 4) float64, from the frame of the mesh to that of the scene, and back.
    root, box, child, order
        Tree over the instances.
    rest
        Scenes whose instances are numbered behind these.
    """

    shapes: Shapes
    mesh: NDArray[np.int32]
    transform: FloatArray
    inverse: FloatArray
    root: int
    box: NDArray[np.float32]
    child: NDArray[np.int64]
    order: NDArray[np.int32]
    rest: tuple[RayScene, ...] = ()

    @property
    def count(self) -> int:
        """Number of instances, with those of the rest."""
        return len(self.mesh) + sum(scene.count for scene in self.rest)


@dataclass(frozen=True)
class Hits:
    """What r rays meet first.

    Attributes
    ----------
    distance
        (r,) float64 in lengths of the direction; infinite where nothing is met.
    instance
        (r,) int64; -1 where nothing is met.
    triangle
        (r,) int32, number of the triangle in the mesh as it was given; -1 likewise.
    u, v
        (r,) float32, weights of its second and third corner.
    back
        (r,) bool, whether it is seen from behind: its corners run clockwise.
    """

    distance: FloatArray
    instance: NDArray[np.int64]
    triangle: NDArray[np.int32]
    u: NDArray[np.float32]
    v: NDArray[np.float32]
    back: NDArray[np.bool_]


def ray_scene(
    vertices: Sequence[ArrayLike],
    triangles: Sequence[ArrayLike],
    mesh: ArrayLike,
    transform: ArrayLike,
    *,
    masks: Masks | None = None,
) -> RayScene:
    """Return a scene of instances of meshes, ready for rays.

    Parameters
    ----------
    vertices
        Of each mesh, (v, 3) in its own frame; kept as float32.
    triangles
        Of each mesh, (t, 3) into its vertices, counter-clockwise seen from outside.
    mesh
        (n,) mesh of each instance.
    transform
        (n, 3, 4) from the frame of the mesh to that of the scene. Mirrored ones pass; instances
        that are flattened to no volume are not seen.
    masks
        Cut-outs of the triangles, those of one mesh after those of the other.
    """
    return placed(shapes_of(vertices, triangles, masks=masks), mesh, transform)


def shapes_of(
    vertices: Sequence[ArrayLike], triangles: Sequence[ArrayLike], *, masks: Masks | None = None
) -> Shapes:
    """Build the trees of meshes; see `ray_scene`."""
    from cityx.geometry import bvh

    counts = [len(np.asarray(t).reshape(-1, 3)) for t in triangles]
    first = np.concatenate([[0], np.cumsum(counts)]).astype(np.int64)
    corners = np.empty((int(first[-1]), 3, 3), np.float32)
    for number, (points, faces) in enumerate(zip(vertices, triangles, strict=True)):
        held = np.asarray(points, np.float32).reshape(-1, 3)
        corners[first[number] : first[number + 1]] = held[np.asarray(faces).reshape(-1, 3)]
    count, total = len(counts), len(corners)
    box, child = np.empty((total + 1, 12), np.float32), np.empty((total + 1, 2), np.int64)
    root, order = np.empty(count, np.int64), np.empty(total, np.int32)
    found = np.empty((count, 6), np.float32)
    bvh.bounds(corners, first, found)
    used = bvh.build_all(corners, first, box, child, root, order)
    box, child = box[:used].copy(), child[:used].copy()
    bvh.grow(box)
    mask, uv = np.full(total, -1, np.int32), np.zeros((0, 3, 2), np.float32)
    images: tuple[NDArray[np.bool_], ...] = ()
    source = np.repeat(first[:-1], counts) + order  # (t,) triangle as given of each in a leaf
    row = np.empty(total, np.int64)
    row[source] = np.arange(total)
    if masks is not None and len(masks.images):
        mask, uv = masks.mask[source].astype(np.int32), masks.uv[source].astype(np.float32)
        images = masks.images
    sizes = np.array([image.shape for image in images], np.int64).reshape(-1, 2)
    return Shapes(
        first, root, box, child, corners, order, row, found, mask, uv,
        np.concatenate([[0], np.cumsum(sizes.prod(axis=1))]).astype(np.int64)[:-1],
        sizes,
        np.concatenate([np.zeros(0, bool), *(image.reshape(-1) for image in images)]),
    )  # fmt: skip


def together(parts: Sequence[Shapes]) -> Shapes:
    """Return the meshes of several tables behind each other, trees and all; none has masks."""
    from cityx.geometry import bvh

    if not parts:
        return shapes_of([], [])
    faces = np.cumsum([0] + [len(part.corners) for part in parts])
    nodes = np.cumsum([0] + [len(part.box) for part in parts])

    def moved(codes: NDArray[np.int64], node: int, face: int) -> NDArray[np.int64]:
        return np.where(codes >= 0, codes + node, codes - bvh.SCALE * face)

    shifts = list(zip(parts, nodes[:-1].tolist(), faces[:-1].tolist(), strict=True))
    held = {
        name: np.concatenate([getattr(part, name) for part in parts])
        for name in ("box", "corners", "number", "bounds", "mask")
    }
    empty = shapes_of([], [])
    return replace(
        empty,
        first=np.concatenate([[0], *(p.first[1:] + face for p, _, face in shifts)]),
        root=np.concatenate([moved(p.root, node, face) for p, node, face in shifts]),
        child=np.concatenate([moved(p.child, node, face) for p, node, face in shifts]),
        row=np.concatenate([p.row + face for p, _, face in shifts]),
        **held,
    )


def placed(shapes: Shapes, mesh: ArrayLike, transform: ArrayLike) -> RayScene:
    """Return a scene of instances of meshes that have their trees; see `ray_scene`."""
    ways = np.asarray(transform, float).reshape(-1, 3, 4)
    return _treed(shapes, np.asarray(mesh, np.int32).reshape(-1), ways, _inverse(ways))


def _treed(
    shapes: Shapes, which: NDArray[np.int32], ways: FloatArray, inverse: FloatArray
) -> RayScene:
    """Build the tree over instances; those whose way back is nothing are not seen."""
    from cityx.geometry import bvh

    seen = inverse[:, :, :3].any(axis=(1, 2))
    seen &= shapes.bounds[which, 0] <= shapes.bounds[which, 3]
    low, high = shapes.bounds[which, :3].astype(float), shapes.bounds[which, 3:].astype(float)
    low, high = np.where(seen[:, None], low, 0.0), np.where(seen[:, None], high, 0.0)
    middle, half = (low + high) / 2, (high - low) / 2
    turned = np.einsum("nij,nj->ni", ways[:, :, :3], middle) + ways[:, :, 3]
    reach = np.einsum("nij,nj->ni", np.abs(ways[:, :, :3]), half)
    work = np.column_stack([turned - reach, turned + reach]).astype(np.float32)
    order = np.flatnonzero(seen).astype(np.int32)
    work = np.ascontiguousarray(work[order])
    bvh.grow(work)
    box = np.empty((len(order) + 1, 12), np.float32)
    child = np.empty((len(order) + 1, 2), np.int64)
    root, used = bvh.build(work, order, 0, len(order), bvh.ONE, box, child, 0)
    return RayScene(
        shapes, which, ways, inverse, int(root), box[:used].copy(), child[:used].copy(), order
    )


def _inverse(ways: FloatArray) -> FloatArray:
    """Return (n, 3, 4) ways back; nothing for what is flattened."""
    linear = ways[:, :, :3]
    seen = np.abs(np.linalg.det(linear)) > FLAT
    back = np.zeros(ways.shape)
    back[seen, :, :3] = np.linalg.inv(linear[seen])
    back[:, :, 3] = -np.einsum("nij,nj->ni", back[:, :, :3], ways[:, :, 3])
    return back


def joined(scene: RayScene, *others: RayScene) -> RayScene:
    """Return a scene with the instances of others numbered behind its own; nothing is copied."""
    return RayScene(
        scene.shapes, scene.mesh, scene.transform, scene.inverse, scene.root, scene.box,
        scene.child, scene.order, (*scene.rest, *others),
    )  # fmt: skip


def subset(scene: RayScene, instances: ArrayLike) -> RayScene:
    """Return a scene of some instances alone, numbered in the order given."""
    rows = np.asarray(instances, np.int64).reshape(-1)
    parts, first = [], 0
    for part in _parts(scene):
        own = rows[(first <= rows) & (rows < first + len(part.mesh))] - first
        first += len(part.mesh)
        if len(own):
            parts.append(
                _treed(part.shapes, part.mesh[own], part.transform[own], part.inverse[own])
            )
    if not parts:
        return placed(scene.shapes, np.zeros(0, np.int32), np.zeros((0, 3, 4)))
    return joined(*parts)


def corners_at(
    scene: RayScene, instance: NDArray[np.int64], triangle: NDArray[np.int32]
) -> FloatArray:
    """Return the (r, 3, 3) corners of triangles of instances, in the frame of the scene."""
    found = np.empty((len(instance), 3, 3))
    first = 0
    for part in _parts(scene):
        own = np.flatnonzero((first <= instance) & (instance < first + len(part.mesh)))
        which = instance[own] - first
        shapes, way = part.shapes, part.transform[which]
        rows = shapes.row[shapes.first[part.mesh[which]] + triangle[own]]
        local = shapes.corners[rows].astype(float)
        found[own] = np.einsum("nij,nkj->nki", way[:, :, :3], local) + way[:, None, :, 3]
        first += len(part.mesh)
    return found


def mesh_corners(scene: RayScene, instance: int) -> FloatArray:
    """Return the (t, 3, 3) corners of the triangles of an instance, in the frame of its mesh."""
    first = 0
    for part in _parts(scene):
        if instance < first + len(part.mesh):
            mesh = part.mesh[instance - first]
            own = slice(*part.shapes.first[mesh : mesh + 2].tolist())
            return part.shapes.corners[own].astype(float)
        first += len(part.mesh)
    raise IndexError(f"there is no instance {instance}, there are {first}")


def ways_at(
    scene: RayScene, instance: NDArray[np.int64]
) -> tuple[FloatArray, FloatArray, NDArray[np.int64]]:
    """Return the (r, 3, 4) transforms of instances, their inverses, and (r,) how many triangles."""
    ways, back = np.empty((len(instance), 3, 4)), np.empty((len(instance), 3, 4))
    count = np.zeros(len(instance), np.int64)
    first = 0
    for part in _parts(scene):
        own = np.flatnonzero((first <= instance) & (instance < first + len(part.mesh)))
        which = instance[own] - first
        ways[own], back[own] = part.transform[which], part.inverse[which]
        count[own] = np.diff(part.shapes.first)[part.mesh[which]]
        first += len(part.mesh)
    return ways, back, count


def normals(scene: RayScene, hits: Hits, directions: ArrayLike) -> FloatArray:
    """Return the (r, 3) unit normals of what rays met, towards where they came from; 0 of none."""
    from cityx.geometry import bvh

    ahead = np.ascontiguousarray(np.asarray(directions, float).reshape(-1, 3))
    found = np.zeros((len(ahead), 3))
    first = 0
    for part in _parts(scene):
        s = part.shapes
        bvh.face_normals(
            s.first, s.row, s.corners, part.mesh, part.inverse, first, hits.instance,
            hits.triangle, ahead, found,
        )  # fmt: skip
        first += len(part.mesh)
    return found


def _parts(scene: RayScene) -> list[RayScene]:
    return [scene, *(part for other in scene.rest for part in _parts(other))]


def cast(
    scene: RayScene,
    origins: ArrayLike,
    directions: ArrayLike,
    *,
    reach: ArrayLike = np.inf,
    threads: int | None = None,
) -> Hits:
    """Return what rays meet first.

    Parameters
    ----------
    scene
        The scene.
    origins
        (r, 3), or (3,) for all.
    directions
        (r, 3) of any length but 0; neighbours should look alike, as pixels of a picture do.
    reach
        Lengths of the direction up to which to look, one or (r,).
    threads
        That share the work, by default all cores; what is found is the same for any number.
    """
    from cityx.geometry import bvh

    ahead = np.ascontiguousarray(np.asarray(directions, float).reshape(-1, 3))
    count = len(ahead)
    begin = np.ascontiguousarray(np.broadcast_to(np.asarray(origins, float), (count, 3)))
    distance = np.array(np.broadcast_to(np.asarray(reach, float), count))
    instance, triangle = np.full(count, -1, np.int64), np.full(count, -1, np.int32)
    u, v = np.zeros(count, np.float32), np.zeros(count, np.float32)
    back = np.zeros(count, bool)
    shift = 0
    for part in _parts(scene):

        def task(low: int, part: RayScene = part, shift: int = shift) -> None:
            s = part.shapes
            bvh.trace(
                s.root, s.box, s.child, s.corners, s.number, s.mask, s.uv, s.mask_start,
                s.mask_size, s.mask_bits, part.root, part.box, part.child, part.order,
                part.mesh, part.inverse, begin, ahead, low, min(low + BLOCK, count), shift,
                distance, instance, triangle, u, v, back,
            )  # fmt: skip

        in_threads(task, range(0, count, BLOCK), threads)
        shift += len(part.mesh)
    missed = instance < 0
    distance[missed] = np.inf
    return Hits(distance, instance, triangle, u, v, back)
