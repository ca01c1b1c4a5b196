import pytest

from cityx.language import read_brief


def codes(text):
    return [conflict.code for conflict in read_brief(text).conflicts]


@pytest.mark.parametrize(
    ("text", "kind"),
    [
        ("A town without streets, with a four-lane avenue through it.", "road"),
        ("No roads, but heavy traffic.", "road"),
        ("A village without water, with a wide canal.", "water"),
        ("A quarter with no people and one woman.", "pedestrian"),
    ],
)
def test_what_is_denied_with_its_kind_contradicts(text, kind):
    assert codes(text) == [f"denied_and_wanted:{kind}"]


@pytest.mark.parametrize(
    "text",
    [
        "No narrow streets, but wide avenues.",
        "A city with no streets wider than 10 m and a boulevard of four lanes.",
        "No roads in the park, but a boulevard of four lanes elsewhere.",
        "A park town without cars, with footpaths.",
    ],
)
def test_what_is_denied_of_a_part_alone_does_not(text):
    assert codes(text) == []


@pytest.mark.parametrize(
    ("text", "predicate"),
    [
        ("Give every house a brick facade.", "share(building, material=brick) >= 0.95"),
        ("All buildings in Japanese style.", "share(building, style=japanese) >= 0.95"),
        ("A town of mostly brick houses.", "share(building, material=brick) >= 0.6"),
        ("A town of brick houses.", "share(building, material=brick) >= 0.95"),
        ("Every house has a garden. Brick facades.", "share(building, material=brick) >= 0.95"),
    ],
)
def test_what_is_asked_of_each_is_measured_of_nearly_all(text, predicate):
    assert predicate in [goal.predicate for goal in read_brief(text).goals]
