"""The database of a city: its journal, its messages and its labels in one SQLite file."""

from __future__ import annotations

import sqlite3
from pathlib import Path

from cityx.errors import InputError

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
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    database = sqlite3.connect(path, timeout=WAIT_S, check_same_thread=False)
    try:
        (version,) = database.execute("PRAGMA user_version").fetchone()
        (tables,) = database.execute("SELECT COUNT(*) FROM sqlite_master").fetchone()
        if tables and version != VERSION:
            raise InputError(
                f"{path} is a journal of version {version}, this program writes {VERSION}; build "
                "the city again."
            )
        database.executescript(
            f"PRAGMA journal_mode=WAL; PRAGMA synchronous=FULL; {_TABLES} "
            f"PRAGMA user_version={VERSION};"
        )
    except sqlite3.DatabaseError as error:
        database.close()
        raise InputError(f"{path} cannot be read as a journal: {error}.") from error
    except InputError:
        database.close()
        raise
    return database
