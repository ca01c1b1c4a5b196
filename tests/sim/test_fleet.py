"""A fleet of mixed bodies: each has its own spaces, and all meet in one world."""

import hashlib

import numpy as np
import pytest
from pettingzoo.test import parallel_api_test, parallel_seed_test

from cityx.errors import UsageError
from cityx.sim import parallel_env
from cityx.sim.fleet import Mixed, names_of
from cityx.sim.kernels.boxes import over_each_other
from cityx.sim.kernels.tables import ALIVE, HEADING, HEIGHT, SPEED, STEPS, X, Y, Z
from cityx.sim.options import FleetOptions, options_of

BODIES = {"car": 2, "bicycle": 1, "robot": 1, "wheelchair": 1, "person": 2, "drone": 2}


@pytest.fixture
def fleet(placed):
    def made(**options):
        return parallel_env("fleet", placed, goal_m=60.0, **{
            "bodies": BODIES, "traffic": 2, "people": 3, **options,
        })  # fmt: skip

    return made


def run(env, seed, steps, act):
    hasher, rng = hashlib.sha256(), np.random.default_rng(seed)
    views, _ = env.reset(seed=seed)
    ended = {}
    for _ in range(steps):
        if not env.agents:
            break
        views, rewards, over, late, infos = env.step(act(env, rng))
        for name in views:
            hasher.update(views[name].tobytes() + np.float64(rewards[name]).tobytes())
            if over[name] or late[name]:
                ended[name] = infos[name]
    return hasher.hexdigest(), ended


def by_chance(env, rng):
    return {name: rng.uniform(-1, 1, env.action_space(name).shape) for name in env.agents}


def by_rule(env, rng):
    del rng
    return env.act_by_rule()


def test_the_checkers_of_pettingzoo_are_content_with_mixed_bodies(fleet):
    parallel_api_test(fleet(), num_cycles=100)
    parallel_seed_test(fleet, num_cycles=40)


def test_each_body_has_the_spaces_of_its_task(fleet):
    env = fleet()
    assert env.possible_agents == ["car_0", "car_1", "bicycle_0", "person_0", "person_1", "robot_0",
                                   "wheelchair_0", "drone_0", "drone_1"]  # fmt: skip
    sizes = {name: (env.observation_space(name).shape, env.action_space(name).shape)
             for name in env.possible_agents}  # fmt: skip
    assert sizes["car_0"] == sizes["bicycle_0"] == ((87,), (2,))
    assert sizes["robot_0"] == sizes["person_1"] == sizes["wheelchair_0"] == ((112,), (2,))
    assert sizes["drone_1"] == ((69,), (4,))


def test_the_same_seed_and_actions_give_the_same_bytes(fleet):
    found = [run(fleet(), seed, 150, by_chance)[0] for seed in (3, 3, 4)]
    assert found[0] == found[1] != found[2]


def test_all_kinds_reach_their_goals_by_rule_and_events_have_the_words_of_their_task(fleet):
    env = fleet()
    reached, words = set(), set()
    for seed in range(3):
        ended = run(env, seed, 1500, by_rule)[1]
        reached |= {name.split("_")[0] for name, info in ended.items() if info["is_success"]}
        for name, info in run(env, seed, 200, by_chance)[1].items():
            words |= {(name.split("_")[0], each["event"]) for each in info["events"]}
            assert set(info["reward_terms"]) >= {"speed", "success"}
    assert reached == set(BODIES)
    assert not {("car", "off_walk"), ("robot", "off_road"), ("drone", "off_road")} & words


def test_a_driver_stops_for_a_robot_of_the_fleet_and_a_drone_passes_above(fleet):
    env = fleet(bodies={"car": 1, "robot": 1, "drone": 1}, traffic=0, people=0)
    env.reset(seed=2)
    engine = env.engine
    real, whole = engine.state.real[0], engine.state.whole[0]
    car, robot, drone = (env.row_of(name) for name in ("car_0", "robot_0", "drone_0"))
    for _ in range(20):
        env.step(env.act_by_rule())
    c, s = np.cos(real[HEADING, car]), np.sin(real[HEADING, car])
    real[[X, Y, Z], robot] = real[[X, Y, Z], car] + [14.0 * c, 14.0 * s, 0.0]
    real[[X, Y, Z], drone] = real[[X, Y, Z], car] + [0.0, 0.0, real[HEIGHT, car] + 0.1]
    assert over_each_other.py_func(real, drone, car)
    assert not over_each_other.py_func(real, robot, car)
    before = whole[STEPS, car]
    action = np.zeros((1, 3, 4))
    for _ in range(60):
        real[[X, Y], drone] = real[[X, Y], car]
        action[0, car, :2] = engine.act_by_rule()[0, car, :2]
        action[0, robot] = [0.0, -1.0, 0.0, 0.0]
        engine.step(action)
        if engine.out.ended[0, robot] or not whole[ALIVE, car]:
            break
        assert not engine.out.ended[0, car], engine.out.event[0, car]
    assert whole[STEPS, car] > before
    assert real[SPEED, car] < 5.0


@pytest.mark.parametrize(("bodies", "told"), [
    ({"cat": 1}, r'no body "cat".* mean "car"'),
    ({"car": -1}, "bodies car is -1; it takes a whole number, 0 to 256."),
    ({}, "bodies is {}; it takes numbers by name: small_car, car, van, lorry, bus, bicycle"),
    ({"car": 200, "drone": 100}, "bodies are 300; a fleet takes 1 to 256."),
])  # fmt: skip
def test_bodies_that_there_are_not_are_refused_by_a_sentence(placed, bodies, told):
    with pytest.raises(UsageError, match=told):
        parallel_env("fleet", placed, bodies=bodies)


def test_a_fleet_that_is_to_go_somewhere_is_told_who_does(placed):
    with pytest.raises(UsageError, match='to is "60,-2"; only CityX/Drive-v0 drives over tiles'):
        parallel_env("fleet", placed, bodies={"car": 1}, at="-80,-2", to="60,-2")


def test_rows_of_the_state_are_in_the_order_in_which_kernels_take_them(placed):
    options = options_of({"bodies": {"drone": 1, "person": 1, "car": 1}}, FleetOptions())
    engine = Mixed(*placed, options)
    assert names_of(options) == ["car_0", "person_0", "drone_0"]
    assert engine.order.tolist() == [0, 2, 1]
    with pytest.raises(UsageError, match="leave one by one"):
        engine.step(np.zeros((1, 3, 4)), anew=True)
