"""Environments keep to Gymnasium's rules, and a batch is its single environments."""

import json
import os
import subprocess
import sys

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

import cityx
from cityx.city.store import read_city
from cityx.errors import UsageError
from cityx.sim.windows import Window


@pytest.fixture
def env(town):
    made = cityx.make("CityX/Drive-v0", place=town, goal_m=60.0, traffic=3)
    yield made
    made.close()


@pytest.mark.parametrize("observation", ["state", "metadrive", "puffer"])
@pytest.mark.parametrize("control", ["pedals", "target", "jerk"])
def test_the_checker_of_gymnasium_is_content(town, observation, control):
    made = gymnasium.make("CityX/Drive-v0", place=town, goal_m=60.0, observation=observation,
                          control=control, render_mode="rgb_array")  # fmt: skip
    check_env(made.unwrapped)
    made.close()


def test_a_batch_is_its_single_environments_over_ends_of_episodes(town):
    options = {"place": town, "goal_m": 60.0, "traffic": 3}
    batch = gymnasium.make_vec("CityX/Drive-v0", num_envs=8,
                               vectorization_mode="vector_entry_point", **options)  # fmt: skip
    single = cityx.make("CityX/Drive-v0", **options)
    views, _ = batch.reset(seed=20)
    view, _ = single.reset(seed=23)
    assert np.array_equal(views[3], view)
    ends = 0
    for action in np.random.default_rng(2).uniform(-0.3, 0.9, (300, 8, 2)).astype(np.float32):
        views, rewards, ended, late, info = batch.step(action)
        view, reward, own_end, own_late, _ = single.step(action[3])
        assert (rewards[3], ended[3], late[3]) == (reward, own_end, own_late)
        if own_end or own_late:
            ends += 1
            assert np.array_equal(info["final_obs"][3], view)
            assert info["_final_info"][3]
            view, _ = single.reset()
        assert np.array_equal(views[3], view)
    assert ends > 1
    batch.close()
    single.close()


def test_a_city_a_project_and_a_folder_give_the_same_episode(town, env):
    first, _ = env.reset(seed=4)
    for place in (read_city(town / "city"), cityx.open(town), town / "city"):
        other = cityx.make("CityX/Drive-v0", place=place, goal_m=60.0, traffic=3)
        assert np.array_equal(other.reset(seed=4)[0], first)


def test_a_map_file_is_built_by_another_process_once(town_map, env):
    made = cityx.make("CityX/Drive-v0", place=str(town_map), goal_m=60.0, traffic=3)
    view, info = made.reset(seed=4)
    assert np.array_equal(view, env.reset(seed=4)[0])
    assert info["route_m"] == 60.0


def test_processes_that_ask_for_one_place_at_once_build_it_once(town_map, tmp_path):
    order = {"build": str(tmp_path / "places" / "one"), "source": str(town_map), "text": "",
             "seed": 0, "size": None}  # fmt: skip
    command = [sys.executable, "-m", "cityx.sim.places", json.dumps(order), str(os.getpid())]
    both = [subprocess.Popen(command, stdout=subprocess.PIPE, text=True) for _ in range(2)]
    said = [json.loads(each.communicate()[0].strip().splitlines()[-1]) for each in both]
    assert said == [{"state": "done"}] * 2
    assert (tmp_path / "places" / "one" / "report.json").is_file()


def test_rendering_moves_nothing(town):
    made = cityx.make("CityX/Drive-v0", place=town, goal_m=60.0, render_mode="rgb_array")
    made.reset(seed=1)
    before = made.engine.state.digests()
    image = made.render()
    assert image.shape == (320, 320, 3)
    assert (image == (220, 60, 40)).all(axis=2).sum() > 100  # the agent
    assert made.engine.state.digests() == before


def test_what_is_wrong_is_said_in_a_sentence(town, env):
    with pytest.raises(
        UsageError, match=r'no environment "CityX/Drive-v1".* mean "CityX/Drive-v0"'
    ):
        cityx.make("CityX/Drive-v1", place=town)
    with pytest.raises(UsageError, match=r'no option "trafic".* mean "traffic"'):
        cityx.make("CityX/Drive-v0", place=town, trafic=3)
    env.reset(seed=0)
    with pytest.raises(UsageError, match="not finite"):
        env.step(np.array([np.nan, 0.0]))
    with pytest.raises(UsageError, match=r"shape \(3,\); it takes \(2,\)"):
        env.step(np.zeros(3))
    with pytest.raises(UsageError, match="multiple of agents"):
        cityx.make_vec("CityX/Drive-v0", place=town, num_envs=5, agents=2)


def test_the_simulator_is_imported_in_under_a_second_of_cpu():
    program = """import sys, time
begin = time.process_time()
import cityx.sim
print(time.process_time() - begin, "bpy" in sys.modules, "numba" in sys.modules)"""
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True,
                          check=True)  # fmt: skip
    seconds, *heavy = done.stdout.split()
    assert float(seconds) < 1.0
    assert heavy == ["False", "False"]


def test_who_looks_on_sees_every_step_in_a_window(town, monkeypatch):
    shown = []

    class Screen:
        def __init__(self, title, seconds):
            assert (title, seconds) == ("CityX/Drive-v0", 0.1)

        def show(self, image):
            shown.append(image.copy())

        def close(self):
            shown.append(None)

    monkeypatch.setattr("cityx.sim.env.Window", Screen)
    made = cityx.make("CityX/Drive-v0", town, render_mode="human", goal_m=60.0, traffic=2)
    plain = cityx.make("CityX/Drive-v0", town, goal_m=60.0, traffic=2)
    view, other = made.reset(seed=4)[0], plain.reset(seed=4)[0]
    for _ in range(5):
        view, other = made.step([0.0, 1.0])[0], plain.step([0.0, 1.0])[0]
    assert np.array_equal(view, other)
    assert made.render() is None
    assert len(shown) == 6
    assert shown[0].shape == (320, 320, 3)
    assert (shown[0] != shown[5]).any()
    made.close()
    assert shown[-1] is None


def test_where_there_is_no_screen_a_sentence_says_what_to_take(monkeypatch):
    import tkinter

    def dark(*_):
        raise tkinter.TclError("no display name")

    monkeypatch.setattr(tkinter, "Tk", dark)
    with pytest.raises(UsageError, match=r"needs a screen .* cityx sim PLACE --view"):
        Window("CityX", 0.1)


def test_with_jerk_pedals_and_wheel_move_no_faster_than_they_can(town):
    made = cityx.make("CityX/Drive-v0", town, control="jerk", goal_m=60.0, traffic=0)
    made.reset(seed=1)
    row = made.engine.state.row
    speeds, steers = [0.0], [0.0]
    for _ in range(12):
        made.step([0.4, 1.0])
        speeds.append(float(row("speed")[0, 0]))
        steers.append(float(row("steer")[0, 0]))
    push = np.diff(speeds) / 0.1
    assert 0 < push[0] <= 1.5 + 1e-9  # m/s2 after a tenth of a second at 15 m/s3
    assert (np.diff(push) <= 1.5 + 1e-9).all()
    assert push.max() == pytest.approx(3.0)
    assert np.allclose(np.diff(steers), 0.4 * 1.2 * 0.1)
