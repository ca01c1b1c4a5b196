"""What a text asks to be told is listed of the city, and asks nothing else of it."""

import pytest

from cityx.language import read_brief

HARBOUR = "A harbour town with a park and lamps. "


@pytest.mark.parametrize(
    ("asked", "commands"),
    [
        ("Tell me how many houses there are.", ["List the houses"]),
        ("Also report the number of benches in the park.", ["List the benches in the park"]),
        ("How many trees are there in the end?", ["List the trees"]),
        ("Please give the totals of houses, trees and benches.",
         ["List the houses", "List the trees", "List the benches"]),
        ("Let me know how many trees stand near the river, and the number of boats.",
         ["List the trees near the river", "List the boats"]),
        ("Then tell me the count of each.", ["List the park", "List the lamps"]),
    ],
)  # fmt: skip
def test_a_description_may_ask_how_many_there_are(asked, commands):
    brief = read_brief(HARBOUR + asked)
    assert [one.text for one in brief.then] == commands
    assert not brief.words_unread
    keys = {key for key, _ in brief.items()}
    assert not keys & {"nature.trees", "building.count", "pedestrians", "element.count"}


@pytest.mark.parametrize(
    "asked", ["Tell me how many people live there.", "Say how many buildings have no height."]
)
def test_what_no_list_tells_is_left_open(asked):
    brief = read_brief(HARBOUR + asked)
    assert not brief.then
    assert any("a question about the city" in note.text for note in brief.notes)


@pytest.mark.parametrize(
    ("asked", "kind", "near"),
    [
        ("Tell me how many houses are within 50 m of the river.", "house", "river"),
        ("How many trees are in the park?", "tree", ""),
        ("Paint the church white and report the number of benches.", "bench", ""),
    ],
)
def test_a_question_about_a_city_is_a_list(asked, kind, near):
    listed = read_brief(asked, base=True).edits[-1]
    assert (listed.verb, listed.target.kind, listed.target.near) == ("list", kind, near)


@pytest.mark.parametrize(
    "command",
    ["Remove the buildings with no height.", "Remove the trees with no leaves.",
     "List the buildings without a height."],
)  # fmt: skip
def test_things_that_lack_something_are_not_all_things(command):
    assert read_brief(command, base=True).questions


@pytest.mark.parametrize(
    ("text", "key", "value"),
    [
        ("Give me a total of 50 houses and a park.", "building.count", 50),
        ("Give us a total of three churches in the north.", "church.count", 3),
        ("How many houses: 40", "building.count", 40),
        ("Tell me how many houses fit, then build a village with 60 houses.", "building.count", 60),
        ("Tell me the number of trees: I want 40 trees and a church.", "tree.count", 40),
        ("Build a town, tell me how many trees it has, and add a church in the north.",
         "church.side", "north"),
    ],
)  # fmt: skip
def test_what_is_ordered_is_no_question(text, key, value):
    assert dict(read_brief(text).items())[key] == value


def test_an_order_behind_a_question_is_carried_out():
    brief = read_brief("A village. Tell me how many trees there are, then plant 20 oaks along the "
                       "river.")  # fmt: skip
    assert {one.text for one in brief.then} == {"List the trees", "plant 20 oaks along the river"}


@pytest.mark.parametrize("thing", ["park", "lake", "roundabout"])
def test_what_no_corner_is_kept_for_is_built_elsewhere(thing):
    brief = read_brief(f"A town with a {thing} in the northeast corner")
    assert thing in brief.values("element")
    assert not brief.then
    assert brief.notes or brief.words_unread
