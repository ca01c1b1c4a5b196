"""The brief: what an instruction asks for, read word by word without a language model."""

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
