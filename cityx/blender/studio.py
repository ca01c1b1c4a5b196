"""A scene that is pictured many times: in one light, at one moment, from one eye after another."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import bpy

from cityx.blender import lawns
from cityx.blender.animation import set_moment
from cityx.blender.leaf_fall import show_twigs
from cityx.blender.light import Lighting, show_signals
from cityx.blender.materials import MaterialLibrary
from cityx.blender.passes import render_passes, use_passes
from cityx.city.camera import Camera
from cityx.city.environment import Environment

if TYPE_CHECKING:
    from cityx.city.store import View


from typing import TYPE_CHECKING

import numpy as np

from cityx.assets.vehicles.moving import PEOPLE, TRAFFIC, with_movers
from cityx.blender.scene import add_layer, remove_layer

if TYPE_CHECKING:
    from cityx.city.store import View


from math import radians
from typing import TYPE_CHECKING

from mathutils import Matrix

from cityx.blender.scene import LAYER
from cityx.geometry.mirrored import Image, images, near

if TYPE_CHECKING:
    from cityx.city.store import View

# Outskirts: the site mirrored across its borders, so that pictures do not end at a bare plain.

NAME = "Outskirts"
# Points are copied as a whole: layers that show from afar, while they are no more than so many.
AFAR = ("trees", "vehicles", "street_furniture")
MOST_ROWS = 12_000
SURROUNDINGS = "surroundings"  # layer of the plain, which the copies' ground replaces
SUNK = 1.5  # metres by which it sinks below them, deeper than water lies
MAP_PITCH = radians(-75.0)  # a camera that looks down like a map shows the site alone


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


# What moves, in a scene that shows one moment after another.


def show_movers(
    scene: bpy.types.Scene, view: View, moment: float, library: MaterialLibrary
) -> None:
    """Put vehicles and people where they are at a moment, in place of those of another.

    Parameters
    ----------
    scene
        A scene made of the view, or one that shows another moment of it.
    view
        The city, without movers in its scene.
    moment
        Seconds into the tracks.
    library
        Gives the materials.
    """
    held = with_movers(view, moment).scene
    for layer in (TRAFFIC, PEOPLE):
        remove_layer(layer)
        rows = held.instances.get(layer)
        if rows is None or not rows.count:
            continue
        used, local = np.unique(rows.prototype, return_inverse=True)
        shapes = [held.prototypes[index] for index in used.tolist()]
        placed = replace(rows, prototype=local.astype(np.int32))
        add_layer(scene, layer, shapes, placed, view.seed, library)


class Studio:
    """A scene and what differs from picture to picture; each depends on its own wishes alone.

    Parameters
    ----------
    scene
        The scene.
    view
        The city it was made of.
    lighting
        Its light.
    library
        Its materials.
    staged
        Whether movers come and go with the moment; if not, the scene holds those of the view.
    animated
        Whether movers have keyframes, so that a moment is a frame.
    """

    def __init__(
        self,
        scene: bpy.types.Scene,
        view: View,
        lighting: Lighting,
        library: MaterialLibrary,
        *,
        staged: bool,
        animated: bool = False,
    ) -> None:
        self.scene, self.view, self.lighting, self.library = scene, view, lighting, library
        self.staged, self.animated = staged, animated
        self.moment: float | None = None
        self.outskirts: Outskirts | None = None

    def show(
        self, environment: Environment, camera: Camera, moment: float | None, *, truth: bool = False
    ) -> None:
        """Set light, grass, movers, signals and outskirts; a moment of None is that of the view.

        A picture that is read as truth shows the site alone.
        """
        if not truth and self.outskirts is None:
            self.outskirts = Outskirts(self.scene, self.view)
        if self.outskirts is not None:
            self.outskirts.show(None if truth else camera)
        show_twigs(bpy.data.objects, shown=not truth)
        wanted = self.view.moment if moment is None else moment
        if self.staged and wanted != self.moment:
            show_movers(self.scene, self.view, wanted, self.library)
        elif self.animated:
            set_moment(self.scene, wanted)
        if wanted != self.moment:
            show_signals(self.view, wanted)
        self.moment = wanted
        self.lighting.set(environment)
        self.lighting.set_for(environment, camera)
        lawns.sow(self.scene, replace(self.view, environment=environment), camera, self.library)

    def passes(
        self, item: bpy.types.Object, path: Path, names: Sequence[str], *, denoise: bool
    ) -> dict[str, Any]:
        """Render a picture with passes; returns what is known of it."""
        use_passes(self.scene, names, denoise=denoise)
        return render_passes(self.scene, item, path)
