"""Copies, hedges and grass: what is new has its room, all else stays byte for byte."""

import numpy as np
import pytest
import shapely

from cityx.checks.predicates import clean
from cityx.checks.predicates.change_predicates import changed_ids
from cityx.city.ground import ROADWAY
from cityx.edit.land.enclose import enclose
from cityx.edit.land.street_edits import streets
from cityx.edit.land.turf import turf
from cityx.edit.objects.copy import copy
from cityx.errors import ActionFailed, UsageError


def new_lines(before, after):
    known = before.layout.lines["id"]
    return after.layout.lines[~after.layout.lines["id"].isin(known)]


def test_copies_of_a_house_stand_apart_and_only_trees_on_their_ground_give_way(park):
    made = copy(park, objects=("b03",), offset=(30.0, 0.0), settle=86.0, count=2)
    known = park.layout.buildings["id"]
    fresh = made.layout.buildings[~made.layout.buildings["id"].isin(known)]
    (original,) = park.layout.buildings.loc[park.layout.buildings["name"] == "b03"].geometry
    assert len(fresh) == 2
    assert set(fresh["name"]) == {""}
    assert shapely.area(fresh.geometry.to_numpy()) == pytest.approx(original.area)
    gone = np.setdiff1d(changed_ids(park, made), fresh["id"])
    trees = park.scene.instances["trees"]
    spots = shapely.points(trees.position[np.isin(trees.object_id, gone), :2])
    assert len(spots) == len(gone)
    assert shapely.covers(shapely.union_all(fresh.geometry.buffer(0.5)), spots).all()
    assert all(rule.met for rule in clean(made))


def test_a_copy_without_room_is_refused(grid):
    with pytest.raises(ActionFailed, match="No copy has room within 10 m of where it shall stand"):
        copy(grid, objects=("b40",), offset=(35.0, 0.0), settle=10.0)


def test_a_hedge_stands_on_both_sides_of_a_street_off_everything_that_drives(park):
    made = enclose(park, kind="hedge", along=("x2",))
    hedges = new_lines(park, made)
    street = park.layout.roads.loc[park.layout.roads["name"] == "x2"].geometry.iloc[0]
    side = [np.sign(shapely.get_x(line.centroid) - street.centroid.x) for line in hedges.geometry]
    assert set(hedges["kind"]) == {"hedge"}
    assert {-1.0, 1.0} == set(side)
    points = np.concatenate([shapely.get_coordinates(shapely.segmentize(line, 1.0))
                             for line in hedges.geometry])  # fmt: skip
    assert not made.ground.on(points, *ROADWAY, "sidewalk", "water").any()
    assert sorted(hedges["id"]) == changed_ids(park, made).tolist()


def test_a_fence_around_a_square_has_gates(park):
    made = enclose(park, kind="fence", near=("plaza1",), height=1.0)
    fences = new_lines(park, made)
    (plaza,) = park.layout.areas.loc[park.layout.areas["name"] == "plaza1"].geometry
    assert shapely.covers(plaza, fences.geometry.to_numpy()).all()
    assert 0.7 < fences.geometry.length.sum() / plaza.length < 0.97
    assert set(fences["height"]) == {1.0}


def test_a_hedge_follows_streets_areas_and_houses_only(park):
    tree = f"{int(park.scene.instances['trees'].object_id[0]):016x}"
    with pytest.raises(UsageError, match="A hedge follows a street, an area or a house"):
        enclose(park, kind="hedge", near=(tree,))
    with pytest.raises(UsageError, match="Nothing is said of the place"):
        enclose(park, kind="hedge")


def test_grass_on_a_square_leaves_what_stands_on_it(park):
    made = turf(park, within=("plaza1",))
    (plaza,) = made.layout.areas.loc[made.layout.areas["name"] == "plaza1"].itertuples()
    assert plaza.kind == "grass"
    assert changed_ids(park, made).tolist() == [plaza.id]
    inside = np.array([plaza.geometry.point_on_surface().coords[0]])
    assert park.ground.on(inside, "plaza").all()
    assert made.ground.on(inside, "grass").all()


def test_grass_is_laid_on_free_land_around_a_house(park):
    made = turf(park, beside=("b03",), reach=6.0)
    new = made.layout.areas[~made.layout.areas["id"].isin(park.layout.areas["id"])]
    houses = park.layout.buildings.geometry.to_numpy()
    assert len(new)
    overlap = shapely.area(shapely.intersection(new.geometry.union_all(), houses)).sum()
    assert overlap == pytest.approx(0.0, abs=1e-6)


def test_a_park_is_green_already(park):
    with pytest.raises(UsageError, match="it is green already"):
        turf(park, within=("park1",))


def test_a_new_surface_moves_nothing_that_stands_beside_the_street(grid):
    made = streets(grid, streets=("y2",), surface="cobblestone")
    changed = changed_ids(grid, made)
    layers = [city.scene.instances[name] for city in (grid, made)
              for name in ("street_covers", "walk_covers")]  # fmt: skip
    covers = np.concatenate([layer.object_id for layer in layers])
    roads = grid.layout.roads
    own = roads.loc[roads["name"] == "y2", "id"].to_numpy(np.uint64)
    assert np.isin(changed, np.concatenate([own, covers])).all()
    assert np.isin(own, changed).all()


def test_a_street_gets_one_more_lane(grid):
    made = streets(grid, streets=("x1",), lanes_by=1)
    before, after = (c.layout.roads.set_index("name").loc["x1", "lanes"] for c in (grid, made))
    assert after == before + 1
    with pytest.raises(UsageError, match="it would have 0 lanes left"):
        streets(grid, streets=("x1",), lanes_by=-int(before))
