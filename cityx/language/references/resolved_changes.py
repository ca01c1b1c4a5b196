"""Changes: what the edits of a brief mean for actions: objects by their ids, places, colours."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from types import MappingProxyType
from typing import Any

import numpy as np
import shapely

from cityx.checks.predicates.facts import Facts
from cityx.checks.predicates.thing_predicates import Selection
from cityx.checks.predicates.vocabulary import KINDS
from cityx.checks.predicates.words import COLORS
from cityx.city import City
from cityx.geometry.compass import SIDES
from cityx.ids import id_text
from cityx.language import Brief, Edit, Question
from cityx.language.brief import Clarify, Value
from cityx.language.measurable import COLORS as NAMED
from cityx.language.references.contradictions import contradictions
from cityx.language.references.parts import with_parts
from cityx.language.references.placing import left_alone, protected, slots_of_places
from cityx.language.references.selecting import Open, chosen_by, region_of
from cityx.protocol.serving import Slots

Found = dict[str, tuple[Any, ...]]

GAP = 4.0  # metres between something and what is put near it or beside it
BESIDE = 60.0  # metres beyond its width within which a copy stands whose place is left open
FARTHEST = 200.0  # metres that anything may end from where it is meant to
SETTLE = 25.0  # metres around a place told in words within which room is looked for
_COLOR_KEYS = ("color", "building.color", "roof.color")
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
    found: list[tuple[Edit, Slots]] = []
    meant: list[tuple[Edit, Selection | None]] = []
    questions: list[Question] = []
    for edit in brief.edits:
        try:
            chosen = chosen_by(edit, city)
            chosen = left_alone(brief, chosen, city) if chosen is not None else None
            meant.append((edit, chosen))
            slots = slots_of_edit(edit, chosen, city)
            slots = with_parts(slots, brief.text[slice(*edit.span)], chosen, city)
            found.append((edit, {**slots, **slots_of_places(edit, city)}))
            found += [(size, slots_of_edit(size, chosen, city)) for size in sizes_of(edit)]
        except Open as error:
            questions.append(error.question)
    questions += [*contradictions(meant), *protected(brief, meant, city)]
    if questions:
        raise Clarify(replace(brief, questions=(*brief.questions, *questions)))
    return _joined(found)


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
    """Return the changes by which a building that replaces another gets the floors asked for."""
    if edit.verb != "replace" or "building.type" not in dict(edit.change):
        return []
    said = [(key.removeprefix("building."), value) for key, value in edit.change]
    return [
        replace(edit, verb=f"set_{key.partition('.')[0]}", change=((key, value),))
        for key, value in said if key.partition(".")[0] == "floors"
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
    if edit.verb == "raise_lanes":  # "by" is a width
        slots["lanes.by"] = slots.pop("by")
    for key, value in edit.change:
        if key in _COLOR_KEYS:
            slots["rgb"] = (_rgb(str(value)),)
    for key in ("building.material", "building.roof"):  # what a look of the whole city calls it
        if key in slots:
            slots.setdefault(key.rpartition(".")[2], slots[key])
    if chosen is not None:
        slots["objects"] = (tuple(id_text(int(one)) for one in chosen.ids),)
        slots["family"] = (KINDS[chosen.layer.kind],)
        if edit.verb in _MOVES:
            slots |= _way(edit, chosen, city)
    return slots


def _rgb(word: str) -> int:
    word = NAMED.get(word, word)
    if word not in COLORS:
        raise Open(f'The colour "{word}" is not known; {", ".join(COLORS)} are.')
    return COLORS[word][0]


def _way(edit: Edit, chosen: Selection, city: City) -> Found:
    """Return how far things are moved: as said, or to a place that is named."""
    change = dict(edit.change)
    if edit.verb == "copy" and not {"direction", "by", *_RELATIONS, "side"} & change.keys():
        half = _half_width(chosen)
        return {"offset": ((2 * half + GAP, 0.0),), "settle": (min(BESIDE + 2 * half, FARTHEST),)}
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
    place = _place(edit.change, chosen, city)
    if place is None:
        return {}
    step = place - _middle(chosen)
    settle = 0.0 if "off" in change else SETTLE
    return {"offset": ((float(step[0]), float(step[1])),), "settle": (settle,)}


def _middle(chosen: Selection) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    points = shapely.get_coordinates(shapely.centroid(chosen.shapes))
    return np.asarray(points.mean(axis=0))


def _place(
    change: tuple[tuple[str, Value], ...], chosen: Selection, city: City
) -> np.ndarray[tuple[int], np.dtype[np.float64]] | None:
    """Return the place that words name, (2,): in, near or on a side of something."""
    said = {key: str(value) for key, value in change}
    facts = Facts(city)
    half = _half_width(chosen)
    for key, relation in _RELATIONS.items():
        if key not in said:
            continue
        region = region_of(said[key], facts)
        if relation == "in":
            inner = shapely.point_on_surface(region)
            middle = shapely.centroid(region)
            at = middle if shapely.intersects(region, middle) else inner
            return np.asarray(shapely.get_coordinates(at)[0])
        return _beside(region, _middle(chosen), half)
    if "side" in said and said.get("of"):
        region = region_of(said["of"], facts)
        way = np.array(SIDES[said["side"].replace("_", "")])
        way = way / np.hypot(*way)
        xmin, ymin, xmax, ymax = region.bounds
        reach = np.array([xmax - xmin, ymax - ymin]) / 2
        gap = GAP + half if "off" not in said else float(said["off"])
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
    return np.asarray(ends[0] + way * (GAP + half))


def _half_width(chosen: Selection) -> float:
    bounds = shapely.bounds(chosen.shapes)
    return float(np.max(bounds[:, 2:] - bounds[:, :2]) / 2) if len(bounds) else 0.0
