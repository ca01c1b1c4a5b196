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


def _faults(told: str) -> int:
    done = subprocess.run(
        [sys.executable, "-c", PROBE, told], capture_output=True, text=True, check=True
    )
    return int(done.stdout)


@pytest.mark.skipif(sys.platform != "linux", reason="the settings are glibc's")
def test_freed_arrays_are_reused() -> None:
    assert _faults("told") < 1000
