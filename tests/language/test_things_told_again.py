"""Words that speak of a thing again or with others: "ones", "each", "and next to", between two."""

import pytest

from cityx.language import read_brief


def slots(text):
    return [(slot.key, slot.value) for slot in read_brief(text).slots]


def test_ones_are_what_was_named_in_the_plural():
    told = slots("Red houses along the river, yellow ones along the main street")
    assert ("house within 60 m of river.color", "red") in told
    assert ("house within 60 m of main_street.color", "yellow") in told
    assert ("house.color", "red") not in told


@pytest.mark.parametrize(
    ("text", "kind"),
    [
        ("Scaffolding on the town hall and a crane behind it", "crane"),
        ("A port with a crane", "harbour_crane"),
        ("A crane beside the quay of the harbour", "harbour_crane"),
    ],
)
def test_a_crane_is_of_a_port_where_there_is_one(text, kind):
    assert [value for key, value in slots(text) if "crane" in str(value)][:1] == [kind]


@pytest.mark.parametrize(
    "text",
    ["No river, but two bridges", "A town without water, with a bridge", "A port, no sea"],
)
def test_water_that_is_needed_is_not_denied(text):
    assert any(one.code.startswith("denied_and_wanted") for one in read_brief(text).conflicts)


@pytest.mark.parametrize(
    "text",
    ["No river, a bridge over the railway", "A harbour at the lake, no sea", "No sea, a bridge"],
)
def test_what_lies_at_something_else_is_no_contradiction(text):
    assert not read_brief(text).conflicts


def test_a_number_of_the_others_counts_no_buildings():
    brief = read_brief("The houses facing the park are three storeys, all others two")
    assert "building.count" not in [slot.key for slot in brief.slots]
    assert any("(of the others)" in note.text for note in brief.notes)


def test_each_is_of_what_was_counted():
    told = slots("Ten towers around the lake, each at least 60 m high")
    assert ("building.height.min", 60) in told
    assert "lake.height.min" not in dict(told)


def test_a_second_place_is_of_the_same_thing():
    brief = read_brief("The hospital stands opposite the fire station and next to the park")
    told = [(slot.key, slot.value) for slot in brief.slots]
    assert ("hospital.near", "fire_station") in told
    assert "fire_station.near" not in dict(told)
    assert any("(where the hospital is)" in note.text for note in brief.notes)


def test_a_square_between_two_buildings_has_them_on_both_sides():
    told = dict(slots("A square between the church and the town hall with a statue in the middle"))
    assert told["church.near"] == "town_hall"
    assert (told["church.relation"], told["church.second"]) == ("across", "plaza")
    assert (told["town_hall.near"], told["statue.near"]) == ("plaza", "plaza")


@pytest.mark.parametrize(
    ("text", "key", "place"),
    [
        ("A restaurant overlooking the sea", "restaurant.near", "sea"),
        ("The library backs onto the park", "library.near", "park"),
        ("A bakery next door to the pub", "bakery.near", "bar"),
    ],
)
def test_verbs_of_houses_tell_what_they_stand_near(text, key, place):
    assert dict(slots(text))[key] == place


def test_what_stands_behind_something_may_be_named_after_it():
    told = dict(slots("A school next to the park, and behind the school a football pitch"))
    assert told["football_pitch.near"] == "school"
    assert told["football_pitch.relation"] == "behind"


@pytest.mark.parametrize(
    ("text", "command", "kept"),
    [
        ("A bus waiting at the bus stop in front of the town hall",
         "put A bus waiting at the bus stop in front of the town hall",
         ("bus_stop.relation", "before")),
        ("A queue of 12 people at the bus stop by the church",
         "put A queue of 12 people at the bus stop by the church", ("bus_stop.near", "church")),
    ],
)  # fmt: skip
def test_a_place_that_a_command_needs_stays_where_it_is_told(text, command, kept):
    brief = read_brief(text)
    assert [one.text for one in brief.then] == [command]
    assert kept in [(slot.key, slot.value) for slot in brief.slots]


def test_houses_on_a_river_are_along_it():
    (edit,) = read_brief("Make the houses on the river white", base=True).edits
    assert (edit.target.along, edit.target.inside) == ("river", "")


def test_a_place_may_be_told_twice_of_one_thing():
    told = dict(slots("A hospital with its car park behind it"))
    assert (told["parking_lot.near"], told["parking_lot.relation"]) == ("hospital", "behind")
