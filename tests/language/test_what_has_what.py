"""Things that others have, one of a kind, and what is denied in one place or behind its noun."""

import pytest

from cityx.language.reading import read_brief


def items(text):
    return read_brief(text).items()


def test_what_a_place_has_stands_there():
    found = items("A town with a market square with a fountain and a statue, a shop with a garden")
    for kind in ("fountain", "statue"):
        assert {(f"{kind}.near", "plaza"), (f"{kind}.relation", "in")} <= {*found}
    found = items("A supermarket with a car park and a church with a graveyard in a town")
    assert {("parking_lot.near", "supermarket"), ("cemetery.near", "church")} <= {*found}


@pytest.mark.parametrize(
    "text",
    ["A town with a school and a playground", "A campus with a library", "Squares with a fountain"],
)
def test_what_a_town_has_stands_anywhere(text):
    assert not [key for key, _ in items(text) if key.endswith(".near")]


def test_a_single_road_or_tree_is_not_all_of_them():
    assert ("roads.main.lanes", 4) in items("A town with a four-lane road through it")
    assert ("roads.lanes", 4) in items("A town with four-lane roads")
    found = items("A square with a big old tree")
    assert ("tree.count.min", 1) in found
    assert not any(key == "nature.trees" for key, _ in found)


@pytest.mark.parametrize("place", ["in the square", "in the park", "on the beach"])
def test_what_is_denied_in_one_place_is_not_denied_everywhere(place):
    brief = read_brief(f"A town with no cars {place}")
    assert not brief.negated
    assert any("denied in one place" in note.text for note in brief.notes)


def test_what_is_not_wanted_is_denied_behind_its_noun_too():
    brief = read_brief("A summer town, long shadows not wanted")
    assert not any(key == "sun.height" for key, _ in brief.items())
    assert ("season", "summer") in brief.items()
    assert [slot.value for slot in read_brief("A town, snow is not wanted").negated] == ["snow"]


def test_streets_wind_and_end_blind_together():
    brief = read_brief("A suburb with cul-de-sacs and curvy streets")
    assert not brief.conflicts
    assert "road.pattern == organic" in [goal.predicate for goal in brief.goals]


def test_a_quarter_of_the_traffic_is_a_share_without_of():
    assert ("truck.share", 0.25) in items("Heavy traffic, a quarter trucks")
    assert not any(key.endswith(".share") for key, _ in items("A quarter of narrow streets"))
