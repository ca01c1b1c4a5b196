"""The manifest: which shots are taken, with the checksums of their files.

While a dataset is made it is a database in which a shot appears when all its files are on the
disk; of a finished one it is ``manifest.jsonl``, a line per shot in their order.
"""

from __future__ import annotations

import json
import sqlite3
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import asdict, dataclass, field
from hashlib import file_digest
from pathlib import Path
from typing import Any

from cityx.dataset.writers.files import Written
from cityx.dataset.writers.format import Kept, Place
from cityx.errors import CityxError, InputError

NAME = "manifest.jsonl"
_TABLES = """
CREATE TABLE IF NOT EXISTS shot(
  number INTEGER PRIMARY KEY, moment INTEGER, city TEXT, name TEXT, files TEXT, parts TEXT,
  statistics TEXT, bytes INTEGER);
CREATE TABLE IF NOT EXISTS file(path TEXT PRIMARY KEY, sha256 TEXT, size INTEGER);
"""


class DiskFull(CityxError):
    """The disk, or the part of it that a dataset may use, is full; what is done stays done."""


@dataclass(frozen=True)
class Done:
    """A shot whose files are complete.

    Attributes
    ----------
    place, name
        Which shot.
    files
        Its files.
    parts
        What each format keeps of it.
    statistics
        What the card and the page tell of it; see `cityx.dataset.statistics`.
    seconds
        Of the makers by their names, and of "files".
    """

    place: Place
    name: str
    files: tuple[Written, ...]
    parts: Mapping[str, Any]
    statistics: Mapping[str, Any]
    seconds: Mapping[str, float] = field(default_factory=dict)


class Manifest:
    """The database of a dataset in the making; a class because it holds a connection.

    Raises
    ------
    InputError
        If the file is no such database.
    """

    def __init__(self, path: Path) -> None:
        path.parent.mkdir(parents=True, exist_ok=True)
        self._database = sqlite3.connect(path)
        try:
            with _full_disk():
                self._database.executescript(
                    f"PRAGMA journal_mode=WAL; PRAGMA synchronous=FULL; {_TABLES}"
                )
        except sqlite3.DatabaseError as error:
            self._database.close()
            raise InputError(f"{path} cannot be read as a manifest: {error}.") from error

    def close(self) -> None:
        """Close the database."""
        self._database.close()

    def add(self, done: Done) -> None:
        """Note a shot whose files are complete; that is on the disk when this returns."""
        size = sum(file.size for file in done.files if not file.path.startswith("."))
        row = (
            done.place.number, done.place.moment, done.place.city, done.name,
            json.dumps([asdict(file) for file in done.files]), json.dumps(dict(done.parts)),
            json.dumps(dict(done.statistics)), size,
        )  # fmt: skip
        with _full_disk(), self._database:
            self._database.execute("INSERT OR REPLACE INTO shot VALUES(?,?,?,?,?,?,?,?)", row)

    def add_files(self, files: Sequence[Written]) -> None:
        """Note files that speak of no single shot."""
        rows = [(file.path, file.sha256, file.size) for file in files]
        with _full_disk(), self._database:
            self._database.executemany("INSERT OR REPLACE INTO file VALUES(?,?,?)", rows)

    def numbers(self) -> set[int]:
        """Return the numbers of the shots that are done."""
        return {row[0] for row in self._database.execute("SELECT number FROM shot")}

    def holds(self, path: str) -> bool:
        """Return whether a file that speaks of no single shot is complete."""
        rows = self._database.execute("SELECT 1 FROM file WHERE path = ?", (path,))
        return rows.fetchone() is not None

    def count(self, city: str) -> int:
        """Return how many shots of a city are done."""
        (count,) = self._database.execute(
            "SELECT COUNT(*) FROM shot WHERE city = ?", (city,)
        ).fetchone()
        return int(count)

    def size(self) -> int:
        """Return the bytes of all files so far."""
        (shots,) = self._database.execute("SELECT TOTAL(bytes) FROM shot").fetchone()
        (files,) = self._database.execute("SELECT TOTAL(size) FROM file").fetchone()
        return int(shots + files)

    def parts(self, format_name: str) -> Callable[[], Iterator[Kept]]:
        """Return what gives the parts of a format in the order of the shots."""

        def read() -> Iterator[Kept]:
            rows = self._database.execute(
                "SELECT number, moment, city, name, parts FROM shot ORDER BY number"
            )
            for number, moment, city, name, parts in rows:
                place = Place(number, moment, city)
                yield Kept(place, name, json.loads(parts).get(format_name, {}))

        return read

    def statistics(self) -> Iterator[tuple[str, dict[str, Any]]]:
        """Yield city and statistics of the shots in their order."""
        rows = self._database.execute("SELECT city, statistics FROM shot ORDER BY number")
        for city, statistics in rows:
            yield city, json.loads(statistics)

    def names(self) -> dict[int, str]:
        """Return what the shots are called, with their city, by their numbers."""
        rows = self._database.execute("SELECT number, city, name FROM shot")
        return {number: f"{city} · {name}" for number, city, name in rows}

    def lines(self) -> Iterator[str]:
        """Yield the lines of the finished manifest: shots in their order, then other files."""
        rows = self._database.execute("SELECT number, city, name, files FROM shot ORDER BY number")
        for number, city, name, files in rows:
            listed = [file for file in json.loads(files) if not file["path"].startswith(".")]
            record = {"number": number, "city": city, "shot": name, "files": listed}
            yield json.dumps(record) + "\n"
        for path, digest, size in self._database.execute("SELECT * FROM file ORDER BY path"):
            yield json.dumps({"files": [{"path": path, "sha256": digest, "size": size}]}) + "\n"


@contextmanager
def _full_disk() -> Iterator[None]:
    try:
        yield
    except sqlite3.OperationalError as error:
        if "full" in str(error) or "disk I/O" in str(error):
            raise DiskFull("The disk is full.") from error
        raise


def faults_of(folder: Path) -> list[str]:
    """Return what is wrong with the files of a finished dataset, a sentence each.

    Every file is read and its checksum compared with that of the manifest.
    """
    faults = []
    with (folder / NAME).open(encoding="utf-8") as lines:
        for line in lines:
            for file in json.loads(line)["files"]:
                path = folder / file["path"]
                if not path.is_file():
                    faults.append(f"{file['path']} is missing.")
                    continue
                with path.open("rb") as content:
                    if file_digest(content, "sha256").hexdigest() != file["sha256"]:
                        faults.append(f"{file['path']} is not what was written.")
    return faults
