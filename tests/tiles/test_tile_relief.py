"""Tiles of a map with heights: one grid and one datum, wherever a window begins."""

import json
from dataclasses import replace
from itertools import takewhile

import numpy as np
import pytest

from cityx.city.frame import Frame
from cityx.city.terrain import Profile
from cityx.errors import InputError, UsageError
from cityx.sources.osm import site_of
from cityx.sources.osm.reader import read_elements
from cityx.tiles.actions import built
from cityx.tiles.check import checked
from cityx.tiles.order import HIGH_MARGIN, Order, read_order
from cityx.tiles.planning import order_of
from cityx.tiles.region import LAID
from cityx.tiles.relief import BLOCK, Relief, packed, relief_of, streets_on, unpacked
from cityx.tiles.run import FRAGMENTS, TILES, build_tiles, prepared, records
from cityx.tiles.split import read_fragment
from cityx.tiles.tile import land_of
from cityx.tiles.tileset import earth_centred

CELL = 0.0005  # degrees, 30 to 55 m


def quiet(_):
    pass


def write_heights(path, frame, across=6000.0, rise=15.0):
    """Write hills about the origin of a frame, in whole metres, as an ESRI grid in degrees."""
    (west, south), (east, north) = frame.to_geographic(across / 2 * np.array([[-1, -1], [1, 1]]))
    columns, rows = int((east - west) / CELL), int((north - south) / CELL)
    x, y = np.meshgrid(west + CELL * np.arange(columns), south + CELL * np.arange(rows)[::-1])
    xy = frame.to_local(np.column_stack([x.ravel(), y.ravel()]))
    z = np.rint(412.0 + 0.02 * xy[:, 0] + rise * np.sin(xy[:, 1] / 150.0)).reshape(rows, columns)
    head = (f"ncols {columns}\nnrows {rows}\nxllcenter {west}\nyllcenter {south}\n"
            f"cellsize {CELL}\n")  # fmt: skip
    path.write_text(head + "\n".join(" ".join(f"{v:.0f}" for v in row) for row in z))
    return path


@pytest.fixture(scope="module")
def frame():
    return Frame(47.0, 9.5)


@pytest.fixture(scope="module")
def hills(frame, tmp_path_factory):
    return write_heights(tmp_path_factory.mktemp("hills") / "hills.asc", frame)


def test_windows_have_the_same_height_wherever_they_begin(frame, hills):
    site = (-1500.0, -1500.0, 1500.0, 1500.0)
    shared = relief_of([hills], frame, site)
    found = [
        Relief([hills], frame, shared).over(box)
        for box in ((-700.0, -700.0, 700.0, 700.0), (-203.0, -511.0, BLOCK + 99.0, 607.0))
    ]
    assert {each.datum for each in found} == {shared["datum"]} == {np.floor(shared["datum"])}
    x = np.arange(-200.0, 700.0, shared["cell"])
    nodes = np.stack(np.meshgrid(x, x[x < 600.0]), axis=-1).reshape(-1, 2)
    one, other = (each.height_at(nodes) for each in found)
    assert (one == other).all()
    assert np.ptp(one) > 20.0
    # Rounding took half a metre, evening out the steps moves half a metre more at most.
    assert np.abs(one + shared["datum"] - (412.0 + 0.02 * nodes[:, 0]
                  + 15.0 * np.sin(nodes[:, 1] / 150.0))).max() < 1.25  # fmt: skip


def test_a_terrain_is_the_same_after_a_fragment_held_it(frame, hills):
    shared = relief_of([hills], frame, (-1500.0, -1500.0, 1500.0, 1500.0))
    terrain = Relief([hills], frame, shared).over((-100.0, -50.0, 80.0, 400.0))
    again = unpacked(packed(terrain))
    assert (again.origin, again.cell, again.datum) == (terrain.origin, terrain.cell, terrain.datum)
    assert (again.heights == terrain.heights).all()
    assert unpacked({}) is None


def test_streets_have_the_heights_of_the_whole_map_in_every_window(town_map, frame, tmp_path):
    osm = read_elements(town_map)
    frame, site = site_of(osm, str(town_map))
    steep = write_heights(tmp_path / "steep.asc", frame, rise=60.0)
    order, _ = order_of([town_map, steep], lod=0, size=500.0)
    relief = Relief([steep], frame, order.relief)
    streets = streets_on(land_of(order, osm, {}, site, "all"), order.items, relief)
    assert (Profile.of(streets.place / 1e3, streets.z).z == streets.z).all()
    moved = streets.z - relief.height_at(streets.place / 1e3)
    assert np.abs(moved).max() > 5.0
    spots = np.column_stack([np.linspace(-250.0, 250.0, 101), np.zeros(101)])

    def heights(box, known):
        terrain = relief.over(box)
        terrain = unpacked(packed(replace(terrain, streets=known.within(box) if known else None)))
        land = replace(land_of(order, osm, {}, box, "part"), terrain=terrain)
        land = replace(land, stages_done=land.stages_done | {"terrain"})
        return built(land, takewhile(lambda item: item.action != LAID, order.items))

    south, north = (-400.0, -410.0, 400.0, 40.0), (-400.0, -40.0, 400.0, 410.0)
    alone = [heights(box, None).terrain.height_at(spots) for box in (south, north)]
    given = [heights(box, streets) for box in (south, north)]
    one, other = (city.terrain.height_at(spots) for city in given)
    assert np.abs(alone[0] - alone[1]).max() > 0.1
    assert (one == other).all()
    assert given[0].terrain.streets is None
    network = given[0].network
    inner = np.abs(network.points).max(axis=1) < 100.0
    ends = streets.at(network.points[inner])
    assert np.isfinite(ends).sum() > 10
    assert np.nanmax(np.abs(ends - network.z[inner])) < 0.5


def test_beyond_all_heights_the_land_lies_at_the_datum(frame, hills):
    shared = relief_of([hills], frame, (-1500.0, -1500.0, 1500.0, 1500.0))
    void = hills.with_name("void.asc")
    void.write_text("ncols 3\nnrows 3\nxllcenter 9.4995\nyllcenter 46.9995\ncellsize 0.0005\n"
                    "nodata_value -1\n" + "-1 -1 -1\n" * 3)  # fmt: skip
    assert (Relief([void], frame, shared).over((0.0, 0.0, 9.0, 9.0)).heights == 0.0).all()


def test_heights_of_houses_or_of_nowhere_are_refused(town_map, tmp_path):
    np.save(tmp_path / "somewhere.npy", np.random.default_rng(0).uniform(2.0, 90.0, (30, 30)))
    with pytest.raises(InputError, match=r"somewhere\.npy does not say where it lies; tiles take"):
        order_of([town_map, tmp_path / "somewhere.npy"])
    with pytest.raises(UsageError, match=r"one OpenStreetMap file, and of heights .* 0 maps given"):
        order_of([tmp_path / "somewhere.npy"])


@pytest.fixture(scope="module")
def tiles_on_hills(town_map, made_once):
    """The folder of two tiles of the small town on hills, in either order."""

    def make(folder):
        folder.mkdir()
        frame = site_of(read_elements(town_map), str(town_map))[0]
        hills = write_heights(folder / "hills.asc", frame)
        order, source = order_of([town_map, hills], lod=0, size=500.0)
        tiles = prepared(order, source, folder / "out", quiet, heights=[hills])
        summary = build_tiles(folder / "out", order, tiles[:2], say=quiet)
        assert (summary.built, summary.failed) == (2, {})

    return made_once("tiles-on-hills", make) / "out"


def test_tiles_with_heights_are_the_same_alone_and_meet(tiles_on_hills):
    order, _ = read_order(tiles_on_hills)
    assert order == Order.from_json(order.to_json())
    assert order.margin == HIGH_MARGIN
    found = {each.name: each for each in checked(
        tiles_on_hills, sample=1, seed=0, source=None, say=quiet)}  # fmt: skip
    assert {name: each.faults for name, each in found.items() if not each.ok} == {}
    assert found["seams of terrain"].told == "1 borders, 100 places"
    for tile in records(tiles_on_hills):
        terrain = read_fragment(tiles_on_hills / FRAGMENTS / f"{tile.name}.npz")[2]
        assert terrain.datum == order.datum > 390.0
        low, high = np.array(records(tiles_on_hills)[tile]["box"])[:, 2]
        assert 10.0 < high - low < 100.0
        tileset = json.loads((tiles_on_hills / TILES / tile.name / "tileset.json").read_text())
        place = np.array(tileset["root"]["transform"][12:15])
        middle = np.array([tile.box(500.0)[:2]]) + 250.0
        level = earth_centred(order.frame.to_geographic(middle), 0.0)[0]
        assert np.linalg.norm(place - level) == pytest.approx(order.datum, abs=0.01)
