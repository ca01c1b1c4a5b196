"""How processes end: with the one they work for, even if that is killed, and without delay."""

from __future__ import annotations

import os
import signal
import sys
from contextlib import suppress
from typing import NoReturn

PR_SET_PDEATHSIG = 1  # of Linux's prctl


def end_with_parent(parent: int) -> None:
    """End this process when the caller ends, even if killed, so that no work continues unused."""
    if sys.platform == "linux":
        import ctypes

        ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGKILL)
    if os.getppid() != parent:  # it ended while this one started
        os._exit(3)


def end_at_once(status: int) -> NoReturn:
    """End this process without giving back what it holds piece by piece, which takes long.

    What waits for the end of the interpreter (`atexit`) is not done; the caller has done it.
    """
    for stream in (sys.stdout, sys.stderr):
        with suppress(OSError, ValueError):  # nobody reads it any more
            stream.flush()
    os._exit(status)
