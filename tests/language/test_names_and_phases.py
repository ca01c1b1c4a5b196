"""Words for things that stand in a name or tell of something else."""

import pytest

from cityx.language.reading import read_brief


@pytest.mark.parametrize(
    ("text", "word"),
    [
        ("A town in two stages.", "stages"),
        ("A town at an early stage of development.", "stage"),
        ("A statue of a horse on the square.", "horse"),
        ("A village with a duck house.", "duck"),
        ("A street with the White Horse Inn.", "Horse"),
    ],
)
def test_a_word_of_a_name_or_of_another_thing_is_no_thing(text, word):
    brief = read_brief(text)
    assert word in brief.words_unread
    kinds = {str(slot.value) for slot in brief.slots} | {
        s.key.partition(".")[0] for s in brief.slots
    }
    assert not kinds.intersection({"stage", "swan", "horse", "duck"})


@pytest.mark.parametrize(
    ("text", "count"),
    [("A meadow with 12 sheep and a barn.", ("sheep.count", 12)),
     ("A town with three stages.", ("stage.count", 3))],
)  # fmt: skip
def test_things_themselves_are_things(text, count):
    assert count in {(slot.key, slot.value) for slot in read_brief(text).slots}


@pytest.mark.parametrize(
    "text",
    ["Which buildings are empty? Demolish them.", "Which houses have red roofs?"],
)
def test_a_question_that_no_list_answers_changes_nothing(text):
    brief = read_brief(text, base=True)
    assert brief.questions
    assert all(edit.verb == "unspecified" for edit in brief.edits)


@pytest.mark.parametrize(
    ("text", "first", "second"),
    [
        ("Make the flat roofs white and the walls red.", ("roof.color", "white"), "building.color"),
        ("Make the flat roofs red and the gabled roofs grey.", ("roof.color", "red"), "roof.color"),
    ],
)
def test_what_is_told_behind_roofs_of_a_form_is_of_its_own(text, first, second):
    told = read_brief(text, base=True).edits
    assert told[0].change == (first,)
    assert told[0].target.filters == ("roof=flat",)
    assert dict(told[1].change).keys() == {second}


def test_lamps_are_turned_on_and_not_put_somewhere():
    (edit,) = read_brief("Turn on the lamps along Hay Road.", base=True, names=["Hay Road"]).edits
    assert edit.verb == "set_lights"


@pytest.mark.parametrize(
    "text",
    ["No house is without a garden, in a village.", "No house stands within 30 m of a river."],
)
def test_what_no_house_is_denies_no_houses(text):
    goals = [goal.predicate for goal in read_brief(text).goals]
    assert "n(building, type=house) == 0" not in goals


def test_a_word_behind_called_is_a_name():
    brief = read_brief("A pub called The Swan in a village.")
    assert [command.text for command in brief.then] == ["call the pub The Swan"]
    assert "swan" not in {slot.value for slot in brief.slots}
