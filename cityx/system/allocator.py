"""Memory of CityX's own processes: reuse or return freed memory, collect garbage rarely."""

from __future__ import annotations

import ctypes
import gc
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

# Names of malloc.h; its `mallopt` is told these in bytes.
TRIM_THRESHOLD, TOP_PAD, MMAP_THRESHOLD = -1, -2, -3
KEPT = 256 << 20  # free memory above this goes back to the system
STEP = 64 << 20  # how much is asked for at once
LARGEST = 32 << 20  # arrays above this come from the system and return to it at once


def keep_freed_memory() -> bool:
    """Let the C library reuse freed memory instead of returning every array to the system.

    A build makes and drops thousands of arrays of a megabyte; fetching each anew from the system
    costs a tenth of its time. Only glibc can be told so; elsewhere nothing changes.

    Returns
    -------
    told
        Whether the library took the settings.
    """
    if sys.platform != "linux":
        return False
    tell = getattr(ctypes.CDLL(None), "mallopt", None)
    if tell is None:
        return False
    wanted = ((MMAP_THRESHOLD, LARGEST), (TRIM_THRESHOLD, KEPT), (TOP_PAD, STEP))
    return all(tell(name, value) == 1 for name, value in wanted)


def return_freed_memory() -> bool:
    """Give the system back what was freed, after work that needed much more than is left of it.

    Processes that are begun later share and double the less. Only glibc can be told so.

    Returns
    -------
    returned
        Whether anything was.
    """
    if sys.platform != "linux":
        return False
    trim = getattr(ctypes.CDLL(None), "malloc_trim", None)
    return trim is not None and trim(0) == 1


def forget_peak() -> None:
    """Count the peak of this process from now on; only Linux can be told so."""
    with suppress(OSError):
        Path("/proc/self/clear_refs").write_text("5")


def peak_and_held() -> tuple[float, float]:
    """Return the MB that this process held at most, since `forget_peak`, and holds now.

    Where nobody tells, both are the most that it ever held.
    """
    try:
        lines = Path("/proc/self/status").read_text().splitlines()
        told = dict(line.split(":", 1) for line in lines)
        peak, held = (int(told[name].split()[0]) / 1024 for name in ("VmHWM", "VmRSS"))
    except (OSError, KeyError):
        import resource

        peak = held = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    return peak, held


@contextmanager
def rare_collection() -> Iterator[None]:
    """Look for reference cycles seldom: a city has millions of objects, but hardly a cycle."""
    before = gc.get_threshold()
    gc.freeze()  # what is held now, libraries above all, is no garbage
    gc.set_threshold(200_000, 20, 50)
    try:
        yield
    finally:
        gc.set_threshold(*before)
        gc.unfreeze()
