"""Kernels: functions that numba compiles. Import it lazily: numba alone takes half a second."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

from numba import njit

F = TypeVar("F", bound=Callable[..., Any])


def compiled(function: F) -> F:
    """Compile a kernel when it is first called, or take it from the cache.

    The cache lies beside the file of the kernel, else in the user's cache folder; where neither can
    be written every process compiles anew. Kernels release Python's lock, and nothing is reordered
    nor fused, so that the same numbers come out each time.
    """
    return _compiled(function)


def borrowing(function: F) -> F:
    """Compile a part of a kernel that only borrows its arrays: it makes none and returns none.

    Nobody counts who holds an array then, and it becomes part of the kernel that calls it: a call
    hands over each array of a tuple by its pointers, shape and strides, some 200 numbers for a
    `Map`, which takes longer than a small function does.
    """
    return _compiled(function, _nrt=False, forceinline=True)


def _compiled(function: F, **options: Any) -> F:
    made: F
    try:
        made = njit(function, nogil=True, cache=True, error_model="numpy", **options)
    except RuntimeError:  # numba found no folder to write to
        made = njit(function, nogil=True, error_model="numpy", **options)
    return made
