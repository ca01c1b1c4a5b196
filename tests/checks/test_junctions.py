from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
import shapely

from cityx.checks.junction_checks import (
    _begun_on_the_straight,
    _turning_near,
    check_junctions,
    kerb_curves,
)
from cityx.city.city import City
from cityx.city.frame import Frame
from cityx.city.ground import LABEL
from cityx.city.layout import Layout, make_table
from cityx.geometry.polylines import Polylines
from cityx.road.ground.ground_surface import ground
from cityx.road.network.lane_graph import lanes
from cityx.road.network.network import network

STREET = {
    "lanes": 2, "lanes_forward": 1, "lane_width": 3.0, "width": 6.0, "sidewalk_left": 2.0,
    "sidewalk_right": 2.0, "surface": "asphalt", "maxspeed_kmh": 50.0,
}  # fmt: skip
ARMS = [[(-90, 0), (0, 0), (90, 0)], [(0, -90), (0, 0), (0, 90)]]


def city_of(kinds, houses=()):
    columns = {key: [value] * len(ARMS) for key, value in STREET.items()}
    roads = make_table("roads", [shapely.LineString(arm) for arm in ARMS],
                       id=np.arange(1, len(ARMS) + 1), kind=kinds, **columns)  # fmt: skip
    shells = np.array([shapely.box(*house) for house in houses], object)
    ids = np.arange(1001, 1001 + len(shells))
    blank = Layout((-80, -80, 80, 80), make_table("buildings", []), make_table("parts", []), roads,
                   make_table("areas", []))  # fmt: skip
    parts = make_table("parts", shells, id=ids, building=ids, base=[0.0] * len(shells),
                       top=[9.0] * len(shells), walls=[True] * len(shells))  # fmt: skip
    layout = replace(blank, parts=parts, buildings=make_table("buildings", shells, id=ids))
    return ground(lanes(network(City("test", Frame(52.0, 13.0), layout, lod=2))))


def by_name(city):
    return {check.name: check for check in check_junctions(city)}


@pytest.mark.parametrize(
    ("kinds", "radius"),
    [(["residential"] * 2, 4.0), (["primary"] * 2, 9.0), (["primary", "residential"], 6.5),
     (["motorway_link"] * 2, 12.0), (["living_street"] * 2, 3.0)],
)  # fmt: skip
def test_the_kerb_curves_by_the_classes_of_both_arms(kinds, radius):
    city = city_of(kinds)
    found = kerb_curves(city, city.ground)
    assert found.radius == pytest.approx([radius] * 4, rel=0.06)
    assert np.degrees(found.turn) == pytest.approx([90] * 4, abs=3)
    assert all(check.ok for check in check_junctions(city))


def test_a_house_near_the_corner_gets_its_walk_and_a_tighter_kerb():
    city = city_of(["primary"] * 2, houses=[(5.5, 5.5, 30, 30)])
    found = kerb_curves(city, city.ground)
    beside = found.middle.min(axis=1) > 0
    assert 3.0 < found.radius[beside][0] < 6.0
    assert found.radius[~beside] == pytest.approx([9.0] * 3, rel=0.06)


def test_a_kerb_that_is_too_sharp_is_named_with_its_place():
    city = city_of(["residential"] * 2)
    sharp = city.ground.face_label.copy()
    # What lies outside of the arms becomes kerb: the corners are square.
    middle = city.ground.vertices[city.ground.triangles].mean(axis=1)
    beside = np.ones(len(sharp), bool)
    np.logical_and.at(beside, city.ground.triangle_face, (np.abs(middle) > 3).all(axis=1))
    sharp[beside & (sharp == LABEL["junction"])] = LABEL["kerb"]
    check = by_name(replace(city, ground=replace(city.ground, face_label=sharp)))["kerb_radius"]
    assert not check.ok
    assert len(check.ids) == 4


@pytest.mark.parametrize(
    ("oneway", "free"),
    [
        ([True, True, True, True], [False, True, False, True]),
        ([True, False, True, True], [True, True, False, True]),  # from the east to the north
        ([False, False, True, True], [True, True, True, True]),
    ],
)
def test_a_corner_that_nothing_may_turn_about_has_no_least_radius(oneway, free):
    # West and south lead in, east and north lead away.
    arms = [[(-90, 0), (0, 0)], [(0, 0), (90, 0)], [(0, -90), (0, 0)], [(0, 0), (0, 90)]]
    columns = {key: [value] * 4 for key, value in STREET.items()}
    roads = make_table("roads", [shapely.LineString(arm) for arm in arms], id=np.arange(1, 5),
                       kind=["residential"] * 4, oneway=oneway, **columns)  # fmt: skip
    layout = Layout((-80, -80, 80, 80), make_table("buildings", []), make_table("parts", []), roads,
                    make_table("areas", []))  # fmt: skip
    city = ground(lanes(network(City("test", Frame(52.0, 13.0), layout, lod=2))))
    found = kerb_curves(city, city.ground)
    quadrant = np.arctan2(*found.middle.T[::-1]) % (2 * np.pi) // (np.pi / 2)  # from the north-east
    assert quadrant[np.argsort(quadrant)].tolist() == [0, 1, 2, 3]
    assert found.free[np.argsort(quadrant)].tolist() == free


def test_where_a_tram_runs_past_its_track_sets_the_corner():
    city = city_of(["residential"] * 2)
    track = make_table("roads", [shapely.LineString([(-90, 4.5), (90, 4.5)])], id=[9],
                       kind=["tram"])  # fmt: skip
    layout = replace(city.layout, roads=pd.concat([city.layout.roads, track], ignore_index=True))
    found = kerb_curves(replace(city, layout=layout), city.ground)
    assert found.free.tolist() == (found.middle[:, 1] < 0).tolist()


def test_a_junction_inside_of_a_paved_area_has_no_size_of_its_own():
    city = city_of(["residential"] * 2)
    label = city.ground.face_label.copy()
    around = np.isin(label, [LABEL[name] for name in ("kerb", "sidewalk", "block")])
    label[around] = LABEL["carriageway"]
    paved = replace(city.ground, face_label=label)
    assert by_name(replace(city, ground=paved))["junction_sizes"].ok


def test_a_junction_with_a_hole_in_its_outline_is_found():
    city = city_of(["residential"] * 2)
    assert by_name(city)["junction_surfaces"].value == 0.0
    label, owner = city.ground.face_label.copy(), city.ground.face_object.copy()
    other = np.flatnonzero(label == LABEL["sidewalk"])[:1]  # a piece far from the surface
    label[other], owner[other] = LABEL["junction"], owner[label == LABEL["junction"]][0]
    broken = replace(city.ground, face_label=label, face_object=owner)
    check = by_name(replace(city, ground=broken))["junction_surfaces"]
    assert check.value == 1.0
    assert len(check.ids) == 1


def test_a_lane_on_a_walk_is_measured():
    city = city_of(["residential"] * 2)
    assert by_name(city)["sidewalk_on_carriageway"].value == 0.0
    label = city.ground.face_label.copy()
    label[label == LABEL["carriageway"]] = LABEL["sidewalk"]
    broken = replace(city, ground=replace(city.ground, face_label=label))
    assert by_name(broken)["sidewalk_on_carriageway"].value > 0.5


def test_the_nose_of_a_median_is_no_corner_wherever_its_outline_begins():
    # Corners of 90 degrees, 2.4 m apart: an island, not the kerbs of two arms.
    island = np.array([(0.0, 0.0), (9.0, 0.0), (9.0, 2.4), (0.0, 2.4), (0.0, 0.0)])
    for first in range(4):
        ring = np.roll(island[:-1], first, axis=0)
        lines = Polylines(np.concatenate([ring, ring[:1]]), np.array([0, 5]))
        begun = _begun_on_the_straight(lines)
        assert (begun.points[0] == begun.points[-1]).all()
        assert begun.points[0, 0] == 4.5
        assert {tuple(p) for p in begun.points[1:-1]} == {tuple(p) for p in island}
    turn = np.full(4, np.pi / 2)
    near = _turning_near(island[:4], turn, np.zeros(4, int), island[:1], np.zeros(1, int))
    assert near == pytest.approx([np.pi])
