from types import SimpleNamespace

import numpy as np

from cityx.plugins.building.fixtures import _apart


def test_corners_of_one_part_that_are_near_each_other_bear_one_thing():
    start = np.array([[0.0, 0.0], [4.0, 0.0], [40.0, 0.0], [4.5, 0.0]])
    walls = SimpleNamespace(start=start, part=np.array([0, 0, 0, 1]))
    assert _apart(walls, np.arange(4), 18.0).tolist() == [0, 2, 3]
    assert _apart(walls, np.arange(0), 18.0).tolist() == []
