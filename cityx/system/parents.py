"""Processes that work for another one end with it, even if that is killed."""

from __future__ import annotations

import os
import signal
import sys

PR_SET_PDEATHSIG = 1  # of Linux's prctl


def end_with_parent(parent: int) -> None:
    """End this process when the caller ends, even if killed, so that no work continues unused."""
    if sys.platform == "linux":
        import ctypes

        ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGKILL)
    if os.getppid() != parent:  # it ended while this one started
        os._exit(3)
