"""Words that are said of one thing, or of no thing at all, are not put on a whole town."""

import pytest

from cityx.language import read_brief


def slots(text, **options):
    return [(slot.key, slot.value) for slot in read_brief(text, **options).slots]


@pytest.mark.parametrize(
    ("text", "key"),
    [
        ("They leave the square by three streets", "roads.count"),
        ("A square test district with shops", "element"),
        ("Houses, and somewhere to park the car", "element"),
        ("A promenade with palm trees every 12 metres", "nature.spacing"),
        ("Terraced houses, mid-rise flats and towers", "building.height"),
        ("A town where all shops are shut but one bar with its neon on", "lights"),
    ],
)
def test_what_is_said_of_one_thing_is_not_of_all(text, key):
    brief = read_brief(text)
    assert key not in [slot.key for slot in brief.slots]
    assert brief.words_unread or brief.notes


def test_the_side_of_a_gate_by_which_something_stands_is_not_that_of_all():
    text = "A town with three gates and a market hall next to the north gate"
    brief = read_brief(text)
    assert "gate.side" not in [slot.key for slot in brief.slots]
    assert any("north" in note.text for note in brief.notes)


def test_a_hyphen_makes_no_order():
    assert not read_brief("A test of a lane-keeping system at a big crossing").kept


def test_a_lake_holds_the_island_of_a_town():
    assert ("island.near", "lake") in slots("A quarter on an island in a lake")
    assert ("island.near", "sea") in slots("A quarter on an island")


def test_heights_in_brackets_are_those_of_the_buildings():
    found = slots("White hotels facing the beach (none taller than 25 m)")
    assert ("hotel.height.max", 25) in found


def test_a_quarter_in_a_name_is_none_of_a_map():
    given = {"inputs": [("m.osm", "osm")]}
    assert "district" not in dict(slots("This bit of the East Village in snow", **given))
    assert ("district", "village") in slots("A village in snow", **given)


@pytest.mark.parametrize(
    ("text", "pair"),
    [
        ("For a class: 600 m x 600 m, with houses", ("size.x", 600)),
        ("Terraces and towers, all with a street width of 14 m", ("roads.width", 14)),
        ("A town with a ring road outside, and houses", ("roads.rings", 1)),
        ("A rush hour test for buses", ("traffic", "heavy")),
        ("A mosque, no cars at all. A mosque with a tower", ("element", "mosque")),
        ("A clinic and a library in the middle", ("clinic.side", "middle")),
    ],
)
def test_what_is_said_of_all_is_read(text, pair):
    assert pair in slots(text)


def test_dead_ends_of_a_suburb_are_counted():
    goals = [goal.predicate for goal in read_brief("A suburb with cul-de-sacs").goals]
    assert "n(dead_end) >= 3" in goals
