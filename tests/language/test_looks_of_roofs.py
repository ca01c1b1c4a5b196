"""Materials of roofs are no materials of walls, and things are no colours."""

import pytest

from cityx.language import read_brief


@pytest.mark.parametrize(
    ("text", "key"),
    [
        ("Houses with roofs made of metal", "building.roof"),
        ("The roofs are of copper", "building.roof"),
        ("Zinc roofs like in Paris", "building.roof"),
        ("Barns with corrugated iron roofs", "barn.roof"),
        ("A church with a roof of copper", "church.roof"),
    ],
)
def test_a_metal_roof_is_a_roof(text, key):
    items = dict(read_brief(text).items())
    assert items[key] == "metal"
    assert "building.material" not in items


def test_a_roof_of_what_none_is_made_of_is_left_open():
    brief = read_brief("A town of brick houses with roofs made of glass")
    assert dict(brief.items())["building.material"] == "brick"
    assert any("roofs" in note.text for note in brief.notes)


@pytest.mark.parametrize(
    "text", ["Sand and gravel on every verge, a village", "A coast with white sand",
             "A square with roses"],
)  # fmt: skip
def test_sand_and_roses_are_no_colours(text):
    assert not any(key.endswith(".color") for key, _ in read_brief(text).items())


def test_names_of_things_are_colours_of_houses():
    values = read_brief("A town in rust and cream").values("building.color")
    assert set(values) == {"terracotta", "beige"}
