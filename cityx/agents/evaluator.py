"""The evaluator: what is asked for is measured, after the layout and again when all is built.

A layout takes seconds and the rest minutes, so what a layout can be asked for is measured as soon
as there is one, and another is tried while something hard is missed.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from cityx.city import City, Goal

ROUNDS = 3  # layouts that are tried after the first
# What a predicate speaks of that only actions after the layout make.
_LATER = (
    "env.", "sun_azimuth", "tree", "light", "style=", "material=", "color=", "roof=", "roof_color=",
    "feature=", "vehicle", "pedestrian", "bench", "terrain", "slope", "used_source", "same(",
    "changed(", "ratio(", "iou(", "corr(",
)  # fmt: skip


@dataclass(frozen=True)
class Judged:
    """What was found of some goals.

    Attributes
    ----------
    missed
        Goals that are not met, with what was measured.
    weight
        Of what is missed, hard goals counting ten times.
    """

    missed: tuple[tuple[Goal, str], ...]
    weight: float

    @property
    def texts(self) -> list[str]:
        """What is missed, in words."""
        return [f"{goal.predicate} ({evidence})" for goal, evidence in self.missed]


def of_layout(goals: Sequence[Goal]) -> tuple[Goal, ...]:
    """Return the goals that can be measured on a layout before anything is built on it."""
    return tuple(goal for goal in goals if not any(word in goal.predicate for word in _LATER))


def judged(city: City, goals: Sequence[Goal]) -> Judged:
    """Measure goals on a city; what cannot be told is not missed."""
    from cityx.checks.predicates import measure_all

    findings = measure_all((goal.predicate for goal in goals), city)
    missed = tuple(
        (goal, finding.evidence)
        for goal, finding in zip(goals, findings, strict=True)
        if finding.met is False
    )
    return Judged(missed, sum(goal.weight * (10.0 if goal.hard else 1.0) for goal, _ in missed))
