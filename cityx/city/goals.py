"""Goals: what a city was asked to have, kept with it so that its report can measure it."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Goal:
    """One thing a city was asked to have.

    Attributes
    ----------
    text
        In words: "25 towers of 80 to 150 m".
    predicate
        The same in the language of `cityx.checks.predicates`, which decides whether it is met.
    hard
        Whether the city fails where it is not met; a soft goal only weighs.
    weight
        How much it counts among the goals.
    """

    text: str
    predicate: str
    hard: bool = True
    weight: float = 1.0
