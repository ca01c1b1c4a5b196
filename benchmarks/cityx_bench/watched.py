"""Commands that are run to their end while the system is asked what they take."""

from __future__ import annotations

import os
import resource
import signal
import subprocess
import tempfile
import threading
import time
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

LOOK_S = 0.25  # seconds from look to look at the memory of processes


def run_watched(
    command: Sequence[str], environment: Mapping[str, str], longest: float
) -> dict[str, Any]:
    """Run a command to its end, and return what it and all that it starts take.

    Returns
    -------
    spent
        "cpu_s", "clock_s", "peak_mb", "exit", the last it "told", and whether it was too "late".
    """
    with tempfile.TemporaryFile() as told:
        begun = time.perf_counter()
        process = subprocess.Popen(
            command, env=dict(environment), stdout=subprocess.DEVNULL, stderr=told,
            start_new_session=True,
        )  # fmt: skip
        memory = _Memory(process.pid)
        late = threading.Event()
        timer = threading.Timer(longest, _stop, (process.pid, late))
        timer.start()
        memory.start()
        try:
            _, status, used = os.wait4(process.pid, 0)
        except BaseException:
            os.killpg(process.pid, signal.SIGKILL)  # its own session: no key stops it
            raise
        finally:
            timer.cancel()
            memory.done.set()
        process.returncode = os.waitstatus_to_exitcode(status)
        memory.join()
        told.seek(0)
        last = told.read()[-2000:].decode(errors="replace")
    return {
        "cpu_s": round(used.ru_utime + used.ru_stime, 3),
        "clock_s": round(time.perf_counter() - begun, 3),
        "peak_mb": round(max(memory.peak, used.ru_maxrss / 1024), 1),
        "exit": process.returncode,
        "told": last,
        "late": late.is_set(),
    }


def _stop(group: int, late: threading.Event) -> None:
    late.set()
    os.killpg(group, signal.SIGKILL)


class _Memory(threading.Thread):
    """Looks at what a process and its descendants hold together, shared pages once."""

    def __init__(self, process: int) -> None:
        super().__init__(daemon=True)
        self.process, self.peak, self.done = process, 0.0, threading.Event()

    def run(self) -> None:
        """Look until it is done."""
        most = 0.0
        while not self.done.wait(LOOK_S):
            family = list(_family(self.process))
            resident = sum(map(_resident_mb, family))
            if resident > most:  # to tell shared pages takes time
                most, self.peak = resident, max(self.peak, sum(map(_held_mb, family)))


def _family(process: int) -> Iterator[int]:
    """Yield a process and its descendants, as far as the system tells them."""
    yield process
    for path in Path(f"/proc/{process}/task").glob("*/children"):
        try:
            children = path.read_text().split()
        except OSError:
            continue  # it has just ended
        for child in children:
            yield from _family(int(child))


def _resident_mb(process: int) -> float:
    """Return the memory of a process, shared pages in full."""
    try:
        pages = int(Path(f"/proc/{process}/statm").read_text().split()[1])
    except OSError:
        return 0.0
    return pages * resource.getpagesize() / 2**20


def _held_mb(process: int) -> float:
    """Return the memory of a process; of pages that n share each has an n-th."""
    try:
        lines = Path(f"/proc/{process}/smaps_rollup").read_text().splitlines()
    except OSError:
        return 0.0
    return sum(int(line.split()[1]) for line in lines if line.startswith("Pss:")) / 1024
