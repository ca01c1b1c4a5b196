"""The owner: the one thread that holds a city open and runs requests in turn."""

from __future__ import annotations

import logging
import queue
import threading
from collections import OrderedDict
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from types import TracebackType
from typing import Any, TypeVar

from cityx.agents.journal import JOURNAL
from cityx.errors import CityxError
from cityx.options import PlannerChoice
from cityx.projects.desk import STORE, Cancelled, Conflict, Desk, recover
from cityx.projects.locks import locked
from cityx.projects.results import result_folder
from cityx.protocol.registry import Registry
from cityx.server.differences import changed_ids, changed_parts, difference
from cityx.server.jobs import Job
from cityx.server.replies import Busy, KeyTaken, NoCity, Reply, reply_of_error, reply_of_fault
from cityx.server.seen import Contents, Seen, look

MOST_WAITING = 32  # jobs in the queue; a client that sends more is told to wait
MOST_JOBS = 500  # jobs that can still be asked for
MOST_KEYS = 2000  # answers kept for calls that are sent again
GRACE_S = 10.0  # for the action in progress when the server ends
MOST_CHANGED = 100  # ids in an answer; scene_diff pages through the rest

T = TypeVar("T")
log = logging.getLogger(__name__)


class Owner:
    """Holds the desk of a folder in a thread of its own; a context manager.

    Parameters
    ----------
    folder
        Of a built city, or where one is to be built.
    actions
        The registry.
    choice
        Who reads and plans what is asked for in words.

    Raises
    ------
    InputError, UsageError
        If the folder cannot be used.
    """

    def __init__(
        self, folder: Path, actions: Registry, choice: PlannerChoice | None = None
    ) -> None:
        self.folder = result_folder(folder)
        self.actions = actions
        self.choice = choice or PlannerChoice()
        self.contents = Contents()
        self.jobs: OrderedDict[str, Job] = OrderedDict()
        self.listeners: list[Callable[[], None]] = []
        self.early_listeners: list[Callable[[], None]] = []
        self._keys: OrderedDict[str, tuple[str, Job]] = OrderedDict()
        self._queue: queue.Queue[Job | None] = queue.Queue(MOST_WAITING)
        self._lock = threading.Lock()
        self._desk: Desk | None = None
        self._opened: tuple[int, int] | None = None
        self.seen = Seen(self.folder)
        self._open()
        self._thread = threading.Thread(target=self._run, name="cityx owner", daemon=True)
        self._thread.start()

    def __enter__(self) -> Owner:
        """Return the owner itself."""
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Call off what waits and end the thread once the action in progress has ended."""
        for job in tuple(self.jobs.values()):
            job.cancel()
        with suppress(queue.Full):
            self._queue.put(None, timeout=GRACE_S)
        self._thread.join(GRACE_S)

    @property
    def alive(self) -> bool:
        """Whether the thread runs."""
        return self._thread.is_alive()

    @property
    def waiting(self) -> int:
        """Number of jobs in the queue."""
        return self._queue.qsize()

    @property
    def busy(self) -> bool:
        """Whether a job runs or waits."""
        return any(job.state != "ended" for job in tuple(self.jobs.values()))

    def submit(
        self, what: str, work: Callable[[Job], Reply], *, key: str = "", request: str = ""
    ) -> Job:
        """Put work in the queue and return its job; from any thread, at once.

        Parameters
        ----------
        what
            Name of the tool.
        work
            See `Job`.
        key
            Idempotency key: the job of the first call with it is returned, "" for none.
        request
            What was asked for with the key, as text.

        Raises
        ------
        Busy
            If the queue is full.
        KeyTaken
            If the key came with another request.
        """
        with self._lock:
            if key in self._keys:
                asked, known = self._keys[key]
                if asked != request:
                    raise KeyTaken(f'The key "{key}" was used for another call; take a new one.')
                return known
            job = Job(what, work)
            try:
                self._queue.put_nowait(job)
            except queue.Full:
                raise Busy(f"{MOST_WAITING} calls wait already; ask again later.") from None
            _put(self.jobs, job.id, job, MOST_JOBS)
            if key:
                _put(self._keys, key, (request, job), MOST_KEYS)
        return job

    def desk(self) -> Desk:
        """Return the desk as the folder is now; only for work, in the thread of the owner.

        Raises
        ------
        NoCity
            If there is no city.
        """
        if self._desk is None:
            raise NoCity("There is no city yet; build one with run_brief.")
        return self._desk

    def expect(self, revision: int | None) -> None:
        """Refuse work for a city that has another revision by now; only for work.

        Raises
        ------
        Conflict
            If the number is given and another one.
        """
        now = self.seen.revision
        if revision not in (None, now):
            raise Conflict(f"The city has revision {now} by now, not {revision}; look at it again.")

    def lend(self, work: Callable[[Path], T]) -> T:
        """Hand the folder to work that opens it itself, and open it again afterwards."""
        self._close()
        try:
            return work(self.folder)
        finally:
            self._open()

    def outdated(self) -> bool:
        """Return whether another process changed the city since it was read; from any thread."""
        return self._signature() != self._opened

    def renew(self) -> None:
        """Reload the folder if another process changed it; only for work."""
        if self.outdated():
            self._close()
            self._open()

    def ok(self, data: Mapping[str, Any], message: str = "", **more: Any) -> Reply:
        """Return the reply that describes the city as it is; from any thread."""
        return Reply("ok", "OK", message, self.seen.revision, data=data, **more)

    def changed(self, before: Seen, job: Job, message: str, **more: Any) -> Reply:
        """Return the reply that describes what changed."""
        after = self.seen
        ids: list[str] = []
        if before.city is not None and after.city is not None:
            hashes = [self.contents.of(seen, seen.revision) for seen in (before, after)]
            ids = changed_parts(before.city, after.city) + changed_ids(difference(*hashes))
        warnings = list(more.pop("warnings", ()))
        if before.city is None:
            warnings.append("The city is new; every object of it is.")
        if len(ids) > MOST_CHANGED:
            warnings.append(
                f"{len(ids)} parts and objects changed, {MOST_CHANGED} are named; "
                f"scene_diff({before.revision}, {after.revision}) has all."
            )
        return Reply(
            "ok", "OK", message, after.revision, tuple(ids[:MOST_CHANGED]),
            warnings=tuple(warnings), job_id=job.id, **more,
        )  # fmt: skip

    def publish(self) -> None:
        """Publish the current city to readers; only for work."""
        before, self.seen = self.seen, Seen(self.folder) if self._desk is None else look(self._desk)
        if self.seen.revision != before.revision or self.seen.city is not before.city:
            for listener in tuple(self.listeners):
                listener()

    def tell_stored(self) -> None:
        """Tell those who show the city that the folder holds another; only for work.

        They come before what a change takes to be judged.
        """
        for listener in tuple(self.early_listeners):
            listener()

    def _run(self) -> None:
        while (job := self._queue.get()) is not None:
            job.running = True
            job.reply.set_result(self._reply(job))
        self._close()

    def _reply(self, job: Job) -> Reply:
        try:
            if job.cancelled():
                raise Cancelled("Called off before it began.")
            self.renew()
            return job.work(job)
        except CityxError as error:
            return self._told(reply_of_error(error, 0, job.id))
        except Exception as error:
            log.exception("%s failed", job.what)
            return self._told(reply_of_fault(error, 0, job.id))

    def _told(self, reply: Reply) -> Reply:
        """Publish what a failure left, such as its run in the journal, and tell the revision."""
        self.publish()
        return replace(reply, state_rev=self.seen.revision)

    def _signature(self) -> tuple[int, int] | None:
        """Return what identifies the store in the folder; None without one."""
        store = self.folder / STORE
        try:
            return store.stat().st_ino, (store / JOURNAL).stat().st_ino
        except OSError:
            return None

    def _open(self) -> None:
        if self.folder.exists() and not (self.folder / STORE).exists():
            with locked(self.folder):
                recover(self.folder)  # a change was cut between two renames
        if (self.folder / STORE / "city.json").exists():
            self._desk = Desk(self.folder, self.actions)
        self._opened = self._signature()
        self.publish()

    def _close(self) -> None:
        if self._desk is not None:
            self._desk.journal.close()
        self._desk = None

    def committed(self) -> None:
        """Note that the desk itself put another store in the folder; only for work."""
        self._opened = self._signature()
        self.publish()


def _put(table: OrderedDict[str, T], key: str, value: T, most: int) -> None:
    """Add an entry and drop the oldest beyond a number."""
    table[key] = value
    while len(table) > most:
        table.popitem(last=False)
