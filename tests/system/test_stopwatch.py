"""Seconds of steps add up, and parts of a step are told apart from what is left of it."""

import subprocess
import sys

import pytest

from cityx.system.stopwatch import Stopwatch


def busy(seconds):
    code = f"import time\nwhile time.process_time() < {seconds}: pass"
    subprocess.run([sys.executable, "-c", code], check=True)


def test_processes_that_ended_within_a_step_count():
    watch = Stopwatch()
    for _ in range(2):
        with watch.step("work"):
            busy(0.2)
    assert watch.cpu["work"] >= 0.4 - 0.02  # clocks of processes tick 100 times a second


def test_parts_of_a_step_leave_the_cpu_seconds_as_they_were():
    watch = Stopwatch({"all": 5.0}, {"all": 4.0})
    watch.split("all", {"a": {"wall_s": 1.0, "cpu_s": 1.5}, "b": {"wall_s": 2.0, "cpu_s": 0.5}})
    assert watch.told() == {
        "timings_s": {"all": 5.0, "a": 1.0, "b": 2.0}, "cpu_s": {"all": 2.0, "a": 1.5, "b": 0.5},
    }  # fmt: skip


def test_a_step_that_fails_is_measured():
    watch = Stopwatch()
    with pytest.raises(ValueError, match="broken"), watch.step("work"):
        raise ValueError("broken")
    assert watch.wall.keys() == watch.cpu.keys() == {"work"}


def test_what_a_process_spent_before_its_first_step_is_told():
    code = (
        "import time\nfrom cityx.system.stopwatch import Stopwatch\ntime.sleep(0.3)\n"
        "told = Stopwatch.of_process('start')\nprint(told.wall['start'], told.cpu['start'])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    wall, cpu = map(float, done.stdout.split())
    assert 0.3 <= wall + 0.02 < 60.0
    assert 0.0 < cpu < wall
