"""What came of measuring a predicate."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Finding:
    """Whether a predicate holds.

    Attributes
    ----------
    met
        None when it cannot be told.
    evidence
        What was measured, or why it cannot be told.
    value
        The measured number, the words that hold, or the truth; None when it cannot be told.
    """

    met: bool | None
    evidence: str
    value: float | bool | tuple[str, ...] | None = None
