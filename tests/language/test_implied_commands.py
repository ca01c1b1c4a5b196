"""Phrases of a description that only a change of the finished city brings about are commands."""

import pytest

from cityx.language import read_brief


def commands_of(text, **more):
    return [one.text for one in read_brief(text, **more).then]


@pytest.mark.parametrize(
    ("text", "command"),
    [
        ("A town with six benches beside the fountain", "put six benches beside the fountain"),
        ("Bins along the canal, a castle in the north", "put Bins along the canal"),
    ],
)
def test_things_that_stand_somewhere_are_put_there(text, command):
    assert commands_of(text) == [command]


@pytest.mark.parametrize(
    ("text", "command"),
    [
        ("A village. Close the main street to cars.", "Close the main street to cars"),
        ("Red houses; make the doors of the houses blue", "make the doors of the houses"),
        ("A town by a river. Line the river with poplars and add a pier", "Line the river with"),
    ],
)
def test_orders_are_commands(text, command):
    assert [one for one in commands_of(text) if one.startswith(command)]


def test_what_a_command_needs_is_still_asked_of_the_town():
    brief = read_brief("A village with six benches beside the fountain")
    assert ("element", "fountain") in brief.items()
    assert not brief.value("bench.count")
    assert not brief.unread


@pytest.mark.parametrize(
    "text",
    [
        "A village with a church in the middle and three parks",  # the layout places these
        "A town without benches beside the fountain",
        "A town with six gargoyles beside the fountain",
        "Build the town at night, in the rain",
        "Houses: narrow, gabled, 3 to 5 floors",
    ],
)
def test_what_slots_say_and_what_is_denied_or_unknown_is_no_command(text):
    assert not commands_of(text)


def test_a_command_keeps_its_place_in_the_text():
    text = "A village with six benches beside the fountain."
    (one,) = read_brief(text).then
    assert text[slice(*one.span)] == "six benches beside the fountain"


def test_a_city_that_exists_has_edits_and_no_commands():
    brief = read_brief("Put six benches beside the fountain", base=True)
    assert brief.edits
    assert not brief.then


@pytest.mark.parametrize(
    ("text", "command"),
    [
        ("A queue of cars at the traffic lights.", "A queue of cars at the traffic lights"),
        ("A school with 10 cars queueing outside it.", "10 cars queueing outside the school"),
        ("A town. 20 cars are waiting at the crossing.", "20 cars are waiting at the crossing"),
        ("A lollipop lady at the crossing.", "A lollipop lady at the crossing"),
        ("Two guards in front of the church.", "Two guards in front of the church"),
    ],
)  # fmt: skip
def test_who_queues_and_who_watches_is_put_there_or_named(text, command):
    brief = read_brief(text)
    assert [one.text for one in brief.then] == [f"put {command}"] * bool(command)
    assert command or brief.unread or brief.notes


@pytest.mark.parametrize(
    ("text", "command"),
    [
        ("Replace the parking lots by parks.", "Replace the parking lots by parks"),
        ("Add 3 m to every building.", "Add 3 m to every building"),
        ("Make every house one floor taller.", "Make every house one floor taller"),
        ("Keep the map, but replace the church by a mosque.", "replace the church by a mosque"),
        ("Use the map, and then demolish the church.", "demolish the church"),
        ("Move the bus stop 20 m north.", "Move the bus stop 20 m north"),
    ],
)
def test_an_order_of_what_a_map_holds_is_carried_out_on_it(text, command):
    brief = read_brief(text, inputs=[("m.osm", "osm")])
    assert [one.text for one in brief.then] == [command]
    assert {slot.key for slot in brief.slots} == {"source"}


def test_what_has_none_is_not_denied():
    brief = read_brief("Put trees along every street that has none.", inputs=[("m.osm", "osm")])
    assert not brief.negated
    assert "none" in brief.words_unread
