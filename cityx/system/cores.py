"""Cores: how many of them this process may use, and work that several share."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor
from typing import TypeVar

T = TypeVar("T")
R = TypeVar("R")


def core_count() -> int:
    """Cores this process may use."""
    try:
        return len(os.sched_getaffinity(0))
    except AttributeError:  # macOS and Windows
        return os.cpu_count() or 1


def in_threads(
    function: Callable[[T], R], items: Iterable[T], threads: int | None = None
) -> list[R]:
    """Return what a function makes of items, in their order, several at once.

    Parameters
    ----------
    function
        Spends its time in libraries that let other threads run: numpy, shapely, numba.
    items
        Large pieces of work.
    threads
        How many at once, by default as many as there are cores.
    """
    work = list(items)
    workers = min(threads or core_count(), len(work))
    if workers < 2:
        return [function(item) for item in work]
    with ThreadPoolExecutor(workers) as pool:
        return list(pool.map(function, work))
