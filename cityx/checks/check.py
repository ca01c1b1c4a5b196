"""One check: a measured value, its limit and whether it holds."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from cityx.ids import id_text

NAMED = 20  # ids named of each check


@dataclass(frozen=True)
class Check:
    """A measured property of a city.

    Attributes
    ----------
    name
        Key in the report.
    value, limit
        Measured value and the largest (or, with ``at_least``, smallest) value allowed.
    meaning
        What is measured, with its unit, for a reader of the report.
    at_least
        Whether the limit is a lower bound.
    ids
        What fails it: ids of objects, or places.
    """

    name: str
    value: float
    limit: float
    meaning: str
    at_least: bool = False
    ids: tuple[str, ...] = ()

    @property
    def ok(self) -> bool:
        """Whether the value keeps the limit; NaN never does."""
        return bool(self.value >= self.limit if self.at_least else self.value <= self.limit)


def named(ids: Iterable[int]) -> tuple[str, ...]:
    """Return the texts of the first ids of what fails a check, each once, in order."""
    return tuple(id_text(int(value)) for value in sorted(set(map(int, ids)))[:NAMED])
