"""Mapping an action for one thing over its layer."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
import shapely

from cityx.city.city import City, Failure
from cityx.city.ground import KERB_HEIGHT
from cityx.city.mesh import MeshBatch, concatenate
from cityx.errors import ActionFailed
from cityx.ids import rng_for
from cityx.protocol.actions import CITY, GENERATOR, hints_of
from cityx.protocol.values import Footprint

if TYPE_CHECKING:
    from cityx.protocol.encapsulation import Encapsulation

LAYER = "buildings"


def footprints(city: City) -> Iterator[Footprint]:
    """Yield the outline of every building in the order of ids."""
    rows = city.layout.buildings
    shapes = shapely.orient_polygons(rows.geometry.to_numpy())
    columns = zip(
        shapes, rows["id"].tolist(), rows["height"].tolist(), rows["levels"].tolist(), strict=True
    )
    for shape, object_id, height, levels in columns:
        holes = tuple(np.asarray(ring.coords)[:-1, :2] for ring in shape.interiors)
        ring = np.asarray(shape.exterior.coords)[:-1, :2]
        yield Footprint(ring, holes, object_id, float(height), int(levels))


def map_over_buildings(
    city: City, record: Encapsulation, function: Callable[..., Any], args: Mapping[str, Any]
) -> City:
    """Run an action on every building and put the meshes into the scene.

    Each building draws from its own stream. The mesh it returns stands on z = 0 and is moved to
    the building's ground. A building the action fails on keeps the mesh it had and is named in the
    failures.

    Raises
    ------
    ActionFailed
        If it fails on every building.
    """
    made: list[MeshBatch] = []
    failures: list[Failure] = []
    kinds = hints_of(function, record.id)
    streams = [name for name, kind in kinds.items() if kind == GENERATOR]
    thing = record.takes[0].name
    shared = {name: city for name, kind in kinds.items() if kind == CITY}
    for footprint in footprints(city):
        given: dict[str, Any] = {thing: footprint, **shared}
        for name in streams:
            given[name] = rng_for(city.seed, record.id, footprint.object_id)
        try:
            made.append(_placed(function(**given, **args), footprint, city))
        except Exception as error:  # noqa: BLE001  one bad building must not stop a city
            text = f"{type(error).__name__}: {error}"
            failures.append(Failure(footprint.object_id, record.id, text))
    if failures and not made:
        raise ActionFailed(
            f"{record.id} failed on all {len(failures)} buildings: {failures[0].error}"
        )
    old = city.scene.meshes.get(LAYER)
    new_ids = {int(mesh.object_id[0]) for mesh in made}
    if old is not None:
        kept = [row for row, i in enumerate(old.object_id.tolist()) if i not in new_ids]
        made += [old.take([row]) for row in kept]
    batch = concatenate(made)
    scene = city.scene.with_mesh(LAYER, batch.take(np.argsort(batch.object_id, kind="stable")))
    return replace(city, scene=scene, failures=(*city.failures, *failures))


def _placed(mesh: Any, footprint: Footprint, city: City) -> MeshBatch:
    if not isinstance(mesh, MeshBatch):
        raise TypeError(f"it returned {type(mesh).__name__}, not MeshBatch")
    if mesh.count != 1 or not len(mesh.faces):
        raise ValueError(f"it returned {mesh.count} meshes with {len(mesh.faces)} faces, not one")
    if not np.isfinite(mesh.vertices).all():
        raise ValueError("it returned a vertex that is not finite")
    level = float(city.terrain.height_at(footprint.ring).min()) + KERB_HEIGHT
    return replace(
        mesh,
        object_id=np.array([footprint.object_id], np.uint64),
        vertices=mesh.vertices + np.array([0.0, 0.0, level]),
    )
