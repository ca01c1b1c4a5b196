"""The message pool: messages between agents, readable by all, never changed."""

from __future__ import annotations

import json
import sqlite3
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any, Literal, get_args

from cityx.errors import UsageError

Role = Literal["user", "annotator", "planner", "executor", "backend", "evaluator", "system"]
Kind = Literal[
    "brief", "labels", "workflow", "next", "call", "reject", "result", "verdict", "budget", "final"
]


@dataclass(frozen=True)
class Message:
    """One message.

    Attributes
    ----------
    role
        Who says it.
    kind
        What it is.
    body
        Its content, JSON.
    step
        Index of the step of the journal it belongs to, -1 for none.
    parent
        `seq` of the message it answers, -1 for none.
    tokens_in, tokens_out
        What a language model was given and answered, 0 where none was asked.
    seq
        Its place in the run, from 0.
    """

    role: Role
    kind: Kind
    body: Mapping[str, Any] = field(default_factory=dict)
    step: int = -1
    parent: int = -1
    tokens_in: int = 0
    tokens_out: int = 0
    seq: int = -1


class Pool:
    """The messages of one run.

    Parameters
    ----------
    database
        Of the city, as `cityx.agents.journal.connect` opens it.
    run
        Number of the run.
    """

    def __init__(self, database: sqlite3.Connection, run: int) -> None:
        self.database = database
        self.run = run

    def say(self, message: Message) -> int:
        """Add a message and return its place.

        Raises
        ------
        UsageError
            If role or kind is none that agents use.
        """
        if message.role not in get_args(Role) or message.kind not in get_args(Kind):
            raise UsageError(f"No agent says {message.kind} as {message.role}.")
        body = json.dumps(dict(message.body), sort_keys=True)
        with self.database:
            (place,) = self.database.execute(
                "SELECT COALESCE(MAX(seq) + 1, 0) FROM message WHERE run_id = ?", (self.run,)
            ).fetchone()
            self.database.execute(
                "INSERT INTO message VALUES(?, ?, ?, ?, ?, ?, ?, ?, ?)",
                (
                    self.run, place, message.step, message.role, message.kind, body,
                    message.parent, message.tokens_in, message.tokens_out,
                ),
            )  # fmt: skip
        return int(place)

    def read(self, *kinds: Kind, after: int = -1) -> tuple[Message, ...]:
        """Return the messages of some kinds, of all when none is named, in order.

        Parameters
        ----------
        after
            Only those that came later than this place.
        """
        rows = self.database.execute(
            "SELECT role, kind, body, step, parent, tokens_in, tokens_out, seq FROM message "
            "WHERE run_id = ? AND seq > ? ORDER BY seq",
            (self.run, after),
        ).fetchall()
        return tuple(
            Message(row[0], row[1], json.loads(row[2]), *row[3:])
            for row in rows
            if not kinds or row[1] in kinds
        )

    def last(self, kind: Kind) -> Message | None:
        """Return the newest message of a kind."""
        found = self.read(kind)
        return found[-1] if found else None

    def tokens(self) -> tuple[int, int]:
        """Return what language models were given and answered over the whole run."""
        row = self.database.execute(
            "SELECT COALESCE(SUM(tokens_in), 0), COALESCE(SUM(tokens_out), 0) FROM message "
            "WHERE run_id = ?",
            (self.run,),
        ).fetchone()
        return int(row[0]), int(row[1])


def keep_labels(
    database: sqlite3.Connection, registry: str, labels: Iterable[tuple[str, str, str]]
) -> None:
    """Store (action, label, author) rows of a registry; those that are known stay."""
    with database:
        database.executemany(
            "INSERT OR IGNORE INTO label VALUES(?, ?, ?, ?)",
            [(registry, *row) for row in labels],
        )


def known_labels(database: sqlite3.Connection, registry: str) -> dict[str, frozenset[str]]:
    """Return action to labels of a registry, {} when it was never annotated."""
    found: dict[str, set[str]] = {}
    rows = database.execute("SELECT action, label FROM label WHERE registry = ?", (registry,))
    for action, label in rows:
        found.setdefault(action, set()).add(label)
    return {action: frozenset(words) for action, words in found.items()}
