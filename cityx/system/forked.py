"""Work that a copy of this process does beside it, on a core of its own."""

from __future__ import annotations

import gc
import multiprocessing
import os
import sys
import time
from collections.abc import Callable
from multiprocessing.connection import Connection
from typing import Generic, TypeVar

from cityx.system.extensions import refusals, refuse
from cityx.system.parents import end_with_parent

T = TypeVar("T")

CAN_FORK = sys.platform == "linux"  # on macOS a copy must not call the system's own libraries


class Forked(Generic[T]):
    """A function that a copy of this process has begun; it sees everything as it was then.

    The copy costs a few milliseconds: memory is shared until one of both writes to it. What the
    function changes stays with the copy; its value comes back pickled.

    Parameters
    ----------
    work
        The function. It must not use threads, databases or sockets that were open before.
    apart
        Whether a copy is wanted; where not, or where there are none, `result` does the work.

    Attributes
    ----------
    spent
        "wall_s" and "cpu_s" of the work of a copy, after `result`; None when it was done here.
    """

    def __init__(self, work: Callable[[], T], *, apart: bool = True) -> None:
        self._work = work
        self._process: multiprocessing.context.ForkProcess | None = None
        self.spent: dict[str, float] | None = None
        if apart and CAN_FORK:
            fork = multiprocessing.get_context("fork")
            self._answer, answer = fork.Pipe(duplex=False)
            self._process = fork.Process(target=_do, args=(work, answer, os.getpid()), daemon=True)
            self._process.start()
            answer.close()

    def result(self) -> T:
        """Wait for the value.

        A copy that failed, or was killed, costs nothing but time: the work is done here, and what
        it raises is raised.
        """
        if self._process is None:
            return self._work()
        try:
            value, self.spent, told = self._answer.recv()
        except EOFError:
            return self._work()
        finally:
            self.close()
        for sentence in told:
            refuse(sentence)
        return value  # type: ignore[no-any-return]

    def close(self) -> None:
        """End a copy whose value nobody wants any more."""
        if self._process is None:
            return
        self._answer.close()
        self._process.terminate()
        self._process.join()
        self._process = None


def _do(work: Callable[[], object], answer: Connection, parent: int) -> None:
    """Do the work in the copy and say the value; say nothing where it fails."""
    end_with_parent(parent)
    gc.freeze()  # a collection would write to every object, and so copy all memory
    begin = time.perf_counter()
    already = sum(os.times()[:2])
    try:
        value = work()
        spent = {
            "wall_s": time.perf_counter() - begin,
            "cpu_s": sum(os.times()[:2]) - already,
        }
        answer.send((value, spent, refusals()))
    except BaseException:  # noqa: BLE001  the process that waits does the work and raises it
        os._exit(1)
    os._exit(0)  # not through what was to be done at the end of the process it is a copy of
