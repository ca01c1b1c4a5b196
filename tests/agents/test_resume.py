"""Builds that are killed anywhere and asked for again."""

import random
import shutil
import signal
import sqlite3
import subprocess
import sys
import time
from contextlib import closing, suppress

import pytest

from cityx.agents.journal import Journal
from cityx.city.content import content_hash
from cityx.city.store import read_city
from cityx.errors import UsageError

# The build of the command line, but every step is kept, so that there is always one to go on from.
SCRIPT = """
import sys
from pathlib import Path
from cityx.agents import step_runner
from cityx.projects.build import build
from cityx.options import BuildOptions
step_runner.SNAPSHOT_S, step_runner.KEEPING = 0.0, float("inf")
options = BuildOptions(formats=(), render=False, seed=4)
say = lambda text: print(text, flush=True)
print(build([Path(sys.argv[1])], Path(sys.argv[2]), options, say=say)["hash"])
"""


def start(town_map, out):
    command = [sys.executable, "-c", SCRIPT, str(town_map), str(out)]
    return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


@pytest.fixture(scope="module")
def undisturbed(town_map, tmp_path_factory):
    out = tmp_path_factory.mktemp("whole") / "town"
    begin = time.monotonic()
    said, _ = start(town_map, out).communicate()
    return said.splitlines()[-1], time.monotonic() - begin


def build_killed(town_map, out, delay):
    process = start(town_map, out)
    time.sleep(delay)
    process.send_signal(signal.SIGKILL)
    process.communicate()


def check(town_map, out, wanted):
    said, errors = start(town_map, out).communicate()
    assert said.splitlines()[-1] == wanted, errors
    assert content_hash(read_city(out / "city")).total == wanted
    with sqlite3.connect(out / "city" / "journal.sqlite") as database:
        assert database.execute("PRAGMA integrity_check").fetchone() == ("ok",)
    assert [path.name for path in out.parent.iterdir()] == [out.name]
    return said


@pytest.mark.slow
@pytest.mark.sweep(3)
@pytest.mark.parametrize("moment", range(20))
def test_a_build_killed_at_any_moment_comes_to_the_same_hash(
    undisturbed, town_map, tmp_path, moment
):
    wanted, seconds = undisturbed
    build_killed(town_map, tmp_path / "town", random.Random(moment).uniform(0.2, 1.0) * seconds)
    check(town_map, tmp_path / "town", wanted)


@pytest.fixture
def half_built(town_map, tmp_path):
    """A folder in which a build was killed in the middle of its steps."""
    process = start(town_map, tmp_path / "town")
    for line in process.stdout:
        if "building/design" in line:
            break
    process.send_signal(signal.SIGKILL)
    process.communicate()
    return tmp_path / "town"


def test_a_killed_build_goes_on_after_the_last_step_that_was_kept(
    undisturbed, town_map, half_built
):
    said = check(town_map, half_built, undisturbed[0])
    assert "going on after road/surface_material-v1" in said
    assert "road/ground-v1" not in said.partition("going on after")[2]
    with Journal(half_built / "city" / "journal.sqlite") as journal:
        steps = journal.steps()
        assert len(journal.runs()) == 1
    done = [step.action for step in steps if step.status == "done"]
    assert len(done) == len(set(done)) == 22


def test_snapshots_that_were_lost_cost_time_and_no_more(undisturbed, town_map, half_built):
    shutil.rmtree(half_built.with_name(".town.partial") / "snapshots")
    said = check(town_map, half_built, undisturbed[0])
    assert "going on" not in said


@pytest.fixture
def stopped(town_map, tmp_path):
    """A process that stands still in the middle of a build."""
    with start(town_map, tmp_path / "town") as process:
        for line in process.stdout:
            if "layout/" in line:
                break
        process.send_signal(signal.SIGSTOP)
        yield process
        process.kill()


def test_two_processes_do_not_build_in_one_folder(stopped, town_map, tmp_path):
    _, errors = start(town_map, tmp_path / "town").communicate()
    assert f"Process {stopped.pid}" in errors
    assert "wait until it ends" in errors
    stopped.send_signal(signal.SIGCONT)
    stopped.communicate()
    assert stopped.returncode == 0


def test_a_build_stopped_while_it_writes_is_not_built_over(stopped, town_map, tmp_path):
    path = tmp_path / ".town.partial" / "journal.sqlite"
    before = path.stat().st_ino
    with closing(sqlite3.connect(path, timeout=0.1, isolation_level=None)) as writer:
        with suppress(sqlite3.OperationalError):  # the stopped process holds the lock itself
            writer.execute("BEGIN IMMEDIATE")
        _, errors = start(town_map, tmp_path / "town").communicate()
    assert f"Process {stopped.pid}" in errors
    assert path.stat().st_ino == before


def test_a_journal_that_another_process_locks_is_not_called_broken(tmp_path, monkeypatch):
    monkeypatch.setattr("cityx.agents.journal.WAIT_S", 0.01)
    path = tmp_path / "journal.sqlite"
    with closing(sqlite3.connect(path, isolation_level=None)) as writer:
        writer.execute("BEGIN EXCLUSIVE")
        with pytest.raises(UsageError, match=r"Another process is writing to .*journal\.sqlite"):
            Journal(path)
