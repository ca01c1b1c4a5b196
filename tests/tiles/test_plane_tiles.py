"""Tiles of the plane: without a map and without end, the same alone and among others."""

import json
import pickle

import numpy as np
import pytest
from copies import copy_of
from typer.testing import CliRunner

from cityx.city.store import read_city
from cityx.cli.tiles import tiles as commands
from cityx.errors import InputError, UsageError
from cityx.ids import id_text
from cityx.protocol.gate import Call
from cityx.tiles.check import checked
from cityx.tiles.editing import _plane_reached, edit_tiles
from cityx.tiles.edits import read_edits
from cityx.tiles.grid import Tile, tile_at
from cityx.tiles.page import start_of
from cityx.tiles.plane import (
    FARTHEST,
    SHEET,
    asked_of,
    origin_of,
    plan_from,
    plan_in,
    plane_land,
    plane_order,
    tiles_in,
)
from cityx.tiles.planning import estimate, plane_sizes, times
from cityx.tiles.run import TILES, build_tiles, chosen, prepared, records

FAR = SHEET * 32_551 + SHEET // 2  # metres; a border of sheets near the farthest tile


def quiet(_):
    pass


@pytest.fixture(scope="module")
def order():
    return plane_order(lod=1, size=500.0, margin=150.0)


@pytest.fixture(scope="module")
def pair(order, tmp_path_factory):
    """The folder of two tiles on both sides of a border of sheets, far out, the last one first."""
    folder = tmp_path_factory.mktemp("plane")
    prepared(order, None, folder, quiet)
    tiles = tiles_in(order, (FAR - 10, -FAR + 10, FAR + 10, -FAR + 20))
    assert [origin_of(order, tile)[0] for tile in tiles] == [FAR - SHEET // 2, FAR + SHEET // 2]
    summary = build_tiles(folder, order, tiles[::-1], say=quiet)
    assert (summary.built, summary.failed) == (2, {})
    return folder


def ids_of(folder, tile):
    scene = read_city(folder / TILES / tile.name / "city").scene
    every = [*scene.meshes.values(), *scene.instances.values()]
    return sorted(np.concatenate([one.object_id for one in every]).tolist())


def test_a_page_begins_at_a_tile(pair):
    start = start_of(pair)
    assert len(start["transform"]) == 16
    assert np.isclose(np.linalg.det(np.reshape(start["transform"], (4, 4))), 1.0)


def test_a_sentence_changes_a_tile_far_out_and_all_else_keeps_its_id(pair, order, tmp_path):
    copied = copy_of(pair, tmp_path / "plane")
    west, _ = tiles_in(order, (FAR - 10, -FAR + 10, FAR + 10, -FAR + 20))
    done = edit_tiles(copied, "make the tallest building red", at=west, say=quiet)
    assert (done.tiles, done.summary.built) == ([west], 1)
    (call,) = read_edits(copied).of(west)
    (name,) = call.args["objects"]
    assert int(name, 16) in ids_of(pair, west)
    # The tile, built from the rule, is the city that the sentence made of its store.
    assert records(copied)[west]["hash"] == done.reports[west]["hash"]
    assert records(copied)[west]["hash"] != records(pair)[west]["hash"]
    assert ids_of(copied, west) == ids_of(pair, west)
    with pytest.raises(UsageError, match="whole site"):
        edit_tiles(copied, "Make it rain.", say=quiet)


def test_a_change_of_a_street_reaches_the_tiles_beyond_the_border_of_sheets(pair, order):
    west, east = tiles_in(order, (FAR - 10, -FAR + 10, FAR + 10, -FAR + 20))
    own, other = (set(plane_land(order, tile).layout.roads["id"]) for tile in (west, east))
    roads = [set(read_city(pair / TILES / tile.name / "city").layout.roads["id"])
             for tile in (west, east)]  # fmt: skip
    street = min(roads[0] & roads[1] & own & other)
    call = Call("edit/streets-v1", {"streets": [id_text(int(street))], "widen_by": 2}, {})
    assert {west, east} <= _plane_reached(pair, order, west, call)
    assert _plane_reached(pair, order, west, call) == _plane_reached(pair, order, east, call)
    inner = min(roads[0] - other)
    call = Call("edit/streets-v1", {"streets": [id_text(int(inner))], "widen_by": 2}, {})
    assert east not in _plane_reached(pair, order, west, call)


def test_a_tile_far_out_is_the_same_again_alone_and_meets_its_neighbour(pair):
    # The tiles were built by a worker of its own; here one of them is built in this process.
    found = {check.name: check for check in checked(pair, sample=1, seed=2, source=None, say=quiet)}
    ground = found.pop("seams of ground")
    assert {name: check.faults for name, check in found.items() if not check.ok} == {}
    assert set(found) == {"files", "sizes", "rebuilt", "seams of roads", "seams of lines",
                          "seams of walks", "no object twice", "none missing"}  # fmt: skip
    assert ", 0 places" not in found["seams of roads"].told
    assert float(found["seams of walks"].told.split()[2]) > 0.5
    places = int(ground.told.split(", ")[1].split()[0])
    apart = sum(int(fault.split(": ")[1].split()[0]) for fault in ground.faults)
    assert apart <= 0.1 * places


def test_the_tileset_of_a_plane_lays_tiles_side_by_side(pair):
    children = json.loads((pair / "tileset.json").read_text())["root"]["children"]
    west, east = (np.array(child["transform"]).reshape(4, 4) for child in children)
    assert (east[3] - west[3]).tolist() == [500.0, 0.0, 0.0, 0.0]
    for child in children:
        root = json.loads((pair / child["content"]["uri"]).read_text())["root"]
        assert "transform" not in root
        assert np.allclose(root["boundingVolume"]["box"], child["boundingVolume"]["box"], atol=0.02)


def test_records_say_where_the_frame_of_a_tile_lies(pair, order):
    for tile, record in records(pair).items():
        assert record["origin"] == list(origin_of(order, tile))
        west, south, east, north = record["extent"]
        assert (east - west, north - south) == (500.0, 500.0)
        assert tile_at(west, south, 500.0) == tile


def test_two_tiles_of_the_first_town_lay_out_what_they_share_alike(order):
    one, other = (plane_land(order, tile).layout for tile in (Tile(0, 0), Tile(1, 0)))

    def whole(layout):
        """What lies wholly within the windows of both, by id: its shape, byte by byte."""
        return {
            (name, key): shape.wkb
            for name in ("roads", "areas", "buildings")
            for key, shape in zip(getattr(layout, name)["id"], getattr(layout, name).geometry,
                                  strict=True)
            if shape.bounds[0] > 360 and shape.bounds[2] < 640
            and shape.bounds[1] > -140 and shape.bounds[3] < 640
        }  # fmt: skip

    assert len(whole(one)) > 100
    assert whole(one) == whole(other)


def test_the_key_of_a_tile_needs_no_file_and_is_of_its_index(order, tmp_path):
    keys = [order.key(Tile(column, -12), tmp_path / "no fragment") for column in (7, 8, 7)]
    assert keys[0] == keys[2] != keys[1]


def test_words_say_what_the_towns_are_like_and_what_is_of_a_site_is_said():
    asked = asked_of("a dense old town with a river and 3 fountains", "brick", lod=1)
    assert (asked.plan.zone, asked.plan.streets, asked.plan.river) == ("core", "narrow", True)
    assert asked.style == "brick"
    assert any("layout/elements-v1 (kind=fountain" in left for left in asked.left_out)
    assert "layout/building_limits-v1" in {item.action for item in asked.amended}
    assert asked_of(lod=1).left_out == ()
    hills = asked_of("hills", lod=1).left_out
    assert hills == ("terrain/relief-v1 (form=hills) is of a whole site",)
    with pytest.raises(UsageError, match="The plane has no end, so its blocks have no number"):
        plan_from({"blocks": 20, "pattern": "grid"})


def test_what_words_say_of_buildings_holds_in_a_tile():
    plain, low = (
        plane_order(text, lod=0, size=500.0, margin=150.0)
        for text in ("towers", "towers, at most 3 floors")
    )
    levels = [plane_land(one, Tile(2, 3)).layout.buildings["levels"] for one in (plain, low)]
    assert levels[0].max() > 3 >= levels[1].max()


def test_an_order_of_a_plane_is_read_as_it_was_written(order):
    from cityx.tiles.order import Order

    worded = plane_order("a dense old town in winter", lod=1, size=500.0)
    for one in (order, worded):
        again = Order.from_json(json.loads(json.dumps(one.to_json())))
        assert again == one == pickle.loads(pickle.dumps(one))  # noqa: S301
    assert plan_in(again).zone == "core"


def test_a_part_of_the_plane_is_asked_for_and_none_beyond_its_last_tile(order, tmp_path):
    with pytest.raises(UsageError, match="The plane has no end; --at and --area say which part"):
        chosen([], order, None)
    far = (FARTHEST + 1) * order.size
    with pytest.raises(InputError, match="it is laid out to 100,000,000"):
        chosen([], order, (far, 0.0, far + 1, 1.0))
    assert len(chosen([], order, (-1.0, -1.0, 1.0, 1.0))) == 4
    words = ["build", "-o", str(tmp_path / "out")]
    assert "of no map; neither given" in str(CliRunner().invoke(commands, words).exception)


def test_an_estimate_of_a_plane_grows_with_its_tiles(order):
    told = estimate(plane_sizes(order, [Tile(0, 0)]), order)
    many = times(told, 25, order)
    assert many.tiles == 25
    assert many.buildings == 25 * told.buildings > 25 * 20
    assert many.cpu_s == pytest.approx(25 * told.cpu_s)
    assert many.memory_mb == told.memory_mb
