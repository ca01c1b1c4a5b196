"""Editing tiles: a sentence is read and tried on the stores of tiles, which are then built anew.

It is tried as on any city, by the same desk and the same gate, on a copy of the store of a tile
that goes when it is done. What ran there is kept as an edit of the tiles (`cityx.tiles.edits`).
"""

from __future__ import annotations

import os
import re
import shutil
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import shapely

from cityx.city.store import read_city
from cityx.errors import InputError, UsageError
from cityx.language import read_brief
from cityx.options import PlannerChoice
from cityx.projects.desk import STORE, Conflict, Desk
from cityx.projects.edit import NEW, OFFLINE, REDO, UNDO, Plan, edit_city, planned, roles_at
from cityx.protocol.gate import Call
from cityx.protocol.objects import find_objects
from cityx.sources.osm.elements import OsmMap, way_lines
from cityx.tiles.actions import SKIPPED
from cityx.tiles.edits import Edit, Edits, ids_in, is_whole, read_edits, united, write_edits
from cityx.tiles.grid import Tile, in_order, tile_named, tiles_of
from cityx.tiles.order import Order, read_order
from cityx.tiles.plane import box_in_frame_of, origin_of, plane_land
from cityx.tiles.run import FRAGMENTS, TILES, Say, Summary, alone, build_tiles, records
from cityx.tiles.split import read_fragment
from cityx.tiles.tile import CITY

TRIED = ".edit.partial"  # folder of the copies on which a sentence is tried
REACH = 100.0  # metres about a street or land within which a change of it shows; see docs/tiles.md
WHOLE_SITE = (*SKIPPED, "edit/time", "edit/air")  # actions on what tiles have not
WHICH = "Which "  # how a question begins of which there are several
SHOWN = 6  # tiles that a message names
_ELEMENT = re.compile(r"osm/(way|relation)/(\d+)")


@dataclass
class Edited:
    """What came of a sentence.

    Attributes
    ----------
    number
        How many edits hold now.
    tiles
        Those that it touches, built or not.
    reports
        That of each tile on which it was tried, as of `cityx.projects.edit.edit_city`.
    summary
        Of the tiles that were built anew.
    """

    number: int
    tiles: list[Tile]
    reports: dict[Tile, dict[str, Any]]
    summary: Summary


def edit_tiles(
    folder: Path, text: str, *, at: Tile | None = None, files: Sequence[Path] = (),
    choice: PlannerChoice = OFFLINE, workers: int = 1, cluster: str = "", say: Say,
) -> Edited:  # fmt: skip
    """Change tiles as a sentence says and build anew those that it touches.

    Parameters
    ----------
    at
        The tile that the sentence speaks of; every built one when left out. Then it may name one
        thing, or add any, only if one tile alone answers.
    files, choice
        As of `cityx.projects.edit.edit_city`.

    Raises
    ------
    Clarify, UsageError
        If the sentence cannot be carried out; nothing is changed.
    InputError
        If there is no tile with a store to read it on.
    Conflict
        If another process edited the tiles meanwhile.
    """
    order, _ = read_order(folder)
    edits = read_edits(folder)
    if steps := _steps(text, edits):
        after = edits.moved(steps)
        number, tiles, summary = _kept(folder, order, edits, after, workers, cluster, say)
        return Edited(number, tiles, {}, summary)
    stored = [tile for tile in records(folder) if _has_store(folder, tile) and at in (None, tile)]
    if not stored:
        where = f"Tile {at.name}" if at else str(folder)
        raise InputError(f"{where} has no store to edit; cityx tiles build makes it.")
    with _copies(folder, stored) as copies:
        meant = _meant(copies, text, files, choice, say)
        reports: dict[Tile, dict[str, Any]] = {}
        calls: dict[Tile, list[Call]] = {}
        for tile in meant:
            say(f"{tile.name}: {text}")
            reports[tile] = edit_city(copies[tile], text, files=files, say=say, choice=choice)
            calls[tile] = _ran(copies[tile])
    edit = Edit(text, _of_tiles(folder, order, calls))
    after = edits.with_edit(edit)
    number, tiles, summary = _kept(folder, order, edits, after, workers, cluster, say)
    return Edited(number, tiles, reports, summary)


def _steps(text: str, edits: Edits) -> int:
    """Return how many edits a sentence takes back, negative, or makes again; 0 if it does neither.

    Raises
    ------
    UsageError
        If it asks for more besides.
    """
    wishes = read_brief(text, base=True).edits
    steps = [wish for wish in wishes if wish.verb in (UNDO, REDO)]
    if not steps:
        return 0
    if len(wishes) > 1:
        raise UsageError(
            f'"{text}" takes an edit of tiles back and asks for more; say the two one by one.'
        )
    verb = steps[0].verb
    count = dict(steps[0].change)[verb]
    room = edits.done if verb == UNDO else len(edits.every) - edits.done
    number = max(room, 1) if count == "all" else max(int(float(count)), 1)
    return -number if verb == UNDO else number


def _kept(
    folder: Path, order: Order, before: Edits, after: Edits, workers: int, cluster: str, say: Say
) -> tuple[int, list[Tile], Summary]:
    """Keep edits and build the tiles anew that they change."""
    with alone(folder):
        if read_edits(folder) != before:
            raise Conflict(f"{folder} was edited by another process; say it again.")
        write_edits(after, folder)
    named = {name for edit in (*before.every, *after.every) for name in edit.calls}
    touched = [tile for tile in in_order(map(tile_named, sorted(named)))
               if before.of(tile) != after.of(tile)]  # fmt: skip
    there = records(folder)
    summary = Summary()
    for store in (True, False):
        anew = [
            one for one in in_order(touched) if one in there and _has_store(folder, one) == store
        ]
        if anew:
            done = build_tiles(
                folder, order, anew, workers=workers, cluster=cluster, store=store, say=say
            )
            summary = summary.plus(done)
    return after.done, touched, summary


def _has_store(folder: Path, tile: Tile) -> bool:
    return (folder / TILES / tile.name / CITY).is_dir()


@contextmanager
def _copies(folder: Path, tiles: Sequence[Tile]) -> Iterator[dict[Tile, Path]]:
    """Make folders of cities out of the stores of tiles, linked and not copied where that works."""
    place = folder / TRIED
    shutil.rmtree(place, ignore_errors=True)
    try:
        found = {}
        for tile in tiles:
            found[tile] = place / tile.name
            store = folder / TILES / tile.name / CITY
            shutil.copytree(store, found[tile] / STORE, copy_function=_linked)
        yield found
    finally:
        shutil.rmtree(place, ignore_errors=True)


def _linked(source: str, target: str) -> None:
    try:
        os.link(source, target)
    except OSError:
        shutil.copy2(source, target)


def _meant(
    copies: Mapping[Tile, Path], text: str, files: Sequence[Path], choice: PlannerChoice, say: Say
) -> list[Tile]:
    """Return the tiles in which a sentence can be carried out.

    Raises
    ------
    UsageError
        If it can in none, or in several though it means one thing.
    """
    plans: dict[Tile, Plan] = {}
    faults: dict[Tile, UsageError] = {}
    for tile, folder in copies.items():
        say(f"reading {tile.name}")
        with Desk(folder) as desk, roles_at(desk, choice) as roles:
            try:
                plans[tile] = planned(desk, text, files, roles=roles)
            except UsageError as error:
                faults[tile] = error
    which = [tile for tile, error in faults.items() if str(error).startswith(WHICH)]
    if not plans:
        told = faults[which[0] if which else min(faults)]
        raise told
    refused = sorted({item.action for plan in plans.values() for item in plan.items
                      if item.action.startswith(WHOLE_SITE)})  # fmt: skip
    if refused:
        raise UsageError(
            f"{', '.join(refused)} is of a whole site; tiles have no hour, no weather and nothing "
            "that moves."
        )
    several = [*plans, *which]
    if len(several) > 1 and any(_means_one(plan) for plan in plans.values()):
        names = ", ".join(tile.name for tile in sorted(several)[:SHOWN])
        raise UsageError(
            f'"{text}" could be done in {len(several)} tiles ({names}); say where with --at X,Y or '
            "LAT,LON."
        )
    return sorted(plans)


def _means_one(plan: Plan) -> bool:
    """Return whether a plan is about things by their rank or number, or about something new."""
    wishes = plan.request.brief.edits
    selectors = [wish.target for wish in wishes if wish.target is not None]
    return any(wish.verb in NEW for wish in wishes) or any(
        one.alone or one.rank or one.k or one.nth or one.share is not None for one in selectors
    )


def _ran(folder: Path) -> list[Call]:
    """Return the calls of the last change of a city."""
    with Desk(folder) as desk:
        return [Call(step.action, step.args, {}) for step in desk.journal.steps(desk.revision)
                if step.status == "done"]  # fmt: skip


def _of_tiles(
    folder: Path, order: Order, calls: Mapping[Tile, Sequence[Call]]
) -> dict[str, tuple[Call, ...]]:
    """Give each tile its calls: its own, and those of streets and land of which it has a part."""
    found: dict[Tile, list[Call]] = {}
    reached = _plane_reached if order.plane is not None else _map_reached
    for tile, own in calls.items():
        for call in own:
            touched = {tile}
            if is_whole(call):
                touched |= reached(folder, order, tile, call)
            for one in touched:
                found.setdefault(one, []).append(call)
    return {tile.name: tuple(united(own)) for tile, own in sorted(found.items())}


def _map_reached(folder: Path, order: Order, tile: Tile, call: Call) -> set[Tile]:
    """Return the tiles of a map in which a change of wholes shows."""
    known = read_order(folder)[1]
    boxes = shapely.box(*np.array([one.box(order.size) for one in known]).T)
    near = shapely.dwithin(
        boxes, shapely.union_all(_whole_shapes(folder, order, tile, call)), REACH
    )
    return {known[row] for row in np.flatnonzero(near).tolist()}


def _plane_reached(folder: Path, order: Order, tile: Tile, call: Call) -> set[Tile]:  # noqa: ARG001
    """Return the tiles of the plane in which a change of wholes shows.

    A tile knows of a street what lies in its window; so the tiles that it reaches into are asked
    how it goes on.
    """
    found, asked = {tile}, set[Tile]()
    while left := sorted(found - asked):
        for one in left:
            x, y = origin_of(order, one)
            land = plane_land(order, one)
            ids = find_objects(land, ids_in([call]))
            for table in (land.layout.roads, land.layout.areas, land.layout.buildings):
                for shape in table[table["id"].isin(ids)].geometry:
                    west, south, east, north = shape.bounds
                    box = (west + x - REACH, south + y - REACH, east + x + REACH, north + y + REACH)
                    for there in tiles_of(box, order.size):
                        held = shapely.box(*box_in_frame_of(order, there, (x, y)))
                        if shapely.dwithin(held, shape, REACH):
                            found.add(there)
        asked |= set(left)
    return found


def _whole_shapes(folder: Path, order: Order, tile: Tile, call: Call) -> list[shapely.Geometry]:
    """Return the shapes of what a call names, with what lies of them beyond the tile."""
    city = read_city(folder / TILES / tile.name / CITY)
    osm, *_ = read_fragment(folder / FRAGMENTS / f"{tile.name}.npz")
    xy = order.frame.to_local(osm.lonlat)
    ids = find_objects(city, ids_in([call]))
    shapes: list[shapely.Geometry] = []
    for table in (city.layout.roads, city.layout.areas, city.layout.buildings):
        rows = table[table["id"].isin(ids)]
        shapes += rows.geometry.tolist()
        for element in filter(None, map(_ELEMENT.match, rows["source"])):
            ways = _ways_of(osm, element[1], int(element[2]))
            shapes += way_lines(osm, xy, ways)[0].tolist()
    return shapes


def _ways_of(osm: OsmMap, kind: str, number: int) -> list[int]:
    """Return the rows of the ways of an element of the map."""
    numbers = [number]
    if kind == "relation":
        rows = [row for row, one in enumerate(osm.relation_id) if one == number]
        numbers = [ref for row in rows for what, ref, _ in osm.members[row] if what == "way"]
    return [row for row in map(osm.way_row, numbers) if row >= 0]
