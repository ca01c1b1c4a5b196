"""Predicates: what is asked of a city as text, and whether the city has it.

``share(building, style=modern) >= 0.7`` is read by `parse` and measured by `measure` on the tables,
meshes, streets and air of a city, never on what something is called. Goals of a city, the report
and the benchmark of agents are stated in this language; `words` says what "dense" or "tall" is.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from cityx.checks.predicates.facts import Reply
    from cityx.checks.predicates.finding import Finding, clean
    from cityx.checks.predicates.measuring import measure, measure_all
    from cityx.checks.predicates.parser import parse
    from cityx.checks.predicates.syntax import Predicate

__all__ = ["Finding", "Predicate", "Reply", "clean", "measure", "measure_all", "parse"]

# Whoever only reads predicates does not wait for the libraries that measure them.
_HOMES = {
    "clean": "finding", "Reply": "facts", "Finding": "finding", "measure": "measuring",
    "measure_all": "measuring", "parse": "parser", "Predicate": "syntax",
}  # fmt: skip


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_HOMES[name]}"), name)
