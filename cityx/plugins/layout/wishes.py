"""Wishes in numbers: what a city is asked to keep, as goals that its report measures."""

from __future__ import annotations

from dataclasses import replace

from cityx.city import City, Goal


def asked(
    city: City, text: str, quantity: str, *, least: float | None = None, most: float | None = None
) -> City:
    """Add a goal: a quantity, an expression of the language of predicates, within bounds."""
    bounds = {"least": least, "most": most}
    wanted = {"of": quantity} | {key: value for key, value in bounds.items() if value is not None}
    return replace(city, goals=(*city.goals, Goal(text, "quantity", wanted)))
