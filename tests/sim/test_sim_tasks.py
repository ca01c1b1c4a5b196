"""The tasks on walks and in the air: rules of Gymnasium, exact events, the same bytes anywhere."""

import subprocess
import sys
from dataclasses import replace

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

import cityx
from cityx.errors import UsageError
from cityx.sim.baseline import trips_of
from cityx.sim.kernels.tables import (
    CRASH_OBJECT,
    CRASH_VEHICLE,
    FALL,
    GOAL_REACHED,
    KERB,
    OFF_ROAD,
    RED_LIGHT,
)
from cityx.sim.options import ExploreOptions, FlyOptions, WalkOptions
from cityx.sim.roamers import Flyers, Roamers
from cityx.sim.travellers import TRAVELLER
from cityx.sim.walks import FITS

TASKS = ("CityX/Deliver-v0", "CityX/Walk-v0", "CityX/Fly-v0", "CityX/Explore-v0")


@pytest.fixture
def roam(placed):
    """Return an engine of agents on walks, seeded and begun."""

    def made(worlds=1, seed=0, threads=1, kind=WalkOptions, **options):
        found = Roamers(*placed, kind(**{"goal_m": 60.0, **options}), worlds, threads)
        found.seed(seed)
        found.begin()
        return found

    return made


@pytest.mark.parametrize("name", TASKS)
def test_the_checker_of_gymnasium_is_content_with(name, town):
    made = gymnasium.make(name, place=town, goal_m=60.0, render_mode="rgb_array")
    check_env(made.unwrapped)
    made.close()


@pytest.mark.parametrize("name", TASKS)
def test_the_checker_of_stable_baselines_is_content_with(name, placed):
    checker = pytest.importorskip("stable_baselines3.common.env_checker")
    checker.check_env(cityx.make(name, place=placed, goal_m=60.0))


def test_the_checker_of_stable_baselines_is_content_with_drive(world):
    checker = pytest.importorskip("stable_baselines3.common.env_checker")
    checker.check_env(cityx.make("CityX/Drive-v0", place=world, goal_m=60.0))


@pytest.mark.parametrize("task", ["deliver", "walk", "fly", "explore"])
def test_a_world_does_not_depend_on_its_batch_nor_on_threads(placed, task):
    made = [cityx.make_vec(f"CityX/{task.title()}-v0", placed, num_envs=count, threads=threads,
                           goal_m=60.0) for count, threads in ((7, 1), (7, 2), (1, 1))]  # fmt: skip
    for each in made:
        each.reset(seed=5)
    drawn = np.random.default_rng(1).uniform(-0.2, 1, (80, 7, made[0].action_space.shape[1]))
    for action in drawn:
        for each in made:
            each.step(action[: each.num_envs])
    whole, threaded, single = (each.engine.state.digests() for each in made)
    assert whole == threaded
    assert whole[:1] == single
    assert len(set(whole)) == 7


PROGRAM = """
import sys
import numpy as np
import cityx
for name in ("Deliver", "Fly"):
    env = cityx.make_vec(f"CityX/{name}-v0", sys.argv[1], num_envs=2, observation=NAMES[name])
    env.reset(seed=3)
    action = np.full((2, env.action_space.shape[1]), 0.4)
    for _ in range(30):
        view = env.step(action)[0]
    print(env.engine.state.digests(), [float(view[key].astype(float).sum()) for key in view])
"""
NAMES = {"Deliver": ["walk", "bev", "lidar", "gps", "imu"], "Fly": ["fly", "lidar", "gps", "imu"]}


def test_another_process_steps_and_senses_the_same(town):
    program = f"NAMES = {NAMES}\n{PROGRAM}"
    said = [subprocess.run([sys.executable, "-c", program, str(town)], capture_output=True,
                           text=True, check=True).stdout for _ in range(2)]  # fmt: skip
    assert said[0] == said[1]
    assert said[0].count("[") == 4


def test_who_goes_by_rule_arrives_and_by_chance_does_not(placed):
    options = {"goal_m": 60.0, "people": 0, "traffic": 0}
    for engine in (Roamers(*placed, WalkOptions(**options), 8),
                   Roamers(*placed, WalkOptions(vehicle="person", **options), 8),
                   Flyers(*placed, FlyOptions(goal_m=60.0), 8)):  # fmt: skip
        assert trips_of(engine, 2, 1).success >= 0.9
        assert trips_of(engine, 2, 1, chance=True).success < 0.2


def test_people_walk_into_no_agent_that_stands_and_leave_no_walk(roam):
    engine = roam(4, people=40, vehicle="person", traffic=0)
    real, whole = engine.state.real, engine.state.whole
    flags, frame = engine.walks.cell_flags, engine.walks.cell_frame
    met = moved = 0
    for _ in range(300):
        engine.step(np.zeros((4, 1, 2)), anew=False)
        met += int((engine.out.event & CRASH_VEHICLE != 0).sum())
        alive = whole[:, 9, 1:41] != 0
        column = ((real[:, 0, 1:41] - frame[0]) // frame[2]).astype(int)[alive]
        row = ((real[:, 1, 1:41] - frame[1]) // frame[2]).astype(int)[alive]
        assert (flags[row, column] & FITS[TRAVELLER["person"]] != 0).all()
        moved += int((real[:, 4, 1:41][alive] > 0.3).sum())
    assert met == 0
    assert moved > 1000


def placed_at(engine, xy, heading):
    """Put the agent of the only world somewhere."""
    from cityx.sim.kernels.paths import height_at

    real = engine.state.real
    real[0, :2, 0] = xy
    real[0, 2, 0] = height_at(engine.paths, *xy)
    real[0, 3, 0], real[0, 4, 0] = heading, 0.0


def kerb_of(engine, reach):
    """A place beside a full kerb, on the walk, and the direction that leads down from it."""
    height, frame = engine.walks.cell_height, engine.walks.cell_frame
    flags = engine.walks.cell_flags
    k = round(reach / frame[2])
    drop = height[:, k:-k] - height[:, 2 * k :]
    flat = np.abs(height[:, k:-k] - height[:, : -2 * k]) < 0.01
    row, column = np.nonzero((drop > 0.09) & flat & (flags[:, k:-k] & 1 != 0))
    for j, i in zip(row.tolist(), column.tolist(), strict=True):
        same = drop[max(j - 4, 0) : j + 5, i] > 0.09
        if len(same) == 9 and same.all():
            xy = frame[0] + (i + k + 0.5) * frame[2], frame[1] + (j + 0.5) * frame[2]
            return np.array(xy), 0.0
    raise AssertionError("the town has no kerb that runs north")


def test_a_robot_falls_off_a_full_kerb_and_does_not_get_up_one(roam):
    engine = roam(people=0, traffic=0)
    spot, east = kerb_of(engine, 0.6)
    placed_at(engine, spot, east)
    events = 0
    for _ in range(30):
        engine.step(np.array([[[0.0, 0.2]]]), anew=False)
        events |= int(engine.out.event[0, 0])
        if engine.out.ended[0, 0]:
            break
    assert events & (FALL | OFF_ROAD)
    placed_at(engine, spot + np.array([1.6, 0.0]), np.pi)  # from the roadway, towards the kerb
    events = 0
    for _ in range(30):
        engine.step(np.array([[[0.0, 0.2]]]), anew=False)
        events |= int(engine.out.event[0, 0])
    assert events & KERB
    assert engine.state.real[0, 0, 0] > spot[0] + 0.2  # it is still below


def test_red_is_told_in_the_step_in_which_one_goes_onto_a_crosswalk(roam):
    engine = roam(people=0, traffic=0, vehicle="person")
    if not (engine.walks.crossing_signal >= 0).any():
        pytest.skip("the town has no crosswalk under signals")
    k = int(np.flatnonzero(engine.walks.crossing_signal >= 0)[0])
    a, b = engine.walks.crossing_ends[k]
    seen = {True: 0, False: 0}
    for clock in np.arange(0.0, 62.0, 4.0):
        placed_at(engine, a, float(np.arctan2(*(b - a)[::-1])))
        engine.state.clock[0] = clock
        told = False
        for _ in range(12):
            engine.step(np.array([[[0.6, 0.0]]]), anew=False)
            told |= bool(engine.out.event[0, 0] & RED_LIGHT)
        seen[told] += 1
    assert min(seen.values()) > 0


def test_a_drone_that_comes_down_on_a_house_is_told_which(placed):
    engine = Flyers(*placed, FlyOptions(goal_m=60.0))
    engine.seed(0)
    engine.begin()
    for _ in range(400):
        engine.step(np.array([[[0.0, 0.0, -1.0, 0.0]]]), anew=False)
        if engine.out.ended[0, 0]:
            break
    assert engine.out.event[0, 0] & CRASH_OBJECT
    assert engine.struck(int(engine.out.touched[0, 0])) in engine.walks.top_object


def test_who_explores_counts_each_square_once(roam):
    engine = roam(kind=ExploreOptions, people=0, traffic=0, goal_m=60.0, cells=6)
    places = set()
    for _ in range(600):
        xy = engine.state.real[0, :2, 0]
        places.add(tuple((xy // 4.0).astype(int).tolist()))
        engine.step(engine.act_by_rule(), anew=False)
        if engine.out.ended[0, 0]:
            break
    xy = engine.state.real[0, :2, 0]
    places.add(tuple((xy // 4.0).astype(int).tolist()))
    assert engine.state.row("gone")[0, 0] <= len(places)
    assert engine.out.event[0, 0] & GOAL_REACHED


def test_what_is_wrong_is_said_in_a_sentence(placed, world):
    with pytest.raises(UsageError, match=r'no sensor "lidr".* mean "lidar"'):
        cityx.make("CityX/Walk-v0", placed, observation=["walk", "lidr"])
    with pytest.raises(UsageError, match="takes one vector, and each sensor once"):
        cityx.make("CityX/Drive-v0", world, observation=["state", "puffer"])
    with pytest.raises(UsageError, match=r'no option "control"'):
        cityx.make("CityX/Fly-v0", placed, control="pedals")
    with pytest.raises(UsageError, match=r'no sensor "wlak".* mean "walk"'):
        cityx.make("CityX/Deliver-v0", placed, observation="wlak")
    with pytest.raises(UsageError, match=r'vehicle is "wheelchiar".* mean "wheelchair"'):
        cityx.make("CityX/Deliver-v0", placed, vehicle="wheelchiar")
    with pytest.raises(UsageError, match="goal_m is 5; it takes a number from 10 to 1000"):
        cityx.make("CityX/Deliver-v0", placed, goal_m=5)
    walks = placed[1]
    none = replace(walks, route_kind=np.zeros_like(walks.route_kind))  # as where all have steps
    with pytest.raises(UsageError, match=r"No two doors .* joined by a way that a robot fits"):
        cityx.make("CityX/Deliver-v0", (world, none))
    with pytest.raises(UsageError, match="A world has no walks"):
        cityx.make("CityX/Walk-v0", world)
    env = cityx.make("CityX/Fly-v0", placed)
    env.reset(seed=0)
    with pytest.raises(UsageError, match="not finite"):
        env.step(np.full(4, np.nan))


@pytest.mark.parametrize("task", ["deliver", "walk", "fly", "explore"])
def test_many_agents_keep_to_the_rules_of_pettingzoo(placed, task):
    from pettingzoo.test import parallel_api_test, parallel_seed_test

    def made():
        return cityx.sim.parallel_env("fleet", placed, agents=3, task=task, goal_m=60.0)

    parallel_api_test(made(), num_cycles=40)
    parallel_seed_test(made, num_cycles=20)


def test_a_wheelchair_is_led_over_dropped_kerbs_alone(roam, placed):
    engine = roam(8, vehicle="wheelchair", people=0, traffic=0)
    kind, walks = TRAVELLER["wheelchair"], placed[1]
    rows = np.flatnonzero(walks.route_kind == kind)
    assert len(rows) > 10
    frame = walks.cell_frame
    for row in rows.tolist():
        spot = walks.route_point[walks.route_start[row] : walks.route_start[row + 1], :2]
        column, line = ((spot - frame[:2]) // frame[2]).astype(int).T
        assert (walks.cell_flags[line, column] & FITS[kind] != 0).mean() > 0.95
    assert trips_of(engine, 2, 1).success >= 0.9


def test_a_step_over_the_corner_of_a_cell_is_a_step():
    from cityx.sim.kernels.rasters import steps_over

    height = np.zeros((3, 3), np.float32)
    height[0, 0] = height[0, 1] = height[1, 0] = 0.05
    height[1, 1], height[2, 2] = 0.0, 0.0
    height[0, 0] = 0.1  # from here to the middle it is 0.1 over the corner, 0.05 along the sides
    found = steps_over(height, 0.06)
    assert found[0, 0]
    assert found[1, 1]
    assert not found[2, 2]


def test_who_stands_beside_somebody_goes_on_ahead(roam):
    """A robot that a person stands beside has free ground before it, and takes it."""
    engine = roam(people=1, traffic=0)
    real, whole = engine.state.real, engine.state.whole
    for seed in range(6):
        engine.seed(seed)
        engine.begin()
        x, y, heading = real[0, [0, 1, 3], 0]
        real[0, :2, 1] = x - np.sin(heading) * 0.68, y + np.cos(heading) * 0.68
        real[0, 2, 1], real[0, 4, 1], real[0, 6:9, 1] = real[0, 2, 0], 0.0, (0.46, 0.34, 1.75)
        whole[0, 9, 1] = 1
        action = engine.act_by_rule()[0, 0]
        assert action[1] > -1.0 or abs(action[0]) > 0.1
