import numpy as np
import pytest
import rasterio
from affine import Affine

from cityx.city import Frame
from cityx.errors import InputError, UsageError
from cityx.sources.heights.height_field import read_height, survey_site, void_notes
from cityx.sources.heights.height_files import HeightOptions, open_height
from cityx.sources.heights.height_mosaic import open_heights, raster_of, strays_of

FRAME = Frame(52.5, 13.5)
SITE = (-200.0, -200.0, 200.0, 200.0)
RANGE = HeightOptions(span=(10.0, 110.0))
PLACED = {"crs": "EPSG:25833", "transform": Affine(5, 0, 396_600, 0, -5, 5_819_000)}


def ramp(count=41, high=1.0):
    """Heights that rise to the north, first row north."""
    return np.tile(np.linspace(high, 0, count)[:, None], (1, count))


def raster(path, values, **profile):
    """Write a TIFF or a PNG, without a place unless the profile names one."""
    bands = values if values.ndim == 3 else values[None]
    driver = "PNG" if path.suffix == ".png" else "GTiff"
    with rasterio.open(
        path, "w", driver=driver, count=len(bands), height=bands.shape[1], width=bands.shape[2],
        dtype=bands.dtype, **profile,
    ) as dataset:  # fmt: skip
        dataset.write(bands)
    return path


def array(path, values):
    np.save(path, values)
    return path


FORMS = {
    "a.png": lambda p: raster(p, np.rint(ramp() * 65535).astype(np.uint16)),
    "a.tif": lambda p: raster(p, np.rint(ramp() * 255).astype(np.uint8)),
    "f.npy": lambda p: array(p, ramp()),
    "i.npy": lambda p: array(p, np.rint(ramp() * 1000).astype(np.int32)),
}


@pytest.mark.filterwarnings("ignore::rasterio.errors.NotGeoreferencedWarning")
@pytest.mark.parametrize("name", FORMS)
def test_forms_without_a_place_lie_over_the_site_and_take_its_range(name, tmp_path):
    path = FORMS[name](tmp_path / name)
    terrain = read_height(path, FRAME, SITE, options=RANGE)
    south, middle, north = terrain.height_at([(0, -195), (0, 0), (0, 195)]) + terrain.datum
    assert [south, middle, north] == pytest.approx([10, 60, 110], abs=0.6)
    with pytest.raises(UsageError, match="--height-range LOW,HIGH"):
        read_height(path, FRAME, SITE)


def test_the_cells_of_a_file_without_a_place_can_be_measured(tmp_path):
    path = array(tmp_path / "a.npy", ramp(high=100.0))
    terrain = read_height(path, FRAME, SITE, options=HeightOptions(pixel=20.0))
    south, north = terrain.height_at([(0, -100), (0, 100)])
    assert north - south == pytest.approx(100 * 200 / (20 * 40), abs=0.1)


@pytest.mark.filterwarnings("ignore::rasterio.errors.NotGeoreferencedWarning")
def test_terraces_of_few_values_become_a_slope(tmp_path):
    path = raster(tmp_path / "a.tif", np.rint(ramp(401) * 20).astype(np.uint8))
    terrain, survey = survey_site(path, FRAME, SITE, options=RANGE)
    y = np.arange(-150.0, 150.0)
    heights = terrain.height_at(np.column_stack([np.zeros_like(y), y])) + terrain.datum
    assert np.abs(heights - (60 + y / 4)).max() < 1.5  # a terrace has five metres
    assert np.diff(heights).max() < 0.5
    error = np.abs(terrain.height_at(survey.points[:, :2]) - survey.points[:, 2])
    assert error.max() <= survey.bound


def test_feet_and_scaled_numbers_become_metres(tmp_path):
    path = raster(tmp_path / "a.tif", np.full((600, 600), 100, np.int16), **PLACED)
    with rasterio.open(path, "r+") as dataset:
        dataset.units, dataset.scales, dataset.offsets = ("foot",), (0.5,), (10.0,)
    assert read_height(path, FRAME, SITE).datum == pytest.approx(60 * 0.3048, abs=1e-3)


def test_a_vertical_datum_is_named(tmp_path):
    profile = {**PLACED, "crs": "EPSG:25833+7837"}
    path = raster(tmp_path / "a.tif", np.zeros((300, 300), np.float32), **profile)
    assert "DHHN2016" in open_height(path).datum


def test_neighbours_are_joined_without_a_seam(tmp_path):
    x = np.arange(600.0)
    values = np.tile(x, (600, 1)).astype(np.float32)
    split = 282  # the site lies on both sides
    west = raster(tmp_path / "w.tif", values[:, :split], **PLACED)
    moved = Affine(5, 0, 396_600 + 5 * split, 0, -5, 5_819_000)
    east = raster(tmp_path / "e.tif", values[:, split:], crs="EPSG:25833", transform=moved)
    whole = raster(tmp_path / "all.tif", values, **PLACED)
    both, one = (read_height(paths, FRAME, SITE) for paths in ([east, west], whole))
    assert np.abs(both.heights - one.heights).max() < 1e-6
    with pytest.raises(InputError, match="does not cover the site"):
        read_height(west, FRAME, (300.0, -200.0, 900.0, 200.0))


def test_a_finer_file_goes_before_a_coarser_one_of_another_system(tmp_path):
    near = np.full((300, 300), 50, np.float32)
    near[:, 282:] = np.nan
    fine = raster(tmp_path / "fine.tif", near, **PLACED)
    world = {"crs": "EPSG:4326", "transform": Affine(0.001, 0, 13.4, 0, -0.001, 52.6)}
    coarse = raster(tmp_path / "coarse.tif", np.full((200, 200), 80, np.float32), **world)
    terrain = read_height([coarse, fine], FRAME, SITE)
    west, east = terrain.height_at([(-190, 0), (190, 0)]) + terrain.datum
    assert [west, east] == pytest.approx([50, 80], abs=1.0)


def test_a_grid_without_a_system_takes_that_of_a_file_on_its_cells(tmp_path):
    raster(tmp_path / "a.tif", np.zeros((40, 50), np.float32), **PLACED)
    header = "ncols 50\nnrows 40\nxllcorner 396600\nyllcorner 5818800\ncellsize 5\n"
    (tmp_path / "b.asc").write_text(header + "3 " * 2000)
    files = open_heights([tmp_path / "b.asc", tmp_path / "a.tif"])
    assert all(file.located for file in files)
    named = HeightOptions(crs="EPSG:25833")
    assert open_height(tmp_path / "b.asc", named).located
    with pytest.raises(InputError, match="--height-crs is no coordinate system"):
        open_height(tmp_path / "b.asc", HeightOptions(crs="nonsense"))


def test_of_a_giant_only_the_site_is_read(tmp_path):
    path = tmp_path / "giant.tif"
    profile = {"width": 30_000, "height": 30_000, "count": 1, "dtype": "float32", "nodata": 0}
    place = {"crs": "EPSG:25833", "transform": Affine(1, 0, 380_000, 0, -1, 5_830_000)}
    with rasterio.open(
        path, "w", driver="GTiff", tiled=True, sparse_ok=True, **profile, **place
    ) as dataset:
        window = rasterio.windows.Window(17_000, 10_500, 2_000, 2_500)
        dataset.write(np.full((1, 2_500, 2_000), 7, np.float32), window=window)
    terrain = read_height(path, FRAME, SITE)
    assert terrain.is_flat
    assert terrain.datum == 7


def test_a_large_window_is_read_as_means_of_blocks(tmp_path):
    values = ramp(400, 100.0).astype(np.float32)
    file = open_height(raster(tmp_path / "a.tif", values, **PLACED))
    means = file.read((slice(3, 103), slice(0, 400)), 10)
    assert means.shape == (10, 40)
    assert np.abs(means - values[3:103].reshape(10, 10, 40, 10).mean(axis=(1, 3))).max() < 1e-4


def objects(path):
    np.save(path, np.array([[{}, "x"]], object), allow_pickle=True)
    return path


def giant(path):
    profile = {"width": 30_000, "height": 30_000, "count": 1, "dtype": "uint8"}
    with rasterio.open(path, "w", driver="GTiff", tiled=True, sparse_ok=True, **profile):
        return path


def text(content):
    def write(path):
        path.write_text(content)
        return path

    return write


BAD = {
    "nan.npy": (lambda p: array(p, np.full((9, 9), np.nan)), "every cell is void"),
    "one.npy": (lambda p: array(p, np.ones((1, 1))), "1 x 1 cells; heights need 2 x 2"),
    "objects.npy": (objects, "no array of numbers"),
    "cube.npy": (lambda p: array(p, np.ones((3, 3, 3))), r"shape \(3, 3, 3\)"),
    "words.npy": (lambda p: array(p, np.array([["a", "b"]])), "type <U1"),
    "giant.tif": (giant, "30,000 x 30,000 cells; a file of its form can have"),
    "text.tif": (text("these are no heights"), "no height file that can be read"),
    "text.npy": (text("these are no heights"), "no array of numbers"),
    "colour.png": (lambda p: raster(p, np.zeros((3, 9, 9), np.uint8)), "image of 3 bands"),
    "complex.tif": (
        lambda p: raster(p, np.zeros((9, 9), np.complex64), **PLACED), "complex64 numbers",
    ),
    "nowhere.tif": (
        lambda p: raster(p, np.ones((9, 9), np.float32), **{**PLACED, "crs": "EPSG:4326"}),
        "no place on Earth by its coordinate system",
    ),
    "wrong.tif": (
        lambda p: raster(p, np.ones((600, 600), np.float32), **{**PLACED, "crs": "EPSG:25831"}),
        "does not cover the site",
    ),
    "gone.tif": (lambda p: p, "does not exist"),
}  # fmt: skip


@pytest.mark.filterwarnings("ignore::rasterio.errors.NotGeoreferencedWarning")
@pytest.mark.parametrize("name", BAD)
def test_what_holds_no_heights_of_the_site_is_refused_in_words(name, tmp_path):
    make, words = BAD[name]
    with pytest.raises(InputError, match=words):
        read_height(make(tmp_path / name), FRAME, SITE)


def test_every_fault_of_several_files_is_said_at_once(tmp_path):
    with pytest.raises(InputError, match=r"a\.tif does not exist.*b\.tif does not exist"):
        open_heights([tmp_path / "a.tif", tmp_path / "b.tif"])


@pytest.mark.parametrize("options", [{"span": (5.0, 5.0)}, {"span": (0.0, 1e9)}, {"pixel": -1.0}])
def test_options_without_sense_are_refused(options):
    with pytest.raises(UsageError, match=r"--height-range|--pixel"):
        HeightOptions(**options)


# Half the side of a site in the middle of each file, metres.
FILES = {
    "N04E034.SRTMGL3.hgt.zip": 2000, "N41E001.hgt.zip": 2000, "N42E001.hgt.zip": 2000,
    "N52E008.hgt.zip": 2000, "N52E013.hgt": 2000, "S29W072.hgt.zip": 2000,
    "alexandria_va_dsm.tif": 200, "alexandria_va_dtm.tif": 200, "alexandria_va_hag.tif": 200,
    "bilbao_building_heights.tif": 500, "bilbao_canopy_heights.tif": 500, "bilbao_dem.tif": 1000,
    "goteborg_kronenhuset_canopy.asc": 90, "goteborg_kronenhuset_dem.tif": 90,
    "goteborg_kronenhuset_dsm.tif": 90, "porto_alegre_elevation.tif": 2000,
    "san_francisco_elevation1.tif": 200, "san_francisco_elevation2.tif": 200,
}  # fmt: skip


@pytest.mark.shared
@pytest.mark.parametrize("name", FILES)
def test_every_shared_file_is_the_terrain_of_a_site_within_it(name, shared_height):
    from cityx.sources.heights.height_mosaic import corners

    path, options = shared_height(name), HeightOptions(crs="EPSG:3007")
    longitude, latitude = corners(open_height(path, options)).mean(axis=0)
    half = FILES[name]
    site = (-half, -half, half, half)
    terrain, survey = survey_site(path, Frame(latitude, longitude), site, options=options)
    assert np.isfinite(terrain.heights).all()
    assert len(survey.points) > 100
    error = np.abs(terrain.height_at(survey.points[:, :2]) - survey.points[:, 2])
    assert error.max() <= survey.bound + 0.05  # the border lies between cells


@pytest.mark.shared
def test_the_two_halves_of_san_francisco_are_one_terrain(shared_height):
    halves = [shared_height(f"san_francisco_elevation{k}.tif") for k in (1, 2)]
    frame, site = Frame(37.7953, -122.4029), (-400.0, -400.0, 400.0, 400.0)
    terrain, survey = survey_site(halves, frame, site)
    error = np.abs(terrain.height_at(survey.points[:, :2]) - survey.points[:, 2])
    assert error.max() <= survey.bound
    assert np.ptp(terrain.heights) > 40


def hills(count=80, low=500.0, rise=60.0):
    x = np.linspace(0, 3, count)
    return (low + rise * (1 + np.sin(x)[:, None] * np.cos(x)) / 2).astype(np.float32)


BROKEN = {
    "a row of -9999": lambda v: v.__setitem__((40, slice(None)), -9999),
    "half of it -9999": lambda v: v.__setitem__(slice(45, None), -9999),
    "one cell of -999": lambda v: v.__setitem__((30, 41), -999),
    "one cell of 8848": lambda v: v.__setitem__((41, 40), 8848),
    "cells of 0 in the hills": lambda v: v.__setitem__((slice(39, 42), 40), 0),
    "broken cells of several values": lambda v: v.__setitem__(
        (40, slice(38, 42)), [-3000, 7000, -777.5, 2500]
    ),
}


@pytest.mark.parametrize("name", BROKEN)
def test_values_far_outside_the_rest_are_no_heights(name, tmp_path):
    values = hills()
    BROKEN[name](values)
    wrong = int(((values < 450) | (values > 600)).sum())
    place = {"crs": "EPSG:25833", "transform": Affine(10, 0, 397_778, 0, -10, 5_818_110)}
    path = raster(tmp_path / "a.tif", values, **place)
    file = open_height(path)
    joined = raster_of([file], FRAME, SITE)
    assert np.nanmin(joined.values) >= 499
    assert np.nanmax(joined.values) <= 561
    if wrong < 200:
        terrain = read_height(path, FRAME, SITE)
        assert terrain.heights.max() < 62
    notes = void_notes([file], FRAME, SITE)
    assert any("void" in note for note in notes)


@pytest.mark.parametrize("rise", [0.0, 30.0, 2500.0])
def test_land_and_towers_are_heights(rise):
    values = hills(low=2.0, rise=rise)
    values[40:43, 40:43] = values.max() + 300  # a tower in a surface
    values[:4] = 0.0  # the sea
    assert strays_of(values) == ()
