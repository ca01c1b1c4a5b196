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
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from hashlib import sha256
from pathlib import Path
from typing import Any

from cityx.agents.models.quoting import scrubbed
from cityx.errors import InputError, UsageError

SHOWN = 200  # letters of a question that has no answer in a recording


class NotRecorded(UsageError):
    """A replay was asked what its recording has no answer to."""


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
    database
        Of the city, or None.
    record
        File that every new decision is added to, or None.
    replay
        Decisions that are played; with them, what they do not hold is an error. None to ask.
    secrets
        Texts that must not be kept.
    """

    database: sqlite3.Connection | None = None
    record: Path | None = None
    replay: Mapping[tuple[str, int], Decision] | None = None
    secrets: tuple[str, ...] = ()
    _asked: Counter[str] = field(default_factory=Counter)

    def find(self, model: str, request: Mapping[str, Any]) -> Decision | None:
        """Return the answer that is known to a question, None where the model is to be asked.

        Raises
        ------
        NotRecorded
            If a replay holds no answer.
        """
        key = key_of(model, request)
        nth = self._asked[key]
        found = self._known(key, nth)
        if found is None and self.replay is not None:
            raise NotRecorded(
                f"The recording has no answer number {nth + 1} of {model} to this question "
                f"({key[:12]}): {json.dumps(request, ensure_ascii=False)[:SHOWN]}... "
                "Record it anew."
            )
        if found is not None:
            self._asked[key] += 1
        return found

    def _known(self, key: str, nth: int) -> Decision | None:
        if self.replay is not None:
            return self.replay.get((key, nth))
        if self.database is None:
            return None
        row = self.database.execute(
            "SELECT model, request, response, usage FROM decision WHERE key = ? AND nth = ?",
            (key, nth),
        ).fetchone()
        return Decision(key, nth, row[0], *map(json.loads, row[1:])) if row else None

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
        if self.database is not None:
            texts = [json.dumps(one) for one in (decision.request, decision.response, usage)]
            with self.database:
                self.database.execute(
                    "INSERT OR REPLACE INTO decision VALUES(?, ?, ?, ?, ?, ?)",
                    (key, decision.nth, model, *texts),
                )
        if self.record is not None:
            with self.record.open("a", encoding="utf-8") as file:
                file.write(json.dumps(vars(decision), ensure_ascii=False) + "\n")

    def _clean(self, value: Mapping[str, Any]) -> Any:
        return json.loads(scrubbed(json.dumps(value, ensure_ascii=False), self.secrets))


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
