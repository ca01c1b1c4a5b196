"""Putting what a typed action returned into the city."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from cityx.city.city import City
from cityx.city.layout import Layout
from cityx.city.mesh import MeshBatch, concatenate
from cityx.city.sites import merged
from cityx.ids import stable_id
from cityx.protocol.conversions import ConversionGraph, Path, apply_path
from cityx.protocol.formats import Format

if TYPE_CHECKING:
    from cityx.protocol.encapsulation import Encapsulation
    from cityx.protocol.registry import Registry

# Formats that describe what lies on the ground go into the layout, solid ones into the scene;
# the others are answers and leave the city as it is.
_INTO_LAYOUT = (Format.POINT, Format.LINE, Format.SURFACE, Format.GEOGRAPHIC_DATA)
_INTO_SCENE = (Format.BASIC_GEOMETRY,)


def deposit(city: City, value: Any, record: Encapsulation, actions: Registry) -> City:
    """Return the city with a value added: objects of ids already there are replaced."""
    fmt = record.gives[0].format
    target = None
    if fmt in _INTO_LAYOUT:
        target = Format.SCENE_LAYOUT
    elif fmt in _INTO_SCENE:
        target = Format.COMPLEX_GEOMETRY
    if target is not None:
        path = ConversionGraph.of(actions).path((fmt, record.gives[0].role), (target, ""))
        if isinstance(path, Path):
            value = apply_path(path, value, actions, city=city)
    if isinstance(value, Layout):
        return replace(city, layout=merged(city.layout, value))
    if isinstance(value, MeshBatch):
        return replace(city, scene=city.scene.with_mesh(record.name, _named(value, record)))
    return city


def _named(batch: MeshBatch, record: Encapsulation) -> MeshBatch:
    """Give ids to meshes that have none and sort by id."""
    ids = batch.object_id.copy()
    for row in np.flatnonzero(ids == 0).tolist():
        ids[row] = stable_id(record.id, row)
    named = replace(batch, object_id=ids)
    return concatenate([named]).take(np.argsort(ids, kind="stable"))
