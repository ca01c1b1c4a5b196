"""Vehicles asked for one by one: where they are, that others keep their ways, what is refused."""

import sys
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest
import shapely

sys.path.insert(0, str(Path(__file__).parents[1] / "traffic"))  # for `made_streets`
from made_streets import CROSS, EAST, REACH, WEST, city_of

from cityx.checks.movement_checks import check_movement
from cityx.city.content import content_hash
from cityx.city.tracks import MOVER, poses_at
from cityx.errors import ActionFailed
from cityx.motion.traffic import traffic
from cityx.motion.vehicle_flow import vehicle_flow

pytestmark = [
    pytest.mark.sumo,
    pytest.mark.skipif(
        find_spec("libsumo") is None, reason='SUMO is not installed: pip install "cityx[traffic]"'
    ),
]
BRIDGES = [
    ([(x, y) for y in ends], {"bridge": bridge, "layer": int(bridge)})
    for x in (-60, 60)
    for ends, bridge in (((-REACH, -40), False), ((-40, 40), True), ((40, REACH), False))
]


@pytest.fixture(scope="module")
def town():
    return city_of(CROSS)


def ends_of(tracks, row):
    start, end = tracks.sample_start[row], tracks.sample_start[row + 1] - 1
    return tracks.position[start, :2], tracks.position[end, :2]


def test_buses_are_on_both_bridges_at_the_speed_asked_for():
    city = vehicle_flow(city_of(BRIDGES), kind="bus", count=8, along="bridge", speed=17.88,
                        duration=5.0)  # fmt: skip
    poses = poses_at(city.tracks, 0.0)
    assert (city.tracks.kind[poses.row] == MOVER["bus"]).all()
    assert np.allclose(poses.speed, 17.88, atol=0.01)
    east = poses.position[:, 0] > 0
    assert east.sum() == (~east).sum() == 4
    assert np.abs(poses.position[:, 1]).max() < 40.0


def test_vehicles_go_from_one_place_to_the_other(town):
    city = vehicle_flow(town, kind="truck", count=3, start=(-140.0, 4.0), goal=(3.0, 130.0))
    assert city.tracks.count == 3
    first = min(range(3), key=lambda row: city.tracks.time[city.tracks.sample_start[row]])
    start, end = ends_of(city.tracks, first)
    assert np.hypot(*(start - (-140.0, 0.0))) < 12.0
    assert np.hypot(*(end - (0.0, 130.0))) < 12.0


def test_what_moves_already_keeps_its_way_and_is_not_run_into(town):
    busy = traffic(town, density="heavy", duration=30.0)
    both = vehicle_flow(busy, kind="bus", count=2, along="street 0", duration=30.0)
    before, after = content_hash(busy), content_hash(both)
    assert all(before.of_object(int(own)) == after.of_object(int(own))
               for own in busy.tracks.object_id)  # fmt: skip
    assert both.tracks.count == busy.tracks.count + 2
    assert both.signals is busy.signals or both.signals == busy.signals
    buses = np.isin(both.tracks.object_id, busy.tracks.object_id, invert=True)
    for moment in np.arange(0.0, 30.0, 0.5).tolist():
        poses = poses_at(both.tracks, moment)
        discs = shapely.points(poses.position[:, :2])
        own = buses[poses.row]
        if own.any() and (~own).any():
            gaps = [shapely.distance(disc, discs[~own]).min() for disc in discs[own]]
            assert min(gaps) > 2.5  # half a bus beside half a car


def test_nothing_that_keeps_its_way_runs_into_those_who_are_slow_before_it():
    busy = traffic(city_of(CROSS, seed=3), density="heavy", duration=30.0)
    both = vehicle_flow(busy, count=5, along="street 0", duration=30.0)
    assert both.tracks.count == busy.tracks.count + 5
    met = {check.name: check.value for check in check_movement(both)}["movers_overlapping"]
    assert met == 0
    assert not [note for note in both.notes if "in the way" in note]


def test_the_same_call_replaces_and_another_adds(town):
    once = vehicle_flow(town, count=4, along="street 1", duration=5.0)
    again = vehicle_flow(once, count=4, along="street 1", duration=5.0)
    assert content_hash(again).total == content_hash(once).total
    more = vehicle_flow(once, kind="van", count=2, along="street 1", duration=5.0)
    assert more.tracks.count == 6
    assert traffic(more, density="none").tracks is None


@pytest.mark.parametrize(
    ("args", "words"),
    [
        ({"along": "street 7"}, 'No street of the city is meant by "street 7". Did you mean "str'),
        ({"along": "bridge"}, 'No street of the city is meant by "bridge".'),
        ({"start": (0.0, 90.0)}, "Give both start and goal"),
        ({"start": (-140.0, 90.0), "goal": (0.0, 0.0)},
         "No street for cars lies within 60 m of the start (-140.0, 90.0). The nearest lies"),
        ({"count": 400, "along": "street 0", "kind": "bus"},
         "400 vehicles of 12 m do not fit on street 0: there is room for"),
    ],
)  # fmt: skip
def test_what_cannot_be_is_refused_with_what_can(town, args, words):
    with pytest.raises(ActionFailed) as caught:
        vehicle_flow(town, **args)
    assert str(caught.value).startswith(words)


def test_where_no_way_leads_is_said():
    apart = city_of([([WEST, (-60, 0)], {}), ([(60, 0), EAST], {})])
    with pytest.raises(ActionFailed, match=r"No way for cars leads from \(-100.0, 0.0\) to \(100"):
        vehicle_flow(apart, start=(-100.0, 0.0), goal=(100.0, 0.0))
