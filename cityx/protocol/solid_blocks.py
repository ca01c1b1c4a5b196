"""Blocks: outlines raised to closed meshes, the first thing a building plugin needs."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
import shapely
from numpy.typing import ArrayLike, NDArray

from cityx.city.mesh import NO_VERTEX, MeshBatch, concatenate

if TYPE_CHECKING:
    from cityx.geometry.solids import Solids

WALL, ROOF = 0, 1  # rows of the materials of a block


def block(
    ring: ArrayLike,
    height: float,
    *,
    holes: Sequence[ArrayLike] = (),
    base: float = 0.0,
    wall: str = "plaster",
    roof: str = "bitumen",
) -> MeshBatch:
    """Raise an outline to a closed block.

    Parameters
    ----------
    ring
        (k, 2) outer ring, metres.
    height
        Metres from base to top.
    holes
        Rings of courtyards.
    base
        Height of the lower face.
    wall, roof
        Names of materials.

    Returns
    -------
    mesh
        One object of id 0; the runner gives it the id of the thing it was made for.
    """
    shape = shapely.Polygon(np.asarray(ring), [np.asarray(hole) for hole in holes])
    return raise_outlines(np.array([shape], object), [base], [base + height], wall=wall, roof=roof)


def one_object(pieces: Iterable[MeshBatch]) -> MeshBatch:
    """Join meshes to one object of id 0."""
    joined = concatenate(pieces)
    return replace(
        joined,
        object_id=np.zeros(1, np.uint64),
        vertex_start=np.array([0, len(joined.vertices)], np.int64),
        face_start=np.array([0, len(joined.faces)], np.int64),
    )


def raise_outlines(
    outlines: NDArray[Any],
    low: ArrayLike,
    high: ArrayLike,
    *,
    object_id: ArrayLike = 0,
    wall: str = "plaster",
    roof: str = "bitumen",
) -> MeshBatch:
    """Raise n outlines to closed blocks, one object each, in their order.

    Parameters
    ----------
    outlines
        (n,) valid shapely Polygons that enclose an area.
    low, high
        (n,) heights of foot and top, metres.
    object_id
        (n,) ids.
    wall, roof
        Names of materials.
    """
    from cityx.geometry.extrude import prisms

    count = len(outlines)
    foot = np.broadcast_to(np.asarray(low, float), (count,))
    top = np.broadcast_to(np.asarray(high, float), (count,))
    solids, _ = prisms(outlines, foot, top, foot)
    ids = np.broadcast_to(np.asarray(object_id, np.uint64), (count,)).copy()
    return packed(solids, ids, (wall, roof))


def packed(solids: Solids, ids: NDArray[np.uint64], materials: tuple[str, str]) -> MeshBatch:
    """Return solids as meshes, one object per part with its id, of materials of wall and roof."""
    vertex_order = np.argsort(solids.vertex_part, kind="stable")
    face_order = np.argsort(solids.face_part, kind="stable")
    number = np.empty(len(vertex_order), np.int64)
    number[vertex_order] = np.arange(len(vertex_order))
    faces = solids.faces[face_order]
    rows = np.arange(len(ids) + 1)
    return MeshBatch(
        ids,
        np.searchsorted(solids.vertex_part[vertex_order], rows).astype(np.int64),
        np.searchsorted(solids.face_part[face_order], rows).astype(np.int64),
        solids.vertices[vertex_order],
        np.where(faces == NO_VERTEX, NO_VERTEX, number[faces]).astype(np.int32),
        np.where(solids.role[face_order] == ROOF, ROOF, WALL).astype(np.int16),
        materials,
        solids.uv[face_order].astype(np.float32),
        np.ones((len(faces), 3), np.float32),
    )
