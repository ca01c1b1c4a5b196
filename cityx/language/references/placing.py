"""Placing: what an edit that adds or sets something says of places and of the air, as slots."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from cityx.checks.predicates.thing_predicates import Selection
from cityx.city import City
from cityx.ids import id_text
from cityx.language import Brief, Edit, Question, Selector, Slot
from cityx.language.asked import air_slots
from cityx.language.measurable import things
from cityx.language.references.selecting import MAIN_STREET, Open, choose, place_selector
from cityx.protocol.serving import Slots

# Words of a change that name a place -> the slot with the ids of what is meant.
_PLACES = {"along": "beside", "around": "beside", "in": "within", "on": "within", "near": "within",
           "of": "from"}  # fmt: skip


def slots_of_places(edit: Edit, city: City) -> Slots:
    """Return where something is added, by the ids of streets and areas, and how strong the air is.

    Raises
    ------
    Open
        If there is no such place.
    """
    found: dict[str, tuple[Any, ...]] = {}
    for key, value in edit.change:
        slot = _PLACES.get(key)
        if slot is None or edit.target is not None:
            continue
        if slot == "from" and edit.verb != "add":
            verb = edit.verb.replace("_", " ")
            raise Open(f"{verb} takes no side of {value}; say near, in or along what.")
        word = str(value)
        selector = replace(place_selector(word), alone=word == MAIN_STREET)
        ids = tuple(id_text(int(one)) for one in _members(choose(selector, city)))
        found[slot] = ((*found.get(slot, ((),))[0], *ids),)
    return {**found, **air_slots(edit.change)}


def _members(chosen: Selection) -> Any:
    return chosen.layer.members(chosen.rows)


def _kept(brief: Brief, city: City) -> Iterator[tuple[Slot, Selection]]:
    """Yield what is to stay as it is, with its words; names of nothing are passed over."""
    for slot in brief.kept:
        word = str(slot.value)
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


def protected(
    brief: Brief, meant: list[tuple[Edit, Selection | None]], city: City
) -> Iterator[Question]:
    """Ask where something is to stay as it is and to change: "remove all trees, keep every tree".

    What is left alone of a larger group is no contradiction: the rest of the group changes.
    """
    for slot, kept in _kept(brief, city):
        for edit, chosen in meant:
            if chosen is not None and set(chosen.ids.tolist()) <= set(kept.ids.tolist()):
                yield Question(
                    f'"{slot.text}" is to stay as it is, but {edit.verb.replace("_", " ")} would '
                    f"change {chosen.examples()}; which of the two?"
                )
