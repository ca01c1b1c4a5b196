"""Places of several things: apart from each other by what each takes."""

import numpy as np
import pytest
import shapely

from cityx.assets.furniture.street_furniture import furniture
from cityx.edit.land.add import add
from cityx.edit.land.room import stand_of
from cityx.edit.land.spots import IN_A_ROW, facing, spots_within
from cityx.errors import ActionFailed
from cityx.geometry.turns import SIDES
from cityx.protocol.objects import find_objects


def new_things(before, after):
    """Return (n, 2) places and (n,) turns of what stands about that was added."""
    rows, old = (city.scene.instances["street_pieces"] for city in (after, before))
    new = ~np.isin(rows.object_id, old.object_id)
    return rows.position[new, :2], rows.rotation[new, 2]


def house(city, name):
    table = city.layout.buildings
    return table.geometry[np.isin(table["id"], find_objects(city, (name,)))].iloc[0]


def test_things_that_are_put_somewhere_do_not_stand_in_each_other(grid):
    stand = stand_of(furniture("kiosk", detail=grid.lod))
    spots = spots_within(grid, ("b05",), 8, stand)
    away = np.hypot(*(spots[:, None] - spots[None]).transpose(2, 0, 1))
    assert away[~np.eye(8, dtype=bool)].min() >= np.hypot(*stand.size)


@pytest.mark.parametrize(("row", "along"), [("behind", -1.0), ("before", 1.0)])
def test_in_a_row_each_stands_behind_or_before_the_last(grid, row, along):
    stand = stand_of(furniture("bench", detail=grid.lod))
    spots = spots_within(grid, ("b05",), 2, stand, row=row)
    yaw = facing(grid, spots[:1])[0]
    front = np.array([np.sin(yaw), -np.cos(yaw)])
    assert spots[1] - spots[0] == pytest.approx(along * (stand.size[1] + IN_A_ROW) * front)


def test_things_of_a_row_look_the_same_way(grid):
    places, turns = new_things(grid, add(grid, thing="bench", within=("b05",), count=3,
                                         row="beside"))  # fmt: skip
    wide = stand_of(furniture("bench", detail=grid.lod)).size[0]
    away = np.sort(np.hypot(*(places[:, None] - places[None]).transpose(2, 0, 1))[0])
    assert away[1] == pytest.approx(wide + IN_A_ROW, abs=1e-3)
    assert len(turns) == 3
    assert len(set(turns.tolist())) == 1


@pytest.mark.parametrize(("side", "off"), [("north", 2.0), ("east", 3.0), ("west", 6.0)])
def test_metres_on_a_side_are_told_from_the_edge_there(grid, side, off):
    ((place,), _) = new_things(grid, add(grid, thing="statue", beyond=("b05",), side=side, off=off))
    corners = shapely.get_coordinates(house(grid, "b05"))
    way = np.array(SIDES[side])
    assert place @ way - (corners @ way).max() == pytest.approx(off)


def test_a_side_without_room_is_refused(grid):
    with pytest.raises(ActionFailed, match="There is no room for one there"):
        add(grid, thing="statue", beyond=("b05",), side="north", off=400.0)


def test_more_than_there_is_room_for_is_refused(grid):
    with pytest.raises(ActionFailed, match="There is room for"):
        add(grid, thing="kiosk", within=("b05",), count=400)


def test_things_stand_round_the_one_that_was_added_before(grid):
    city = add(grid, thing="statue", within=("b05",))
    made = add(city, thing="bench", last="statue", count=4)
    at, _ = new_things(city, made)
    (statue,), _ = new_things(grid, city)
    assert len(at) == 4
    assert np.hypot(*(at - statue)[:, :2].T).max() < 12.0
    with pytest.raises(ActionFailed, match="0 statue were added by commands"):
        add(grid, thing="bench", last="statue")
