"""Words for districts, density and streets give what is measured for them."""

import pytest

from cityx.checks.predicates import measure
from cityx.city import City, Frame, Layout
from cityx.errors import UsageError
from cityx.language.goals import WORDS
from cityx.protocol import registry
from cityx.protocol.running import Call, run_action
from cityx.town.presets import PRESETS, plan_of, zone_for

ACTIONS = registry(outside=False)
CASES = [
    (slot, word)
    for slot, rows in PRESETS.items()
    for word in rows
    if slot != "size" and word not in ("usual", "medium")
]


def laid_out(words, size=420.0, seed=2):
    city = City("Town", Frame(50.0, 10.0), Layout((0.0, 0.0, 1.0, 1.0)), seed=seed)
    (town, args), *rest = plan_of(words)
    for action, given in [(town, {"width": size, "depth": size, **args}), *rest]:
        city = run_action(city, Call(action, dict(given)), ACTIONS).city
    return city


@pytest.mark.sweep(8)
@pytest.mark.parametrize(("slot", "word"), CASES)
def test_a_word_gives_what_is_measured_for_it(slot, word, as_built):
    city = as_built(laid_out([(slot, word)]))
    rows = WORDS.get(slot, {})
    asked = [
        text.format(v=word) for text in rows.get(word, rows.get("*", ())) if "share(" not in text
    ]
    for predicate in [*asked, *(goal.predicate for goal in city.goals)]:
        found = measure(predicate, city)
        assert found.met, (predicate, found.evidence)


def test_every_argument_of_a_preset_is_known_to_its_action():
    for rows in PRESETS.values():
        for preset in rows.values():
            assert ACTIONS["layout/town-v1"].argument_faults(dict(preset.town)) == []
            for action, args in preset.then:
                assert ACTIONS[action].argument_faults(dict(args)) == []


def test_later_words_go_over_earlier_ones_and_actions_follow_their_words():
    plan = plan_of([("district", "coastal"), ("density", "low"), ("roads.pattern", "grid")])
    assert [action for action, _ in plan] == [
        "layout/town-v1",
        "layout/coast-v1",
        "layout/cover-v1",
    ]
    assert plan[0][1]["pattern"] == "grid"


def test_unknown_words_are_refused_with_the_nearest():
    with pytest.raises(UsageError, match=r'"suburbn" is no district.*suburban'):
        plan_of([("district", "suburbn")])
    with pytest.raises(UsageError, match=r'No preset for "densty".*density'):
        plan_of([("densty", "high")])


@pytest.mark.parametrize(("count", "zone"), [(12, "core"), (30, "midrise"), (120, "row")])
def test_a_number_of_buildings_has_a_zone_that_suits(count, zone):
    assert zone_for(count, 200.0**2) == zone
