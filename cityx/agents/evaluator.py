"""The evaluator: measure the goals after the layout, and again on the finished city.

A layout takes seconds and the rest minutes, so what a layout can be asked for is measured as soon
as there is one, and another is tried while something hard is missed.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from cityx.agents.verdict import Measured
from cityx.checks.predicates.syntax import NAME
from cityx.checks.predicates.vocabulary import family_of
from cityx.city import City, Goal

ROUNDS = 3  # layouts that are tried after the first
HARD = 10.0  # weight of a hard goal, of one that only weighs 1
BLOCK = 1000.0  # weight of a failed check, more than that of all goals of a brief
# Question to somebody who looks at pictures -> checks whose failure answers it.
DECIDED: Mapping[str, tuple[str, ...]] = {
    "look.standing": ("floating_building", "building_buried", "things_off_ground"),
}
# Of what a predicate speaks that only actions after the layout make: families of things, and words.
_LATER_FAMILIES = frozenset({"piece", "lamp", "light", "vehicle", "pedestrian"})
_LATER_WORDS = frozenset({
    "sun_azimuth", "sun_elev", "style", "material", "color", "roof", "roof_color", "feature",
    "terrain", "slope", "used_source", "same", "changed", "ratio", "gained", "iou", "corr",
})  # fmt: skip
_AIR = "env."


@dataclass(frozen=True)
class Judged:
    """What was found of some goals.

    Attributes
    ----------
    missed
        Goals that are not met, with what was measured.
    weight
        Of what is missed, hard goals counting ten times; a failed check outweighs all goals.
    failed
        Checks that fail, with what was measured.
    """

    missed: tuple[tuple[Goal, str], ...]
    weight: float
    failed: tuple[str, ...] = ()

    @property
    def texts(self) -> list[str]:
        """What is missed, in words."""
        return [*(f"{goal.predicate} ({evidence})" for goal, evidence in self.missed), *self.failed]


def of_layout(goals: Sequence[Goal]) -> tuple[Goal, ...]:
    """Return the goals that can be measured on a layout before anything is built on it."""
    return tuple(goal for goal in goals if not any(map(_is_later, _words(goal.predicate))))


def _words(predicate: str) -> list[str]:
    return re.findall(NAME, predicate)


def _is_later(word: str) -> bool:
    later = word in _LATER_WORDS or word.startswith(_AIR)
    return later or family_of(word) in _LATER_FAMILIES


def judged(city: City, goals: Sequence[Goal], before: City | None = None) -> Judged:
    """Measure goals on a city, and the checks of buildings, which a layout can fail already.

    What cannot be told is not missed; of the state before, nothing can be where there is none.
    """
    from cityx.checks.building_checks import check_buildings
    from cityx.checks.predicates import measure_all

    findings = measure_all((goal.predicate for goal in goals), city, before=before)
    missed = tuple(
        (goal, finding.evidence)
        for goal, finding in zip(goals, findings, strict=True)
        if finding.met is False
    )
    failed = tuple(
        f"{check.name} {check.value:g} (limit {check.limit:g})"
        for check in check_buildings(city)
        if not check.ok
    )
    weight = sum(goal.weight * (HARD if goal.hard else 1.0) for goal, _ in missed)
    return Judged(missed, weight + BLOCK * len(failed), failed)


def measured_of(report: Mapping[str, Any]) -> Measured:
    """Return what a report measured, as it stands against what is seen in pictures.

    Goals are called as in the checklist of a look; a check that failed stands under its own name
    and answers the question that it decides, so that no look can let it pass.
    """
    failed = {name for name, check in report["checks"].items() if not check["ok"]}
    goals = {goal["goal"].replace(" = ", "="): goal["met"] for goal in report["goals"]}
    answered = {question for question, checks in DECIDED.items() if failed & {*checks}}
    return {**goals, **dict.fromkeys(sorted(failed | answered), False)}
