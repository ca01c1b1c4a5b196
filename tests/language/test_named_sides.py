"""A side of a thing is no side of the city: north of the river, across it, on the other bank."""

import pytest

from cityx.language import read_brief
from cityx.language.asked import slots_of_brief
from cityx.protocol.serving import DO


def slots(text):
    return {slot.key: slot.value for slot in read_brief(text).slots}


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("Shops on the north side of the main street and houses on the south side",
         {"shop.by": "north of main_street", "house.by": "south of main_street"}),
        ("Warehouses north of the river and apartment blocks south of it",
         {"warehouse.by": "north of river", "apartment.by": "south of river"}),
        ("A school on the west bank of the river and a hospital on the east bank",
         {"school.near": "river", "school.relation": "west", "hospital.relation": "east"}),
        ("A library west of the town hall", {"library.near": "town_hall",
                                            "library.relation": "west"}),
        ("A town with a hotel across the river from the cathedral",
         {"hotel.near": "cathedral", "hotel.relation": "across", "hotel.second": "river"}),
        ("A chapel on the other side of the canal from the town hall",
         {"church.near": "town_hall", "church.relation": "across", "church.second": "canal"}),
    ],
)  # fmt: skip
def test_a_side_is_of_the_thing_that_it_is_told_of(text, told):
    assert slots(text).items() >= told.items()
    assert not [key for key in slots(text) if key.endswith((".part", ".side"))]


@pytest.mark.parametrize(
    ("text", "word"),
    [
        ("To the left of the town hall stands a library, to the right a museum", "right"),
        ("A square with a church on its north side", "north"),
        ("A chapel on the other side of the river", "other"),
    ],
)
def test_a_side_that_cannot_be_told_is_named(text, word):
    brief = read_brief(text)
    assert not [one for one in brief.slots if one.key.endswith((".side", ".relation"))]
    said = [text[slice(*span)] for span in brief.unread] + [note.text for note in brief.notes]
    assert any(word in one for one in said)


def test_sides_of_the_town_stay_what_they_are():
    told = slots("A church in the north of the town, offices in the south, a park on the west side")
    assert (
        told.items()
        >= {"church.side": "north", "office.part": "south", "park.side": "west"}.items()
    )


def test_a_river_runs_so_that_it_has_the_sides_that_are_told():
    asked = dict(
        slots_of_brief(read_brief("A school west of the river, a hospital east of it"))[DO]
    )
    assert asked["layout/river-v1"]["axis"] == "north_south"


def test_the_middle_of_it_is_that_of_what_was_named():
    told = slots("Three benches in the park, a statue in the middle of it")
    assert told.items() >= {"statue.near": "park", "statue.relation": "in"}.items()
    assert "statue.side" not in told


@pytest.mark.parametrize(
    ("text", "time"),
    [
        ("A village just before sunrise", "first_light"),
        ("A village shortly after sunset", "dusk"),
        ("A village at sunrise", "sunrise"),
    ],
)
def test_before_sunrise_the_sun_is_not_up(text, time):
    assert slots(text)["time"] == time


@pytest.mark.parametrize(
    ("text", "key"),
    [
        ("A church facing west", "church.side"),
        ("A village with a school on the north side of the church and a pond on its south",
         "pond.side"),
        ("A village with an inn and a pond south of the inn", "pond.side"),
    ],
)  # fmt: skip
def test_a_side_that_is_of_a_thing_or_looked_at_is_none_of_the_site(text, key):
    told = read_brief(text)
    assert key not in {slot.key for slot in told.slots}
    assert told.notes or told.then


def test_a_clear_view_is_no_weather():
    told = read_brief("A town with a clear view of the sea")
    assert "weather" not in {slot.key for slot in told.slots}
    assert any("clear" in note.text for note in told.notes)


def test_what_people_call_a_place_is_a_name():
    told = read_brief("A village that people call the White Village")
    assert {slot.key for slot in told.slots} == {"district"}
    (command,) = read_brief("A square that people call Green Place").then
    assert command.text == "call the square Green Place"


def test_the_side_of_a_lake_on_which_a_village_lies_is_not_where_the_lake_is():
    told = read_brief("A lake with a village on its north side")
    assert "lake.side" not in {slot.key for slot in told.slots}
    assert slots("A village with a lake to its north")["lake.side"] == "north"
