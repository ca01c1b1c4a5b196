"""Paths, footbridges, walks, ponds and fences that a command puts into a city that stands."""

import numpy as np
import pytest
import shapely

from cityx.checks.predicates import clean
from cityx.edit.land.add import add
from cityx.edit.land.enclose import enclose
from cityx.edit.land.paths import footbridge, footpath
from cityx.edit.land.pond import pond
from cityx.edit.land.street_edits import streets
from cityx.errors import ActionFailed, UsageError
from cityx.geometry.polygons import corners_of


def new_ways(before, after):
    roads = after.layout.roads
    return roads[~roads["id"].isin(before.layout.roads["id"])]


def new_things(before, after):
    known = before.scene.instances.get("street_pieces")
    rows = after.scene.instances["street_pieces"]
    fresh = (
        np.ones(rows.count, bool) if known is None else ~np.isin(rows.object_id, known.object_id)
    )
    return rows.position[fresh, :2]


def area(city, name):
    areas = city.layout.areas
    return areas.loc[areas["name"] == name].geometry.iloc[0]


def test_a_path_leads_through_land_off_houses_and_streets(park):
    made = footpath(park, through=("park1",), surface="gravel", width=2.0)
    ways = new_ways(park, made)
    assert set(ways["surface"]) == {"gravel"}
    assert shapely.covers(shapely.buffer(area(park, "park1"), 1.0), ways.geometry.to_numpy()).all()
    houses = shapely.union_all(park.layout.buildings.geometry.to_numpy())
    assert ways.geometry.distance(houses).min() > 1.0
    assert all(rule.met for rule in clean(made))
    again = footpath(park, through=("park1",), surface="gravel", width=2.0)
    assert new_ways(park, again).geometry.to_wkb().tolist() == ways.geometry.to_wkb().tolist()


def test_a_footbridge_leads_over_water_to_streets_on_both_banks(river):
    water = river.layout.areas.loc[river.layout.areas["kind"] == "river"]
    made = footbridge(river, over=(str(water["source"].iloc[0]),), width=3.0)
    ways = new_ways(river, made)
    (deck,) = ways.loc[ways["bridge"]].geometry
    assert len(ways) == 3
    assert shapely.intersection(deck, water.geometry.iloc[0]).length > 5.0
    others = river.layout.roads.loc[river.layout.roads["bridge"]].geometry
    assert others.distance(deck).min() >= 25.0
    assert all(rule.met for rule in clean(made))


def test_a_path_needs_a_way(park):
    with pytest.raises(UsageError, match="Nothing is said of the way"):
        footpath(park)
    with pytest.raises(UsageError, match="A footbridge leads over water"):
        footbridge(park, over=("park1",))


def test_walks_get_as_wide_as_is_said_and_no_street_gets_some(grid, park):
    sides = ["sidewalk_left", "sidewalk_right"]
    before = grid.layout.roads[sides].to_numpy(float)
    row = int(np.flatnonzero((before > 0).all(axis=1))[0])
    least = float(before[row].max()) + 0.3
    name = str(grid.layout.roads["source"].iloc[row])
    after = streets(grid, streets=(name,), walk_least=least).layout.roads[sides].to_numpy(float)
    assert after[row].tolist() == [least, least]
    assert (np.delete(after, row, axis=0) == np.delete(before, row, axis=0)).all()
    made = streets(park, streets=("x2",), walk_least=2.0)  # which has none
    assert made.layout.roads[sides].equals(park.layout.roads[sides])


def test_a_ring_has_as_many_gates_as_are_asked_for(park):
    made = enclose(park, kind="fence", near=("plaza1",), gates=0)
    closed = made.layout.lines.geometry.length.sum()
    made = enclose(park, kind="fence", near=("plaza1",), gates=2)
    assert closed - made.layout.lines.geometry.length.sum() == pytest.approx(5.0, abs=1.5)


def test_a_pond_lies_where_its_ground_is_told_and_benches_stand_round_it(park):
    green = area(park, "park1")
    spot = corners_of(green.centroid.buffer(12.0))
    made = pond(park, ground=spot, area=100.0)
    (water,) = made.layout.areas.loc[
        made.layout.areas["source"].str.startswith("edit/pond/")
    ].geometry
    assert water.centroid.distance(green.centroid) <= 12.5
    benches = add(made, thing="bench", last="pond", count=3)
    fresh = new_things(made, benches)
    assert len(fresh) == 3
    away = shapely.distance(shapely.points(fresh), water)
    assert (away > 0).all()
    assert away.max() < 8.0


def test_so_many_stand_in_each_of_several_places(park):
    x, y = area(park, "plaza1").centroid.coords[0]
    spots = [shapely.box(x + dx - 3, y - 3, x + dx + 3, y + 3) for dx in (-8.0, 8.0)]
    ground = corners_of(shapely.GeometryCollection(spots))
    made = add(park, thing="bench", ground=ground, count=1, each="yes")
    fresh = new_things(park, made)
    assert [int(shapely.intersects_xy(one, *fresh.T).sum()) for one in spots] == [1, 1]


def test_nothing_stands_round_what_was_never_added(park):
    with pytest.raises(ActionFailed, match="No pond was added"):
        add(park, thing="bench", last="pond")
