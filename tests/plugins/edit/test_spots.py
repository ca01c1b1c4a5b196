"""Places of several things: apart from each other by what each takes."""

import numpy as np
import pytest

from cityx.assets.furniture import furniture
from cityx.errors import ActionFailed
from cityx.plugins.edit.add import add
from cityx.plugins.edit.room import stand_of
from cityx.plugins.edit.spots import spots_within


def test_things_that_are_put_somewhere_do_not_stand_in_each_other(grid):
    stand = stand_of(furniture("kiosk", detail=grid.lod))
    spots = spots_within(grid, ("b05",), 8, stand)
    away = np.hypot(*(spots[:, None] - spots[None]).transpose(2, 0, 1))
    assert away[~np.eye(8, dtype=bool)].min() >= np.hypot(*stand.size)


def test_more_than_there_is_room_for_is_refused(grid):
    with pytest.raises(ActionFailed, match="There is room for"):
        add(grid, thing="kiosk", within=("b05",), count=400)
