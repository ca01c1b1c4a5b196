"""Remedies: change single objects of a built city so that it meets the goals it misses."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import NamedTuple

import numpy as np

from cityx.checks.predicates.facts import Facts, constant
from cityx.checks.predicates.parser import parse
from cityx.checks.predicates.syntax import Call, Comparison, Name, Within
from cityx.checks.predicates.thing_predicates import CannotTell, Selection, UInt64Array
from cityx.checks.predicates.vocabulary import KINDS, NARROWING, Group, split_arguments
from cityx.city import City
from cityx.city.bounds import is_stated
from cityx.geometry.arrays import BoolArray, FloatArray, IntArray
from cityx.ids import hash_ids
from cityx.language import Edit

# Look -> usual ones, for those that must not have theirs.
USUAL: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {
        "material": ("plaster", "brick", "concrete", "stone", "wood"),
        "color": ("white", "beige", "grey", "brown"), "roof_color": ("brown", "grey", "black"),
        "roof": ("tiles", "slate", "metal"), "roof_shape": ("gabled", "hipped", "flat"),
        "roof_form": ("gabled", "flat"),
    }
)  # fmt: skip
SPARE = 1.05  # times as many as asked for of "at least" that get a look
MEASURES = ("height", "floors")  # of buildings, that an edit can set
# Looks of buildings that an edit can give -> the edit, and what it sets.
LOOKS: Mapping[str, tuple[str, str]] = MappingProxyType(
    {
        **{name: (f"set_{name}", name) for name in ("style", "material", "color", "roof")},
        **dict.fromkeys(("roof_form", "roof_shape"), ("set_roof", "roof")),
        "roof_color": ("set_roof", "roof.color"),
    }
)
MOVABLE = ("piece", "lamp", "vehicle", "pedestrian")  # families of which things come and go
# Part of the values that lies below what a function returns.
_BELOW: Mapping[str, float] = MappingProxyType(
    {"min": 0.0, "p10": 0.1, "p50": 0.5, "p90": 0.9, "max": 1.0}
)


class Remedy(NamedTuple):
    """A change that helps, and what it changes; None where it adds something."""

    edit: Edit
    chosen: Selection | None


Remedies = tuple[Remedy, ...]
_NOTHING: Remedies = ()


def remedies(predicate: str, city: City) -> Remedies:
    """Return changes after which a city has what a predicate asks for.

    Parameters
    ----------
    predicate
        Something that is measured and not met.
    city
        The city that misses it.

    Returns
    -------
    remedies
        None where no change of single objects helps, as of the shape of a layout.
    """
    wanted = parse(predicate)
    measured = wanted.left if isinstance(wanted, Comparison) else getattr(wanted, "of", None)
    if not isinstance(measured, Call) or measured.form not in _RULES:
        return _NOTHING
    try:
        low, high = _bounds(wanted)
        return _RULES[measured.form](measured, low, high, Facts(city))
    except CannotTell:
        return _NOTHING


def _bounds(wanted: object) -> tuple[float, float]:
    """Return the least and the greatest value that is asked for."""
    if isinstance(wanted, Within):
        return constant(wanted.low), constant(wanted.high)
    assert isinstance(wanted, Comparison)
    value = constant(wanted.right)
    if wanted.sign in (">=", ">"):
        return value, math.inf
    if wanted.sign in ("<=", "<"):
        return -math.inf, value
    return (value, value) if wanted.sign == "==" else (-math.inf, math.inf)


def _by_lot(ids: UInt64Array, number: int, city: City) -> BoolArray:
    """Choose some of all ids by chance that is always the same; (n,)."""
    taken = np.zeros(len(ids), bool)
    order: IntArray = np.lexsort((ids, hash_ids(city.seed, "agents/remedy", ids)))
    taken[order[:number]] = True
    return taken


def _measure(call: Call, low: float, high: float, facts: Facts) -> Remedies:
    """Set heights or floors of those that keep a statistic out of its bounds."""
    (group, attribute, function), _ = split_arguments(call)
    assert isinstance(attribute.head, Name)
    assert isinstance(function.head, Name)
    name, below = attribute.head.word, _BELOW.get(function.head.word)
    chosen = facts.select(group)
    if KINDS[chosen.layer.kind] != "building" or name not in MEASURES or below is None:
        return _NOTHING
    value = chosen.layer.number(name)[chosen.rows]
    table = facts.city.layout.buildings
    stated = table["id"].to_numpy(np.uint64)[is_stated(table)]  # what a map states stands
    free = ~np.isin(chosen.ids, stated)
    chosen, value = chosen.where(free), value[free]
    found = []
    for bound, missed in ((low, value < low), (high, value > high)):
        moved = _needed(value, missed, below, up=bound is low)
        if moved.any() and math.isfinite(bound):
            found.append(Remedy(Edit(f"set_{name}", None, ((name, bound),)), chosen.where(moved)))
    return tuple(found)


def _needed(value: FloatArray, missed: BoolArray, below: float, *, up: bool) -> BoolArray:
    """(n,) which must be moved so that no more than a part of all is left beyond."""
    rows = np.flatnonzero(missed)
    nearest = rows[np.argsort(-value[rows] if up else value[rows], kind="stable")]
    # What may stay: those under a high quantile when it rises, those over a low one when it falls.
    stay = math.floor((below if up else 1.0 - below) * (len(value) - 1))
    moved = np.zeros(len(value), bool)
    moved[nearest[: max(len(rows) - stay, 0)]] = True
    return moved


def _share(call: Call, low: float, high: float, facts: Facts) -> Remedies:
    """Give more buildings the look of which too few have one, or fewer where too many do."""
    (group, *_), _ = split_arguments(call)
    chosen, has = facts.select_apart(group)
    if KINDS[chosen.layer.kind] != "building":
        return _NOTHING
    if not math.isfinite(low) or has.sum() > high * len(has) + 1e-9:
        return _fewer(group, chosen, has, high)
    wanted = math.ceil(low * len(has) - 1e-9)
    lacking = wanted - int(has.sum())
    if lacking > 0 and high > 1:  # other changes may take some of them back
        lacking = min(math.ceil(wanted * SPARE), len(has)) - int(has.sum())
    others = chosen.where(~has)
    changed = others.where(_by_lot(others.ids, max(lacking, 0), facts.city))
    found = []
    for asked in group.conditions:
        if not isinstance(asked, Comparison) or not isinstance(asked.left, Name):
            return _NOTHING
        name = asked.left.word
        if name in NARROWING:
            continue
        if asked.sign != "=" or name not in (*LOOKS, *MEASURES):
            return _NOTHING
        value = asked.right.word if isinstance(asked.right, Name) else constant(asked.right)
        verb, key = LOOKS.get(name, (f"set_{name}", name))
        found.append(Remedy(Edit(verb, None, ((key, value),)), changed))
    return tuple(found) if lacking > 0 else _NOTHING


def _fewer(group: Group, chosen: Selection, has: BoolArray, high: float) -> Remedies:
    """Give buildings the look that is most common among the others, or another usual one."""
    surplus = int(has.sum()) - math.floor(high * len(has) + 1e-9)
    looks = [one for one in group.conditions if isinstance(one, Comparison)]
    told = [(one.left.word, one.right) for one in looks
            if isinstance(one.left, Name) and one.left.word not in NARROWING]  # fmt: skip
    layer = chosen.layer
    if len(told) != 1 or surplus <= 0:
        return _NOTHING
    ((name, value),) = told
    if name not in USUAL or not isinstance(value, Name):
        return _NOTHING
    others = [word for word in USUAL[name] if word != value.word]
    number = [int(layer.has(name, word)[chosen.rows].sum()) for word in others]
    word = others[int(np.argmax(number))]
    mine = chosen.where(has)
    changed = mine.where(_by_lot(mine.ids, surplus, layer.city))
    verb, key = LOOKS[name]
    return (Remedy(Edit(verb, None, ((key, word),)), changed),)


def _number(call: Call, low: float, high: float, facts: Facts) -> Remedies:
    """Take away what there is too much of; plant trees where there are too few."""
    (group, *_), _ = split_arguments(call)
    chosen = facts.select(group)
    kind = chosen.layer.kind
    if KINDS[kind] not in MOVABLE:
        return _NOTHING
    if chosen.count > high:
        gone = _by_lot(chosen.ids, chosen.count - math.floor(high), facts.city)
        return (Remedy(Edit("remove"), chosen.where(gone)),)
    if chosen.count < low and kind == "tree" and not group.conditions:
        more = math.ceil(low) - chosen.count
        return (Remedy(Edit("plant", None, (("nature", "tree"), ("count", more))), None),)
    return _NOTHING


_RULES: Mapping[str, Callable[[Call, float, float, Facts], Remedies]] = MappingProxyType(
    {"stat": _measure, "share": _share, "n": _number}
)
