"""Buildings raised by an action for one building: what ``--do "building/ziggurat-v1"`` does."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from cityx.building.catalogue import generators, outside_generator
from cityx.building.design import laid_open, raised
from cityx.building.lots import cleared
from cityx.building.mesh_designs import with_meshes
from cityx.building.mesh_volumes import with_order
from cityx.building.selection import fits_size, sizes_of
from cityx.building.splicing import SHELLS
from cityx.city.city import City
from cityx.errors import ActionFailed
from cityx.ids import uniform
from cityx.protocol.objects import find_objects, name_hint
from cityx.protocol.plugged import mesh_action
from cityx.protocol.registry import BUILTIN


def raised_by(
    city: City, function: Callable[..., Any], args: Mapping[str, Any], *, package: str = BUILTIN
) -> City:
    """Let an action for one building raise those that are asked for.

    They are of its kind from then on: other actions leave them to it, and a building that it fails
    on stays as it was and is named in the failures. A height that the map says gives way to that of
    the mesh. Where buildings stand already they are raised anew.

    Parameters
    ----------
    args
        Its arguments, with those of the runner: which buildings, and the share of them.
    package
        Where it comes from; actions of other packages run in a process of their own.

    Raises
    ------
    ActionFailed
        If it fails on every building, or a name names none.
    """
    made = mesh_action(function, "" if package == BUILTIN else package)
    kind = generators().get(made.name)
    if kind is None or kind.outside is None or kind.outside.record != made.record:
        kind = outside_generator(made)
    layout = city.layout
    ids = layout.buildings["id"].to_numpy(np.uint64)
    own = {name: value for name, value in args.items() if name not in ("objects", "share")}
    chosen = uniform(city.seed, "building/share", ids) < float(args.get("share", 1.0))
    if args.get("objects"):
        chosen = np.isin(ids, _named(city, args["objects"]))
    else:
        chosen &= fits_size(kind, *sizes_of(layout))
    rows = np.flatnonzero(chosen)
    if not len(rows):
        raise ActionFailed("there is no building of a size that it makes sense on")
    tags = layout.buildings["tags"].to_numpy(object).copy()
    tags[rows] = [with_order(text, None, height=False) for text in tags[rows]]
    names = layout.buildings["generator"].to_numpy(object).copy()
    names[rows] = made.name
    buildings = layout.buildings.assign(generator=names.astype(str), tags=tags.astype(str))
    asked = replace(layout, buildings=buildings)
    done, lost = with_meshes(
        asked, rows, city.seed, own, kinds={made.name: kind}, apart=package != BUILTIN
    )
    if len(lost) == len(rows):
        raise ActionFailed(f"it fits none of {len(rows)} buildings: {lost[0].error}")
    failed = np.isin(ids, np.array([one.object_id for one in lost], np.uint64))
    before = layout.buildings
    kept = {name: np.where(failed, before[name], done.buildings[name])
            for name in ("generator", "tags")}  # fmt: skip
    layout = replace(done, buildings=done.buildings.assign(**kept).astype(before.dtypes.to_dict()))
    city = replace(city, layout=layout, failures=city.failures + lost)
    city = cleared(city, laid_open(layout, np.setdiff1d(rows, np.flatnonzero(failed))))
    return raised(city) if SHELLS in city.scene.meshes else city


def _named(city: City, names: tuple[str, ...]) -> Any:
    found = find_objects(city, list(names))
    known = np.isin(found, city.layout.buildings["id"].to_numpy(np.uint64))
    for name, good in zip(names, known.tolist(), strict=True):
        if not good:
            raise ActionFailed(f'"{name}" names no building of the city.{name_hint(city, name)}')
    return found
