"""Edits that were read as something else: the right edit is read, or the words are asked about."""

from __future__ import annotations

import pytest

from cityx.language import Brief
from cityx.language.reading import read_brief


def _read(text: str) -> Brief:
    return read_brief(text, base=True)


def _told(brief: Brief) -> list[tuple[str, str, dict[str, object]]]:
    """Return the verb, the kind of the target and the change of each edit."""
    return [(edit.verb, edit.target.kind if edit.target else "", dict(edit.change))
            for edit in brief.edits]  # fmt: skip


def _is_asked(brief: Brief) -> bool:
    return bool(brief.unread or brief.questions or brief.left)


@pytest.mark.parametrize(
    ("text", "verb", "key", "values"),
    [
        ("Half of the houses red and half white.", "set_color", "color", ["red", "white"]),
        ("Make half of the roofs slate and half tile.", "set_roof", "roof", ["slate", "tile"]),
        ("A third of the roofs slate, a third tile.", "set_roof", "roof", ["slate", "tile"]),
        ("Half of the roofs slate and half thatch.", "set_roof", "roof", ["slate", "thatch"]),
    ],
)
def test_shares_are_disjoint(text: str, verb: str, key: str, values: list[str]) -> None:
    brief = _read(text)
    assert not _is_asked(brief)
    assert [(edit.verb, dict(edit.change)) for edit in brief.edits] == [
        (verb, {key: value}) for value in values
    ]
    first, second = (edit.target for edit in brief.edits)
    assert first is not None
    assert second is not None
    assert first.share in (0.5, 0.3333)
    assert second.but == (first,)


@pytest.mark.parametrize(
    ("text", "verb", "target", "change"),
    [
        ("Put ten lamps where the park is.", "add", "", {"element": "streetlight", "in": "park"}),
        ("Put a bench where the playground is.", "add", "",
         {"element": "bench", "in": "playground"}),
        ("Put a villa where the church stands.", "replace", "church", {"building.type": "villa"}),
        ("Put a park where the school is.", "replace", "school", {"element": "park"}),
        ("Keep as many trees as you can and paint the houses red.", "set_color", "house",
         {"color": "red"}),
        ("Keep as many of the trees as possible, and paint the church white.", "set_color",
         "church", {"color": "white"}),
        ("Put solar panels on every south-facing roof.", "add_parts", "building",
         {"part": "solar", "facing": "south"}),
        ("Make the roofs flat.", "set_roof", "building", {"roof": "flat"}),
        ("Add a crowd of 50 in the square.", "add_agent", "",
         {"agent": "pedestrian", "count": 50, "at": "plaza"}),
        ("Give everything in the park slate roofs.", "set_roof", "building", {"roof": "slate"}),
        ("I don't want the cars in the park.", "remove", "vehicle", {}),
        ("We can do without all of the lamps.", "remove", "streetlight", {}),
        ("I don't want the red houses.", "remove", "house", {}),
        ("Plant trees because there are no trees.", "plant", "", {"nature": "tree"}),
    ],
)  # fmt: skip
def test_the_right_edit_is_read(
    text: str, verb: str, target: str, change: dict[str, object]
) -> None:
    brief = _read(text)
    assert not _is_asked(brief)
    ((said, kind, told),) = _told(brief)
    assert (said, kind) == (verb, target)
    assert told.items() >= change.items()


@pytest.mark.parametrize(
    ("text", "near", "reach"),
    [
        ("Remove the houses at most 100 m from the park.", "park", 100.0),
        ("Remove the trees less than 30 m from the church.", "church", 30.0),
        ("Raise the houses less than 50 m away from the river by one floor.", "river", 50.0),
    ],
)
def test_an_upper_bound_of_a_distance_is_within_it(text: str, near: str, reach: float) -> None:
    brief = _read(text)
    assert not _is_asked(brief)
    (target,) = (edit.target for edit in brief.edits)
    assert target is not None
    assert (target.near, target.reach, target.filters) == (near, reach, ())


@pytest.mark.parametrize(
    ("text", "key", "amount"),
    [
        ("Add a bench at most 30 m from the church.", "near", 30.0),
        ("Add a bench at least 100 m away from the church.", "beyond", 100.0),
        ("Add a bench 20 m from the church.", "off", 20.0),
    ],
)
def test_bounds_of_distances_of_what_is_new(text: str, key: str, amount: float) -> None:
    brief = _read(text)
    assert not _is_asked(brief)
    assert [(ref.key, ref.amount) for edit in brief.edits for ref in edit.refs] == [(key, amount)]


@pytest.mark.parametrize(
    "text",
    [
        "Put a bench where the church stands.",
        "Remove the houses between 50 and 100 m from the park.",
        "Plant trees between 50 and 100 m from the park.",
        "Add lamps every 10 m from the church to the school.",
        "Add a fountain and a bench 20 m from it.",
        "Paint the north-facing roofs red.",
        "Paint every south-facing roof of the school green.",
        "Make the houses red. Make the roof flat.",
        "Add a crowd of 200, mostly children, in the park.",
        "Put benches where there are no trees.",
        "Paint everything in the park red.",
        "I don't want the church painted.",
        "I don't want the church so tall.",
        "We don't need all of the lamps.",
    ],
)
def test_what_no_rule_reads_right_is_asked(text: str) -> None:
    brief = _read(text)
    assert _is_asked(brief)
    assert all("building.height" not in dict(edit.change) for edit in brief.edits)
    assert all(edit.verb != "remove" for edit in brief.edits) or text.startswith("Remove")


@pytest.mark.parametrize(
    ("text", "verb", "counted"),
    [
        ("Add a group of 20 old trees in the park.", "plant", 20),
        ("We are planning to add ten trees along the canal.", "plant", 10),
        ("Add a crowd of 200, mostly children, in the park.", "add_agent", 200),
    ],
)
def test_a_count_is_of_what_is_named(text: str, verb: str, counted: int) -> None:
    ((said, _, change),) = _told(_read(text))
    assert (said, change["count"]) == (verb, counted)


def test_ones_within_a_sentence_say_which() -> None:
    brief = _read("Paint the benches, the red ones, blue.")
    ((verb, kind, change),) = _told(brief)
    assert (verb, kind, change) == ("set_color", "bench", {"color": "blue"})
    (target,) = (edit.target for edit in brief.edits)
    assert target is not None
    assert target.filters == ("color=red",)
