"""Pulling: what an artist changed in ``city.blend`` comes back as one revision of the city."""

from __future__ import annotations

import json
import shutil
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import shapely

from cityx.agents.briefs import Request
from cityx.agents.loop import Say, quiet
from cityx.city import City
from cityx.city.layout import CURVE
from cityx.errors import EngineError, InputError, UsageError
from cityx.ids import id_text
from cityx.projects.desk import HISTORY, STORE, Conflict, Desk
from cityx.projects.edit import renew
from cityx.protocol.gate import Call
from cityx.sources.blend_curves import SLACK, plain_line
from cityx.system.blender_process import run_module

BLEND = "city.blend"
TEXT = "pulled from city.blend"
MOST_REMOVED = 0.2  # share of the objects of a layer that may go without being asked for
FEW = 5  # objects of a layer that always may
SHOWN = 12  # things named of each kind of change


@dataclass(frozen=True)
class Pull:
    """What a .blend differs in from the city that it shows.

    Attributes
    ----------
    moved, copied
        Objects ("id") with "move", "turn" and "factor"; see `cityx.edit.objects.place_objects`.
    removed
        Ids of objects that are gone.
    painted
        Objects ("id") with "surface" and "tint"; see `cityx.edit.objects.paint_objects`.
    drawn
        Curves of the artist's own ("name", "points" in metres) that the city has not just so; who
        is told to goes along them.
    erased
        Names of curves that an earlier pull took, and that are gone.
    untaken
        Changes that CityX cannot take back, in words.
    foreign
        Objects of the artist's own: "name" and "type".
    """

    moved: tuple[Mapping[str, Any], ...] = ()
    copied: tuple[Mapping[str, Any], ...] = ()
    removed: tuple[str, ...] = ()
    painted: tuple[Mapping[str, Any], ...] = ()
    drawn: tuple[Mapping[str, Any], ...] = ()
    erased: tuple[str, ...] = ()
    untaken: tuple[str, ...] = ()
    foreign: tuple[Mapping[str, str], ...] = ()

    @property
    def empty(self) -> bool:
        """Whether the city is as the file shows it, but for what cannot be taken."""
        return not (self.moved or self.copied or self.removed or self.painted or self.drawn
                    or self.erased)  # fmt: skip

    def lines(self, most: int = SHOWN) -> list[str]:
        """Say in words what differs, some of each kind by name."""
        found = []
        for verb, changes in (("moved", self.moved), ("copied", self.copied)):
            found += _named(verb, [f"{c['id']}{_pose_in_words(c)}" for c in changes], most)
        found += _named("removed", sorted(self.removed), most)
        found += _named("removed", list(self.erased), most)
        found += _named("recoloured", [str(c["id"]) for c in self.painted], most)
        found += _named("not taken", list(self.untaken), most)
        found += _named("drawn", [str(c["name"]) for c in self.drawn], most)
        paths = {c["name"] for c in self.drawn}
        own = [f"{item['name']} ({item['type']})" for item in self.foreign
               if item["name"] not in paths]  # fmt: skip
        return found + _named("your own, kept in city.blend alone", own, most)


def calls_of(found: Pull, city: City) -> list[Call]:
    """Return the actions that bring about what differs: objects to which the same happens at once.

    What a building owns goes where the building goes; changes of its own are taken only of one
    that stays.
    """
    owner = owners_of(city)
    gone = set(found.removed)
    carried = gone | {change["id"] for change in found.moved}
    kept = [change for change in found.moved if owner.get(change["id"]) not in carried]
    painted = [c for c in found.painted if gone.isdisjoint({c["id"], owner.get(c["id"], "")})]
    poses = ("move", "turn", "factor")
    drawn = [Call("edit/draw_curve-v1", dict(curve)) for curve in found.drawn]
    calls = [
        *(Call("edit/erase_curve-v1", {"name": name}) for name in found.erased),
        *drawn,
        *(Call("edit/copy_objects-v1", same) for same in _grouped(found.copied, poses)),
    ]
    whole: list[str] = []
    parts: list[str] = []
    barriers = city.scene.meshes.get("barriers")
    walls = set() if barriers is None else set(map(id_text, barriers.object_id.tolist()))
    for name in sorted(gone):
        if owner.get(name) in gone:
            continue
        (parts if name in owner or name in walls else whole).append(name)
    for action, names in (("edit/remove_parts-v1", parts), ("edit/remove-v1", whole)):
        if names:
            calls.append(Call(action, {"objects": names}))
    same = _grouped(painted, ("surface", "tint"))
    calls += [Call("edit/paint_objects-v1", arguments) for arguments in same]
    return [*calls, *(Call("edit/place_objects-v1", same) for same in _grouped(kept, poses))]


def owners_of(city: City) -> dict[str, str]:
    """Return the building that each part belongs to, by ids."""
    found: dict[str, str] = {}
    for rows in city.scene.instances.values():
        mine = rows.owner > 0
        ids, owners = rows.object_id[mine].tolist(), rows.owner[mine].tolist()
        found |= zip(map(id_text, ids), map(id_text, owners), strict=True)
    return found


def _pose_in_words(change: Mapping[str, Any]) -> str:
    """Say by how much something was moved, turned and scaled."""
    words = ""
    for key, same, said in (("move", 0.0, "by {} m"), ("turn", 0.0, "turned {} rad"),
                            ("factor", 1.0, "scaled {}")):  # fmt: skip
        if any(value != same for value in change[key]):
            words += " " + said.format(", ".join(f"{value:g}" for value in change[key]))
    return words


def _named(verb: str, things: Sequence[str], most: int) -> list[str]:
    """Return a line for each of the first things, and one that counts the others."""
    more = [f"{verb}: {len(things) - most} more"] if len(things) > most else []
    return [*(f"{verb}: {thing}" for thing in things[:most]), *more]


def _grouped(changes: Sequence[Mapping[str, Any]], keys: tuple[str, ...]) -> list[dict[str, Any]]:
    """Put objects to which the same happens into one call."""
    groups: dict[str, dict[str, Any]] = {}
    for change in changes:
        same = {key: change[key] for key in keys}
        group = groups.setdefault(json.dumps(same), {**same, "objects": []})
        group["objects"].append(change["id"])
    return list(groups.values())


def pull(
    folder: Path,
    *,
    blend: Path | None = None,
    dry_run: bool = False,
    removals: bool = False,
    say: Say = quiet,
) -> tuple[Pull, dict[str, Any] | None]:
    """Take what was changed in the .blend of a city into the city, as one revision.

    Parameters
    ----------
    folder
        Folder of a built city.
    blend
        The file that the artist saved; ``city.blend`` of the folder when left out.
    dry_run
        Whether only to look.
    removals
        Whether more than a fifth of a layer may go.
    say
        Called with one line of progress at a time.

    Returns
    -------
    found, report
        What differs, and the report of the changed city; None where nothing was changed.

    Raises
    ------
    InputError
        If there is no .blend, or it cannot be read, or shows another city.
    Conflict
        If it shows an older revision of the city.
    UsageError
        If more is gone than `removals` admits.
    """
    path = folder / BLEND if blend is None else blend
    if not path.is_file():
        raise InputError(
            f"There is no {path}. A city is built with one by: cityx build ... --formats blend"
        )
    with Desk(folder) as desk:
        revision = desk.revision
        numbers = [*sorted((r.number for r in desk.revisions()), reverse=True)]
        say("reading city.blend")
        found = differences(folder, path, numbers)
        held = set(_held_curves(desk.city))
        erased = tuple(name for name in found.erased if name in held)
        found = replace(found, drawn=tuple(_new_curves(found, desk.city)), erased=erased)
        _bounded(found, desk, removals)
        calls = calls_of(found, desk.city)
        if dry_run or not calls:
            return found, None
        done = desk.change(calls, text=TEXT, expected=revision)
        # The artist's file goes where the state is kept that it shows: objects of their own are
        # in no other.
        kept = folder / HISTORY / str(revision) / BLEND
        shutil.copyfile(path, kept)
        report = renew(folder, desk.city, Request(), done, say)
        if found.foreign and (folder / BLEND).exists():
            say("carrying own objects over")
            _carry(kept, folder / BLEND, [item["name"] for item in found.foreign])
        return found, report


def _new_curves(found: Pull, city: City) -> Iterator[Mapping[str, Any]]:
    """Yield the curves that the city has not, or otherwise."""
    held = _held_curves(city)
    for curve in found.drawn:
        points = plain_line(np.array(curve["points"]))
        known = held.get(curve["name"])
        if known is None or not shapely.equals_exact(known, shapely.LineString(points), SLACK):
            yield {"name": curve["name"], "points": points}


def _held_curves(city: City) -> dict[str, shapely.LineString]:
    """Return the curves of a city by their names."""
    table = city.layout.lines
    own = table[table["kind"].to_numpy() == CURVE]
    return dict(zip(own["source"].tolist(), own.geometry.tolist(), strict=True))


def differences(folder: Path, path: Path, numbers: Sequence[int]) -> Pull:
    """Compare a .blend with the city of a folder, in a Blender process.

    Parameters
    ----------
    folder
        Folder of the city.
    path
        The .blend.
    numbers
        Revisions of the city, the newest first.

    Raises
    ------
    InputError, Conflict, EngineError
        As of `pull`.
    """
    past = [(n, folder / HISTORY / str(n)) for n in numbers[1:]]
    stores = [(numbers[0] if numbers else 0, folder / STORE)]
    stores += [(number, store) for number, store in past if (store / "city.json").is_file()]
    with tempfile.TemporaryDirectory(prefix="cityx-pull-") as work:
        answer = Path(work) / "result.json"
        job = {
            "blend": str(path.resolve()),
            "stores": [str(store.resolve()) for _, store in stores],
            "result": str(answer),
        }
        code, log = run_module("cityx.blender.pull", job, Path(work))
        if code or not answer.exists():
            raise EngineError(f"Blender could not compare {path}. Its last words:\n{log}")
        record = json.loads(answer.read_text())
    if "unreadable" in record:
        raise InputError(f"{path}: {record['unreadable']}.")
    if "state" not in record:
        raise InputError(
            f'{path} shows another city ("{record["name"]}"), or a state of this one that is not '
            "kept; pull it into the folder that it was built in."
        )
    if record["state"]:
        shown = stores[record["state"]][0]
        raise Conflict(
            f"{path} shows revision {shown}, and the city has revision {stores[0][0]} by now. "
            f"Put the file aside as mine.blend, go back with: cityx undo {folder} --to {shown}, "
            f"then: cityx pull {folder} --blend mine.blend"
        )
    del record["state"]
    return Pull(**{name: tuple(values) for name, values in record.items()})


def _carry(source: Path, target: Path, names: Sequence[str]) -> None:
    """Append an artist's own objects to the city made anew."""
    job = {
        "source": str(source.resolve()), "target": str(target.resolve()), "names": list(names),
    }  # fmt: skip
    with tempfile.TemporaryDirectory(prefix="cityx-carry-") as work:
        code, log = run_module("cityx.blender.carry", job, Path(work))
    if code:
        raise EngineError(
            f"The city was changed, but your own objects stayed in {source}. Blender's last "
            f"words:\n{log}"
        )


def _bounded(found: Pull, desk: Desk, removals: bool) -> None:
    """Ask before a large part of the city goes: a layer is easily deleted by mistake."""
    gone = np.array([int(text, 16) for text in found.removed], np.uint64)
    scene = desk.city.scene
    held = {name: batch.object_id for name, batch in scene.meshes.items()}
    held |= {name: rows.object_id for name, rows in scene.instances.items()}
    large = []
    for layer, ids in held.items():
        lost = int(np.isin(ids, gone).sum())
        if lost > max(FEW, MOST_REMOVED * len(ids)):
            large.append(f"{lost} of {len(ids)} {layer.replace('_', ' ')}")
    if large and not removals:
        raise UsageError(
            f"{' and '.join(large)} are gone from {BLEND}. If that is meant, pull with "
            "--removals; nothing was changed."
        )
