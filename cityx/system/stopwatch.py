"""Seconds and CPU seconds of named steps, as a build spends them and its report tells them."""

from __future__ import annotations

import os
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path

AFTER_NAME, START = ")", 19  # of /proc/self/stat: ticks from boot to start, by place after a name


@dataclass
class Stopwatch:
    """Seconds and CPU seconds per named step, in order."""

    wall: dict[str, float] = field(default_factory=dict)
    cpu: dict[str, float] = field(default_factory=dict)

    @classmethod
    def of_process(cls, name: str) -> Stopwatch:
        """Return a watch whose first step is what this process has spent so far."""
        return cls({name: _age()}, {name: _cpu_seconds()})

    @contextmanager
    def step(self, name: str) -> Iterator[None]:
        """Measure the block; children that ended within it count."""
        wall, cpu = time.perf_counter(), _cpu_seconds()
        try:
            yield
        finally:
            self.add(name, time.perf_counter() - wall, _cpu_seconds() - cpu)

    def add(self, name: str, wall: float, cpu: float) -> None:
        """Add seconds to a step."""
        self.wall[name] = self.wall.get(name, 0.0) + wall
        self.cpu[name] = self.cpu.get(name, 0.0) + cpu

    def split(self, name: str, parts: Mapping[str, Mapping[str, float]]) -> None:
        """Give parts of a step, each with its "wall_s" and "cpu_s", names of their own.

        What is left of its CPU seconds stays with the step, and all its clock: another process
        did the parts, and may have begun before it.
        """
        for part, spent in parts.items():
            self.add(part, spent["wall_s"], spent["cpu_s"])
            self.add(name, 0.0, -spent["cpu_s"])

    def take(self, name: str, other: Stopwatch) -> None:
        """Give what is within a step the names that another watch has for it."""
        parts = {
            part: {"wall_s": wall, "cpu_s": other.cpu[part]} for part, wall in other.wall.items()
        }
        self.split(name, parts)

    def told(self) -> dict[str, dict[str, float]]:
        """Return ``timings_s`` and ``cpu_s`` as a report holds them."""
        return {
            "timings_s": {name: round(value, 3) for name, value in self.wall.items()},
            "cpu_s": {name: round(value, 3) for name, value in self.cpu.items()},
        }


def _cpu_seconds() -> float:
    used = os.times()
    return used.user + used.system + used.children_user + used.children_system


def _age() -> float:
    """Return the seconds since this process was started; those of the processor where no one knows.

    References
    ----------
    proc_pid_stat(5)
    """
    told = Path("/proc/self/stat")
    if not told.exists():
        return time.process_time()
    ticks = int(told.read_text().rpartition(AFTER_NAME)[2].split()[START])
    return time.clock_gettime(time.CLOCK_BOOTTIME) - ticks / os.sysconf("SC_CLK_TCK")
