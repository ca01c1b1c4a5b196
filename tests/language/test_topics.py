"""What commands are about that do not name it themselves, and words that none passes over."""

import pytest

from cityx.language.reading import read_brief

NAMES = ("Cooper Green", "Hay Road", "Wool Lane")


def edits(text):
    brief = read_brief(text, base=True, names=NAMES)
    assert not brief.questions, brief.questions
    assert not brief.left, brief.left
    assert not brief.unread
    return brief.edits


def targets(text):
    return [edit.target and edit.target.text for edit in edits(text)]


@pytest.mark.parametrize("name", ["Cooper Green", "the park"])
def test_each_thing_of_a_list_has_its_place_in_what_is_told_first(name):
    told = edits(f"In {name} put a bandstand in the middle and a playground at the west end")
    assert [(edit.refs[0].key, edit.refs[0].side) for edit in told] == [
        ("middle", ""),
        ("end", "west"),
    ]
    assert all(edit.refs[0].spots for edit in told)


def test_half_of_a_place_holds_its_end():
    told = edits("In Cooper Green: put a pond in its east half and a bench in the middle")
    assert (told[0].refs[0].key, told[0].refs[0].side) == ("end", "east")


@pytest.mark.parametrize(
    ("text", "verb", "change"),
    [
        ("Every third house along Hay Road: add a storey.", "raise_floors", (("by", 1),)),
        (
            "Houses on Hay Road: convert to shops.",
            "replace",
            (("building.type", "shop"), ("each", "yes")),
        ),
        ("b03 and b04: demolish.", "remove", ()),
    ],
)
def test_a_command_behind_a_colon_is_of_what_stands_before_it(text, verb, change):
    (edit,) = edits(text)
    assert (edit.verb, edit.change) == (verb, change)
    assert edit.target is not None


def test_a_sentence_that_only_tells_of_things_says_what_is_meant_by_both():
    told = edits("The two towers ruin the skyline in our drama. Lower both to 18 m.")
    assert [(one.verb, one.target.kind, one.target.k) for one in told] == [
        ("set_height", "tower", 2)
    ]


def test_what_is_made_of_cleared_land_stands_on_it():
    told = edits("Pull down everything within 40 m of the church and make that land a square.")
    assert [one.verb for one in told] == ["remove", "add"]
    assert told[1].refs[0].key == "cleared"


def test_instead_is_in_the_place_of_what_goes_where_no_other_is_told():
    told = edits("Remove the fence round b12 and plant a hedge instead.")
    assert told[1].refs[0].key == "cleared"
    told = edits("Remove the bench by the church and put a lamp near the park instead.")
    assert not told[1].refs


def test_a_place_of_two_streets_is_of_both():
    told = edits("Paint every third house along Hay Road and Wool Lane red.")
    assert [one.target.along for one in told] == ["Hay Road", "Wool Lane"]
    assert all(one.target.share == 0.3333 for one in told)


def test_vehicles_do_not_drive_where_people_walk():
    told = edits("80 cars, 6 buses, and 30 people on the pavements.")
    assert not any("path" in dict(one.change) for one in told)


@pytest.mark.parametrize(
    ("text", "roof", "change"),
    [
        ("Make all the flat roofs green.", "roof=flat", "roof.color"),
        ("The hipped roofs should be red.", "roof=hipped", "roof.color"),
        ("Make the church yellow and the gabled roofs brown.", "roof=gabled", "roof.color"),
        ("Replace the pitched roofs with flat roofs.", "roof=gabled", "roof"),
    ],
)
def test_roofs_of_a_form_are_those_there_are(text, roof, change):
    told = edits(text)[-1]
    assert told.target.filters == (roof,)
    assert dict(told.change).keys() == {change}


def test_a_share_of_what_a_filter_chooses_is_measured_among_these():
    goals = [one.predicate for one in read_brief("Make the flat roofs green.", base=True).goals]
    chosen = "building, roof_form=flat"
    assert f"n({chosen}, roof_color=green) == n({chosen})" in goals


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("Replace the two bridges with one wide footbridge.", "wide"),
        ("Put a bus stop every 200 m on the main street, on both sides.", "both"),
        ("Set the church back by 4 m.", "back"),
    ],
)
def test_no_command_passes_over_a_word_that_says_something(text, words):
    brief = read_brief(text, base=True)
    asked = [*(one.text for one in brief.questions), *(one.told for one in brief.left)]
    assert any(f'"{words}' in one for one in asked)


@pytest.mark.parametrize(
    "text", ["Take the tower down to eight floors.", "Cut b05 down to 8 floors."]
)
def test_down_to_a_height_lowers(text):
    assert [(one.verb, one.change) for one in edits(text)] == [("set_floors", (("floors", 8),))]


def test_which_asks_for_those_that_are_so():
    (edit,) = edits("Which buildings are taller than 20 m?")
    assert (edit.verb, edit.target.kind, edit.target.filters) == (
        "list",
        "building",
        ("height>20",),
    )
