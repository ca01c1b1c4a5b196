"""Measures of meshes: closedness, volume, ground covered, faults of faces."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from cityx.city.mesh import MeshBatch
from cityx.geometry.arrays import FloatArray
from cityx.geometry.solids import (
    LEVEL,
    MIN_FACE,
    area_vectors,
    face_areas,
    open_groups,
    surely_open,
    volumes_by_group,
)


def check_closed(batch: MeshBatch) -> NDArray[np.bool_]:
    """Return for each object whether every directed edge has its reverse exactly once.

    Vertices count as they are indexed; positions are not welded. An object without faces is open.

    Returns
    -------
    closed
        (k,) bool.
    """
    vertices = max(len(batch.vertices), 1)
    found = surely_open(batch.faces, batch.face_start, vertices)
    owner = batch.face_object()
    asked = ~found[owner]
    found |= open_groups(batch.faces[asked], owner[asked], vertices, batch.count)
    return ~found & (np.diff(batch.face_start) > 0)


def volume(batch: MeshBatch) -> FloatArray:
    """Return the signed volume of each object, (k,) cubic metres; positive means outward faces."""
    return volumes_by_group(batch.vertices, batch.faces, batch.face_object(), batch.count)


def _undersides(
    batch: MeshBatch, without: Sequence[str], below: FloatArray | None
) -> tuple[FloatArray, NDArray[np.bool_]]:
    """Return the area vector of each face, (f, 3), and which are level undersides, (f,)."""
    normal = area_vectors(batch.vertices, batch.faces)
    size = np.linalg.norm(normal, axis=1)
    under = -normal[:, 2] > LEVEL * size
    skipped = [i for i, name in enumerate(batch.materials) if name in without]
    if below is not None:
        under &= batch.vertices[batch.faces[:, 0], 2] < below[batch.face_object()]
    return normal, np.asarray(under & ~np.isin(batch.material, skipped))


def plan_area(
    batch: MeshBatch, *, without: Sequence[str] = ("trim",), below: FloatArray | None = None
) -> FloatArray:
    """Return the ground that each object covers, (k,) square metres.

    The level undersides are summed, so eaves (whose material is named in `without`), domes that
    bulge and roofs cut into many faces do not count twice.

    Parameters
    ----------
    without
        Materials whose faces do not count.
    below
        (k,) metres, height of each object below which undersides count; all do when left out.
    """
    normal, counted = _undersides(batch, without, below)
    area = np.bincount(batch.face_object()[counted], -normal[counted, 2], minlength=batch.count)
    return np.asarray(area, float)


def plan_middle(
    batch: MeshBatch, *, without: Sequence[str] = ("trim",), below: FloatArray | None = None
) -> FloatArray:
    """Return the middle of the ground that each object covers, (k, 2) metres; NaN for none.

    It is the centroid of the level undersides, see `plan_area`.
    """
    counted = _undersides(batch, without, below)[1]
    triangles, face = batch.triangles()
    kept = counted[face]
    a, b, c = batch.vertices[triangles[kept], :2].transpose(1, 0, 2)
    u, v = b - a, c - a
    weight = np.abs(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0])
    owner = batch.face_object()[face[kept]]
    sums = [
        np.bincount(owner, values, minlength=batch.count)
        for values in (weight, *(weight[:, None] * (a + b + c) / 3).T)
    ]
    total = np.where(sums[0] > 0, sums[0], np.nan)
    return np.column_stack([sums[1] / total, sums[2] / total])


def degenerate_faces(batch: MeshBatch, *, smallest: float = MIN_FACE) -> NDArray[np.bool_]:
    """Mark the faces smaller than `smallest` square metres, (f,) bool."""
    return np.asarray(face_areas(batch.vertices, batch.faces) < smallest)


def has_nan(batch: MeshBatch) -> NDArray[np.bool_]:
    """Return for each object whether a coordinate of a vertex or of its texture is not finite."""
    bad = np.zeros(batch.count, bool)
    owner = np.repeat(np.arange(batch.count), np.diff(batch.vertex_start))
    bad[owner[~np.isfinite(batch.vertices).all(axis=1)]] = True
    bad[batch.face_object()[~np.isfinite(batch.uv).all(axis=(1, 2))]] = True
    return bad
