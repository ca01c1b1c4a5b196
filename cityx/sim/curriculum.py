"""Curricula: from short routes on empty streets to long ones among traffic and people.

Real places are held out: lessons are given in made towns, `cityx.sim.places.towns`.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from types import MappingProxyType
from typing import Any

from cityx.errors import UsageError

ENOUGH = 0.8  # share of episodes that arrive, from which on the next lesson is taken
# Options of Drive in the order in which they are learnt: first the distance, then traffic, then
# people.
LESSONS: tuple[Mapping[str, Any], ...] = tuple(MappingProxyType(each) for each in (
    {"goal_m": 60.0, "density": 0.0, "people": 0},
    {"goal_m": 120.0, "density": 0.0, "people": 0},
    {"goal_m": 120.0, "density": 3.0, "people": 0},
    {"goal_m": 120.0, "density": 6.0, "people": 0},
    {"goal_m": 200.0, "density": 6.0, "people": 10},
    {"goal_m": 300.0, "density": 12.0, "people": 20},
))  # fmt: skip


def lesson_after(successes: Iterable[float], *, enough: float = ENOUGH) -> int:
    """Return the number of the lesson that comes after what was learnt; nothing else decides.

    Parameters
    ----------
    successes
        Shares of episodes that arrived, one for each judgement, the first of lesson 0. Each that is
        enough leads to the next lesson; nobody is sent back.
    enough
        From which share on.

    Raises
    ------
    UsageError
        If a share is not from 0 to 1.
    """
    lesson = 0
    for share in successes:
        if not 0.0 <= share <= 1.0:
            raise UsageError(f"A share of episodes is {share!r}; it is a number from 0 to 1.")
        if share >= enough:
            lesson = min(lesson + 1, len(LESSONS) - 1)
    return lesson
