"""Placing: rows of instances on walls, gathered prototype by prototype."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cityx.building.facade.wall_faces import WallFaces
from cityx.building.facade.walls import WallTable
from cityx.city.scene import Instances, Prototype, no_instances
from cityx.geometry.arrays import FloatArray, IntArray
from cityx.ids import hash_ids


@dataclass(frozen=True)
class Facing:
    """Walls to be faced up to a level, k of them.

    Attributes
    ----------
    material
        Name of the material.
    wall
        (k,) rows of walls.
    low, high
        (k,) heights.
    tint
        (k, 3) linear RGB.
    before, after
        (k,) how far it runs round the corner at the start and the end, in its thickness.
    """

    material: str
    wall: IntArray
    low: FloatArray
    high: FloatArray
    tint: NDArray[np.float32]
    before: FloatArray
    after: FloatArray


@dataclass
class Placing:
    """Collects instances on the walls of one city, layer by layer.

    A class because a facade puts some thirty kinds of things on the same walls.

    Attributes
    ----------
    walls, faces, building, key
        The walls; how their drawn faces leave the straight line; the building of each, (w,) uint64;
        and a stable key of each, (w,) uint64.
    detail
        Level of detail in which prototypes are made.
    prototypes, rows, facings
        What was put on the walls so far.
    """

    walls: WallTable
    faces: WallFaces
    building: NDArray[np.uint64]
    key: NDArray[np.uint64]
    detail: int = 2
    prototypes: dict[str, Prototype] = field(default_factory=dict)
    rows: list[tuple[str, Instances]] = field(default_factory=list)
    facings: list[Facing] = field(default_factory=list)
    _numbers: dict[str, int] = field(default_factory=dict)

    def __post_init__(self) -> None:
        """Work out the direction of every wall once."""
        vector = self.walls.end - self.walls.start
        self.unit = vector / np.maximum(self.walls.length, 1e-9)[:, None]
        self.yaw = np.arctan2(vector[:, 1], vector[:, 0])

    def add(
        self,
        name: str,
        make: Callable[..., Prototype],
        wall: IntArray,
        along: FloatArray,
        z: FloatArray,
        *,
        scale: tuple[Any, Any, Any] = (1.0, 1.0, 1.0),
        tint: Any = 1.0,
        index: Any = 0,
        out: Any = 0.0,
        reach: Any = 0.5,
        turn: float = 0.0,
        ids: NDArray[np.uint64] | None = None,
    ) -> None:
        """Put a prototype on walls.

        Parameters
        ----------
        name, make
            Name of the prototype and how to make it at a level of `detail`; made once.
        wall, along, z
            (k,) rows of walls, metres from their start, heights.
        scale
            Along the wall, outward, upward; each a number or (k,).
        tint
            (k, 3) linear RGB, or a number.
        index
            (k,) what tells things of the same kind in the same wall apart.
        out
            Metres before the wall.
        reach
            Metres to either side over which the thing leans on the wall.
        turn
            Radians by which it is turned away from the wall, counter-clockwise.
        ids
            (k,) ids, where they are known.
        """
        if not len(wall):
            return
        number = self._number(name, make)
        ids = self.ids(name, wall, index) if ids is None else ids
        rows = self._against(number, ids, wall, along, z, scale, tint, out, reach, turn)
        self.rows.append((self.prototypes[name].kind, rows))

    def add_each(
        self,
        names: NDArray[np.str_],
        make: Callable[[str], Callable[..., Prototype]],
        wall: IntArray,
        along: FloatArray,
        z: FloatArray,
        *,
        index: IntArray,
        scale: tuple[Any, Any, Any] = (1.0, 1.0, 1.0),
        tint: Any = 1.0,
        out: Any = 0.0,
        reach: Any = 0.5,
        turn: Any = 0.0,
    ) -> None:
        """Put many prototypes of one kind on walls at once, each row its own; see `add`.

        Parameters
        ----------
        names
            (k,) name of the prototype of each row.
        make
            Tells how to make the one of a name.
        """
        if not len(wall):
            return
        known, which = np.unique(names, return_inverse=True)
        numbers = np.array([self._number(name, make(name)) for name in known.tolist()], np.int32)
        ids = np.empty(len(wall), np.uint64)
        order = np.argsort(which, kind="stable")
        bounds = np.cumsum(np.bincount(which))[:-1]
        for name, of in zip(known.tolist(), np.split(order, bounds), strict=True):
            ids[of] = self.ids(name, wall[of], index[of])
        kind = self.prototypes[str(known[0])].kind
        rows = self._against(numbers[which], ids, wall, along, z, scale, tint, out, reach, turn)
        self.rows.append((kind, rows))

    def _number(self, name: str, make: Callable[..., Prototype]) -> int:
        """Return the number of a prototype, made where it is new."""
        if name not in self.prototypes:
            self.prototypes[name] = make(detail=self.detail)
            self._numbers[name] = len(self._numbers)
        return self._numbers[name]

    def _against(
        self, number: Any, ids: NDArray[np.uint64], wall: IntArray, along: FloatArray, z: Any,
        scale: tuple[Any, Any, Any], tint: Any, out: Any, reach: Any, turn: Any,
    ) -> Instances:  # fmt: skip
        """Return rows of things that lean on walls; arguments as of `add`."""
        size = len(wall)
        along = np.asarray(along, float)
        left = np.clip(along - reach, 0.0, self.walls.length[wall])
        right = np.clip(along + reach, 0.0, self.walls.length[wall])
        face = np.stack([self.faces.before(self.walls, wall, x) for x in (left, along, right)])
        lean = np.arctan2(face[0] - face[2], np.maximum(right - left, 0.05))
        # A face that bulges between the ends lifts the thing clear of it.
        stand = np.maximum((face[0] + face[2]) / 2, face[1]) + np.asarray(out)
        at = self.walls.start[wall] + self.unit[wall] * along[:, None]
        at = at + self.walls.normal[wall] * stand[:, None]
        rotation = np.zeros((size, 3), np.float32)
        rotation[:, 2] = self.yaw[wall] + lean + turn
        factors = np.stack([np.broadcast_to(each, (size,)) for each in scale], axis=1)
        return Instances(
            np.broadcast_to(np.asarray(number, np.int32), (size,)).copy(),
            ids,
            self.building[wall],
            np.column_stack([at, np.broadcast_to(z, (size,))]),
            rotation,
            factors.astype(np.float32),
            np.broadcast_to(np.asarray(tint, np.float32), (size, 3)).copy(),
        )

    def put(
        self,
        made: Prototype,
        ids: NDArray[np.uint64],
        building: NDArray[np.uint64],
        position: FloatArray,
        rotation: FloatArray,
        *,
        scale: FloatArray | None = None,
        tint: Any = 1.0,
    ) -> None:
        """Put a prototype anywhere, turned and scaled at will.

        Parameters
        ----------
        ids, building
            (k,) uint64 of the instances and of what they belong to.
        position, rotation
            (k, 3) metres, and XYZ Euler angles in radians.
        scale
            (k, 3), ones by default.
        tint
            (k, 3) linear RGB, or a number.
        """
        size = len(ids)
        if not size:
            return
        number = self._number(made.name, lambda **_: made)
        rows = Instances(
            np.full(size, number, np.int32),
            ids,
            building,
            position,
            np.asarray(rotation, np.float32),
            np.ones((size, 3), np.float32) if scale is None else np.asarray(scale, np.float32),
            np.broadcast_to(np.asarray(tint, np.float32), (size, 3)).copy(),
        )
        self.rows.append((made.kind, rows))

    def ids(self, purpose: str, wall: IntArray, index: Any) -> NDArray[np.uint64]:
        """Ids that follow from building, wall and `index` alone."""
        return hash_ids(0, purpose, self.building[wall] ^ self.key[wall], index)

    def layer(self, kind: str) -> tuple[list[Prototype], Instances]:
        """Return the rows of one kind, sorted by id, and all prototypes."""
        return list(self.prototypes.values()), joined([r for k, r in self.rows if k == kind])


def joined(tables: list[Instances]) -> Instances:
    """Join tables of instances, sorted by id."""
    if not tables:
        return no_instances()
    columns = (
        "prototype", "object_id", "owner", "position", "rotation", "scale", "tint",
    )  # fmt: skip
    data = {name: np.concatenate([getattr(t, name) for t in tables]) for name in columns}
    order = np.lexsort((data["prototype"], data["object_id"]))
    return Instances(**{name: values[order] for name, values in data.items()})


def used(prototypes: list[Prototype], rows: Instances) -> tuple[list[Prototype], Instances]:
    """Drop the prototypes that a table does not use."""
    from dataclasses import replace

    present, local = np.unique(rows.prototype, return_inverse=True)
    kept = [prototypes[number] for number in present.tolist()]
    return kept, replace(rows, prototype=local.astype(np.int32))
