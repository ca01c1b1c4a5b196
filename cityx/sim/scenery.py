"""The scenery: what cameras of the simulator see of a city, made once and kept beside its world."""

from __future__ import annotations

import json
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cityx.geometry.arrays import FloatArray, IntArray

SCENERY_VERSION = 2  # rises when a city gives another scenery, or files of it another form
# Kinds of figures: those of vehicles are `cityx.sim.dynamics.DRIVEN`, then come travellers.
PERSON, ROBOT, WHEELCHAIR, DRONE = 10, 11, 12, 20
LAMPS = {"signal_stop": 1, "signal_amber": 2, "signal_green": 4}  # bits by material
POSES = 8  # of a cycle of walking; one more stands


@dataclass(frozen=True)
class Scenery:
    """Meshes of a city and of what moves in it: m meshes, t triangles, n things, o objects.

    Attributes
    ----------
    root
        (m,) int64, code of the root of each mesh's tree.
    box, child, corner
        Trees and their triangles, see `cityx.geometry.bvh`; (t, 3, 3) float32 corners, metres in
        the frame of the mesh.
    bounds
        (m, 6) float32, lower and upper corner of each mesh.
    face_part
        (t,) int32, which object of its thing a triangle belongs to.
    face_colour
        (t, 3) uint8, square root of the linear colour times 255.
    face_tinted
        (t,) bool, whether the tint of the thing multiplies it.
    face_lamp
        (t,) uint8, which lamp of a signal it is, of `LAMPS`; 0 for none.
    thing_way
        (n, 3, 4) float64, from the frame of the mesh of each thing to that of the city.
    thing_object
        (n,) int64, first row of its objects.
    thing_tint
        (n, 3) float32, linear.
    cluster_thing, cluster_node
        (c,) parts of things, and the node of the mesh under which each is.
    top_box, top_child, top_order
        Tree over the clusters; its root is in `about`.
    object_id, object_class
        (o,) uint64 as in masks and reports, and uint8 into `cityx.dataset.classes.CLASSES`.
    figure_mesh, figure_kind, figure_class
        (f,) meshes of what moves: which, whose (a vehicle, or `PERSON` and so on), and its class.
    figure_size
        (f, 3) metres: length, width and height.
    figure_stride
        (f,) metres of a cycle of two steps; the figure and the `POSES` after it are its poses.
    paint
        (p, 3) float32, linear, of vehicles.
    prop_thing, prop_bounds, prop_mass
        (q,) things that can be pushed, (q, 6) bounds of their meshes, and kilograms.
    shade_frame, shade
        (5,) west, south, metres of a cell, columns and rows, and (h, w) float32: the height up to
        which no sun comes.
    about
        Text (JSON) with "name", "hash", "version", "top_root" and "light".
    """

    root: IntArray
    box: NDArray[np.float32]
    child: IntArray
    corner: NDArray[np.float32]
    bounds: NDArray[np.float32]
    face_part: NDArray[np.int32]
    face_colour: NDArray[np.uint8]
    face_tinted: NDArray[np.bool_]
    face_lamp: NDArray[np.uint8]
    thing_way: FloatArray
    thing_object: IntArray
    thing_tint: NDArray[np.float32]
    cluster_thing: NDArray[np.int32]
    cluster_node: IntArray
    top_box: NDArray[np.float32]
    top_child: IntArray
    top_order: NDArray[np.int32]
    object_id: NDArray[np.uint64]
    object_class: NDArray[np.uint8]
    figure_mesh: IntArray
    figure_kind: IntArray
    figure_class: NDArray[np.uint8]
    figure_size: FloatArray
    figure_stride: FloatArray
    paint: NDArray[np.float32]
    prop_thing: IntArray
    prop_bounds: FloatArray
    prop_mass: FloatArray
    shade_frame: FloatArray
    shade: NDArray[np.float32]
    about: NDArray[np.str_]

    @cached_property
    def facts(self) -> dict[str, Any]:
        """What `about` says."""
        found: dict[str, Any] = json.loads(str(self.about[0]))
        return found
