"""A curriculum goes from short routes on empty streets to long ones among others."""

from itertools import pairwise

import pytest

from cityx.errors import UsageError
from cityx.sim.curriculum import LESSONS, lesson_after
from cityx.sim.options import options_of


def test_every_lesson_is_made_of_options_of_drive_and_none_is_easier_than_the_one_before():
    for before, after in pairwise(LESSONS):
        options_of(after)
        assert all(after[name] >= before[name] for name in after)
        assert dict(before) != dict(after)


@pytest.mark.parametrize(
    ("successes", "lesson"),
    [((), 0), ((0.79,), 0), ((0.8,), 1), ((0.5, 0.9, 0.1, 0.85), 2), ((1.0,) * 40, 5)],
)
def test_what_was_learnt_leads_on_and_nobody_is_sent_back(successes, lesson):
    assert lesson_after(successes) == lesson


def test_a_share_is_from_0_to_1():
    with pytest.raises(UsageError, match=r"share of episodes is 1\.2"):
        lesson_after([0.5, 1.2])
