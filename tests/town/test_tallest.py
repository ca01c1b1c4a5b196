"""What is to be taller than all other buildings is so."""

import pytest

from cityx.checks.predicates import measure
from cityx.city import City, Frame, Layout
from cityx.errors import ActionFailed
from cityx.town.town import town
from cityx.town.wishes.elements import elements
from cityx.town.wishes.tallest import tallest


@pytest.mark.parametrize("zone", ["core", "midrise", "suburb"])
def test_a_church_is_taller_than_all_else_in_any_town(zone):
    bare = City("Town", Frame(50.0, 10.0), Layout((0.0, 0.0, 1.0, 1.0)), seed=5)
    city = elements(town(bare, width=300.0, depth=300.0, zone=zone), kind="church")
    changed = tallest(city, kind="church")
    found = measure(changed.goals[-1].predicate, changed)
    assert found.met, found.evidence
    assert changed.layout.buildings.equals(tallest(city, kind="church").layout.buildings)
    with pytest.raises(ActionFailed, match="no castle"):
        tallest(city, kind="castle")


@pytest.mark.parametrize(
    "text",
    [
        "A town with three hotels taller than everything else and a playground",
        "A town where the town hall must be the tallest building",
        "A village with a church that is higher than all other buildings",
    ],
)
def test_a_sentence_about_the_tallest_is_built(check_sentence, text):
    brief_goals = check_sentence(text).goals
    assert any("height, max" in goal.predicate for goal in brief_goals)
