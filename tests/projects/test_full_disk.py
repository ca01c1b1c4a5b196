"""A disk that is full: it is said with the path, the older city stays, and nothing is left."""

import errno
import resource
import subprocess
import sys

import pytest
from copies import copy_of

from cityx.system.atomic import disk_fault


def contents(folder):
    """Return every file but the journal of a city, which tells what was tried."""
    files = [path for path in folder.rglob("*") if path.is_file()]
    return {str(p): p.read_bytes() for p in files if not p.name.startswith("journal.sqlite")}


def limited(most, *words):
    """Run a command that may write no file larger than so many bytes."""
    return subprocess.run(
        [sys.executable, "-m", "cityx.cli", *map(str, words)], capture_output=True, text=True,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (most, most)), check=False,
    )  # fmt: skip


@pytest.mark.parametrize(("most", "older"), [(20_000, False), (20_000, True), (250_000, True)])
def test_a_build_on_a_full_disk_leaves_all_as_it_was(town_map, built_town, tmp_path, most, older):
    out = tmp_path / "out"
    if older:
        copy_of(built_town("glb"), out)
    before = contents(tmp_path)
    done = limited(most, "build", town_map, "-o", out, "--no-render", "--formats", "glb")
    assert done.returncode == 4, done.stderr
    assert str(out) in done.stderr
    assert "please report" not in done.stderr
    assert contents(tmp_path) == before
    assert [path.name for path in tmp_path.iterdir()] == (["out"] if older else [])


def test_an_edit_on_a_full_disk_leaves_the_city_as_it_was(built_town, tmp_path):
    folder = copy_of(built_town("glb"), tmp_path / "town")
    before = contents(folder)
    done = limited(130_000, "edit", folder, "make the tallest building 40 m tall")
    assert done.returncode == 4, done.stderr
    assert str(folder) in done.stderr
    assert contents(folder) == before


@pytest.mark.parametrize(
    ("number", "said"),
    [(errno.ENOSPC, "The disk is full: x"), (errno.EDQUOT, "The quota of the disk is used up: x"),
     (errno.EROFS, "The disk can only be read: x"), (errno.ENOENT, None)],
)  # fmt: skip
def test_what_a_disk_refuses_is_told_whatever_it_led_to(number, said):
    error = ValueError("nothing could be done")
    error.__cause__ = OSError(number, "some words", "x")
    assert disk_fault(error) == said


def test_a_chain_of_errors_that_closes_is_followed_once():
    first, then = ValueError("one"), ValueError("two")
    first.__cause__, then.__cause__ = then, first
    assert disk_fault(first) is None
