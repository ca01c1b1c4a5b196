"""Speed is measured of whole builds in processes of their own, beside peers that read the same."""

import gzip
import json
import re
import sys
from dataclasses import replace

import pytest
from cityx_bench import speed
from cityx_bench.inputs import write_osm
from cityx_bench.peers import PEERS, Peer, peer_once, peers_named
from cityx_bench.speed import (
    COLD,
    LOG,
    MAPS,
    WARM,
    Wanted,
    build_once,
    content_of,
    made_maps,
    maps_in,
    measure_speed,
    read_log,
)
from cityx_bench.speed_tables import BEGIN, FINISH, REST, phases_of, text_of, write_into
from cityx_bench.watched import run_watched

from cityx.errors import EngineError, InputError, MissingExtra, UsageError
from cityx.projects.views import AWAITED

READER = """
import sys, time
begin = time.process_time()
assert open(sys.argv[1]).read().startswith("<osm")
print("read", time.process_time() - begin + 1.0)
"""
RUN = {
    "cpu_s": 10.0, "clock_s": 12.0, "peak_mb": 100.0, "exit": 0, "buildings": 20, "trees": 0,
    "km2": 1.0, "built_km2": 0.5, "seen": 9e6, "written": 2e6, "glb_mb": 1.0, "blend_mb": 1.0,
    "pictures": ["street"], "failed": [], "hash": "h", "code": "c",
    "phases": {"start": 1.0, "import": 0.5, "layout/inputs": 0.5, "road/ground": 1.0, "glb": 3.0,
               "blender setup": 1.0, "blender save": 0.25, "blender render street": 2.0},
    "clock": {"blender light street": 0.5, "blender render street": 4.0},
}  # fmt: skip


def peer(script, reason=""):
    program = (sys.executable, "-c")
    return Peer("reader", "nothing", program, script, ("layout/inputs",), lambda: reason)


def rows_of(text, first):
    """The rows of the table whose head begins with some columns, each by its columns."""
    (table,) = (part for part in text.split("\n\n") if part.startswith(first))
    head, _, *rows = ([c.strip() for c in line.split("|")[1:-1]] for line in table.splitlines())
    return [dict(zip(head, row, strict=True)) for row in rows]


@pytest.fixture
def town(tmp_path):
    write_osm(tmp_path / "town.osm")
    return tmp_path / "town.osm"


@pytest.fixture
def quick(monkeypatch):
    """Let builds take nothing; returns what was asked of them."""
    asked = []

    def build(path, lod, out, cache, *, pictures=False, **_):
        out.mkdir()
        cache.mkdir(exist_ok=True)
        asked.append((path.name, lod, pictures))
        return dict(RUN)

    monkeypatch.setattr(speed, "build_once", build)
    return asked


@pytest.mark.slow
@pytest.mark.blender
def test_a_build_is_the_one_of_a_user_and_its_phases_add_up(town, tmp_path):
    run = build_once(town, 0, tmp_path / "out", tmp_path / "cache")
    assert (tmp_path / "out" / "city.blend").exists()
    assert run["buildings"] == 33
    assert 0.03 <= run["built_km2"] <= 0.16  # the town is 320 m by 300 m
    assert run["written"] > 33 * 10
    spent = phases_of(run)
    assert sum(spent.values()) == pytest.approx(run["cpu_s"])
    assert min(spent.values()) > -0.1  # clocks tick a hundred times a second
    assert spent["start"] > 0.5
    assert spent[REST] < 0.3 * run["cpu_s"]
    # Blender and copies of the process work beside it.
    copies = ("blender ", "building/", "checks", "goals", "fidelity", "counts", "store hash")
    beside = {name for name in run["clock"] if name.startswith(copies)} - {AWAITED}
    assert run["clock_s"] >= sum(run["clock"][name] for name in run["clock"].keys() - beside)


def test_all_that_a_command_starts_counts(tmp_path):
    inner = "x = bytearray(100_000_000)\nimport time\nwhile time.process_time() < 0.5: pass"
    outer = (
        "import subprocess, sys\ny = bytearray(100_000_000)\n"
        f"subprocess.run([sys.executable, '-c', {inner!r}], check=True)\nsys.exit(1)"
    )
    spent = run_watched([sys.executable, "-c", outer], {}, 60.0)
    assert (spent["exit"], spent["late"]) == (1, False)
    assert 0.5 <= spent["cpu_s"] < 5.0
    if (tmp_path.anchor == "/") and sys.platform == "linux":
        assert spent["peak_mb"] > 190.0


def test_a_build_that_takes_too_long_is_told_and_its_map_left():
    spent = run_watched([sys.executable, "-c", "import time\ntime.sleep(60)"], {}, 0.2)
    assert spent["late"]
    assert spent["clock_s"] < 30.0


def test_a_build_that_fails_is_told_with_its_last_words(tmp_path):
    (tmp_path / "bad.osm").write_text("<osm")
    with pytest.raises(EngineError, match=r"bad\.osm: exit \d"):
        build_once(tmp_path / "bad.osm", 0, tmp_path / "out", tmp_path / "cache")


def test_every_phase_has_its_place_and_the_rest_its_name():
    spent = phases_of(RUN)
    assert spent["start"] == 1.5
    assert (spent["scene"], spent["blend"], spent["pictures"]) == (1.0, 0.25, 2.0)
    assert spent[REST] == pytest.approx(0.75)
    assert sum(spent.values()) == RUN["cpu_s"]


def test_the_tables_hold_what_was_measured():
    warm = {"map": "a.osm", "lod": 2, "build": WARM, "turn": 0, **RUN}
    runs = [
        {**warm, "build": COLD, "cpu_s": 30.0}, warm, {**warm, "turn": 1, "cpu_s": 12.0},
        {**warm, "build": "pictures"},
        {"map": "a.osm", "lod": 2, "peer": "osmium", "turn": 0, "cpu_s": 0.25, "code": "d"},
        {"map": "b.osm", "lod": 2, "build": WARM, "error": "not finished in 9 s", "code": "d"},
        {**warm, "map": speed.MADE[0]}, {**warm, "map": speed.MADE[1], "km2": 51.0, "cpu_s": 20.0},
    ]  # fmt: skip
    text = text_of({"runs": runs, "skipped": {"blosm": "it is absent"}})
    row = rows_of(text, "| map | kind |")[0]
    assert (row["CPU s"], row["cold"], row["ms/building"]) == ("11.0", "30.0", "550")
    assert (row["s/km2 built"], row["M triangles"], row["s/M"]) == ("22", "2.00", "5.5")
    assert rows_of(text, "| map | LOD | start")[0]["glb"] == "3.00"
    assert rows_of(text, "| step |")[0]["step"] == "glb"
    (picture,) = rows_of(text, "| map | LOD | picture")
    assert (picture["picture"], picture["clock s"], picture["CPU s"]) == ("street", "4.5", "2.0")
    assert rows_of(text, "| map | peer |")[0]["ours / peer"] == "2"
    assert "100 km2 of empty ground (fields, woods, tracks): 20.0 CPU s at level 2." in text
    assert "b.osm at level 2, warm: not finished in 9 s." in text
    assert "Not run: blosm, since it is absent." in text
    assert "Measured of the state c, d of CityX." in text


def test_what_the_log_holds_is_not_measured_again(town, tmp_path, quick):
    wanted = Wanted([town], peers=[peer(READER)])
    record = measure_speed(wanted, tmp_path, print)
    assert [one.get("build") for one in record["runs"]] == [COLD, WARM, None]
    assert record["runs"][2]["cpu_s"] == pytest.approx(1.0, abs=0.2)
    assert json.loads((tmp_path / speed.RECORD).read_text()) == record
    with (tmp_path / LOG).open("a") as file:
        file.write('{"lod": 2, "ma')  # half a line
    del quick[:]
    again = measure_speed(replace(wanted, lods=(2, 0), builds=(WARM,), repeat=2), tmp_path, print)
    # Of each level a build fills the cache, unless one with an empty one was asked for.
    assert [lod for _, lod, _ in quick] == [2, 2, 0, 0, 0]
    assert again["runs"][:3] == record["runs"]
    assert len(read_log(tmp_path)) == len(again["runs"]) == 6


def test_a_peer_that_fails_costs_no_other_measurement(town, tmp_path, quick):
    record = measure_speed(Wanted([town], peers=[peer("raise ValueError")]), tmp_path, print)
    assert "reader ended with 1" in record["runs"][2]["error"]
    assert len(quick) == 2


def test_empty_ground_is_a_village_within_a_hundred_square_kilometres(tmp_path):
    alone, spread = made_maps(tmp_path)
    counts = [path.read_text().count('k="building"') for path in (alone, spread)]
    assert counts[0] == counts[1] > 400
    assert spread.read_text().count("landuse") > 80


def test_triangles_that_meshes_share_are_written_once(tmp_path):
    held = {
        "accessors": [{"count": 9}, {"count": 6}, {"count": 30}],
        "meshes": [{"primitives": [{"indices": 0, "attributes": {"POSITION": 2}}]},
                   {"primitives": [{"indices": 0}, {"indices": 1}]}],
    }  # fmt: skip
    text = json.dumps(held).encode()
    path = tmp_path / "city.glb"
    path.write_bytes(b"glTF" + bytes(8) + len(text).to_bytes(4, "little") + b"JSON" + text)
    assert speed.triangles_written(path) == 5


def test_a_peer_reads_the_map_unpacked(town, tmp_path):
    packed = tmp_path / "town.osm.gz"
    packed.write_bytes(gzip.compress(town.read_bytes()))
    assert content_of(packed) == content_of(town)
    assert peer_once(peer(READER), content_of(packed)) >= 1.0


def test_a_peer_that_fails_is_named_with_its_last_words(town):
    with pytest.raises(EngineError, match="reader ended with 1: ValueError: broken"):
        peer_once(peer('raise ValueError("broken")'), content_of(town))


def test_peers_are_taken_by_name_where_they_are_installed():
    with pytest.raises(UsageError, match=r'"osmny".*Did you mean "osmnx"'):
        peers_named(["osmny"])
    found, skipped = peers_named(["installed"])
    assert {one.name for one in found} | skipped.keys() == PEERS.keys()
    assert not {one.name for one in found} & skipped.keys()
    assert all(skipped.values())
    for name, reason in skipped.items():
        with pytest.raises(MissingExtra, match=f"{name} cannot be run: {re.escape(reason)}"):
            peers_named([name])


@pytest.mark.slow
@pytest.mark.parametrize("name", PEERS)
def test_a_peer_that_is_here_reads_what_it_is_given(name, town, built_town):
    if reason := PEERS[name].lacking():
        pytest.skip(f"{name}: {reason}")
    reads = PEERS[name].reads
    content = (built_town("glb") / reads).read_bytes() if reads else content_of(town)
    assert peer_once(PEERS[name], content) > 0.0


def test_a_peer_that_is_absent_says_how_to_have_it(monkeypatch, tmp_path):
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.setenv("BLENDER_USER_SCRIPTS", str(tmp_path / "scripts"))
    monkeypatch.setattr("importlib.util.find_spec", lambda _: None)
    found, skipped = peers_named(["installed"])
    assert found == ()
    assert skipped["osmnx"] == "it is not installed: pip install osmnx"
    assert skipped["osm2streets"] == "node is not installed"
    assert skipped["blosm"].startswith("Blender has no add-on blosm: ")
    (tmp_path / "scripts" / "addons" / "blosm").mkdir(parents=True)
    (tmp_path / "scripts" / "addons" / "blosm" / "__init__.py").touch()
    assert [one.name for one in peers_named(["installed"])[0]] == ["blosm"]


def test_the_table_goes_between_the_marks_of_a_page(tmp_path):
    page = tmp_path / "page.md"
    page.write_text(f"before\n{BEGIN}\nold\n{FINISH}\nafter\n")
    write_into(page, "new")
    assert page.read_text() == f"before\n{BEGIN}\nnew\n{FINISH}\nafter\n"
    page.write_text("nothing")
    with pytest.raises(InputError, match="has no place for the table"):
        write_into(page, "new")


def test_maps_of_folders_are_taken_and_those_they_lack_named(town, tmp_path):
    with pytest.raises(InputError, match="holds none of"):
        maps_in([tmp_path])
    with pytest.raises(InputError, match=r"no such map: .*none\.osm"):
        maps_in([tmp_path / "none.osm"])
    assert maps_in([town]) == ([town], {})
    first, second = list(MAPS)[:2]
    (tmp_path / "more").mkdir()
    held = [tmp_path / "more" / first, tmp_path / second]
    for path in held:
        path.touch()
    found, skipped = maps_in([tmp_path, town, tmp_path / "more"])
    assert found == [town, *held]
    assert list(skipped) == list(MAPS)[2:]
    assert "it is not in" in skipped[list(MAPS)[2]]
