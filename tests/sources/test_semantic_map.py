import json
import re

import numpy as np
import pytest
import shapely
from PIL import Image

from cityx.errors import InputError, UsageError
from cityx.sources.semantic_map import read_semantic_map

ROAD, HOUSE, GRASS, WATER = (
    (0x8C, 0x8C, 0x96),
    (0xC8, 0x3C, 0x3C),
    (0xA0, 0xD2, 0x78),
    (90, 150, 220),
)


def town(size=400):
    """A street crossing, eight houses in its corners, a lake and lawns, half a metre per pixel."""
    picture = np.full((size, size, 3), GRASS, np.uint8)
    picture[193:207] = ROAD
    picture[:, 193:207] = ROAD
    for y, x in ((60, 60), (60, 130), (60, 260), (120, 60), (260, 60), (260, 130), (320, 60)):
        picture[y : y + 30, x : x + 40] = HOUSE
    picture[280:360, 260:370] = WATER
    return picture


def saved(tmp_path, pixels, name="town.png", **options):
    path = tmp_path / name
    Image.fromarray(pixels).save(path, **options)
    return path


def test_a_map_becomes_houses_streets_and_land(tmp_path):
    city = read_semantic_map(saved(tmp_path, town()), pixel=0.5, at=(48.0, 11.0))
    layout = city.layout
    assert len(layout.buildings) == 7
    assert np.allclose(layout.buildings.geometry.area, 15 * 20, rtol=0.03)
    assert len(layout.roads) == 4
    assert np.allclose(layout.roads["width"], 7.0, atol=0.3)
    assert set(layout.roads["kind"]) == {"residential"}
    assert sorted(layout.areas["kind"]) == ["grass", "water"]
    ends = shapely.get_coordinates(shapely.get_point(layout.roads.geometry.to_numpy(), 0))
    assert np.abs(ends).max() < 101
    assert (city.frame.latitude, city.frame.longitude) == (48.0, 11.0)


def test_the_legend_found_is_said(tmp_path):
    city = read_semantic_map(saved(tmp_path, town()), pixel=0.5)
    assert any('legend "cityx" explains 100.0 %' in note for note in city.notes)


def suburb(street, house, *, car=0):
    """Streets 120 pixels apart, houses and cars of so many pixels between them."""
    picture = np.full((480, 480, 3), GRASS, np.uint8)
    for at in range(0, 480, 120):
        picture[at : at + street] = ROAD
        picture[:, at : at + street] = ROAD
    for y in range(50, 480, 120):
        for x in range(50, 480, 120):
            picture[y : y + house, x : x + house] = HOUSE
            if car:
                row = (y - 50) // 120 * 120
                picture[row + 2 : row + 2 + car, x : x + 2 * car] = CAR
    return picture


CAR = (0xE6, 0xC8, 0x32)
CARS = {"#8C8C96": "road", "#C83C3C": "building", "#A0D278": "grass", "#E6C832": "car"}


@pytest.mark.parametrize(
    ("picture", "pixel"),
    [(suburb(14, 24), 0.5), (suburb(9, 16), 0.77), (suburb(18, 60, car=5), 0.39)],
)
def test_the_scale_is_estimated_where_two_thirds_of_the_clues_agree(tmp_path, picture, pixel):
    legend = tmp_path / "legend.json"
    legend.write_text(json.dumps(CARS))
    city = read_semantic_map(saved(tmp_path, picture), legend=legend)
    told = next(note for note in city.notes if "a pixel is taken for" in note)
    assert float(re.search(r"taken for ([\d.]+) m:", told)[1]) == pytest.approx(pixel, rel=0.1)
    assert "its streets are" in told


@pytest.mark.parametrize(
    ("picture", "tries"),
    [
        (suburb(14, 60), ("--pixel 0.52", "--pixel 0.2")),  # streets and houses contradict
        (suburb(14, 0), ("--pixel 0.52",)),  # one clue alone
        (suburb(14, 60, car=2), ("--pixel 0.52", "--pixel 0.2", "--pixel 1")),
    ],
)
def test_the_scale_is_asked_where_clues_do_not_agree(tmp_path, picture, tries):
    legend = tmp_path / "legend.json"
    legend.write_text(json.dumps(CARS))
    path = saved(tmp_path, picture)
    with pytest.raises(InputError, match=r"How many metres is a pixel\?") as error:
        read_semantic_map(path, legend=legend)
    for text in tries:
        assert text in str(error.value)
    assert read_semantic_map(path, legend=legend, pixel=0.5).layout.roads is not None


def test_a_world_file_without_a_system_is_a_clue_to_the_scale(tmp_path):
    path = saved(tmp_path, suburb(14, 0))
    path.with_suffix(".pgw").write_text("0.5\n0\n0\n-0.5\n100\n100\n")
    city = read_semantic_map(path)
    told = next(note for note in city.notes if "a pixel is taken for" in note)
    assert "its file says 0.5 units per pixel" in told


def test_parts_of_one_map_have_one_scale_or_are_asked_for(tmp_path):
    """Blocks with large houses on one side of the map, and small ones on the other."""
    picture = np.concatenate([suburb(14, 24), suburb(14, 60)], axis=1)
    scales = []
    for k in range(4):
        part = saved(tmp_path, picture[:, 240 * k : 240 * (k + 1)], f"{k}.png")
        try:
            notes = read_semantic_map(part).notes
        except InputError:
            continue
        told = next(note for note in notes if "a pixel is taken for" in note)
        scales.append(float(re.search(r"taken for ([\d.]+) m:", told)[1]))
    assert max(scales, default=1.0) <= 1.25 * min(scales, default=1.0)


def test_a_palette_image_and_a_true_colour_image_are_the_same_map(tmp_path):
    plain = read_semantic_map(saved(tmp_path, town()), pixel=0.5)
    image = Image.fromarray(town()).convert("P", palette=Image.Palette.ADAPTIVE, colors=4)
    image.save(tmp_path / "palette.png")
    other = read_semantic_map(tmp_path / "palette.png", pixel=0.5)
    assert plain.layout.buildings.equals(other.layout.buildings)
    assert plain.layout.roads.equals(other.layout.roads)


def test_a_jpeg_gives_the_same_houses(tmp_path):
    city = read_semantic_map(saved(tmp_path, town(), "town.jpg", quality=75), pixel=0.5)
    assert len(city.layout.buildings) == 7
    assert np.allclose(city.layout.buildings.geometry.area, 300, rtol=0.06)


def test_a_legend_file_gives_classes_and_heights(tmp_path):
    legend = tmp_path / "legend.json"
    legend.write_text(json.dumps([
        {"color": "#C83C3C", "class": "building=office", "height": 30},
        {"color": "#8C8C96", "class": "road"}, {"color": "#A0D278", "class": "natural=scrub"},
        {"color": "#5A96DC", "class": "lake"},
    ]))  # fmt: skip
    city = read_semantic_map(saved(tmp_path, town()), legend=legend, pixel=0.5)
    assert set(city.layout.buildings["use"]) == {"office"}
    assert np.allclose(city.layout.buildings["height"], 30)
    assert sorted(city.layout.areas["kind"]) == ["scrub", "water"]


def test_all_faults_of_a_legend_are_named(tmp_path):
    legend = tmp_path / "legend.csv"
    legend.write_text("class,color,height\nbulding,#FF0000,\nroad,red,\nhouse,#00FF00,-3\n")
    with pytest.raises(InputError) as error:
        read_semantic_map(saved(tmp_path, town()), legend=legend)
    text = str(error.value)
    assert 'line 1: "bulding" is no class of a map. Did you mean "building"' in text
    assert 'line 2: "red" is no colour; write #rrggbb' in text
    assert 'line 3: "-3" is no height of a building' in text


def test_a_legend_that_is_neither_preset_nor_file_is_refused(tmp_path):
    with pytest.raises(UsageError, match=r'no legend "dubay".* Did you mean "dubai"'):
        read_semantic_map(saved(tmp_path, town()), legend="dubay")


def test_unknown_colours_are_proposed_and_taken_when_confirmed(tmp_path):
    other = {ROAD: (40, 40, 60), HOUSE: (200, 120, 200), GRASS: (30, 200, 60), WATER: (0, 60, 250)}
    pixels = town()
    for color, new in other.items():
        pixels[(town() == color).all(axis=2)] = new
    path = saved(tmp_path, pixels)
    with pytest.raises(InputError) as error:
        read_semantic_map(path)
    text = str(error.value)
    assert "follow no known legend" in text
    assert '"#28283C": "road"' in text
    assert '"#C878C8": "building"' in text
    city = read_semantic_map(path, confirm=True, pixel=0.5)
    assert len(city.layout.buildings) == 7
    assert len(city.layout.roads) == 4
    assert "water" in set(city.layout.areas["kind"])
    assert any("proposed from colours and shapes, and confirmed" in note for note in city.notes)


def test_the_same_map_gives_the_same_city(tmp_path):
    path = saved(tmp_path, town())
    one, other = (read_semantic_map(path, seed=3, pixel=0.5) for _ in range(2))
    for table in ("buildings", "parts", "roads", "areas", "points"):
        assert getattr(one.layout, table).equals(getattr(other.layout, table))


def test_a_change_elsewhere_changes_no_id(tmp_path):
    one = read_semantic_map(saved(tmp_path, town()), pixel=0.5)
    pixels = town()
    pixels[350:380, 100:150] = HOUSE
    other = read_semantic_map(saved(tmp_path, pixels, "other.png"), pixel=0.5)
    assert set(one.layout.buildings["id"]) < set(other.layout.buildings["id"])


def crescent():
    """A bent row of plots, 30 m deep, beside a street of 7 m, half a metre per pixel."""
    y, x = np.mgrid[:500, :500] * 0.5
    away = np.hypot(x - 20, y - 20)
    picture = np.full((500, 500, 3), GRASS, np.uint8)
    picture[(away > 140) & (away < 170)] = HOUSE
    picture[(away > 175) & (away < 182)] = ROAD
    return picture


def test_a_row_of_plots_is_one_house_or_many_and_this_is_said(tmp_path):
    path = saved(tmp_path, crescent())
    exact = read_semantic_map(path, pixel=0.5)
    assert len(exact.layout.buildings) == 1
    assert any("1 patches of buildings are rows rather than houses" in n for n in exact.notes)
    cut = read_semantic_map(path, pixel=0.5, fidelity="plausible")
    assert 8 <= len(cut.layout.buildings) <= 16
    assert set(cut.layout.buildings["use"]) == {"house"}
    row, houses = (city.layout.buildings.geometry.union_all() for city in (exact, cut))
    assert houses.difference(row).area < 0.05 * houses.area


def test_an_unknown_fidelity_is_refused(tmp_path):
    with pytest.raises(UsageError, match='no fidelity "some"'):
        read_semantic_map(saved(tmp_path, town()), fidelity="some")
