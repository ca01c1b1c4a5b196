"""Workers: processes that take shots in chunks, are replaced, and may die without harm."""

from __future__ import annotations

import logging
import os
import re
import signal
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from importlib import import_module
from multiprocessing import get_context, parent_process
from multiprocessing.connection import Connection, wait
from multiprocessing.context import SpawnProcess
from threading import Thread
from typing import Any

from cityx.errors import EngineError, MissingExtra, UsageError

ATTEMPTS = 2  # at a shot at which a worker died, before it is given up
THREADS = ("NUMBA_NUM_THREADS", "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS")


@dataclass(frozen=True)
class Died:
    """What is said of an item at which its worker died as often as is tried."""

    item: Any
    cause: str


# Does a chunk and yields a result per item, in their order; top level, so that it can be sent.
Work = Callable[[Any, Sequence[Any]], Iterator[Any]]


@dataclass
class _Worker:
    process: SpawnProcess
    connection: Connection
    left: deque[Any] = field(default_factory=deque)
    done: int = 0


class Pool:
    """Processes on this machine.

    Parameters
    ----------
    work
        What each does with a chunk.
    job
        First argument of `work`, sent once to each process.
    count
        How many.
    renew
        Items after which a process is replaced, so that what libraries leak is given back.
    """

    def __init__(self, work: Work, job: Any, count: int, *, renew: int) -> None:
        self._work, self._job = work, job
        self._count, self._renew = count, renew
        self._workers: list[_Worker] = []

    def run(self, chunks: Sequence[Sequence[Any]]) -> Iterator[Any]:
        """Yield results as they come: those of `work`, and `Died` for items that kill workers."""
        waiting = deque(list(chunk) for chunk in chunks if len(chunk))
        deaths: dict[int, int] = {}
        while waiting or any(worker.left for worker in self._workers):
            self._hand_out(waiting)
            ready = wait([worker.connection for worker in self._workers if worker.left])
            for worker in [w for w in self._workers if w.connection in ready]:
                try:
                    result = worker.connection.recv()
                except (EOFError, OSError):
                    yield from self._bury(worker, waiting, deaths)
                    continue
                worker.left.popleft()
                worker.done += 1
                yield result

    def _hand_out(self, waiting: deque[list[Any]]) -> None:
        for worker in [w for w in self._workers if not w.left and w.done >= self._renew]:
            self._end(worker)
        while waiting and len(self._workers) < min(
            self._count, len(waiting) + sum(bool(w.left) for w in self._workers)
        ):
            self._workers.append(self._start())
        for worker in self._workers:
            if waiting and not worker.left:
                chunk = waiting.popleft()
                worker.left.extend(chunk)
                worker.connection.send(chunk)

    def _start(self) -> _Worker:
        context = get_context("spawn")
        ours, theirs = context.Pipe()
        process = context.Process(target=_serve, args=(theirs, self._work, self._job), daemon=False)
        process.start()
        theirs.close()
        return _Worker(process, ours)

    def _bury(
        self, worker: _Worker, waiting: deque[list[Any]], deaths: dict[int, int]
    ) -> Iterator[Died]:
        """Put back what a dead worker had not done; the item it died at has an attempt less."""
        self._end(worker)
        code = worker.process.exitcode
        left = list(worker.left)
        first = left[0]
        deaths[id(first)] = deaths.get(id(first), 0) + 1
        if deaths[id(first)] >= ATTEMPTS:
            fate = f"by signal {-code}" if code is not None and code < 0 else f"with status {code}"
            yield Died(first, f"its worker ended {fate}, {ATTEMPTS} times")
            left = left[1:]
        if left:
            waiting.appendleft(left)

    def _end(self, worker: _Worker) -> None:
        self._workers.remove(worker)
        worker.connection.close()  # which is what an idle worker ends by
        worker.process.join(5.0)
        if worker.process.is_alive():
            worker.process.kill()
            worker.process.join()

    def close(self) -> None:
        """End all processes, also those at work."""
        for worker in list(self._workers):
            if worker.left:
                worker.process.kill()
            self._end(worker)


def _serve(connection: Connection, work: Work, job: Any) -> None:
    """Do chunks until the other end closes."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the parent decides
    Thread(target=_follow_parent, daemon=True).start()
    while True:
        try:
            chunk = connection.recv()
            for result in work(job, chunk):
                connection.send(result)
        except (EOFError, BrokenPipeError):
            return


def _follow_parent() -> None:
    """End with the parent, also when that is killed: nobody would note what is made."""
    parent = parent_process()
    if parent is not None:
        wait([parent.sentinel])
        os._exit(1)


def share_threads(threads: int) -> None:
    """Limit the threads of processes that are started from now on."""
    for name in THREADS:
        os.environ[name] = str(threads)


class Cluster:
    """Workers of dask on this machine or on others, which see the same folder.

    Parameters
    ----------
    address
        Of a scheduler, ``tcp://host:8786``, or ``local:N`` for N processes on this machine.
    """

    def __init__(self, work: Work, job: Any, address: str) -> None:
        check_cluster(address)
        dask: Any = import_module("distributed")  # without types
        self._work, self._job, self._address = work, job, address
        self._cluster: Any = None
        try:
            if address.startswith("local:"):
                self._cluster = dask.LocalCluster(
                    n_workers=int(address.removeprefix("local:")), threads_per_worker=1,
                    dashboard_address=None,
                )  # fmt: skip
            self._client = dask.Client(self._cluster or address, timeout=20)
        except (OSError, TimeoutError) as error:
            raise EngineError(f"no scheduler of dask answers at {address}: {error}.") from error

    def run(self, chunks: Sequence[Sequence[Any]]) -> Iterator[Any]:
        """Yield results as chunks end; dask itself tries those of lost workers again.

        Raises
        ------
        EngineError
            If the scheduler is lost.
        """
        dask: Any = import_module("distributed")
        # What it says of a lost scheduler is a trace of its own; the error below tells it.
        logging.getLogger("distributed.client").setLevel(logging.CRITICAL)
        futures = {
            self._client.submit(_do, self._work, self._job, chunk, pure=False): chunk
            for chunk in chunks if len(chunk)
        }  # fmt: skip
        for future in dask.as_completed(list(futures)):
            try:
                yield from future.result()
            except dask.KilledWorker as error:
                for item in futures[future]:
                    yield Died(item, f"its worker was lost again and again ({error})")
            except dask.CancelledError as error:
                raise EngineError(
                    f"the scheduler of dask at {self._address} was lost; what is done stays done, "
                    "and the same command goes on when there is one again."
                ) from error
            future.release()

    def close(self) -> None:
        """Leave the scheduler; a cluster of this machine ends."""
        self._client.close()
        if self._cluster is not None:
            self._cluster.close()


def _do(work: Work, job: Any, chunk: Sequence[Any]) -> list[Any]:
    return list(work(job, chunk))


def check_cluster(address: str) -> None:
    """Describe what is wrong with an address, or what to install if dask is missing.

    Raises
    ------
    UsageError, MissingExtra
    """
    from importlib.util import find_spec

    if not re.fullmatch(r"local:[1-9]\d{0,3}|(\w+://)?[\w.\-\[\]:]+:\d{1,5}", address):
        raise UsageError(
            f'--cluster "{address}" is neither the address of a scheduler, tcp://host:8786, nor '
            "local:N."
        )
    if find_spec("distributed") is None:
        raise MissingExtra('--cluster needs dask: pip install "cityx[cluster]"')
