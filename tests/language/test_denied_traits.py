"""What no thing of a kind has or is denies no such thing, but what is said of it."""

import pytest

from cityx.language import read_brief


def denied(text):
    return [slot.value for slot in read_brief(text).negated]


@pytest.mark.parametrize(
    ("text", "trait"),
    [
        ("No house has a red roof.", "house.roof_color=red"),
        ("A town with no red roofs.", "roof.color=red"),
        ("A village by a lake; none of the houses is white.", "house.color=white"),
        ("20 houses, none of them white.", "house.color=white"),
        ("There are no houses with flat roofs.", "house.roof=flat"),
        ("No brick buildings.", "building.material=brick"),
        ("No tower is made of glass.", "tower.material=glass"),
    ],
)
def test_a_look_that_none_has_is_denied_alone(text, trait):
    brief = read_brief(text)
    assert denied(text) == [trait]
    assert [goal.predicate for goal in brief.goals if goal.predicate.endswith("== 0")]
    assert not brief.unread
    assert not any(note.code == "left_open" for note in brief.notes)


@pytest.mark.parametrize(
    ("text", "slot"),
    [
        ("No house without a garden.", ("house.garden.count.min", 1)),
        ("None of the houses has a garage.", ("house.garage.count", 0)),
        ("No shop without an awning.", ("shop.awning.count.min", 1)),
        ("No street without trees.", ("nature.trees", "some")),
    ],
)
def test_what_none_has_or_lacks_each_is_without_or_with(text, slot):
    brief = read_brief(text)
    assert [(one.key, one.value) for one in brief.slots] == [slot]
    assert not brief.negated


@pytest.mark.parametrize(
    "text", ["No house stands by the river.", "No car is red.", "No house is identical to another."]
)
def test_what_is_denied_of_things_is_left_open_as_a_whole(text):
    brief = read_brief(text)
    assert not brief.negated
    assert not brief.slots
    assert [note.text for note in brief.notes if note.code == "left_open"]


def test_a_number_of_roofs_is_not_of_all_buildings():
    brief = read_brief("A bazaar with ten domes.")
    assert not any("roof" in goal.predicate for goal in brief.goals)
    assert any('"domes"' in note.text for note in brief.notes)
    assert any("flat" in goal.predicate for goal in read_brief("30 flat-roofed houses.").goals)
