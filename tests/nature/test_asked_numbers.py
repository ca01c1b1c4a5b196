"""What is asked for by number is not also set out by the rules of streets and parks."""

from dataclasses import replace

import numpy as np
import pytest

from cityx.city import City, Frame, Goal, Layout
from cityx.ground.pieces import pieces
from cityx.nature.furniture.asked_numbers import counted

NAMES = np.array(["kiosk", "planter", "planter_round", "bench", "rock"], object)


@pytest.mark.parametrize(
    ("predicate", "gone"),
    [
        ("n(kiosk) == 3", {"kiosk"}),
        ("n(planter) <= 2", {"planter", "planter_round"}),
        ("n(rock) in [1, 2]", {"rock"}),
        ("n(bench) >= 3", set()),
        ("n(building, tag=bank) == 1", set()),
    ],
)
def test_rules_add_none_of_what_is_bounded(predicate, gone):
    city = City("Town", Frame(50.0, 10.0), Layout((0.0, 0.0, 1.0, 1.0)))
    city = replace(city, goals=(Goal("asked", predicate),))
    found = pieces(NAMES, np.zeros((5, 2)), np.arange(5, dtype=np.uint64), np.zeros(5))
    assert set(NAMES[counted(city, found)]) == gone
