"""Goals in numbers: what a city is asked to keep, measured by its report."""

from __future__ import annotations

from dataclasses import replace

from cityx.city.city import City
from cityx.city.goals import Goal


def asked(
    city: City, text: str, quantity: str, *, least: float | None = None, most: float | None = None
) -> City:
    """Add a goal: a quantity of the language of predicates within bounds, at least one of them."""
    if least == most:
        predicate = f"{quantity} == {least:g}"
    elif least is None:
        predicate = f"{quantity} <= {most:g}"
    elif most is None:
        predicate = f"{quantity} >= {least:g}"
    else:
        predicate = f"{quantity} in [{least:g}, {most:g}]"
    return with_goal(city, text, predicate)


def with_goal(city: City, text: str, predicate: str) -> City:
    """Add a goal to a city."""
    return replace(city, goals=(*city.goals, Goal(text, predicate)))
