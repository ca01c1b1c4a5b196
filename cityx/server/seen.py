"""What is seen of a city between two changes: values that any thread may read."""

from __future__ import annotations

import threading
from collections import OrderedDict
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from types import MappingProxyType

from cityx.agents.journal import RunRecord, Step
from cityx.city import City
from cityx.city.content import ContentHash, content_hash
from cityx.city.store import read_city
from cityx.errors import UsageError
from cityx.projects.desk import HISTORY, Desk, Revision
from cityx.server.replies import NoCity

KEPT = 4  # content hashes in memory: both sides of a difference, twice


@dataclass(frozen=True)
class Seen:
    """A city as it was when it was looked at last.

    Attributes
    ----------
    folder
        Of the city.
    revision
        Its number, 0 without a city.
    city
        None where none was built yet.
    revisions
        That can be gone back to.
    runs
        Number to run and steps, those that failed too.
    """

    folder: Path
    revision: int = 0
    city: City | None = None
    revisions: tuple[Revision, ...] = ()
    runs: Mapping[int, tuple[RunRecord, tuple[Step, ...]]] = field(
        default_factory=lambda: MappingProxyType({})
    )

    @property
    def built(self) -> City:
        """The city.

        Raises
        ------
        NoCity
            If there is none.
        """
        if self.city is None:
            raise NoCity("There is no city yet; build one with run_brief.")
        return self.city


def look(desk: Desk) -> Seen:
    """Return what is seen of an open city; only the thread that owns the desk may ask."""
    runs = {record.number: (record, desk.journal.steps(record.number))
            for record in desk.journal.runs()}  # fmt: skip
    return Seen(desk.folder, desk.revision, desk.city, desk.revisions(), MappingProxyType(runs))


class Contents:
    """Content hashes of revisions, the last few kept."""

    def __init__(self) -> None:
        self._held: OrderedDict[str, ContentHash] = OrderedDict()
        self._lock = threading.Lock()

    def of(self, seen: Seen, revision: int) -> ContentHash:
        """Return the hashes of a revision.

        Raises
        ------
        UsageError
            If there is no such revision.
        NoCity
            If there is no city at all.
        """
        city = seen.built
        known = {item.number: item.content for item in seen.revisions}
        if revision not in known:
            words = ", ".join(map(str, sorted(known)))
            raise UsageError(f"There is no revision {revision}; they are {words}.")
        with self._lock:
            content = known[revision]
            if content not in self._held:
                if revision != seen.revision:
                    city = read_city(seen.folder / HISTORY / str(revision))
                self._held[content] = content_hash(city)
            self._held.move_to_end(content)
            while len(self._held) > KEPT:
                self._held.popitem(last=False)
            return self._held[content]
