import zipfile

import numpy as np
import pytest
import rasterio
from affine import Affine

from cityx.city import Frame
from cityx.errors import InputError
from cityx.sources.heights.height_field import SMOOTHED, read_height, survey_site

FRAME = Frame(52.5, 13.5)
SITE = (-200.0, -200.0, 200.0, 200.0)


def slope(lon, lat):
    """Heights that rise to the east and the north."""
    return 50 + 1000 * (lon - 13.5) + 2000 * (lat - 52.5)


def tile(values):
    return values.astype(">i2").tobytes()


def geotiff(path, values, crs="EPSG:25833", west=396_600.0, north=5_819_000.0, cell=5.0):
    profile = {"driver": "GTiff", "width": values.shape[1], "height": values.shape[0], "count": 1}
    profile |= {"dtype": values.dtype, "transform": Affine(cell, 0, west, 0, -cell, north)}
    with rasterio.open(path, "w", **profile, crs=crs) as dataset:
        dataset.write(values, 1)
    return path


def hgt(folder, name="N52E013.hgt", base=100):
    values = np.full((1201, 1201), base)
    values += np.arange(1201)[::-1, None] // 4  # rises to the north
    (folder / name).write_bytes(tile(values))
    return folder / name


def test_a_tile_gives_heights_above_the_lowest_point_of_the_site(tmp_path):
    terrain = read_height(hgt(tmp_path), FRAME, SITE)
    assert terrain.heights.min() == 0
    assert terrain.datum == pytest.approx(100 + 600 / 4, abs=2)
    south, north = terrain.height_at([(0, -190), (0, 190)])
    assert north - south == pytest.approx(380 / 92.8 / 4, abs=0.3)


def test_windows_of_one_run_have_the_same_heights(tmp_path):
    row, column = np.mgrid[0:600, 0:600]
    hills = np.rint(300 + 40 * np.sin(row / 31) * np.cos(column / 23))  # in whole metres
    path = geotiff(tmp_path / "dem.tif", hills.astype(np.int16))
    whole = read_height(path, FRAME, (-600.0, -600.0, 600.0, 600.0))
    given = {"cell": whole.cell, "datum": whole.datum}
    xy = np.random.default_rng(1).uniform(-150, 150, (2000, 2))
    for window in (SITE, (-171.3, -233.1, 520.0, 157.9)):
        terrain = read_height(path, FRAME, window, **given)
        assert terrain.height_at(xy) == pytest.approx(whole.height_at(xy), abs=1e-9)


def test_a_packed_tile_reads_like_a_plain_one(tmp_path):
    plain = hgt(tmp_path)
    packed = tmp_path / "N52E013.SRTMGL3.hgt.zip"
    with zipfile.ZipFile(packed, "w") as archive:
        archive.write(plain, "N52E013.hgt")
    first, second = (read_height(path, FRAME, SITE) for path in (plain, packed))
    assert (first.heights == second.heights).all()


def test_voids_are_filled_from_their_border(tmp_path):
    path = hgt(tmp_path)
    values = np.frombuffer(path.read_bytes(), ">i2").reshape(1201, 1201).copy()
    values[600:603, 600:602] = -32768
    path.write_bytes(tile(values))
    terrain = read_height(path, FRAME, SITE)
    assert terrain.datum > 240
    assert terrain.heights.max() < 5


def test_a_projected_grid_is_sampled_where_it_lies(tmp_path):
    # Columns rise by one metre per 5 m to the east in UTM 33.
    values = np.tile(np.arange(600, dtype=np.float32), (600, 1))
    path = geotiff(tmp_path / "dem.tif", values)
    terrain = read_height(path, FRAME, SITE, cell=10.0)
    west, east = terrain.height_at([(-150, 0), (150, 0)])
    assert east - west == pytest.approx(60, rel=0.02)
    assert terrain.cell == 10


def test_ascii_grids_in_degrees_need_no_coordinate_system(tmp_path):
    cell, count = 0.0005, 60
    lon = 13.485 + cell * (np.arange(count) + 0.5)
    lat = 52.485 + cell * (np.arange(count) + 0.5)[::-1]
    values = slope(*np.meshgrid(lon, lat))
    header = f"ncols {count}\nnrows {count}\nxllcorner 13.485\nyllcorner 52.485\ncellsize {cell}\n"
    path = tmp_path / "dem.asc"
    path.write_text(header + "\n".join(" ".join(map(str, row)) for row in values))
    terrain = read_height(path, FRAME, SITE)
    expected = slope(*FRAME.to_geographic([(30, 70)])[0])
    assert terrain.height_at([(30, 70)])[0] + terrain.datum == pytest.approx(expected, abs=0.05)


def test_ascii_grids_in_metres_need_a_projection_file(tmp_path):
    header = "ncols 200\nnrows 200\nxllcorner 397600\nyllcorner 5817000\ncellsize 10\n"
    path = tmp_path / "dem.asc"
    path.write_text(header + "7 " * 40_000)
    with pytest.raises(InputError, match=r"put its \.prj file beside it, name it"):
        read_height(path, FRAME, SITE)
    path.with_suffix(".prj").write_text(rasterio.crs.CRS.from_epsg(25833).to_wkt())
    terrain = read_height(path, FRAME, SITE)
    assert terrain.is_flat
    assert terrain.datum == 7


def test_a_file_of_another_place_is_refused_with_both_places(tmp_path):
    with pytest.raises(InputError, match=r"file lies at 9\.9996.*site at 13\.4973"):
        read_height(hgt(tmp_path, "N52E010.hgt"), FRAME, SITE)


BROKEN = {
    "short.hgt": b"abc", "N52E013.hgt": b"abc" * 10, "nowhere.hgt": bytes(1201 * 1201 * 2),
    "text.tif": b"hello", "empty.asc": b"", "words.asc": b"ncols x", "few.asc": b"ncols 2\nnrows 2",
    "N52E013.hgt.zip": b"PK\x05\x06" + bytes(18),
}  # fmt: skip


@pytest.mark.parametrize("name", BROKEN)
def test_broken_files_are_refused(name, tmp_path):
    path = tmp_path / name
    path.write_bytes(BROKEN[name])
    with pytest.raises(InputError):
        read_height(path, FRAME, SITE)


def test_pictures_and_empty_tiles_are_refused(tmp_path):
    path = tmp_path / "N52E013.hgt"
    path.write_bytes(tile(np.full((1201, 1201), -32768)))
    with pytest.raises(InputError, match="no heights for 100% of the site"):
        read_height(path, FRAME, SITE)
    picture = tmp_path / "rgb.tif"
    profile = {"driver": "GTiff", "width": 4, "height": 4, "count": 3, "dtype": "uint8"}
    transform = Affine(0.1, 0, 13, 0, -0.1, 53)
    with rasterio.open(picture, "w", **profile, crs="EPSG:4326", transform=transform) as dataset:
        dataset.write(np.zeros((3, 4, 4), np.uint8))
    with pytest.raises(InputError, match="image of 3 bands"):
        read_height(picture, FRAME, SITE)


def rough(folder):
    """Write a tile of whole metres with steep and with noisy places."""
    values = np.random.default_rng(1).integers(0, 4, (1201, 1201))
    values += 40 * (np.arange(1201) // 3 % 2)  # walls
    (folder / "N52E013.hgt").write_bytes(tile(values))
    return folder / "N52E013.hgt"


def test_the_terrain_keeps_within_its_stated_bound_of_the_cells_of_the_file(tmp_path):
    terrain, survey = survey_site(rough(tmp_path), FRAME, SITE)
    assert len(survey.points) > 20
    error = np.abs(terrain.height_at(survey.points[:, :2]) - survey.points[:, 2])
    assert error.max() <= survey.bound < SMOOTHED + 0.5
    assert error.max() > 0.1  # steps of a metre are smoothed away


def test_the_survey_of_smooth_heights_is_exact_and_reaches_beyond_the_site(tmp_path):
    slope = np.tile(np.arange(600, dtype=np.float32) / 7, (600, 1))
    terrain, survey = survey_site(geotiff(tmp_path / "dem.tif", slope), FRAME, SITE)
    error = np.abs(terrain.height_at(survey.points[:, :2]) - survey.points[:, 2])
    assert error.max() < 0.01
    places = [[-900.0, 0.0], [900.0, 0.0]]
    assert np.ptp(survey.around.height_at(places)) == pytest.approx(1800 / 5 / 7, rel=0.02)
    assert abs(survey.around.height_at([[0, 0]]) - terrain.height_at([[0, 0]]))[0] < 0.02


@pytest.mark.shared
def test_a_mountain_country_has_mountains(shared_height):
    terrain = read_height(
        shared_height("N42E001.hgt.zip"), Frame(42.55, 1.6), (-9000.0, -9000.0, 9000.0, 9000.0)
    )
    assert 1200 < terrain.heights.max() < 2500
    # Smoothed: no metre steps between neighbouring nodes on gentle ground.
    assert len(np.unique(terrain.heights.round(2))) > 10_000
