"""What changed between two states of a city, object by object, by content hashes."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import asdict
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.checks.predicates.facts import Facts, names_of
from cityx.checks.predicates.syntax import Call, Name
from cityx.checks.predicates.thing_predicates import CannotTell, Selection, UInt64Array
from cityx.checks.predicates.vocabulary import Group, is_identity, kind_named
from cityx.city import City
from cityx.city.content import (
    differing_ids,
    hash_instances,
    hash_mesh,
    hash_table,
    same_features,
    same_rows,
)
from cityx.city.layout import SCHEMA
from cityx.city.mesh import MeshBatch, same_objects
from cityx.city.rows import take_rows
from cityx.city.scene import Instances
from cityx.ids import id_text, stable_id
from cityx.system.remembered import Remembered

# Meshes that are arranged anew around whatever changes, and hold no object of their own.
ARRANGED = ("ground", "surroundings")
Prints = Mapping[str, tuple[UInt64Array, UInt64Array]]


BESIDE = 0.5  # metres from a wall in which nothing can stay that the wall was put beside


def changed_ids(before: City, after: City) -> UInt64Array:
    """Return the ids of all objects that were added, removed or changed, sorted.

    What belongs to an object (parts, windows) counts for it. The arranged ground is no object.
    """
    return _CHANGED.get(lambda: _changed_ids(before, after), (before, after))


_CHANGED: Remembered[UInt64Array] = Remembered()  # several questions in turn are of one change


def _changed_ids(before: City, after: City) -> UInt64Array:
    found = [np.zeros(0, np.uint64)]
    for name in SCHEMA:
        found.append(_of_tables(getattr(before.layout, name), getattr(after.layout, name), name))
    layers = {*before.scene.meshes, *after.scene.meshes} - set(ARRANGED)
    for layer in sorted(layers):
        old, new = before.scene.meshes.get(layer), after.scene.meshes.get(layer)
        if old is not new:
            found.append(_of_meshes(old, new))
    for layer in sorted({*before.scene.instances, *after.scene.instances}):
        old_rows, new_rows = before.scene.instances.get(layer), after.scene.instances.get(layer)
        if old_rows is not new_rows:
            found.append(_of_layers(before, after, layer))
    return np.unique(np.concatenate(found))


def _of_tables(old: Any, new: Any, name: str) -> UInt64Array:
    if old is new or old.equals(new):
        return np.zeros(0, np.uint64)
    if len(old) and all(_once(table) for table in (old, new)):
        same, at = same_features(new, old, name)
        gone = np.ones(len(old), bool)
        gone[at[same]] = False
        old, new = old.iloc[np.flatnonzero(gone)], new.iloc[np.flatnonzero(~same)]
    pair = []
    for table in (old, new):
        ids, hashes = hash_table(table, name)
        owner = table["building"].to_numpy(np.uint64) if name == "parts" else ids
        pair.append((owner, hashes))
    return differing_ids(*pair)


def _once(table: Any) -> bool:
    """Return whether the ids of a table rise, each once."""
    return _rise(table["id"].to_numpy(np.uint64))


def _rise(ids: UInt64Array) -> bool:
    return bool((ids[1:] > ids[:-1]).all())


def _of_meshes(old: MeshBatch | None, new: MeshBatch | None) -> UInt64Array:
    """Return the ids of the objects of a layer of meshes that differ."""
    if old is not None and new is not None and _in_order(old) and _in_order(new):
        kept, gone = same_objects(new, old), same_objects(old, new)
        old, new = (each.take(np.flatnonzero(~own)) for each, own in ((old, gone), (new, kept)))
    empty = np.zeros(0, np.uint64), np.zeros(0, np.uint64)
    pair = [hash_mesh(each) if each is not None else empty for each in (old, new)]
    return differing_ids(*pair)


def _in_order(batch: MeshBatch) -> bool:
    """Return whether the ids of a batch rise, each once."""
    return _rise(batch.object_id)


def _of_layers(before: City, after: City, layer: str) -> UInt64Array:
    """Return the ids of the owners of the rows of a layer that differ."""
    old, new = before.scene.instances.get(layer), after.scene.instances.get(layer)
    if old is not None and new is not None and old.count and _rising(old) and _rising(new):
        # A prototype is known by its place in memory; one that was made anew counts as another.
        kinds = [np.array([id(one) for one in city.scene.prototypes], np.uint64)
                 for city in (after, before)]  # fmt: skip
        same, at = same_rows(new, old, *kinds)
        gone = np.ones(old.count, bool)
        gone[at[same]] = False
        old, new = take_rows(old, gone), take_rows(new, ~same)
    return differing_ids(_of_instances(before, old), _of_instances(after, new))


def _rising(rows: Instances) -> bool:
    return bool((rows.object_id[1:] >= rows.object_id[:-1]).all())


def _of_instances(city: City, rows: Instances | None) -> tuple[UInt64Array, UInt64Array]:
    """Return the owner and the hash of each of some rows."""
    if rows is None:
        return np.zeros(0, np.uint64), np.zeros(0, np.uint64)
    used = np.unique(rows.prototype).tolist()
    names = np.zeros(len(city.scene.prototypes), np.uint64)
    for at in used:
        prototype = city.scene.prototypes[at]
        names[at] = stable_id(prototype.name, hash_mesh(prototype.mesh)[1].tobytes().hex())
    ids, hashes = hash_instances(rows, names)
    owner = np.where(rows.owner > 0, rows.owner, rows.object_id)
    order = np.argsort(rows.object_id, kind="stable")
    row = order[np.searchsorted(rows.object_id[order], ids)]
    return owner[row], hashes


def changed_parts(before: City, after: City) -> list[str]:
    """Return what else differs: the site, the light, the terrain."""
    found = []
    if before.layout.extent != after.layout.extent:
        found.append("the site")
    if asdict(before.environment) != asdict(after.environment):
        found.append("light and weather")
    if not np.array_equal(before.terrain.heights, after.terrain.heights):
        found.append("the terrain")
    return found


def named_elsewhere(facts: Facts) -> tuple[UInt64Array, set[str]]:
    """Return the ids that the predicates measured together name, and the parts they speak of.

    A kind alone, as in ``n(building) == 48``, names all of its things, but only where no other
    predicate names some of the same family one by one.
    """
    ids = [np.zeros(0, np.uint64)]
    ids += [chosen.layer.members(chosen.rows) for chosen in _named(facts)]
    parts = {"light and weather" for p in facts.together if "env." in str(p) or "sun_" in str(p)}
    return np.unique(np.concatenate(ids)), parts


def _named(facts: Facts) -> list[Selection]:
    """Return what the predicates measured together name, as it was and as it is."""
    single: list[Group] = []
    kinds: list[str] = []
    for predicate in facts.together:
        for group in names_of(predicate):
            own = [c for c in group.conditions if _is_identity(c)]
            if isinstance(group.head, Call) or own or _is_single(group.head):
                single.append(group)
            elif isinstance(group.head, Name):
                kinds.append(kind_named(group.head.word))
    states = list(_states(facts))
    found = [_tried(state, group) for group in single for state in states]
    families = {type(chosen.layer) for chosen in found if chosen is not None}
    for kind in kinds:
        whole = [_tried(state, Group(Name(kind))) for state in states]
        found += [c for c in whole if c is not None and type(c.layer) not in families]
    return [chosen for chosen in found if chosen is not None]


def far_ids(facts: Facts, ids: UInt64Array, reach: float) -> UInt64Array:
    """Return those of some changed objects that lie farther than `reach` metres from all named.

    What lies nowhere, as a rule of a junction does, is far.
    """
    grounds = [chosen.grounds for chosen in _named(facts)]
    region = shapely.union_all(np.concatenate([np.zeros(0, object), *grounds]))
    shapely.prepare(region)
    near: list[NDArray[np.uint64]] = [np.zeros(0, np.uint64)]
    far = [np.zeros(0, np.uint64)]
    for state in _states(facts):
        for own, shapes in located(state.city, ids):
            close = shapely.dwithin(shapes, region, reach)
            near.append(own[close])
            far.append(own[~close])
    astray = np.concatenate(far)
    return np.asarray(ids[~np.isin(ids, np.concatenate(near)) | np.isin(ids, astray)])


def gave_way(facts: Facts, ids: UInt64Array) -> UInt64Array:
    """Return those of some objects that are gone from where what is named stands now."""
    if not len(ids):
        return ids
    left = [own for own, _ in located(facts.city, ids)]
    gone = ids[~np.isin(ids, np.concatenate(left))]
    grounds = [chosen.grounds for chosen in _named(facts)]
    region = shapely.union_all(np.concatenate([np.zeros(0, object), *grounds]))
    found = [np.zeros(0, np.uint64)]
    for own, shapes in located(facts.earlier.city, gone):
        found.append(own[shapely.dwithin(shapes, region, BESIDE)])
    return np.unique(np.concatenate(found))


def located(city: City, ids: UInt64Array) -> Iterator[tuple[UInt64Array, NDArray[Any]]]:
    """Yield objects among some ids with the shapes they have on the ground."""
    for name in SCHEMA:
        table = getattr(city.layout, name)
        own = table["building" if name == "parts" else "id"].to_numpy(np.uint64)
        kept = np.isin(own, ids)
        yield own[kept], table.geometry.to_numpy()[kept]
    for layer, batch in city.scene.meshes.items():
        rows = np.flatnonzero(np.isin(batch.object_id, ids))
        if layer in ARRANGED or not len(rows):
            continue
        spans = zip(batch.vertex_start[rows], batch.vertex_start[rows + 1], strict=True)
        shapes = [shapely.convex_hull(shapely.multipoints(batch.vertices[a:b, :2]))
                  for a, b in spans]  # fmt: skip
        yield batch.object_id[rows], np.array(shapes, object)
    for instances in city.scene.instances.values():
        owner = np.where(instances.owner > 0, instances.owner, instances.object_id)
        kept = np.isin(owner, ids)
        yield owner[kept], np.asarray(shapely.points(instances.position[kept, :2]), object)


def _states(facts: Facts) -> Iterable[Facts]:
    return (facts.earlier, facts)


def _tried(facts: Facts, group: Group) -> Any:
    try:
        return facts.select(group)
    except CannotTell:
        return None  # it was removed, or does not stand yet: the other state knows it


def _is_single(head: Any) -> bool:
    return isinstance(head, Name) and not kind_named(head.word) and is_identity(head.word)


def _is_identity(condition: Any) -> bool:
    return str(condition).startswith(("id", "name"))


def listed(ids: NDArray[np.uint64], most: int = 4) -> str:
    """Name some ids."""
    more = len(ids) - most
    words = ", ".join(id_text(int(value)) for value in ids[:most])
    return words + (f" and {more} more" if more > 0 else "")
