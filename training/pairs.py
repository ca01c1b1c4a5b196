"""Pairs of images and labels at the ground resolution of the network, split by place.

No place is on both sides: of Dubai whole tile folders are held back, of Kampala the east of the one
patch of ground that its map tiles of three zooms show.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from labels import ANYTHING, may_be
from numpy.typing import NDArray
from PIL import Image

PIXEL = 0.6  # metres
# The set does not say how large its pixels are: lanes of its motorways are five to six wide.
DUBAI_PIXEL = 0.7
DUBAI_HELD_BACK = ("tile2", "tile3")
DUBAI_LEGEND = {
    0x3C1098: may_be("building"),
    0x8429F6: may_be("bare"),
    0x6EC1E4: may_be("road"),
    0xFEDD3A: may_be("vegetation"),
    0xE2A929: may_be("water"),
}
KAMPALA_ZOOM = 21
KAMPALA_LATITUDE = 0.336  # degrees
# Only buildings are labelled; the images show that the rest of the ground is dry.
KAMPALA_REST = may_be("road", "vegetation", "bare")
KAMPALA_SPLIT = 2 / 3  # of the ground from the west is for training
TILE = 256  # pixels of a map tile
EQUATOR = 40_075_016.7  # metres around


@dataclass(frozen=True)
class Pair:
    """An image and its labels.

    Attributes
    ----------
    place, name
        Set it belongs to, and which of its images it is.
    image
        (rows, columns, 3) uint8 sRGB.
    labels
        (rows, columns) uint8, as in `labels`.
    pixel
        Metres of a pixel.
    held_back
        Whether training must not see it.
    """

    place: str
    name: str
    image: NDArray[np.uint8]
    labels: NDArray[np.uint8]
    pixel: float
    held_back: bool

    def at(self, pixel: float) -> Pair:
        """Return the pair at another ground resolution."""
        if math.isclose(pixel, self.pixel):
            return self
        rows, columns = self.labels.shape
        scale = self.pixel / pixel
        size = max(1, round(columns * scale)), max(1, round(rows * scale))
        image = Image.fromarray(self.image).resize(size, Image.Resampling.BOX if scale < 1 else
                                                   Image.Resampling.BICUBIC)  # fmt: skip
        labels = Image.fromarray(self.labels).resize(size, Image.Resampling.NEAREST)
        return Pair(self.place, self.name, np.asarray(image), np.asarray(labels), pixel,
                    self.held_back)  # fmt: skip


def dubai(images: Path) -> Iterator[Pair]:
    """Read the pairs of Dubai.

    Parameters
    ----------
    images
        The folder `satellite`; masks lie beside it in `semantic`.
    """
    for path in sorted((images / "dubai").glob("tile*.jpg")):
        image = np.asarray(Image.open(path).convert("RGB"))
        mask = Image.open(images.parent / "semantic" / "dubai" / f"{path.stem}.png")
        colors = packed(np.asarray(mask.convert("RGB")))
        labels = np.full(colors.shape, ANYTHING, np.uint8)
        for color, label in DUBAI_LEGEND.items():
            labels[colors == color] = label
        held_back = path.stem.startswith(DUBAI_HELD_BACK)
        yield Pair("Dubai", path.stem, image, labels, DUBAI_PIXEL, held_back)


def packed(colors: NDArray[np.uint8]) -> NDArray[np.uint32]:
    """Return 0xRRGGBB of (..., 3) colours."""
    wide = colors.astype(np.uint32)
    return (wide[..., 0] << 16) | (wide[..., 1] << 8) | wide[..., 2]


def kampala(images: Path) -> Iterator[Pair]:
    """Read the ground of Kampala, joined from map tiles; the finest zoom lies on top.

    Parameters
    ----------
    images
        The folder `satellite`; masks lie beside it in `semantic`.
    """
    tiles = sorted((images / "kampala").glob("z*.png"))
    corners = [_corner(path) for path in tiles]
    west, north = (min(corner[axis] for corner in corners) for axis in (0, 1))
    columns, rows = (
        max(corner[axis] + corner[2] for corner in corners) - low
        for axis, low in ((0, west), (1, north))
    )
    image = np.zeros((rows, columns, 3), np.uint8)
    labels = np.full((rows, columns), ANYTHING, np.uint8)
    for path, (x, y, side) in zip(tiles, corners, strict=True):
        where = slice(y - north, y - north + side), slice(x - west, x - west + side)
        picture = Image.open(path).convert("RGBA").resize((side, side))
        mask = Image.open(images.parent / "semantic" / "kampala" / path.name).convert("L")
        house = np.asarray(mask.resize((side, side), Image.Resampling.NEAREST)) > 127
        seen = np.asarray(picture)[:, :, 3] > 127
        image[where][seen] = np.asarray(picture)[:, :, :3][seen]
        labels[where][seen] = np.where(house, may_be("building"), KAMPALA_REST)[seen]
    pixel = EQUATOR * math.cos(math.radians(KAMPALA_LATITUDE)) / (TILE << KAMPALA_ZOOM)
    cut = round(columns * KAMPALA_SPLIT)
    yield Pair("Kampala", "west", image[:, :cut], labels[:, :cut], pixel, held_back=False)
    yield Pair("Kampala", "east", image[:, cut:], labels[:, cut:], pixel, held_back=True)


def _corner(path: Path) -> tuple[int, int, int]:
    """Return west, north and side of a map tile in pixels of the finest zoom."""
    zoom, x, y = (int(word.lstrip("z")) for word in path.stem.split("_"))
    side = TILE << (KAMPALA_ZOOM - zoom)
    return x * side, y * side, side


def synthetic(folder: Path) -> Iterator[Pair]:
    """Read what `synthesize.py` has rendered."""
    for path in sorted(folder.glob("*.png")):
        mask = path.with_suffix(".mask.png")
        if mask.is_file():
            image = np.asarray(Image.open(path).convert("RGB"))
            yield Pair("CityX", path.stem, image, np.asarray(Image.open(mask)), PIXEL, False)
