"""Bodies: what every object of a city is to a physics engine, as data.

Bodies are derived (`cityx.assets.colliders`), never stored: they follow from meshes, materials and
kinds, and a second truth would be wrong after the first edit. The same city gives the same bodies.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

from cityx.geometry.convex import Box, Cylinder, Hull, Solid
from cityx.geometry.ranges import ranges

FORMS = ("box", "cylinder", "hull", "mesh")
FORM = {name: number for number, name in enumerate(FORMS)}
# fixed: part of the world; free: pushed and lifted; hinge: turns about the line x = -half length of
# its first part, upright; driven: follows its track and yields to nothing.
MOTIONS = ("fixed", "free", "hinge", "driven")
MOTION = {name: number for number, name in enumerate(MOTIONS)}


@dataclass(frozen=True)
class Colliders:
    """Colliders of k shapes, each of one or more parts, p parts in all.

    A part is a box or a cylinder (upright, turned about z), the hull of points, or the triangles of
    the object's own mesh. Places are in the frame of the shape: that of the prototype for what is
    placed, that of the city for what has a mesh of its own.

    Attributes
    ----------
    part_start
        (k + 1,) int64 into the parts.
    form
        (p,) uint8 into `FORMS`.
    center, half
        (p, 3) float64, metres: middle, and half of length, width and height before the turn (twice
        the radius and the half height of a cylinder; of a hull or mesh those of its bounds).
    yaw
        (p,) float64, radians counter-clockwise about z.
    point_start
        (p + 1,) int64 into ``points``.
    points
        (q, 3) float64, corners of hulls, metres.
    volume
        (p,) float64, cubic metres; 0 for a mesh.
    """

    part_start: NDArray[np.int64]
    form: NDArray[np.uint8]
    center: NDArray[np.float64]
    half: NDArray[np.float64]
    yaw: NDArray[np.float64]
    point_start: NDArray[np.int64]
    points: NDArray[np.float64]
    volume: NDArray[np.float64]

    @property
    def count(self) -> int:
        """Number of shapes."""
        return len(self.part_start) - 1

    def parts(self, shape: int) -> slice:
        """Return the rows of the parts of a shape."""
        return slice(int(self.part_start[shape]), int(self.part_start[shape + 1]))

    def hull(self, part: int) -> NDArray[np.float64]:
        """Return the corners of a hull, (n, 3)."""
        return self.points[self.point_start[part] : self.point_start[part + 1]]

    def corners(self, part: int) -> NDArray[np.float64]:
        """Return points whose hull is the part, (n, 3): of a cylinder an outer polygon's."""
        if self.form[part] == FORM["hull"]:
            return self.hull(part)
        if self.form[part] == FORM["cylinder"]:
            turn = np.arange(16) * (np.pi / 8)
            rim = np.column_stack([np.cos(turn), np.sin(turn)]) / np.cos(np.pi / 16)
            flat = np.tile(rim * self.half[part, 0], (2, 1))
            upright = np.repeat([-1.0, 1.0], 16) * self.half[part, 2]
            return np.asarray(np.column_stack([flat, upright]) + self.center[part])
        return Box(self.center[part], self.half[part], float(self.yaw[part])).corners()


@dataclass(frozen=True)
class Bodies:
    """The bodies of n objects.

    Attributes
    ----------
    object_id, owner
        (n,) uint64: the object, and the one it belongs to (a building for its doors), or 0.
    kind
        (n,) int16 into ``kinds``, the semantic class.
    kinds
        Such as "building", "ground", "tree", "bench", "car".
    shape
        (n,) int32 into ``colliders``.
    colliders
        The shapes; instances of a prototype share one.
    position, rotation, scale
        (n, 3) float64: metres, XYZ Euler angles in radians, factors; of the frame of the shape.
    mass
        (n,) float64, kilograms.
    friction, restitution
        (n,) float64, of Coulomb and of Newton.
    motion
        (n,) uint8 into `MOTIONS`.
    """

    object_id: NDArray[np.uint64]
    owner: NDArray[np.uint64]
    kind: NDArray[np.int16]
    kinds: tuple[str, ...]
    shape: NDArray[np.int32]
    colliders: Colliders
    position: NDArray[np.float64]
    rotation: NDArray[np.float64]
    scale: NDArray[np.float64]
    mass: NDArray[np.float64]
    friction: NDArray[np.float64]
    restitution: NDArray[np.float64]
    motion: NDArray[np.uint8]

    @property
    def count(self) -> int:
        """Number of bodies."""
        return len(self.object_id)

    @property
    def movable(self) -> NDArray[np.bool_]:
        """(n,) whether it is a thing of its own that can be pushed or carried away."""
        return np.asarray(self.motion == MOTION["free"])

    def of_kind(self, *kinds: str) -> NDArray[np.bool_]:
        """(n,) whether it is of one of some classes."""
        return np.asarray(np.isin(self.kind, [i for i, k in enumerate(self.kinds) if k in kinds]))


def colliders_of(shapes: Sequence[Sequence[Solid]]) -> Colliders:
    """Return colliders of shapes of convex solids; a shape without any is one of its own mesh."""
    solids = [solid for shape in shapes for solid in (shape or (None,))]
    points = [s.points if isinstance(s, Hull) else np.zeros((0, 3)) for s in solids]
    count = len(solids)
    center, half, yaw, form = np.zeros((count, 3)), np.zeros((count, 3)), np.zeros(count), []
    for row, solid in enumerate(solids):
        if isinstance(solid, Box):
            form.append("box")
            center[row], half[row], yaw[row] = solid.center, solid.half, solid.yaw
        elif isinstance(solid, Cylinder):
            form.append("cylinder")
            center[row], half[row] = solid.center, (solid.radius, solid.radius, solid.half_height)
        elif isinstance(solid, Hull):
            form.append("hull")
            low, high = solid.points.min(axis=0), solid.points.max(axis=0)
            center[row], half[row] = (low + high) / 2, (high - low) / 2
        else:
            form.append("mesh")
    return Colliders(
        np.concatenate([[0], np.cumsum([max(len(shape), 1) for shape in shapes])]).astype(np.int64),
        np.array([FORM[name] for name in form], np.uint8),
        center,
        half,
        yaw,
        np.concatenate([[0], np.cumsum([len(p) for p in points])]).astype(np.int64),
        np.concatenate([np.zeros((0, 3)), *points]),
        np.array([0.0 if solid is None else solid.volume for solid in solids]),
    )


def join_colliders(tables: Sequence[Colliders]) -> Colliders:
    """Put the shapes of tables behind each other."""
    names = ("form", "center", "half", "yaw", "points", "volume")
    held = {name: np.concatenate([getattr(t, name) for t in tables]) for name in names}
    lengths = [np.concatenate([np.diff(getattr(t, name)) for t in tables])
               for name in ("part_start", "point_start")]  # fmt: skip
    starts = [np.concatenate([[0], np.cumsum(length)]).astype(np.int64) for length in lengths]
    return Colliders(part_start=starts[0], point_start=starts[1], **held)


def join_bodies(tables: Sequence[Bodies]) -> Bodies:
    """Put tables of bodies behind each other, at least one; kinds of the same name are one."""
    kinds = tuple(dict.fromkeys(name for table in tables for name in table.kinds))
    plain = [
        f.name for f in fields(Bodies) if f.name not in ("kind", "kinds", "shape", "colliders")
    ]
    held = {name: np.concatenate([getattr(t, name) for t in tables]) for name in plain}
    shift = np.cumsum([0] + [t.colliders.count for t in tables])
    numbers = [np.array([kinds.index(name) for name in t.kinds], np.int16) for t in tables]
    return Bodies(
        **held,
        kind=np.concatenate([n[t.kind] for n, t in zip(numbers, tables, strict=True)]),
        kinds=kinds,
        shape=np.concatenate(
            [t.shape + np.int32(s) for t, s in zip(tables, shift, strict=False)]
        ).astype(np.int32),
        colliders=join_colliders([t.colliders for t in tables]),
    )


def take_bodies(bodies: Bodies, rows: NDArray[np.int64] | NDArray[np.bool_]) -> Bodies:
    """Return some bodies, in the order of `rows`, with the shapes they use."""
    rows = np.arange(bodies.count)[rows]
    used, shape = np.unique(bodies.shape[rows], return_inverse=True)
    parts, part_start = ranges(bodies.colliders.part_start, used.astype(np.int64))
    points, point_start = ranges(bodies.colliders.point_start, parts)
    names = ("form", "center", "half", "yaw", "volume")
    held = {name: getattr(bodies.colliders, name)[parts] for name in names}
    colliders = Colliders(
        part_start=part_start, point_start=point_start,
        points=bodies.colliders.points[points], **held,
    )  # fmt: skip
    skipped = ("kinds", "shape", "colliders")
    plain = {f.name: getattr(bodies, f.name)[rows] for f in fields(Bodies) if f.name not in skipped}
    return Bodies(**plain, kinds=bodies.kinds, shape=shape.astype(np.int32), colliders=colliders)
