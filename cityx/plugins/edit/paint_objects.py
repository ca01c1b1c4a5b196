"""Painting objects: the tint of their faces, or of them as a whole."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated

import numpy as np

from cityx.assets.surface_states import material_named
from cityx.city import City
from cityx.errors import ActionFailed
from cityx.protocol import ObjectName, Port, Range, Text, action
from cityx.protocol.objects import find_objects


@action(
    "edit/paint_objects-v1",
    limits=["Materials that take no tint, such as glass, keep their colour."],
    takes=(Port("object", "complex_geometry"),),
    gives=(Port("object", "complex_geometry"),),
    labels=("paint", "recolour", "color", "tint"),
)
def paint_objects(
    city: City,
    *,
    objects: Annotated[tuple[str, ...], ObjectName()],
    tint: Annotated[tuple[float, float, float], Range(0.0, 1.0)],
    surface: Annotated[str, Text()] = "",
) -> City:
    """Set the tint that multiplies the colour of what objects are made of.

    Parameters
    ----------
    city
        City that holds the objects.
    objects
        the objects
    tint
        linear red, green and blue
    surface
        the material whose faces are painted, of objects with a mesh of their own; all without one
    """
    ids = find_objects(city, objects)
    color = np.asarray(tint, np.float32)
    scene, painted = city.scene, False
    for layer, batch in city.scene.meshes.items():
        of_object = np.isin(batch.object_id, ids)
        if not of_object.any():
            continue
        taking = [
            material_named(name).takes_tint and surface in ("", name, material_named(name).root)
            for name in batch.materials
        ]
        mine = of_object[batch.face_object()] & np.array(taking, bool)[batch.material]
        painted |= bool(mine.any())
        faces = np.where(mine[:, None], color, batch.tint)
        scene = scene.with_mesh(layer, replace(batch, tint=faces))
    for layer, rows in city.scene.instances.items():
        mine = np.isin(rows.object_id, ids)
        if mine.any():
            painted = True
            faces = np.where(mine[:, None], color, rows.tint)
            scene = scene.with_instances(layer, scene.prototypes, replace(rows, tint=faces))
    if not painted:
        what = f'of "{surface}" ' if surface else ""
        raise ActionFailed(f"None of the objects has a face {what}that takes a tint.")
    return replace(city, scene=scene)
