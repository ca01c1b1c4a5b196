"""People about those who drive: they cross, are seen, are stopped for, and are hit by name."""

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

from cityx.errors import UsageError
from cityx.sim.baseline import rule_actions, trips_of
from cityx.sim.drives import driven
from cityx.sim.info import happened
from cityx.sim.kernels.tables import CRASH_HUMAN, HEADING, LIMIT, SPEED, X, Y, Z
from cityx.sim.observe import PRESETS
from cityx.sim.record import read_recording, replay
from cityx.sim.tasks import DRIVE, engine_of


@pytest.fixture
def streets(placed):
    """Return an engine of drivers among people, seeded and begun."""

    def made(worlds=1, seed=0, threads=1, **options):
        given = {"place": placed, "goal_m": 60.0, "traffic": 4, "people": 20, **options}
        found = engine_of("drive", worlds, threads, given)
        found.seed(seed)
        found.begin()
        return found

    return made


def stood_before(engine, metres):
    """Put the first person so far ahead of the agent, on its route, and let it stand there."""
    real = engine.state.real[0]
    ahead = metres * np.array([np.cos(real[HEADING, 0]), np.sin(real[HEADING, 0])])
    real[[X, Y], 1] = real[[X, Y], 0] + ahead
    real[Z, 1], real[LIMIT, 1], real[SPEED, 1] = real[Z, 0], 0.0, 0.0


def test_a_world_with_people_does_not_depend_on_its_batch_nor_on_threads(streets, actions):
    whole, threaded, single = streets(5, 3), streets(5, 3, 2), streets(1, 5)
    for action in actions(80, 5):
        for each, low in ((whole, 0), (threaded, 0), (single, 2)):
            each.step(np.ascontiguousarray(action[low : low + each.worlds]))
    assert whole.state.digests() == threaded.state.digests()
    assert single.state.digests()[0] == whole.state.digests()[2]
    assert single.view.tobytes() == whole.view[2:3].tobytes()


def test_who_is_hit_on_foot_is_named(streets):
    engine = streets(traffic=0, people=1)
    stood_before(engine, 5.0)
    for _ in range(40):
        engine.step(np.array([[[0.0, 1.0]]]), anew=False)
        if engine.out.ended[0, 0]:
            break
    assert engine.out.event[0, 0] == CRASH_HUMAN
    assert happened(engine, 0, 0) == [{"event": "crash_human", "object": "person:0"}]
    assert engine.out.cost[0, 0] == 1.0
    assert engine.out.reward[0, 0] == -5.0


def test_the_driver_by_rule_stops_for_who_stands_in_its_way(streets):
    engine = streets(traffic=0, people=1)
    stood_before(engine, 12.0)
    for _ in range(100):
        engine.step(rule_actions(engine), anew=False)
        assert not engine.out.event[0, 0]
    real = engine.state.real[0]
    away = np.hypot(*(real[[X, Y], 0] - real[[X, Y], 1]))
    assert real[SPEED, 0] < 0.1
    assert 2.0 < away < 8.0


def test_people_cross_streets_and_a_driver_by_rule_arrives_among_them(streets, placed):
    walks = placed[1]
    engine = streets(8, 1, people=40)
    crossing, frame = walks.cell_crossing, walks.cell_frame
    over = 0
    for _ in range(400):
        engine.step(rule_actions(engine))
        real = engine.state.real[:, :, 1:41]
        column = ((real[:, X] - frame[0]) // frame[2]).astype(int).clip(0, crossing.shape[1] - 1)
        row = ((real[:, Y] - frame[1]) // frame[2]).astype(int).clip(0, crossing.shape[0] - 1)
        over += int((crossing[row, column] > 0).sum())
    assert over > 50
    assert trips_of(engine, 2, 1).success >= 0.8


def test_people_are_seen_and_hide_no_vehicle(streets):
    engine = streets(people=60, traffic=6, agents=4)
    for _ in range(60):
        engine.step(np.zeros((1, 4, 2)))
    near = PRESETS["state"].part(engine.view, "neighbours").reshape(4, 8, 7)
    afoot = (near[..., 5] > 0) & (near[..., 5] < 0.5 / 20)
    assert 0 < afoot.sum(axis=1).max() <= 4
    away = np.hypot(near[..., 0], near[..., 1])
    away[near[..., 5] == 0] = np.inf
    assert (np.diff(np.where(np.isinf(away), 9.0, away), axis=1) >= 0).all()
    puffer = streets(people=60, traffic=6, agents=4, observation="puffer")
    partner = PRESETS["puffer"].part(puffer.view, "partners").reshape(4, 63, 7)
    for row in partner:
        size = row[row[:, 3] > 0, 3] * 30.0
        assert (np.diff((size < 0.5).astype(int)) >= 0).all()
    assert (partner[..., 3] * 30.0 > 1.0).any()
    assert ((partner[..., 3] > 0) & (partner[..., 3] * 30.0 < 0.5)).any()


def test_a_recording_with_people_drives_again(placed, tmp_path):
    path = tmp_path / "people.npz"
    driven(placed, {"goal_m": 50.0, "people": 15}, 1, 4, say=[].append, record=path)
    recording = read_recording(path)
    assert recording.options.people == 15
    assert replay(recording, placed) == len(recording.actions)


def test_the_checker_of_gymnasium_is_content_among_people(town):
    made = gymnasium.make(DRIVE, place=town, goal_m=60.0, people=8, render_mode="rgb_array")
    check_env(made.unwrapped)
    made.close()


def test_people_need_walks(world):
    with pytest.raises(UsageError, match="A world has no walks; give the folder"):
        engine_of("drive", 1, 1, {"place": world, "people": 3})
    with pytest.raises(UsageError, match=r"people is -1; it takes a whole number from 0 to 250"):
        engine_of("drive", 1, 1, {"place": world, "people": -1})
