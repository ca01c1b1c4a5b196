import numpy as np
import pytest
from PIL import Image

from cityx.errors import InputError, UsageError
from cityx.sources.map_classes import class_of
from cityx.sources.satellite import read_satellite
from cityx.sources.satellite.segmented import segment, squares, unlearned_segmenter
from cityx.sources.satellite.segmenter import Segmenter, load_segmenter
from cityx.sources.semantic_map.picture import read_picture

SAND, ASPHALT, ROOF, LAWN, SEA = (
    (214, 200, 178),
    (92, 88, 90),
    (190, 92, 70),
    (70, 120, 52),
    (22, 40, 62),
)


def town(size=480, seed=3):
    """Streets, houses with shadows, a lawn and a bay on sand, 0.6 m per pixel, with grain."""
    picture = np.full((size, size, 3), SAND, float)
    picture[:, size // 2 - 7 : size // 2 + 7] = ASPHALT
    picture[size // 2 - 7 : size // 2 + 7] = ASPHALT
    for y in range(30, size - 60, 60):
        for x in range(30, size - 60, 60):
            if abs(y + 12 - size // 2) > 30 and abs(x + 15 - size // 2) > 30:
                picture[y + 5 : y + 29, x + 5 : x + 36] = (60, 58, 62)
                picture[y : y + 24, x : x + 30] = ROOF
    picture[:110, :110] = LAWN
    picture[-120:, -160:] = SEA
    noise = np.random.default_rng(seed).normal(0, 5, picture.shape)
    return np.clip(picture + noise, 0, 255).astype(np.uint8)


def saved(tmp_path, pixels, name="town.png", **options):
    path = tmp_path / name
    Image.fromarray(pixels).save(path, **options)
    return path


def local_segmenter(tile=128, stride=16):
    """Two classes told by brightness alone, so that no tile can matter."""

    def run(image):
        bright = image.mean(axis=0)
        return np.stack([8 * bright, 8 * (1 - bright)]).astype(np.float32)

    return Segmenter("by light", (class_of("road"), class_of("bare")), run, 0.6, tile, stride)


@pytest.mark.parametrize("shape", [(1, 1), (64, 64), (65, 300), (300, 129)])
def test_squares_cover_a_raster_once(shape):
    count = np.zeros(shape, int)
    for rows, columns, inner in squares(shape, 128, 16):
        assert len(rows) % 16 == len(columns) % 16 == 0
        assert max(len(rows), len(columns)) <= 128
        count[np.ix_(rows[inner[0]], columns[inner[1]])] += 1
    assert (count == 1).all()


def test_tiles_give_what_the_whole_image_gives():
    image = town(300)
    tiled = segment(image, local_segmenter(tile=128))
    whole = segment(image, local_segmenter(tile=1024))
    assert np.array_equal(tiled.labels, whole.labels)
    assert np.array_equal(tiled.confidence, whole.confidence)
    assert np.array_equal(tiled.labels, (image.mean(axis=2) < 127.5).astype(np.uint8))


def test_an_image_becomes_a_city_with_its_doubt(tmp_path):
    path = saved(tmp_path, town())
    city = read_satellite(path, pixel=0.6, at=(25.2, 55.3), segmenter="none")
    assert len(city.layout.buildings) > 0
    assert len(city.layout.roads) > 0
    assert any("mean confidence 0." in note for note in city.notes)
    assert any("no learning" in note for note in city.notes)
    assert (city.frame.latitude, city.frame.longitude) == (25.2, 55.3)
    assert "layout" in city.stages_done


@pytest.mark.parametrize("fidelity", ["exact", "plausible"])
def test_the_same_image_gives_the_same_city(tmp_path, fidelity):
    path = saved(tmp_path, town())
    first, again = (
        read_satellite(path, pixel=0.6, fidelity=fidelity, seed=5, segmenter="none")
        for _ in range(2)
    )
    assert first.layout.buildings.equals(again.layout.buildings)
    assert first.layout.roads.equals(again.layout.roads)
    assert first.notes == again.notes


def test_plants_and_water_are_known_without_learning():
    image = town()
    found = segment(image, unlearned_segmenter())
    words = [item.word for item in unlearned_segmenter().classes]
    lawn, bay = found.labels[20:90, 20:90], found.labels[-90:-20, -120:-20]
    assert (lawn == words.index("vegetation")).mean() > 0.9
    assert (bay == words.index("water")).mean() > 0.9


def test_transparent_pixels_are_neither_house_nor_street(tmp_path):
    picture = np.dstack([town(), np.full((480, 480), 255, np.uint8)])
    picture[:, 300:, 3] = 0
    city = read_satellite(saved(tmp_path, picture), pixel=0.6, segmenter="none")
    assert city.layout.buildings.geometry.bounds["maxx"].max() < (300 - 240) * 0.6 + 1


def test_sixteen_bits_show_what_eight_show(tmp_path):
    grey = town().mean(axis=2)
    path = tmp_path / "wide.png"
    Image.fromarray((grey * 9 + 300).astype(np.uint16)).save(path)
    shown = read_picture(path, photograph=True).colors[..., 0].astype(float)
    assert np.corrcoef(shown.ravel(), grey.ravel())[0, 1] > 0.98
    assert shown.max() == 255
    assert shown.min() == 0


def test_an_image_without_a_city_is_refused(tmp_path):
    rng = np.random.default_rng(0)
    sea = np.clip(rng.normal(SEA, 3, (300, 300, 3)), 0, 255).astype(np.uint8)
    with pytest.raises(InputError, match="shows no city"):
        read_satellite(saved(tmp_path, sea), pixel=0.6, segmenter="none")


def test_wrong_words_are_refused(tmp_path):
    path = saved(tmp_path, town(64))
    with pytest.raises(UsageError, match='no fidelity "nice"; write exact or plausible'):
        read_satellite(path, fidelity="nice")
    with pytest.raises(InputError, match="A pixel of 40 m is of no use"):
        read_satellite(path, pixel=40)


def test_files_that_are_no_image_are_refused(tmp_path):
    cut = saved(tmp_path, town(), "cut.png")
    cut.write_bytes(cut.read_bytes()[:5000])
    text = tmp_path / "text.png"
    text.write_text("a city, please")
    dot = saved(tmp_path, town(60)[:1, :1], "dot.png")
    inks = tmp_path / "inks.jpg"
    Image.fromarray(town(64)).convert("CMYK").save(inks)
    for path, why in ((cut, "cut off"), (text, "no image"), (dot, "1 x 1"), (inks, "CMYK")):
        with pytest.raises(InputError, match=why):
            read_satellite(path)


def test_what_is_no_network_is_refused(tmp_path):
    path = tmp_path / "none.onnx"
    path.write_bytes(b"no network")
    with pytest.raises(InputError, match="no ONNX model that can be run"):
        load_segmenter(path)
    with pytest.raises(InputError, match=r"gone\.onnx does not exist"):
        load_segmenter(tmp_path / "gone.onnx")


def test_a_shadow_is_no_lake(tmp_path):
    picture = town()
    picture[300:310, 60:140] = picture[-60, -60]
    city = read_satellite(saved(tmp_path, picture), pixel=0.6, segmenter="none")
    lakes = city.layout.areas[city.layout.areas["kind"] == "water"].geometry
    assert len(lakes) >= 1
    assert (lakes.bounds["maxy"] < -30).all()  # all in the bay, none beside the houses


@pytest.mark.parametrize(("color", "kind"), [(SAND, "sand"), ((176, 108, 66), "bare")])
def test_bare_ground_is_named_by_its_colour(tmp_path, color, kind):
    picture = town()
    picture[(picture > 150).all(axis=2)] = color
    city = read_satellite(saved(tmp_path, picture), pixel=0.6, segmenter="none")
    kinds = set(city.layout.areas["kind"])
    assert kind in kinds
    assert not {"sand", "bare"} - {kind} & kinds


def test_a_georeference_gives_place_and_scale(tmp_path):
    import rasterio
    from rasterio.transform import Affine

    path = tmp_path / "town.tif"
    pixels = np.moveaxis(town(), 2, 0)
    place = Affine(0.6, 0, 330_000, 0, -0.6, 2_780_000)
    with rasterio.open(path, "w", driver="GTiff", width=480, height=480, count=3, dtype="uint8",
                       crs="EPSG:32640", transform=place) as file:  # fmt: skip
        file.write(pixels)
    city = read_satellite(path, pixel=2.0, segmenter="none")
    assert 25.0 < city.frame.latitude < 25.3
    assert 55.2 < city.frame.longitude < 55.4
    west, south, east, north = city.layout.roads.total_bounds
    assert 285 < east - west < 293
    assert 285 < north - south < 293
    assert any("the georeference says 0.6 m per pixel" in note for note in city.notes)


def test_scale_is_asked_where_what_is_seen_does_not_agree(tmp_path):
    path = saved(tmp_path, town())
    with pytest.raises(InputError, match=r"How many metres is a pixel\?.*--pixel .* or --pixel"):
        read_satellite(path, segmenter="none")
    assert len(read_satellite(path, segmenter="none", pixel=0.6).layout.buildings)
