"""Locks: one process at a time changes a city."""

from __future__ import annotations

import os
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from cityx.errors import InputError, UsageError

WAIT_S = 20.0  # for another process to end what it does
STEP_S = 0.05


@contextmanager
def locked(folder: Path, wait: float = WAIT_S) -> Iterator[None]:
    """Hold a folder for the block; the system lets go of it when the process ends, however it ends.

    Where the system knows no locks of folders, the block runs without one.

    Raises
    ------
    InputError
        If there is no such folder.
    UsageError
        If another process holds it for longer than the wait.
    """
    if not folder.is_dir():
        raise InputError(f"{folder} holds no city: it is no folder.")
    try:
        import fcntl
    except ImportError:  # Windows
        yield
        return
    handle = os.open(folder, os.O_RDONLY)
    try:
        end = time.monotonic() + wait
        while True:
            try:
                fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
                break
            except BlockingIOError:
                if time.monotonic() > end:
                    raise UsageError(
                        f"Another process is changing {folder}; try again when it has ended."
                    ) from None
                time.sleep(STEP_S)
        yield
    finally:
        os.close(handle)
