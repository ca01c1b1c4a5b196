"""What may be handed in as a semantic map, and what is said of files that are none."""

import struct
import zlib

import numpy as np
import pytest
import rasterio
from PIL import Image
from rasterio.transform import Affine

from cityx.errors import InputError
from cityx.sources.input_kinds import classify
from cityx.sources.semantic_map import read_semantic_map
from cityx.sources.semantic_map.legends import PRESETS
from cityx.sources.semantic_map.picture import read_picture
from cityx.sources.semantic_map.proposal import is_semantic

ROAD, HOUSE, GRASS = (0x8C, 0x8C, 0x96), (0xC8, 0x3C, 0x3C), (0xA0, 0xD2, 0x78)


def town(values=(GRASS, ROAD, HOUSE), size=200):
    """A street of 8 m and four houses of 20 by 12 m at half a metre per pixel."""
    grass, road, house = (np.array(value) for value in values)
    picture = np.zeros((size, size, *grass.shape), np.int64) + grass
    picture[92:108] = road
    for y, x in ((40, 30), (40, 120), (130, 30), (130, 120)):
        picture[y : y + 24, x : x + 40] = house
    return picture.astype(np.uint8)


def write_tiff(path, bands, **options):
    bands = bands[None] if bands.ndim == 2 else np.moveaxis(bands, 2, 0)
    count, rows, columns = bands.shape
    with rasterio.open(
        path, "w", driver="GTiff", width=columns, height=rows, count=count, dtype=bands.dtype,
        **options,
    ) as file:  # fmt: skip
        file.write(bands)
    return path


def refused(path, **options):
    with pytest.raises(InputError) as error:
        read_semantic_map(path, **options)
    return str(error.value)


@pytest.mark.filterwarnings("ignore::rasterio.errors.NotGeoreferencedWarning")
@pytest.mark.parametrize("mode", ["RGB", "RGBA", "P", "tif", "tif rgba"])
def test_every_way_to_keep_colours_is_read(tmp_path, mode):
    path = tmp_path / ("town.tif" if "tif" in mode else "town.png")
    if mode == "tif":
        write_tiff(path, town())
    elif mode == "tif rgba":
        write_tiff(path, np.dstack([town(), np.full((200, 200), 255, np.uint8)]))
    else:
        image = Image.fromarray(town())
        image = image.quantize(3) if mode == "P" else image.convert(mode)
        image.save(path)
    city = read_semantic_map(path, pixel=0.5)
    assert len(city.layout.buildings) == 4
    assert len(city.layout.roads) == 1


@pytest.mark.filterwarnings("ignore::rasterio.errors.NotGeoreferencedWarning")
def test_a_palette_of_a_tiff_is_its_colours(tmp_path):
    path = tmp_path / "town.tif"
    values = town((0, 1, 2))
    with rasterio.open(
        path, "w", driver="GTiff", width=200, height=200, count=1, dtype="uint8"
    ) as file:
        file.write(values[None])
        file.write_colormap(1, {0: (*GRASS, 255), 1: (*ROAD, 255), 2: (*HOUSE, 255)})
    assert len(read_semantic_map(path, pixel=0.5).layout.buildings) == 4


@pytest.mark.filterwarnings("ignore::rasterio.errors.NotGeoreferencedWarning")
@pytest.mark.parametrize("dtype", [np.uint8, np.uint16, np.float32])
def test_values_are_classes_whatever_their_type(tmp_path, dtype):
    path = write_tiff(tmp_path / "cover.tif", town((5, 1, 2)).astype(dtype))
    city = read_semantic_map(path, legend="gothenburg", pixel=0.5)
    assert len(city.layout.buildings) == 4
    assert set(city.layout.areas["kind"]) == {"grass", "pedestrian"}


def test_a_georeference_says_place_and_scale(tmp_path):
    # Degrees: pixels are not square, and the map is laid on square ones.
    lat, lon = 36.14, -115.23
    step = 0.5 / 111_320
    place = Affine(step / np.cos(np.radians(lat)), 0, lon, 0, -step, lat)
    path = write_tiff(tmp_path / "town.tif", town(), crs="EPSG:4326", transform=place)
    city = read_semantic_map(path, pixel=3.0)
    assert abs(city.frame.latitude - lat) < 0.001
    assert abs(city.frame.longitude - lon) < 0.001
    xmin, ymin, xmax, ymax = city.layout.extent
    assert abs(xmax - xmin - 100) < 1
    assert abs(ymax - ymin - 100) < 1
    assert np.allclose(city.layout.buildings.geometry.area, 240, rtol=0.04)
    assert any("instead of the 3 m given" in note for note in city.notes)


def test_north_is_up(tmp_path):
    picture = np.full((100, 100, 3), GRASS, np.uint8)
    picture[10:30, 60:90] = HOUSE  # in the north-east
    Image.fromarray(picture).save(tmp_path / "one.png")
    (house,) = read_semantic_map(tmp_path / "one.png", pixel=1.0).layout.buildings.geometry
    assert house.bounds == (10.0, 20.0, 40.0, 40.0)


def test_transparent_pixels_say_nothing(tmp_path):
    picture = np.dstack([town(), np.full((200, 200), 255, np.uint8)])
    picture[:, :100, 3] = 0
    Image.fromarray(picture).save(tmp_path / "half.png")
    assert len(read_semantic_map(tmp_path / "half.png", pixel=0.5).layout.buildings) == 2


def test_files_that_are_no_picture_are_named_so(tmp_path):
    (tmp_path / "text.png").write_text("this is no picture")
    assert "is no image: its content is of no known kind" in refused(tmp_path / "text.png")
    assert "cannot read" in refused(tmp_path / "absent.png")
    Image.fromarray(town()).save(tmp_path / "town.png")
    half = (tmp_path / "town.png").read_bytes()[:400]
    (tmp_path / "cut.png").write_bytes(half)
    assert "is damaged or cut off" in refused(tmp_path / "cut.png")
    (tmp_path / "cut.tif").write_bytes(b"II*\0" + b"\1" * 60)
    assert "is damaged or cut off" in refused(tmp_path / "cut.tif")


def test_pictures_of_the_wrong_size_or_kind_are_named_so(tmp_path):
    Image.new("RGB", (1, 1)).save(tmp_path / "dot.png")
    assert "has 1 x 1 pixels; a map of a city has 8 or more" in refused(tmp_path / "dot.png")
    Image.new("1", (30_000, 30_000)).save(tmp_path / "huge.png")
    assert "64,000,000 pixels" in refused(tmp_path / "huge.png")
    Image.new("1", (9_000, 9_000)).save(tmp_path / "large.png")
    assert "has 9,000 x 9,000 pixels; at most 64,000,000" in refused(tmp_path / "large.png")
    Image.new("CMYK", (40, 40)).save(tmp_path / "print.jpg")
    assert "colours of the kind CMYK" in refused(tmp_path / "print.jpg")
    frames = [Image.fromarray(np.roll(town(), i, 0)) for i in (0, 9)]
    frames[0].save(tmp_path / "moving.gif", save_all=True, append_images=frames[1:])
    assert "is animated (2 pictures)" in refused(tmp_path / "moving.gif")


def test_a_map_without_a_city_is_refused(tmp_path):
    picture = np.full((100, 100, 3), GRASS, np.uint8)
    picture[:50] = (0x5A, 0x96, 0xDC)
    Image.fromarray(picture).save(tmp_path / "lake.png")
    text = refused(tmp_path / "lake.png")
    assert "shows no city: nothing on it is a building or a street (it shows grass, water" in text
    Image.new("RGB", (50, 50), GRASS).save(tmp_path / "plain.png")
    assert "plain.png" in refused(tmp_path / "plain.png")


def test_a_wrong_legend_is_refused_with_what_the_map_shows(tmp_path):
    Image.fromarray(town()).save(tmp_path / "town.png")
    text = refused(tmp_path / "town.png", legend="dubai")
    assert "shows nothing of the legend dubai" in text
    assert '"cityx" explains 100.0 %' in text


@pytest.mark.filterwarnings("ignore::rasterio.errors.NotGeoreferencedWarning")
def test_two_legends_that_fit_alike_are_not_guessed_between(tmp_path):
    path = write_tiff(tmp_path / "cover.tif", town((5, 1, 2)))
    text = refused(path)
    assert 'may follow the legends "gothenburg" and "loveda-values"' in text
    assert "--legend gothenburg" in text


def test_a_mask_is_one_of_houses_or_of_streets_by_its_shape(tmp_path):
    Image.fromarray(town((0, 0, 255))).save(tmp_path / "houses.png")
    Image.fromarray(town((0, 255, 0))).save(tmp_path / "streets.png")
    houses = read_semantic_map(tmp_path / "houses.png", pixel=0.5).layout
    streets = read_semantic_map(tmp_path / "streets.png", pixel=0.5).layout
    assert (len(houses.buildings), len(houses.roads)) == (4, 0)
    assert (len(streets.buildings), len(streets.roads)) == (0, 1)


def photograph(seed=0, size=200):
    from scipy.ndimage import gaussian_filter

    noise = np.random.default_rng(seed).normal(size=(size, size, 3))
    smooth = gaussian_filter(noise, (6, 6, 0)) * 900 + noise * 8 + 120
    return np.clip(smooth, 0, 255).astype(np.uint8)


@pytest.mark.parametrize("name", ["photo.png", "photo.jpg"])
def test_a_photograph_is_no_semantic_map(tmp_path, name):
    Image.fromarray(photograph()).save(tmp_path / name)
    assert not is_semantic(read_picture(tmp_path / name)).semantic
    assert "does not look like a semantic map" in refused(tmp_path / name)


def _enlarged(image):
    return image.resize((24, 24)).resize((300, 300), Image.Resampling.BICUBIC)


def _posterised(image):
    few = image.resize((24, 24)).convert("P", palette=Image.Palette.ADAPTIVE, colors=16)
    return few.resize((300, 300), Image.Resampling.NEAREST)


def _sea_and_quay(image):
    """Grey all over, as of a harbour in haze: every pixel is near a colour of some legend."""
    grey = np.asarray(_enlarged(image).convert("L"), float)
    grey = 110 + 0.25 * (grey - 120)
    grey[:, 200:] += 50
    return Image.fromarray(np.repeat(grey.astype(np.uint8)[:, :, None], 3, axis=2))


@pytest.mark.parametrize(
    ("form", "name"),
    [
        (_enlarged, "enlarged.jpg"), (_posterised, "posterised.png"), (_sea_and_quay, "haze.jpg"),
        (lambda image: _sea_and_quay(image).convert("L"), "grey.jpg"),
    ],
)  # fmt: skip
def test_a_smooth_photograph_is_no_semantic_map(tmp_path, form, name):
    form(Image.fromarray(photograph())).save(tmp_path / name)
    evidence = is_semantic(read_picture(tmp_path / name))
    assert not evidence.semantic
    assert evidence.score < 0.5
    assert "does not look like a semantic map" in refused(tmp_path / name)
    assert classify(tmp_path / name).kind != "semantic"


def test_a_height_map_is_no_semantic_map(tmp_path):
    x, y = np.meshgrid(np.arange(200), np.arange(200))
    height = (20_000 + 9_000 * np.sin(x / 40) * np.cos(y / 60)).astype(np.uint16)
    Image.fromarray(height).save(tmp_path / "height.png")
    assert not is_semantic(read_picture(tmp_path / "height.png")).semantic


@pytest.mark.parametrize("name", ["town.png", "town.jpg"])
@pytest.mark.parametrize("colors", [(GRASS, ROAD, HOUSE), ((9, 99, 9), (1, 1, 1), (99, 9, 99))])
def test_a_map_of_known_or_unknown_colours_is_one(tmp_path, name, colors):
    Image.fromarray(town(colors)).save(tmp_path / name, quality=85)
    evidence = is_semantic(read_picture(tmp_path / name))
    assert evidence.semantic
    assert evidence.score > 0.8


def test_presets_have_no_colour_twice():
    for legend in PRESETS.values():
        keys = [entry.key for entry in legend.entries]
        assert len(set(keys)) == len(keys), legend.name


WORLD = "0.5\n0\n0\n-0.5\n500000.25\n5400000.75\n"  # centre of the first pixel, metres
PAM = (
    "<PAMDataset><SRS>EPSG:32633</SRS>"
    "<GeoTransform>500000, 0.5, 0, 5400001, 0, -0.5</GeoTransform></PAMDataset>"
)


@pytest.mark.parametrize("beside", ["aux", "world"])
def test_a_file_beside_an_image_says_place_and_scale(tmp_path, beside):
    path = tmp_path / "town.png"
    Image.fromarray(town()).save(path)
    if beside == "aux":
        (tmp_path / "town.png.aux.xml").write_text(PAM)
    else:
        (tmp_path / "town.pgw").write_text(WORLD)
        (tmp_path / "town.prj").write_text(rasterio.CRS.from_epsg(32633).to_wkt())
    city = read_semantic_map(path)
    assert abs(city.frame.latitude - 48.7527) < 0.001
    assert abs(city.frame.longitude - 15.0007) < 0.001
    xmin, _, xmax, _ = city.layout.extent
    assert abs(xmax - xmin - 100) < 1


def test_a_world_file_without_a_coordinate_system_is_a_doubt(tmp_path):
    Image.fromarray(town()).save(tmp_path / "town.png")
    (tmp_path / "town.pgw").write_text(WORLD)
    city = read_semantic_map(tmp_path / "town.png", pixel=0.5)
    assert (
        "semantic map: town.pgw says where the pixels lie but not in which coordinate system, so "
        "it is not used; give town.prj or town.png.aux.xml with the system"
    ) in city.notes


def test_a_prj_that_is_none_is_refused(tmp_path):
    Image.fromarray(town()).save(tmp_path / "town.png")
    (tmp_path / "town.pgw").write_text(WORLD)
    (tmp_path / "town.prj").write_text("somewhere")
    assert "town.prj is no coordinate system in WKT" in refused(tmp_path / "town.png", pixel=0.5)


def chunk(name, content):
    body = name + content
    return struct.pack(">I", len(content)) + body + struct.pack(">I", zlib.crc32(body))


@pytest.mark.parametrize("kind", ["png", "tif"])
def test_a_picture_of_900_megapixels_is_refused_with_the_limit(tmp_path, kind):
    path = tmp_path / f"huge.{kind}"
    if kind == "png":
        head = chunk(b"IHDR", struct.pack(">IIBBBBB", 30_000, 30_000, 8, 2, 0, 0, 0))
        path.write_bytes(b"\x89PNG\r\n\x1a\n" + head + chunk(b"IDAT", zlib.compress(bytes(99))))
    else:
        with rasterio.open(
            path, "w", driver="GTiff", width=30_000, height=30_000, count=3, dtype="uint8",
            tiled=True, sparse_ok=True, crs="EPSG:32633",
            transform=Affine(0.5, 0, 5e5, 0, -0.5, 54e5),
        ):  # fmt: skip
            pass
    text = refused(path)
    assert "64,000,000" in text
    assert "Cut it into tiles or make it coarser" in text
