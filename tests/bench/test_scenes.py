"""Base scenes and small inputs."""

import hashlib

import numpy as np
import pytest
import rasterio
from cityx_bench.inputs import SITE, SMALL_INPUTS, TRUTH, town, write_inputs
from cityx_bench.scenes import SCENES, write_drawing
from PIL import Image

from cityx.checks.predicates import clean, measure_all
from cityx.city.content import content_hash
from cityx.sources.drawn import read_drawn
from cityx.sources.input_kinds import classify
from cityx.sources.osm import read_osm

HOLDS = {
    "grid_s": [
        "n(building) == 48", "n(building, id=b01) == 1", "n(building, id=b48) == 1",
        "share(building, material=concrete) == 1", "n(tree) == 60", "n(road) == 8",
        "n(vehicle) == 0", "n(pedestrian) == 0", "road.pattern == grid", "env.time == noon",
        "n(road, class=primary) == 1", "env.weather == clear", "size.x in [399, 401]",
        "size.y in [399, 401]",
    ],
    "river_s": [
        "n(building) == 40", "n(bridge) == 2", "crosses(bridge, river)", "n(river) == 1",
        "n(vehicle) == 30", "n(pedestrian) == 0", "env.weather == overcast",
        "size.x in [599, 601]", "size.y in [399, 401]",
    ],
    "park_s": [
        "n(building) == 20", "n(park) == 1", "n(plaza) == 1", "n(park1) == 1", "n(loop1) == 1",
        "n(plaza1) == 1", "env.time == afternoon", "env.weather == clear", "size.x in [299, 301]",
    ],
}  # fmt: skip


@pytest.mark.parametrize("name", SCENES)
def test_a_scene_has_the_layout_that_its_hash_says(name, tmp_path):
    scene = SCENES[name]
    path = write_drawing(scene.draw(), scene.extent, tmp_path / f"{name}.geojson")
    assert content_hash(read_drawn(path)).total == scene.layout


@pytest.mark.parametrize("name", SCENES)
def test_a_built_scene_holds_what_tasks_rely_on_and_is_clean(name, scene):
    city = scene(name)
    missed = [f.evidence for f in measure_all(HOLDS[name], city) if not f.met]
    assert missed == []
    assert [f.evidence for f in clean(city) if not f.met] == []


def test_the_three_tallest_of_the_grid_are_no_matter_of_taste():
    levels = sorted(int(t.tags["building:levels"]) for t in SCENES["grid_s"].draw()
                    if "building" in t.tags)  # fmt: skip
    assert levels[-4] < levels[-3] - 2
    assert len(set(levels[-3:])) == 3


def test_inputs_are_of_their_kinds_and_always_the_same(tmp_path):
    one, other = (write_inputs(tmp_path / name) for name in "ab")
    kinds = {name: classify(path).kind for name, path in one.items()}
    assert kinds == {
        "osm_small.osm": "osm", "semantic_small.png": "semantic", "height_small.tif": "height",
        "satellite_small.png": "satellite", "note.txt": "text", TRUTH: "drawn",
    }  # fmt: skip
    for name in (*SMALL_INPUTS, TRUTH):
        digests = {hashlib.sha256(paths[name].read_bytes()).digest() for paths in (one, other)}
        assert len(digests) == 1, name


def test_the_map_shows_the_whole_town(tmp_path):
    path = write_inputs(tmp_path)["osm_small.osm"]
    layout = read_osm(path).layout
    houses = [thing for thing in town() if "building" in thing.tags]
    assert len(layout.buildings) == len(houses)
    area = sum(thing.shape.area for thing in houses)
    assert layout.buildings.geometry.area.sum() == pytest.approx(area, rel=1e-3)
    assert layout.extent == pytest.approx(SITE, abs=1.0)


def test_no_street_of_the_hills_has_to_be_steeper_than_asked(tmp_path):
    with rasterio.open(write_inputs(tmp_path)["height_small.tif"]) as file:
        slope = np.hypot(*np.gradient(file.read(1), file.res[0]))
    assert 0.05 < slope.max() < 0.12


def test_roofs_are_seen_from_above_where_houses_stand(tmp_path):
    paths = write_inputs(tmp_path)
    seen = np.asarray(Image.open(paths["satellite_small.png"])).astype(float)
    classes = np.asarray(Image.open(paths["semantic_small.png"]))
    house = (classes == (0xC8, 0x3C, 0x3C)).all(axis=2)
    ruddy = seen[..., 0] - seen[..., 2]
    assert ruddy[house].min() > ruddy[~house].mean()
