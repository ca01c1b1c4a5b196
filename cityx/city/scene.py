"""The scene: shells of their own, and instances of shared prototypes."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from cityx.city.mesh import MeshBatch

CHUNK = 16_384  # faces
MOST_IN_CHUNK = 512  # prototypes, whose materials are numbered together with 16 bits


@dataclass(frozen=True)
class Prototype:
    """A mesh that many instances share: a window, a tree, a lamp.

    Attributes
    ----------
    name
        Unique in the scene, lower case, such as ``window_sash``.
    kind
        Collection it belongs to: "window", "door", "shopfront", "trim", "tree", "furniture",
        "vehicle", "roof_furniture", ...
    mesh
        Batch of one object about the prototype's own origin, z up, front facing -y.
    """

    name: str
    kind: str
    mesh: MeshBatch


@dataclass(frozen=True)
class Instances:
    """Rows that place prototypes, n of them.

    Attributes
    ----------
    prototype
        (n,) int32 into ``Scene.prototypes``.
    object_id
        (n,) uint64, the instance's own id.
    owner
        (n,) uint64, the object it belongs to (a building for its windows), or 0.
    position
        (n, 3) float64, metres.
    rotation
        (n, 3) float32, XYZ Euler angles, radians.
    scale
        (n, 3) float32.
    tint
        (n, 3) float32, linear RGB, multiplies the base colour of materials that take a tint.
    """

    prototype: NDArray[np.int32]
    object_id: NDArray[np.uint64]
    owner: NDArray[np.uint64]
    position: NDArray[np.float64]
    rotation: NDArray[np.float32]
    scale: NDArray[np.float32]
    tint: NDArray[np.float32]

    @property
    def count(self) -> int:
        """Number of instances."""
        return len(self.prototype)


def in_chunks(prototypes: Sequence[Prototype]) -> Iterator[Sequence[Prototype]]:
    """Yield prototypes in runs of no more than `CHUNK` faces, at least one in each.

    Arrays of such a run stay in the processor's cache, and are worked on faster than one by one.
    """
    first = faces = 0
    for row, prototype in enumerate(prototypes):
        own = len(prototype.mesh.faces)
        if row > first and (faces + own > CHUNK or row - first == MOST_IN_CHUNK):
            yield prototypes[first:row]
            first, faces = row, 0
        faces += own
    if first < len(prototypes):
        yield prototypes[first:]


def no_instances() -> Instances:
    """Return an empty table of instances."""
    return Instances(
        np.zeros(0, np.int32),
        np.zeros(0, np.uint64),
        np.zeros(0, np.uint64),
        np.zeros((0, 3)),
        np.zeros((0, 3), np.float32),
        np.zeros((0, 3), np.float32),
        np.zeros((0, 3), np.float32),
    )


@dataclass(frozen=True)
class Scene:
    """Meshes by layer name and instances by layer name.

    Attributes
    ----------
    meshes
        Layer name ("buildings", "ground", "barriers", "bridges", ...) to batch.
    prototypes
        Shared meshes; instances refer to them by position in this tuple.
    instances
        Layer name ("windows", "trees", "street_furniture", "vehicles", ...) to rows.
    """

    meshes: Mapping[str, MeshBatch] = field(default_factory=lambda: MappingProxyType({}))
    prototypes: tuple[Prototype, ...] = ()
    instances: Mapping[str, Instances] = field(default_factory=lambda: MappingProxyType({}))

    def with_mesh(self, layer: str, batch: MeshBatch) -> Scene:
        """Return the scene with one mesh layer set; layers are kept in alphabetical order."""
        meshes = dict(sorted({**self.meshes, layer: batch}.items()))
        return replace(self, meshes=MappingProxyType(meshes))

    def with_instances(self, layer: str, prototypes: Iterable[Prototype], rows: Instances) -> Scene:
        """Return the scene with one instance layer set.

        Parameters
        ----------
        layer
            Name of the layer; rows it held before are replaced.
        prototypes
            Prototypes that ``rows.prototype`` counts; those already in the scene (by name) are
            shared, the others are added.
        rows
            The instances.
        """
        offered = tuple(prototypes)
        known = {prototype.name: index for index, prototype in enumerate(self.prototypes)}
        added = tuple(p for p in offered if p.name not in known)
        known |= {p.name: len(self.prototypes) + i for i, p in enumerate(added)}
        table = np.array([known[p.name] for p in offered], np.int32)
        same = np.array_equal(table, np.arange(len(table)))
        moved = rows if same else replace(rows, prototype=table[rows.prototype])
        instances = dict(sorted({**self.instances, layer: moved}.items()))
        return replace(
            self, prototypes=self.prototypes + added, instances=MappingProxyType(instances)
        )
