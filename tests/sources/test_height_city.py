import numpy as np
import pytest
import rasterio
import shapely
from affine import Affine

from cityx.city import Frame
from cityx.errors import InputError
from cityx.options import HowToRead
from cityx.sources.heights.height_files import HeightOptions, open_height
from cityx.sources.heights.height_kinds import Shows, kind_of
from cityx.sources.heights.height_source import height_city, lay_terrain, place_of, read_heights
from cityx.sources.heights.measured_heights import heights_from_surface
from cityx.sources.intake import read_sources, sort_inputs

FRAME = Frame(52.5, 13.4)
SIZE = 300  # metres and cells of a side, about the origin
PITCH, BLOCK = 60, 44  # metres from block to block, and of a block


def ground():
    """A slope of 4 % to the north."""
    return np.tile(np.linspace(12, 0, SIZE)[:, None], (1, SIZE)) + 30


def standing():
    """Rows of houses 9 and 15 m high round yards, streets of 16 m, trees in the yards."""
    above = np.zeros((SIZE, SIZE))
    rng = np.random.default_rng(3)
    for row in range(8, SIZE - BLOCK, PITCH):
        for column in range(8, SIZE - BLOCK, PITCH):
            above[row : row + BLOCK, column : column + 22] = 9
            above[row : row + BLOCK, column + 22 : column + BLOCK] = 15
            above[row + 12 : row + 32, column + 12 : column + 32] = 0
            above[row + 18 : row + 26, column + 18 : column + 26] = rng.uniform(3, 9, (8, 8))
    return above


def tif(path, values, frame=FRAME):
    profile = {"driver": "GTiff", "width": SIZE, "height": SIZE, "count": 1, "dtype": "float32"}
    place = Affine(1, 0, -SIZE / 2, 0, -1, SIZE / 2)
    with rasterio.open(path, "w", **profile, crs=frame.projection, transform=place) as dataset:
        dataset.write(values.astype(np.float32), 1)
    return path


@pytest.fixture
def files(tmp_path):
    return {
        "dsm": tif(tmp_path / "dsm.tif", ground() + standing()),
        "dtm": tif(tmp_path / "dtm.tif", ground()),
        "hag": tif(tmp_path / "hag.tif", standing()),
    }


def test_what_a_file_shows_is_told_from_its_numbers(files):
    kinds = {name: kind_of(open_height(path)).shows for name, path in files.items()}
    assert kinds == {"dsm": Shows.SURFACE, "dtm": Shows.TERRAIN, "hag": Shows.ABOVE}


@pytest.mark.parametrize("names", [("dsm", "dtm"), ("dsm",), ("hag", "dtm"), ("hag",)])
def test_a_surface_becomes_a_city(files, names):
    heights = read_heights([files[name] for name in names])
    city = height_city(heights, seed=1)
    blocks = 25
    area = (standing() > 8.5).sum()
    assert len(city.layout.buildings) == 2 * blocks
    assert city.layout.buildings.geometry.area.sum() == pytest.approx(area, rel=0.05)
    height = np.sort(city.layout.buildings["height"].to_numpy())
    assert np.abs(height - np.repeat([9, 15], blocks)).max() < 1.3
    assert len(city.layout.points) == blocks  # the trees
    roads = city.layout.roads
    assert 2000 < roads.geometry.length.sum() < 3600
    houses = shapely.union_all(city.layout.buildings.geometry.to_numpy())
    assert shapely.area(shapely.intersection(roads.geometry.union_all().buffer(2), houses)) < 20
    if "dsm" in names or "dtm" in names:
        assert np.ptp(city.terrain.height_at([(0, -140), (0, 140)])) == pytest.approx(11.2, abs=1)
    else:
        assert city.terrain.is_flat
        assert any("no file says how the ground lies" in note for note in city.notes)


def test_the_same_files_and_seed_give_the_same_city(files):
    first, second = (height_city(read_heights(files["dsm"]), seed=4) for _ in range(2))
    for name in ("buildings", "parts", "roads", "points"):
        assert getattr(first.layout, name).equals(getattr(second.layout, name))
    assert (first.terrain.heights == second.terrain.heights).all()


def test_bare_ground_makes_no_city_but_says_its_place(files):
    heights = read_heights(files["dtm"])
    assert not heights.has_houses
    with pytest.raises(InputError, match=r"No height file shows a house .*dtm\.tif is taken for"):
        height_city(heights)
    frame, box = place_of(heights)
    assert (frame.latitude, frame.longitude) == pytest.approx((52.5, 13.4), abs=1e-4)
    assert box == pytest.approx((-150, -150, 150, 150), abs=1)


def test_a_surface_without_a_place_stands_where_it_is_told(tmp_path):
    np.save(tmp_path / "dsm.npy", (ground() + standing()).astype(np.float32))
    heights = read_heights(tmp_path / "dsm.npy", HeightOptions(pixel=1.0))
    city = height_city(heights, at=(48.0, 2.0))
    assert (city.frame.latitude, city.frame.longitude) == (48.0, 2.0)
    assert len(city.layout.buildings) == 50
    assert any("does not say where it lies" in note for note in city.notes)


def test_cells_that_nobody_measured_show_no_houses(tmp_path):
    np.save(tmp_path / "dsm.npy", (ground() + standing()).astype(np.float32))
    heights = read_heights(tmp_path / "dsm.npy")
    assert not heights.has_houses
    assert "--pixel says their metres" in heights.notes[0]


def test_a_country_is_refused_with_the_limit(tmp_path):
    file = tmp_path / "dsm.tif"
    profile = {"driver": "GTiff", "width": 8000, "height": 8000, "count": 1, "dtype": "float32"}
    with rasterio.open(
        file, "w", **profile, tiled=True, sparse_ok=True, crs=FRAME.projection,
        transform=Affine(1, 0, -4000, 0, -1, 4000),
    ) as dataset:  # fmt: skip
        middle = rasterio.windows.Window(4000, 4000, SIZE, SIZE)
        dataset.write((ground() + standing()).astype(np.float32), 1, window=middle)
    with pytest.raises(InputError, match="houses are drawn on 6,000 m"):
        height_city(read_heights(file))


def test_a_map_takes_the_heights_of_a_surface_where_it_says_none(files, drawing):
    drawing.box(-142, 98, 22, 44, building="yes")  # 9 m high, a yard bites into it
    drawing.box(-120, 98, 22, 44, building="yes")  # 15 m
    drawing.box(-82, 98, 22, 44, building="yes", height="30")
    drawing.way([(-150, 92), (150, 92)], highway="residential")
    city = drawing.city()
    for names in (("dsm", "dtm"), ("dsm",)):
        found = heights_from_surface(city, read_heights([files[name] for name in names]))
        height = np.sort(found.layout.buildings["height"].to_numpy())
        assert height == pytest.approx([9, 15, 30], abs=1.5)
        assert np.sort(found.layout.parts["top"].to_numpy()) == pytest.approx(height)
        assert any("2 of 3 buildings have the height" in note for note in found.notes)
    levels = found.layout.buildings.sort_values("height")["levels"].tolist()
    assert 2 <= levels[0] <= 3 < levels[1] <= 6


def test_the_error_of_a_surface_is_told_where_the_map_says_heights(files, drawing):
    for row in range(4):
        for column in range(2):
            drawing.box(
                -142 + 60 * row, 98 - 60 * column, 22, 44, building="yes", height="10"
            )  # 9 m
    city = heights_from_surface(drawing.city(), read_heights([files["dsm"], files["dtm"]]))
    assert any("8 whose height the map says it misses by 1.0 m" in note for note in city.notes)


def test_terrain_is_laid_under_any_city(files, drawing):
    drawing.box(-100, -100, 200, 200, building="yes")
    city = lay_terrain(drawing.city(), read_heights(files["dtm"]))
    assert city.survey is not None
    assert np.ptp(city.terrain.height_at([(0, -90), (0, 90)])) == pytest.approx(7.2, abs=0.3)
    assert not any("misses" in note for note in city.notes)  # that is of the ground once built


KINDS = {
    "alexandria_va_dsm.tif": "surface", "alexandria_va_dtm.tif": "terrain",
    "alexandria_va_hag.tif": "above ground", "bilbao_building_heights.tif": "above ground",
    "bilbao_canopy_heights.tif": "canopy", "bilbao_dem.tif": "terrain",
    "goteborg_kronenhuset_canopy.asc": "canopy", "goteborg_kronenhuset_dem.tif": "terrain",
    "goteborg_kronenhuset_dsm.tif": "surface", "N42E001.hgt.zip": "terrain",
    "porto_alegre_elevation.tif": "terrain", "san_francisco_elevation1.tif": "terrain",
}  # fmt: skip


@pytest.mark.shared
@pytest.mark.parametrize("name", KINDS)
def test_the_kinds_of_the_shared_files_are_told(name, shared_height):
    file = open_height(shared_height(name), HeightOptions(crs="EPSG:3007"))
    assert kind_of(file).shows == KINDS[name]


@pytest.mark.shared
def test_alexandria_stands_on_its_ground(shared_height):
    paths = [shared_height(f"alexandria_va_{word}.tif") for word in ("dsm", "dtm")]
    city = height_city(read_heights(paths), seed=1)
    assert 100 < len(city.layout.buildings) < 250
    assert 4000 < city.layout.roads.geometry.length.sum() < 9000
    assert 20 < city.layout.buildings["height"].max() < 30
    assert city.survey is not None


def test_heights_of_the_ground_alone_say_how_far_a_town_may_reach(files):
    found = read_sources(sort_inputs([files["dtm"]]), HowToRead())
    assert np.allclose(found.city.layout.extent, (-150.0, -150.0, 150.0, 150.0), atol=1.0)
    assert not len(found.city.layout.buildings)
