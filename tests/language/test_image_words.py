"""What a text tells of the images that came with it."""

import pytest

from cityx.language.reading import read_brief

MAP = [("a.png", "semantic")]


def told(text, inputs=MAP):
    brief = read_brief(f"A map of a town. {text}.", inputs=inputs)
    assert not brief.unread
    assert not any("left open" in note.text for note in brief.notes)
    return {slot.key: slot.value for slot in brief.slots if slot.key.startswith("read.")}


@pytest.mark.parametrize(
    ("text", "metres"),
    [
        ("0.5 m per pixel", 0.5), ("half a metre to the pixel", 0.5), ("One pixel is 2 m", 2.0),
        ("Resolution 30 cm", 0.3), ("1 m cells", 1.0), ("A pixel stands for 50 cm", 0.5),
        ("0.6 m/px", 0.6), ("GSD 0.25 m", 0.25), ("Each pixel being 1 ft", 0.3048),
    ],
)  # fmt: skip
def test_metres_of_a_pixel(text, metres):
    assert told(text) == {"read.pixel": metres}


@pytest.mark.parametrize("text", ["Colours are Dubai standard", "Use the Dubai palette"])
def test_legends_that_are_known(text):
    assert told(text) == {"read.legend": "dubai"}


def test_heights_of_black_and_white():
    found = told("Black is 3 m and white 95 m", [("a.png", "height")])
    assert found == {"read.lowest": 3.0, "read.highest": 95.0}


def test_cells_without_an_image_are_none():
    brief = read_brief("A prison with 2 m cells and a town around it.")
    assert not any(slot.key.startswith("read.") for slot in brief.slots)


def test_looks_are_told_of_all_but_where_the_text_says_most():
    def share(text):
        return next(g.predicate for g in read_brief(text).goals if "material" in g.predicate)

    assert share("A town of stone houses.").endswith(">= 0.95")
    assert share("A town of mostly stone houses.").endswith(">= 0.6")
