"""A fleet keeps to PettingZoo's rules; its agents leave one by one."""

import numpy as np
import pytest
from pettingzoo.test import parallel_api_test, parallel_seed_test

from cityx.errors import UsageError
from cityx.sim import parallel_env


@pytest.fixture
def fleet(town):
    def made(**options):
        return parallel_env("fleet", town, goal_m=60.0, traffic=2, **{"agents": 4, **options})

    return made


def test_the_checkers_of_pettingzoo_are_content(fleet):
    parallel_api_test(fleet(), num_cycles=300)
    parallel_seed_test(fleet, num_cycles=60)


def test_agents_leave_one_by_one_and_nobody_meets_them_any_more(fleet):
    env = fleet(horizon=400)
    env.reset(seed=3)
    left, rng = [], np.random.default_rng(0)
    while env.agents:
        before = list(env.agents)
        actions = {name: rng.uniform(-0.3, 0.9, 2) for name in before}
        views, rewards, ended, late, _ = env.step(actions)
        gone = [name for name in before if name not in env.agents]
        assert all(ended[name] or late[name] for name in gone)
        assert set(views) == set(rewards) == set(before)
        left += gone
    assert sorted(left) == env.possible_agents
    assert (env.engine.state.whole[0, 9, :4] == 0).all()  # alive
    assert len(env.reset()[0]) == 4


def test_who_is_under_way_needs_an_action(fleet):
    env = fleet()
    env.reset(seed=1)
    with pytest.raises(UsageError, match="no action for vehicle_1, vehicle_2, vehicle_3"):
        env.step({"vehicle_0": np.zeros(2)})
    with pytest.raises(UsageError, match=r'no environment "flet".* mean "fleet"'):
        parallel_env("flet")


def test_who_looks_on_sees_every_step_of_the_first_that_is_under_way(fleet, monkeypatch):
    shown = []

    class Screen:
        def __init__(self, title, seconds):
            assert (title, seconds) == ("fleet", 0.1)

        def show(self, image):
            shown.append(image.copy())

        def close(self):
            shown.append(None)

    monkeypatch.setattr("cityx.sim.parallel.Window", Screen)
    env = fleet(render_mode="human")
    env.reset(seed=4)
    for _ in range(5):
        env.step({name: np.array([0.0, 1.0]) for name in env.agents})
    assert env.render() is None
    assert len(shown) == 6
    assert shown[0].shape == (320, 320, 3)
    assert (shown[0] != shown[5]).any()
    env.close()
    assert shown[-1] is None
    with pytest.raises(UsageError, match='render_mode is "humn"; known are human, rgb_array'):
        fleet(render_mode="humn")
