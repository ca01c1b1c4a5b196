"""Surface and height of the ground under points."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cityx.city.ground import LABEL, SURFACES, UNDRAPED, Ground
from cityx.city.mesh import NO_VERTEX, MeshBatch
from cityx.geometry.arrays import FloatArray
from cityx.geometry.triangle_cells import (
    TriangleCells,
    cells_of_triangles,
    triangle_at,
    triangles_at,
)
from cityx.ids import stable_id
from cityx.system.remembered import Remembered

NOWHERE = -1  # label beyond the ground, and under buildings, where the mesh is open
# Surfaces people walk on, beside those that cars share.
WALKED = ("sidewalk", "kerb", "plaza", "path", "courtyard", "trail", "furnishing", "gravel",
          "edging", "frontage")  # fmt: skip
LAWNS = ("grass", "park", "meadow", "block")
EARTH = "grass"  # material of slopes heaped against ramps
FLAT = 1e-9  # square metres in plan; what covers less stands upright


@dataclass(frozen=True)
class Footing:
    """What n points stand on.

    Attributes
    ----------
    label
        (n,) int64 into `cityx.city.ground.SURFACES`, `NOWHERE` where there is no ground.
    z
        (n,) float64, metres; NaN where there is no ground.
    face
        (n,) int64, face of the mesh, `NOWHERE` where there is no ground.
    """

    label: NDArray[np.int64]
    z: FloatArray
    face: NDArray[np.int64]


def stand_on(ground: MeshBatch | None, xy: ArrayLike) -> Footing:
    """Return surface and height of the draped ground under (n, 2) points.

    Parameters
    ----------
    ground
        The mesh layer "ground": an object per surface, its tops triangles.
    xy
        (n, 2) float, metres.
    """
    spots = np.asarray(xy, float).reshape(-1, 2)
    label = np.full(len(spots), NOWHERE, np.int64)
    z = np.full(len(spots), np.nan)
    under = np.full(len(spots), NOWHERE, np.int64)
    if ground is None or not ground.count or not len(spots):
        return Footing(label, z, under)
    tops = _LAST.get(lambda: _tops_of_mesh(ground), [ground.vertices])
    found = tops.at(spots)
    hit = np.flatnonzero(found >= 0)
    known = {stable_id("ground", surface.name): i for i, surface in enumerate(SURFACES)}
    labels = np.array([known.get(int(own), NOWHERE) for own in ground.object_id])
    face = tops.faces[found[hit]]
    own = np.searchsorted(ground.face_start, face, side="right") - 1
    label[hit], under[hit] = labels[own], face
    z[hit] = heights_on(ground.vertices[ground.faces[face, :3]], spots[hit])
    return Footing(label, z, under)


def surfaces_at(
    batch: MeshBatch | None, xy: FloatArray, *, material: str = ""
) -> tuple[NDArray[np.int64], FloatArray]:
    """Find where vertical lines through (n, 2) places meet a mesh.

    Parameters
    ----------
    batch
        The mesh; none of it is met by no line.
    xy
        (n, 2) float, metres.
    material
        Of the faces that count; all when left out.

    Returns
    -------
    place, height
        (h,) int64 rows of ``xy``, and (h,) metres.
    """
    if batch is None or not len(xy):
        return np.zeros(0, np.int64), np.zeros(0)
    triangles, face = batch.triangles()
    if material:
        own = np.array(batch.materials, object)[batch.material] == material
        triangles = triangles[own[face]]
    corners = batch.vertices[triangles]
    u, v = (corners[:, 1] - corners[:, 0])[:, :2], (corners[:, 2] - corners[:, 0])[:, :2]
    corners = corners[np.abs(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]) > FLAT]
    if not len(corners):
        return np.zeros(0, np.int64), np.zeros(0)
    faces = cells_of_triangles(
        corners[:, :, :2].reshape(-1, 2), np.arange(3 * len(corners), dtype=np.int32).reshape(-1, 3)
    )
    spot, hit = (np.concatenate(column) for column in zip(*triangles_at(xy, faces), strict=True))
    return spot, heights_on(corners[hit], xy[spot])


def earth_over(structures: MeshBatch | None, xy: FloatArray) -> FloatArray:
    """Return (n,) heights of the slopes of earth at points, metres; NaN where there is none.

    Parameters
    ----------
    structures
        The mesh layer of that name.
    xy
        (n, 2) float, metres.
    """
    top = np.full(len(xy), np.nan)
    spot, height = surfaces_at(structures, xy, material=EARTH)
    np.fmax.at(top, spot, height)
    return top


def heights_on(corners: FloatArray, xy: FloatArray) -> FloatArray:
    """Return (n,) heights at (n, 2) places on the planes of (n, 3, 3) triangles."""
    a, b, c = corners.transpose(1, 0, 2)
    u, v, w = (b - a)[:, :2], (c - a)[:, :2], xy - a[:, :2]
    area = u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]
    area = np.where(np.abs(area) < 1e-12, 1.0, area)
    s = (w[:, 0] * v[:, 1] - w[:, 1] * v[:, 0]) / area
    t = (u[:, 0] * w[:, 1] - u[:, 1] * w[:, 0]) / area
    return np.asarray(a[:, 2] + s * (b - a)[:, 2] + t * (c - a)[:, 2])


@dataclass(frozen=True)
class _Tops:
    """The k top faces of the ground's mesh, and the triangles by which they are found.

    Attributes
    ----------
    faces
        (k,) int64, rows of the mesh, rising.
    cells
        The t triangles.
    number
        (t,) int64, the top face that each triangle is, -1 for none; None where they are the same.
    """

    faces: NDArray[np.int64]
    cells: TriangleCells
    number: NDArray[np.int64] | None = None

    def at(self, spots: FloatArray) -> NDArray[np.int64]:
        """(n,) the last top face that holds each of (n, 2) points, -1 for none."""
        if self.number is None:
            return triangle_at(spots, self.cells)
        found = np.full(len(spots), NOWHERE, np.int64)
        for spot, triangle in triangles_at(spots, self.cells, self.number >= 0):
            np.maximum.at(found, spot, self.number[triangle])
        return found


_LAST: Remembered[_Tops] = Remembered()


def _top_faces(mesh: MeshBatch) -> NDArray[np.int64]:
    return np.flatnonzero(mesh.faces[:, 3] == NO_VERTEX)


def _tops_of_mesh(mesh: MeshBatch) -> _Tops:
    faces = _top_faces(mesh)
    return _Tops(faces, cells_of_triangles(mesh.vertices[:, :2], mesh.faces[faces, :3]))


def find_by_ground(ground: Ground, mesh: MeshBatch) -> None:
    """Let `stand_on` find the top faces of a mesh by the triangles of the ground that it shows.

    These are looked up by others as well, also by copies of this process that are begun later, and
    are prepared now, once for all.

    Parameters
    ----------
    ground
        The arrangement.
    mesh
        What `cityx.ground.drape.drape` made of it.
    """
    label = ground.face_label[ground.triangle_face]
    order = np.argsort(label, kind="stable")
    order = order[~np.isin(label[order], [LABEL[name] for name in UNDRAPED])]
    number = np.full(len(label), NOWHERE, np.int64)
    number[order] = np.arange(len(order))
    _LAST.get(lambda: _Tops(_top_faces(mesh), ground.cells, number), [mesh.vertices])
