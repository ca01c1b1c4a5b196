"""Worlds step the same way alone, in a batch, in threads and in another process."""

import json
import subprocess
import sys

import numpy as np
import pytest

from cityx.errors import UsageError
from cityx.ids import id_text
from cityx.sim.info import struck
from cityx.sim.kernels.tables import (
    CRASH_OBJECT,
    CRASH_VEHICLE,
    GOAL_REACHED,
    LATE,
    OFF_ROAD,
    REAL,
    TERMS,
)
from cityx.sim.observe import PRESETS
from cityx.sim.options import options_of
from cityx.sim.state import read_state


def driven(engine, actions, **options):
    """Return the digests of worlds after some actions."""
    for action in actions:
        engine.step(np.ascontiguousarray(action), **options)
    return engine.state.digests()


@pytest.mark.parametrize("worlds", [1, 7, 64])
def test_a_world_does_not_depend_on_the_others_of_its_batch(engine, actions, worlds):
    taken = actions(120, 64)
    whole = driven(engine(64, seed=5), taken)
    assert driven(engine(worlds, seed=5), taken[:, :worlds]) == whole[:worlds]


def test_threads_change_nothing(engine, actions):
    taken = actions(80, 9)
    assert driven(engine(9, threads=2), taken) == driven(engine(9), taken)


def test_another_seed_gives_another_episode(engine, actions):
    taken = actions(5, 1)
    assert driven(engine(1, seed=1), taken) != driven(engine(1, seed=2), taken)


PROGRAM = """
import json, sys
import numpy as np
from cityx.sim.engine import Engine
from cityx.sim.options import options_of
from cityx.sim.places import world_of
engine = Engine(world_of(sys.argv[1]), options_of({"goal_m": 60.0, "traffic": 4}), 3)
engine.seed(11)
engine.begin()
drawn = np.random.default_rng(0).uniform(-1, 1, (60, 3, 1, 2)) * [0.15, 0.5] + [0.0, 0.3]
for action in drawn:
    engine.step(action)
heavy = [name for name in ("bpy", "compas_cgal", "onnxruntime", "geopandas") if name in sys.modules]
print(json.dumps([engine.state.digests(), heavy]))
"""


def test_another_process_steps_the_same_and_imports_nothing_heavy(town, engine, actions):
    done = subprocess.run([sys.executable, "-c", PROGRAM, str(town)], capture_output=True,
                          text=True, check=True)  # fmt: skip
    digests, heavy = json.loads(done.stdout)
    assert digests == driven(engine(3, seed=11), actions(60, 3))
    assert heavy == []


def test_a_copy_of_a_state_goes_on_as_the_state_does(engine, actions, tmp_path):
    one, taken = engine(2), actions(60, 2)
    driven(one, taken[:30])
    one.state.write(tmp_path / "state.npz")
    kept = one.state.copy()
    end = driven(one, taken[30:])
    one.state.assign(kept)
    assert driven(one, taken[30:]) == end
    one.state.assign(read_state(tmp_path / "state.npz"))
    assert driven(one, taken[30:]) == end


def test_rewards_are_the_sum_of_their_terms_and_episodes_end_by_events(engine, actions):
    one = engine(64)
    seen = 0
    for action in actions(200, 64):
        one.step(action)
        out = one.out
        assert np.allclose(out.reward, out.term.sum(axis=0))
        ends = CRASH_VEHICLE | CRASH_OBJECT | OFF_ROAD | GOAL_REACHED
        assert (out.ended[(out.event & ends) != 0]).all()
        seen |= int(np.bitwise_or.reduce(out.event, axis=None))
        fell = (out.event & OFF_ROAD) != 0
        assert (out.term[TERMS.index("off_road")][fell] == -5.0).all()
    assert seen & OFF_ROAD
    assert seen & CRASH_OBJECT


def test_whoever_stands_still_is_cut_off_at_the_horizon(engine):
    one = engine(1, horizon=20, traffic=0)
    for _ in range(20):
        assert not one.out.late[0, 0]
        one.step(np.array([[[0.0, -1.0]]]), anew=False)
    assert one.out.late[0, 0]
    assert not one.out.ended[0, 0]
    assert one.out.event[0, 0] & LATE


def test_what_was_hit_is_named(engine, actions, world):
    one, named = engine(64), []
    for action in actions(300, 64):
        one.step(action)
        hit = (one.out.event & CRASH_OBJECT) != 0
        named += [struck(one, int(row)) for row in one.out.touched[hit]]
    assert named
    assert set(named) <= {id_text(int(each)) for each in world.segment_object}


def test_a_car_goes_as_far_as_its_speed_says_and_turns_about_its_wheelbase(engine):
    one = engine(1, traffic=0)
    real, rows = one.state.real[0], {name: row for row, name in enumerate(REAL)}
    real[rows["x"], 0] = real[rows["y"], 0] = real[rows["heading"], 0] = 0.0
    real[rows["speed"], 0], real[rows["steer"], 0] = 5.0, 0.3
    for _ in range(10):
        one.step(np.array([[[0.5, 0.0]]]), anew=False)
    radius = 2.7 / np.tan(0.3)
    turned = 5.0 / radius
    # The rear axle runs on a circle; it begins 1.35 m behind the middle.
    x = -1.35 + radius * np.sin(turned) + 1.35 * np.cos(turned)
    y = radius * (1 - np.cos(turned)) + 1.35 * np.sin(turned)
    assert np.allclose(real[[rows["x"], rows["y"]], 0], [x, y], atol=0.01)


@pytest.mark.parametrize("preset", sorted(PRESETS))
def test_observations_keep_to_their_space(engine, actions, preset):
    one = engine(32, observation=preset)
    assert one.preset.size == {"state": 87, "metadrive": 259, "puffer": 1848}[preset]
    for action in actions(60, 32):
        one.step(action)
        assert np.isfinite(one.view).all()
        assert one.view.min() >= one.preset.low
        assert one.view.max() <= one.preset.high


def test_agents_of_one_world_see_each_other_and_begin_anew_one_by_one(engine, actions):
    one = engine(2, agents=5, traffic=0, observation="puffer")
    partners = one.preset.part(one.view, "partners").reshape(2, 5, 63, 7)
    assert (np.abs(partners).sum(axis=(2, 3)) > 0).any()
    for action in actions(40, 2, 5):
        before = one.state.whole[:, 8, :5].copy()  # steps
        one.step(action)
        done = one.out.ended | one.out.late
        assert (one.state.whole[:, 8, :5][~done] == before[~done] + 1).all()
        assert (one.state.whole[:, 8, :5][done] == 0).all()


def test_every_fault_of_options_is_told_at_once_with_the_nearest_word():
    with pytest.raises(UsageError) as told:
        options_of({"observation": "stat", "hoirzon": 5, "density": 50, "reward": {"sucess": 1}})
    for words in ('observation is "stat"', 'mean "state"', 'no option "hoirzon"',
                  'mean "horizon"', "density is 50; it takes a number from 0 to 20",
                  'no term "sucess"'):  # fmt: skip
        assert words in str(told.value)
