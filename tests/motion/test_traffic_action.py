"""Traffic as an action: what it keeps, what it must never do."""

import sys
from dataclasses import replace
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest
import shapely

sys.path.insert(0, str(Path(__file__).parents[1] / "traffic"))  # for `made_streets`
from crossing_town import crossing_town
from made_streets import CROSS, MIDDLE, REACH, city_of

from cityx.city.content import content_hash
from cityx.city.ground import KERB_HEIGHT
from cityx.city.section import KIND
from cityx.city.signals import GO, STATE, states_at
from cityx.city.store import read_city, write_city
from cityx.city.terrain import Terrain
from cityx.city.tracks import MOVER, join_tracks, poses_at
from cityx.motion.traffic import ACTION, traffic
from cityx.places.profiles import profile_named
from cityx.traffic.kinds import shares_on
from cityx.traffic.recording import _heights

pytestmark = [
    pytest.mark.sumo,
    pytest.mark.skipif(
        find_spec("libsumo") is None, reason='SUMO is not installed: pip install "cityx[traffic]"'
    ),
]
BUSY = {"density": "heavy", "duration": 40.0, "hour": 8.0}


@pytest.fixture(scope="module")
def town():
    return city_of(CROSS, signals=[MIDDLE], houses=[(20, 20, 60, 60), (-60, -60, -20, -20)])


@pytest.fixture(scope="module")
def busy(town):
    return traffic(town, **BUSY)


def test_the_same_seed_gives_the_same_tracks_byte_for_byte(town, busy):
    again = traffic(town, **BUSY)
    for name in ("object_id", "time", "position", "heading", "speed", "place", "tint"):
        assert getattr(again.tracks, name).tobytes() == getattr(busy.tracks, name).tobytes()
    assert content_hash(again).total == content_hash(busy).total
    other = traffic(replace(town, seed=2), **BUSY)
    assert set(other.tracks.object_id.tolist()).isdisjoint(busy.tracks.object_id.tolist())


def test_streets_are_as_full_as_asked_from_the_beginning(busy, town):
    for density, least, most in (("light", 1, 8), ("heavy", 28, 70)):
        city = busy if density == "heavy" else traffic(town, density=density, duration=20.0)
        km = shapely.length(town.layout.roads.geometry).sum() / 1000.0
        for moment in (0.0, 10.0, 20.0):
            assert least <= len(poses_at(city.tracks, moment).row) / km <= most
    asked = traffic(town, per_km=12.0, duration=10.0)
    assert 9 <= len(poses_at(asked.tracks, 0.0).row) / km <= 15
    assert traffic(busy, density="none").tracks is None


def test_a_street_of_a_hundred_metres_is_as_full_as_a_long_one():
    """Who enters it is gone after ten seconds, so that many are needed."""
    reach = 50.0
    town = city_of([([(-reach, 0.0), (reach, 0.0)], {})])
    city = traffic(town, density="heavy", duration=40.0)
    present = [len(poses_at(city.tracks, moment).row) for moment in np.arange(0.0, 40.0, 2.0)]
    assert np.mean(present) >= 2.0  # of 48 on a kilometre


def test_middles_of_vehicles_stay_on_their_lanes(busy):
    tracks, graph = busy.tracks, busy.lanes
    row = {int(own): number for number, own in enumerate(graph.lane_id)}
    on = np.flatnonzero(tracks.place != 0)
    assert len(on) > 100
    for sample in on.tolist():
        lane = row[int(tracks.place[sample])]
        line = shapely.LineString(graph.lane_points(lane))
        off = line.distance(shapely.Point(tracks.position[sample, :2]))
        assert off <= graph.left[lane] - graph.right[lane]


def test_nobody_drives_through_another(busy):
    tracks = busy.tracks
    assert tracks.count > 1
    for moment in np.arange(0.0, 40.0, 0.5).tolist():
        poses = poses_at(tracks, moment)
        size = tracks.size[poses.row].astype(float) / 2 - 0.05
        ahead = np.column_stack([np.cos(poses.heading), np.sin(poses.heading)])
        left = np.column_stack([-ahead[:, 1], ahead[:, 0]])
        u, v = ahead * size[:, :1], left * size[:, 1:2]
        at = poses.position[:, :2]
        boxes = shapely.polygons(np.stack([at - u - v, at + u - v, at + u + v, at - u + v], axis=1))
        one, other = shapely.STRtree(boxes).query(boxes, predicate="intersects")
        assert not (one != other).any(), moment


def test_signals_never_let_those_go_who_cross(busy):
    signals = busy.signals
    heading = np.round(signals.heading / (np.pi / 2)).astype(int) % 2
    vehicles = signals.lane != 0
    assert vehicles.sum() == 12
    for moment in np.arange(0.0, 180.0, 1.0).tolist():
        go = np.isin(states_at(signals, moment), [STATE[word] for word in GO]) & vehicles
        assert len(np.unique(heading[go])) <= 1


def test_nobody_drives_over_a_red_line(busy):
    tracks, signals = busy.tracks, busy.signals
    red = STATE["red"]
    seen = 0
    for row in range(tracks.count):
        part = slice(tracks.sample_start[row], tracks.sample_start[row + 1])
        place, time = tracks.place[part], tracks.time[part]
        left = np.flatnonzero((place[:-1] != 0) & (place[1:] != place[:-1]))
        for at in left.tolist():
            heads = np.flatnonzero(signals.lane == place[at])
            crossed = np.array([states_at(signals, t)[heads] for t in (time[at], time[at + 1])])
            if len(heads):
                seen += 1
                assert (crossed != red).any()
    assert seen


def test_only_what_the_action_made_before_is_replaced(town, busy):
    other = busy.tracks.take([0])
    other = replace(other, object_id=np.array([5], np.uint64), origin=np.array(["test/other-v1"]))
    held = replace(busy, tracks=join_tracks([busy.tracks, other]))
    again = traffic(held, density="light", duration=10.0)
    assert (again.tracks.origin == "test/other-v1").sum() == 1
    before, after = content_hash(held), content_hash(again)
    assert before.of_object(5) == after.of_object(5)
    assert set(again.tracks.origin.tolist()) == {ACTION, "test/other-v1"}
    assert before.layers["layout/roads"][1].tobytes() == after.layers["layout/roads"][1].tobytes()
    del town


def test_wheels_that_cut_a_corner_are_on_the_walk():
    xy = np.array([[20.0, 0.0], [20.0, 4.5]])  # on the carriageway and on the walk beside it
    nowhere = np.full((2, 2), -1)
    height = _heights(crossing_town(), xy, np.zeros(2, np.int64), nowhere)
    assert height.tolist() == pytest.approx([0.0, KERB_HEIGHT])


def test_wheels_stand_on_the_street_of_a_hill():
    nodes = np.linspace(-200.0, 200.0, 81)
    heights = np.tile(6.0 * np.sin(nodes / 40.0), (81, 1))
    hill = Terrain((-200.0, -200.0), 5.0, heights)
    city = traffic(city_of(CROSS, terrain=hill), density="medium", duration=20.0)
    tracks = city.tracks
    assert np.ptp(tracks.position[:, 2]) > 3.0
    for moment in (0.0, 7.3, 15.15):
        at = poses_at(tracks, moment).position
        assert np.allclose(at[:, 2], hill.height_at(at[:, :2]), atol=0.02)


def test_tracks_and_signals_come_back_from_the_store(busy, tmp_path):
    write_city(busy, tmp_path / "city")
    back = read_city(tmp_path / "city")
    assert content_hash(back).total == content_hash(busy).total
    assert back.signals.time.tobytes() == busy.signals.time.tobytes()
    assert np.isin(back.tracks.kind, [MOVER["car"], MOVER["van"]]).any()
    assert np.abs(back.tracks.position[:, :2]).max() <= REACH + 1.0


def test_streets_are_nearly_empty_at_night_and_full_in_the_morning(town):
    there = {
        hour: len(poses_at(traffic(town, hour=hour, duration=10.0).tracks, 5.0).row)
        for hour in (3.0, 8.0)
    }
    assert 0 < 4 * there[3.0] <= there[8.0]


def test_many_cycle_in_central_europe_and_nobody_on_a_motorway(busy):
    for place in ("world", "europe", "gb", "jp"):
        cyclists = profile_named(place).streets.cyclists
        for road in ("motorway", "primary", "residential"):
            assert sum(shares_on(road, cyclists)) == pytest.approx(1.0)
    assert (busy.tracks.kind == MOVER["bicycle"]).mean() > 0.1
    line = [(-REACH, 0.0), (REACH, 0.0)]
    fast = traffic(city_of([(line, {"kind": "motorway"})]), density="heavy", duration=10.0)
    assert fast.tracks.count > 3
    assert not (fast.tracks.kind == MOVER["bicycle"]).any()


def test_bicycles_take_the_lane_of_their_own_where_one_begins():
    section = "cycle 1.6 - | drive 3.25 - | drive 3.25 + | cycle 1.6 +"
    with_lanes = {"section": section, "width": 9.7}
    streets = [([(-REACH, 0), MIDDLE], {}), ([MIDDLE, (REACH, 0)], with_lanes),
               ([MIDDLE, (0, REACH)], {"kind": "residential"})]  # fmt: skip
    tracks = traffic(city := city_of(streets), density="heavy", duration=120.0, hour=8.0).tracks
    graph = city.lanes
    owner = np.repeat(np.arange(len(tracks.object_id)), np.diff(tracks.sample_start))
    order = np.argsort(graph.lane_id)
    found = np.searchsorted(graph.lane_id[order], tracks.place)
    lane = order[np.minimum(found, graph.count - 1)]
    lane = np.where(graph.lane_id[lane] == tracks.place, lane, -1)
    rides = (tracks.kind[owner] == MOVER["bicycle"]) & (lane >= 0)
    beside = np.isin(graph.edge[lane], graph.edge[graph.kind == KIND["cycle"]]) & rides
    assert beside.sum() > 100
    assert np.mean(graph.kind[lane[beside]] == KIND["cycle"]) > 0.8
