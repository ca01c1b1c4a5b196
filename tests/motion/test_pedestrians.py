"""Pedestrians: as many as asked, the same each time, on walks, in nobody, waiting for vehicles."""

from dataclasses import replace

import numpy as np
import pytest
from crossing_town import crossing_town

from cityx.agents.briefs import read_request
from cityx.agents.planning.planner import OfflinePlanner
from cityx.checks.movement_checks import check_movement
from cityx.city.content import content_hash
from cityx.city.moments import moments_of
from cityx.city.signals import STATE, Signals
from cityx.city.tracks import GAIT, MOVER, Tracks, join_tracks
from cityx.errors import ActionFailed
from cityx.geometry.polylines import Polylines
from cityx.ground.walking.crosswalks import crosswalks_of
from cityx.ground.walking.walkable import walkable_of
from cityx.ground.walking.walks import walk_graph
from cityx.language.references.resolved_changes import slots_of_edit
from cityx.motion import people_trips
from cityx.motion.crowds import LOOK, among, met
from cityx.motion.pedestrian_flow import pedestrian_flow
from cityx.motion.pedestrians import ACTION, pedestrians
from cityx.motion.people_gates import Gates, gates_of
from cityx.motion.people_trips import DAYS, FLOW, LEAST, SPELL, Room, Trips, activity
from cityx.motion.people_walk import LONGEST_WAIT, _Walk
from cityx.options import BuildOptions
from cityx.protocol import Serves, registry
from cityx.protocol.catalogue import known_records
from cityx.protocol.example_city import example_city


@pytest.fixture(scope="module")
def town():
    return crossing_town()


@pytest.fixture(scope="module")
def busy(town):
    return pedestrians(town, count=40, duration=30.0)


def values(city):
    return {check.name: check.value for check in check_movement(city)}


def test_people_go_near_to_places_that_few_are_drawn_to(town, monkeypatch):
    area = walkable_of(town)
    ports = people_trips.ports_of(town, area, 12.0)
    assert len(ports.id) > 12
    monkeypatch.setattr(people_trips, "GOALS", 2)
    monkeypatch.setattr(people_trips, "NEAR_GOALS", 0)
    few = people_trips.drawn_trips(town, area, ports, 40, 60.0, "test")
    monkeypatch.setattr(people_trips, "NEAR_GOALS", 10)
    monkeypatch.setattr(people_trips, "NEAR", 110.0)
    many = people_trips.drawn_trips(town, area, ports, 40, 60.0, "test")
    goals, reach = people_trips._goals(town, ports, "test")
    assert (reach == people_trips.FARTHEST).sum() == 2
    places = walk_graph(area).places[ports.node[goals]]
    for trips in (few, many):
        first, last = (trips.walks.points[rows] for rows in
                       (trips.walks.start[:-1], trips.walks.start[1:] - 1))  # fmt: skip
        goal = np.hypot(*(last[:, None] - places[None]).transpose(2, 0, 1)).argmin(axis=1)
        found = len(np.unique(goal))
        assert found <= 2 if trips is few else found > 4
        near = reach[goal] < people_trips.FARTHEST
        assert (np.hypot(*(last - first)[near].T) < 111.0).all()


def driver(seconds, y0, y1, speed=8.0):
    """A car that drives along x = -1.5."""
    time = np.array([0.0, seconds])
    position = np.array([[-1.5, y0, 0.0], [-1.5, y1, 0.0]])
    return Tracks(
        np.array([5], np.uint64), np.array([MOVER["car"]], np.uint8), np.array(["car_sedan"]),
        np.array(["test"]), np.ones((1, 3), np.float32), np.array([[4.5, 1.8, 1.5]], np.float32),
        np.array([0, 2]), time, position, np.full(2, np.arctan2(y1 - y0, 0.0)),
        np.full(2, speed, np.float32), np.zeros(2, np.uint8), np.zeros(2, np.uint64),
    )  # fmt: skip


def test_as_many_walk_as_were_asked_for(busy):
    present = moments_of(busy.tracks, [0.0])
    assert len(present.mover) == 40
    assert (busy.tracks.kind == MOVER["pedestrian"]).all()
    assert set(busy.tracks.origin) == {ACTION}


def test_nothing_that_walks_breaks_a_rule(busy):
    assert set(values(busy).values()) == {0.0}


def test_the_same_seed_gives_the_same_bytes_and_another_others(town, busy):
    again = pedestrians(town, count=40, duration=30.0)
    assert content_hash(again).total == content_hash(busy).total
    assert again.tracks.position.tobytes() == busy.tracks.position.tobytes()
    other = pedestrians(replace(town, seed=1), count=40, duration=30.0)
    assert other.tracks.position.tobytes() != busy.tracks.position.tobytes()


def test_only_the_tracks_change(town, busy):
    before, after = content_hash(town).layers, content_hash(busy).layers
    changed = {name for name in after if name not in before or not all(
        np.array_equal(a, b) for a, b in zip(before[name], after[name], strict=True))}  # fmt: skip
    assert changed == {"tracks"}


def test_most_walk_at_the_pace_of_people(busy):
    speed = busy.tracks.speed[busy.tracks.speed > 0.5]
    assert 1.1 < np.median(speed) < 1.6
    assert speed.max() < 4.0


def test_a_million_are_refused_with_how_many_fit(town):
    with pytest.raises(ActionFailed) as refused:
        pedestrians(town, count=1_000_000)
    text = str(refused.value)
    assert text.startswith("1,000,000 people do not fit: of ")
    most = int(text.rsplit("Ask for ", 1)[1].split(" at most")[0].replace(",", ""))
    assert 300 < most < 3000


def test_none_takes_everybody_out_and_leaves_vehicles(town):
    held = replace(
        town,
        tracks=join_tracks(
            [driver(30.0, -60.0, 60.0), pedestrians(town, count=5, duration=10.0).tracks]
        ),
    )
    left = pedestrians(held, density="none")
    assert left.tracks.object_id.tolist() == [5]
    assert pedestrians(replace(town, tracks=None), density="none").tracks is None


def test_a_second_call_replaces_the_first(busy):
    fewer = pedestrians(busy, count=7, duration=10.0)
    assert len(moments_of(fewer.tracks, [0.0]).mover) == 7


def test_people_wait_while_a_vehicle_is_on_the_crosswalk(town):
    area = walkable_of(town)
    middle = area.crosswalks.ends.mean(axis=1)
    y = float(middle[np.abs(middle[:, 0]) < 1.0, 1].max())
    car = driver(60.0, y - 6.0, y + 6.0)  # creeps over the northern crosswalk
    held = replace(town, tracks=car)
    gates = gates_of(car, None, area, 60.0)
    assert gates.taken.any(axis=1).sum() == 1
    found = pedestrian_flow(held, count=6, places=((-30.0, 4.4), (30.0, 4.4)), duration=60.0)
    assert values(found)["movers_overlapping"] == 0
    north = int(np.flatnonzero(gates.taken.any(axis=1))[0]) + 1
    walks = found.tracks.take(found.tracks.kind == MOVER["pedestrian"])
    at = moments_of(walks, np.arange(0, 60.0, gates.tick))
    over = area.at(area.crosswalk, at.position[:, :2])
    shut = gates.taken[north - 1, np.minimum(at.number, gates.taken.shape[1] - 1)]
    assert not ((over == north) & shut).any()


def test_where_a_vehicle_stands_for_long_people_go_another_way_or_back(town):
    area = walkable_of(town)
    middle = area.crosswalks.ends.mean(axis=1)
    y = float(middle[np.abs(middle[:, 0]) < 1.0, 1].max())
    parked = driver(90.0, y - 0.2, y + 0.2)  # stands on the northern crosswalk all the time
    known, gates = among(town, area, 90.0, parked)
    north = int(np.argmax(gates.taken.mean(axis=1)))
    assert known.waits[north] > 60.0
    assert np.delete(known.waits, north).max() < 1.0
    held = replace(town, tracks=parked)
    found = pedestrian_flow(held, count=6, places=((-30.0, 4.4), (30.0, 4.4)), duration=90.0)
    assert values(found)["movers_overlapping"] == 0
    assert values(found)["movers_stuck"] == 0
    walks = found.tracks.take(found.tracks.kind == MOVER["pedestrian"])
    over = area.at(area.crosswalk, walks.position[:, :2])
    assert north + 1 not in over
    assert (over > 0).any()  # by the southern one


def test_nobody_begins_to_cross_who_would_not_be_off_before_a_vehicle_comes():
    taken = np.zeros((1, 100), bool)
    taken[0, 50:60] = True  # from 10 s on, for 2 s
    gates = Gates(0.2, np.zeros((1, 100), bool), taken, np.array([6.0]), np.zeros((0, 6)),
                  np.zeros(101, np.int64))  # fmt: skip
    one = np.zeros(1, np.int64)
    assert gates.open(one, 3.0, np.array([6.5]))
    assert not gates.open(one, 4.0, np.array([6.5]))
    assert gates.left(one, 4.0) == pytest.approx(6.0)
    assert gates.opens_in(one, 3.0) == 0.0
    assert gates.opens_in(one, 5.0) == pytest.approx(7.0)
    assert 0.0 < gates.waits[0] < 7.0


def test_a_narrow_passage_lets_only_so_many_through(town):
    area = walkable_of(town)
    way = np.column_stack([np.linspace(-30.0, 30.0, 121), np.full(121, 4.4)])
    narrow = float(area.at(area.clearance, way).min())
    many = Polylines(np.tile(way, (400, 1)), np.arange(401) * len(way))
    who, pace, begun = np.arange(400), np.full(400, 1.3), np.zeros(400)
    room, clock = Room(area, 120.0), np.zeros(400)
    found = room.admitted(many, who, who, clock, pace, begun)
    assert len(found) == int(np.ceil(SPELL / 60.0 * max(FLOW * narrow, LEAST)))
    assert found.tolist() == list(range(len(found)))  # who comes first goes first
    assert clock[found] == pytest.approx(60.0 / 1.3)
    # Another spell has room of its own, what is walked after the end needs none.
    later = np.full(400, SPELL)
    assert len(room.admitted(many, who, who, later, pace, begun)) >= len(found)
    assert len(room.admitted(many, who, who, np.full(400, 120.0), pace, begun)) == 400


def test_nobody_is_where_a_vehicle_sweeps_over_a_walk(busy):
    first = busy.tracks.time[busy.tracks.sample_start[:-1]] == 0.0
    walker = busy.tracks.take(np.flatnonzero(first)[:1])
    at, wall = walker.position[0], np.array([0.0, 1.0, 0.0])
    for aside, kept in ((wall, 0), (4 * wall, 1)):
        passing = driver(30.0, 0.0, 0.0)
        passing = replace(passing, position=np.array([at + aside, at + aside]),
                          heading=np.zeros(2))  # fmt: skip
        assert (~met(walker, passing, LOOK)).sum() == kept


def test_people_stop_at_red_and_go_at_green(town):
    found = crosswalks_of(town.ground, town.layout, town.network)
    heads = found.count
    red_first = Signals(
        np.arange(1, heads + 1, dtype=np.uint64), np.zeros(heads, np.uint64),
        np.zeros(heads, np.uint64), found.id, np.column_stack([found.ends.mean(axis=1),
        np.zeros(heads)]), np.zeros(heads), np.full(heads, 40.0),
        np.arange(0, 2 * heads + 1, 2), np.tile([0.0, 20.0], heads),
        np.tile([STATE["red"], STATE["green"]], heads).astype(np.uint8),
    )  # fmt: skip
    ruled = replace(town, signals=red_first)
    walking = pedestrian_flow(ruled, count=8, places=((-30.0, 4.4), (30.0, 4.4)), duration=40.0)
    assert values(walking)["ran_red"] == 0
    area = walkable_of(town)
    at = moments_of(walking.tracks, np.arange(0, 40.0, 0.5))
    over = area.at(area.crosswalk, at.position[:, :2]) > 0
    assert not over[at.time < 19.5].any()
    assert over[at.time > 20.0].any()
    free = pedestrian_flow(town, count=8, places=((-30.0, 4.4), (30.0, 4.4)), duration=40.0)
    assert values(replace(free, signals=red_first))["ran_red"] > 0


@pytest.mark.parametrize(
    ("y", "was_on", "waits", "may_be_on"),
    [(3.8, False, True, 0), (-3.8, False, False, 0), (-3.8, True, False, 0), (-1.0, True, False, 1),
     (3.8, True, True, 0)],
)  # fmt: skip
def test_who_is_beside_a_crosswalk_is_not_taken_for_one_on_it(town, y, was_on, waits, may_be_on):
    area = walkable_of(town)
    x = float(area.crosswalks.ends[1, 0, 0])
    way = np.column_stack([np.full(21, x), np.linspace(5.0, -5.0, 21)])  # from north to south
    walks = Polylines(way, np.array([0, 21]))
    trips = Trips(np.array([7], np.uint64), np.zeros(1, np.int64), walks, np.ones(1), np.zeros(1))
    shut = np.ones((area.crosswalks.count, 100), bool)
    gates = Gates(0.2, shut, ~shut, np.full(len(shut), 6.0), np.zeros((0, 6)),
                  np.zeros(101, np.int64))  # fmt: skip
    walk = _Walk(trips, area, gates, 1.0)
    walk.begin(np.zeros((0, 2)))
    # The way is past the middle of the roadway, wherever the walker is: it turned back, or fled.
    walk.at[:], walk.position[:] = 13, (x, y)
    number = int(walk.over[13])
    walk.on[:] = number if was_on else 0
    here = area.at(area.crosswalk, walk.position).astype(np.int64)
    waiting, _ = walk._wait(walk.present, here, 1.0)
    assert waiting.tolist() == [waits]
    assert walk.granted.tolist() == [number * may_be_on]


def test_a_gap_that_others_take_ends_no_wait(town):
    area = walkable_of(town)
    x = float(area.crosswalks.ends[1, 0, 0])
    way = np.column_stack([np.full(41, x), np.linspace(15.0, -5.0, 41)])  # from north to south
    walks = Polylines(way, np.array([0, 41]))
    trips = Trips(np.array([7], np.uint64), np.zeros(1, np.int64), walks, np.ones(1), np.zeros(1))
    shut = np.ones((area.crosswalks.count, 600), bool)
    for first in range(75, 600, 75):  # 1 s in every 15 s, but who is behind others cannot go on
        shut[:, first : first + 5] = False
    gates = Gates(0.2, shut, np.zeros_like(shut), np.full(len(shut), 6.0), np.zeros((0, 6)),
                  np.zeros(601, np.int64))  # fmt: skip
    walk = _Walk(trips, area, gates, 120.0)
    walk.begin(np.zeros((0, 2)))
    at = int(np.flatnonzero(walk.over)[0]) - 4
    assert walk.over[at] == 0
    walk.at[:], walk.position[:] = at, walk.points[at]
    here = area.at(area.crosswalk, walk.position).astype(np.int64)
    for now in np.arange(0.0, LONGEST_WAIT + 1.5, 0.1):
        walk._wait(walk.present, here, now)
    assert walk.at[0] == at
    for now in np.arange(LONGEST_WAIT + 1.5, LONGEST_WAIT + 3.0, 0.1):
        walk._wait(walk.present, here, now)
    assert walk.at[0] != at  # it has turned back


def test_a_flow_goes_from_place_to_place_and_adds_to_what_moves(busy):
    places = ((10.0, 10.0), (35.0, 35.0))
    more = pedestrian_flow(busy, count=5, places=places, speed=1.2, duration=30.0)
    added = more.tracks.take(~np.isin(more.tracks.object_id, busy.tracks.object_id))
    assert 1 <= added.count <= 5
    assert np.isin(busy.tracks.object_id, more.tracks.object_id).all()
    assert set(values(more).values()) == {0.0}
    ends = added.position[added.sample_start[1:] - 1, :2]
    assert np.hypot(*(ends - [35.0, 35.0]).T).min() < 25.0


def test_a_flow_to_nowhere_names_every_place(town):
    with pytest.raises(ActionFailed) as refused:
        pedestrian_flow(town, places=((0.0, 0.0), (500.0, 500.0), (60.0, 60.0)))
    assert "(500.0, 500.0) is more than 15 m from any sidewalk" in str(refused.value)
    assert "(60.0, 60.0) is more than 15 m from any sidewalk" in str(refused.value)


def test_people_keep_to_the_side_of_the_road_that_traffic_keeps_to(town):
    offsets = []
    for city in (town, crossing_town(longitude=-1.0)):
        walkers = pedestrian_flow(city, count=1, places=((8.0, 23.0), (38.0, 23.0)), duration=20.0)
        offsets.append(float(np.median(walkers.tracks.position[:, 1])) - 23.0)
    assert offsets[0] < -0.1 < 0.1 < offsets[1]  # east is ahead, south to the right


def test_the_day_has_its_hours():
    assert activity("retail", 12.5) > 5 * activity("retail", 3.0)
    assert activity("flats", 18.0) > activity("flats", 11.0)
    assert activity("office", 8.5) > activity("office", 20.0)
    for kind in DAYS:
        assert activity(kind, 0.0) == pytest.approx(activity(kind, 24.0), abs=1.0)


@pytest.mark.parametrize(
    ("sentence", "action", "arguments"),
    [
        ("Make the pavements crowded.", "dynamic/pedestrians-v1", {"density": "heavy"}),
        ("Fewer people.", "dynamic/pedestrians-v1", {"density": "light"}),
        ("Add 30 pedestrians.", "dynamic/pedestrian_flow-v1", {"count": 30}),
        ("Add a crowd of a million people.", "dynamic/pedestrian_flow-v1", {"count": 1_000_000}),
    ],
)
def test_sentences_reach_the_actions(sentence, action, arguments):
    request = read_request(BuildOptions(text=sentence), [], base=True)
    planner = OfflinePlanner(known_records(registry(outside=False)))
    (edit,) = request.brief.edits
    slots = slots_of_edit(edit, None, example_city())
    assert [(i.action, i.args) for i in planner.answers(slots)] == [(action, arguments)]


def test_a_wish_that_must_not_be_asked_for_keeps_an_action_out():
    wish = Serves("edit=add_agent", "!path")
    assert wish.asked({"edit": ("add_agent",)})
    assert not wish.asked({"edit": ("add_agent",), "path": ("park",)})


def test_who_runs_is_seen_to_run(town):
    running = pedestrian_flow(town, count=4, places=((10.0, 10.0), (35.0, 35.0)), gait="run",
                              duration=15.0)  # fmt: skip
    moving = running.tracks.speed > 1.0
    assert np.median(running.tracks.speed[moving]) > 2.3
    assert (running.tracks.gait[moving] == GAIT["run"]).mean() > 0.8
