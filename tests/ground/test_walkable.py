"""The walkable area: what is on it, what is taken out, and places moved into it."""

from dataclasses import replace
from functools import cache

import numpy as np
import pandas as pd
import pytest
import shapely
from crossing_town import HOUSES, PLAZA, crossing_town, with_post
from hypothesis import given, settings
from hypothesis import strategies as st

from cityx.city import make_table
from cityx.geometry.polylines import pack, to_linestrings
from cityx.ground.walking.crosswalks import (
    FOOTWAYS,
    _Candidates,
    _to_lowered,
    _walks_beside,
    crosswalks_of,
)
from cityx.ground.walking.walkable import BODY, CELL, DRIVEN, SHOULDER, walk_areas, walkable_of


@pytest.fixture(scope="module")
def town():
    return crossing_town()


@pytest.fixture(scope="module")
def area(town):
    return walkable_of(town)


def cells(area):
    return area.places(np.argwhere(area.free))


def test_every_free_cell_lies_wholly_on_walks_verges_or_crosswalks(area):
    corners = [cells(area) + CELL / 2 * np.array(s) for s in ((1, 1), (1, -1), (-1, 1), (-1, -1))]
    whole = shapely.buffer(shapely.union_all(area.areas), 1e-6)
    shapely.prepare(whole)
    assert all(shapely.intersects(whole, shapely.points(c)).all() for c in corners)


def test_roadways_are_free_on_crosswalks_alone(town, area):
    spots = cells(area)
    road = town.ground.on(spots, "carriageway", "junction")
    assert road.any()
    beside = spots[road & (area.at(area.crosswalk, spots) == 0)]
    assert len(beside) < 0.01 * road.sum()
    walk = town.ground.vertices[town.ground.triangles_of(*FOOTWAYS)]
    walk = shapely.union_all(shapely.polygons(walk))
    assert (shapely.distance(walk, shapely.points(beside)) < 1e-3).all()  # on the rim itself


def test_half_a_body_is_kept_from_houses_and_posts(town):
    posted = with_post(town, 20.0, 20.0)
    area = walkable_of(posted)
    spots = shapely.points(cells(area))
    assert shapely.distance(spots, shapely.box(19.7, 19.7, 20.3, 20.3)).min() >= BODY
    for house in HOUSES:
        assert shapely.distance(spots, house).min() >= BODY
    assert not area.holds([[20.0, 20.0]])[0]
    assert walkable_of(town).holds([[20.0, 20.0]])[0]


def test_clearance_grows_with_the_distance_from_the_rim(area):
    spots = np.array([[23.0, 23.0], [23.0, 8.0]])
    assert area.at(area.clearance, spots) == pytest.approx([12.0, 8.0 - 3.15 + 0.3], abs=5.0)
    assert area.at(area.clearance, spots)[0] > area.at(area.clearance, spots)[1]


def test_the_plaza_and_the_walks_are_one_area(area):
    assert area.holds([[23.0, 23.0], [30.0, 4.4]]).all()
    assert shapely.area(PLAZA) < area.area


def test_each_arm_has_a_crosswalk_without_bars_or_with(town):
    found = crosswalks_of(town.ground, town.layout, town.network)
    assert found.count == 4
    assert found.length == pytest.approx([7.6] * 4, abs=0.2)  # where kerbs curve and are lowered
    ends = found.ends.reshape(-1, 2)
    assert town.ground.on(ends, *FOOTWAYS).all()
    assert len(np.unique(found.id)) == 4


def test_kerbs_are_looked_for_near_a_junction_alone(town):
    network = town.network
    middle = np.full(network.edge_count, 45.0)
    edges = np.arange(network.edge_count)
    found = _to_lowered(town.ground, network, network.lines, edges, middle, np.ones(len(edges)))
    assert np.isnan(found).all()


def test_crosswalks_stay_when_streets_are_listed_the_other_way(town):
    turned = replace(town.layout, roads=town.layout.roads.iloc[::-1].reset_index(drop=True))
    assert turned.roads["id"].tolist() == [2, 1]
    found = crosswalks_of(town.ground, turned, town.network)
    assert set(found.id) == set(crosswalks_of(town.ground, town.layout, town.network).id)


@pytest.mark.parametrize(("begins", "paths"), [(4.0, 0), (7.0, 1), (14.0, 1)])
def test_no_two_crosswalks_share_roadway(town, begins, paths):
    line = shapely.LineString([(begins, -4.4), (begins + 7.0, 4.4)])
    path = make_table("roads", [line], id=[3], kind=["footway"], width=[2.0])
    roads = pd.concat([town.layout.roads, path], ignore_index=True)
    area = walk_areas(replace(town, layout=replace(town.layout, roads=roads)))
    assert area.crosswalks.count == 4 + paths  # the path's only apart from lowered kerbs
    assert (area.crosswalks.edge < 0).sum() == paths
    one, other = shapely.STRtree(area.over).query(area.over, predicate="intersects")
    common = shapely.area(shapely.intersection(area.over[one], area.over[other]))
    assert common[one != other].max(initial=0.0) < 1e-3


def test_land_beside_a_street_without_pavement_is_walked_on():
    bare = walkable_of(crossing_town(walks=0.0, plaza=False))
    beside = np.array([[30.0, 4.0], [30.0, 8.0]])
    assert bare.holds(beside).tolist() == [True, False]
    assert bare.at(bare.verge, beside).tolist() == [True, False]


plain_town = cache(crossing_town)


@settings(max_examples=60, deadline=None)
@given(st.tuples(st.floats(-80, 80), st.floats(-80, 80)))
def test_a_snapped_place_is_free_near_and_off_the_roadway(place):
    area = walkable_of(plain_town())
    moved, found = area.snapped([place], 5.0)
    if found[0]:
        assert area.holds(moved)[0]
        assert area.at(area.crosswalk, moved)[0] == 0
        assert np.hypot(*(moved[0] - place)) <= 5.0
        again, _ = area.snapped(moved, 5.0)
        assert np.array_equal(again, moved)
    else:
        assert np.array_equal(moved[0], np.array(place, float))


def test_the_area_is_made_once_for_one_ground(town):
    assert walkable_of(town) is walkable_of(replace(town, name="other"))
    assert walkable_of(with_post(town, 20.0, 20.0)) is not walkable_of(town)


def test_nobody_walks_where_no_ground_is_laid(town):
    with pytest.raises(ValueError, match="the ground is not laid yet"):
        walkable_of(replace(town, ground=None))


def test_a_place_without_streets_has_no_crosswalks(town):
    network = town.network
    none = replace(
        network, edge_nodes=network.edge_nodes[:0], edge_road=network.edge_road[:0],
        edge_id=network.edge_id[:0], point_start=network.point_start[:1],
        points=network.points[:0], half_width=network.half_width[:0], trim=network.trim[:0],
        crossing=network.crossing[:0], left_hand=network.left_hand[:0], z=network.z[:0],
        lift=network.lift[:0],
    )  # fmt: skip
    assert crosswalks_of(town.ground, town.layout, none).count == 0


def test_one_walks_on_the_edge_of_a_roadway_beside_a_narrow_walk_where_nothing_drives():
    def on_road(walks):
        town = crossing_town(walks=walks, plaza=False, oneway=True)
        area = walkable_of(town)
        spots = cells(area)
        road = town.ground.on(spots, "carriageway", "junction", "gutter")
        return town, area, spots[road & (area.at(area.rim, spots) == 0)]

    town, area, spots = on_road(1.0)
    lanes = to_linestrings(town.lanes.lines)[town.lanes.travelled]
    assert len(spots) > 100
    assert shapely.distance(shapely.multilinestrings(lanes), shapely.points(spots)).min() >= DRIVEN
    walks = town.ground.triangles_of("sidewalk", "kerb", "kerb_dropped", "ramp")
    paved = shapely.union_all(shapely.polygons(town.ground.vertices[walks]))
    assert shapely.distance(paved, shapely.points(spots)).max() <= SHOULDER
    assert area.at(area.verge, spots).all()
    assert not len(on_road(2.5)[2])


class Ditch:
    """A ground with two metres of water between each roadway and its walks."""

    def on_each(self, xy, *_):
        away = np.abs(xy[:, 1] - 1000.0 * np.rint(xy[:, 1] / 1000.0))
        return np.array([away >= 3.0, away < 1.0])


def test_a_wide_street_elsewhere_decides_nothing_here(town):
    lines = pack(shapely.linestrings([[(0, y), (80, y)] for y in (0.0, 1000.0)]))
    no = np.zeros(2, bool)
    found = _Candidates(np.arange(2), np.full(2, 40.0), np.full(2, 3.0), no, no, no)
    for wide in (3.0, 30.0):
        network = replace(
            town.network, points=lines.points, point_start=lines.start,
            half_width=np.array([3.0, wide]),
        )  # fmt: skip
        assert not _walks_beside(found, Ditch(), network, 4.0)[1][0]
