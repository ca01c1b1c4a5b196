"""The journal: what ran on a city, with which arguments, for how long and with what result.

A step is recorded before it starts and again when it ends, so a process killed anywhere leaves a
journal that says where. A run belongs to one process at a time, by a lease.
"""

from __future__ import annotations

import json
import os
import socket
import sqlite3
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from hashlib import blake2b
from pathlib import Path
from types import TracebackType
from typing import Any

from cityx.errors import InputError, UsageError

# The database of a city: its journal, its messages and its labels in one SQLite file.

VERSION = 2  # rises when an older program could not read the tables
WAIT_S = 10.0  # for a writer in another process

_TABLES = """
CREATE TABLE IF NOT EXISTS run(
  id INTEGER PRIMARY KEY, inputs TEXT, config TEXT, seed INTEGER, brief TEXT, registry TEXT,
  status TEXT, content TEXT, owner TEXT, lease_until REAL);
CREATE TABLE IF NOT EXISTS step(
  run_id INTEGER REFERENCES run(id), idx INTEGER, attempt INTEGER, action TEXT, args TEXT,
  bind TEXT, key TEXT,
  status TEXT CHECK(status IN ('started', 'done', 'rolled_back', 'rejected')),
  state_before TEXT, state_after TEXT, error TEXT, ms INTEGER,
  PRIMARY KEY(run_id, idx, attempt));
CREATE TABLE IF NOT EXISTS snapshot(
  run_id INTEGER REFERENCES run(id), state TEXT, folder TEXT, PRIMARY KEY(run_id, state));
CREATE TABLE IF NOT EXISTS message(
  run_id INTEGER REFERENCES run(id), seq INTEGER, step INTEGER, role TEXT, kind TEXT, body TEXT,
  parent INTEGER, tokens_in INTEGER, tokens_out INTEGER, PRIMARY KEY(run_id, seq));
CREATE TABLE IF NOT EXISTS decision(
  key TEXT, nth INTEGER, model TEXT, request TEXT, response TEXT, usage TEXT,
  PRIMARY KEY(key, nth));
CREATE TABLE IF NOT EXISTS label(
  registry TEXT, action TEXT, label TEXT, author TEXT, PRIMARY KEY(registry, action, label));
"""


def connect(path: Path) -> sqlite3.Connection:
    """Open the database of a city; it is made when absent.

    Every change is a transaction that is on disk when it ends, so that a process killed anywhere
    leaves the state before or after it. Readers in other processes see the last one that ended.

    Raises
    ------
    InputError
        If the file is no database, or one of another version.
    UsageError
        If another process is writing to it and does not end.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    database = sqlite3.connect(path, timeout=WAIT_S, check_same_thread=False)
    try:
        database.execute("PRAGMA synchronous=FULL")
        (version,) = database.execute("PRAGMA user_version").fetchone()
        (tables,) = database.execute("SELECT COUNT(*) FROM sqlite_master").fetchone()
        if tables and version != VERSION:
            raise InputError(
                f"{path} is a journal of version {version}, this program writes {VERSION}; build "
                "the city again."
            )
        if not tables:
            database.executescript(
                f"PRAGMA journal_mode=WAL; BEGIN IMMEDIATE; {_TABLES} "
                f"PRAGMA user_version={VERSION}; COMMIT;"
            )
    except sqlite3.DatabaseError as error:
        database.close()
        if _busy(error):
            raise UsageError(f"Another process is writing to {path}; wait until it ends.") from None
        raise InputError(f"{path} cannot be read as a journal: {error}.") from error
    except InputError:
        database.close()
        raise
    return database


def _busy(error: sqlite3.DatabaseError) -> bool:
    """Return whether a database is whole, but locked by another process."""
    return getattr(error, "sqlite_errorcode", 0) & 0xFF == sqlite3.SQLITE_BUSY


JOURNAL = "journal.sqlite"  # its name in the folder of a stored city
LEASE_S = 900.0  # seconds; a step that takes longer renews nothing, but few take a minute
STARTED, DONE, ENDED = "started", "done", "ended"


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


@dataclass(frozen=True)
class RunRecord:
    """What is known of a run.

    Attributes
    ----------
    number
        Of the run, from 1.
    brief
        What it was asked for, as JSON.
    status
        "started", "done", or why it ended otherwise.
    content
        Hash of the city it made.
    """

    number: int
    inputs: Sequence[Mapping[str, Any]]
    config: Mapping[str, Any]
    seed: int
    brief: Mapping[str, Any]
    registry: str
    status: str
    content: str


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

    Raises
    ------
    InputError
        If the file is no journal that this program can read.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self.database = connect(path)
        self._file = path.stat().st_ino

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
        self.close()

    def close(self) -> None:
        """Close the file."""
        self.database.close()

    def is_of(self, path: Path) -> bool:
        """Return whether this journal is the file that lies at a path now."""
        return path.exists() and path.stat().st_ino == self._file

    def copy_to(self, path: Path) -> None:
        """Write the journal as it is now to another file."""
        import sqlite3

        with sqlite3.connect(path) as target:
            self.database.backup(target)
        target.close()

    def start_run(
        self,
        inputs: Sequence[Mapping[str, Any]],
        config: Mapping[str, Any],
        seed: int,
        *,
        brief: Mapping[str, Any] | None = None,
        registry: str = "",
    ) -> int:
        """Record a run, which this process owns, and return its number."""
        row = (*_words(inputs, config, seed, brief), registry, _owner(), time.time() + LEASE_S)
        with self.database:
            cursor = self.database.execute(
                "INSERT INTO run(inputs, config, seed, brief, registry, status, owner, lease_until)"
                " VALUES(?, ?, ?, ?, ?, 'started', ?, ?)",
                row,
            )
        return int(cursor.lastrowid or 0)

    def unfinished(
        self,
        inputs: Sequence[Mapping[str, Any]],
        config: Mapping[str, Any],
        seed: int,
        *,
        brief: Mapping[str, Any] | None = None,
        registry: str = "",
    ) -> int | None:
        """Return the run that was asked for the same and never ended, if there is one."""
        found = self.database.execute(
            "SELECT id FROM run WHERE status = 'started' AND inputs = ? AND config = ? AND "
            "seed = ? AND brief = ? AND registry = ? ORDER BY id DESC LIMIT 1",
            (*_words(inputs, config, seed, brief), registry),
        ).fetchone()
        return None if found is None else int(found[0])

    def take(self, run: int) -> None:
        """Make a run this process's own.

        Raises
        ------
        UsageError
            If another process that lives owns it.
        """
        self._check_free(run)  # before it is locked, for an owner may be stopped while it writes
        with self.database:
            self.database.execute("BEGIN IMMEDIATE")
            self._check_free(run)
            self._renew(run)

    def _check_free(self, run: int) -> None:
        owner, until = self.database.execute(
            "SELECT owner, lease_until FROM run WHERE id = ?", (run,)
        ).fetchone()
        if owner != _owner() and until > time.time() and _lives(owner):
            raise UsageError(
                f"Process {owner.split()[1]} on {owner.split()[0]} is working on this city; "
                "wait until it ends."
            )

    def _renew(self, run: int) -> None:
        self.database.execute(
            "UPDATE run SET owner = ?, lease_until = ? WHERE id = ?",
            (_owner(), time.time() + LEASE_S, run),
        )

    def end_run(self, run: int, status: str, content: str) -> None:
        """Record how a run ended and the content hash of its city; its lease ends too."""
        with self.database:
            self.database.execute(
                "UPDATE run SET status = ?, content = ?, owner = '', lease_until = 0 WHERE id = ?",
                (status, content, run),
            )
            self.database.execute("DELETE FROM snapshot WHERE run_id = ?", (run,))

    def run(self, number: int) -> RunRecord:
        """Return what is known of a run."""
        row = self.database.execute(
            "SELECT id, inputs, config, seed, brief, registry, status, content FROM run "
            "WHERE id = ?",
            (number,),
        ).fetchone()
        inputs, config, brief = json.loads(row[1]), json.loads(row[2]), json.loads(row[4])
        return RunRecord(row[0], inputs, config, row[3], brief, row[5], row[6], row[7] or "")

    def runs(self) -> tuple[RunRecord, ...]:
        """Return all runs in order."""
        rows = self.database.execute("SELECT id FROM run ORDER BY id").fetchall()
        return tuple(self.run(number) for (number,) in rows)

    def done(self) -> dict[int, RunRecord]:
        """Return the runs that came to an end well, each a revision of the city, by number."""
        return {record.number: record for record in self.runs() if record.status == DONE}

    def start_step(
        self,
        run: int,
        action: str,
        args: Mapping[str, Any],
        state: str,
        *,
        bind: Mapping[str, str] | None = None,
    ) -> int:
        """Record that a step starts and return its index within the run.

        A step that a killed process left behind is started again, as another attempt.
        """
        key = derivation_key(state, action, args)
        with self.database:
            found = self.database.execute(
                "SELECT idx, attempt FROM step WHERE run_id = ? AND key = ? AND status = 'started' "
                "ORDER BY idx DESC, attempt DESC LIMIT 1",
                (run, key),
            ).fetchone()
            if found is None:
                (index,) = self.database.execute(
                    "SELECT COALESCE(MAX(idx) + 1, 0) FROM step WHERE run_id = ?", (run,)
                ).fetchone()
                attempt = 1
            else:
                index, attempt = found[0], found[1] + 1
                self.database.execute(
                    "UPDATE step SET status = 'rolled_back', error = 'the process ended' "
                    "WHERE run_id = ? AND idx = ? AND attempt = ?",
                    (run, index, found[1]),
                )
            self.database.execute(
                "INSERT INTO step(run_id, idx, attempt, action, args, bind, key, status, "
                "state_before) VALUES(?, ?, ?, ?, ?, ?, ?, 'started', ?)",
                (run, index, attempt, action, _text(args), _text(bind or {}), key, state),
            )
            self._renew(run)
        return int(index)

    def end_step(
        self,
        run: int,
        index: int,
        status: str,
        *,
        state: str = "",
        error: str = "",
        ms: int = 0,
        snapshot: str = "",
    ) -> None:
        """Record how the last attempt of a step ended, and the snapshot of the state it made."""
        with self.database:
            self.database.execute(
                "UPDATE step SET status = ?, state_after = ?, error = ?, ms = ? WHERE run_id = ? "
                "AND idx = ? AND attempt = (SELECT MAX(attempt) FROM step WHERE run_id = ? AND "
                "idx = ?)",
                (status, state, error, ms, run, index, run, index),
            )
            if snapshot:
                self.database.execute("DELETE FROM snapshot WHERE run_id = ?", (run,))
                self.database.execute(
                    "INSERT INTO snapshot(run_id, state, folder) VALUES(?, ?, ?)",
                    (run, state, snapshot),
                )

    def snapshot(self, run: int) -> tuple[str, str] | None:
        """Return the state of the last snapshot of a run and the folder that holds it."""
        found = self.database.execute(
            "SELECT state, folder FROM snapshot WHERE run_id = ?", (run,)
        ).fetchone()
        return None if found is None else (str(found[0]), str(found[1]))

    def steps(self, run: int = 1) -> tuple[Step, ...]:
        """Return the steps of a run in order."""
        rows = self.database.execute(
            "SELECT idx, attempt, action, args, status, state_before, state_after, error, ms "
            "FROM step WHERE run_id = ? ORDER BY idx, attempt",
            (run,),
        ).fetchall()
        return tuple(
            Step(r[0], r[1], r[2], json.loads(r[3]), r[4], r[5], r[6] or "", r[7] or "", r[8] or 0)
            for r in rows
        )


def _words(
    inputs: Sequence[Mapping[str, Any]],
    config: Mapping[str, Any],
    seed: int,
    brief: Mapping[str, Any] | None,
) -> tuple[str, str, int, str]:
    return json.dumps(inputs, sort_keys=True), _text(config), seed, _text(brief or {})


def _text(value: Mapping[str, Any]) -> str:
    return json.dumps(dict(value), sort_keys=True)


def _owner() -> str:
    return f"{socket.gethostname()} {os.getpid()} {_born(os.getpid())}"


def _born(process: int) -> str:
    """Return when a process started, as the system counts; "" where it does not tell."""
    try:
        return Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[19]
    except (OSError, IndexError):
        return ""


def _lives(owner: str) -> bool:
    """Return whether the process of an owner lives; of another machine that is not known."""
    host, process, *born = owner.split()
    if host != socket.gethostname():
        return True
    try:
        os.kill(int(process), 0)
    except ProcessLookupError:
        return False
    except PermissionError:
        pass
    return not born or born == [_born(int(process))]
