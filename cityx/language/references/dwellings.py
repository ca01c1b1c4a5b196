"""Dwellings: in a town of flats alone, its houses are the buildings in which people live."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import fields, is_dataclass, replace
from typing import Any, TypeVar

from cityx.city import City
from cityx.language.brief import Brief, Note, Selector
from cityx.language.goals import goals_of
from cityx.language.measurable import things

HOUSE, FLATS = "house", "apartment"
Value = TypeVar("Value")


def with_dwellings(brief: Brief, city: City) -> Brief:
    """Return a brief whose houses are flats, with a note, where a city has no house but flats.

    Parameters
    ----------
    brief
        A change of the city, as it was read.
    """
    spans = [edit.span for edit in brief.edits if any(_houses(edit))]
    if not spans or _count("building, use=house", city):
        return brief
    flats = _count(things(FLATS), city)
    if not flats:
        return brief
    edits = _changed(brief.edits)
    wishes = tuple(replace(wish, edits=_changed(wish.edits)) for wish in brief.wishes)
    goals, _ = goals_of(brief.slots, brief.negated, brief.kept, edits)
    said = f"There is no house of its own; the {flats} blocks of flats are taken."
    return replace(
        brief,
        edits=edits,
        wishes=wishes,
        goals=goals,
        notes=(*brief.notes, Note("dwellings", said, spans[0])),
    )


def _count(chosen: str, city: City) -> int:
    from cityx.checks.predicates.measuring import rows_of  # with libraries of geometry

    return len(rows_of(chosen, city))


def _houses(value: Any) -> Iterator[Selector]:
    """Yield the selectors of houses in a change."""
    if isinstance(value, Selector) and value.kind == HOUSE:
        yield value
    if isinstance(value, tuple):
        for one in value:
            yield from _houses(one)
    elif is_dataclass(value):
        for item in fields(value):
            yield from _houses(getattr(value, item.name))


def _changed(value: Value) -> Value:
    """Return a value in which all selectors of houses are of flats."""
    if isinstance(value, tuple):
        return tuple(_changed(one) for one in value)  # type: ignore[return-value]
    if not is_dataclass(value) or isinstance(value, type):
        return value
    told = {item.name: _changed(getattr(value, item.name)) for item in fields(value)}
    if isinstance(value, Selector) and value.kind == HOUSE:
        told["kind"] = FLATS
    return type(value)(**told)
