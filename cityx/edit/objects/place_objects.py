"""Placing objects as they are: moved, turned, scaled, all about their own feet."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from cityx.building.lots import cleared
from cityx.city import City
from cityx.city.layout import Layout
from cityx.city.levels import at_heights, ground_levels
from cityx.city.mesh import MeshBatch, feet
from cityx.city.scene import Instances
from cityx.edit.buildings.redrawn_outlines import redrawn, rows_of
from cityx.edit.objects.footing import moved_points
from cityx.edit.objects.scale_object import scale_object
from cityx.errors import ActionFailed
from cityx.geometry.arrays import FloatArray
from cityx.geometry.turns import euler_of, matrices
from cityx.ids import id_text
from cityx.protocol import ObjectName, Port, Range, action
from cityx.protocol.objects import find_objects

UPRIGHT = 1e-4  # radians that a shell may be tilted by, which the eye of no one sees
Vector = tuple[float, float, float]


@action(
    "edit/place_objects-v1",
    limits=[
        "As by hand: objects may reach into their neighbours or stand in the air.",
        "Buildings are turned about the vertical only.",
    ],
    takes=(Port("object", "complex_geometry"),),
    gives=(Port("object", "complex_geometry"),),
    labels=("move", "turn", "rotate", "shift", "place"),
)
def place_objects(
    city: City,
    *,
    objects: Annotated[tuple[str, ...], ObjectName()],
    move: Annotated[Vector, Range(-1e6, 1e6)] = (0.0, 0.0, 0.0),
    turn: Annotated[Vector, Range(-7.0, 7.0)] = (0.0, 0.0, 0.0),
    factor: Annotated[Vector, Range(0.01, 100.0)] = (1.0, 1.0, 1.0),
) -> City:
    """Move, turn and scale objects from where they are, each about the middle of its own foot.

    What a building owns, such as its windows, goes with it. An object is scaled first, along its
    own axes, then turned, then moved.

    Parameters
    ----------
    city
        City that holds the objects.
    objects
        the objects
    move
        metres to the east, to the north and up
    turn
        radians about the axes to the east, to the north and up, in that order
    factor
        factors of length, width and height
    """
    ids = find_objects(city, objects)
    shells = [i for i in ids.tolist() if _has_shell(city, i)]
    tilted = shells and max(abs(turn[0]), abs(turn[1])) > UPRIGHT
    if tilted:
        raise ActionFailed(
            f"{id_text(shells[0])} is a building or another mesh that stands on the ground; it "
            "can be turned about the vertical only."
        )
    if shells and factor != (1.0, 1.0, 1.0):
        for shell in shells:
            city = scale_object(city, scale_factor=factor, scaled_obj_name=id_text(shell))
    for shell in shells:
        city = _shell_moved(city, np.uint64(shell), np.asarray(move, float), turn[2])
    loose = np.setdiff1d(ids, np.array(shells, np.uint64))
    return _rows_moved(city, loose, np.asarray(move, float), turn, np.asarray(factor, float))


def _has_shell(city: City, wanted: int) -> bool:
    return any((batch.object_id == np.uint64(wanted)).any() for batch in city.scene.meshes.values())


def _rows_moved(
    city: City, ids: NDArray[np.uint64], move: FloatArray, turn: Vector, factor: FloatArray
) -> City:
    """Move instances, each about its own place, and the places of the layout that they stand at."""
    scene = city.scene
    for layer, rows in city.scene.instances.items():
        mine = np.isin(rows.object_id, ids)
        if mine.any():
            moved = turned_rows(rows, mine, rows.position, move, turn)
            scale = np.where(mine[:, None], rows.scale * factor, rows.scale).astype(np.float32)
            scene = scene.with_instances(layer, scene.prototypes, replace(moved, scale=scale))
    return moved_points(replace(city, scene=scene), ids, move[:2])


def turned_rows(
    rows: Instances, mine: NDArray[np.bool_], pivot: FloatArray, move: FloatArray, turn: Vector
) -> Instances:
    """Turn some instances about pivots, (n, 3) or (3,), then move them."""
    about = matrices(np.asarray([turn], float))[0]
    position, rotation = rows.position.copy(), rows.rotation.copy()
    center = np.broadcast_to(pivot, position.shape)[mine]
    position[mine] = center + (position[mine] - center) @ about.T + move
    if np.any(turn):
        rotation[mine] = euler_of(about @ matrices(rotation[mine].astype(float)))
    return replace(rows, position=position, rotation=rotation)


def _shell_moved(city: City, wanted: np.uint64, move: FloatArray, yaw: float) -> City:
    """Move a shell, what it owns, and its rows of the layout."""
    turn, scene = (0.0, 0.0, yaw), city.scene
    pivot = np.zeros(3)
    for layer, batch in city.scene.meshes.items():
        mine = batch.object_id == wanted
        if mine.any():
            pivot = feet(batch)[int(np.argmax(mine))]
            scene = scene.with_mesh(layer, _moved_mesh(batch, mine, pivot, move, turn))
    for layer, rows in city.scene.instances.items():
        own = (rows.object_id == wanted) | (rows.owner == wanted)
        if own.any():
            moved = turned_rows(rows, own, pivot, move, turn)
            scene = scene.with_instances(layer, scene.prototypes, moved)
    layout = _moved_layout(city, wanted, pivot, move, yaw)
    return cleared(replace(city, scene=scene, layout=layout), np.array([wanted], np.uint64))


def _moved_mesh(
    batch: MeshBatch, mine: NDArray[np.bool_], pivot: FloatArray, move: FloatArray, turn: Vector
) -> MeshBatch:
    rows = np.repeat(mine, np.diff(batch.vertex_start))
    vertices = batch.vertices.copy()
    about = matrices(np.asarray([turn], float))[0]
    vertices[rows] = pivot + (vertices[rows] - pivot) @ about.T + move
    return replace(batch, vertices=vertices)


def _moved_layout(
    city: City, wanted: np.uint64, pivot: FloatArray, move: FloatArray, yaw: float
) -> Layout:
    """Return the layout with the outlines and heights of a building at its new place."""
    layout = city.layout
    ids = np.array([wanted], np.uint64)
    whole, part = rows_of(layout, ids)
    if not whole.any():
        return layout
    about = matrices(np.array([[0.0, 0.0, yaw]]))[0, :2, :2]
    before = ground_levels(layout, city.terrain)[part]
    was = layout.parts.loc[part]
    layout = redrawn(
        layout, ids, lambda xy: pivot[:2] + (xy - pivot[:2]) @ about.T + move[:2], turn=yaw
    )

    def risen(level: FloatArray, name: str) -> FloatArray:
        return np.asarray(was[name].to_numpy() + (before + move[2] - level))

    layout = at_heights(layout, city.terrain, part, risen)
    buildings, parts = layout.buildings, layout.parts
    if part.any():
        buildings.loc[whole, "height"] = parts.loc[part, "top"].max()
    return replace(layout, buildings=buildings, parts=parts)
