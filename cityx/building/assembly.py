"""Assembly: solids of parts become one mesh object per building."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cityx.city.mesh import MeshBatch
from cityx.geometry.solids import GLAZED, NO_VERTEX, ROOF, TRIM, Solids
from cityx.places.profiles import profile_of

if TYPE_CHECKING:
    from cityx.assets.styles.palettes import Finishes
    from cityx.city.city import City

TRIM_MATERIAL = "trim"
GLASS_MATERIAL = "glass_wall"  # of the upright faces of sawtooth roofs


def finishes_of(city: City) -> Finishes:
    """Return materials and tints of every part of the city."""
    from cityx.assets.styles.palettes import finishes_for
    from cityx.building.catalogue import generators
    from cityx.building.selection import designs_of_parts

    local = profile_of(city.frame).buildings
    design = designs_of_parts(city)
    return finishes_for(city.layout, city.seed, design, generators(), style=city.style, local=local)


LEVEL, SOILED = 0.95, 0.45  # copings and ledges this level keep so much of their lightness


def assemble(solids: Solids, building: NDArray[np.uint64], finishes: Finishes) -> MeshBatch:
    """Group parts into objects, one per building, sorted by id.

    Parameters
    ----------
    solids
        Shells of n parts; parts without faces add nothing.
    building
        (n,) uint64, building of each part.
    finishes
        Materials and tints of the n parts.
    """
    present = np.zeros(len(building), bool)
    present[solids.face_part] = True
    ids = np.unique(building[present])
    owner = np.searchsorted(ids, building)  # object of each part
    vertex_owner, face_owner = owner[solids.vertex_part], owner[solids.face_part]
    vertex_order = np.lexsort((solids.vertex_part, vertex_owner))
    face_order = np.lexsort((solids.face_part, face_owner))
    number = np.empty(len(vertex_order), np.int64)
    number[vertex_order] = np.arange(len(vertex_order))
    corners = solids.faces[face_order]
    faces = np.where(corners == NO_VERTEX, NO_VERTEX, number[corners]).astype(np.int32)
    names, material_of = _material_table(finishes)
    role = solids.role[face_order].astype(np.int64)
    part = solids.face_part[face_order]
    clear = np.ones_like(np.asarray(finishes.wall_tint, np.float32))
    tints = np.stack(
        [
            np.asarray(tint, np.float32).reshape(-1, 3)
            for tint in (finishes.wall_tint, finishes.roof_tint, finishes.trim_tint, clear)
        ]
    )  # (4, n, 3), in the order of the roles
    material, names = _used(material_of[role, part], names)
    vertices, tint = solids.vertices[vertex_order], tints[role, part]
    trims = np.flatnonzero(role == TRIM)
    one, two, three = vertices[faces[trims, :3]].transpose(1, 0, 2)
    normal = np.cross(two - one, three - one)
    level = normal[:, 2] > LEVEL * np.linalg.norm(normal, axis=1)
    tint[trims[level]] *= SOILED
    return MeshBatch(
        ids,
        _starts(vertex_owner, len(ids)),
        _starts(face_owner, len(ids)),
        vertices,
        faces,
        material,
        names,
        solids.uv[face_order],
        tint,
    )


def _starts(owner: NDArray[np.int64], count: int) -> NDArray[np.int64]:
    return np.concatenate([[0], np.cumsum(np.bincount(owner, minlength=count))]).astype(np.int64)


def _used(
    material: NDArray[np.int64], names: tuple[str, ...]
) -> tuple[NDArray[np.int16], tuple[str, ...]]:
    """Drop the names of materials that no face has."""
    present = np.bincount(material, minlength=len(names)) > 0
    number = np.cumsum(present) - 1
    kept = tuple(name for name, used in zip(names, present.tolist(), strict=True) if used)
    return number[material].astype(np.int16), kept


def _material_table(finishes: Finishes) -> tuple[tuple[str, ...], NDArray[np.int64]]:
    """Names of all materials and the one of each (role, part)."""
    wall = np.asarray(finishes.wall_material, dtype=str)
    roof = np.asarray(finishes.roof_material, dtype=str)
    words = np.concatenate(
        [wall, roof, np.full(len(wall), TRIM_MATERIAL), np.full(len(wall), GLASS_MATERIAL)]
    )
    names, index = np.unique(words, return_inverse=True)
    table = np.asarray(index, np.int64).reshape(4, -1)
    order = [0] * 4
    order[ROOF], order[TRIM], order[GLAZED] = 1, 2, 3
    return tuple(str(name) for name in names), table[order]
