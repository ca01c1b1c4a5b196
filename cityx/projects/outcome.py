"""Outcome: what a change did to a city, kind by kind, and what its ranks were taken to be."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.checks.predicates.change_predicates import changed_ids
from cityx.checks.predicates.facts import LAYERS, Facts
from cityx.checks.predicates.thing_predicates import Absent, CannotTell, Layer
from cityx.checks.predicates.vocabulary import KINDS, kind_named
from cityx.city import City
from cityx.ids import id_text
from cityx.language import Brief, Edit, Selector
from cityx.language.commands.that_place import PLACES
from cityx.language.references.ranking import measure_of
from cityx.language.references.resolved_changes import LIST
from cityx.language.references.selecting import Open, choose

UInt64Array = NDArray[np.uint64]

SHOWN = 6  # things of a kind that a line names
KEPT = 500  # things of a kind that the report holds
ADDED, REMOVED, CHANGED = "added", "removed", "changed"
# Families whose things are told, and kinds that only gather others or are made of them.
# Roundabouts and crosswalks are not: streets make them up, which are told, and ground, no thing.
_FAMILIES = ("building", "road", "bridge", "land", "piece", "lamp", "vehicle", "pedestrian",
             "line", "crossing")  # fmt: skip
_GATHER = ("quarter", "green", "grass", "water", "courtyard", "traffic", "bridge")
_PIECES = ("piece", "lamp", "vehicle", "pedestrian")
# Forms that look at the state before; ranks are those that the sentence was said of.
COMPARING = re.compile(r"\b(changed|gained|ratio|same|top)\(")


@dataclass(frozen=True)
class Deed:
    """What became of the things of a kind.

    Attributes
    ----------
    how
        "added", "removed" or "changed".
    kind
        Their kind.
    count
        How many.
    objects
        Some of them, each with "id", "name" and the middle "x", "y" (metres, scene frame).
    """

    how: str
    kind: str
    count: int
    objects: tuple[dict[str, Any], ...]

    def to_json(self) -> dict[str, Any]:
        """Return it for a report."""
        return {"how": self.how, "kind": self.kind, "count": self.count,
                "objects": list(self.objects)}  # fmt: skip


def line_of(deed: dict[str, Any]) -> str:
    """Return one of `Deed.to_json` in a line: "added 14 x bench: 3f..., a0... and 12 more"."""
    named = [one["name"] or one["id"] for one in deed["objects"][:SHOWN]]
    more = deed["count"] - len(named)
    tail = f" and {more} more" if more > 0 else ""
    kind = str(deed["kind"]).replace("_", " ")
    return f"{deed['how']} {deed['count']} x {kind}: {', '.join(named)}{tail}"


def deeds_of(before: City, after: City) -> list[Deed]:
    """Return what was added, removed and changed, each thing by its narrowest kind.

    Buildings and streets come first, then land, then what stands on it. The ground that is laid
    anew around a change is no thing.
    """
    empty = np.zeros(0, np.uint64)
    old, new = (empty if (t := city.tracks) is None else t.object_id for city in (before, after))
    ids = np.union1d(changed_ids(before, after), np.setxor1d(old, new))
    loose = _is_loose(before, after)
    was, now = (dict(_found(Facts(city), ids, loose=loose)) for city in (before, after))
    deeds = []
    every_old, every_new = (np.concatenate([empty, *state.values()]) for state in (was, now))
    for kind in dict.fromkeys((*now, *was)):
        old, new = was.get(kind, empty), now.get(kind, empty)
        kept = np.isin(new, every_old)  # a street that becomes a path is changed
        for how, own, city in (
            (ADDED, new[~kept], after),
            (REMOVED, old[~np.isin(old, every_new)], before),
            (CHANGED, new[kept], after),
        ):
            if len(own):
                deeds.append(_deed(how, Facts(city).layer(kind), own))
    return deeds


def _is_loose(before: City, after: City) -> bool:
    """Return whether anything loose differs: furniture, plants, vehicles, people."""
    old, new = before.scene.instances, after.scene.instances
    same = old.keys() == new.keys() and all(old[name] is new[name] for name in old)
    return not same or before.tracks is not after.tracks


def _found(facts: Facts, ids: UInt64Array, *, loose: bool) -> Iterator[tuple[str, UInt64Array]]:
    """Yield the kinds of things of a city with those of them that differ, each thing once."""
    layers: list[tuple[str, UInt64Array]] = []
    # Layers of kinds of which nothing differs are costly to make: a house alone is no bench.
    loose = loose and bool(np.isin(_ids_of_pieces(facts.city), ids).any())
    land = bool(np.isin(facts.city.layout.areas["id"].to_numpy(np.uint64), ids).any())
    for kind, family in KINDS.items():
        if family not in _FAMILIES or (family in _PIECES and not loose) or kind in _GATHER:
            continue
        if family == "land" and not land:
            continue
        if family == "building" and kind != "building":
            continue
        layer = facts.layer(kind) if family in LAYERS else None
        if layer is not None and len(layer.ids):
            layers.append((kind, layer.ids))
    left = ids
    narrow = {kind: len(own) for kind, own in layers}
    taken: dict[str, UInt64Array] = {}
    for kind, own in sorted(layers, key=lambda one: narrow[one[0]]):
        mine = left[np.isin(left, own)]
        if len(mine):
            taken[kind] = mine
            left = left[~np.isin(left, mine)]
    yield from ((kind, taken[kind]) for kind, _ in layers if kind in taken)


def _ids_of_pieces(city: City) -> UInt64Array:
    """Return the ids of all instances of a city, and of what moves."""
    tracks = city.tracks
    own = [rows.object_id for rows in city.scene.instances.values()]
    return np.concatenate(
        [np.zeros(0, np.uint64), *own, *(() if tracks is None else (tracks.object_id,))]
    )


def _deed(how: str, layer: Layer, ids: UInt64Array) -> Deed:
    rows = np.flatnonzero(np.isin(layer.ids, ids))
    _, first = np.unique(layer.ids[rows], return_index=True)
    rows = rows[np.sort(first)]
    some = rows[:KEPT]
    at = shapely.get_coordinates(shapely.centroid(layer.shapes[some]))
    names = layer.names.get("name")
    called = [""] * len(some) if names is None else [str(one) for one in names[some]]
    objects = tuple(
        {"id": id_text(int(layer.ids[row])), "name": name, "x": round(float(x), 2),
         "y": round(float(y), 2)}
        for row, name, (x, y) in zip(some, called, at, strict=True)
    )  # fmt: skip
    return Deed(how, layer.kind, len(rows), objects)


def choices_of(brief: Brief, before: City) -> list[str]:
    """Say which objects of a city ranks of a request were taken to be, and by which measure.

    Parameters
    ----------
    brief
        The request.
    before
        The city that the request was said of.
    """
    found: dict[str, None] = {}
    for edit in brief.edits:
        for selector in _ranked_in(edit):
            told = _choice(selector, before)
            if told:
                found[told] = None
        for word in _names_in(edit):
            told = _shared_name(word, before)
            if told:
                found[told] = None
    return list(found)


def _names_in(edit: Edit) -> Iterator[str]:
    """Yield the names that a change speaks of."""
    spots = [edit.target] if edit.target is not None else []
    spots += [spot for ref in edit.refs for spot in ref.spots]
    for one in spots:
        yield from (*one.ids, one.near, one.inside, one.along, one.of)
    yield from (value for key, value in edit.change if key in _WHERE and isinstance(value, str))


_WHERE = (*PLACES, "at", "of")


def _shared_name(word: str, city: City) -> str:
    """Say that several streets bear a name, all of which are meant; "" where there is but one."""
    if " " not in word or kind_named(word):
        return ""
    try:
        found = Facts(city).named(word)
    except (Absent, CannotTell):
        return ""
    if found.count < 2 or KINDS[found.layer.kind] != "road":
        return ""
    return f'"{word}" is the name of {found.count} streets that do not meet; all are meant.'


def _ranked_in(edit: Edit) -> Iterator[Selector]:
    """Yield the choices by a rank that a change speaks of."""
    spots = [edit.target] if edit.target is not None else []
    spots += [spot for ref in edit.refs for spot in ref.spots]
    while spots:
        one = spots.pop(0)
        spots += [spot for ref in one.where for spot in ref.spots]
        if one.rank or (one.alone and one.kind == "main_street"):
            yield one
        words = (one.near, one.inside, one.along, one.of)
        spots += [_of_word(word) for word in words if " " in word]
    for _, value in edit.change:
        if isinstance(value, str) and " " in value:
            spots.append(_of_word(value))
    yield from (one for one in spots if one.rank)


def _of_word(word: str) -> Selector:
    """Return "longest road" as a choice of one."""
    rank, _, kind = word.partition(" ")
    return Selector(kind, rank=rank, k=1) if kind in KINDS else Selector(kind=word)


def _choice(selector: Selector, city: City) -> str:
    try:
        chosen = choose(replace(selector, but=()), city)
        told = measure_of(selector.rank, chosen)
    except (Open, CannotTell):
        return ""
    if not told or not len(chosen.rows):
        return ""
    kind = (selector.kind or "building").replace("_", " ")
    rank = selector.rank or "main"
    known = chosen.layer.names.get("name")
    names = [str(known[row]) if known is not None else "" for row in chosen.rows.tolist()]
    called = [name or id_text(int(own)) for name, own in zip(names, chosen.ids, strict=True)]
    called = list(dict.fromkeys(called))
    more = f" and {len(called) - SHOWN} more" if len(called) > SHOWN else ""
    return f'"{rank} {kind}" is taken to be {", ".join(called[:SHOWN])}{more}: {told}.'


_NOTHING = "Nothing was changed: all that was asked for is so already, or could not be done."


def said_of(report: dict[str, Any]) -> list[str]:
    """Return in lines what a change did, by its report: what was taken to be meant, then the deeds.

    Light and weather are no things; a change of them alone names none.
    """
    done = [line_of(one) for one in report["done_of_change"]]
    asked = any(edit.get("verb") != LIST for edit in report["change"].get("edits", ()))
    same = report["same_of_change"] and asked
    return [*report["chosen_of_change"], *done, *([_NOTHING] if same else ())]
