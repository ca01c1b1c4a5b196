"""Goals: what a city was asked to have, kept with it so that its report can measure it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field


@dataclass(frozen=True)
class Goal:
    """One thing a city was asked to have.

    Attributes
    ----------
    text
        In words: "25 towers of 80 to 150 m around a plaza".
    measure
        Name of the measurement of `cityx.checks.goals` that decides whether it is met.
    wanted
        What the measurement compares with.
    """

    text: str
    measure: str
    wanted: Mapping[str, float | str] = field(default_factory=dict)
