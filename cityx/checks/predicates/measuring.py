"""Measuring: a predicate and a city become a finding."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

from cityx.checks.predicates.facts import Facts, Reply, compared, said
from cityx.checks.predicates.finding import Finding, Measured
from cityx.checks.predicates.forms import measured_call, measured_quantity
from cityx.checks.predicates.syntax import (
    Argument,
    Arithmetic,
    Call,
    Comparison,
    Expression,
    Name,
    Negative,
    Number,
    Predicate,
    Within,
)
from cityx.checks.predicates.thing_predicates import Absent, CannotTell, Selection
from cityx.checks.predicates.vocabulary import split_arguments
from cityx.city import City
from cityx.errors import CityxError
from cityx.geometry.arrays import IntArray
from cityx.options import HowToRead


def _read(text: str) -> Predicate:
    from cityx.checks.predicates.parser import parse  # a city without goals needs no grammar

    return parse(text)


def rows_of(choice: str, city: City) -> IntArray:
    """Return the rows of the layout's buildings that a choice names: "building, use=office"."""
    call = _read(f"n({choice}) >= 0")
    assert isinstance(call, Comparison)
    assert isinstance(call.left, Call)
    (group, *_), _ = split_arguments(call.left)
    ids = city.layout.buildings["id"].to_numpy(np.uint64)
    return np.flatnonzero(np.isin(ids, Facts(city).select(group).ids))


def measure(
    predicate: Predicate | str,
    city: City,
    *,
    before: City | None = None,
    inputs: Mapping[str, Path] | None = None,
    reply: Reply | None = None,
) -> Finding:
    """Measure one predicate.

    Parameters
    ----------
    predicate
        As `parse` gives it, or its text.
    city
        What is measured: its tables, meshes and network, not what things are called.
    before
        The state that ``changed``, ``same`` and ``ratio`` compare with.
    inputs
        Files by the names that ``iou`` and ``corr`` call them.
    reply
        What an agent answered, for ``reply``, ``mentions`` and ``used``.

    Returns
    -------
    finding
        Its ``met`` is None, and its evidence the reason, where it cannot be told.

    Raises
    ------
    UsageError
        If the text is no predicate.
    """
    return measure_all([predicate], city, before=before, inputs=inputs, reply=reply)[0]


def measure_all(
    predicates: Iterable[Predicate | str],
    city: City,
    *,
    before: City | None = None,
    inputs: Mapping[str, Path] | None = None,
    reply: Reply | None = None,
    together: Iterable[Predicate | str] = (),
    how: HowToRead | None = None,
) -> list[Finding]:
    """Measure predicates that belong together; see `measure`.

    What they share is measured once, and ``others`` is what none of them names, nor any of those
    that are measured elsewhere but belong to them (`together`). `how` is what the user says of the
    inputs.
    """
    read, all_of_them = (
        tuple(_read(each) if isinstance(each, str) else each for each in given)
        for given in (predicates, together)
    )
    facts = Facts(
        city, before, dict(inputs or {}), reply, all_of_them or read, how=how or HowToRead()
    )  # fmt: skip
    return [_finding(predicate, facts) for predicate in read]


def things_of(text: str, city: City) -> Selection:
    """Return the things that words choose, such as "building, tag=church" or "park".

    Raises
    ------
    UsageError
        If the words choose no kind of things.
    """
    predicate = _read(f"n({text}) >= 0")
    assert isinstance(predicate, Comparison)
    assert isinstance(predicate.left, Call)
    return Facts(city).select(split_arguments(predicate.left)[0][0])


def _finding(predicate: Predicate, facts: Facts) -> Finding:
    try:
        return finding_of(predicate, facts)
    except Absent as error:
        return Finding(False, str(error))
    except (CannotTell, CityxError) as error:  # an input that cannot be read says so itself
        return Finding(None, f"cannot tell: {error}")


def finding_of(predicate: Predicate, facts: Facts) -> Finding:
    """Measure a predicate.

    Raises
    ------
    CannotTell
        If the city does not hold what it asks for.
    """
    if isinstance(predicate, Call):
        found = _call(predicate, facts)
        return Finding(bool(found.value), found.evidence, found.value)
    if isinstance(predicate, Within):
        found = value_of(predicate.of, facts)
        low, high = (_number(side, facts) for side in (predicate.low, predicate.high))
        value = np.array(_as_number(found, predicate.of))
        met = bool(compared(value, ">=", low) & compared(value, "<=", high))
        return Finding(met, found.evidence, found.value)
    found = value_of(predicate.left, facts)
    if isinstance(found.value, tuple):
        same = str(predicate.right).strip('"') in found.value
        return Finding(same != (predicate.sign == "!="), found.evidence, found.value)
    wanted = _number(predicate.right, facts)
    value = np.array(_as_number(found, predicate.left))
    return Finding(bool(compared(value, predicate.sign, wanted)), found.evidence, found.value)


def value_of(expression: Argument, facts: Facts) -> Measured:
    """Measure an expression.

    Raises
    ------
    CannotTell
        If the city does not hold what it asks for.
    """
    if isinstance(expression, Number):
        return Measured(expression.value, str(expression))
    if isinstance(expression, Name):
        return measured_quantity(expression.word, facts)
    if isinstance(expression, Call):
        return _call(expression, facts)
    if isinstance(expression, Negative):
        return Measured(-_number(expression.of, facts), f"{expression}")
    assert isinstance(expression, Arithmetic)
    left, right = (_number(side, facts) for side in (expression.left, expression.right))
    if expression.sign == "/" and right == 0:
        raise CannotTell(f"{expression.right} is 0, by which nothing can be divided")
    value = _SIGNS[expression.sign](left, right)
    return Measured(value, f"{expression} is {value:.4g}")


def _call(call: Call, facts: Facts) -> Measured:
    if call.form == "each":
        return _each(call, facts)
    if call.form in ("min", "max"):
        return _extreme(call, facts)
    return measured_call(call, facts)


def _extreme(call: Call, facts: Facts) -> Measured:
    """Return the least or the greatest of some numbers."""
    found = [value_of(group.head, facts) for group in split_arguments(call)[0]]
    best = min if call.form == "min" else max
    value = best(float(each.value) for each in found if not isinstance(each.value, tuple))
    return Measured(value, f"{value:.4g}")


def _each(call: Call, facts: Facts) -> Measured:
    """Measure whether a predicate holds at each of some things, of what stands there."""
    groups, _ = split_arguments(call)
    chosen = facts.select(groups[0])
    inner = groups[1].head
    assert isinstance(inner, Call | Comparison | Within)
    met = sum(
        bool(finding_of(inner, replace(facts, focus=ground)).met)
        for ground in chosen.grounds.tolist()
    )
    every = met == len(chosen.rows) and met > 0
    return Measured(every, f"{inner} holds at {met} of {said(chosen)}")


_SIGNS: Mapping[str, Callable[[float, float], float]] = {
    "+": lambda a, b: a + b, "-": lambda a, b: a - b, "*": lambda a, b: a * b,
    "/": lambda a, b: a / b,
}  # fmt: skip


def _number(expression: Expression, facts: Facts) -> float:
    return _as_number(value_of(expression, facts), expression)


def _as_number(found: Measured, expression: Argument) -> float:
    if isinstance(found.value, tuple):
        raise CannotTell(f"{expression} is no number")
    return float(found.value)
