"""Counts of kinds of buildings, and words that count without a number."""

import pytest

from cityx.language.reading import read_brief


def goals(text):
    return [goal.predicate for goal in read_brief(text).goals]


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("A town with 40 houses, 5 offices and three shops.",
         ["n(building, type=house) == 40", "n(building, use=office) == 5",
          "n(building, use=retail) == 3"]),
        ("A suburb with eight villas, two apartment blocks and an office building",
         ["n(building, tag=villa) == 8", "n(building, use=flats) == 2",
          "n(building, use=office) >= 1"]),
        ("A town with several churches, a few offices and a handful of shops",
         ["n(building, tag=church) in 3-9", "n(building, use=office) in 2-6",
          "n(building, use=retail) in 3-7"]),
        ("A town with 20 houses and ten villas",
         ["n(building, tag=villa) == 10", "n(building, type=house) == 30"]),
    ],
)  # fmt: skip
def test_what_is_counted_is_no_share_of_all_buildings(text, expected):
    found = goals(text)
    for goal in expected:
        base, _, ends = goal.partition(" in ")
        low, _, high = ends.partition("-")
        wanted = [goal] if not ends else [f"{base} >= {low}", f"{base} <= {high}"]
        assert set(wanted) <= set(found)
    assert not [goal for goal in found if goal.startswith("share(")]


@pytest.mark.parametrize("word", ["some", "several", "a few", "a handful of", "hardly any"])
def test_words_that_count_without_a_number_are_read(word):
    brief = read_brief(f"A town with {word} shops and 30 houses")
    assert not brief.words_unread
    counts = [slot.key for slot in brief.slots if slot.key.startswith("shop.count")]
    assert counts == ["shop.count.min", "shop.count.max"]


def test_lots_of_a_kind_are_what_most_buildings_are():
    assert "share(building, type=house) >= 0.6" in goals("A town with lots of houses")


def test_two_shops_and_a_church_are_not_all_there_is():
    found = goals("A town with two shops and a church")
    assert "n(building, use=retail) == 2" in found
    assert "n(building) == 2" not in found
