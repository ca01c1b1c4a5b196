"""How many things lie near others, and what most of those there are: by a river, in the north."""

from __future__ import annotations

from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.checks.predicates import words
from cityx.checks.predicates.facts import Facts, Options, constant, said
from cityx.checks.predicates.finding import Measured
from cityx.checks.predicates.syntax import Name
from cityx.checks.predicates.thing_predicates import Absent, Selection
from cityx.checks.predicates.vocabulary import Group
from cityx.checks.predicates.whereabouts import is_in_part, is_near, is_on_side
from cityx.geometry.arrays import BoolArray


def near(facts: Facts, groups: tuple[Group, ...], options: Options) -> Measured:
    """Count the first that lie near one of the second."""
    chosen, places = (facts.select(group) for group in groups)
    within = _within(options, words.NEARBY)
    side, by = _on_side(options, chosen.shapes, places.shapes, within)
    number = len(np.unique(chosen.layer.units(chosen.rows)[by]))
    return Measured(
        number, f"{number} of {said(chosen)} lie within {within:g} m{side} of {groups[1]}"
    )


def near_share(facts: Facts, groups: tuple[Group, ...], options: Options) -> Measured:
    """Measure which share of the things near one of the second are the first."""
    chosen, places = (facts.select(group) for group in groups)
    whole = _whole(facts, groups[0])
    within = _within(options, words.BESIDE)
    side, by = _on_side(options, whole.shapes, places.shapes, within)
    return _share(chosen, whole, by, f"within {within:g} m{side} of {groups[1]}")


def part_share(facts: Facts, groups: tuple[Group, ...], _: Options) -> Measured:
    """Measure which share of the things in a part of the site are the first."""
    chosen, whole = facts.select(groups[0]), _whole(facts, groups[0])
    head = groups[1].head
    assert isinstance(head, Name)
    there = is_in_part(whole.shapes, head.word, facts.city.layout.extent)
    return _share(chosen, whole, there, f"in the {head.word}")


def _within(options: Options, usual: float) -> float:
    return float(constant(options["within"])) if "within" in options else usual


def _on_side(
    options: Options, shapes: NDArray[Any], places: NDArray[Any], within: float
) -> tuple[str, BoolArray]:
    """Return the words for the side that is asked for, and (n,) which shapes lie near, on it."""
    by, side = is_near(shapes, places, within), options.get("side")
    if not isinstance(side, Name):
        return "", by
    return f" {side.word}", by & is_on_side(shapes, places, side.word)


def _whole(facts: Facts, group: Group) -> Selection:
    """Return all things of the kind that an argument chooses from; of buildings no sheds."""
    whole = facts.select(Group(group.head))
    if whole.layer.kind != "building":
        return whole
    return whole.where(shapely.area(whole.shapes) >= words.LEAST_BUILDING)


def _share(chosen: Selection, whole: Selection, there: BoolArray, where: str) -> Measured:
    if not there.any():
        raise Absent(f"there is no {whole.text} {where}")
    has = np.isin(whole.ids[there], chosen.ids)
    share = float(has.mean())
    said_of = f"{int(has.sum())} of {int(there.sum())} {whole.text} {where} are {chosen.text}"
    return Measured(share, said_of)
