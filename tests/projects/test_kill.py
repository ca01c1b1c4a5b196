"""A build that is killed leaves the folder absent, or the older city as it was."""

import hashlib
import json
import os
import signal
import subprocess
import sys
import time

import pytest
from copies import copy_of

from cityx.city.content import content_hash
from cityx.city.store import read_city
from cityx.options import BuildOptions
from cityx.projects import results
from cityx.projects.build import build

QUICK = BuildOptions(formats=("glb",), render=False)


def contents(folder):
    files = sorted(path for path in folder.rglob("*") if path.is_file())
    return {str(p.relative_to(folder)): hashlib.sha256(p.read_bytes()).hexdigest() for p in files}


def killed(town_map, out, words, delay):
    """Start a build, kill it so many seconds after it says the words; returns its exit code."""
    command = [sys.executable, "-m", "cityx.cli", "build", town_map, "-o", out, "--seed", "9",
               "--no-render", "--formats", "glb"]  # fmt: skip
    with subprocess.Popen(
        [*map(str, command)], stderr=subprocess.PIPE, stdout=subprocess.DEVNULL, text=True
    ) as process:
        for line in process.stderr:
            if words in line:
                break
        time.sleep(delay)
        process.send_signal(signal.SIGKILL)
        return process.wait()


@pytest.mark.parametrize(
    ("words", "delay", "older"),
    [("road/ground", 0.02, False), ("writing the store", 0.01, True), ("city.glb", 0.03, True)],
)
def test_a_killed_build_leaves_nothing_or_the_older_city(
    town_map, built_town, tmp_path, words, delay, older
):
    out = tmp_path / "out"
    if older:
        copy_of(built_town("glb"), out)
    before = contents(out)
    assert killed(town_map, out, words, delay) == -signal.SIGKILL
    assert out.exists() == older
    assert contents(out) == before
    report = build([town_map], out, QUICK)
    assert content_hash(read_city(out / "city")).total == report["hash"]
    assert [path.name for path in tmp_path.iterdir()] == ["out"]


class Killed(BaseException):
    """Stands for the kill: nothing catches it."""


@pytest.mark.parametrize("rename", [1, 2])
def test_a_kill_while_the_new_city_moves_in_loses_neither(town_map, tmp_path, monkeypatch, rename):
    out, staging = tmp_path / "out", tmp_path / ".out.partial"
    out.mkdir()
    (out / "report.json").write_text("old")
    staging.mkdir()
    (staging / "report.json").write_text("new")
    count = 0
    plain = os.rename

    def stopping(self, target):
        nonlocal count
        count += 1
        if count == rename:
            raise Killed
        plain(self, target)

    with monkeypatch.context() as patch:
        patch.setattr(results.Path, "rename", stopping)
        with pytest.raises(Killed):
            results.publish(staging, out)
    results.staging_of(out)
    assert (out / "report.json").read_text() == "old"
    build([town_map], out, QUICK)
    assert json.loads((out / "report.json").read_text())["counts"]["buildings"] == 11
    assert [path.name for path in tmp_path.iterdir()] == ["out"]


def test_what_an_export_that_was_cut_short_left_is_in_no_later_one(tmp_path):
    out, left = tmp_path / "out", tmp_path / ".out.partial"
    (left / "objects").mkdir(parents=True)
    (left / "objects" / "old.json").write_text("old")

    def export():
        with results.fresh_staging(out) as staging:
            assert staging == left
            assert not list(staging.iterdir())
            (staging / "objects").mkdir()
            raise Killed

    with pytest.raises(Killed):
        export()
    assert not list(tmp_path.iterdir())
    with results.fresh_staging(out) as staging:
        (staging / "new.json").write_text("new")
        staging.rename(out)
    assert [path.name for path in tmp_path.rglob("*")] == ["out", "new.json"]


def test_what_a_user_keeps_beside_the_city_stays(town_map, tmp_path):
    out = tmp_path / "out"
    (out / "renders").mkdir(parents=True)
    (out / "renders" / "street.png").write_text("of the older city")
    (out / "notes.txt").write_text("mine")
    build([town_map], out, QUICK)
    assert sorted(path.name for path in out.iterdir()) == [
        "city", "city.glb", "notes.txt", "report.html", "report.json", "views.json",
    ]  # fmt: skip


def test_a_folder_that_one_stands_in_stays_the_same(town_map, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    number = tmp_path.stat().st_ino
    build([town_map], tmp_path, QUICK)
    build([town_map], tmp_path, QUICK)
    assert tmp_path.stat().st_ino == number
    assert (tmp_path / "city.glb").exists()
