"""Journeys go over the borders of tiles as if there were none, whichever tiles were there."""

import shutil

import numpy as np
import pytest
from copies import copy_of

import cityx
from cityx.city.lanes import MOVEMENTS
from cityx.errors import InputError, UsageError
from cityx.sim.kernels import tables as rows
from cityx.sim.options import DriveOptions
from cityx.sim.world import kept_path
from cityx.tiles.journey import _unlock, journey
from cityx.tiles.order import read_order
from cityx.tiles.region import region_about, region_city, region_streets
from cityx.tiles.run import TILES
from cityx.tiles.ways import metres_to

WEST, EAST = (-80.0, -2.0), (60.0, -2.0)


@pytest.fixture(scope="module")
def trip(built_tiles):
    pytest.importorskip("numba")
    return journey(built_tiles, WEST, EAST, options=DriveOptions(density=20.0), seed=3)


def test_a_drive_over_a_border_arrives_without_a_jump(trip):
    assert (trip.end, trip.tiles) == ("goal", ("-1_-1", "0_-1"))
    assert 100.0 < trip.metres < 145.0
    time, x, _, speed = trip.track.T
    assert np.diff(time) == pytest.approx(0.1)
    step = np.hypot(*np.diff(trip.track[:, 1:3], axis=0).T)
    assert (np.abs(step - (speed[1:] + speed[:-1]) / 2 * 0.1) < 0.02).all()
    assert np.abs(np.diff(speed)).max() < 1.0
    assert x[0] < 0 < x[-1]
    assert np.hypot(*(trip.track[-1, 1:3] - EAST)) < 4.0


def test_lanes_on_both_sides_of_a_border_are_the_same_lines_with_the_same_ids(trip):
    assert trip.shared >= 20
    assert trip.same == trip.shared


def test_an_environment_goes_over_a_border_as_a_journey_does(trip, built_tiles):
    env = cityx.make("CityX/Drive-v0", place=built_tiles, at="-80,-2", to="60,-2", density=20.0)
    for _ in range(2):  # the same bytes again
        view, info = env.reset(seed=3)
        assert info["route_m"] == trip.to_go
        worlds, done, track, shares = set(), False, [], []
        while not done:
            view, _, ended, late, info = env.step(env.engine.act_by_rule()[0, 0])
            done = ended or late
            worlds.add(env.engine.world.hash)
            shares.append(info["route_completion"])
            track.append(env.engine.state.real[0, [rows.X, rows.Y], 0].tolist())
            assert env.observation_space.contains(view)
        assert info["is_success"]
        assert len(worlds) == 2
        assert np.array_equal(track, trip.track[:, 1:3])
        assert (np.diff(shares) > -0.02).all()
        assert shares[-1] > 0.99
    env.close()


def test_whose_episode_ends_begins_the_journey_again(built_tiles):
    envs = cityx.make_vec(
        "CityX/Drive-v0", place=built_tiles, at="-80,-2", to="60,-2", horizon=20, traffic=0
    )
    envs.reset(seed=3)
    place = envs.engine.state.real[0, [rows.X, rows.Y], 0]
    for _ in range(20):
        view, _, _, late, info = envs.step(np.array([[0.0, 1.0]], np.float32))
    assert late.tolist() == [True]
    assert not np.array_equal(info["final_obs"][0], view[0])
    assert np.array_equal(envs.engine.state.real[0, [rows.X, rows.Y], 0], place)
    envs.close()


def test_what_a_journey_has_not_is_refused(built_tiles):
    given = {"place": built_tiles, "at": "-80,-2", "to": "60,-2"}
    for name, more, told in (
        ("CityX/Walk-v0", {}, "only CityX/Drive-v0 drives over tiles"),
        ("CityX/Drive-v0", {"people": 3}, "people is 3; a journey takes 0"),
        ("CityX/Drive-v0", {"at": ""}, "at says where the journey begins"),
        ("CityX/Drive-v0", {"place": None}, "needs a folder of tiles"),
        ("CityX/Drive-v0", {"town_size": (500, 500)}, "leave out town_size"),
    ):
        with pytest.raises(UsageError, match=told):
            cityx.make(name, **{**given, **more})
    with pytest.raises(UsageError, match="one world of its own, not 2"):
        cityx.make_vec("CityX/Drive-v0", num_envs=2, **given)


def test_a_drive_is_the_same_when_tiles_are_built_on_the_way(trip, built_tiles, tmp_path):
    copied = copy_of(built_tiles, tmp_path / "tiles")
    shutil.rmtree(copied / TILES / "0_-1")
    size = read_order(copied)[0].size
    for x in (-size / 2, size / 2):  # a world that is kept needs no tiles
        region = region_about(copied, (x, -size / 2), (2 * size, 2 * size))
        kept_path(region.key, region.name).unlink()
    again = journey(copied, WEST, EAST, options=DriveOptions(density=20.0), seed=3)
    assert (copied / TILES / "0_-1").is_dir()
    assert again.digest == trip.digest


def test_metres_to_go_fall_along_the_lanes_that_lead_to_the_goal(built_tiles):
    lanes = region_streets(region_about(built_tiles, (0.0, 0.0), (10.0, 10.0))).lanes
    through = int(np.flatnonzero(lanes.movement == MOVEMENTS.index("through"))[0])
    source, target = (lanes.lane_id[row] for row in lanes.connection[through])
    found = metres_to(lanes, int(target))
    row = int(np.flatnonzero(lanes.lane_id == source)[0])
    long = np.hypot(*np.diff(lanes.lane_points(row), axis=0).T).sum()
    assert found[int(target)] == 0.0
    assert long < found[int(source)] < long + 40.0


def test_places_without_a_lane_are_refused(built_tiles):
    with pytest.raises(InputError, match="No lane for cars lies within 150 m of 400,400"):
        journey(built_tiles, WEST, (400.0, 400.0))


def test_a_way_keeps_clear_of_turns_that_a_world_showed_to_be_closed(built_tiles):
    lanes = region_streets(region_about(built_tiles, (0.0, 0.0), (10.0, 10.0))).lanes
    through = np.flatnonzero(lanes.movement == MOVEMENTS.index("through"))
    source, target = lanes.lane_id[lanes.connection[through[0]]].tolist()
    free = metres_to(lanes, target)
    assert metres_to(lanes, target, {source: {target}})[source] == free[source]
    closed = metres_to(lanes, target, {source: set()})
    assert source not in closed
    assert closed[target] == 0.0
    assert all(closed[key] >= free[key] for key in closed)


def test_traffic_that_stands_about_a_journey_that_stands_makes_way(built_tiles):
    pytest.importorskip("numba")
    from cityx.sim.engine import Engine
    from cityx.sim.places import world_of

    city = region_city(region_about(built_tiles, (0.0, 0.0), (10.0, 10.0)))
    engine = Engine(world_of(city), DriveOptions(density=40.0, agents=1))
    engine.seed(1)
    engine.begin()
    real, whole = engine.state.real[0], engine.state.whole[0]
    alive = np.flatnonzero(whole[rows.ALIVE])
    near, late, far = alive[1:4]
    for mover, x, waited in ((near, 20.0, 70.0), (late, -20.0, 5.0), (far, 90.0, 70.0)):
        real[rows.X, mover], real[rows.Y, mover] = real[rows.X, 0] + x, real[rows.Y, 0]
        real[rows.WAITED, mover] = waited
    real[rows.WAITED, 0] = 95.0
    _unlock(engine.state)
    assert whole[rows.ALIVE, [0, near, late, far]].tolist() == [1, 0, 1, 1]
    real[rows.WAITED, 0] = 185.0  # others came and wait in their stead
    _unlock(engine.state)
    assert whole[rows.ALIVE, [0, late, far]].tolist() == [1, 0, 1]
    engine.close()
