"""The journal: what ran on a city, with which arguments, for how long and with what result.

One SQLite file per city. A step is recorded before it starts and again when it ends, so a process
killed anywhere leaves a journal that says where.
"""

from __future__ import annotations

import json
import sqlite3
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from hashlib import blake2b
from pathlib import Path
from types import TracebackType
from typing import Any

_TABLES = """
CREATE TABLE IF NOT EXISTS run(
  id INTEGER PRIMARY KEY, inputs TEXT, config TEXT, seed INTEGER, status TEXT, content TEXT);
CREATE TABLE IF NOT EXISTS step(
  run_id INTEGER REFERENCES run(id), idx INTEGER, attempt INTEGER, action TEXT, args TEXT, key TEXT,
  status TEXT CHECK(status IN ('started', 'done', 'rolled_back', 'rejected')),
  state_before TEXT, state_after TEXT, error TEXT, ms INTEGER,
  PRIMARY KEY(run_id, idx, attempt));
"""


@dataclass(frozen=True)
class Step:
    """One row of the journal, as read back."""

    index: int
    attempt: int
    action: str
    args: Mapping[str, Any]
    status: str
    state_before: str
    state_after: str
    error: str
    milliseconds: int


def derivation_key(state: str, action: str, args: Mapping[str, Any]) -> str:
    """Name the state that an action with these arguments makes of a state, 32 hex digits.

    Actions are pure, so equal keys mean equal cities; no geometry has to be hashed between steps.
    """
    text = json.dumps([state, action, dict(args)], sort_keys=True)
    return blake2b(text.encode(), digest_size=16).hexdigest()


class Journal:
    """An open journal; a context manager.

    Parameters
    ----------
    path
        SQLite file, made when absent.
    """

    def __init__(self, path: Path) -> None:
        path.parent.mkdir(parents=True, exist_ok=True)
        self._db = sqlite3.connect(path)
        self._db.executescript("PRAGMA synchronous=FULL;" + _TABLES)

    def __enter__(self) -> Journal:
        """Return the journal itself."""
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Close the file."""
        self._db.close()

    def start_run(
        self, inputs: Sequence[Mapping[str, Any]], config: Mapping[str, Any], seed: int
    ) -> int:
        """Record a run and return its number."""
        row = (json.dumps(inputs), json.dumps(dict(config), sort_keys=True), seed)
        with self._db:
            cursor = self._db.execute(
                "INSERT INTO run(inputs, config, seed, status) VALUES(?, ?, ?, 'started')", row
            )
        return int(cursor.lastrowid or 0)

    def end_run(self, run: int, status: str, content: str) -> None:
        """Record how a run ended and the content hash of its city."""
        with self._db:
            self._db.execute(
                "UPDATE run SET status = ?, content = ? WHERE id = ?", (status, content, run)
            )

    def start_step(self, run: int, action: str, args: Mapping[str, Any], state: str) -> int:
        """Record that a step starts and return its index within the run."""
        with self._db:
            (index,) = self._db.execute(
                "SELECT COALESCE(MAX(idx) + 1, 0) FROM step WHERE run_id = ?", (run,)
            ).fetchone()
            key = derivation_key(state, action, args)
            self._db.execute(
                "INSERT INTO step(run_id, idx, attempt, action, args, key, status, state_before) "
                "VALUES(?, ?, 1, ?, ?, ?, 'started', ?)",
                (run, index, action, json.dumps(dict(args), sort_keys=True), key, state),
            )
        return int(index)

    def end_step(
        self, run: int, index: int, status: str, *, state: str = "", error: str = "", ms: int = 0
    ) -> None:
        """Record how a step ended."""
        with self._db:
            self._db.execute(
                "UPDATE step SET status = ?, state_after = ?, error = ?, ms = ? "
                "WHERE run_id = ? AND idx = ?",
                (status, state, error, ms, run, index),
            )

    def steps(self, run: int = 1) -> tuple[Step, ...]:
        """Return the steps of a run in order."""
        rows = self._db.execute(
            "SELECT idx, attempt, action, args, status, state_before, state_after, error, ms "
            "FROM step WHERE run_id = ? ORDER BY idx, attempt",
            (run,),
        ).fetchall()
        return tuple(
            Step(r[0], r[1], r[2], json.loads(r[3]), r[4], r[5], r[6] or "", r[7] or "", r[8] or 0)
            for r in rows
        )
