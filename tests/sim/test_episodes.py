"""Recorded episodes become cities with tracks and plans, of which data sets are made."""

import json
import re
from dataclasses import replace

import numpy as np
import pytest
from typer.testing import CliRunner

from cityx.city.store import read_city, view_of
from cityx.city.tracks import poses_at
from cityx.cli.main import app
from cityx.dataset.plans.custom import read_plan
from cityx.dataset.stage import stage_of
from cityx.errors import InputError, UsageError
from cityx.ids import stable_id
from cityx.sim.drives import driven
from cityx.sim.episodes import episode_of, tracks_of, write_episode
from cityx.sim.record import read_recording


@pytest.fixture(scope="module")
def recording(placed, tmp_path_factory):
    path = tmp_path_factory.mktemp("episodes") / "drive.npz"
    options = {"goal_m": 60.0, "traffic": 5, "people": 6}
    driven(placed, options, 2, 9, say=[].append, record=path)
    return path


@pytest.fixture(scope="module")
def exported(recording, town, tmp_path_factory):
    out = tmp_path_factory.mktemp("episodes") / "second"
    found = CliRunner().invoke(app, ["sim", str(town), "--replay", str(recording), "--export",
                                     str(out), "--episode", "2"])  # fmt: skip
    assert found.exit_code == 0, found.output
    assert re.search(r"episode 2, \d+ moments of 12 movers", found.output)
    return out


def test_movers_of_an_episode_are_where_the_engine_had_them(recording, placed):
    episode = episode_of(read_recording(recording), placed, 2)
    tracks = tracks_of(episode)
    rows = {int(key): row for row, key in enumerate(tracks.object_id)}
    for k in (0, len(episode.time) // 2, len(episode.time) - 1):
        poses = poses_at(tracks, float(episode.time[k]))
        there = {rows[int(stable_id("sim", name))]: n for n, name in enumerate(episode.names)
                 if int(stable_id("sim", name)) in rows and episode.there[k, n]}  # fmt: skip
        assert there
        for at, row in enumerate(poses.row.tolist()):
            if row in there:
                own = episode.real[k, :, there[row]]
                assert np.allclose(poses.position[at], own[:3], atol=1e-6)
                assert np.isclose(np.cos(poses.heading[at] - own[3]), 1.0)
    assert stable_id("sim", "agent:0") not in rows


def test_who_goes_elsewhere_is_another_one(recording, placed):
    episode = episode_of(read_recording(recording), placed, 1)
    real = episode.real.copy()
    real[20:, 0, 8] += 500.0
    tracks = tracks_of(replace(episode, real=real))
    assert {stable_id("sim", "traffic:1"), stable_id("sim", "traffic:1:2")} <= set(
        tracks.object_id.tolist()
    )
    step = np.hypot(*np.diff(tracks.position[:, :2], axis=0).T)
    inner = np.diff(tracks.mover) == 0
    assert step[inner].max() < 8.0


def test_the_city_of_an_episode_has_its_tracks_and_its_plan(exported, town):
    city = read_city(exported / "city")
    plan = json.loads((exported / "plan.json").read_text())["trajectories"][0]
    assert city.tracks.count >= 11
    assert city.moment == plan["moment"] == city.tracks.time.min()
    written = read_plan(exported / "plan.json", city)
    assert [each.name for each in written] == ["episode-2"]
    assert written[0].take.count == len(plan["keys"])
    assert (exported / "city" / "lanes.npz").samefile(town / "city" / "lanes.npz")
    stage = stage_of(view_of(city), city.moment)
    own = {stable_id("sim", f"{word}:{n}") for word, count in (("traffic", 5), ("person", 6))
           for n in range(count)}  # fmt: skip
    assert len(own & set(stage.object_id.tolist())) >= 10


def test_a_data_set_is_made_of_an_episode(exported, tmp_path):
    out = tmp_path / "set"
    made = CliRunner().invoke(app, [
        "dataset", str(exported), "--plan", str(exported / "plan.json"), "--views", "2",
        "--size", "64x48", "--channels", "semantic,instance", "--format", "webdataset", "--boxes",
        "-o", str(out),
    ])  # fmt: skip
    assert made.exit_code == 0, made.output
    assert list(out.rglob("*.tar"))


def test_the_same_episode_gives_the_same_bytes(recording, town, exported, tmp_path):
    episode = episode_of(read_recording(recording), town, 2)
    plan = write_episode(episode, town, tmp_path / "again")
    assert plan.read_bytes() == (exported / "plan.json").read_bytes()
    one, other = (folder / "city" / "tracks.npz" for folder in (exported, plan.parent))
    with np.load(one) as a, np.load(other) as b:
        assert all(np.array_equal(a[name], b[name]) for name in a.files)


def test_what_cannot_be_exported_is_said_in_a_sentence(recording, town, placed, tmp_path):
    held = read_recording(recording)
    with pytest.raises(InputError, match="has 3 episodes; there is no episode 7 of 2 moments"):
        episode_of(held, placed, 7)
    many = replace(held, options=replace(held.options, agents=3))
    with pytest.raises(UsageError, match="has 3 agents; episodes of one"):
        episode_of(many, placed)
    (tmp_path / "full").mkdir()
    (tmp_path / "full" / "note.txt").write_text("mine")
    with pytest.raises(UsageError, match="full is not empty"):
        write_episode(episode_of(held, placed), town, tmp_path / "full")
    found = CliRunner().invoke(app, ["sim", str(town), "--export", str(tmp_path / "out")])
    assert found.exit_code != 0
    assert "give --replay FILE as well" in str(found.exception)
