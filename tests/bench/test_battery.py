"""Inputs of every kind say exactly what a city of them should hold, and come out the same."""

import hashlib
import json

import numpy as np
import pytest
import shapely
from cityx_bench.battery import KINDS, _Town, things_of, write_battery
from cityx_bench.inputs import write_map
from cityx_bench.runner import Bench, run_bench
from cityx_bench.scenes import FRAME, Thing
from PIL import Image

from cityx.checks.predicates import parse
from cityx.city.sites import moved
from cityx.errors import UsageError
from cityx.sources.osm import read_osm


@pytest.fixture(scope="module")
def battery(tmp_path_factory):
    folder = tmp_path_factory.mktemp("battery")
    return write_battery(folder, count=3), folder


def test_there_are_so_many_of_each_kind_and_every_file_is_in_the_manifest(battery):
    made, folder = battery
    assert [task.group for task in made.tasks] == [kind for kind in KINDS for _ in range(3)]
    manifest = json.loads((folder / "manifest.json").read_text())
    assert {entry["file"] for entry in manifest["files"]} == set(made.inputs)
    for entry in manifest["files"]:
        content = made.inputs[entry["file"]].read_bytes()
        assert (hashlib.sha256(content).hexdigest(), len(content)) == (
            entry["sha256"], entry["bytes"],
        )  # fmt: skip
        assert entry["licence"]
    assert len(manifest["texts"]) == 3
    for task in made.tasks:
        assert task.expect
        for text in task.expect:
            parse(text)
        assert set(task.inputs) <= set(made.inputs)


def test_the_same_inputs_are_written_whatever_is_asked_for_besides(battery, tmp_path):
    _, folder = battery
    again = write_battery(tmp_path, kinds=("semantic",), count=2)
    names = [p.name for p in tmp_path.iterdir() if p.name != "manifest.json"]
    assert len(names) == 8  # map, image, world file, projection
    for name in names:
        assert (tmp_path / name).read_bytes() == (folder / name).read_bytes()
    before = {p.name: p.stat().st_mtime_ns for p in tmp_path.iterdir() if p.suffix != ".json"}
    assert write_battery(tmp_path, kinds=("semantic",), count=2) == again
    after = {p.name: p.stat().st_mtime_ns for p in tmp_path.iterdir() if p.suffix != ".json"}
    assert before == after


def read_back(path):
    """Read a map in the frame that it was written in."""
    found = read_osm(path)
    return moved(found.layout, found.frame, FRAME)


@pytest.mark.parametrize("number", [0, 1, 2])
def test_a_map_holds_what_its_town_holds(battery, number):
    made, folder = battery
    town = _Town(number, folder)
    layout, read = town.layout(), read_back(made.inputs[f"town_{number:02d}.osm"])
    assert len(read.buildings) == len(layout.buildings)
    shapes = [
        [shapely.union_all(getattr(one, table).geometry.to_numpy()) for one in (layout, read)]
        for table in ("buildings", "roads")
    ]
    assert shapely.area(shapely.symmetric_difference(*shapes[0])) < 0.005 * shapes[0][0].area
    assert shapely.hausdorff_distance(*shapes[1]) < 0.02
    wet = layout.areas["kind"] == "river"
    assert wet.any() == town.wet
    if town.wet:
        water = shapely.union_all(read.areas.geometry[read.areas["kind"] == "river"].to_numpy())
        river = shapely.union_all(layout.areas.geometry[wet].to_numpy())
        assert shapely.area(shapely.symmetric_difference(water, river)) < 0.01 * river.area


def test_an_image_shows_each_house_in_the_colour_of_houses(battery):
    made, folder = battery
    layout = _Town(1, folder).layout()
    with Image.open(made.inputs["town_01.png"]) as image:
        pixels = np.asarray(image)
    red = (pixels == (0xC8, 0x3C, 0x3C)).all(axis=2).sum() * 0.25
    area = shapely.union_all(layout.buildings.geometry.to_numpy()).area
    assert red == pytest.approx(area, rel=0.01)


def test_rings_with_holes_and_points_survive_a_map(tmp_path):
    court = shapely.Polygon(
        [(0, 0), (40, 0), (40, 30), (0, 30)], [[(10, 10), (30, 10), (30, 20), (10, 20)]]
    )
    tree = Thing("tree", {"natural": "tree"}, shapely.Point(50, 10))
    things = [Thing("court", {"building": "yes"}, court), tree]
    write_map(things, (-60, -60, 60, 60), tmp_path / "map.osm")
    layout = read_back(tmp_path / "map.osm")
    (shape,) = layout.buildings.geometry
    assert shapely.area(shapely.symmetric_difference(shape, court)) < 0.1
    assert len(shape.interiors) == 1
    assert len(layout.points) == 1
    assert {thing.tags.get("building") for thing in things_of(layout)} == {"yes", None}


def test_real_maps_come_first_and_are_named_with_their_licence(tmp_path):
    (tmp_path / "maps").mkdir()
    write_map([Thing("b", {"building": "yes"}, shapely.box(0, 0, 9, 9))], (-50, -50, 50, 50),
              tmp_path / "maps" / "place.osm")  # fmt: skip
    made = write_battery(tmp_path / "out", kinds=("osm",), count=2, maps=tmp_path / "maps")
    assert sorted(made.inputs) == ["place.osm", "town_01.osm"]
    manifest = json.loads((tmp_path / "out" / "manifest.json").read_text())
    licences = {entry["file"]: entry["licence"] for entry in manifest["files"]}
    assert "ODbL" in licences["place.osm"]
    assert "CC0" in licences["town_01.osm"]


def test_a_kind_that_does_not_exist_is_named(tmp_path):
    with pytest.raises(UsageError, match=r'"semantics".*Did you mean "semantic"'):
        write_battery(tmp_path, kinds=("semantics",))


@pytest.mark.slow
def test_cities_of_each_kind_hold_what_their_inputs_show(tmp_path):
    made = write_battery(tmp_path / "files", count=1)
    said = []
    bench = Bench(made.tasks, "offline", tmp_path, lod=1, inputs=made.inputs)
    samples = run_bench(bench, said.append)
    assert [(s.category, s.right) for s in samples] == [(kind, True) for kind in KINDS]
    said.clear()
    assert run_bench(bench, said.append) == samples
    assert said == []  # the log held them all
