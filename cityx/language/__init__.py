"""The brief: what an instruction asks for, read word by word without a language model."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from cityx.language.brief import (
    Brief,
    Command,
    Conflict,
    Edit,
    GoalText,
    Note,
    Question,
    Reference,
    Selector,
    Slot,
)

if TYPE_CHECKING:
    from cityx.language.reading import read_brief, read_note

__all__ = [
    "Brief",
    "Command",
    "Conflict",
    "Edit",
    "GoalText",
    "Note",
    "Question",
    "Reference",
    "Selector",
    "Slot",
    "read_brief",
    "read_note",
]


def __getattr__(name: str) -> Any:
    if name in ("read_brief", "read_note"):  # most builds have no text: words are loaded with one
        return getattr(import_module("cityx.language.reading"), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
