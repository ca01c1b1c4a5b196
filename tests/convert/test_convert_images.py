import numpy as np
import pytest

from cityx.assets.styles.materials import MATERIALS
from cityx.convert.images import (
    color_to_material_conversion,
    color_to_string_conversion,
    height_to_point_conversion,
    image_to_color_conversion,
    image_to_material_conversion,
    image_to_point_conversion,
    material_to_color_conversion,
    noise_to_image_conversion,
    string_to_color_conversion,
)
from cityx.errors import ActionFailed
from cityx.protocol.values import Image, LinearColor, NoiseFunction

RED, BLUE = LinearColor(1, 0, 0), LinearColor(0, 0, 1)


def test_the_first_row_of_an_image_is_north():
    pixels = np.array([[RED, RED], [BLUE, BLUE]], float)
    image = Image(pixels, 10.0, (100.0, 200.0), ((RED, "building"), (BLUE, "park")))
    points = image_to_point_conversion(image)
    assert points.position[:, :2].tolist() == [[105, 215], [115, 215], [105, 205], [115, 205]]
    assert points.kind.tolist() == ["building", "building", "park", "park"]


def test_colours_no_class_stands_for_are_left_out():
    pixels = np.array([[RED, (0.0, 1.0, 0.0)]], float)
    assert image_to_point_conversion(Image(pixels, classes=((RED, "x"),))).count == 1
    with pytest.raises(ActionFailed, match="The image says no classes"):
        image_to_point_conversion(Image(pixels))


def test_heights_span_the_range_given():
    image = Image(np.array([[[0.0], [0.5], [1.0]]]))
    assert height_to_point_conversion(image, low=10, high=30).position[:, 2].tolist() == [
        10,
        20,
        30,
    ]


def test_colours_survive_the_way_through_text_within_an_eight_bit_step():
    for color in ((0.0, 1.0, 0.5), (0.01, 0.2, 0.9)):
        again = string_to_color_conversion(color_to_string_conversion(LinearColor(*color)))
        assert again == pytest.approx(color, abs=0.01)
    assert string_to_color_conversion("White") == pytest.approx((1, 1, 1))
    with pytest.raises(ActionFailed, match='"sky" is no colour: write #rrggbb or one of black,'):
        string_to_color_conversion("sky")


def test_a_material_of_a_colour_has_that_colour():
    color = LinearColor(0.2, 0.4, 0.6)
    assert material_to_color_conversion(color_to_material_conversion(color)) == color


def test_the_material_nearest_to_a_picture_of_one_material_is_that_material():
    for name in ("grass", "copper", "asphalt"):
        picture = Image(np.broadcast_to(MATERIALS[name].color, (4, 4, 3)))
        assert image_to_material_conversion(picture).name == name
        assert image_to_color_conversion(picture) == pytest.approx(MATERIALS[name].color)


def test_an_image_of_noise_holds_its_values():
    noise = NoiseFunction(3, 20.0)
    image = noise_to_image_conversion(noise, pixels=8, pixel_size=2.0)
    assert image.origin == (-8.0, -8.0)
    assert image.pixels[7, 0, 0] == pytest.approx((noise([[-7.0, -7.0]])[0] + 1) / 2)
