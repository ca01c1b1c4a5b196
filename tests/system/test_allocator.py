"""The memory settings of a build process: taken by glibc, harmless elsewhere."""

from __future__ import annotations

import subprocess
import sys

import pytest

# A second large array must not fetch its pages from the system again.
PROBE = """
import resource, sys
import numpy as np
from cityx.system.allocator import keep_freed_memory
if sys.argv[1] == "told":
    assert keep_freed_memory()
def faults():
    return resource.getrusage(resource.RUSAGE_SELF).ru_minflt
for _ in range(3):
    np.ones(1 << 20)
before = faults()
for _ in range(50):
    np.ones(1 << 20)  # 8 MB
print(faults() - before)
"""

# Every second of many arrays is freed: what is left keeps the others from the top of the heap.
RETURN = """
import os
import numpy as np
from cityx.system.allocator import keep_freed_memory, return_freed_memory
keep_freed_memory()
def held():
    return int(open("/proc/self/statm").read().split()[1]) * os.sysconf("SC_PAGESIZE")
arrays = [np.ones(1 << 18) for _ in range(100)]  # 2 MB each
kept = [np.ones(1 << 10) for _ in range(2)] + arrays[::2]
full = held()
del arrays
assert held() > full - (50 << 20)
assert return_freed_memory()
print(full - held())
"""


def _faults(told: str) -> int:
    done = subprocess.run(
        [sys.executable, "-c", PROBE, told], capture_output=True, text=True, check=True
    )
    return int(done.stdout)


@pytest.mark.skipif(sys.platform != "linux", reason="the settings are glibc's")
def test_freed_arrays_are_reused() -> None:
    assert _faults("told") < 1000


@pytest.mark.skipif(sys.platform != "linux", reason="glibc alone returns it when told")
def test_freed_memory_goes_back_to_the_system_when_told() -> None:
    done = subprocess.run([sys.executable, "-c", RETURN], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert int(done.stdout) > 80 << 20  # of 100 MB
