"""Speed is measured in processes of their own, beside peers that read the same map."""

import gzip

import pytest

from cityx.bench.inputs import write_osm
from cityx.bench.speed import (
    BEGIN,
    END,
    PEERS,
    Peer,
    content_of,
    maps_in,
    measure_speed,
    peer_once,
    peers_named,
    write_into,
)
from cityx.errors import EngineError, InputError, MissingExtra, UsageError

READER = """
import sys, time
begin = time.process_time()
assert open(sys.argv[1]).read().startswith("<osm")
print("read", time.process_time() - begin + 1.0)
"""


def peer(script, module="json"):
    return Peer("reader", module, "nothing", script, ("layout/inputs",))


@pytest.fixture
def town(tmp_path):
    write_osm(tmp_path / "town.osm")
    return tmp_path / "town.osm"


@pytest.mark.slow
def test_a_map_is_built_and_stands_beside_a_peer(town):
    text = measure_speed([town], [0], repeat=1, workers=1, peers=[peer(READER)], say=print)
    ours, theirs = text.split("\n\n")
    head, _, row = ([cell.strip() for cell in line.split("|")[1:-1]] for line in ours.splitlines())
    found = dict(zip(head, row, strict=True))
    assert (found["map"], found["LOD"], found["buildings"]) == ("town.osm", "0", "33")
    assert float(found["ms/building"]) > 0
    last = [cell.strip() for cell in theirs.splitlines()[-1].split("|")[1:-1]]
    assert last[1] == "reader"
    assert float(last[4]) == pytest.approx(1.0, abs=0.2)


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
    assert all(one.installed for one in peers_named(["installed"]))
    for one in PEERS.values():
        if not one.installed:
            with pytest.raises(MissingExtra, match=f"pip install {one.module}"):
                peers_named([one.name])


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
