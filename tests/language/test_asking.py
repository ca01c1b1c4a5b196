"""Commands in other words: wishes, bounds of all, "don't", and what may not be passed over."""

import pytest

from cityx.language import Selector, read_brief


def verbs(text):
    brief = read_brief(text, base=True)
    assert not brief.questions, brief.questions
    return [(edit.verb, edit.target.kind if edit.target else "") for edit in brief.edits]


@pytest.mark.parametrize(
    "text",
    [
        "Could you put a fountain between the church and the park?",
        "There should be a fountain between the church and the park.",
        "Between the church and the park there ought to be a fountain.",
        "We need a fountain between the church and the park, please.",
        "A fountain is needed between the church and the park.",
    ],
)
def test_a_wish_is_a_command(text):
    assert verbs(text) == [("add", "")]
    (edit,) = read_brief(text, base=True).edits
    assert [(one.key, *(spot.kind for spot in one.spots)) for one in edit.refs] == [
        ("between", "church", "park")
    ]


@pytest.mark.parametrize(
    ("text", "filters", "change"),
    [
        ("No building should be taller than 12 m.", ("height>12",), ("height.max", 12)),
        ("Nothing may be higher than 9 m except the church.", ("height>9",), ("height.max", 9)),
        ("Every house must have at least two floors.", ("floors<2",), ("floors.min", 2)),
        ("No house may have more than 2 floors.", ("floors>2",), ("floors.max", 2)),
    ],
)
def test_a_bound_of_all_changes_those_beyond_it(text, filters, change):
    (edit,) = read_brief(text, base=True).edits
    assert edit.target is not None
    assert (edit.target.filters, edit.change) == (filters, (change,))


@pytest.mark.parametrize(
    ("text", "kept"),
    [
        ("Add a hotel by the park; don't knock down any houses for it.", "house"),
        ("Build a hotel next to the park without removing trees.", "tree"),
        ("Never paint the church. Make everything else white.", "church"),
    ],
)
def test_what_is_not_to_happen_protects(text, kept):
    brief = read_brief(text, base=True)
    assert [slot.value for slot in brief.kept] == [kept]
    assert all(edit.verb != "remove" for edit in brief.edits)


@pytest.mark.parametrize(
    "text",
    [
        "Make the main street one-way with a protected cycle lane where the shops aren't.",
        "Make houses within 80 m of the church as tall as it, but no more than three of them.",
        "Take out every building lower than 6 m, unless it's a shop.",
    ],
)
def test_a_part_that_is_not_understood_stops_the_whole(text):
    assert read_brief(text, base=True).questions


def test_several_changes_of_one_thing_are_all_read():
    text = "Please give the smallest office two more floors and a green roof."
    assert {verb for verb, _ in verbs(text)} == {"raise_floors", "set_roof"}


def test_there_is_a_place_that_others_tell():
    text = "Add a crossing in front of the church, and please lower the speed limit there to 20."
    _, limit = read_brief(text, base=True).edits
    assert (limit.verb, limit.change) == ("set_speed", (("speed_kmh", 20),))
    assert limit.target is not None
    assert limit.target.kind == "road"
    assert limit.target.where[0].spots == (Selector("church", alone=True),)
