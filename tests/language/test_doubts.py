"""What is read of words is said of what they are said of, or taken back and named."""

import pytest

from cityx.language.reading import read_brief


def slots(text, **keys):
    return {(slot.key, slot.value) for slot in read_brief(text, **keys).slots}


MAP = {"inputs": [("town.osm", "osm")]}


@pytest.mark.parametrize(
    ("text", "wrong", "named"),
    [
        ("Low mud-brick houses with flat roofs", ("building.material", "brick"), "brick"),
        ("Some filigree-stone houses", ("building.material", "stone"), "stone"),
        ("shop lights are already on", ("building.type", "shop"), "shop"),
        ("hotel lights along the street", ("building.type", "hotel"), "hotel"),
        ("a town with a motel with a neon sign", ("lights", "neon"), "neon sign"),
        ("a town and a zendo with a thatched roof", ("building.roof", "thatched"), "thatched roof"),
        ("Eight warehouses, each with loading docks", ("district", "harbour"), "docks"),
        ("Half the windows are dark", ("windows.lit", "none"), ""),
        ("All cars stop where they are", ("traffic", "medium"), "cars"),
        ("Streets 16 m wide, tallest stuff up to 200 m", ("terrain.relief.max", 200), ""),
        ("Houses of 2 floors at the edges", ("building.floors", 2), ""),
        ("A town where the towers shrink to 3 floors in the glebes", ("building.floors", 3), ""),
    ],
)
def test_what_is_said_of_something_else_is_left_open(text, wrong, named):
    brief = read_brief(text)
    assert wrong not in {(slot.key, slot.value) for slot in brief.slots}
    assert any(named in note.text for note in brief.notes) or not named


@pytest.mark.parametrize(
    ("text", "wrong"),
    [
        ("Add masts at every junction with traffic lights.", ("element", "signalled_junction")),
        ("Small desert town. Add a fountain.", ("size", "small")),
        (
            "On each road with two or more lanes per direction, paint the outer lane green.",
            ("roads.count.min", 2),
        ),
    ],
)
def test_what_tells_which_things_of_a_map_are_meant_is_no_wish(text, wrong):
    assert wrong not in slots(text, **MAP)


@pytest.mark.parametrize(
    "text", ["no modern street furniture", "no modern street lamps", "without modern benches"]
)
def test_a_denied_look_is_of_the_kind_that_is_denied(text):
    brief = read_brief(text)
    assert not brief.negated
    assert any("denied of one kind alone" in note.text for note in brief.notes)


@pytest.mark.parametrize(
    ("text", "slot"),
    [
        ("Houses with two or more storeys", ("building.floors.min", 2)),
        ("A road with four or more lanes", ("roads.main.lanes.min", 4)),
        ("Houses of three or fewer storeys", ("building.floors.max", 3)),
        ("Make it 3 in the morning in January", ("time", "03:00")),
        ("It is 4 in the afternoon on a Sunday", ("time", "16:00")),
        ("a town with modern benches, no modern houses", ("not", "modern")),
        ("Leave the middle empty for a park", ("element", "park")),
    ],
)
def test_what_is_said_is_read(text, slot):
    brief = read_brief(text)
    assert slot in {(one.key, one.value) for one in (*brief.slots, *brief.negated)}
    assert not brief.kept


@pytest.mark.parametrize(
    "text", ["Move it 40 m nearer to the other one.", "zxcv qwer", "Make sure that they match."]
)
def test_a_text_that_tells_of_nothing_that_is_built_is_asked_about(text):
    brief = read_brief(text)
    assert [one.text for one in brief.questions][:1]
    assert "What is" in brief.questions[0].text


@pytest.mark.parametrize("text", ["", "a city", "Build me something nice", "a foggy morning"])
def test_what_leaves_all_to_the_planner_is_not(text):
    assert not read_brief(text).questions


def test_words_for_a_place_and_a_colour_are_not_passed_over():
    brief = read_brief("Coloured wooden houses, and a lighthouse on a pier, at its end.")
    assert {"Coloured", "end"} <= set(brief.words_unread)
