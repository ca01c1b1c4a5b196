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
from cityx.city.ground import LABEL
from cityx.geometry.mirrored import Box, Image, built_up, folded, images, near
from cityx.geometry.standing import stand_on

if TYPE_CHECKING:
    from cityx.city.store import View

NAME = "Outskirts"
# Points are copied as a whole: layers that show from afar, while they are no more than so many.
AFAR = ("trees", "vehicles", "street_furniture")
MOST_ROWS = 12_000
SURROUNDINGS = "surroundings"  # layer of the plain, which the copies' ground replaces
SUNK = 1.5  # metres by which it sinks below them, deeper than water lies
FEWEST = 20  # buildings of a site whose margin is filled
STEPS = (0.0, 17.0, -17.0, 34.0, -34.0)  # metres by which copies are moved to fill what is left
BUILDABLE = ("block", "courtyard", "grass", "parking", "plaza", "sidewalk", "furnishing")
MAP_PITCH = radians(-75.0)  # a camera that looks down like a map shows the site alone

FloatArray = NDArray[np.float64]


def may_stand(view: View, placed: FloatArray, known: Box) -> NDArray[np.bool_]:
    """(n,) whether copies of buildings would stand on empty land of the margin or of its images.

    Parameters
    ----------
    view
        The city.
    placed
        (n, 4) boxes of the copies, metres.
    known
        Box in which its buildings lie; what is beyond is margin.
    """
    share = np.array([(x, y) for x in (0.1, 0.5, 0.9) for y in (0.1, 0.5, 0.9)])
    spots = placed[:, None, :2] + share * (placed[:, None, 2:] - placed[:, None, :2])
    spots = folded(spots.reshape(-1, 2), view.extent)
    good = ((spots < known[:2]) | (spots > known[2:])).any(axis=1)
    under = stand_on(view.scene.meshes.get("ground"), spots)
    good &= np.isin(under.label, [LABEL[name] for name in BUILDABLE])
    return np.asarray(good.reshape(len(placed), len(share)).all(axis=1))


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
        self._fill(view, solid, boxes, held)

    def _fill(
        self, view: View, solid: list[Any], boxes: FloatArray, held: bpy.types.Collection
    ) -> None:
        """Put copies of buildings into the margin of the site that the map leaves empty."""
        rows = np.array([i for i, o in enumerate(solid) if o[LAYER] == "buildings"], np.int64)
        if len(rows) < FEWEST:
            return
        known = built_up(boxes[rows])
        margin = float(np.abs(np.array(known) - np.array(view.extent)).max())
        taken = np.zeros((0, 4))
        shifted = (image.moved(step) for step in STEPS for image in images(known, margin))
        for mirrored in shifted:
            chosen = rows[near(mirrored, boxes[rows], known, 2 * margin)]
            chosen = chosen[may_stand(view, mirrored.placed(boxes[chosen]), known)]
            for index in chosen.tolist():
                box = mirrored.placed(boxes[index])
                if ((box[:, :2] < taken[:, 2:]) & (box[:, 2:] > taken[:, :2])).all(axis=1).any():
                    continue
                taken = np.concatenate([taken, box])
                image = bpy.data.objects.new(f"{NAME} fill", solid[index].data)
                image.matrix_world = _matrix(mirrored) @ Matrix.Translation(solid[index].location)
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
