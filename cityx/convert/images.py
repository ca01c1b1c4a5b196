"""From and to images: semantic maps, height fields, colours, noise."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from cityx.assets.styles.materials import MATERIALS, Material
from cityx.errors import ActionFailed
from cityx.protocol import Port, Range, action
from cityx.protocol.values import Image, LinearColor, NoiseFunction, Points, make_points


def pixel_centres(image: Image) -> NDArray[np.float64]:
    """Return the (h * w, 2) centres of the pixels in the order of the array, metres."""
    rows, columns = image.pixels.shape[:2]
    x = image.origin[0] + (np.arange(columns) + 0.5) * image.pixel_size
    y = image.origin[1] + (rows - np.arange(rows) - 0.5) * image.pixel_size
    return np.column_stack([np.tile(x, rows), np.repeat(y, columns)])


@action(
    "convert/image_to_point_conversion-v1",
    classname="Image_to_point_conversion",
    extension=True,
    gives=(Port("points", "point", "semantic"),),
    lossy=0.1,
    limits=["Loses colours that no class stands for: pixels farther from all than the tolerance."],
)
def image_to_point_conversion(
    image: Annotated[Image, Port("image", "image", "semantic_map")],
    *,
    tolerance: Annotated[float, Range(0.0, 2.0)] = 0.05,
) -> Points:
    """Convert a semantic map to points that carry the class of their pixel.

    Parameters
    ----------
    image
        Semantic map with its table of colours.
    tolerance
        Greatest distance of a pixel's colour from the colour of its class.
    """
    if not image.classes:
        raise ActionFailed("The image says no classes; a semantic map needs a table of colours.")
    words = np.array([word for _, word in image.classes])
    labels = image.labels(tolerance).ravel()
    kept = labels < len(words)
    points = make_points(pixel_centres(image)[kept])
    return replace(points, kind=words[labels[kept]])


@action(
    "convert/height_to_point_conversion-v1",
    classname="Height_to_point_conversion",
    extension=True,
    gives=(Port("points", "point", "height"),),
    limits=["Loses nothing but the grid; values are scaled to the range of heights given."],
    lossy=0.05,
)
def height_to_point_conversion(
    image: Annotated[Image, Port("image", "image", "height_field")],
    *,
    low: Annotated[float, Range(-12_000.0, 12_000.0)] = 0.0,
    high: Annotated[float, Range(-12_000.0, 12_000.0)] = 100.0,
) -> Points:
    """Convert a height image to points at their heights.

    Parameters
    ----------
    image
        Image whose first channel is height, 0 to 1.
    low, high
        Metres of the values 0 and 1.
    """
    z = low + (high - low) * image.pixels[:, :, 0].reshape(-1)
    return make_points(np.column_stack([pixel_centres(image), z]))


@action(
    "convert/image_to_color_conversion-v1",
    classname="Image_to_color_conversion",
    extension=True,
    lossy=0.9,
    limits=["Loses everything but the mean."],
)
def image_to_color_conversion(
    image: Annotated[Image, Port("image", "image", "picture")],
) -> LinearColor:
    """Convert an image to its mean colour.

    Parameters
    ----------
    image
        Image with one or three channels.
    """
    mean = image.pixels.reshape(-1, image.pixels.shape[2]).mean(axis=0)
    red, green, blue = np.clip(np.broadcast_to(mean[:3], 3), 0, 1).tolist()
    return LinearColor(red, green, blue)


@action(
    "convert/color_to_material_conversion-v1",
    classname="Color_to_material_conversion",
    extension=True,
    lossy=0.1,
    limits=["Loses nothing, but says nothing of roughness either: the material is plain paint."],
)
def color_to_material_conversion(color: Annotated[LinearColor, Port("color", "color")]) -> Material:
    """Convert a colour to a plain painted material.

    Parameters
    ----------
    color
        Linear red, green and blue.
    """
    red, green, blue = (float(channel) for channel in color)
    red8, green8, blue8 = (_srgb(channel) for channel in (red, green, blue))
    return Material(f"paint_{red8:02x}{green8:02x}{blue8:02x}", (red, green, blue), 0.7)


def _srgb(linear: float) -> int:
    if linear <= 0.0031308:
        return round(255 * 12.92 * max(linear, 0.0))
    return round(255 * (1.055 * math.pow(min(linear, 1.0), 1 / 2.4) - 0.055))


@action(
    "convert/color_to_string_conversion-v1",
    classname="Color_to_string_conversion",
    extension=True,
    gives=(Port("text", "string", "color"),),
    lossy=0.02,
    limits=["Loses differences below an eight-bit step."],
)
def color_to_string_conversion(color: Annotated[LinearColor, Port("color", "color")]) -> str:
    """Convert a colour to the text "#rrggbb".

    Parameters
    ----------
    color
        Linear red, green and blue.
    """
    return "#" + "".join(f"{_srgb(float(channel)):02x}" for channel in color)


@action(
    "convert/string_to_color_conversion-v1",
    classname="String_to_color_conversion",
    extension=True,
    limits=["Reads #rrggbb and the sixteen basic colour words; other words are refused."],
)
def string_to_color_conversion(
    text: Annotated[str, Port("text", "string", "color")],
) -> LinearColor:
    """Convert "#rrggbb" or a colour word to a colour.

    Parameters
    ----------
    text
        The text.
    """
    from cityx.assets.styles.materials import srgb_to_linear

    word = text.strip().lower()
    digits = word.removeprefix("#")
    if word in COLOR_WORDS:
        return LinearColor(*srgb_to_linear(COLOR_WORDS[word]))
    if len(digits) == 6 and all(digit in "0123456789abcdef" for digit in digits):
        return LinearColor(*srgb_to_linear(int(digits, 16)))
    raise ActionFailed(f'"{text}" is no colour: write #rrggbb or one of {", ".join(COLOR_WORDS)}.')


COLOR_WORDS = {
    "black": 0x000000, "silver": 0xC0C0C0, "grey": 0x808080, "gray": 0x808080, "white": 0xFFFFFF,
    "maroon": 0x800000, "red": 0xFF0000, "purple": 0x800080, "green": 0x008000, "olive": 0x808000,
    "yellow": 0xFFFF00, "navy": 0x000080, "blue": 0x0000FF, "teal": 0x008080, "orange": 0xFFA500,
    "brown": 0xA52A2A,
}  # fmt: skip


@action(
    "convert/material_to_color_conversion-v1",
    classname="Material_to_color_conversion",
    extension=True,
    lossy=0.7,
    limits=["Loses texture, roughness and metal."],
)
def material_to_color_conversion(material: Material) -> LinearColor:
    """Convert a material to its base colour.

    Parameters
    ----------
    material
        Material.
    """
    return LinearColor(*material.color)


@action(
    "convert/image_to_material_conversion-v1",
    classname="Image_to_material_conversion",
    extension=True,
    lossy=0.8,
    limits=["Loses the pattern: the material of the table whose base colour is nearest is taken."],
)
def image_to_material_conversion(
    image: Annotated[Image, Port("image", "image", "picture")],
) -> Material:
    """Convert an image to the known material that looks most like its mean colour.

    Parameters
    ----------
    image
        Image with one or three channels.
    """
    mean = np.array(image_to_color_conversion(image))
    names = sorted(MATERIALS)
    colors = np.array([MATERIALS[name].color for name in names])
    # Square roots bring linear light close to how different colours look.
    apart = np.linalg.norm(np.sqrt(colors) - np.sqrt(mean), axis=1)
    return MATERIALS[names[int(np.argmin(apart))]]


@action(
    "convert/material_to_image_conversion-v1",
    classname="Material_to_image_conversion",
    extension=True,
    gives=(Port("image", "image", "picture"),),
    lossy=0.3,
    cost=2.0,
    limits=["Loses relief and roughness: the picture is one tile in even light."],
)
def material_to_image_conversion(
    material: Material, *, size: Annotated[int, Range(16, 2048)] = 256
) -> Image:
    """Convert a material to a picture of one tile of it.

    Parameters
    ----------
    material
        Material.
    size
        Edge of the picture, pixels.
    """
    base = np.array(material.color)
    pixels = np.broadcast_to(base, (size, size, 3))
    if material.texture:
        from cityx.assets.textures import texture

        pixels = base * np.asarray(texture(material.texture, size).color, float)
    return Image(np.clip(pixels, 0, 1), material.tile / size)


@action(
    "convert/noise_to_image_conversion-v1",
    classname="Noise_to_image_conversion",
    extension=True,
    gives=(Port("image", "image", "height_field"),),
    lossy=0.2,
    limits=["Loses what lies beyond the picture and between its pixels."],
)
def noise_to_image_conversion(
    noise: NoiseFunction,
    *,
    pixels: Annotated[int, Range(1, 8192)] = 256,
    pixel_size: Annotated[float, Range(0.001, 1000.0)] = 2.0,
) -> Image:
    """Convert a noise function to an image about the origin, -1 black and 1 white.

    Parameters
    ----------
    noise
        The function.
    pixels
        Pixels on a side.
    pixel_size
        Metres.
    """
    corner = -pixels * pixel_size / 2
    blank = Image(np.zeros((pixels, pixels, 1)), pixel_size, (corner, corner))
    values = np.clip((noise(pixel_centres(blank)) + 1) / 2, 0, 1)
    return Image(values.reshape(pixels, pixels, 1), pixel_size, (corner, corner))
