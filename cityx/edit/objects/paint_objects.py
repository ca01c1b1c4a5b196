"""Painting objects: the tint of their faces, or of them as a whole."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from cityx.assets.styles.materials import linear_to_srgb, material_named
from cityx.city import City
from cityx.city.layout import Layout
from cityx.city.mesh import MeshBatch
from cityx.errors import ActionFailed
from cityx.geometry.solids import area_vectors
from cityx.protocol import ObjectName, Port, Range, Text, action
from cityx.protocol.objects import find_objects

PLAIN = "plaster"  # whose colour is that of near white walls


@action(
    "edit/paint_objects-v1",
    limits=["Materials that take no tint, such as glass, keep their colour."],
    takes=(Port("object", "complex_geometry"),),
    gives=(Port("object", "complex_geometry"),),
    labels=("paint", "recolour", "color", "tint"),
    serves=("edit=paint_parts",),
    binds={"objects": "objects", "tint": "part.tint"},
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
    scene, painted, walls = city.scene, False, set[int]()
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
        walls |= set(batch.object_id[_upright(batch, mine)].tolist())
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
    return replace(city, scene=scene, layout=_noted(city.layout, walls, color, surface))


def _upright(batch: MeshBatch, painted: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """(k,) whether most of what is painted of each object is walls."""
    area = np.where(painted[:, None], area_vectors(batch.vertices, batch.faces), 0.0)
    flat = np.bincount(batch.face_object(), np.abs(area[:, 2]), minlength=batch.count)
    size = np.linalg.norm(area, axis=1)
    return np.asarray(2 * flat < np.bincount(batch.face_object(), size, minlength=batch.count))


def _noted(layout: Layout, walls: set[int], tint: NDArray[np.float32], surface: str) -> Layout:
    """Return the layout with the colour of painted walls, for when the building is rebuilt."""
    mine = np.isin(layout.parts["building"].to_numpy(np.uint64), np.array([*walls], np.uint64))
    if not mine.any():
        return layout
    seen = tint * np.array(material_named(surface or PLAIN).color)
    parts = layout.parts.copy()
    parts.loc[mine, "wall_color"] = linear_to_srgb(seen.tolist())
    return replace(layout, parts=parts)
