"""A benchmark that is killed goes on where it was, and comes to the results of one that is not."""

import os
import signal
import subprocess
import sys
import time

import pytest
from cityx_bench.commands import bench
from cityx_bench.runner import LOG, read_log
from typer.testing import CliRunner

pytestmark = pytest.mark.slow
LONGEST = 600.0  # seconds until the first proposal is logged
COMMANDS = {
    "agents": ["agents", "--lod", "0", "--only", "P28,P09,P11"],
    "inputs": ["inputs", "--kinds", "osm,text", "--count", "2", "--lod", "0"],
}


def lines(folder):
    path = folder / LOG
    return path.read_text().splitlines() if path.exists() else []


def killed(command, out):
    """Kill a benchmark, and all that it started, once its log holds something."""
    process = subprocess.Popen(
        [sys.executable, "-m", "cityx.cli", "bench", *command, "-o", str(out)],
        start_new_session=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
    )  # fmt: skip
    end = time.monotonic() + LONGEST
    while not lines(out) and process.poll() is None and time.monotonic() < end:
        time.sleep(0.05)
    os.killpg(process.pid, signal.SIGKILL)
    return process.wait()


def results(folder):
    """What was measured, without how long it took."""
    return {
        sample.task: {**sample.to_json(), "seconds": 0.0, "planning_s": 0.0}
        for sample in read_log(folder / LOG)
    }


@pytest.mark.sweep(1)
@pytest.mark.parametrize("name", COMMANDS)
def test_a_killed_benchmark_comes_to_the_same_results(name, tmp_path):
    command, out, whole = COMMANDS[name], tmp_path / "killed", tmp_path / "whole"
    assert killed(command, out) == -signal.SIGKILL
    kept = lines(out)
    with (out / LOG).open("a") as log:
        log.write('{"task": "P09", "dig')  # as a killed process leaves a line half written
    for folder in (out, whole):
        done = CliRunner().invoke(bench, [*command, "-o", str(folder)])
        assert done.exit_code == 0, done.output
    assert 1 <= len(kept) < len(lines(whole))
    assert lines(out)[: len(kept)] == kept
    assert results(out) == results(whole)
    assert len(lines(out)) == len(lines(whole)) + 1  # none was made twice
