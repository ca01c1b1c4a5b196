"""Gathered: what the commands of an instruction have come to so far."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from cityx.language.brief import Edit, Question, Reference, Selector, Span
from cityx.language.commands.wishes import Clause
from cityx.language.here import Findings
from cityx.language.scan import Item

Spot = tuple[str, str] | Reference  # how something lies to what, or a place that others tell


@dataclass
class Commands:
    """What the commands of an instruction came to.

    Attributes
    ----------
    edits, questions, found
        What changes, what is to be asked, and what describes the city.
    named
        What "it" stands for.
    spared, spares
        What is to be left alone by every change, and whether such words are still to come.
    place
        What "there" stands for: how something lies to it, and its kind or its name.
    topic
        What a heading says that all that follows is about: "In the park: ...".
    about
        What was said to be wrong with it: its "width" or its "height".
    open
        Complaints: their spans, how many edits there were before, and what is to be asked.
    parses
        Attempts of the grammar.
    clauses
        What was read of each command.
    """

    edits: list[Edit] = field(default_factory=list)
    questions: list[Question] = field(default_factory=list)
    found: Findings = field(default_factory=lambda: Findings(""))
    named: list[Selector] = field(default_factory=list)
    spared: list[Selector] = field(default_factory=list)
    spares: bool = False
    place: Spot | None = None
    topic: Selector | None = None
    about: str = ""
    open: list[tuple[Span, int, str]] = field(default_factory=list)
    parses: int = 0
    clauses: list[Clause] = field(default_factory=list)

    def lists(self) -> list[list[Any]]:
        """Return all lists that grow with what is read."""
        found = self.found
        return [self.edits, self.questions, self.spared, self.open, found.slots, found.kept,
                found.negated, found.notes]  # fmt: skip


class Before:
    """What was read up to a command, to which its reading can be taken back."""

    def __init__(self, commands: Commands, items: Sequence[Item]) -> None:
        self._commands = commands
        self._lists = [(one, list(one)) for one in commands.lists()]
        self._named, self._place, self._about = commands.named, commands.place, commands.about
        self._items = [(item, replace(item)) for item in items]

    def restore(self) -> None:
        """Take back what has been read since."""
        commands = self._commands
        for one, held in self._lists:
            one[:] = held
        commands.named, commands.place, commands.about = self._named, self._place, self._about
        for item, was in self._items:
            item.kind, item.senses, item.quantity, item.state = (
                was.kind, was.senses, was.quantity, was.state)  # fmt: skip
            item.words = was.words
