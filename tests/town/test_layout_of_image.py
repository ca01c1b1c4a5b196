import numpy as np
import pytest
import shapely

from cityx.errors import ActionFailed
from cityx.protocol import Format, registry
from cityx.protocol.conversions import ConversionGraph, apply_path
from cityx.protocol.example_city import example_city
from cityx.protocol.values import Image, LinearColor
from cityx.town.semantic_map import semantic_map

WORDS = {"grass": (0.4, 0.8, 0.3), "road": (0.5, 0.5, 0.5), "building": (0.8, 0.2, 0.2)}
CITY = example_city()


def town(pixel=0.5, side=200.0):
    """A street and six houses on a lawn, one of them at an angle."""
    size = round(side / pixel)
    pixels = np.full((size, size, 3), WORDS["grass"])
    middle = (np.arange(size) + 0.5) * pixel - side / 2
    x, y = np.meshgrid(middle, -middle)
    pixels[np.abs(y) < 4.0] = WORDS["road"]
    for cx in (-60, 0, 60):
        pixels[(np.abs(x - cx) < 10) & (np.abs(y - 30) < 7)] = WORDS["building"]
        u, v = (x - cx) * 0.8 + (y + 40) * 0.6, (y + 40) * 0.8 - (x - cx) * 0.6
        pixels[(np.abs(u) < 12) & (np.abs(v) < 6)] = WORDS["building"]
    classes = tuple((LinearColor(*color), word) for word, color in WORDS.items())
    return Image(pixels, pixel, (-side / 2, -side / 2), classes)


def check(layout, pixel):
    assert len(layout.buildings) == 6
    areas = np.sort(shapely.area(layout.buildings.geometry.to_numpy()))
    assert np.allclose(areas, [280] * 3 + [288] * 3, rtol=0.04 * pixel / 0.5)
    corners = shapely.get_num_coordinates(layout.buildings.geometry.to_numpy()) - 1
    assert corners.tolist() == [4] * 6
    assert len(layout.roads) == 1
    assert abs(layout.roads["width"][0] - 8.0) <= pixel
    assert abs(layout.roads.geometry[0].length - 200) < 2
    assert set(layout.areas["kind"]) == {"grass"}


@pytest.mark.parametrize("pixel", [0.25, 0.5, 1.0])
def test_the_direct_way_draws_houses_streets_and_land(pixel):
    check(semantic_map(CITY, town(pixel)), pixel)


@pytest.mark.parametrize("pixel", [0.25, 0.5, 1.0])
def test_the_papers_way_gives_the_same_without_the_direct_action(pixel):
    actions = registry(outside=False)
    path = ConversionGraph.of(actions).path(
        (Format.IMAGE, "semantic_map"), (Format.SCENE_LAYOUT, "")
    )
    assert path.steps == (
        "Image_to_point_conversion", "Point_to_face_conversion", "Face_to_layout_conversion",
    )  # fmt: skip
    image = town(pixel)
    layout = apply_path(path, image, actions, city=CITY)
    check(layout, pixel)
    direct = semantic_map(CITY, image)
    assert shapely.equals_exact(
        layout.buildings.geometry.union_all().normalize(),
        direct.buildings.geometry.union_all().normalize(),
        1e-3,
    )


def test_pixels_far_from_every_class_are_unknown():
    image = town()
    image.pixels[:40, :40] = (0.0, 0.0, 1.0)
    layout = semantic_map(CITY, image)
    assert set(layout.areas["kind"]) == {"grass"}
    assert layout.areas.geometry.area.sum() == pytest.approx(40_000, rel=1e-3)


def test_a_map_without_a_street_keeps_its_land():
    image = Image(np.full((40, 40, 3), WORDS["grass"]), 1.0, (0, 0), town().classes)
    layout = semantic_map(CITY, image)
    assert layout.areas["kind"].tolist() == ["grass"]
    assert not len(layout.roads)


def test_an_image_without_classes_is_refused():
    with pytest.raises(ActionFailed, match="says no classes"):
        semantic_map(CITY, Image(np.zeros((20, 20, 3))))


def test_a_word_that_is_no_class_is_refused():
    image = Image(np.zeros((20, 20, 3)), classes=((LinearColor(0, 0, 0), "mood"),))
    with pytest.raises(ActionFailed, match='"mood" is no class of a map'):
        semantic_map(CITY, image)
