"""The scenery of a city: its stage, cut to clusters, with colours, shade and what moves."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from dataclasses import replace
from math import cos, sin, tan

import numpy as np
from numpy.typing import NDArray

from cityx.assets.colliders import bodies_of
from cityx.assets.people.gaits import going, stride_of
from cityx.assets.shapes import box as box_shape
from cityx.assets.shapes import cylinder, fuse, moved
from cityx.assets.styles.materials import material_named
from cityx.assets.vehicles.movers import figure_of, person_look, size_of, vehicle
from cityx.assets.vehicles.vehicles import PAINTS
from cityx.city.city import City
from cityx.city.content import content_hash
from cityx.city.environment import Environment
from cityx.city.mesh import MeshBatch
from cityx.city.store import view_of
from cityx.city.tracks import GAIT
from cityx.dataset.classes import CLASS
from cityx.dataset.stage import SKY_MATERIAL, Stage, stage_of
from cityx.geometry import bvh
from cityx.geometry.arrays import FloatArray, IntArray
from cityx.geometry.raycast import Shapes, shapes_of, together
from cityx.outputs.gltf_instances import sun_light
from cityx.outputs.gltf_material import weather_look
from cityx.sim.kernels import shade as shading
from cityx.sim.scenery import (
    DRONE,
    LAMPS,
    PERSON,
    POSES,
    ROBOT,
    SCENERY_VERSION,
    WHEELCHAIR,
    Scenery,
)

WIDE = 20.0  # metres from which the mesh of a thing is cut to clusters
CELL = 0.5  # metres, of shade
REACH = 150.0  # metres of shade at most
SUNLIGHT = 0.65  # of the sun of other views, so that a high sun and the sky make white white
# Looks of the vehicles of `cityx.sim.dynamics.DRIVEN`, in their order.
LOOKS = (
    ("car_hatchback", "car_city_car"), ("car_sedan", "car_estate", "car_suv"),
    ("car_delivery_van", "car_van"), ("truck",), ("bus",), ("bicycle",),
)  # fmt: skip
CLASSES = ("car", "car", "car", "truck", "bus", "bicycle")
PEOPLE = 8  # persons who look unlike


def compile_scenery(city: City, city_hash: str = "") -> Scenery:
    """Return what cameras see of a city, without what moves at its moment."""
    view = replace(view_of(city), tracks=None)
    stage = stage_of(view, tints=True)
    light = view.environment
    figures = list(_meshes())
    shapes = together([stage.rays.shapes, *map(_tree, figures)])
    colour, tinted, lamp, part = _faces(stage, shapes, figures, light)
    which, way = stage.rays.mesh, stage.rays.transform
    thing, node, bounds = _clusters(shapes, which, way)
    order = np.arange(len(thing), dtype=np.int32)
    top_box = np.empty((len(thing) + 1, 12), np.float32)
    top_child = np.empty((len(thing) + 1, 2), np.int64)
    bvh.grow(bounds)
    root, used = bvh.build(bounds, order, 0, len(thing), bvh.ONE, top_box, top_child, 0)
    rows = [layer for layer in view.scene.instances.values() if layer.count]
    tints: list[FloatArray] = [np.ones((len(which) - sum(each.count for each in rows), 3)),
              *(np.asarray(each.tint, float) for each in rows)]  # fmt: skip
    frame, dark = _shade(stage, light)
    first = stage.rays.shapes.count
    about = {
        "name": city.name, "hash": city_hash or content_hash(city).total,
        "version": SCENERY_VERSION, "top_root": int(root), "light": _light(light),
    }  # fmt: skip
    kinds = list(_kinds())
    return Scenery(
        shapes.root, shapes.box, shapes.child, shapes.corners, shapes.bounds, part, colour, tinted,
        lamp,
        way, stage.instance_object, np.concatenate(tints).astype(np.float32), thing, node,
        top_box[:used].copy(), top_child[:used].copy(), order, stage.object_id, stage.semantic,
        first + np.arange(len(kinds)), np.array([kind[0] for kind in kinds]),
        np.array([CLASS[kind[1]] for kind in kinds], np.uint8),
        np.array([kind[2] for kind in kinds]), np.array([kind[3] for kind in kinds]),
        np.asarray(PAINTS, np.float32), *_props(stage, shapes), frame, dark,
        np.array([json.dumps(about)]),
    )  # fmt: skip


def _faces(
    stage: Stage, shapes: Shapes, figures: Sequence[MeshBatch], light: Environment
) -> tuple[NDArray[np.uint8], NDArray[np.bool_], NDArray[np.uint8], NDArray[np.int32]]:
    """Return colour, whether tinted, lamp, and part of each triangle in the order of the trees."""
    names = list(stage.materials)
    names += sorted({name for mesh in figures for name in mesh.materials} - set(names))
    material, part = [stage.material[:-1]], [stage.part[:-1]]
    tint = [np.asarray(stage.tint)[:-1]]
    for mesh in figures:
        table = np.array([names.index(name) for name in mesh.materials], np.uint16)
        _, face = mesh.triangles()
        material.append(table[mesh.material[face]])
        tint.append(np.asarray(mesh.tint[face], np.float32))
        part.append(np.zeros(len(face), np.int32))
    looks = [material_named(name) if name != SKY_MATERIAL else None for name in names]
    base = np.array([np.zeros(3) if look is None else weather_look(look, light)[0]
                     for look in looks])  # fmt: skip
    takes = np.array([look is not None and look.takes_tint for look in looks])
    number = np.concatenate(material)
    shown = base[number] * np.where(takes[number, None], np.concatenate(tint), 1.0)
    coded = np.round(255.0 * np.sqrt(np.clip(shown, 0.0, 1.0))).astype(np.uint8)
    first = shapes.first
    row = np.repeat(first[:-1], np.diff(first)) + shapes.number  # as given, of each in the trees
    lamp = np.array([LAMPS.get(name, 0) for name in names], np.uint8)
    return coded[row], takes[number][row], lamp[number][row], np.concatenate(part)[row]


def _clusters(
    shapes: Shapes, which: NDArray[np.int32], way: FloatArray
) -> tuple[NDArray[np.int32], IntArray, NDArray[np.float32]]:
    """Return things in parts no wider than `WIDE`, the nodes they are under, and their bounds."""
    thing, node, low, high = [], [], [], []
    bounds = shapes.bounds[which].astype(float)
    solid = np.abs(np.linalg.det(way[:, :, :3])) > 1e-18
    solid &= bounds[:, 0] <= bounds[:, 3]
    middle, half = (bounds[:, :3] + bounds[:, 3:]) / 2, (bounds[:, 3:] - bounds[:, :3]) / 2
    reach = np.einsum("nij,nj->ni", np.abs(way[:, :, :3]), np.where(solid[:, None], half, 0.0))
    wide = solid & (reach.max(axis=1) > WIDE / 2)
    plain = np.flatnonzero(solid & ~wide)
    thing.append(plain)
    node.append(shapes.root[which[plain]])
    low.append(middle[plain])
    high.append(half[plain])
    for row in np.flatnonzero(wide).tolist():
        size = float(np.abs(way[row, :, :3]).sum(axis=1).max())
        for code, box in _parts(shapes, int(shapes.root[which[row]]), bounds[row], WIDE / size):
            thing.append(np.array([row]))
            node.append(np.array([code]))
            low.append((box[None, :3] + box[None, 3:]) / 2)
            high.append((box[None, 3:] - box[None, :3]) / 2)
    number = np.concatenate(thing).astype(np.int32)
    centre, extent = np.concatenate(low), np.concatenate(high)
    there = np.einsum("nij,nj->ni", way[number][:, :, :3], centre) + way[number][:, :, 3]
    about = np.einsum("nij,nj->ni", np.abs(way[number][:, :, :3]), extent)
    return (number, np.concatenate(node).astype(np.int64),
            np.column_stack([there - about, there + about]).astype(np.float32))  # fmt: skip


def _parts(
    shapes: Shapes, root: int, bounds: FloatArray, wide: float
) -> Iterator[tuple[int, FloatArray]]:
    todo = [(root, bounds)]
    while todo:
        code, box = todo.pop()
        if code < 0 or (box[3:] - box[:3]).max() <= wide:
            yield code, box
            continue
        todo += [(int(shapes.child[code, side]), shapes.box[code, 6 * side : 6 * side + 6]
                  .astype(float)) for side in range(2)]  # fmt: skip


def _props(stage: Stage, shapes: Shapes) -> tuple[IntArray, FloatArray, FloatArray]:
    """Return things that can be pushed, the bounds of their meshes, and their masses."""
    bodies = bodies_of(stage.view.scene)
    loose = np.flatnonzero(bodies.movable)
    loose = loose[np.argsort(bodies.object_id[loose], kind="stable")]
    ids = bodies.object_id[loose]
    own = stage.piece[stage.instance_object]  # (n,) id of each thing
    first = len(own) - sum(rows.count for rows in stage.view.scene.instances.values())
    at = np.minimum(np.searchsorted(ids, own), max(len(ids) - 1, 0))
    held = np.flatnonzero((ids[at] == own) & (np.arange(len(own)) >= first)) if len(ids) else at[:0]
    mass = bodies.mass[loose[at[held]]] if len(ids) else np.zeros(0)
    return held.astype(np.int64), shapes.bounds[stage.rays.mesh[held]].astype(float), mass


# --- light ----------------------------------------------------------------------------------------


def _towards(light: Environment) -> FloatArray:
    flat = cos(light.sun_elevation)
    return np.array([sin(light.sun_azimuth) * flat, cos(light.sun_azimuth) * flat,
                     sin(light.sun_elevation)])  # fmt: skip


def _light(light: Environment) -> dict[str, object]:
    """Return the sun's direction, its and the sky's light on a white surface, and the air."""
    sun = sun_light(light)
    up = max(sin(light.sun_elevation), 0.0)
    strength = 0.0 if up <= 0 else float(sun["intensity"])
    day = float(np.clip((np.degrees(light.sun_elevation) + 6.0) / 16.0, 0.0, 1.0))
    closed = light.cloud_cover
    clear = np.array([0.40, 0.52, 0.76])
    grey = np.array([0.62, 0.65, 0.70])
    sky = (clear * (1 - closed) + grey * closed) * (0.03 + 0.97 * day)
    return {
        "towards": _towards(light).round(9).tolist(),
        "sun": (SUNLIGHT * np.array(sun["color"]) * strength).round(6).tolist(),
        "sky": sky.round(6).tolist(), "visibility": light.visibility,
    }  # fmt: skip


def _shade(stage: Stage, light: Environment) -> tuple[FloatArray, NDArray[np.float32]]:
    """Return up to which height it is dark in the sun; things count as solid down to the ground."""
    west, south, east, north = stage.view.extent
    frame = np.array([west, south, CELL, max(np.ceil((east - west) / CELL), 1),
                      max(np.ceil((north - south) / CELL), 1)])  # fmt: skip
    dark = np.full((int(frame[4]), int(frame[3])), -np.inf, np.float32)
    if light.sun_elevation <= 0.02:
        return frame, dark
    rays = stage.rays
    top = dark.copy()
    shading.tops(rays.shapes.first, rays.shapes.corners, rays.mesh, rays.transform, frame, top)
    x, y, _ = _towards(light) / cos(light.sun_elevation)
    shading.darken(top, frame, x, y, tan(light.sun_elevation), REACH, dark)
    return frame, dark


# --- what moves -----------------------------------------------------------------------------------


def _kinds() -> Iterator[tuple[int, str, tuple[float, float, float], float]]:
    """Yield kind, class, size and stride of each figure, as `_meshes` yields their meshes."""
    for kind, looks in enumerate(LOOKS):
        for look in looks:
            yield kind, CLASSES[kind], vehicle(look).size, 0.0
    for number in range(PEOPLE):
        look = person_look(number, age="adult")
        stride = float(np.round(stride_of(figure_of(look, 2), GAIT["walk"]), 6))
        for _ in range(POSES + 1):
            yield PERSON, "pedestrian", size_of(look), stride
    yield ROBOT, "vehicle", (0.68, 0.56, 0.60), 0.0
    chair = person_look(0, gear="wheelchair")
    yield WHEELCHAIR, "pedestrian", size_of(chair), 0.0
    yield DRONE, "vehicle", (0.5, 0.5, 0.2), 0.0


def _meshes() -> Iterator[MeshBatch]:
    """Yield the meshes of figures, which look along x."""
    for looks in LOOKS:
        for look in looks:
            yield _vehicle(look)
    for number in range(PEOPLE):
        made = figure_of(person_look(number, age="adult"), 2)
        for pose in range(POSES):
            yield moved(going(made, GAIT["walk"], pose / POSES), yaw=np.pi / 2)
        yield moved(going(made, GAIT["still"], 0.0), yaw=np.pi / 2)
    yield _robot()
    sitting = figure_of(person_look(0, gear="wheelchair"), 2)
    yield moved(going(sitting, GAIT["sit"], 0.0), yaw=np.pi / 2)
    yield _drone()


def _vehicle(look: str) -> MeshBatch:
    made = vehicle(look)
    parts = [made.body.mesh]
    for part in made.parts:
        parts.append(moved(part.prototype.mesh, part.place, yaw=np.pi if part.about else 0.0))
    for wheel in made.wheels:
        about = np.pi if wheel.place[0] < 0 else 0.0
        parts.append(moved(wheel.prototype.mesh, wheel.place, yaw=about))
    return moved(fuse(parts), yaw=np.pi / 2)


def _robot() -> MeshBatch:
    """Return a delivery robot: a box with a lid, a mast and six wheels, 0.6 m to its lid."""
    parts = [
        box_shape((-0.32, -0.22, 0.14), (0.32, 0.22, 0.50), "plastic", (0.85, 0.86, 0.88)),
        box_shape((-0.34, -0.23, 0.50), (0.30, 0.23, 0.60), "plastic", (0.16, 0.17, 0.19)),
        box_shape((0.28, -0.15, 0.34), (0.34, 0.15, 0.44), "plastic", (0.02, 0.02, 0.03)),
    ]
    for x in (-0.23, 0.0, 0.23):
        for side in (-1.0, 1.0):
            parts.append(cylinder((x, side * 0.22, 0.10), (x, side * 0.28, 0.10), 0.10, "rubber"))
    return fuse(parts)


def _drone() -> MeshBatch:
    parts = [box_shape((-0.12, -0.06, 0.02), (0.12, 0.06, 0.12), "plastic", (0.1, 0.1, 0.11))]
    for x in (-0.18, 0.18):
        for y in (-0.18, 0.18):
            parts.append(cylinder((x, y, 0.12), (x, y, 0.14), 0.07, "plastic", (0.2, 0.2, 0.2)))
            parts.append(box_shape((min(x, 0), min(y, 0), 0.08), (max(x, 0), min(y, 0) + 0.02, 0.1),
                                   "plastic", (0.3, 0.3, 0.3)))  # fmt: skip
    return fuse(parts)


def _tree(mesh: MeshBatch) -> Shapes:
    triangles, _ = mesh.triangles()
    return shapes_of([mesh.vertices], [triangles])
