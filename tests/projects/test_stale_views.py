"""A view that shows another city than the one stored is known for it, wherever a kill came."""

import json
import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path
from types import MappingProxyType

import pytest
from copies import copy_of
from typer.testing import CliRunner

import cityx
from cityx.agents.briefs import Request
from cityx.city import City, Frame, Layout
from cityx.city.content import content_hash
from cityx.city.store import read_city, read_view, write_city
from cityx.cli.main import app
from cityx.ids import id_text
from cityx.light.sun import sun
from cityx.options import BuildOptions
from cityx.outputs import earlier_glb
from cityx.outputs.format import Format
from cityx.outputs.glb import write_glb
from cityx.projects import file_formats, results
from cityx.projects.build import build, recheck
from cityx.projects.desk import Desk
from cityx.projects.edit import edit_city, renew
from cityx.projects.results import VIEWS_FILE, enter_views, stale_views, views_made
from cityx.projects.views import renew_stale
from cityx.protocol.gate import Call

SNOW = Call("background/weather-v1", {"preset": "snow"})
DUSK = Call("background/sun-v1", {"time": "dusk"})
FILE, PARTS = "city.words.txt", "city_words"


class Killed(BaseException):
    """Stands for the kill: nothing catches it."""


def total(folder):
    return content_hash(read_city(folder / "city")).total


def write_words(city, path):
    """Write the hash of a city, so that the file itself tells what it shows, and a folder."""
    parts = path.with_name(PARTS)
    parts.mkdir(exist_ok=True)
    for file in (path, parts / "part.txt"):
        file.write_text(content_hash(city).total)


@pytest.fixture
def words(monkeypatch):
    """A format of another package."""
    own = {each.name: each for each in file_formats.BUILT_IN}
    table = MappingProxyType(own | {"words": Format("words", FILE, write_words, "its hash")})
    for name in ("file_formats.formats", "views.formats"):
        monkeypatch.setattr(f"cityx.projects.{name}", lambda: table)


@pytest.fixture
def folder(built_town, tmp_path, words):  # noqa: ARG001
    folder = copy_of(built_town(lod=0), tmp_path / "town")
    (folder / FILE).touch()  # an existing file is what a change renews
    change(folder, DUSK)
    assert not stale_views(folder, total(folder))
    return folder


@pytest.fixture
def small(tmp_path, words):  # noqa: ARG001
    """A city of nothing but its ground, with two revisions."""
    folder = tmp_path / "town"
    city = City("c", Frame(52.5, 13.4), Layout((0.0, 0.0, 50.0, 50.0)),
                stages_done=frozenset({"layout"}))  # fmt: skip
    write_city(sun(city, time="2026-12-21 noon"), folder / "city")
    (folder / FILE).touch()
    for call in (Call("background/weather-v1", {"preset": "fog"}), DUSK):
        change(folder, call)
    return folder


def change(folder, call=SNOW):
    with Desk(folder) as desk:
        revision = desk.change([call])
        renew(folder, desk.city, Request(), revision)


def back(folder):
    with Desk(folder) as desk:
        revision = desk.undo()
        renew(folder, desk.city, Request(), revision)


def killed_at(patch, number, work, folder):
    """Do work and stop it for good before a rename, counted from when the store is replaced.

    Returns whether it came that far.
    """
    count, before = None, (folder / "city").stat().st_ino
    dead = False

    def guard(plain):
        def stopping(*args, **kwargs):
            nonlocal count, dead
            store = folder / "city"
            if count is None and store.exists() and store.stat().st_ino != before:
                count = 0
            if count is not None:
                count += 1
                dead = dead or count == number
            if dead:
                raise Killed
            return plain(*args, **kwargs)

        return stopping

    with patch.context() as patched:
        for name in ("rename", "replace"):
            patched.setattr(Path, name, guard(getattr(Path, name)))
        plain_rmtree = shutil.rmtree
        patched.setattr(shutil, "rmtree", lambda *a, **k: dead or plain_rmtree(*a, **k))
        try:
            work()
        except Killed:
            return True
    return False


def honest(folder):
    """Assert that a view which counts as current shows the stored city; return what is stale."""
    stale = stale_views(folder, total(folder))
    if FILE not in stale and (folder / FILE).exists():
        assert (folder / FILE).read_text() == total(folder)
    if PARTS not in stale and (folder / PARTS).exists():
        assert (folder / PARTS / "part.txt").read_text() == total(folder)
    return stale


@pytest.mark.slow
@pytest.mark.parametrize("work", [change, back])
def test_wherever_a_change_is_killed_stale_views_are_known_and_renewed(small, work, monkeypatch):
    folder = small
    kept = copy_of(folder, folder.with_name("kept"))
    found = []
    for number in range(1, 40):
        shutil.rmtree(folder)
        copy_of(kept, folder)
        if not killed_at(monkeypatch, number, lambda: work(folder), folder):
            break
        with Desk(folder) as desk:
            after = desk.revision
        found.append(FILE in honest(folder))
        once_more = shutil.copytree(folder, folder.with_name(f"killed{number}"))
        with Desk(once_more) as desk:
            desk.undo(after - 1)  # no view is renewed: as if killed again
        honest(once_more)
        notes = renew_stale(read_city(folder / "city"), folder, total(folder), say=print)
        assert honest(folder) == {}
        assert (folder / FILE).read_text() == total(folder)
        assert any(FILE in note for note in notes) == found[-1]
        with Desk(folder) as desk:
            assert desk.revision == after
    assert found[:2] == [True, True]
    assert not found[-1]
    assert len(found) >= 6  # the store, both entries of the table, file, folder, report


@pytest.mark.parametrize("number", [1, 2, 3, 5, 7, 9])
def test_a_build_killed_while_it_moves_in_beside_other_files_is_known(
    folder, town_map, number, monkeypatch
):
    (folder / "notes.txt").write_text("mine")
    other = BuildOptions(formats=("glb",), render=False, lod=0, seed=5)
    if killed_at(monkeypatch, number, lambda: build([town_map], folder, other), folder):
        honest(folder)
        assert "city.glb" not in stale_views(folder, total(folder)) or recheck(folder)
    assert "city.glb" not in stale_views(folder, total(folder))
    assert (folder / "notes.txt").exists()
    build([town_map], folder, other)
    assert views_made(folder) == {"city.glb": total(folder)}
    assert not (folder / FILE).exists()  # what the older city had is not left beside this one


def test_a_build_enters_every_view(built_town):
    folder = built_town("glb", "bodies", lod=0)
    made = json.loads((folder / VIEWS_FILE).read_text())
    assert {*made} == {"city.glb", "city_bodies.npz", "city_bodies.json"}
    assert {*made.values()} == {total(folder)}


def test_what_cannot_be_renewed_fails_the_check_and_pictures_are_named(folder):
    (folder / "renders").mkdir()
    for name in ("city.blend", "renders/street.png", "renders/top.png"):
        (folder / name).write_text("drawn")
    results.enter_views(folder, ["city.blend", "renders/street.png"], total(folder))
    assert recheck(folder)["stale_views"] == {"renders/top.png": None}
    first = total(folder)
    with Desk(folder) as desk:
        desk.change([SNOW])
    report = recheck(folder)
    assert report["stale_views"] == {
        "city.blend": first, "renders/street.png": first, "renders/top.png": None,
    }  # fmt: skip
    assert (folder / "city.blend").read_text() == "drawn"
    assert "of the city as it was before" in (folder / "report.html").read_text()
    done = CliRunner().invoke(app, ["check", str(folder)])
    assert done.exit_code == 1
    assert "city.blend, renders/street.png" in done.output
    held = cityx.open(folder)
    assert "city.blend" in repr(held)
    assert held.stale_views == report["stale_views"]
    with Desk(folder) as desk:
        desk.undo()
    assert recheck(folder)["stale_views"] == {"renders/top.png": None}


@pytest.mark.parametrize("text", ["", "[]", "{", '{"city.glb": 3}', '{"../town": "x"}'])
def test_a_damaged_table_says_nothing(built_town, tmp_path, text):
    folder = copy_of(built_town("glb", lod=0), tmp_path / "town")
    (folder / VIEWS_FILE).write_text(text)
    assert stale_views(folder, total(folder))["city.glb"] is None
    assert "city.glb" not in recheck(folder)["stale_views"]


def test_an_export_into_the_folder_is_entered(folder):
    held = cityx.open(folder)
    held.export("glb")
    assert views_made(folder)["city.glb"] == held.hash == total(folder)
    held.do("background/weather-v1", preset="snow")
    assert held.stale_views == {}


@pytest.mark.parametrize("delay", [0.05])
def test_a_killed_edit_leaves_no_glb_that_counts_as_current(built_town, tmp_path, delay):
    folder = copy_of(built_town("glb", lod=0), tmp_path / "town")
    first = (folder / "city.glb").read_bytes()
    command = [sys.executable, "-m", "cityx.cli", "edit", folder, "make all buildings red"]
    with subprocess.Popen(
        [*map(str, command)], stderr=subprocess.PIPE, stdout=subprocess.DEVNULL, text=True
    ) as process:
        for line in process.stderr:
            if "city.glb" in line:
                break
        time.sleep(delay)
        os.kill(process.pid, signal.SIGKILL)
        process.wait()
    if (folder / "city.glb").read_bytes() == first:
        assert "city.glb" in stale_views(folder, total(folder))
    assert recheck(folder)["stale_views"] == {}
    assert (folder / "city.glb").read_bytes() != first


@pytest.mark.parametrize("stale", [False, True])
def test_a_glb_is_renewed_from_the_one_that_shows_the_city_before(
    built_town, tmp_path, monkeypatch, stale
):
    folder = copy_of(built_town("glb", lod=0), tmp_path / "town")
    if stale:  # of another state: nothing of it may be used
        enter_views(folder, ["city.glb"], "0" * 64)
    seen = []
    read = earlier_glb.read_earlier
    monkeypatch.setattr(
        "cityx.outputs.glb.read_earlier", lambda *a: seen.append(read(*a)) or seen[-1]
    )
    before = read_city(folder / "city")
    own = id_text(int(before.layout.buildings["id"].iloc[0]))
    report = edit_city(folder, f"Make {own} 14 m tall")
    assert [set(layers) for layers in seen] == ([] if stale else [set(before.scene.meshes)])
    write_glb(read_view(folder / "city"), tmp_path / "anew.glb")
    assert (folder / "city.glb").read_bytes() == (tmp_path / "anew.glb").read_bytes()
    assert views_made(folder)["city.glb"] == report["hash"] != content_hash(before).total
