"""The desk: a built city opened for changes; each becomes a revision, whole or not at all.

A change is written beside the store and takes its place by a rename, together with the journal that
tells of it; the store as it was goes to the folder ``history`` under the number of its revision.
What a change leaves alone is linked there, so that it costs neither time nor room.
"""

from __future__ import annotations

import math
import shutil
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import Any

from cityx.agents.journal import (
    DONE,
    JOURNAL,
    STARTED,
    Journal,
    RunRecord,
    derivation_key,
)
from cityx.agents.pool import Message, Pool
from cityx.agents.step_runner import Run, unwatched
from cityx.city import City
from cityx.city.content import HASHES, content_hash, read_hash, write_hash
from cityx.city.store import read_city, replace_folder, write_city
from cityx.errors import CityxError, DiskError, UsageError
from cityx.projects.locks import locked
from cityx.protocol.gate import Budget, Call
from cityx.protocol.input_files import InputFiles
from cityx.protocol.registry import Registry, registry
from cityx.system.atomic import disk_fault

STORE, NEXT, OLD, HISTORY = "city", "city.next", "city.old", "history"


class Conflict(UsageError):
    """Another process changed the city since the caller read it."""


class Cancelled(CityxError):
    """A change was cancelled by its caller; the city stays as it was."""


@dataclass(frozen=True)
class Revision:
    """A state that a city had.

    Attributes
    ----------
    number
        Of the run that led to it, from 1.
    text
        What was asked for.
    actions
        What ran.
    content
        Hash of the city.
    """

    number: int
    text: str
    actions: tuple[str, ...]
    content: str


class Desk:
    """A built city opened for changes; a context manager.

    Parameters
    ----------
    folder
        Folder of a built city.
    actions
        The registry; that of all actions when left out.

    Raises
    ------
    InputError
        If the folder holds no city.
    """

    def __init__(self, folder: Path, actions: Registry | None = None) -> None:
        self.folder = folder
        self.actions = registry() if actions is None else actions
        with locked(folder):
            recover(folder)
            self.city = read_city(self._store)
            self.journal = Journal(self._store / JOURNAL)
            self._close_dead_runs()

    @property
    def _store(self) -> Path:
        return self.folder / STORE

    def __enter__(self) -> Desk:
        """Return the desk itself."""
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Close the journal."""
        self.journal.close()

    @property
    def revision(self) -> int:
        """Number of the revision that the city on disk has."""
        return max(self.journal.done(), default=0)

    def revisions(self) -> tuple[Revision, ...]:
        """Return every revision that can be gone back to, in order."""
        return tuple(
            Revision(
                record.number,
                str(record.brief.get("text", "")),
                tuple(s.action for s in self.journal.steps(record.number) if s.status == "done"),
                record.content,
            )
            for record in self.journal.done().values()
        )

    def change(
        self,
        calls: Sequence[Call],
        *,
        text: str = "",
        expected: int | None = None,
        inputs: InputFiles | None = None,
        budget: Budget | None = None,
        cancelled: Callable[[], bool] = lambda: False,
        base: int | None = None,
        calling: Callable[[int], None] = lambda _: None,
        watched: Callable[[Run, City], City] = unwatched,
    ) -> Revision:
        """Run actions on the city and keep the result as a new revision; all of them or none.

        Where they change nothing there is no new revision; the newest is returned.

        Parameters
        ----------
        calls
            Actions in order.
        text
            What was asked for, in words.
        expected
            Revision that the caller looked at, None for any.
        inputs
            Files the user handed in.
        budget
            What may be spent.
        cancelled
            Asked after each action whether the change is called off.
        base
            Earlier revision that the actions run on, the newest when None: then what came after it
            is undone by the same change.
        calling
            Called with the place of each action before it runs.
        watched
            Looks at the changed city and has it mended by the run.

        Raises
        ------
        Conflict
            If the city has another revision by now.
        Cancelled
            If the change was called off; the city stays as it was.
        ActionRejected, ActionFailed
            If a call may not run or fails; the city stays as it was.
        """
        with self._alone(expected):
            base = base or self.revision
            return self._change(calls, text, inputs, budget, cancelled, base, calling, watched)

    def _change(
        self,
        calls: Sequence[Call],
        text: str,
        inputs: InputFiles | None,
        budget: Budget | None,
        cancelled: Callable[[], bool],
        base: int,
        calling: Callable[[int], None],
        watched: Callable[[Run, City], City],
    ) -> Revision:
        city = start = self.at(base)
        config: dict[str, Any] = {"calls": [call.key for call in calls]}
        number = self._begin(text, config | ({} if base == self.revision else {"base": base}))
        pool = Pool(self.journal.database, number)
        pool.say(Message("user", "brief", {"text": text}))
        state = derivation_key("", "revision", {"content": self.content_at(base)})
        run = Run(
            self.journal, number, state, self.actions, inputs=inputs or InputFiles(), budget=budget
        )
        try:
            for place, call in enumerate(calls):
                calling(place)
                city = run.do(city, call)
                if cancelled():
                    raise Cancelled(f"Called off after {call.action}; the city stays as it was.")
            city = watched(run, city)
            if cancelled():
                raise Cancelled("Called off; the city stays as it was.")
        except CityxError as error:
            pool.say(Message("backend", "reject", {"error": str(error)}))
            self.journal.end_run(number, "rolled_back", "")
            raise
        like = start, self._source(base)
        if base == self.revision and self._is_same(city, like):
            self.journal.end_run(number, "unchanged", "")
            return self.revisions()[-1]
        return self._commit(number, city, like)

    def _is_same(self, city: City, like: tuple[City, Path]) -> bool:
        """Return whether a change left all of a city as it is stored."""
        shared, source = like
        held = read_hash(source / HASHES)
        return held is not None and content_hash(city, (shared, held)).total == held.total

    def undo(self, to: int | None = None, *, expected: int | None = None) -> Revision:
        """Go back to an earlier revision, or forward to one that was undone.

        Parameters
        ----------
        to
            The revision; the one before the last change when left out.
        expected
            As of `change`.

        Raises
        ------
        UsageError
            If there is no such revision.
        Conflict
            As of `change`.
        """
        with self._alone(expected):
            return self._back_to(self.led((-1,)) if to is None else to)

    def redo(self, to: int | None = None, *, expected: int | None = None) -> Revision:
        """Make the change that was undone last again; as of `undo`."""
        with self._alone(expected):
            return self._back_to(self.led((1,)) if to is None else to)

    def led(self, steps: Iterable[float]) -> int:
        """Return the revision that undoing and redoing in turn lead to.

        Parameters
        ----------
        steps
            How many changes are undone, negative, or redone; infinite for all there are.

        Raises
        ------
        UsageError
            If there are fewer.
        """
        states, place = self._line()
        for step in steps:
            room = place if step < 0 else len(states) - 1 - place
            if math.isfinite(step) and abs(step) > room:
                verb = "undo" if step < 0 else "redo"
                raise UsageError(
                    f"There are {room} changes to {verb}, not {abs(step):g}."
                    if room > 0
                    else f"There is nothing to {verb}."
                )
            place += int(math.copysign(min(abs(step), max(room, 0)), step))
        return states[place] if states else self.revision

    def at(self, number: int) -> City:
        """Return the city as it was at a revision.

        Raises
        ------
        UsageError
            If there is no such revision.
        """
        return self.city if number == self.revision else read_city(self._source(number))

    def content_at(self, number: int) -> str:
        """Return the hash of the city as it was at a revision, "" where none is known."""
        found = self.journal.done().get(number)
        return found.content if found is not None else ""

    def _source(self, number: int) -> Path:
        """Return the folder that holds a revision."""
        known = self.journal.done()
        if number == self.revision:
            return self._store
        if number not in known:
            raise UsageError(
                f"There is no revision {number}; they are {', '.join(map(str, sorted(known)))} "
                f"({self.revision} is the last)."
            )
        return self.folder / HISTORY / str(number)

    def _back_to(self, wanted: int) -> Revision:
        city = self.at(wanted)
        number = self._begin(f"back to revision {wanted}", {"same_as": wanted})
        return self._commit(number, city, (city, self._source(wanted)))

    def _line(self) -> tuple[list[int], int]:
        """Return the revisions that changes led to, one after the other, and where one is in them.

        What was undone when something else was changed is no longer one of them.
        """
        known = self.journal.done()
        states: list[int] = []
        place = -1
        for number in sorted(known):
            state = _state(number, known)
            if state in states:
                place = states.index(state)
                continue
            base = _state(known[state].config.get("base", 0), known)
            place = states.index(base) if base in states else place
            states = [*states[: place + 1], state]
            place = len(states) - 1
        return states, place

    @contextmanager
    def _alone(self, expected: int | None) -> Iterator[None]:
        """Lock the city folder and reload its newest revision."""
        with locked(self.folder):
            if not self.journal.is_of(self._store / JOURNAL):
                self.journal.close()
                recover(self.folder)
                self.journal = Journal(self._store / JOURNAL)
                self.city = read_city(self._store)
            now = self.revision
            if expected is not None and expected != now:
                raise Conflict(
                    f"The city has revision {now} by now, not {expected}; look at it again."
                )
            yield

    def _begin(self, text: str, config: Mapping[str, Any]) -> int:
        for record in self.journal.runs():
            if record.status == STARTED:
                self.journal.take(record.number)
        return self.journal.start_run([], config, self.city.seed, brief={"text": text})

    def _commit(self, number: int, city: City, like: tuple[City, Path]) -> Revision:
        """Put a city in the place of the one on disk, with the journal that tells of it.

        What it shares with a city that is stored, `like`, is not written again.
        """
        shared, source = like
        before = self.revision
        following = self.folder / NEXT
        try:
            write_city(city, following, like=like)
            held = read_hash(source / HASHES)
            content = content_hash(city, None if held is None else (shared, held))
            write_hash(content, following / HASHES)
            self.journal.copy_to(following / JOURNAL)
            with Journal(following / JOURNAL) as told:
                told.end_run(number, DONE, content.total)
        except Exception as error:
            for left in (following, self.folder / f"{NEXT}.partial"):
                shutil.rmtree(left, ignore_errors=True)
            if refused := disk_fault(error, self.folder):
                raise DiskError(f"{refused}. The city is as it was.") from error
            raise
        self.journal.close()
        try:
            self._store.rename(self.folder / OLD)
            following.rename(self._store)
            _put_away(self.folder, before)
        except OSError as error:
            recover(self.folder)
            self.journal = Journal(self._store / JOURNAL)
            raise UsageError(f"{self.folder} cannot be changed: {error.strerror}.") from error
        self.journal = Journal(self._store / JOURNAL)
        self.city = city
        return self.revisions()[-1]

    def _close_dead_runs(self) -> None:
        """End the runs of processes that were killed; their changes never came about."""
        for record in self.journal.runs():
            if record.status == STARTED:
                try:
                    self.journal.take(record.number)
                except UsageError:
                    continue
                self.journal.end_run(record.number, "killed", "")


def _state(number: int, known: Mapping[int, RunRecord]) -> int:
    """Return the revision that first had the state that a revision has."""
    while number in known and "same_as" in known[number].config:
        number = int(known[number].config["same_as"])
    return number


def recover(folder: Path) -> None:
    """Finish a change whose process was killed while its result took the place of the city."""
    store, following, old = folder / STORE, folder / NEXT, folder / OLD
    if not store.exists() and (following / JOURNAL).exists():
        following.rename(store)
    elif not store.exists() and old.exists():
        old.rename(store)
    if old.exists():
        with Journal(store / JOURNAL) as journal:
            *_, before, _ = (0, *sorted(journal.done()))  # 0 for a city that came without a journal
        _put_away(folder, before)
    if store.exists():
        for left in (following, folder / f"{NEXT}.partial"):
            shutil.rmtree(left, ignore_errors=True)


def _put_away(folder: Path, number: int) -> None:
    """Move the store as it was before a change to the history."""
    old, target = folder / OLD, folder / HISTORY / str(number)
    for path in old.glob(f"{JOURNAL}*"):
        path.unlink()
    target.parent.mkdir(exist_ok=True)
    replace_folder(old, target)
