"""Contradictions: changes of one request that cannot all hold, found before anything runs."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import combinations

import numpy as np

from cityx.building.roofs.shapes import SHAPES
from cityx.checks.predicates.thing_predicates import Selection
from cityx.language import Edit, Question

Meant = Sequence[tuple[Edit, Selection | None]]
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
    return [*_two_values(meant), *_against_each_other(meant)]


def _two_values(meant: Meant) -> Iterator[Question]:
    """Ask about "make b07 red and blue"."""
    for edit, _ in meant:
        for key in dict.fromkeys(key for key, _ in edit.change if key not in _SEVERAL):
            values = dict.fromkeys(str(value) for name, value in edit.change if name == key)
            shapes = [value for value in values if value in SHAPES]
            if key == "roof" and len(shapes) == len(values) - 1 == 1:
                continue  # "a gabled slate roof" has a shape and a covering
            if len(values) > 1:
                yield Question(f"{' and '.join(values)} cannot both be the {key}; which?",
                               tuple(values))  # fmt: skip


def _against_each_other(meant: Meant) -> Iterator[Question]:
    """Ask about "make b07 taller and delete b07"."""
    for (first, some), (second, others) in combinations(meant, 2):
        if some is None or others is None or type(some.layer) is not type(others.layer):
            continue
        shared = some.where(np.isin(some.ids, others.ids))
        if len(shared.rows) and _clash(first, second):
            yield Question(
                f"{_named(first)} and {_named(second)} are both asked of {shared.examples()}; "
                "which of the two?",
                (_named(first), _named(second)),
            )


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
