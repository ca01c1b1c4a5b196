"""Edits of tiles: a sentence builds anew what it touches, and is there again when that is lost."""

import json
import shutil

import numpy as np
import pytest
from copies import copy_of
from typer.testing import CliRunner

from cityx.city.content import content_hash
from cityx.city.store import read_city
from cityx.cli.tiles import tiles as commands
from cityx.errors import InputError, UsageError
from cityx.projects.edit import edit_city
from cityx.protocol.gate import Call
from cityx.tiles.check import checked
from cityx.tiles.editing import TRIED, edit_tiles
from cityx.tiles.edits import NAME, Edit, Edits, read_edits, united, write_edits
from cityx.tiles.grid import Tile
from cityx.tiles.order import read_order
from cityx.tiles.run import TILES, build_tiles, records

HERE = Tile(-1, -1)
RED = "make the tallest building red"


def quiet(_):
    pass


@pytest.fixture
def copied(built_tiles, tmp_path):
    return copy_of(built_tiles, tmp_path / "tiles")


class Hands:
    """Workers that are this process, which has imported everything."""

    def __init__(self, build, job, *_, **__):
        self.build, self.job = build, job

    def run(self, chunks):
        for chunk in chunks:
            yield from self.build(self.job, chunk)

    def close(self):
        pass


@pytest.fixture(autouse=True)
def in_this_process(monkeypatch):
    monkeypatch.setattr("cityx.tiles.run.Pool", Hands)


def digests(folder):
    return {tile.name: (record["key"], record["files"]) for tile, record in records(folder).items()}


def store(folder, tile):
    return read_city(folder / TILES / tile.name / "city")


def test_an_edit_builds_its_tile_alone_and_undoing_it_gives_the_same_bytes_again(
    copied, built_tiles, tmp_path
):
    copy_of(copied / TILES / HERE.name / "city", tmp_path / "alone" / "city")
    told = edit_city(tmp_path / "alone", RED)
    done = edit_tiles(copied, RED, at=HERE, say=quiet)
    assert (done.number, done.tiles, done.summary.built) == (1, [HERE], 1)
    before, after = digests(built_tiles), digests(copied)
    assert [name for name in before if before[name] != after[name]] == [HERE.name]
    # The tile, built from its fragment, is the city that the sentence made of its store.
    assert content_hash(store(copied, HERE)).total == told["hash"]
    index = json.loads((copied / "index.json").read_text())["tiles"]
    assert index[HERE.name]["hash"] == told["hash"]
    assert not (copied / TRIED).exists()

    shutil.rmtree(copied / TILES / HERE.name)  # a tile that was lost has its edit again
    order, tiles = read_order(copied)
    assert build_tiles(copied, order, tiles, say=quiet).built == 1
    assert digests(copied) == after

    shown = CliRunner().invoke(commands, ["edit", str(copied), "undo"])
    assert shown.exit_code == 0, shown.output
    assert "edit 0: 1 tiles built anew" in shown.output
    assert digests(copied) == before
    assert read_edits(copied).every[0].text == RED  # which redo would make again


def test_a_street_is_changed_in_every_tile_that_has_a_part_of_it(copied, built_tiles):
    missing = [Tile(0, -1), Tile(0, 0)]  # they would have it if they were built
    for tile in missing:
        shutil.rmtree(copied / TILES / tile.name)
    done = edit_tiles(copied, "make the main street 2 m wider", at=HERE, say=quiet)
    assert set(missing) & set(done.tiles)
    there = [tile for tile in done.tiles if tile not in missing]
    assert done.summary.built == len(there) == 2
    calls = {call.key for tile in done.tiles for call in read_edits(copied).of(tile)}
    assert len(calls) == 1
    (street,) = read_edits(copied).of(HERE)[0].args["streets"]
    wider = 0
    for tile in there:
        roads, old = (store(folder, tile).layout.roads for folder in (copied, built_tiles))
        mine = roads["id"] == int(street, 16)
        gained = roads["width"][mine].to_numpy() - old["width"][mine].to_numpy()
        assert np.allclose(gained, 2.0)
        wider += int(mine.sum())
    assert wider > 1
    found = {
        check.name: check for check in checked(copied, sample=0, seed=0, source=None, say=quiet)
    }
    assert found["seams of ground"].ok


def test_what_is_not_settled_or_not_of_tiles_is_refused_and_nothing_changes(copied, built_tiles):
    with pytest.raises(UsageError, match=r"could be done in 3 tiles .* say where with --at"):
        edit_tiles(copied, RED, say=quiet)
    with pytest.raises(UsageError, match="background/weather-v1 is of a whole site; tiles have no"):
        edit_tiles(copied, "it rains", at=HERE, say=quiet)
    with pytest.raises(UsageError, match="There is no edit of these tiles to undo"):
        edit_tiles(copied, "undo", say=quiet)
    with pytest.raises(InputError, match="Tile 7_7 has no store to edit"):
        edit_tiles(copied, RED, at=Tile(7, 7), say=quiet)
    assert digests(copied) == digests(built_tiles)
    assert not (copied / NAME).exists()


def test_edits_are_read_as_they_were_written(tmp_path):
    wide = Call("edit/streets-v1", {"streets": ["0" * 16], "widen_by": 2}, {})
    edits = Edits().with_edit(Edit("a", {"0_0": (wide,)})).with_edit(Edit("b", {"1_0": (wide,)}))
    write_edits(edits.moved(-1), tmp_path)
    again = read_edits(tmp_path)
    assert again == edits.moved(-1)
    assert (again.of(Tile(0, 0)), again.of(Tile(1, 0))) == ((wide,), ())
    assert again.moved(1) == edits
    (tmp_path / NAME).write_text("{}")
    with pytest.raises(InputError, match=r"edits\.json is damaged"):
        read_edits(tmp_path)


def test_streets_of_several_tiles_are_changed_once_in_each():
    one, other = (Call("edit/streets-v1", {"streets": [key * 16], "lanes": 2}, {}) for key in "ab")
    grown = Call("edit/scale-v1", {"objects": ["c" * 16], "factor": 2.0}, {})
    found = united([one, grown, other, one, grown])
    assert [dict(call.args) for call in found] == [
        {"streets": ["a" * 16, "b" * 16], "lanes": 2}, dict(grown.args), dict(grown.args),
    ]  # fmt: skip
