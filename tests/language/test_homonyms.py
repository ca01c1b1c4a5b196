"""Nouns that are meant behind an article or a number alone: a bank, a well."""

import pytest

from cityx.language import read_brief


def slots(text):
    return {(slot.key, slot.value) for slot in read_brief(text).slots}


@pytest.mark.parametrize(
    ("text", "slot"),
    [
        ("A town with a bank", ("element", "bank")),
        ("A town with three banks", ("bank.count", 3)),
        ("A square with a well", ("element", "well")),
        ("A village with two wells", ("well.count", 2)),
    ],
)
def test_a_homonym_is_the_noun_behind_an_article_or_a_number(text, slot):
    assert slot in slots(text)


@pytest.mark.parametrize(
    "text",
    [
        "A park on the northern bank of a river",
        "A town on both banks of a river",
        "Trees along the banks",
        "A village as well as a lake",
        "A well lit street with a well kept park",
        "A town that works well",
    ],
)
def test_elsewhere_it_is_no_thing(text):
    said = slots(text)
    assert not {("element", "bank"), ("element", "well")} & said
    assert not any(key.startswith(("bank.", "well.")) for key, _ in said)
