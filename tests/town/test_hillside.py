"""Towns on height files: streets follow the land, and nothing stands in the sea or in voids."""

from dataclasses import replace

import numpy as np
import pytest
import rasterio
import shapely
from rasterio.transform import Affine

from cityx.city.store import read_city
from cityx.options import BuildOptions, HowToRead
from cityx.projects.build import build
from cityx.road.heights.way_heights import way_heights
from cityx.road.network.network import road_network
from cityx.sources.heights.height_source import lay_terrain, read_heights
from cityx.sources.input_kinds import Input
from cityx.sources.intake import Inputs, read_sources
from cityx.town.town import town

SIDE, CELL = 121, 5.0  # cells, and metres


def hill(x, y):
    return 200 + 90 * np.exp(-(x**2 + y**2) / (2 * 130**2))


def valley(x, y):
    return 50 + 0.24 * np.abs(x - 0.3 * y)


def slope(x, y):
    return 300 + 0.22 * x + 0.05 * y + 4 * np.sin(y / 40)


def written(path, land, *, nodata=np.nan):
    """Write a function of metres about the middle of a file."""
    row, column = np.mgrid[0:SIDE, 0:SIDE]
    middle = (SIDE - 1) / 2
    values = land(CELL * (column - middle), CELL * (middle - row))
    place = Affine(CELL, 0, 500_000 - SIDE * CELL / 2, 0, -CELL, 5_500_000 + SIDE * CELL / 2)
    with rasterio.open(path, "w", driver="GTiff", height=SIDE, width=SIDE, count=1,
                       dtype="float32", crs="EPSG:32633", nodata=nodata,
                       transform=place) as file:  # fmt: skip
        file.write(values.astype(np.float32), 1)
    return path


def town_on(path, **asked):
    city = read_sources(Inputs((), (Input(path, "height"),)), HowToRead()).city
    return town(city, width=500.0, depth=500.0, **asked)


def climbs(layout, land):
    """Return rise over run of the land itself along each stretch of 20 m of street."""
    found = []
    for line in layout.roads.geometry:
        if line.length < 20:
            continue
        at = np.linspace(0, line.length, int(line.length // 20) + 1)
        points = shapely.get_coordinates(shapely.line_interpolate_point(line, at))
        found.append(np.abs(np.diff(land(*points.T))) / np.diff(at))
    return np.concatenate(found)


def earth(city, path, land):
    """Return metres between the land and the streets as the step of heights lays them."""
    laid = lay_terrain(city, read_heights(path))
    network = road_network(laid.layout)
    ground = way_heights(laid.layout, network, laid.terrain)[2]
    points = shapely.get_coordinates(shapely.segmentize(laid.layout.roads.geometry.to_numpy(), 4.0))
    inner = points[(np.abs(points) < 245).all(axis=1)]
    return np.abs(ground.height_at(inner) + ground.datum - land(*inner.T))


@pytest.mark.parametrize("land", [hill, valley, slope])
def test_streets_follow_the_land_instead_of_moving_it(tmp_path, land):
    path = written(tmp_path / "land.tif", land)
    city = town_on(path)
    moved = earth(city, path, land)
    assert np.percentile(moved, 95) <= 3.0
    assert moved.max() <= 8.0
    usual = town(replace(city, survey=None), width=500.0, depth=500.0)
    assert earth(usual, path, land).max() > 8.0
    by_land, as_usual = (climbs(one.layout, land) for one in (city, usual))
    assert np.percentile(by_land, 95) < 0.75 * np.percentile(as_usual, 95)
    assert city.layout.roads.geometry.length.sum() > 1500
    assert any("its streets move up to" in note for note in city.notes)


@pytest.mark.parametrize("pattern", ["grid", "organic", "radial"])
def test_a_pattern_that_is_asked_for_follows_the_land_too(tmp_path, pattern):
    path = written(tmp_path / "land.tif", slope)
    moved = earth(city := town_on(path, pattern=pattern), path, slope)
    assert np.percentile(moved, 95) <= 3.0
    assert moved.max() <= 8.0
    assert len(city.layout.buildings) > 10


@pytest.mark.parametrize("height", [0.2, 40.0, 800.0])
def test_a_town_on_level_heights_is_as_without_them(tmp_path, height):
    path = written(tmp_path / "level.tif", lambda x, y: height + 0.01 * x + 0 * y)
    city = read_sources(Inputs((), (Input(path, "height"),)), HowToRead()).city
    one = town(city, width=300.0, depth=300.0).layout
    other = town(replace(city, survey=None), width=300.0, depth=300.0).layout
    for table in ("buildings", "roads", "areas", "points"):
        assert getattr(one, table).equals(getattr(other, table))


def test_the_same_land_gives_the_same_town(tmp_path):
    path = written(tmp_path / "land.tif", hill)
    one, other = town_on(path).layout, town_on(path).layout
    for table in ("buildings", "roads", "areas"):
        assert getattr(one, table).equals(getattr(other, table))


def level_sea(x, y):
    return np.where(x > 80, 0.0, 1 + 0.05 * (80 - x) + 0 * y)


def void_sea(x, y):
    return np.where(y < -60, np.nan, 0.5 + 0.02 * (y + 60) + 0 * x)


def bay(x, y):
    away = np.hypot(x - 300, y - 300)
    return np.where(away < 260, 0.0, 0.1 + 0.04 * (away - 260))


@pytest.mark.parametrize("land", [level_sea, void_sea, bay])
def test_the_sea_of_a_tile_is_water_and_bears_no_town(tmp_path, land):
    layout = (city := town_on(written(tmp_path / "coast.tif", land))).layout
    sea = layout.areas[layout.areas["kind"] == "sea"].geometry
    x, y = np.meshgrid(np.arange(-247.5, 250, 5), np.arange(-247.5, 250, 5))
    wet = ~(land(x, y) > 0)
    assert sea.area.sum() == pytest.approx(25 * wet.sum(), rel=0.05)
    assert any("of the site is sea" in note for note in city.notes)
    assert not layout.buildings.intersects(sea.union_all().buffer(-1)).any()
    assert not layout.roads.intersects(sea.union_all().buffer(-1)).any()
    assert len(layout.buildings) > 10


def polder(x, y):
    return -3 + 2 * np.sin(x / 25) * np.cos(y / 31)


def lake_at_zero(x, y):
    return np.where(np.hypot(x, y) < 60, 0.0, 2 + 0.02 * np.hypot(x, y))


@pytest.mark.parametrize("land", [polder, lake_at_zero, hill])
def test_low_land_that_is_no_sea_stays_land(tmp_path, land):
    layout = town_on(written(tmp_path / "low.tif", land)).layout
    assert "sea" not in set(layout.areas["kind"])


@pytest.mark.parametrize("wide", [20, 120, 200])
def test_nothing_stands_in_a_wide_void(tmp_path, wide):
    def torn(x, y):
        return np.where((np.abs(x) < wide / 2) & (y > 0), np.nan, 150 + 0.02 * x)

    city = town_on(written(tmp_path / "torn.tif", torn))
    layout = city.layout
    void = layout.areas[layout.areas["kind"] == "void"].geometry.union_all()
    assert void.is_empty == (wide < 80)
    assert not layout.buildings.intersects(void.buffer(-1)).any()
    assert any("of the site is void" in note for note in city.notes) == (wide >= 80)


def test_a_tile_with_sea_is_built_as_a_town(tmp_path):
    path = written(tmp_path / "coast.tif", level_sea)
    options = BuildOptions(size=(300.0, 300.0), lod=0, render=False, formats=())
    build([path], tmp_path / "out", options)
    layout = read_city(tmp_path / "out" / "city").layout
    assert layout.area_km2 == pytest.approx(0.09)
    assert len(layout.buildings) > 3
    assert "sea" in set(layout.areas["kind"])
