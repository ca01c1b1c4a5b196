"""A city against the files it was made of."""

from dataclasses import replace

import numpy as np
import pytest
import rasterio
import shapely
from affine import Affine
from PIL import Image

from cityx.checks.predicates import measure
from cityx.city import Terrain
from cityx.errors import InputError
from cityx.sources.heights.height_source import lay_terrain, read_heights
from cityx.sources.osm import read_osm
from cityx.sources.semantic_map import read_semantic_map

GREY, RED, GREEN, BLUE = (0x8C, 0x8C, 0x96), (0xC8, 0x3C, 0x3C), (0xA0, 0xD2, 0x78), (90, 150, 220)


def shifted(city, table, x, y):
    old = getattr(city.layout, table)
    shapes = shapely.transform(old.geometry.to_numpy(), lambda p: p + np.array([x, y]))
    return replace(city, layout=replace(city.layout, **{table: old.set_geometry(shapes)}))


@pytest.fixture(scope="module")
def mapped(town_map):
    return read_osm(town_map)


@pytest.fixture
def painted(tmp_path):
    """A street, houses and a lake, half a metre per pixel."""
    picture = np.full((400, 400, 3), GREEN, np.uint8)
    picture[193:207] = GREY
    for y in (40, 90, 140, 240, 300, 350):
        for x in (60, 130, 200):
            picture[y : y + 24, x : x + 24] = RED
    picture[280:360, 260:370] = BLUE
    path = tmp_path / "town.png"
    Image.fromarray(picture).save(path)
    return path


def test_a_city_is_its_own_map(mapped, town_map):
    inputs = {"town.osm": town_map}
    for layer in ("building", "road"):
        asked = f"iou({layer}, town.osm) >= 0.95"
        assert measure(asked, mapped, inputs=inputs).met
        table = {"building": "buildings", "road": "roads"}[layer]
        found = measure(asked, shifted(mapped, table, 4.0, 4.0), inputs=inputs)
        assert found.met is False, found


def test_a_picture_is_compared_pixel_by_pixel(painted):
    city = read_semantic_map(painted)
    inputs = {"town.png": painted}
    for layer, table in (("building", "buildings"), ("water", "areas"), ("road", "roads")):
        asked = f"iou({layer}, town.png) >= 0.85"
        found = measure(asked, city, inputs=inputs)
        assert found.met, found
        assert measure(asked, shifted(city, table, 6.0, 6.0), inputs=inputs).met is False


def test_the_terrain_is_compared_with_its_file(mapped, tmp_path):
    path = tmp_path / "hills.tif"
    lonlat = mapped.frame.to_geographic([[0.0, 0.0]])[0]
    rows, columns = np.mgrid[0:100, 0:100]
    values = (20 * np.sin(rows / 12) + 15 * np.cos(columns / 9)).astype("float32")
    step = 1e-4
    place = Affine(step, 0, lonlat[0] - 50 * step, 0, -step, lonlat[1] + 50 * step)
    profile = {"driver": "GTiff", "width": 100, "height": 100, "count": 1, "dtype": "float32"}
    with rasterio.open(path, "w", **profile, crs="EPSG:4326", transform=place) as dataset:
        dataset.write(values, 1)
    asked, inputs = "corr(terrain, hills.tif) >= 0.99", {"hills.tif": path}
    draped = lay_terrain(mapped, read_heights(path))
    assert measure(asked, draped, inputs=inputs).met
    assert measure(asked, mapped, inputs=inputs).met is False
    heights = np.random.default_rng(3).normal(size=draped.terrain.heights.shape)
    rough = replace(draped, terrain=Terrain(draped.terrain.origin, draped.terrain.cell, heights))
    assert measure(asked, rough, inputs=inputs).met is False


def test_a_file_that_is_not_given_or_cannot_be_read_tells_nothing(mapped, tmp_path):
    found = measure("iou(building, other.osm) >= 0.5", mapped)
    assert found.met is None
    assert found.evidence == "cannot tell: no input is called other.osm; given: none"
    broken = tmp_path / "broken.osm"
    broken.write_text("<osm>")
    found = measure("iou(building, broken.osm) >= 0.5", mapped, inputs={"broken.osm": broken})
    assert found.met is None
    with pytest.raises(InputError):
        read_osm(broken)


def test_an_input_of_another_place_tells_nothing(mapped, painted):
    far = replace(mapped, layout=replace(mapped.layout, extent=(9e4, 9e4, 9.1e4, 9.1e4)))
    found = measure("iou(building, town.png) >= 0.5", far, inputs={"town.png": painted})
    assert found.met is None
    assert "lies elsewhere" in found.evidence
