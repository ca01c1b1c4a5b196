"""Looks of the buildings of a part of a town, blocks by two numbers, and words beside numbers."""

from __future__ import annotations

import pytest

from cityx.language.brief import Clarify
from cityx.language.reading import read_brief


def _said(text: str) -> dict[str, object]:
    return {slot.key: slot.value for slot in read_brief(text).slots}


@pytest.mark.parametrize(
    ("text", "told"),
    [
        (
            "A grid town. Brick offices of 4 to 8 storeys in the middle.",
            {"office.part": "center", "office.material": "brick", "office.floors.max": 8},
        ),
        (
            "Wooden cottages with thatched roofs around the pond.",
            {"cottage.by": "pond", "cottage.material": "timber", "cottage.roof": "thatch"},
        ),
        (
            "Low houses with red roofs at the edge.",
            {"house.part": "edge", "house.height": "low", "house.roof_color": "red"},
        ),
        (
            "Houses of at most 7 m along the river.",
            {"house.by": "river", "house.height.max": 7},
        ),
    ],
)
def test_looks_of_the_buildings_of_a_part_are_theirs(text, told):
    said = _said(text)
    assert told.items() <= said.items()
    assert not [key for key in said if key.startswith("building.")]


@pytest.mark.parametrize(
    ("text", "columns", "rows"),
    [
        ("A downtown, six blocks by four", 6, 4),
        ("Four rows of six blocks, each 80 m by 120 m.", 6, 4),
        ("Three columns of five blocks", 3, 5),
        ("A grid six blocks long and three blocks wide.", 3, 6),
        ("a grid, 4 blocks wide and 9 deep", 4, 9),
    ],
)
def test_blocks_are_counted_by_two_numbers(text, columns, rows):
    said = _said(text)
    assert (said["block.columns"], said["block.rows"]) == (columns, rows)
    assert "block.count" not in said


@pytest.mark.parametrize(
    ("text", "key", "value"),
    [
        ("Skyscrapers (200m+)", "building.height.min", 200),
        ("10+ churches", "church.count.min", 10),
        ("A town with 6+ floor houses", "building.floors.min", 6),
        ("Houses of dark wood", "building.material", "timber"),
        ("At least three dead-end lanes", "dead_end.count.min", 3),
        ("A road with a roundabout at either end", "roundabout.count", 2),
        ("Towers in the middle, houses further out, 12 storeys max.", "building.floors.max", 12),
        ("A town of houses of 6 floors", "building.type", "apartment"),
    ],
)
def test_what_is_said_is_read_as_it_is_meant(text, key, value):
    assert _said(text)[key] == value


def test_a_wood_is_a_forest_and_wood_a_material():
    brief = read_brief("Houses of dark wood, and a dark wood to the north.")
    assert ("element", "forest") in {(slot.key, slot.value) for slot in brief.slots}
    assert ("building.material", "timber") in {(slot.key, slot.value) for slot in brief.slots}


@pytest.mark.parametrize(
    ("text", "contradicts"),
    [
        ("Tall towers of 200 m", False),
        ("A narrow river of 40 m", False),
        ("Tall buildings, none over 6 m", True),
        ("Low buildings of at least 40 m", True),
    ],
)
def test_a_word_contradicts_only_numbers_that_it_cannot_stand_beside(text, contradicts):
    assert bool(read_brief(text).conflicts) == contradicts


@pytest.mark.parametrize(
    "text",
    ["Recreate the street in the photo.", "Build our street from the attached survey."],
)
def test_a_file_that_did_not_come_along_is_asked_for(text):
    assert any(question.text.startswith("Which file") for question in read_brief(text).questions)


def test_attached_garages_are_no_file():
    assert not read_brief("A street of houses with attached garages").questions


def test_a_contradiction_names_the_words_that_were_not_understood_as_well():
    brief = read_brief("Tall buildings, none over 6 m, and a zorblax.")
    said = str(Clarify(brief, brief.told))
    assert "zorblax" in said
    assert "6 m" in said


def test_what_is_denied_in_an_unknown_place_is_denied_there_alone():
    assert not read_brief("A town. No cars on the course.").negated
    assert read_brief("A town. No cars on the street.").negated


@pytest.mark.parametrize(
    ("text", "not_read"),
    [
        ("A town with no road markings", ("not", "road")),
        ("No park benches", ("not", "park")),
        ("Houses on red sand ground", ("building.color", "beige")),
        ("Buildings can be plain boxes", ("terrain", "flat")),
        ("A market hall holding 500 people", ("pedestrian.count", 500)),
        ("A town with a lollipop lady", ("agent", "woman")),
        ("Heritage office here. A town.", ("building.type", "office")),
        ("A railway crossing the town", ("element", "level_crossing")),
        ("Planters outside anything tagged restaurant", ("element", "restaurant")),
        ("400 shoppers, a few dogs on leads", ("pedestrian.count.max", 6)),
        ("A fence with a gatehouse", ("element", "gate")),
    ],
)
def test_what_only_looks_like_a_wish_is_none(text, not_read):
    brief = read_brief(text)
    assert not_read not in {(slot.key, slot.value) for slot in (*brief.slots, *brief.negated)}


def test_what_is_told_of_houses_is_no_command_of_its_own():
    assert not read_brief("Detached houses with big gardens right at the edge").then
    assert read_brief("A town with six benches beside the fountain").then


@pytest.mark.parametrize("text", ["- one set of lights", "- twenty houses\n- two ponds", "-one"])
def test_a_bullet_before_a_number_is_none_of_it(text):
    assert read_brief(text).text == text
