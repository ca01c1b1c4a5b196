"""Outskirts: the site mirrored across its borders, so that pictures do not end at a bare plain.

A street that leaves the site meets its own image, so carriageways, rows of houses, parks and water
go on without a seam. The copies are instances of what the scene holds: they cost next to no memory,
belong to no city, are in no file, and are hidden where a picture is read as truth.
"""

from __future__ import annotations

from math import radians
from typing import TYPE_CHECKING, Any

import bpy
import numpy as np
from mathutils import Matrix
from numpy.typing import NDArray

from cityx.blender.scene import LAYER
from cityx.city.camera import Camera
from cityx.geometry.mirrored import Image, images, near

if TYPE_CHECKING:
    from cityx.city.store import View

NAME = "Outskirts"
# Points are copied as a whole: layers that show from afar, while they are no more than so many.
AFAR = ("trees", "vehicles", "street_furniture")
MOST_ROWS = 12_000
SURROUNDINGS = "surroundings"  # layer of the plain, which the copies' ground replaces
SUNK = 1.5  # metres by which it sinks below them, deeper than water lies
MAP_PITCH = radians(-75.0)  # a camera that looks down like a map shows the site alone

FloatArray = NDArray[np.float64]


class Outskirts:
    """The images of one scene's site: a class because they are made once and shown or hidden.

    Parameters
    ----------
    scene
        A scene made by `cityx.blender.scene`.
    view
        The city it was made from. Where its terrain is not level, or it has no land round it,
        there are no images: the land beyond is that of the height file.
    """

    def __init__(self, scene: bpy.types.Scene, view: View) -> None:
        self.items: list[bpy.types.Object] = []
        self.plain = [o for o in scene.objects if o.get(LAYER) == SURROUNDINGS]
        if view.lod < 1 or not self.plain or not view.terrain.is_flat:
            return
        solid, afar = _sources(scene, view)
        boxes = np.array([_box(item) for item in solid]).reshape(-1, 4)
        held = bpy.data.collections.new(NAME)
        scene.collection.children.link(held)
        for number, mirrored in enumerate(images(view.extent)):
            chosen = [solid[i] for i in np.flatnonzero(near(mirrored, boxes, view.extent)).tolist()]
            if not chosen:
                continue
            source = bpy.data.collections.new(f"{NAME} {number}")
            for item in [*chosen, *afar]:
                source.objects.link(item)
            image = bpy.data.objects.new(f"{NAME} {number}", None)
            image.instance_type, image.instance_collection = "COLLECTION", source
            image.matrix_world = _matrix(mirrored)
            held.objects.link(image)
            self.items.append(image)

    def show(self, camera: Camera | None) -> None:
        """Show the images to a camera, unless it looks straight down; None hides them."""
        shown = camera is not None and camera.pitch > MAP_PITCH
        for item in self.items:
            item.hide_render = item.hide_viewport = not shown
        for item in self.plain if self.items else ():
            item.location.z = -SUNK if shown else 0.0


def _sources(scene: bpy.types.Scene, view: View) -> tuple[list[Any], list[Any]]:
    """Return the meshes of the site and the points of layers that show from afar."""
    solid = [o for o in scene.objects if o.get(LAYER) in view.scene.meshes and o.type == "MESH"
             and o.get(LAYER) != SURROUNDINGS]  # fmt: skip
    counts = {layer: rows.count for layer, rows in view.scene.instances.items()}
    afar = [o for o in scene.objects if o.name in AFAR and counts.get(o.name, 0) < MOST_ROWS]
    return solid, afar


def _matrix(image: Image) -> Matrix:
    """Return the transform of an image."""
    scale = Matrix.Diagonal((*image.sign.tolist(), 1.0, 1.0))
    return Matrix.Translation((*image.shift.tolist(), 0.0)) @ scale


def _box(item: bpy.types.Object) -> tuple[float, float, float, float]:
    """Return xmin, ymin, xmax, ymax of an object that is moved but not turned; metres."""
    corners = np.array(item.bound_box)[:, :2] + np.array(item.location)[:2]
    (xmin, ymin), (xmax, ymax) = corners.min(axis=0).tolist(), corners.max(axis=0).tolist()
    return xmin, ymin, xmax, ymax
