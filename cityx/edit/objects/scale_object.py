"""Scaling one object of the scene."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated

import numpy as np

from cityx.city.city import City
from cityx.city.layout import Layout
from cityx.city.levels import at_heights, ground_levels
from cityx.city.mesh import MeshBatch
from cityx.city.scene import Instances
from cityx.edit.buildings.redrawn_outlines import redrawn, rows_of
from cityx.errors import ActionFailed
from cityx.geometry.arrays import FloatArray
from cityx.protocol import ObjectName, Port, Range, action
from cityx.protocol.objects import find_object


@action(
    "edit/scale_object-v1",
    limits=["The object keeps its place on the ground and may reach into its neighbours."],
    takes=(Port("object", "complex_geometry"),),
    gives=(Port("object", "complex_geometry"),),
    labels=("size", "resize", "taller", "bigger", "smaller"),
)
def scale_object(
    city: City,
    *,
    scale_factor: Annotated[tuple[float, float, float], Range(0.01, 100.0)],
    scaled_obj_name: Annotated[str, ObjectName()],
) -> City:
    """Scale an object.

    The object is scaled about the middle of its base, together with everything it owns, such as
    its windows.

    Parameters
    ----------
    city
        City that holds the object.
    scale_factor
        scale factor
    scaled_obj_name
        scaled object name
    """
    number = find_object(city, scaled_obj_name)
    if number is None:
        raise ActionFailed(f'"{scaled_obj_name}" names no single object of the city.')
    factor = np.asarray(scale_factor, float)
    wanted = np.uint64(number)
    scene = city.scene
    pivot = _pivot(city, wanted)
    if pivot is None:
        raise ActionFailed(f'"{scaled_obj_name}" has no mesh and no instance in the scene yet.')
    for layer, batch in city.scene.meshes.items():
        if np.any(batch.object_id == wanted):
            scene = scene.with_mesh(layer, _scaled_mesh(batch, wanted, pivot, factor))
    for layer, rows in city.scene.instances.items():
        if np.any((rows.object_id == wanted) | (rows.owner == wanted)):
            scaled = _scaled_rows(rows, wanted, pivot, factor)
            scene = scene.with_instances(layer, scene.prototypes, scaled)
    return replace(city, scene=scene, layout=_scaled_layout(city, wanted, pivot, factor))


def _pivot(city: City, wanted: np.uint64) -> np.ndarray[tuple[int], np.dtype[np.float64]] | None:
    """Return the middle of the base of an object, (3,), or None when it has no geometry."""
    points = [
        batch.vertices[np.repeat(batch.object_id == wanted, np.diff(batch.vertex_start))]
        for batch in city.scene.meshes.values()
    ]
    found = np.concatenate([np.zeros((0, 3)), *points])
    if not len(found):
        places = [r.position[r.object_id == wanted] for r in city.scene.instances.values()]
        found = np.concatenate([np.zeros((0, 3)), *places])
    if not len(found):
        return None
    low, high = found.min(axis=0), found.max(axis=0)
    level = ground_levels(city.layout, city.terrain)[
        (city.layout.parts["building"] == wanted).to_numpy()
    ]
    # A building rises from the ground: its doors stay there, and so does the plinth below.
    base = max(float(low[2]), float(level.min())) if len(level) else low[2]
    return np.array([(low[0] + high[0]) / 2, (low[1] + high[1]) / 2, base])


def _scaled_points(
    points: np.ndarray[tuple[int, ...], np.dtype[np.float64]],
    pivot: np.ndarray[tuple[int], np.dtype[np.float64]],
    factor: np.ndarray[tuple[int], np.dtype[np.float64]],
) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
    """Scale (n, 3) points about a pivot; what lies below it keeps its height."""
    scaled = pivot + (points - pivot) * factor
    scaled[:, 2] = np.where(points[:, 2] < pivot[2], points[:, 2], scaled[:, 2])
    return scaled


def _scaled_layout(
    city: City,
    wanted: np.uint64,
    pivot: np.ndarray[tuple[int], np.dtype[np.float64]],
    factor: np.ndarray[tuple[int], np.dtype[np.float64]],
) -> Layout:
    """Return the layout with the footprint and the heights that a scaled building has now."""
    layout = city.layout
    ids = np.array([wanted], np.uint64)
    whole, part = rows_of(layout, ids)
    if not whole.any() or not part.any():
        return layout
    old = ground_levels(layout, city.terrain)[part]
    was = layout.parts.loc[part]
    layout = redrawn(layout, ids, lambda xy: pivot[:2] + (xy - pivot[:2]) * factor[:2])
    layout.parts.loc[part, "roof_height"] *= factor[2]

    def risen(level: FloatArray, name: str) -> FloatArray:
        return np.asarray(pivot[2] + (old + was[name].to_numpy() - pivot[2]) * factor[2] - level)

    layout = at_heights(layout, city.terrain, part, risen)
    layout.buildings.loc[whole, "height"] = layout.parts.loc[part, "top"].max()
    return layout


def _scaled_mesh(
    batch: MeshBatch,
    wanted: np.uint64,
    pivot: np.ndarray[tuple[int], np.dtype[np.float64]],
    factor: np.ndarray[tuple[int], np.dtype[np.float64]],
) -> MeshBatch:
    mine = np.repeat(batch.object_id == wanted, np.diff(batch.vertex_start))
    vertices = batch.vertices.copy()
    vertices[mine] = _scaled_points(vertices[mine], pivot, factor)
    return replace(batch, vertices=vertices)


def _scaled_rows(
    rows: Instances,
    wanted: np.uint64,
    pivot: np.ndarray[tuple[int], np.dtype[np.float64]],
    factor: np.ndarray[tuple[int], np.dtype[np.float64]],
) -> Instances:
    mine = (rows.object_id == wanted) | (rows.owner == wanted)
    position, scale = rows.position.copy(), rows.scale.copy()
    position[mine] = _scaled_points(position[mine], pivot, factor)
    # An instance's own axes are turned about z: its width and depth share the horizontal factor
    # along the directions they point in.
    turn = rows.rotation[mine, 2].astype(float)
    wide = np.hypot(np.cos(turn) * factor[0], np.sin(turn) * factor[1])
    deep = np.hypot(np.sin(turn) * factor[0], np.cos(turn) * factor[1])
    scale[mine] *= np.column_stack([wide, deep, np.full(len(turn), factor[2])]).astype(np.float32)
    return replace(rows, position=position, scale=scale)
