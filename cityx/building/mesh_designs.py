"""Designs by generators of other packages: their meshes become parts, or another takes over."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
import shapely

from cityx.building.catalogue import generators
from cityx.building.massing.massing import Mass
from cityx.building.mesh_volumes import (
    made_meshes,
    masses_of,
    order_of,
    ordered,
    with_order,
)
from cityx.building.part_rows import aims_of, as_high_as, with_masses
from cityx.building.selection import choose_generators
from cityx.city.city import City, Failure
from cityx.geometry.arrays import IntArray
from cityx.places.profiles import profile_of

if TYPE_CHECKING:
    from cityx.assets.styles.generators import Generator
    from cityx.city.layout import Layout


OVERLAP = 0.3  # square metres of its neighbours that the overhang of a mesh may cover


def with_meshes(
    layout: Layout, rows: IntArray, seed: int, args: Mapping[str, Any] | None = None,
    *, kinds: Mapping[str, Generator] | None = None, apart: bool = True,
) -> tuple[Layout, tuple[Failure, ...]]:  # fmt: skip
    """Let generators of other packages make buildings: parts become the slabs of their meshes.

    Parameters
    ----------
    rows
        (k,) of the buildings, whose generators make meshes.
    args
        Arguments for all; those that the building was asked for before when left out.
    kinds
        Generators by name; those of the catalogue when left out.
    apart
        Whether other packages run in a process of their own.

    Returns
    -------
    layout, failures
        Why a mesh is no building on its footprint; those buildings stay as they were.
    """
    buildings, parts = layout.buildings, layout.parts
    names, ids = buildings["generator"].to_numpy(str), buildings["id"].to_numpy(np.uint64)
    tags = buildings["tags"].to_numpy(object).copy()
    levels = buildings["levels"].to_numpy().copy()
    owner = parts["building"].to_numpy(np.uint64)
    near = shapely.STRtree(buildings.geometry.to_numpy())
    storeys: list[float] = []
    aims = aims_of(buildings, np.arange(len(ids)))
    gone: list[int] = []
    sources: list[int] = []
    masses: list[Mass] = []
    numbers: list[int] = []
    failures: list[Failure] = []
    for name in np.unique(names[rows]).tolist():
        kind = (kinds or generators())[name]
        assert kind.outside is not None
        of = rows[names[rows] == name]
        before = [order_of(text) for text in tags[of]]
        orders = [
            one if args is None else replace(one, args=args)
            for one in (
                old or fresh
                for old, fresh in zip(before, ordered(layout, of, {}), strict=True)
            )
        ]  # fmt: skip
        made = made_meshes(kind, layout, of, orders, seed, apart=apart)
        for row, order, mesh in zip(of.tolist(), orders, made, strict=True):
            own = np.flatnonzero(owner == ids[row]).tolist()
            found = [] if isinstance(mesh, str) else masses_of(mesh, kind)
            why = mesh if isinstance(mesh, str) else ""
            why = why or ("" if own else "the layout has no volume for it")
            why = why or _over_neighbours(near, row, found)
            if why:
                failures.append(Failure(int(ids[row]), kind.outside.record.id, why))
                continue
            found = as_high_as(found, aims[row])
            eave = max(mass.high - mass.rise for mass in found)
            levels[row] = max(round(eave / kind.storey), 1)
            storeys += [kind.storey] * len(found)
            gone += own
            sources += [own[0]] * len(found)
            masses += found
            numbers += range(len(found))
            tags[row] = with_order(tags[row], order)
    if not gone:
        return layout, tuple(failures)
    layout = replace(layout, buildings=buildings.assign(tags=tags.astype(str), levels=levels))
    layout = with_masses(layout, gone, sources, masses, numbers, np.array(storeys))
    return layout, tuple(failures)


def _over_neighbours(footprints: shapely.STRtree, row: int, masses: list[Mass]) -> str:
    """Return why a building cannot reach as far over its footprint as it does, "" if it can."""
    shapes = footprints.geometries
    reach = shapely.difference(shapely.union_all([mass.plan for mass in masses]), shapes[row])
    others = [at for at in footprints.query(reach, predicate="intersects").tolist() if at != row]
    taken = shapely.intersection(reach, shapely.union_all(shapes[others])).area if others else 0.0
    return f"it covers {taken:.1f} m2 of its neighbours" if taken > OVERLAP else ""


def with_others(city: City, failures: tuple[Failure, ...]) -> Layout:
    """Let other generators build what a generator of another package could not."""
    layout = city.layout
    if not failures:
        return layout
    lost = [failure.object_id for failure in failures]
    rows = np.isin(layout.buildings["id"].to_numpy(np.uint64), np.array(lost, np.uint64))
    names = layout.buildings["generator"].to_numpy(str)
    outside = [name for name, kind in generators().items() if kind.outside]
    other = choose_generators(
        layout, city.seed, style=city.style, place=profile_of(city.frame), without=outside
    )  # fmt: skip
    tags = layout.buildings["tags"].to_numpy(object).copy()
    tags[rows] = [with_order(text, None) for text in tags[rows]]
    buildings = layout.buildings.assign(
        generator=np.where(rows, other, names), tags=tags.astype(str)
    )
    return replace(layout, buildings=buildings)
