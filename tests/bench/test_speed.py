"""Speed is measured in processes of their own, beside peers that read the same map."""

import gzip
import json
import re
import sys

import pytest
from cityx_bench import speed
from cityx_bench.inputs import write_osm
from cityx_bench.peers import PEERS, Peer, peer_once, peers_named
from cityx_bench.speed import (
    BEGIN,
    END,
    content_of,
    maps_in,
    measure_speed,
    row_of,
    text_of,
    write_into,
)

from cityx.errors import EngineError, InputError, MissingExtra, UsageError

READER = """
import sys, time
begin = time.process_time()
assert open(sys.argv[1]).read().startswith("<osm")
print("read", time.process_time() - begin + 1.0)
"""


def peer(script, reason=""):
    program = (sys.executable, "-c")
    return Peer("reader", "nothing", program, script, ("layout/inputs",), lambda: reason)


def measured(maps, out, *, lods=(0,), peers=(), skipped=None):
    return measure_speed(
        maps, lods, out, command="cityx bench speed", repeat=1, workers=1, peers=peers,
        skipped=skipped or {}, say=print,
    )  # fmt: skip


@pytest.fixture
def town(tmp_path):
    write_osm(tmp_path / "town.osm")
    return tmp_path / "town.osm"


@pytest.mark.slow
def test_a_map_is_built_and_stands_beside_a_peer(town, tmp_path):
    record = measured([town], tmp_path, peers=[peer(READER)], skipped={"blosm": "it is absent"})
    assert json.loads((tmp_path / speed.RECORD).read_text()) == record
    ours, theirs, left = text_of(record).split("\n\n")
    assert left == "Not run: blosm, since it is absent."
    head, _, row = ([cell.strip() for cell in line.split("|")[1:-1]] for line in ours.splitlines())
    found = dict(zip(head, row, strict=True))
    assert (found["map"], found["LOD"], found["buildings"]) == ("town.osm", "0", "33")
    assert float(found["ms/building"]) > 0
    last = [cell.strip() for cell in theirs.splitlines()[-1].split("|")[1:-1]]
    assert last[1] == "reader"
    assert float(last[4]) == pytest.approx(1.0, abs=0.2)


def test_streets_and_nature_are_timed_apart_from_buildings(town):
    taken = {"import": 9.0, "layout/inputs": 0.5, "road/ground": 2.0, "nature/trees": 1.0,
             "background/sun": 0.25, "building/facade": 4.0, "store": 0.25}  # fmt: skip
    report = {
        "cpu_s": taken, "timings_s": {step: took / 2 for step, took in taken.items()},
        "counts": {"buildings": 10}, "area_km2": 0.5, "peak_rss_mb": 1.0, "blend_mb": 1.0,
        "triangles": {"unique": 8, "instanced": 80},
    }  # fmt: skip
    row = row_of(town, 2, [report])
    assert (row["streets, nature s/km2"], row["s/km2"]) == ("6.50", "16.00")
    assert row["on the clock s/km2"] == "3.25"


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
def test_a_peer_that_is_here_reads_the_map(name, town):
    if reason := PEERS[name].lacking():
        pytest.skip(f"{name}: {reason}")
    assert peer_once(PEERS[name], content_of(town)) > 0.0


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


def test_what_a_killed_process_measured_is_not_measured_again(town, tmp_path, monkeypatch):
    built = []

    def build(_path, lod, _workers):
        built.append(lod)
        if len(built) == 2:
            raise KeyboardInterrupt
        return {}

    monkeypatch.setattr(speed, "build_once", build)
    row = {"map": "town.osm", "ms/building": "1"}
    monkeypatch.setattr(speed, "row_of", lambda _path, lod, _reports: {**row, "LOD": lod})
    with pytest.raises(KeyboardInterrupt):
        measured([town], tmp_path, lods=(0, 2))
    assert not (tmp_path / speed.RECORD).exists()
    with (tmp_path / speed.PARTIAL).open("a") as file:
        file.write('{"lod": 2, "ma')  # half a line
    record = measured([town], tmp_path, lods=(0, 2))
    assert built == [0, 2, 2]
    assert [one["LOD"] for one in record["rows"]] == [0, 2]
    assert not (tmp_path / speed.PARTIAL).exists()


def test_the_table_goes_between_the_marks_of_a_page(tmp_path):
    page = tmp_path / "page.md"
    page.write_text(f"before\n{BEGIN}\nold\n{END}\nafter\n")
    write_into(page, "new")
    assert page.read_text() == f"before\n{BEGIN}\nnew\n{END}\nafter\n"
    page.write_text("nothing")
    with pytest.raises(InputError, match="has no place for the table"):
        write_into(page, "new")


def test_a_folder_without_known_maps_is_refused(tmp_path):
    with pytest.raises(InputError, match="holds none of"):
        maps_in(tmp_path)
