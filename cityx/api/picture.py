"""A small picture of a city as it is, without an engine: what notebooks show beside the plan."""

from __future__ import annotations

from io import BytesIO
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from cityx.assets.styles.materials import material_named
from cityx.city.camera import Camera, project
from cityx.city.mesh import MeshBatch
from cityx.city.scene import Instances, Prototype
from cityx.city.store import View
from cityx.geometry.arrays import FloatArray
from cityx.geometry.compiled import compiled
from cityx.geometry.turns import matrices
from cityx.views.cameras import aerial_camera

SIZE = (520, 340)  # pixels
FINER = 2  # times as many pixels of an edge are drawn, against steps along edges
SHELLS = ("ground", "buildings", "decks", "structures", "surroundings")  # drawn as they are
# Layers whose rows are drawn as the box, or the crown, that their prototype fills.
BLOCKS = ("windows", "doors", "shopfronts", "vehicles")
CROWNS = ("trees",)
SKY, HAZE = (0.62, 0.75, 0.88), 6000.0  # linear colour, metres at which it hides two thirds
AMBIENT, SUNLIT = 0.55, 0.75  # light from the sky, and more of it towards the sun
NEAR = 1.0  # metres before the lens that nothing is drawn in
_CUBE = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)
_SIDES = np.array([[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [1, 5, 7, 3]])
_RING = np.column_stack([np.cos(np.arange(6) * np.pi / 3), np.sin(np.arange(6) * np.pi / 3)])


def picture_of(view: View, size: tuple[int, int] = SIZE) -> bytes:
    """Return a picture of a city from above as JPEG; b"" where there is nothing to see.

    Buildings and ground are drawn as they are; windows and vehicles as blocks and trees as crowns
    of the size and colour that they have; nothing throws a shadow.

    Parameters
    ----------
    view
        The city.
    size
        Pixels.
    """
    from PIL import Image

    if "buildings" not in view.scene.meshes and "ground" not in view.scene.meshes:
        return b""
    width, height = (FINER * edge for edge in size)
    camera = aerial_camera(view, width=width, height=height)
    corners, colors = _triangles(view)
    image = _drawn(camera, corners, colors * _light(view, corners)[:, None])
    encoded = np.where(image < 0.0031308, image * 12.92, 1.055 * image ** (1 / 2.4) - 0.055)
    picture = Image.fromarray(np.rint(encoded * 255).astype(np.uint8))
    out = BytesIO()
    picture.resize(size, Image.Resampling.BOX).save(out, "JPEG", quality=85)
    return out.getvalue()


def _triangles(view: View) -> tuple[FloatArray, FloatArray]:
    """Return (t, 3, 3) corners in metres and (t, 3) linear colours of what is drawn."""
    scene = view.scene
    corners, colors = [np.zeros((0, 3, 3))], [np.zeros((0, 3))]
    for layer in SHELLS:
        if layer in scene.meshes:
            batch = scene.meshes[layer]
            triangle, face = batch.triangles()
            corners.append(batch.vertices[triangle])
            colors.append(_colors(batch)[face])
    for layer in (*BLOCKS, *CROWNS):
        rows = scene.instances.get(layer)
        for number in np.unique(rows.prototype).tolist() if rows is not None else ():
            assert rows is not None
            of = np.flatnonzero(rows.prototype == number)
            shape, tone = _stand_in(scene.prototypes[number], crown=layer in CROWNS)
            corners.append(_placed(rows, of, shape))
            colors.append(np.repeat(np.clip(rows.tint[of], 0, 1) * tone, len(shape), axis=0))
    return np.nan_to_num(np.concatenate(corners)), np.clip(np.concatenate(colors), 0, 1)


def _colors(batch: MeshBatch) -> FloatArray:
    """(f, 3) linear colours of faces as they look from afar."""
    named = [material_named(name) for name in batch.materials]
    if not named:
        return np.zeros((len(batch.faces), 3))
    base = np.array([material.color for material in named], float)[batch.material]
    tinted = np.array([material.takes_tint for material in named])[batch.material]
    return np.asarray(base * np.where(tinted[:, None], np.nan_to_num(batch.tint, nan=1.0), 1.0))


def _stand_in(prototype: Prototype, *, crown: bool) -> tuple[FloatArray, FloatArray]:
    """Return (t, 3, 3) triangles of the box or crown of a prototype, and its mean colour."""
    mesh = prototype.mesh
    if not len(mesh.vertices):
        return np.zeros((0, 3, 3)), np.zeros(3)
    low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
    tone = np.asarray(_colors(mesh).mean(axis=0))
    if not crown:
        quads = (low + _CUBE * (high - low))[_SIDES]
        return np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]]), tone
    middle, radius = (low + high)[:2] / 2, (high - low)[:2] / 2
    rings = []
    for share, up in ((0.55, 0.25), (1.0, 0.5), (0.75, 0.8), (0.0, 1.0)):
        level = np.full(6, low[2] + up * (high[2] - low[2]))
        rings.append(np.column_stack([middle + _RING * radius * share, level]))
    sides = [
        np.stack([one[[k, (k + 1) % 6]], two[[(k + 1) % 6, k]]]).reshape(4, 3)
        for one, two in pairwise(rings) for k in range(6)
    ]  # fmt: skip
    quads = np.array(sides)
    return np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]]), tone


def _placed(rows: Instances, of: NDArray[np.int64], shape: FloatArray) -> FloatArray:
    turned = matrices(rows.rotation[of]) * rows.scale[of][:, None, :].astype(float)
    placed = np.einsum("nij,tcj->ntci", turned, shape) + rows.position[of][:, None, None, :]
    return np.asarray(placed.reshape(-1, 3, 3))


def _light(view: View, corners: FloatArray) -> FloatArray:
    """(t,) how bright triangles are, from 0 to 1 and some more, by the side that they turn."""
    environment = view.environment
    level = max(environment.sun_elevation, np.radians(25.0))  # at night too one sees the city
    azimuth = environment.sun_azimuth
    sun = np.array([np.sin(azimuth) * np.cos(level), np.cos(azimuth) * np.cos(level),
                    np.sin(level)])  # fmt: skip
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    length = np.linalg.norm(normal, axis=1)
    unit = normal / np.where(length > 0, length, 1.0)[:, None]
    return np.asarray(AMBIENT * (0.75 + 0.25 * unit[:, 2]) + SUNLIT * np.maximum(unit @ sun, 0))


def _drawn(camera: Camera, corners: FloatArray, colors: FloatArray) -> FloatArray:
    """Return (h, w, 3) linear colours of triangles, the nearest at each pixel."""
    width, height = camera.width, camera.height
    place, depth = project(camera, corners.reshape(-1, 3))
    place, depth = place.reshape(-1, 3, 2), depth.reshape(-1, 3)
    with np.errstate(invalid="ignore"):
        low = np.clip(np.ceil(place.min(axis=1) - 0.5), 0, (width, height))
        high = np.clip(np.floor(place.max(axis=1) - 0.5), -1, (width - 1, height - 1))
        span = np.nan_to_num(high - low + 1)
        one, two = place[:, 1] - place[:, 0], place[:, 2] - place[:, 0]
        front = one[:, 0] * two[:, 1] < one[:, 1] * two[:, 0]  # y runs down
    shown = np.flatnonzero(front & (depth.min(axis=1) > NEAR) & (span > 0).all(axis=1))
    place, depth, low = place[shown], depth[shown], low[shown].astype(np.int64)
    span = span[shown].astype(np.int64)
    plane = _planes(place, 1 / depth)
    nearest = np.zeros((height, width))  # of 1 / depth, which is linear on the picture
    which = np.full((height, width), -1, np.int64)
    _fill(plane, low, low + span, nearest, which)
    seen = which >= 0
    clear = np.exp(-1 / nearest[seen] / HAZE)[:, None]
    image = np.tile(np.array(SKY), (height, width, 1))
    image[seen] = colors[shown[which[seen]]] * clear + np.array(SKY) * (1 - clear)
    return np.clip(image, 0, 1)


def _planes(corner: FloatArray, close: FloatArray) -> FloatArray:
    """Return (n, 4, 3) linear functions of x, y and 1 on the picture, for each triangle.

    The first three are the shares of its corners, at least 0 inside, the last is 1 / depth.
    """
    a, b, c = corner[:, 0], corner[:, 1], corner[:, 2]
    one, two = b - a, c - a
    area = (one[:, 0] * two[:, 1] - one[:, 1] * two[:, 0])[:, None]
    second = np.column_stack([two[:, 1], -two[:, 0], a[:, 1] * two[:, 0] - a[:, 0] * two[:, 1]])
    third = np.column_stack([-one[:, 1], one[:, 0], a[:, 0] * one[:, 1] - a[:, 1] * one[:, 0]])
    shares = np.stack([second, third], axis=1) / area[:, None]
    first = np.array([0.0, 0.0, 1.0]) - shares.sum(axis=1)
    found = np.concatenate([first[:, None], shares], axis=1)
    return np.concatenate([found, np.einsum("nc,ncx->nx", close, found)[:, None]], axis=1)


@compiled
def _fill(
    plane: FloatArray, low: NDArray[np.int64], end: NDArray[np.int64], nearest: FloatArray,
    which: NDArray[np.int64],
) -> None:  # fmt: skip
    """Put triangles into a picture where they are the nearest."""
    for row in range(len(plane)):
        p = plane[row]
        for y in range(low[row, 1], end[row, 1]):
            for x in range(low[row, 0], end[row, 0]):
                u, v = x + 0.5, y + 0.5
                if (
                    p[0, 0] * u + p[0, 1] * v + p[0, 2] < 0
                    or p[1, 0] * u + p[1, 1] * v + p[1, 2] < 0
                    or p[2, 0] * u + p[2, 1] * v + p[2, 2] < 0
                ):
                    continue
                close = p[3, 0] * u + p[3, 1] * v + p[3, 2]
                if close > nearest[y, x]:
                    nearest[y, x] = close
                    which[y, x] = row
