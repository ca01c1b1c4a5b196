"""Facings of ground floors, at the finest level of detail part of the shells."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cityx.building.assembly import TRIM_MATERIAL
from cityx.building.facade.placing import Facing, Placing
from cityx.building.facade.slabs import Pieces, around, coursed, slabs
from cityx.building.growth import Piece
from cityx.city.mesh import MeshBatch
from cityx.geometry.polygons import FloatArray, IntArray

if TYPE_CHECKING:
    from cityx.building.facade.facade_plan import Facade

COURSE = 0.45  # metres, height of the courses of the material "stone"
# Metres that a facing stands out and by which its edges are chamfered.
STANDS_OUT = {"stone": (0.030, 0.014), "door_paint": (0.012, 0.0)}


def facing_pieces(batch: MeshBatch, placing: Placing, found: Facade) -> list[Piece]:
    """Make the facings that were asked for as closed slabs around the openings."""
    table = found.openings
    holes = Pieces(
        table.wall, table.along - table.width / 2, table.along + table.width / 2,
        table.low, table.low + table.height,
    )  # fmt: skip
    return [
        _made(batch, placing, found, facing, holes)
        for facing in placing.facings
        if len(facing.wall) and batch.count
    ]


def _made(
    batch: MeshBatch, placing: Placing, found: Facade, facing: Facing, holes: Pieces
) -> Piece:
    walls = found.walls
    out, chamfer = STANDS_OUT[facing.material]
    row, begin, finish = placing.faces.pieces(walls, facing.wall)
    wall = facing.wall[row]
    whole = Pieces(row, begin, finish, facing.low[row], facing.high[row])
    pieces = around(whole, wall, holes)
    if facing.material == "stone":
        zero = found.volumes.ground[walls.part[wall]]
        pieces = coursed(pieces, zero[pieces.source], COURSE)
    source = pieces.source
    wall, asked = wall[source], row[source]
    # Pieces at the ends of a wall run round the corner; a hair less than the other side's face.
    first = pieces.x0 < 1e-6
    last = pieces.x1 > walls.length[wall] - 1e-6
    ends = [
        pieces.x0 - np.where(first, 0.97 * out * facing.before[asked], 0.0),
        pieces.x1 + np.where(last, 0.97 * out * facing.after[asked], 0.0),
    ]
    feet = []
    for along, inside in zip(ends, (pieces.x0, pieces.x1), strict=True):
        stand = placing.faces.before(walls, wall, inside)
        foot = walls.start[wall] + placing.unit[wall] * along[:, None]
        feet.append(foot + walls.normal[wall] * stand[:, None])
    vertices, faces = slabs(
        feet[0], feet[1], walls.normal[wall], pieces.z0, pieces.z1, out, chamfer
    )
    uv = _texture(found, wall, ends, pieces)
    owner = np.searchsorted(batch.object_id, placing.building[wall]).clip(max=batch.count - 1)
    known = batch.object_id[owner] == placing.building[wall]
    vertices, uv, owner = vertices[known], uv[known], owner[known]
    count, corners, sides = len(vertices), vertices.shape[1], len(faces)
    shift = len(batch.vertices) + corners * np.arange(count)
    # Undersides count as trim, so that they are no ground that the building covers.
    kinds = np.zeros(sides, np.int16)
    kinds[0] = 1
    return Piece(
        vertices.reshape(-1, 3), np.repeat(owner, corners),
        (faces[None] + shift[:, None, None]).reshape(-1, 4), np.repeat(owner, sides),
        np.tile(kinds, count), (facing.material, TRIM_MATERIAL),
        uv.reshape(-1, 4, 2), np.repeat(facing.tint[asked[known]], sides, axis=0),
    )  # fmt: skip


def _texture(
    found: Facade, wall: IntArray, ends: list[FloatArray], pieces: Pieces
) -> NDArray[np.float32]:
    """(p, 10, 4, 2) metres along the ring and above the ground."""
    along = found.walls.along[wall]
    zero = found.volumes.ground[found.walls.part[wall]]
    u0, u1 = along + ends[0], along + ends[1]
    v0, v1 = pieces.z0 - zero, pieces.z1 - zero
    uv = np.zeros((len(wall), 10, 4, 2), np.float32)
    for face, (low, high) in enumerate(
        ((v0, v0), (v0, v0), (v0, v1), (v1, v1), (v1, v1), (v0, v1))
    ):
        uv[:, face, :, 0] = np.stack([u0, u1, u1, u0], 1)
        uv[:, face, :, 1] = np.stack([low, low, high, high], 1)
    return uv
