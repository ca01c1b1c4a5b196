"""One suite over every registered action."""

import pytest

from cityx.checks.conformance import check_action
from cityx.protocol import registry

ACTIONS = registry(outside=False)


@pytest.mark.parametrize("action_id", list(ACTIONS))
def test_the_action_conforms(action_id):
    results = check_action(action_id, ACTIONS)
    assert [f"{r.test}: {r.message}" for r in results if r.passed is False] == []


def test_no_two_actions_share_a_classname():
    names = [ACTIONS.entry(action_id).classname for action_id in ACTIONS]
    assert sorted(names) == sorted(set(names))
