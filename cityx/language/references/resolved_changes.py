"""Resolved changes: the edits of a brief as arguments of actions: object ids, places, colours."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import combinations
from types import MappingProxyType
from typing import Any

import numpy as np
import shapely

from cityx.assets.outside_words import outside_pieces
from cityx.building.roofs.shapes import SHAPES
from cityx.checks.predicates.facts import Facts
from cityx.checks.predicates.junctions import Spots
from cityx.checks.predicates.thing_predicates import Selection
from cityx.checks.predicates.vocabulary import KINDS
from cityx.checks.predicates.words import COLORS
from cityx.city import City
from cityx.geometry.polygons import corners_of
from cityx.geometry.turns import SIDES
from cityx.ids import id_text
from cityx.language import Brief, Edit, Question, Reference, Selector, Slot
from cityx.language.asked import air_slots
from cityx.language.brief import Clarify, Note
from cityx.language.commands.earlier import GAP, NEW
from cityx.language.measurable import COLORS as NAMED
from cityx.language.measurable import things
from cityx.language.references.cleared import on_cleared_ground
from cityx.language.references.goals_here import KIND
from cityx.language.references.likeness import each_taken_over
from cityx.language.references.palette import PASTEL, TONE, softened
from cityx.language.references.parts import with_parts
from cityx.language.references.selecting import (
    MAIN_STREET,
    Nothing,
    Open,
    choose,
    chosen_by,
    listed,
    part_of_streets,
    place_of,
    place_selector,
    region_of,
)
from cityx.protocol.serving import Slots
from cityx.town.elements import ELEMENTS

LIST = "list"  # verb of what is told of the changed city and changes nothing
Meant = Sequence[tuple[Edit, Selection | None]]  # changes with the objects they are about

# Placing: what an edit that adds or sets something says of places and of the air, as slots.

# Words of a change that name a place -> the slot with the ids of what is meant.
_PLACES = {"along": "beside", "around": "beside", "in": "within", "on": "within", "near": "within",
           "of": "from", "at": "at", "to": "walk.goal", "from": "walk.origin",
           "over": "over"}  # fmt: skip


AT_SPOT = 7.0  # metres from the middle of a junction or a crossing to who is at it


def slots_of_places(edit: Edit, city: City) -> Slots:
    """Return where something is added, by the ids of streets and areas, and how strong the air is.

    Raises
    ------
    Open
        If there is no such place.
    """
    found: dict[str, tuple[Any, ...]] = {}
    grounds: list[Any] = []
    for key, value in edit.change:
        slot = _PLACES.get(key)
        if slot is None or edit.target is not None:
            continue
        if slot == "from" and edit.verb != "add":
            verb = edit.verb.replace("_", " ")
            raise Open(f"{verb} takes no side of {value}; say near, in or along what.")
        word = str(value)
        selector = replace(place_selector(word), alone=word == MAIN_STREET)
        chosen = choose(selector, city)
        if _is_ringed(edit, key, chosen):
            ring = place_of(Reference("around", (selector,)), city)
            found["ground"] = (corners_of(ring),)
            continue
        if edit.verb == "add_agent" and isinstance(chosen.layer, Spots):
            grounds.append(shapely.union_all(chosen.shapes).buffer(AT_SPOT))
            continue
        if edit.verb == "add_building" and key == "near" and KINDS[chosen.layer.kind] == "land":
            found["ground"] = (corners_of(_beside_land(chosen)),)
            continue
        ids = tuple(id_text(int(one)) for one in _members(chosen))
        if _stands_in_rows(edit) and slot == "within" and KINDS[chosen.layer.kind] == "road":
            slot = "beside"
        found[slot] = ((*found.get(slot, ((),))[0], *ids),)
    if edit.target is None:
        found |= _told_by_others(edit, city, found)
        found |= _on_side(edit, city)
    if grounds:
        found = {"at": (), **found, "ground": (corners_of(shapely.union_all(grounds)),)}
    return {**found, **air_slots(edit.change)}


def _stands_in_rows(edit: Edit) -> bool:
    """Return whether what is new stands in rows: trees, and things told every so many metres."""
    from cityx.edit.land.lining import THINGS

    change = dict(edit.change)
    return edit.verb == "plant" or ("spacing" in change and change.get("element") in THINGS)


def _on_side(edit: Edit, city: City) -> dict[str, tuple[Any, ...]]:
    """Return the half of the site in which things are added that a side alone tells the place of.

    What is laid out with its ground takes the side itself.
    """
    from cityx.edit.land.add_element import LYING

    said = dict(edit.change)
    side = str(said.get("side", "")).replace("_", "")
    if edit.verb not in ("add", "plant") or side not in SIDES or "of" in said or edit.refs:
        return {}
    if said.get("element") in LYING or any(key in _PLACES for key in said):
        return {}
    xmin, ymin, xmax, ymax = city.layout.extent
    x, y = SIDES[side]
    west, east = ((xmin + xmax) / 2 if x > 0 else xmin), ((xmin + xmax) / 2 if x < 0 else xmax)
    south, north = ((ymin + ymax) / 2 if y > 0 else ymin), ((ymin + ymax) / 2 if y < 0 else ymax)
    return {"ground": (corners_of(shapely.box(west, south, east, north)),)}


def _beside_land(chosen: Selection) -> Any:
    """Return the ground beside land, on which a house is by a park or a river and not in it."""
    land = shapely.union_all(shapely.make_valid(chosen.grounds))
    return shapely.difference(shapely.buffer(land, BESIDE), land)


def _is_ringed(edit: Edit, key: str, chosen: Selection) -> bool:
    """Return whether things are put on the ground round objects, and not along or in them."""
    if KINDS[chosen.layer.kind] in ("road", "land"):
        return False
    element = str(dict(edit.change).get("element", ""))
    round_it = key == "around" and edit.verb == "add" and element not in BARRIERS
    return round_it or (edit.verb == "plant" and key in ("around", "near"))


BARRIERS = ("hedge", "fence", "wall")  # which run around houses themselves


# Relations by which objects themselves tell a place -> the slot with their ids.
_BY_IDS = {
    "along": "beside",
    "in": "within",
    "on": "within",
    "to": "within",
    "near": "within",
    "start": "start",
    "end": "end",
    "facing": "toward",
}


def _told_by_others(edit: Edit, city: City, found: Mapping[str, Any]) -> dict[str, tuple[Any, ...]]:
    """Return the places that other objects tell: their ids, or the ground before or between them.

    Things are spread around what is neither a street nor land.
    """
    grounds: list[Any] = []
    made: dict[str, tuple[Any, ...]] = {}
    each = "each" in dict(edit.change)
    for one in edit.refs:
        if one.side and _is_row(one, edit):
            chosen = choose(one.spots[0], city)
            own = tuple(id_text(int(each)) for each in _members(chosen))
            made |= {"beside": (own,), "row.part": (corners_of(place_of(one, city)),)}
            continue
        slot = _BY_IDS.get(one.key) if not one.amount and not one.side else None
        slot = None if one.key == "end" and edit.verb != "add_path" else slot
        if slot is None:
            grounds += _ground_at_each(one, city) if each else [place_of(one, city)]
            continue
        chosen = choose(one.spots[0], city)
        if edit.verb == "add_agent" and isinstance(chosen.layer, Spots):
            grounds.append(shapely.union_all(chosen.shapes).buffer(AT_SPOT))
            made["at"] = ()
            continue
        if edit.verb == "add_agent" and slot == "within":
            slot = "at"  # who is at a thing; things are put within a place
        ids = tuple(id_text(int(each)) for each in _members(chosen))
        made[slot] = ((*made.get(slot, found.get(slot, ((),)))[0], *ids),)
    if grounds:
        whole = shapely.GeometryCollection(grounds) if each else shapely.union_all(grounds)
        made["ground"] = (corners_of(whole),)
    return made


def _is_row(one: Reference, edit: Edit) -> bool:
    """Return whether things stand in a row beside a way or water, on one side of it."""
    long = dict(edit.change).get("element") in BARRIERS or "spacing" in dict(edit.change)
    return one.key == "along" or (one.key == "side" and long)


def _ground_at_each(reference: Reference, city: City) -> list[Any]:
    """Return the ground before each building, or at each corner or end of a place, by itself."""
    if reference.key in ("before", "behind", "opposite"):
        chosen = choose(reference.spots[0], city)
        own = [Selector(ids=(id_text(int(one)),)) for one in chosen.ids]
        found = [place_of(replace(reference, spots=(one,)), city) for one in own]
    else:
        found = [*shapely.get_parts(place_of(reference, city))]
    return [max(shapely.get_parts(shape).tolist(), key=lambda part: part.area) for shape in found]


def _members(chosen: Selection) -> Any:
    return chosen.layer.members(chosen.rows)


_ELSE = re.compile(r"\b(else|rest|other)", re.IGNORECASE)


def _kept(brief: Brief, city: City) -> Iterator[tuple[Slot, Selection]]:
    """Yield what is to stay as it is, with its words; names of nothing are passed over."""
    for slot in brief.kept:
        word = str(slot.value)
        if word == "everything" and _ELSE.search(brief.text, slot.span[0], slot.span[1] + 6):
            continue  # what changes is no part of all else
        try:
            kept = choose(Selector(kind=word) if things(word) else Selector(ids=(word,)), city)
        except Open:
            continue
        yield slot, kept


def left_alone(brief: Brief, chosen: Selection, city: City) -> Selection:
    """Return the things of a larger group that change: those that are kept are none of them."""
    for _, kept in _kept(brief, city):
        others = ~np.isin(chosen.ids, kept.ids)
        if others.any():
            chosen = chosen.where(others)
    return chosen


def _against_what_is_kept(
    brief: Brief, meant: Meant, city: City
) -> Iterator[tuple[Question, tuple[Edit]]]:
    """Ask where something is to stay as it is and to change: "remove all trees, keep every tree".

    What is left alone of a larger group is no contradiction: the rest of the group changes.
    """
    for slot, kept in _kept(brief, city):
        for edit, chosen in meant:
            if chosen is not None and set(chosen.ids.tolist()) <= set(kept.ids.tolist()):
                question = Question(
                    f'"{slot.text}" is to stay as it is, but {edit.verb.replace("_", " ")} would '
                    f"change {chosen.examples()}; which of the two?"
                )
                yield question, (edit,)


# Contradictions: changes of one request that cannot all hold, found before anything runs.

# What an object can have but one of; "set_height" and "raise_floors" speak of the same.
_ABOUT: Mapping[str, str] = {
    "height": "height", "floors": "height", "color": "color", "material": "material",
    "style": "style", "roof": "roof",
}  # fmt: skip
_OUTRIGHT = ("set_", "scale_", "raise_")
_SEVERAL = ("direction",)  # keys of a change that may have several values: "north and east"


def contradictions(meant: Meant) -> list[Question]:
    """Return what has to be settled before changes run.

    Parameters
    ----------
    meant
        Each change with the objects it is about, None for none.
    """
    found = (*_two_values(meant), *_against_each_other(meant))
    return [question for question, _ in found]


def _two_values(meant: Meant) -> Iterator[tuple[Question, tuple[Edit]]]:
    """Ask about "make b07 red and blue"."""
    for edit, _ in meant:
        for key in dict.fromkeys(key for key, _ in edit.change if key not in _SEVERAL):
            values = dict.fromkeys(str(value) for name, value in edit.change if name == key)
            shapes = [value for value in values if value in SHAPES]
            if key in ("roof", "building.roof") and len(shapes) == len(values) - 1 == 1:
                continue  # "a gabled slate roof" has a shape and a covering
            if len(values) > 1:
                said = f"{' and '.join(values)} cannot both be the {key}; which?"
                yield Question(said, tuple(values)), (edit,)


def _against_each_other(meant: Meant) -> Iterator[tuple[Question, tuple[Edit, Edit]]]:
    """Ask about "make b07 taller and delete b07"."""
    for (first, some), (second, others) in combinations(meant, 2):
        if some is None or others is None or type(some.layer) is not type(others.layer):
            continue
        shared = some.where(np.isin(some.ids, others.ids))
        if len(shared.rows) and _clash(first, second):
            question = Question(
                f"{_named(first)} and {_named(second)} are both asked of {shared.examples()}; "
                "which of the two?",
                (_named(first), _named(second)),
            )
            yield question, (first, second)


def _clash(first: Edit, second: Edit) -> bool:
    if "remove" in (first.verb, second.verb):
        return first.verb != second.verb
    about = {_about(first), _about(second)}
    same = first.verb == second.verb and first.change == second.change
    return len(about) == 1 and about != {""} and not same


def _about(edit: Edit) -> str:
    """Return what a change settles of an object, "" for what may be done twice."""
    if not edit.verb.startswith(_OUTRIGHT):
        return "all" if edit.verb == "replace" else ""
    return _ABOUT.get(edit.verb.partition("_")[2], "")


def _named(edit: Edit) -> str:
    values = ", ".join(str(value) for _, value in edit.change)
    return edit.verb.replace("_", " ") + (f" {values}" if values else "")


Found = dict[str, tuple[Any, ...]]

APART = 4.0  # metres between something and what is put near it or beside it
BESIDE = 60.0  # metres beyond its width within which a copy stands whose place is left open
FARTHEST = 200.0  # metres that anything may end from where it is meant to
SETTLE = 25.0  # metres around a place told in words within which room is looked for
_COLOR_KEYS = ("color", "building.color", "roof.color")
_ANEW = ("add", "add_building", "replace")  # verbs of what has walls and a roof of its own
_RELATIONS: Mapping[str, str] = MappingProxyType({"in": "in", "on": "in", "near": "near"})
_MOVES = ("move", "copy")


def slots_of_edits(brief: Brief, city: City) -> list[tuple[Edit, Slots]]:
    """Return the changes of a brief, each with what actions take of it.

    Besides what the sentence says there are "objects", the ids of what is meant, as 16 hexadecimal
    digits each; "family", what they are: a family of `cityx.checks.predicates.vocabulary.KINDS`;
    "rgb", a colour as 0xRRGGBB; "offset" and "settle", how far something is moved and how far from
    there it may end, metres.

    Raises
    ------
    Clarify
        If it is open which objects are meant, or changes contradict each other.
    """
    found, asked, _ = changes_here(brief, city)
    if asked:
        questions = dict.fromkeys(question for question, _ in asked)
        raise Clarify(replace(brief, questions=(*brief.questions, *questions)))
    return found


Asked = list[tuple[Question, tuple[Edit, ...]]]  # each with the changes that it is about


def changes_here(
    brief: Brief, city: City
) -> tuple[list[tuple[Edit, Slots]], Asked, list[Note]]:  # fmt: skip
    """Return the changes of a brief as of `slots_of_edits`, and what is to be asked of them.

    The notes are of changes with nothing to do, as of what is to go and is not there.
    """
    idle: list[Note] = []
    found: list[tuple[Edit, Slots]] = []
    meant: list[tuple[Edit, Selection | None]] = []
    said_by: dict[Edit, Edit] = {}  # what a change stands for -> as it was said
    asked: Asked = []
    for said in on_cleared_ground(brief.edits, city):
        if said.verb == LIST:
            continue
        try:
            if said.verb in NEW and any(one.key == GAP for one in said.refs):
                raise Open("Which ground is meant? It is not known what clears it; name a place.")
            for edit in each_taken_over(said, city):
                said_by[edit] = said
                chosen = chosen_by(edit, city)
                chosen = left_alone(brief, chosen, city) if chosen is not None else None
                meant.append((edit, chosen))
                words = brief.text[slice(*edit.span)]
                for own in _one_by_one(edit, chosen):
                    slots = with_parts(slots_of_edit(edit, own, city), words, own, city)
                    slots = {**slots, **slots_of_places(edit, city)}
                    found.append((edit, {key: held for key, held in slots.items() if held}))
                found += [(size, slots_of_edit(size, chosen, city)) for size in sizes_of(edit)]
        except Nothing as error:
            if is_idle(said):
                words = brief.text[slice(*said.span)].rstrip(".!? ").removesuffix(" and")
                idle.append(Note("idle", f'nothing to do for "{words}": {error.question.text}',
                                 said.span))  # fmt: skip
            else:
                asked.append((error.question, (said,)))
        except Open as error:
            asked.append((error.question, (said,)))
    asked += [
        (question, tuple(said_by[edit] for edit in edits))
        for question, edits in (*_two_values(meant), *_against_each_other(meant),
                                *_against_what_is_kept(brief, meant, city))
    ]  # fmt: skip
    return _joined(found), asked, idle


MOST_ANEW = 40  # buildings that others which are laid out with their ground take the place of


def _one_by_one(edit: Edit, chosen: Selection | None) -> list[Selection | None]:
    """Return what a change is about, one by one where each gives way to one laid out by itself."""
    from cityx.edit.buildings.replace_building import BUILT

    change = dict(edit.change)
    kind = change.get("building.type")
    each = edit.verb == "replace" and "each" in change and kind in ELEMENTS and kind not in BUILT
    if chosen is None or not each or not 1 < len(chosen.rows) <= MOST_ANEW:
        return [chosen]
    return [chosen.where(chosen.ids == one) for one in chosen.ids]


def is_idle(edit: Edit) -> bool:
    """Return whether a change holds already where there is nothing of what it is about.

    It is to go, or to be brought within a bound: all of it, and not one or so many.
    """
    target = edit.target
    if target is None or target.alone or target.ids or target.k or target.nth or target.rank:
        return False
    name = edit.verb.partition("_")[2]
    bounded = any(key.startswith(f"{name}.m") for key, _ in edit.change)
    beyond = any(text.startswith((f"{name}<", f"{name}>")) for text in target.filters)
    return edit.verb == "remove" or (bounded and beyond)


def _joined(found: list[tuple[Edit, Slots]]) -> list[tuple[Edit, Slots]]:
    """Let parts of one command share what is said once: "12 buses and 40 mph traffic"."""
    speeds = {(edit.span, slots.get("path")): slots["speed"] for edit, slots in found
              if edit.verb == "add_traffic" and "speed" in slots}  # fmt: skip
    kept: list[tuple[Edit, Slots]] = []
    colors = {slots["objects"]: slots["rgb"] for edit, slots in found if edit.verb == "set_color"
              and "objects" in slots and "rgb" in slots}  # fmt: skip
    clad = [slots.get("objects", ()) for edit, slots in found if edit.verb == "set_material"]
    for edit, slots in found:
        own = slots.get("objects", ())
        if edit.verb == "set_color" and own in clad:
            continue
        if edit.verb == "set_material" and own in colors:
            slots = {**slots, "rgb": colors[own]}
        place = (edit.span, slots.get("path"))
        if edit.verb == "add_agent" and place in speeds:
            slots = {"speed": speeds[place], **slots}
        kept.append((edit, slots))
    return kept


def sizes_of(edit: Edit) -> list[Edit]:
    """Return the changes by which a building that replaces another gets the size asked for."""
    if edit.verb != "replace" or "building.type" not in dict(edit.change):
        return []
    said = [(key.removeprefix("building."), value) for key, value in edit.change]
    return [
        replace(edit, verb=f"set_{key.partition('.')[0]}", change=((key, value),))
        for key, value in said if key.partition(".")[0] in ("floors", "height")
    ]  # fmt: skip


def slots_of_edit(edit: Edit, chosen: Selection | None, city: City) -> Slots:
    """Return what actions take of one change.

    Parameters
    ----------
    edit
        The change.
    chosen
        The objects that it is about, None for none.
    city
        Where they are.

    Raises
    ------
    Open
        If a place or a distance is not settled.
    """
    slots: Found = {}
    for key, value in edit.items():
        slots[key] = (*slots.get(key, ()), value)
    if edit.verb == "replace" and chosen is not None:
        together = chosen.count > 1 and any(one.key == GAP for one in edit.refs)
        together &= "each" not in slots
        slots.pop("each", None)
        slots |= _own_ground(slots.get("building.type", ()), chosen, together=together)
        slots = {key: value for key, value in slots.items() if value}
    outside = tuple(word for word in slots.get("element", ()) if word in outside_pieces())
    if edit.verb == "add" and outside:
        slots["outside_thing"] = outside
    if edit.verb == "raise_lanes":  # "by" is a width
        slots["lanes.by"] = slots.pop("by")
    for key, value in edit.change:
        if key in _COLOR_KEYS:
            rgb = _rgb(str(value))
            name = "roof.rgb" if key == "roof.color" and edit.verb in _ANEW else "rgb"
            slots[name] = (softened(rgb) if (TONE, PASTEL) in edit.change else rgb,)
    for key in ("building.material", "building.roof"):  # what a look of the whole city calls it
        if key in slots:
            slots.setdefault(key.rpartition(".")[2], slots[key])
    if chosen is not None:
        slots["objects"] = (tuple(id_text(int(one)) for one in chosen.ids),)
        slots["family"] = (KINDS[chosen.layer.kind],)
        slots[KIND] = (chosen.layer.kind,)
        part = None if edit.target is None else part_of_streets(edit.target, chosen, city)
        if part is not None:
            slots["part"] = (corners_of(part),)
        if edit.verb in _MOVES:
            slots |= _way(edit, chosen, city)
    return slots


def _own_ground(kinds: Sequence[Any], chosen: Selection, *, together: bool) -> Found:
    """Return a building that is laid out with its ground as an element in the place of others.

    Other kinds are built on the footprint of what they replace.

    Parameters
    ----------
    together
        Whether one takes the place of all, on the ground that they leave.

    Raises
    ------
    Open
        If one is to stand in the place of several.
    """
    from cityx.edit.buildings.replace_building import BUILT

    kind = str(kinds[0]) if kinds else ""
    if kind not in ELEMENTS or (kind in BUILT and not together):
        return {}
    if chosen.count > 1 and not together:
        said = kind.replace("_", " ")
        raise Open(f"One {said} in the place of all {chosen.count}, or one for each? Name one of "
                   "them, as by its id or a rank.", listed(chosen))  # fmt: skip
    return {"element": (kind,), "building.type": ()}


def _rgb(word: str) -> int:
    word = NAMED.get(word, word)
    if word not in COLORS:
        raise Open(f'The colour "{word}" is not known; {", ".join(COLORS)} are.')
    return COLORS[word][0]


def _way(edit: Edit, chosen: Selection, city: City) -> Found:
    """Return how far things are moved: as said, or to a place that is named."""
    change = dict(edit.change)
    anywhere = not edit.refs and not {"direction", "by", *_RELATIONS, "side"} & change.keys()
    if edit.verb == "copy" and anywhere:
        half = _half_width(chosen)
        return {"offset": ((2 * half + APART, 0.0),), "settle": (min(BESIDE + 2 * half, FARTHEST),)}
    towards = [str(value) for key, value in edit.change if key == "direction"]
    if towards and "by" in change:
        way = sum((np.array(SIDES[word]) for word in towards), np.zeros(2))
        length = float(np.hypot(*way))
        if not length:
            raise Open(f"{' and '.join(towards)} lead nowhere; which way?")
        step = way / length * float(change["by"])
        return {"offset": ((float(step[0]), float(step[1])),), "settle": (0.0,)}
    if towards or "by" in change:
        missing = "By how far?" if towards else "Which way?"
        raise Open(f"{missing} Say it as in: move b03 10 m north.")
    place = _place(edit, chosen, city)
    if place is None:
        return {}
    step = place - _middle(chosen)
    settle = 0.0 if "off" in change else SETTLE
    return {"offset": ((float(step[0]), float(step[1])),), "settle": (settle,)}


def _middle(chosen: Selection) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    points = shapely.get_coordinates(shapely.centroid(chosen.shapes))
    return np.asarray(points.mean(axis=0))


def _middle_of(region: Any) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    """Return the middle of a region, or a place in it where the middle lies outside, (2,)."""
    inner = shapely.point_on_surface(region)
    middle = shapely.centroid(region)
    at = middle if shapely.intersects(region, middle) else inner
    return np.asarray(shapely.get_coordinates(at)[0])


def _place(
    edit: Edit, chosen: Selection, city: City
) -> np.ndarray[tuple[int], np.dtype[np.float64]] | None:
    """Return the place that words name, (2,): in, near or on a side of something."""
    facts = Facts(city)
    half = _half_width(chosen)
    if edit.refs:
        return _middle_of(shapely.union_all([place_of(one, city) for one in edit.refs]))
    change = edit.change
    said = {key: str(value) for key, value in change}
    for key, relation in _RELATIONS.items():
        if key not in said:
            continue
        region = region_of(said[key], facts)
        if relation == "in":
            return _middle_of(region)
        return _beside(region, _middle(chosen), half)
    if "side" in said and said.get("of"):
        region = region_of(said["of"], facts)
        way = np.array(SIDES[said["side"].replace("_", "")])
        way = way / np.hypot(*way)
        xmin, ymin, xmax, ymax = region.bounds
        reach = np.array([xmax - xmin, ymax - ymin]) / 2
        gap = APART + half if "off" not in said else float(said["off"])
        off = float(np.abs(way) @ reach) + gap
        return np.asarray(np.array([(xmin + xmax) / 2, (ymin + ymax) / 2]) + way * off)
    return None


def _beside(
    region: Any, start: np.ndarray[tuple[int], np.dtype[np.float64]], half: float
) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    """Return the place before a region, on the side from which something comes."""
    ends = shapely.get_coordinates(shapely.shortest_line(region, shapely.Point(start)))
    way = ends[1] - ends[0]
    far = float(np.hypot(*way))
    way = way / far if far > 0 else np.array([1.0, 0.0])
    return np.asarray(ends[0] + way * (APART + half))


def _half_width(chosen: Selection) -> float:
    bounds = shapely.bounds(chosen.shapes)
    return float(np.max(bounds[:, 2:] - bounds[:, :2]) / 2) if len(bounds) else 0.0
