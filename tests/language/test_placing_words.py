"""Where things stand to others, how far away and how large they are, in words."""

import pytest

from cityx.language import read_brief
from cityx.language.asked import slots_of_brief
from cityx.protocol.serving import DO


def slots(text, **options):
    return {slot.key: slot.value for slot in read_brief(text, **options).slots}


def elements_of(text):
    asked = slots_of_brief(read_brief(text))[DO]
    return {args["kind"]: args for action, args in asked if action == "layout/elements-v1"}


@pytest.mark.parametrize(
    ("text", "kind", "near", "relation"),
    [
        ("A harbour with a stone pier and a lighthouse at the end of it", "lighthouse", "pier",
         "end"),
        ("A stone quay with a lighthouse at the end and a cafe", "lighthouse", "harbour", "end"),
        ("A church at the far end of the high street", "church", "main_street", "end"),
        ("A bakery on the high street, and houses", "bakery", "main_street", "at"),
        ("A mall with a car park on the main road", "mall", "main_street", "at"),
        ("A town with a pharmacy across the street from the school", "pharmacy", "school",
         "opposite"),
        ("A cinema outside the town hall", "cinema", "town_hall", "at"),
        ("A town with a pub on a street corner", "bar", "corner", "at"),
        ("A harbour with cranes on the quay and a church", "harbour_crane", "harbour", "at"),
        ("A seaside town with a museum on the seafront", "museum", "sea", "at"),
        ("A town with a cafe on the high street and a bakery opposite it", "bakery", "cafe",
         "opposite"),
        ("A market square in the middle and a cathedral next to it", "cathedral", "plaza", None),
        ("A school in the middle with a playing field", "sports_field", "school", None),
    ],
)  # fmt: skip
def test_a_thing_stands_to_another_as_it_is_told(text, kind, near, relation):
    found = slots(text)
    assert found[f"{kind}.near"] == near
    assert found.get(f"{kind}.relation") == relation
    brief = read_brief(text)
    assert brief.words_unread == ()
    assert not any("(where the" in note.text for note in brief.notes)
    assert elements_of(text)[kind]["near"] == near


@pytest.mark.parametrize(
    ("text", "kind", "key", "metres"),
    [
        ("A hospital within 200 m of the fire station", "hospital", "metres.max", 200),
        ("A school at least 150 metres away from a pub", "school", "metres.min", 150),
        ("A town with a hotel at least 300 m from the station", "hotel", "metres.min", 300),
        ("Six wind turbines at least 500 m from the closest home", "wind_turbine", "metres.min",
         500),
    ],
)  # fmt: skip
def test_distances_have_bounds(text, kind, key, metres):
    assert slots(text)[f"{kind}.{key}"] == metres
    goals = [goal.predicate for goal in read_brief(text).goals if goal.predicate[:4] == "dist"]
    assert goals
    assert f" {'<=' if 'max' in key else '>='} {metres}" in goals[0]


@pytest.mark.parametrize(
    ("text", "kind", "size"),
    [
        ("A small clinic in a village", "clinic", "small"),
        ("A mall with a huge car park", "parking_lot", "large"),
        ("A town with a big playground", "playground", "large"),
    ],
)
def test_things_are_large_or_small(text, kind, size):
    assert slots(text)[f"{kind}.size"] == size
    assert elements_of(text)[kind]["size"] == size
    assert any("area" in goal.predicate for goal in read_brief(text).goals)


@pytest.mark.parametrize(
    ("text", "key"),
    [
        ("A cinema, and a water tower poking up behind it all", "water_tower.near"),
        ("A school with a playground and a church beside it", "church.near"),  # beside which?
        ("Café tables outside the restaurants", "cafe_set.near"),
        ("A small harbour with a stone pier", "pier.near"),  # the pier is the harbour
        ("A big shed and a small lawn", "lawn.size"),
    ],
)
def test_what_may_be_meant_otherwise_is_left(text, key):
    assert key not in slots(text)


@pytest.mark.parametrize(
    "text",
    [
        "A hill town with stone houses, a wall round it with two gates",
        "A village, and a wall around the whole lot with two gates",
        "A medieval town with a ring wall with two gates",
    ],
)
def test_a_wall_round_a_town_is_its_city_wall(text):
    found = slots(text)
    assert found["element"] == "city_wall"
    assert found["gate.count"] == 2


def test_a_wall_round_a_garden_is_none():
    brief = read_brief("A garden with a wall around it")
    assert "city_wall" not in [slot.value for slot in brief.slots]
    assert any("wall" in note.text for note in brief.notes)
