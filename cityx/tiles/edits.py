"""Edits of tiles: what was changed by sentences, as calls that a tile runs whenever it is built.

A tile stays a function of its fragment, its order and its edits. What changes a street or land as a
whole runs on the window of each tile that sees it, so that tiles side by side agree; anything else
on what one tile owns, after that.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from types import MappingProxyType
from typing import Any

from cityx.city import City
from cityx.city.content import differing_ids, hash_table
from cityx.city.layout import SCHEMA, Layout, joined_tables
from cityx.edit.renewal import ARRANGED, renewed
from cityx.errors import ActionFailed, ActionRejected, InputError, UsageError
from cityx.protocol.gate import Call
from cityx.protocol.objects import find_objects
from cityx.protocol.registry import registry
from cityx.protocol.running import run_action
from cityx.system.atomic import replaced
from cityx.tiles.grid import Box, Tile
from cityx.tiles.ownership import owned

NAME = "edits.json"
FORMAT = 1
# Actions that change streets and land as wholes: each tile that holds a part does the same.
WHOLE = ("edit/streets", "edit/turf", "edit/enclose")
_ID = re.compile(r"[0-9a-f]{16}")


@dataclass(frozen=True)
class Edit:
    """What one sentence changed.

    Attributes
    ----------
    text
        The sentence.
    calls
        The calls of each tile, by its name.
    """

    text: str
    calls: Mapping[str, tuple[Call, ...]]


@dataclass(frozen=True)
class Edits:
    """The edits of a folder of tiles, in order.

    Attributes
    ----------
    every
        All, with those that were taken back.
    done
        How many of them hold.
    """

    every: tuple[Edit, ...] = ()
    done: int = 0

    def of(self, tile: Tile) -> tuple[Call, ...]:
        """Return the calls of a tile."""
        held = self.every[: self.done]
        return tuple(call for edit in held for call in edit.calls.get(tile.name, ()))

    def with_edit(self, edit: Edit) -> Edits:
        """Return the edits with one more; those that were taken back are forgotten."""
        return Edits((*self.every[: self.done], edit), self.done + 1)

    def moved(self, steps: int) -> Edits:
        """Return the edits after so many are taken back, negative, or made again.

        Raises
        ------
        UsageError
            If there are fewer.
        """
        room = self.done if steps < 0 else len(self.every) - self.done
        if abs(steps) > room:
            verb = "undo" if steps < 0 else "redo"
            raise UsageError(
                f"There are {room} edits of these tiles to {verb}, not {abs(steps)}."
                if room else f"There is no edit of these tiles to {verb}."
            )  # fmt: skip
        return replace(self, done=self.done + steps)


def read_edits(folder: Path) -> Edits:
    """Read the edits of a folder of tiles, none where there are none.

    Raises
    ------
    InputError
        If the file is damaged.
    """
    path = folder / NAME
    try:
        told = json.loads(path.read_text())
        if told["format"] != FORMAT:
            raise InputError(f"{path} is of another version of CityX; build the tiles anew.")
        every = tuple(
            Edit(str(one["text"]), {name: tuple(Call(action, args, {}) for action, args in calls)
                                    for name, calls in one["tiles"].items()})
            for one in told["edits"]
        )  # fmt: skip
        return Edits(every, int(told["done"]))
    except FileNotFoundError:
        return Edits()
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise InputError(f"{path} is damaged ({error}).") from error


def write_edits(edits: Edits, folder: Path) -> None:
    """Write the edits of a folder of tiles; the file is whole or as it was before."""
    told = {
        "format": FORMAT, "done": edits.done,
        "edits": [{"text": edit.text, "tiles": told_calls(edit.calls)} for edit in edits.every],
    }  # fmt: skip
    with replaced(folder / NAME) as temporary:
        temporary.write_text(json.dumps(told, indent=1, ensure_ascii=False) + "\n")


def told_calls(calls: Mapping[str, Sequence[Call]]) -> dict[str, list[list[Any]]]:
    """Return calls as JSON."""
    return {name: [[call.action, dict(call.args)] for call in own] for name, own in calls.items()}


def is_whole(call: Call) -> bool:
    """Return whether a call changes streets or land as wholes."""
    return call.action.startswith(WHOLE)


def on_window(city: City, calls: Iterable[Call]) -> City:
    """Change the streets and the land of a window."""
    return _run(city, filter(is_whole, calls))


def on_owned(window: City, box: Box, calls: Iterable[Call]) -> City:
    """Return what a tile owns of a window, after the calls that are not for the window.

    Where one lays the ground anew that is done on the window: a tile alone does not know how the
    streets go on beyond its border.
    """
    city = owned(window, box)
    for call in calls:
        if is_whole(call):
            continue
        before, city = city, _run(city, [call])
        if city.ground is before.ground:
            continue
        window = renewed(window, _with_changes(window.layout, before.layout, city.layout))
        fresh = owned(window, box)
        scene = owned(city, box).scene
        meshes = {key: batch for key, batch in scene.meshes.items() if key not in ARRANGED}
        meshes |= {key: batch for key, batch in fresh.scene.meshes.items() if key in ARRANGED}
        city = replace(
            city, scene=replace(scene, meshes=MappingProxyType(meshes)), ground=fresh.ground,
            network=fresh.network, heights=fresh.heights, lanes=fresh.lanes,
        )  # fmt: skip
    return city


def _with_changes(layout: Layout, before: Layout, after: Layout) -> Layout:
    """Return a layout with what two others have otherwise, as the second has it."""
    tables = {}
    for name in SCHEMA:
        table, old, new = (getattr(one, name) for one in (layout, before, after))
        changed = differing_ids(hash_table(old, name), hash_table(new, name))
        if len(changed):
            rest = table[~table["id"].isin(changed)].reset_index(drop=True)
            rows = new[new["id"].isin(changed)].reset_index(drop=True)
            tables[name] = joined_tables(rest, rows)
    return replace(layout, **tables)


def on_overview(city: City, calls: Iterable[Call]) -> City:
    """Change what an overview shows of a tile; what its level of detail has not is left out."""
    for call in calls:
        try:
            city = _run(city, [call])
        except (ActionFailed, ActionRejected, UsageError):
            continue
    return city


def _run(city: City, calls: Iterable[Call]) -> City:
    actions = registry()
    for call in calls:
        here = call_here(city, call)
        if here is not None:
            city = run_action(city, here, actions).city
    return city


def call_here(city: City, call: Call) -> Call | None:
    """Return a call about those of its objects that a city has, None if that is none of them."""
    args = dict(call.args)
    for key, value in call.args.items():
        if not is_ids(value):
            continue
        found = find_objects(city, list(value)) != 0
        if not found.any():
            return None
        args[key] = [one for one, there in zip(value, found.tolist(), strict=True) if there]
    return replace(call, args=args)


def is_ids(value: Any) -> bool:
    """Return whether the value of an argument names objects by their ids."""
    several = isinstance(value, list | tuple) and bool(value)
    return several and all(isinstance(one, str) and bool(_ID.fullmatch(one)) for one in value)


def united(calls: Iterable[Call]) -> list[Call]:
    """Return calls on wholes that say the same of several of them as one about all, in order.

    A street of which several tiles have a part is changed once in each.
    """
    found: dict[Any, Call] = {}
    for place, call in enumerate(calls):
        plain = {key: [] if is_ids(value) else value for key, value in call.args.items()}
        same = replace(call, args=plain).key if is_whole(call) else place
        there = found.setdefault(same, call)
        named = {key: sorted({*there.args[key], *value}) for key, value in call.args.items()
                 if is_whole(call) and is_ids(value)}  # fmt: skip
        found[same] = replace(there, args={**there.args, **named})
    return list(found.values())


def ids_in(calls: Iterable[Call]) -> list[str]:
    """Return the ids that calls name, each once."""
    found = {one for call in calls for value in call.args.values() if is_ids(value)
             for one in value}  # fmt: skip
    return sorted(found)
