"""A robot with contacts as an environment: rules, baseline, bytes, and a user's own robot."""

import subprocess
import sys
from hashlib import blake2b
from pathlib import Path

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

import cityx
from cityx.errors import InputError, UsageError
from cityx.sim.contact.robots import ROBOT, Robot
from cityx.sim.kernels.tables import ALIVE, HEADING, HEIGHT, LENGTH, WIDTH, X, Y, Z

pytest.importorskip("mujoco")
NAME = "CityX/Contact-v0"
FOUR_WHEELS = Path(__file__).parents[2] / "examples/contact/robot.xml"


@pytest.fixture
def contact(town):
    made = []

    def make(**options):
        made.append(
            cityx.make(NAME, town, **{"goal_m": 40.0, "people": 2, "traffic": 1, **options})
        )
        return made[-1]

    yield make
    for env in made:
        env.close()


def digest(env, steps=60):
    """Return a hash of what is observed and rewarded by chance."""
    rng, hasher = np.random.default_rng(0), blake2b(digest_size=16)
    view, _ = env.reset(seed=4)
    for _ in range(steps):
        hasher.update(view.tobytes())
        view, reward, ended, late, _ = env.step(rng.uniform(0.2, 0.7, 2).astype(np.float32))
        hasher.update(np.float64(reward).tobytes())
        if ended or late:
            view, _ = env.reset()
    return hasher.hexdigest()


PROGRAM = """
import sys
import cityx
from test_contact_env import NAME, digest
print(digest(cityx.make(NAME, sys.argv[1], goal_m=40.0, people=2, traffic=1)))
"""


def test_the_checker_of_gymnasium_is_content(town):
    made = gymnasium.make(NAME, place=town, goal_m=40.0, render_mode="rgb_array")
    check_env(made.unwrapped)
    made.close()


def test_the_checker_of_stable_baselines_is_content(contact):
    checker = pytest.importorskip("stable_baselines3.common.env_checker")
    checker.check_env(contact())


def test_another_process_sees_the_same_bytes(contact, town):
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM, str(town)], capture_output=True, text=True, check=True,
        cwd=Path(__file__).parent,
    )  # fmt: skip
    assert done.stdout.strip() == digest(contact())


def test_by_rule_the_robot_gets_to_its_goal(contact):
    env = contact(people=0, traffic=0)
    for seed in range(3):
        view, _ = env.reset(seed=seed)
        over = False
        while not over:
            view, _, ended, late, info = env.step(env.engine.act_by_rule()[0, 0])
            assert view in env.observation_space
            over = ended or late
        assert info["is_success"], info["events"]


def test_a_robot_that_falls_over_has_fallen(contact):
    env = contact()
    env.reset(seed=1)
    window = env.engine.window()
    window.data.qpos[window.root.place + 3 : window.root.place + 7] = [0.7, 0.7, 0.0, 0.0]
    _, reward, ended, _, info = env.step(np.zeros(2, np.float32))
    assert ended
    assert {"event": "fall"} in info["events"]
    assert reward == -5.0


def test_who_is_run_into_is_named(contact):
    env = contact(people=1, traffic=0)
    env.reset(seed=1)
    real, whole = env.engine.state.real[0], env.engine.state.whole[0]
    named = []
    ahead = np.array([np.cos(real[HEADING, 0]), np.sin(real[HEADING, 0])])
    spot = real[[X, Y], 0] + 0.7 * ahead
    for _ in range(15):
        real[[X, Y, Z, LENGTH, WIDTH, HEIGHT], 1] = *spot, real[Z, 0], 0.46, 0.34, 1.75
        whole[ALIVE, 1] = 1
        *_, ended, _, info = env.step(np.ones(2, np.float32))
        named += info["events"]
        if ended:
            break
    assert {"event": "crash_mover", "object": "person:0"} in named


def test_a_robot_of_a_users_own_takes_its_place(contact):
    env = contact(robot=str(FOUR_WHEELS))
    assert env.action_space.shape == (4,)
    joints, speeds = Robot(FOUR_WHEELS).felt
    assert (joints, speeds) == (8, 4)
    assert env.observation_space.shape[0] == contact().observation_space.shape[0] + 4 + 2
    view, _ = env.reset(seed=2)
    begun = env.engine.window().position
    for _ in range(10):
        view, *_ = env.step(np.full(4, 0.5, np.float32))
        assert view in env.observation_space
    gone = env.engine.window().position - begun
    heading = env.engine.state.real[0, HEADING, 0]
    assert gone[:2] @ [np.cos(heading), np.sin(heading)] > 0.3


def robot_of(tmp_path, old, new):
    path = tmp_path / "robot.xml"
    text = ROBOT.read_text()
    assert old in text
    path.write_text(text.replace(old, new))
    return path


def test_robots_of_no_use_are_refused_by_a_sentence(contact, town, tmp_path):
    free = robot_of(tmp_path, ' ctrlrange="-14 14"', "")
    with pytest.raises(InputError, match=r"does not say what its actuators take; give left, right"):
        contact(robot=str(free))
    still = tmp_path / "still.xml"
    still.write_text('<mujoco><worldbody><body><freejoint/><geom size="1"/></body></worldbody>'
                     "</mujoco>")  # fmt: skip
    with pytest.raises(InputError, match="has no actuator"):
        contact(robot=str(still))
    with pytest.raises(InputError, match="is no model of MuJoCo"):
        contact(robot=str(tmp_path / "none.xml"))
    with pytest.raises(UsageError, match="a world with contacts has one robot"):
        cityx.make_vec(NAME, town, num_envs=2, agents=2)
    with pytest.raises(UsageError, match="robot is 3; it takes the name of a file"):
        contact(robot=3)


def test_by_rule_only_wheels_on_two_sides_are_driven(tmp_path):
    other = robot_of(tmp_path, '"left"', '"one"')
    with pytest.raises(UsageError, match=r"called left and right, and are there; .* are one, r"):
        Robot(other).rolled(1.0, 0.0, 0.0)


def test_a_batch_is_its_worlds_one_by_one(town):
    options = {"goal_m": 40.0, "people": 2, "traffic": 1}
    batch = cityx.make_vec(NAME, town, num_envs=2, **options)
    one = cityx.make(NAME, town, **options)
    views = [batch.reset(seed=6)[0][1], one.reset(seed=7)[0]]
    for _ in range(15):
        assert views[0].tobytes() == views[1].tobytes()
        action = np.array([0.6, 0.5], np.float32)
        views = [batch.step(np.tile(action, (2, 1)))[0][1], one.step(action)[0]]
    batch.close()
    one.close()
