"""What compares numbers or heights of two kinds is no wish for most of a town to be of either."""

import pytest

from cityx.language import read_brief


def slots(text):
    return {slot.key: slot.value for slot in read_brief(text).slots}


def test_a_factor_between_two_kinds_of_buildings_gives_their_shares():
    assert slots("Twice as many houses as shops.") == {"house.share": 0.6667, "shop.share": 0.3333}
    assert slots("Three times as many flats as offices.") == {
        "apartment.share": 0.75, "office.share": 0.25,
    }  # fmt: skip


@pytest.mark.parametrize(
    "text", ["More trees than houses.", "Twice as many parked cars as bicycles."]
)
def test_other_comparisons_of_numbers_are_left_open(text):
    brief = read_brief(text)
    assert not brief.slots
    assert any("compared" in note.text for note in brief.notes)


@pytest.mark.parametrize(
    "text",
    ["A village with nothing taller than the church.", "No building is higher than the church."],
)
def test_what_nothing_is_taller_than_is_the_tallest(text):
    assert slots(text)["church.height"] == "tallest"
    assert not read_brief(text).negated


def test_what_only_one_building_is_is_not_said_of_all():
    assert slots("The town hall is the only building over 20 m.") == {"element": "town_hall"}


def test_people_of_whom_a_town_is_the_home_are_inhabitants():
    assert slots("A small town, home to 3,000 people.") == {"size": "small", "population": 3000}


def test_tall_houses_are_no_towers():
    assert "building.height" not in slots("Tall houses along a canal.")


@pytest.mark.parametrize(
    ("text", "command"),
    [
        ("A village where every third house is yellow and the others are white.",
         "paint every third house yellow and the rest white"),
        ("Every other house has solar panels.", "give every other house solar panels"),
        ("All houses are white except the ones at the market square.",
         "paint all houses except the ones at the market square white"),
        ("Apart from the church, all buildings are of wood.",
         "clad all buildings except the church in wood"),
        ("A fishing village with colourful houses.", "paint the houses colourful"),
    ],
)  # fmt: skip
def test_what_is_said_of_so_many_or_all_but_some_becomes_a_command(text, command):
    brief = read_brief(text)
    assert [one.text for one in brief.then] == [command]
    assert not brief.unread
