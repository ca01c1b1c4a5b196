"""Recordings: what a model was asked and answered, so that it is asked but once.

A decision is found again by what was asked, not by when: the key is a digest of the model's name,
the messages without ids and times, the schemas of the tools and the settings. The database of the
city keeps every decision, so a run that was killed decides the same when it is taken up again; a
file of decisions lets a run be played without the model.
"""

from __future__ import annotations

import datetime
import json
import sqlite3
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import closing
from dataclasses import dataclass, field
from hashlib import sha256
from pathlib import Path
from typing import Any
from urllib.parse import quote

from cityx.agents.models.quoting import scrubbed
from cityx.errors import InputError, UsageError

SHOWN = 200  # letters of a question that has no answer in a recording


class NotRecorded(UsageError):
    """A replay was asked what its recording has no answer to, or a prompt waits for one."""


@dataclass(frozen=True)
class Decision:
    """One question and its answer.

    Attributes
    ----------
    key
        Of the question, 64 hex digits.
    nth
        How often the same was asked before it.
    model
        Who answered.
    request, response
        Plain values; see `cityx.agents.models.library`.
    usage
        Tokens "in" and "out".
    date
        Day of the answer, as in ISO 8601.
    """

    key: str
    nth: int
    model: str
    request: Mapping[str, Any]
    response: Mapping[str, Any]
    usage: Mapping[str, int] = field(default_factory=dict)
    date: str = ""


def key_of(model: str, request: Mapping[str, Any]) -> str:
    """Return the key of a question to a model, 64 hex digits."""
    text = json.dumps([model, request], sort_keys=True, ensure_ascii=False)
    return sha256(text.encode()).hexdigest()


@dataclass
class Decisions:
    """The decisions of a run.

    Attributes
    ----------
    known
        Decisions made before, by key and count.
    replayed
        Whether nothing else may be asked.
    record
        File that every new decision is added to, or None.
    secrets
        Texts that must not be kept.
    ask
        What is told a question without an answer that nobody is there to give, with the role that
        asks and how often it was asked before; it returns the error that is raised. None where
        there is somebody.
    """

    known: Mapping[tuple[str, int], Decision] = field(default_factory=dict)
    replayed: bool = False
    record: Path | None = None
    secrets: tuple[str, ...] = field(default=(), repr=False)
    ask: Callable[[str, Mapping[str, Any], int], NotRecorded] | None = None
    _database: sqlite3.Connection | None = None
    _waiting: list[Decision] = field(default_factory=list)
    _asked: Counter[str] = field(default_factory=Counter)

    def attach(self, database: sqlite3.Connection) -> None:
        """Keep decisions in the database of a city, those made before too."""
        self._database = database
        for decision in self._waiting:
            _write(database, decision)
        self._waiting.clear()

    def find(self, model: str, request: Mapping[str, Any], role: str = "") -> Decision | None:
        """Return the answer that is known to a question, None where the model is to be asked.

        Raises
        ------
        NotRecorded
            If a replay holds no answer, or a prompt was written that waits for one.
        """
        key = key_of(model, request)
        nth = self._asked[key]
        found = self.known.get((key, nth))
        if found is not None:
            self._asked[key] += 1
        elif self.ask is not None:
            raise self.ask(role, request, nth)
        elif self.replayed:
            raise NotRecorded(
                f"The recording has no answer number {nth + 1} of {model} to this question "
                f"({key[:12]}): {json.dumps(request, ensure_ascii=False)[:SHOWN]}... "
                "Record it anew."
            )
        return found

    def keep(
        self,
        model: str,
        request: Mapping[str, Any],
        response: Mapping[str, Any],
        usage: Mapping[str, int],
    ) -> None:
        """Keep a new decision."""
        key = key_of(model, request)
        decision = Decision(
            key, self._asked[key], model, self._clean(request), self._clean(response), usage,
            datetime.datetime.now(datetime.UTC).date().isoformat(),
        )  # fmt: skip
        self._asked[key] += 1
        if self._database is not None:
            _write(self._database, decision)
        else:
            self._waiting.append(decision)
        if self.record is not None:
            with self.record.open("a", encoding="utf-8") as file:
                file.write(json.dumps(vars(decision), ensure_ascii=False) + "\n")

    def _clean(self, value: Mapping[str, Any]) -> Any:
        return json.loads(scrubbed(json.dumps(value, ensure_ascii=False), self.secrets))


def _write(database: sqlite3.Connection, decision: Decision) -> None:
    texts = map(json.dumps, (decision.request, decision.response, decision.usage))
    with database:
        database.execute(
            "INSERT OR REPLACE INTO decision VALUES(?, ?, ?, ?, ?, ?)",
            (decision.key, decision.nth, decision.model, *texts),
        )


def kept_decisions(journal: Path | None) -> dict[tuple[str, int], Decision]:
    """Return the decisions in the database of a city, {} where there is none.

    A run that was killed is taken up with the answers that it had.
    """
    if journal is None or not journal.is_file():
        return {}
    try:
        with closing(sqlite3.connect(f"file:{quote(str(journal))}?mode=ro", uri=True)) as database:
            rows = database.execute(
                "SELECT key, nth, model, request, response, usage FROM decision"
            ).fetchall()
    except sqlite3.DatabaseError:
        return {}  # `cityx.agents.journal` says what is wrong with it
    return {(row[0], row[1]): Decision(*row[:3], *map(json.loads, row[3:])) for row in rows}


def read_decisions(path: Path) -> dict[tuple[str, int], Decision]:
    """Read a file of decisions.

    Raises
    ------
    InputError
        If it is none; names the line.
    """
    try:
        return {(one.key, one.nth): one for one in _lines(path)}
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"{path} cannot be read: {error}.") from error


def _lines(path: Path) -> Iterator[Decision]:
    for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
        try:
            decision = Decision(**json.loads(line))
            honest = decision.key == key_of(decision.model, decision.request)
        except (ValueError, TypeError) as error:
            raise InputError(f"{path}, line {number}: no decision of a model ({error}).") from error
        if not honest:
            raise InputError(f"{path}, line {number}: the key does not fit the question.")
        yield decision


def model_of(decisions: Iterable[Decision]) -> str:
    """Return the name of the model that answered.

    Raises
    ------
    InputError
        If there is none, or several.
    """
    names = sorted({decision.model for decision in decisions})
    if len(names) != 1:
        raise InputError(f"A recording is of one model; this one is of {names or 'none'}.")
    return names[0]
