"""What is said of all things of a list, of all of a town, or with a label, is read of each."""

import pytest

from cityx.language import read_brief


def slots(text):
    return {slot.key: slot.value for slot in read_brief(text).slots}


@pytest.mark.parametrize(
    ("text", "kinds", "side"),
    [
        ("A town with a school, a museum and a bakery, all three at the southern end.",
         ("school", "museum", "bakery"), "south"),
        ("A town with a school and a museum (both in the north-east corner) and a hotel.",
         ("school", "museum"), "northeast"),
        ("In the far north there is a theatre, plus a vet.", ("theatre", "vet"), "north"),
        ("A town. In the north a school and a library, in the south a church.",
         ("school", "library"), "north"),
        ("On the outskirts: a prison, a cemetery, and a windmill.",
         ("prison", "cemetery", "windmill"), "edge"),
        ("We need a courthouse and a bank. Both should be in the heart of town.",
         ("courthouse", "bank"), "middle"),
    ],
)  # fmt: skip
def test_each_thing_of_a_list_is_where_all_are(text, kinds, side):
    found = slots(text)
    assert {kind: found.get(f"{kind}.side") for kind in kinds} == dict.fromkeys(kinds, side)
    assert read_brief(text).words_unread == ()


def test_each_thing_of_a_list_has_the_distance_of_all():
    found = slots("A clinic, a school and a pharmacy, all within 300 m of the green in the middle.")
    for kind in ("clinic", "school", "pharmacy"):
        assert (found[f"{kind}.near"], found[f"{kind}.metres.max"]) == ("park", 300)
    assert found["park.side"] == "middle"


def test_what_of_a_list_cannot_be_there_is_named():
    brief = read_brief("At the southern end: a petrol station plus a 20-room casino.")
    assert ("petrol_station.side", "south") in {(one.key, one.value) for one in brief.slots}
    assert "casino" in brief.words_unread
    brief = read_brief("In the park, a kiosk, a pond and a statue.")
    assert any("where the pond is" in note.text for note in brief.notes)
    assert slots("In the park, a kiosk, a pond and a statue.")["statue.near"] == "park"


@pytest.mark.parametrize(
    "text",
    [
        "A park with a kiosk, a library and a museum, all in the north.",
        "A school by the river, a library and a museum, all in the north.",
        "A church and a school, each in a different corner.",
        "In the north of the park, a kiosk and a statue.",
        "A library, a school and a museum, both in the north.",
    ],
)
def test_a_list_that_may_be_another_one_is_left(text):
    brief = read_brief(text)
    assert not any(slot.key.endswith(".side") for slot in brief.slots)
    assert brief.words_unread or brief.notes


@pytest.mark.parametrize(
    ("text", "key", "value"),
    [
        ("A test site for robots: 500 m x 500 m, flat, wide pavements.", "terrain", "flat"),
        ("I'd like a town where the streets are narrow and the ground is flat.", "terrain", "flat"),
        ("A town whose roofs are all flat.", "building.roof", "flat"),
        ("Type: town. Roofs: flat. Streets: narrow.", "building.roof", "flat"),
        ("A town. Floors: 3 to 4.", "building.floors.max", 4),
        ("Small town; max. 5 floors.", "building.floors.max", 5),
        ("Small town. No more than five storeys, cobbled streets.", "building.floors.max", 5),
        ("A gritty little town for a crime novel: at most five storeys, a pub.",
         "building.floors.max", 5),
        ("Every building 3-4 floors with a flat green roof.", "building.floors.min", 3),
        ("A hill town with terracotta roofs everywhere.", "building.roof", "tile"),
        ("A town where the pavements are wide.", "sidewalk.width", "wide"),
        ("Wooden houses in rows.", "building.material", "timber"),
        ("Thirty-odd houses.", "building.count", 30),
        ("A pond with offices round it.", "office.by", "pond"),
        ("A mosque with a square minaret 35 m high.", "mosque.minaret.height", 35),
        ("A school with a playground and a red roof.", "school.roof_color", "red"),
        ("Narrow lanes climbing to a lighthouse at the top.", "lighthouse.side", "high"),
        ("A town of no cars, 1 km across.", "size.x", 1000),
        ("A tram line straight down the middle.", "tram_line.side", "middle"),
        ("It is still dark, street lamps on.", "time", "night"),
    ],
)  # fmt: skip
def test_what_is_certain_is_kept(text, key, value):
    assert slots(text)[key] == value


@pytest.mark.parametrize(
    ("text", "key"),
    [
        ("In the north there are hills and the ground is flat.", "terrain"),
        ("If possible the streets are narrow and the ground is flat.", "terrain"),
        ("A house, flat, with a garden.", "terrain"),
        ("A dark, gritty town with dark, narrow lanes.", "time"),
        ("A square with people, 60 m across.", "size.x"),
        ("A church by the river and red roofs.", "church.roof_color"),
        ("A cable-car station at the top of the hill.", "station.side"),
        ("A tall brick chimney, 60 m.", "building.height"),
        ("A town with a square where there are no cars.", "not"),
    ],
)
def test_what_is_said_of_a_part_is_not_put_on_all(text, key):
    brief = read_brief(text)
    values = {slot.value for slot in brief.slots if slot.key == key}
    assert values <= {"hilly"}
    assert key != "not" or not brief.negated


@pytest.mark.parametrize(
    ("text", "element"),
    [("A village on a river", "river"), ("A city near a canal, with 60 houses", "canal"),
     ("A suburb next to a forest", "forest"), ("A hamlet beside a pond", "pond")],
)  # fmt: skip
def test_what_a_whole_town_lies_by_may_be_anywhere_in_it(text, element):
    brief = read_brief(text)
    assert element in brief.values("element")
    assert not brief.notes


def test_what_stands_every_so_many_metres_is_on_all_streets_or_on_one():
    assert dict(read_brief("Lamps every 25 m on all streets").items()) == {
        "streetlight.spacing": 25
    }
    brief = read_brief("A village with benches every 50 m along the high street")
    assert [one.text for one in brief.then] == ["put benches every 50 m along the high street"]


def test_a_street_that_is_only_named_is_there():
    assert "main_street" in read_brief("A town with one main street").values("element")


def test_what_a_town_lies_round_or_in_is_left_open():
    assert read_brief("A town around a lake").notes
    assert read_brief("A village in a forest").notes
