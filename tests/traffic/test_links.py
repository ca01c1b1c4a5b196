"""Which ways across a junction are kept."""

import numpy as np

from cityx.traffic.links import _turning_back_last
from cityx.traffic.streets import Link


def link(source, target, *points):
    shape = np.column_stack([np.array(points, float), np.zeros(len(points))])
    return Link((source, 0), (target, 0), shape)


AHEAD = link(0, 1, (0, 0), (10, 0), (20, 0))
BACK = link(0, 2, (0, 0), (10, 2), (10, 6), (0, 8))
LEFT = link(3, 2, (20, -20), (18, 0), (10, 8), (0, 8))


def test_nobody_turns_back_where_other_ways_lead_on_and_back():
    assert _turning_back_last([AHEAD, BACK, LEFT]) == [AHEAD, LEFT]


def test_one_turns_back_where_nothing_else_leads_on():
    assert _turning_back_last([BACK, LEFT]) == [BACK, LEFT]


def test_one_turns_back_to_where_nothing_else_leads():
    assert _turning_back_last([AHEAD, BACK]) == [AHEAD, BACK]
