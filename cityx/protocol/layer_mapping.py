"""Mapping an action for one building over footprints: one mesh each, or the reason for none."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
import shapely

from cityx.city.mesh import MeshBatch
from cityx.ids import rng_for
from cityx.protocol.actions import GENERATOR, hints_of
from cityx.protocol.values import Footprint

if TYPE_CHECKING:
    from cityx.city.layout import Layout
    from cityx.protocol.encapsulation import Encapsulation

Made = MeshBatch | str  # a mesh, or why there is none


def footprints(layout: Layout, rows: Sequence[int]) -> Iterator[Footprint]:
    """Yield the outlines of buildings by their rows."""
    table = layout.buildings.iloc[list(rows)]
    shapes = shapely.orient_polygons(table.geometry.to_numpy())
    columns = zip(
        shapes, table["id"].tolist(), table["height"].tolist(), table["levels"].tolist(),
        strict=True,
    )  # fmt: skip
    for shape, object_id, height, levels in columns:
        holes = tuple(np.asarray(ring.coords)[:-1, :2] for ring in shape.interiors)
        ring = np.asarray(shape.exterior.coords)[:-1, :2]
        yield Footprint(ring, holes, object_id, float(height), int(levels))


def meshes_of(
    record: Encapsulation,
    function: Callable[..., Any],
    outlines: Sequence[Footprint],
    args: Mapping[str, Any],
    seed: int,
    *,
    then: Callable[[], object] = lambda: None,
) -> list[Made]:
    """Run an action on every footprint, each with a random stream of its own.

    Parameters
    ----------
    then
        Called after every one.
    """
    streams = [n for n, kind in hints_of(function, record.id).items() if kind == GENERATOR]
    found: list[Made] = []
    for outline in outlines:
        given: dict[str, Any] = {record.takes[0].name: outline}
        given |= {name: rng_for(seed, record.id, outline.object_id) for name in streams}
        try:
            found.append(_checked(function(**given, **args), outline))
        except Exception as error:  # noqa: BLE001  one bad building must not stop a city
            found.append(f"{type(error).__name__}: {error}")
        then()
    return found


def _checked(mesh: Any, outline: Footprint) -> MeshBatch:
    if not isinstance(mesh, MeshBatch):
        raise TypeError(f"it returned {type(mesh).__name__}, not MeshBatch")
    if mesh.count != 1 or not len(mesh.faces):
        raise ValueError(f"it returned {mesh.count} meshes with {len(mesh.faces)} faces, not one")
    if not np.isfinite(mesh.vertices).all():
        raise ValueError("it returned a vertex that is not finite")
    return replace(mesh, object_id=np.array([outline.object_id], np.uint64))
