import numpy as np
import pytest
import shapely
from crossing_town import HOUSES
from planned_town import CARS, SECONDS, eyes, planned, stage, town

from cityx.city.tracks import poses_at
from cityx.dataset.plans.planning import KINDS
from cityx.geometry.polylines import Polylines, to_linestrings
from cityx.ground.walking.crosswalks import FOOTWAYS

MADE = {
    "street": (40, {}), "walk": (48, {"length": 24}), "drive": (60, {"length": 20}),
    "aerial": (12, {}), "orbit": (36, {}),
}  # fmt: skip
FLIGHT = ("aerial", 24, {"length": 12})


@pytest.fixture(scope="module")
def plans():
    made = {name: planned(name, count, **options) for name, (count, options) in MADE.items()}
    return made | {"flight": planned(FLIGHT[0], FLIGHT[1], **FLIGHT[2])}


def test_every_kind_is_tried_here():
    assert set(MADE) == set(KINDS)


@pytest.mark.parametrize("name", [*MADE, "flight"])
def test_no_eye_is_in_or_near_anything(plans, name):
    # More directions than the check looks in, turned against them.
    angle, z = np.meshgrid(np.arange(0, 2 * np.pi, 0.05), np.linspace(-0.99, 0.99, 60))
    flat = np.sqrt(1 - z**2)
    way = np.stack([np.cos(angle) * flat, np.sin(angle) * flat, z], axis=-1).reshape(-1, 3)
    least = 2.0 if name in ("aerial", "flight") else 0.5
    assert plans[name].shots
    for shot in plans[name].shots:
        eye = np.broadcast_to(shot.camera.position, way.shape)
        hits = stage().cast(eye, way)
        assert hits.distance.min() >= 0.97 * least
        assert (hits.back & (hits.distance < 30.0)).mean() < 0.01  # seams at the foot of houses


@pytest.mark.parametrize("name", ["street", "walk", "drive"])
def test_nothing_that_moves_is_near_an_eye(plans, name):
    tracks = town().tracks
    assert plans[name].shots
    for shot in plans[name].shots:
        poses = poses_at(tracks, shot.moment)
        gap = np.linalg.norm(poses.position[:, :2] - shot.camera.position[:2], axis=1)
        assert (gap >= 0.5 + tracks.size[poses.row, 1] / 2).all()


@pytest.mark.parametrize("name", [*MADE, "flight"])
def test_names_sort_as_shots(plans, name):
    names = [shot.name for shot in plans[name].shots]
    assert names == sorted(set(names))
    assert len(names) == (MADE[name][0] if name in MADE else FLIGHT[1])


@pytest.mark.parametrize(("name", "options"), [(n, o) for n, (_, o) in MADE.items()]
                         + [("aerial", {"length": 12})])  # fmt: skip
def test_a_shot_is_the_same_however_many_are_asked_for(name, options):
    many = planned(name, 40, seed=5, weathers=["clear", "rain"], **options).shots
    few = planned(name, 7, seed=5, weathers=["clear", "rain"], **options).shots
    assert few == many[:7]


def test_another_seed_gives_another_plan(plans):
    other = planned("street", 40, seed=1).shots
    assert not set(map(tuple, eyes(other))) & set(map(tuple, eyes(plans["street"].shots)))


def test_eyes_of_street_views_stand_on_pavements_at_the_height_of_eyes(plans):
    places = eyes(plans["street"].shots)
    assert not shapely.contains_xy(shapely.union_all(HOUSES), *places[:, :2].T).any()
    ground = town().ground
    walked = ground.on(places[:, :2], *FOOTWAYS)
    assert walked.mean() > 0.9
    assert (places[:, 2] > 1.4).all()
    assert (places[:, 2] < 1.9 + 0.13).all()


def test_street_views_spread_over_all_arms(plans):
    places = eyes(plans["street"].shots)[:, :2]
    quarter = (np.arctan2(places[:, 1], places[:, 0]) // (np.pi / 4)).astype(int)
    assert len(np.unique(quarter)) >= 6
    assert np.ptp(places, axis=0).min() > 80.0


def test_walkers_go_at_walking_speed_and_look_where_they_go(plans):
    shots = [shot for shot in plans["walk"].shots if shot.sequence == "walk_0000"]
    assert [shot.frame for shot in shots] == list(range(24))
    places = eyes(shots)
    step = np.hypot(*np.diff(places[:, :2], axis=0).T) * 10.0
    assert step == pytest.approx(1.4, abs=0.1)
    heading = np.unwrap([shot.camera.heading for shot in shots])
    assert np.abs(np.diff(heading)).max() * 10.0 < np.radians(60)  # a second
    way = places[-1] - places[0]
    assert np.cos(heading - np.arctan2(way[0], way[1])).min() > 0.5


def test_walks_stay_where_one_may_walk(plans):
    from cityx.ground.walking.walkable import walkable_of

    places = eyes(plans["walk"].shots)[:, :2]
    areas = shapely.union_all(walkable_of(town()).areas)
    assert shapely.contains_xy(areas, *places.T).all()


def test_drives_follow_lanes_on_the_right_hand(plans):
    graph = town().lanes
    driven = [graph.lane_points(lane) for lane in range(graph.count)]
    curves = to_linestrings(Polylines(graph.curve, graph.curve_start))
    lanes = shapely.union_all([*map(shapely.LineString, driven), *curves])
    assert plans["drive"].shots
    for shot in plans["drive"].shots:
        x, y, z = shot.camera.position
        assert shapely.distance(lanes, shapely.Point(x, y)) < 0.6
        assert z == pytest.approx(1.6, abs=0.02)
        if abs(x) > 15 and abs(y) < 5:  # along the street from west to east
            assert np.sign(np.sin(shot.camera.heading)) == -np.sign(y)


def test_drives_keep_the_limits_of_speed_and_of_bends(plans):
    assert plans["drive"].shots
    for sequence in {shot.sequence for shot in plans["drive"].shots}:
        places = eyes([shot for shot in plans["drive"].shots if shot.sequence == sequence])
        speed = np.linalg.norm(np.diff(places, axis=0), axis=1) * 10.0
        assert speed.max() <= town().lanes.speed.max() / 3.6 + 0.1
        assert np.abs(np.diff(speed)).max() * 10.0 < 4.0  # metres per second squared


def test_a_drive_behind_a_slow_car_keeps_its_distance():
    from dataclasses import replace

    from moving_city import moving

    slow = [(100, "car_sedan", "car", "ride", (-55.0, -1.5, 0.0), 0.0, 2.0)]
    city = replace(town(), tracks=moving(*slow, seconds=SECONDS).tracks)
    seen = 0
    for shot in planned("drive", 400, city=city, length=20).shots:
        x, y, _ = shot.camera.position
        ahead = -55.0 + 2.0 * shot.moment
        if abs(y + 1.5) < 0.5 and np.sin(shot.camera.heading) > 0.9 and x < ahead:
            seen += 1
            assert ahead - x > 2.2 + 2.2  # half of either car
    assert seen >= 15


def test_drones_fly_high_over_everything_and_look_down(plans):
    for name in ("aerial", "flight"):
        for shot in plans[name].shots:
            assert 39.9 <= shot.camera.position[2] <= 120.1
            assert shot.camera.pitch < np.radians(-20)
    assert any(shot.camera.pitch < np.radians(-89) for shot in plans["aerial"].shots)


def test_flights_are_smooth(plans):
    places = eyes([shot for shot in plans["flight"].shots if shot.sequence == "aerial_0000"])
    step = np.diff(places, axis=0) * 10.0
    assert np.linalg.norm(step, axis=1) == pytest.approx(8.0, abs=0.8)
    assert np.linalg.norm(np.diff(step, axis=0), axis=1).max() * 10.0 < 12.0


def test_orbits_always_look_at_their_target():
    low, high = np.array(HOUSES[0].bounds).reshape(2, 2)
    seen = planned("orbit", 36, target="000000000000000b").shots  # the first house, id 11
    middle = np.append((low + high) / 2, 4.5)
    for shot in seen:
        way = middle - shot.camera.position
        heading, pitch = shot.camera.heading, shot.camera.pitch
        ahead = [np.sin(heading) * np.cos(pitch), np.cos(heading) * np.cos(pitch), np.sin(pitch)]
        assert np.dot(ahead, way / np.linalg.norm(way)) > 0.9999
    places = eyes(seen)[:, :2] - middle[:2]
    assert np.ptp(np.hypot(*places.T)) < 1e-6
    turn = np.unwrap(np.arctan2(places[:, 1], places[:, 0]))
    assert abs(turn[-1] - turn[0]) == pytest.approx(2 * np.pi * 35 / 36)


def test_orbits_keep_the_radius_and_height_asked_for():
    shots = planned("orbit", 12, target="middle", radius=50.0, height=25.0, length=12).shots
    assert np.hypot(*eyes(shots)[:, :2].T) == pytest.approx(50.0)
    assert eyes(shots)[:, 2] == pytest.approx(25.0)


def test_moments_spread_over_the_tracks(plans):
    moments = np.array([shot.moment for shot in plans["street"].shots])
    assert moments.min() < 0.1 * SECONDS
    assert moments.max() > 0.9 * SECONDS
    assert len(np.unique(moments)) == len(moments)
    drive = [shot.moment for shot in plans["drive"].shots if shot.sequence == "drive_0001"]
    assert np.diff(drive) == pytest.approx(0.1)
    assert drive[-1] <= SECONDS
    assert len(CARS) == 3
