"""Tops of a world: how high the highest thing over each place reaches, and which it is."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cityx.city.city import City
from cityx.city.scene import Instances, Prototype
from cityx.city.thing_outlines import placed_rings
from cityx.geometry.arrays import FloatArray, IntArray
from cityx.sim.kernels import rasters as kernels

CELL = 0.5  # metres
# Kinds of things that lie within a wall, or go with a car that stands for them.
WITHIN = ("window", "trim", "door", "shopfront", "street_cover", "vehicle_part")
HANGS = ("wires", "power_lines", "surroundings")  # layers too thin for a raster, or far away


def tops_of(
    city: City,
) -> tuple[FloatArray, NDArray[np.float32], NDArray[np.int32], NDArray[np.uint64]]:
    """Return the arrays ``top_*`` of `cityx.sim.walks.Walks`; things count as their boxes."""
    west, south, east, north = city.layout.extent
    frame = np.array([west, south, CELL, max(np.ceil((east - west) / CELL), 1),
                      max(np.ceil((north - south) / CELL), 1)])  # fmt: skip
    height = np.full((int(frame[4]), int(frame[3])), np.nan, np.float32)
    row = np.full(height.shape, -1, np.int32)
    ids: list[NDArray[np.uint64]] = []
    for layer, batch in city.scene.meshes.items():
        if layer in HANGS or not len(batch.faces):
            continue
        faces, of_face = batch.triangles()
        owner = batch.face_object()[of_face]
        _draw(height, row, frame, np.asarray(batch.vertices), faces, owner, ids)
        ids.append(batch.object_id)
    for rows in city.scene.instances.values():
        for number in np.unique(rows.prototype).tolist():
            one = city.scene.prototypes[number]
            if one.kind in WITHIN or not len(one.mesh.faces):
                continue
            of = np.flatnonzero(rows.prototype == number)
            corners, owner = _boxes(one, rows, of)
            faces = np.arange(4 * len(of)).reshape(-1, 4)[:, [0, 1, 2, 0, 2, 3]].reshape(-1, 3)
            _draw(height, row, frame, corners, faces, owner, ids)
            ids.append(rows.object_id[of])
    return frame, height, row, np.concatenate([np.zeros(0, np.uint64), *ids])


def _draw(
    height: NDArray[np.float32], row: NDArray[np.int32], frame: FloatArray, vertices: FloatArray,
    faces: NDArray[np.generic], owner: IntArray, ids: list[NDArray[np.uint64]],
) -> None:  # fmt: skip
    shift = sum(len(each) for each in ids)
    kernels.draw_tops(height, row, frame, vertices, faces, owner.astype(np.int64) + shift)


def _boxes(one: Prototype, rows: Instances, of: IntArray) -> tuple[FloatArray, IntArray]:
    """(4 n, 3) upper corners of the boxes about things, and (2 n,) which of them a triangle has."""
    low, high = one.mesh.vertices.min(axis=0), one.mesh.vertices.max(axis=0)
    ring = np.array([[low[0], low[1]], [high[0], low[1]], [high[0], high[1]], [low[0], high[1]]])
    scale, at = np.asarray(rows.scale[of], float), np.asarray(rows.position[of])
    corners = placed_rings(ring, at[:, :2], rows.rotation[of, 2], scale)
    top = high[2] * scale[:, 2] + at[:, 2]
    whole = np.concatenate([corners, np.repeat(top[:, None, None], 4, axis=1)], axis=2)
    return whole.reshape(-1, 3), np.repeat(np.arange(len(of)), 2)
