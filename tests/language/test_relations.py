"""Where one thing stands to another, as sentences say it: arguments of the action, and goals."""

import pytest

from cityx.language import read_brief
from cityx.language.asked import slots_of_brief
from cityx.protocol.serving import DO


def asked(text, kind):
    brief = read_brief(text)
    done = [args for action, args in slots_of_brief(brief)[DO] if action == "layout/elements-v1"]
    args = next(args for args in done if args["kind"] == kind)
    kept = ("near", "relation", "second", "metres", "parts", "height")
    return {name: args[name] for name in kept if name in args}, brief


@pytest.mark.parametrize(
    ("text", "kind", "args"),
    [
        ("A town with a church opposite the town hall", "church",
         {"near": "town_hall", "relation": "opposite"}),
        ("A village with a school behind the church", "school",
         {"near": "church", "relation": "behind"}),
        ("A town with a fountain in front of the castle", "fountain",
         {"near": "castle", "relation": "before"}),
        ("A town with a library next to the park", "library", {"near": "park"}),
        ("A hotel near the main street of a town", "hotel", {"near": "main_street"}),
        ("A town with a statue in the park", "statue", {"near": "park", "relation": "in"}),
        ("A town with a market on the main square", "market", {"near": "plaza", "relation": "in"}),
        ("A town with a helipad on the hospital", "helipad",
         {"near": "hospital", "relation": "on"}),
        ("A town with four greenhouses around the school", "greenhouse",
         {"near": "school", "relation": "around"}),
        ("A town with a museum between the church and the school", "museum",
         {"near": "church", "relation": "between", "second": "school"}),
        ("A town with a hotel 100 m from the station", "hotel",
         {"near": "station", "metres": 100}),
        ("A town with a playground 60 metres away from the school", "playground",
         {"near": "school", "metres": 60}),
    ],
)  # fmt: skip
def test_a_relation_becomes_arguments_and_a_goal(text, kind, args):
    found, brief = asked(text, kind)
    assert found == args
    assert not brief.words_unread
    goals = [goal.predicate for goal in brief.goals]
    forms = ("dist(", "inside(", "before(", "behind(", "opposite(", "between(", "around(")
    assert sum(goal.startswith(forms) for goal in goals) == 1


@pytest.mark.parametrize(
    "text",
    [
        "A town with two churches behind the school", "A town with houses behind the church",
        "A town with a church on the hill",
    ],
)  # fmt: skip
def test_what_cannot_be_built_so_is_left_open(text):
    brief = read_brief(text)
    assert not any(slot.key.endswith((".near", ".relation", ".metres")) for slot in brief.slots)


@pytest.mark.parametrize(
    ("text", "kind", "args"),
    [
        ("A town in a city wall 9 m high with four city gates", "city_wall",
         {"parts": 4, "height": 9.0}),
        ("A town with a railway and two level crossings", "railway", {"parts": 2}),
        ("A town with a railway and no level crossing", "railway", {"parts": 0}),
        ("A town with three level crossings", "railway", {"parts": 3}),
        ("A tram line with five tram stops through a town", "tram_line", {"parts": 5}),
    ],
)  # fmt: skip
def test_lines_have_as_many_parts_as_are_told(text, kind, args):
    assert asked(text, kind)[0] == args


@pytest.mark.parametrize(
    ("text", "key", "kind"),
    [
        ("A village with cypresses along the road", "trees.street_species", "cypress"),
        ("A beach town with palm trees along the streets", "trees.street_species", "palm"),
        ("A town with plane trees along the main street", "trees.street_species", "plane"),
        ("A town with oaks in the park", "trees.park_species", "oak"),
        ("A village with olive trees", "trees.species", "olive"),
    ],
)
def test_named_trees_are_planted_where_they_are_told(text, key, kind):
    brief = read_brief(text)
    assert slots_of_brief(brief)[key] == (kind,)
    assert any(f"species={kind}" in goal.predicate for goal in brief.goals)
    assert not brief.words_unread


def test_of_several_kinds_of_trees_none_is_that_of_all():
    assert "trees.species" not in slots_of_brief(read_brief("A town with maples and birches"))
