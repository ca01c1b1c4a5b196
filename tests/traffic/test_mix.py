"""Shares of kinds of vehicles that are asked for."""

import pytest

from cityx.traffic.kinds import DRIVING, shares_on


@pytest.mark.parametrize("road", ["primary", "residential", "motorway"])
@pytest.mark.parametrize("mix", [{"truck": 1 / 3}, {"bicycle": 0.5, "bus": 0.2}, {"truck": 0.0}])
def test_kinds_have_the_share_that_is_asked_and_the_others_keep_theirs_of_the_rest(road, mix):
    usual, asked = shares_on(road), shares_on(road, mix=mix)
    assert sum(asked) == pytest.approx(1.0)
    found = dict(zip(DRIVING, asked, strict=True))
    assert {kind: found[kind] for kind in mix} == pytest.approx(mix)
    others = [kind for kind in DRIVING if kind not in mix]
    before = dict(zip(DRIVING, usual, strict=True))
    rest, left = sum(before[kind] for kind in others), 1.0 - sum(mix.values())
    assert [found[k] for k in others] == pytest.approx([before[k] / rest * left for k in others])


def test_without_a_wish_the_shares_are_the_usual_ones():
    assert shares_on("primary", mix={}) == shares_on("primary")
