"""The brief: what an instruction asks for, read word by word without a language model."""

from cityx.agents.brief.brief import (
    Brief,
    Conflict,
    Edit,
    GoalText,
    Note,
    Question,
    Selector,
    Slot,
)
from cityx.agents.brief.reading import read_brief, read_note

__all__ = [
    "Brief",
    "Conflict",
    "Edit",
    "GoalText",
    "Note",
    "Question",
    "Selector",
    "Slot",
    "read_brief",
    "read_note",
]
