"""What a description places in words that no order has becomes an order, or a relation."""

import pytest

from cityx.language import read_brief


@pytest.mark.parametrize(
    ("text", "commands"),
    [
        ("Streets lined with parked cars.", ["put parked cars along the streets"]),
        ("A town with parked cars.", ["put parked cars along the streets"]),
        (
            "A square surrounded by benches and plane trees",
            ["put benches around the square", "put plane trees around the square"],
        ),
        (
            "A square surrounded by five-storey buildings.",
            ["make the buildings around the square five-storey"],
        ),
        (
            "A hospital with an ambulance at the entrance.",
            ["put an ambulance at the entrance of the hospital"],
        ),
        (
            "A fountain in the middle of the square, with four benches round it.",
            ["put four benches round the fountain"],
        ),
        (
            "A hospital with an ambulance at the entrance, and a car park with 20 cars in it.",
            ["put an ambulance at the entrance of the hospital", "put 20 cars in the car park"],
        ),
        (
            "A roundabout with a statue in the middle",
            ["put a statue in the middle of the roundabout"],
        ),
        ("A park with a pond in its middle", ["put a pond in the middle of the park"]),
        (
            "Roadworks on the main street: cones, a barrier and three workers.",
            [
                "put cones on the main street",
                "put a barrier on the main street",
                "put three workers on the main street",
            ],
        ),
        ("100 pedestrians crossing.", ["put 100 pedestrians on the zebra crossings"]),
        ("A square where 20 people are crossing.", ["put 20 people on the zebra crossings"]),
        (
            "A procession of 60 people marching down the main street to the church.",
            ["put A procession of 60 people marching down the main street to the church"],
        ),
        (
            "A food truck on the square with a queue of eight people.",
            ["put a queue of eight people at the food truck"],
        ),
        ("Lamps on both sides of the main street", ["put Lamps on both sides of the main street"]),
        ("Two policemen at the crossroads.", ["put Two policemen at the crossroads"]),
    ],
)
def test_what_is_placed_in_other_words_is_put_there(text, commands):
    brief = read_brief(text)
    assert [one.text for one in brief.then] == commands
    assert not brief.unread


@pytest.mark.parametrize(
    "text",
    [
        "A wide avenue lined with trees",  # trees of streets have slots
        "A playground surrounded by a hedge",
        "A town with 60 parked cars",
        "A roundabout on the main street.",  # of which no change of a city makes one
    ],
)
def test_what_slots_say_is_no_order(text):
    assert not read_brief(text).then


def test_many_who_cross_are_no_crossings():
    assert not read_brief("A town with 100 pedestrians crossing.").value("crosswalk.count")


@pytest.mark.parametrize(
    ("text", "key"),
    [
        ("A cafe on the south side of the Thames.", "cafe.side"),
        ("A roundabout at the northern end of the main street.", "roundabout.side"),
    ],
)
def test_a_side_of_another_thing_is_no_side_of_the_town(text, key):
    brief = read_brief(text)
    assert not brief.value(key)
    assert any("side of" in note.text for note in brief.notes)


@pytest.mark.parametrize(
    ("text", "predicate"),
    [
        ("A town with a river through it.", "dist(river, center) <= 120"),
        ("A river with a stone bridge over it.", "crosses(bridge, river)"),
        ("A long bridge over a wide river.", "crosses(bridge, river)"),
        ("A village with a central church.", "dist(building, tag=church, center) <= 120"),
    ],
)
def test_over_through_and_central_are_measured(text, predicate):
    assert predicate in [goal.predicate for goal in read_brief(text).goals]
