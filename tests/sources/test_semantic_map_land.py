"""Paved land is paving and void stays void, measured on the finished ground."""

import numpy as np
import pytest
import rasterio
from PIL import Image

import cityx

SIZE, PIXEL = 160, 0.5
COURT = (slice(20, 70), slice(20, 70))  # rows and columns of what is asked about
MIDDLE = np.array([(-17.5, 17.5)])  # of the court, metres
LAWN = np.array([(-25.0, -25.0)])


def town(road, house, land, special):
    """A street, four houses on land, and a court of the special class."""
    picture = np.empty((SIZE, SIZE, *np.shape(land)), np.uint8)
    picture[:] = land
    picture[:, 73:87] = road
    picture[COURT] = special
    for y, x in ((100, 100), (100, 20), (20, 100), (60, 130)):
        picture[y : y + 24, x : x + 20] = house
    return picture


def built(path, legend):
    return cityx.build(path, legend=legend, pixel=PIXEL, lod=0).city


@pytest.mark.filterwarnings("ignore::rasterio.errors.NotGeoreferencedWarning")
@pytest.mark.parametrize(
    ("legend", "classes"),
    [
        ("plain", ((128, 128, 128), (255, 0, 0), (0, 255, 0), (255, 255, 0))),
        ("isprs", ((255, 255, 255), (0, 0, 255), (0, 255, 255), (255, 255, 255))),
        ("gothenburg", (1, 2, 5, 1)),
    ],
)
def test_paved_land_is_paving(tmp_path, legend, classes):
    Image.fromarray(town(*classes)).save(tmp_path / "paved.png")
    city = built(tmp_path / "paved.png", legend)
    assert city.ground.on(MIDDLE, "plaza").all()
    assert city.ground.on(LAWN, "grass").all()
    assert not any("void" in note for note in city.notes)


DUBAI = ((0x6E, 0xC1, 0xE4), (0x3C, 0x10, 0x98), (0xFE, 0xDD, 0x3A))


def _transparent(path):
    alpha = np.full((SIZE, SIZE, 1), 255, np.uint8)
    alpha[COURT] = 0
    Image.fromarray(np.dstack([town(*DUBAI, DUBAI[2]), alpha])).save(path)


def _without_data(path):
    options = {"driver": "GTiff", "dtype": "uint8", "count": 1, "nodata": 255}
    with rasterio.open(path, "w", width=SIZE, height=SIZE, **options) as file:
        file.write(town(3, 2, 6, 255), 1)


def _unlabelled(path):
    Image.fromarray(town(*DUBAI, (0x9B, 0x9B, 0x9B))).save(path)


def _of_no_class(path):
    Image.fromarray(town(*DUBAI, (10, 250, 10))).save(path)


@pytest.mark.filterwarnings("ignore::rasterio.errors.NotGeoreferencedWarning")
@pytest.mark.parametrize(
    ("write", "name", "legend"),
    [
        (_transparent, "alpha.png", "dubai"), (_without_data, "nodata.tif", "loveda-values"),
        (_unlabelled, "unlabelled.png", "dubai"), (_of_no_class, "strange.png", "dubai"),
    ],
)  # fmt: skip
def test_void_stays_void_and_is_said(tmp_path, write, name, legend):
    write(tmp_path / name)
    city = built(tmp_path / name, legend)
    assert city.ground.on(MIDDLE, "void").all()
    assert not city.ground.on(LAWN, "void").any()
    void = city.layout.areas[city.layout.areas["kind"] == "void"]
    assert void.geometry.area.sum() == pytest.approx(2500 * PIXEL**2, rel=0.1)
    share = 100 * 2500 / SIZE**2
    assert any(f"{share:.2g} % of the pixels say nothing" in note for note in city.notes)


def test_colours_mixed_along_a_border_are_no_void(tmp_path):
    picture = town(*DUBAI, DUBAI[2])
    picture[:, 72] = picture[:, 87] = (10, 250, 10)
    Image.fromarray(picture).save(tmp_path / "seams.png")
    assert "void" not in set(built(tmp_path / "seams.png", "dubai").layout.areas["kind"])
