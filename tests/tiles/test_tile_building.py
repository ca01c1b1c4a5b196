"""Tiles are built alone, in any order, by any workers, again after all: with the same bytes."""

import json
import resource
import shutil
import weakref
from contextlib import contextmanager

import numpy as np
import pytest
from copies import copy_of
from typer.testing import CliRunner

from cityx.city.store import read_city
from cityx.cli.tiles import tiles as commands
from cityx.errors import DiskError, InputError, UsageError
from cityx.system.digests import file_sha256
from cityx.tiles.check import _walked, checked
from cityx.tiles.grid import Tile
from cityx.tiles.order import UNPACKED, code_of, read_order
from cityx.tiles.planning import estimate, order_of, sizes_of, survey_of
from cityx.tiles.run import (
    FRAGMENTS,
    PROTOTYPES,
    TILES,
    Built,
    Failed,
    Job,
    build_one,
    build_tiles,
    prepared,
    records,
)
from cityx.tiles.tile import file_faults, make_tile


def quiet(_):
    pass


@pytest.fixture
def copied(built_tiles, tmp_path):
    return copy_of(built_tiles, tmp_path / "tiles")


def digests(folder):
    return {tile.name: (record["key"], record["files"]) for tile, record in records(folder).items()}


def test_every_check_passes_and_two_tiles_built_again_alone_are_the_same(built_tiles, town_map):
    found = checked(built_tiles, sample=2, seed=1, source=town_map, say=quiet)
    assert {check.name: check.faults for check in found if not check.ok} == {}
    assert len(found) == 9
    (walks,) = [check.told for check in found if check.name == "seams of walks"]
    assert walks.startswith("4 borders, ")
    assert float(walks.split()[2]) > 0.5  # the kerbs of two streets


def test_walks_that_go_on_as_others_beyond_a_border_are_found():
    here = np.array([[0.0, 2.0, 8, 1, 5], [2.0, 2.15, 9, 1, 5]])
    assert _walked(here, here[::-1]) == pytest.approx((2.15, 0.0))
    cut = np.array([[0.0, 1.5, 8, 1, 5], [1.5, 2.0, 8, 1, 5], [2.0, 2.15, 9, 1, 5]])
    assert _walked(here, cut) == pytest.approx((2.15, 0.0))
    renamed = here + np.array([[0, 0, 0, 0, 1], [0, 0, 0, 0, 0]])
    assert _walked(here, renamed) == pytest.approx((0.15, 2.0))
    assert _walked(here, here[:0]) == pytest.approx((0.0, 2.15))
    assert _walked(here, here + np.array([0.0004, 0.0004, 0, 0, 0]))[1] == 0.0


def test_workers_of_dask_in_another_order_write_the_same_bytes(
    order_and_map, built_tiles, tmp_path
):
    pytest.importorskip("distributed")
    order, source = order_and_map
    tiles = prepared(order, source, tmp_path / "out", quiet)
    build_tiles(tmp_path / "out", order, tiles[::-1], cluster="local:1", say=quiet)
    assert digests(tmp_path / "out") == digests(built_tiles)
    for name in ("tileset.json", "index.json"):
        assert (tmp_path / "out" / name).read_bytes() == (built_tiles / name).read_bytes()


def test_a_run_goes_on_after_a_worker_was_killed(order_and_map, built_tiles, copied):
    order, tiles = order_and_map[0], read_order(copied)[1]
    (copied / TILES / tiles[1].name).rename(copied / TILES / f".{tiles[1].name}.host.1.partial")
    summary = build_tiles(copied, order, tiles, say=quiet)
    assert (summary.built, summary.kept) == (1, 3)
    assert digests(copied) == digests(built_tiles)
    assert not [*(copied / TILES).glob(".*")]


def test_a_tile_of_a_broken_fragment_is_named_and_the_others_are_built(order_and_map, copied):
    order, tiles = order_and_map[0], read_order(copied)[1]
    broken = tiles[2].name
    (copied / FRAGMENTS / f"{broken}.npz").write_bytes(b"no fragment")
    shutil.rmtree(copied / TILES / tiles[0].name)
    summary = build_tiles(copied, order, tiles, say=quiet)
    assert summary.built == 1
    assert list(summary.failed) == [broken]
    assert f"{broken}.npz is damaged" in summary.failed[broken]


@contextmanager
def files_of_at_most(size):
    """Let no file of this process, or of those it starts, grow beyond some bytes."""
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)


def test_a_tile_without_room_is_named_the_others_are_built_and_it_is_too_when_there_is(
    order_and_map, built_tiles, copied
):
    order, tiles = order_and_map[0], read_order(copied)[1]
    largest = {
        tile: max(path.stat().st_size for path in (copied / TILES / tile.name).rglob("*.*"))
        for tile in tiles
    }
    small, *_, large = sorted(tiles, key=lambda tile: largest[tile])
    for tile in (small, large):
        shutil.rmtree(copied / TILES / tile.name)
    with files_of_at_most((largest[small] + largest[large]) // 2):
        summary = build_tiles(copied, order, [large, small], say=quiet)
    assert summary.built == 1
    assert list(summary.failed) == [large.name]
    assert summary.failed[large.name].startswith("A file would be larger than may be written: ")
    assert list(json.loads((copied / "index.json").read_text())["tiles"]) == [
        tile.name for tile in sorted(tiles) if tile != large
    ]
    build_tiles(copied, order, tiles, say=quiet)
    assert digests(copied) == digests(built_tiles)
    assert not [*(copied / TILES).glob(".*")]


def test_a_run_ends_when_no_tile_finds_room(order_and_map, copied, monkeypatch):
    order, tiles = order_and_map[0], read_order(copied)[1]
    monkeypatch.setattr("cityx.tiles.run.FULL", 2)
    for tile in tiles[:3]:
        shutil.rmtree(copied / TILES / tile.name)
    said = f"So 2 tiles in a row failed: {tiles[0].name}, {tiles[1].name}. 1 tiles are done"
    with files_of_at_most(5000), pytest.raises(DiskError, match=said):
        build_tiles(copied, order, tiles, say=quiet)


def test_a_worker_holds_nothing_of_a_tile_while_it_builds_the_next(
    order_and_map, copied, monkeypatch
):
    made = []

    def watched(*args):
        assert [ref() for ref in made] == [None] * len(made)
        tile = make_tile(*args)
        made.append(weakref.ref(tile))
        return tile

    monkeypatch.setattr("cityx.tiles.run.make_tile", watched)
    order, tiles = order_and_map[0], read_order(copied)[1]
    built = list(build_one(Job(copied, order), tiles[:2]))
    assert len(made) == 2
    for one in built:
        assert isinstance(one, Built), one
        assert 0 < one.held_mb <= one.rss_mb + 1


def test_a_worker_that_packs_meshes_otherwise_fails_its_tiles_by_name(
    order_and_map, copied, monkeypatch
):
    order, tiles = order_and_map[0], read_order(copied)[1]
    packs = not order.code.endswith(UNPACKED)
    monkeypatch.setattr("cityx.tiles.order.codec", lambda: None if packs else object())
    (failed,) = build_one(Job(copied, order), tiles[:1])
    assert isinstance(failed, Failed)
    assert failed.tile == tiles[0]
    assert "this worker lacks the extra view" in failed.cause or not packs
    assert code_of().endswith(UNPACKED) == packs


def test_the_store_of_a_tile_refers_to_what_it_holds_alone(built_tiles):
    for tile in records(built_tiles):
        city = read_city(built_tiles / TILES / tile.name / "city")
        network, lanes = city.network, city.lanes
        assert network.edge_count > 0
        assert network.edge_road.max() < len(city.layout.roads)
        assert set(network.edge_nodes.ravel()) == set(range(len(network.node_position)))
        assert lanes.edge.max() < network.edge_count
        assert lanes.connection.min() >= 0 < lanes.count > lanes.connection.max()
        assert city.ground.edge_faces[:, 0].min() >= 0  # what lies beyond is on the right
        left = city.ground.vertices[city.ground.edges]
        rim = city.ground.edge_faces[:, 1] < 0
        middle = np.mean(tile.box(500.0)[::2]), np.mean(tile.box(500.0)[1::2])
        way, inward = left[rim, 1] - left[rim, 0], middle - left[rim, 0]
        assert (way[:, 0] * inward[:, 1] - way[:, 1] * inward[:, 0] > 0).all()


def test_stores_of_tiles_share_their_prototypes(built_tiles):
    held = {path.stat().st_ino: path.stem for path in (built_tiles / PROTOTYPES).iterdir()}
    assert len(held) > 5
    files = [path for path in built_tiles.glob("tiles/*/city/prototypes*.npz")
             if path.stat().st_nlink > 1]  # fmt: skip
    assert {path.stat().st_ino for path in files} == set(held)
    assert all(path.stat().st_nlink == 1 + sum(other.samefile(path) for other in files)
               for path in files)  # fmt: skip
    assert len(files) > 1.5 * len(held)
    assert file_sha256(files[0]) == held[files[0].stat().st_ino]


def test_a_file_that_was_changed_is_found(copied):
    tile = next(iter(records(copied)))
    path = copied / TILES / tile.name / "tileset.json"
    path.write_text(path.read_text() + " ")
    assert file_faults(copied / TILES / tile.name) == [f"{path} is not as it was written."]


def test_get_builds_the_tile_at_a_place_if_it_is_missing(copied):
    shutil.rmtree(copied / TILES / "-1_0")
    shown = CliRunner().invoke(commands, ["get", str(copied), "-20,30"])
    assert shown.exit_code == 0, shown.output
    assert shown.stdout.strip() == str(copied / TILES / "-1_0")
    assert Tile(-1, 0) in records(copied)


def test_an_area_is_built_first_and_extended_later(built_tiles, town_map, tmp_path):
    out = tmp_path / "out"
    words = ["build", str(town_map), "-o", str(out), "--lod", "1", "--size", "500",
             "--at=100,100", "--area", "50x50"]  # fmt: skip
    shown = CliRunner().invoke(commands, words)
    assert shown.exit_code == 0, shown.output
    assert list(digests(out)) == ["0_0"]
    assert digests(out)["0_0"] == digests(built_tiles)["0_0"]


def test_what_cannot_be_split_is_refused(town_map, built_tiles, tmp_path):
    with pytest.raises(UsageError, match="--size 300 is no size of a tile; it takes a multiple of"):
        order_of([town_map], size=300)
    with pytest.raises(UsageError, match="--margin 50 is too narrow"):
        order_of([town_map], margin=50)
    with pytest.raises(InputError, match="holds no tiles; cityx tiles build makes them"):
        read_order(tmp_path)
    other = order_of([town_map], lod=2, size=500.0)[0]
    with pytest.raises(UsageError, match=r"holds tiles of another order \(items, lod differ\)"):
        prepared(other, town_map, built_tiles, quiet)


def test_the_plan_counts_what_is_built(order_and_map, built_tiles):
    order, source = order_and_map
    told = estimate(sizes_of(survey_of(order, source), order), order)
    index = json.loads((built_tiles / "index.json").read_text())["tiles"]
    assert told.tiles == len(index)
    assert told.buildings >= sum(row["counts"]["buildings"] for row in index.values()) > 8
    assert told.cpu_s > 0
