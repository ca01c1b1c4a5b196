"""A driver by rule arrives, chance does not, and what was driven can be driven again."""

import re

import numpy as np
import pytest
from PIL import Image
from typer.testing import CliRunner

from cityx.cli.main import app
from cityx.errors import InputError
from cityx.sim.baseline import rule_actions, trips_of
from cityx.sim.drives import driven
from cityx.sim.kernels.boxes import boxes_touch
from cityx.sim.kernels.idm import shown
from cityx.sim.kernels.tables import (
    ALIVE,
    BEFORE,
    HEADING,
    LENGTH,
    PIECE,
    SPEED,
    WIDTH,
    X,
    Y,
)
from cityx.sim.record import read_recording, replay


def test_a_driver_by_rule_arrives_and_chance_does_not(engine):
    assert trips_of(engine(32, traffic=0), 2).success >= 0.95
    assert trips_of(engine(32, traffic=0), 2, chance=True).success == 0.0


def test_a_driver_by_rule_reads_the_state_and_leaves_it(engine):
    one = engine(4)
    before = one.state.digests()
    actions = rule_actions(one)
    assert one.state.digests() == before
    assert np.abs(actions).max() <= 1.0


def test_traffic_keeps_moving_does_not_overlap_and_halts_at_red(engine, world):
    one = engine(2, traffic=6)
    real, whole = one.state.real, one.state.whole
    speeds, entered = [], 0
    for step in range(1800):
        before = whole[:, PIECE].copy()
        one.step(np.tile([0.0, -1.0], (2, 1, 1)), anew=False)
        for e in range(2):
            real[e, 2, 0] = 500.0  # the agent is out of the way
            rows = np.flatnonzero(whole[e, ALIVE] == 1)[1:]
            speeds.append(real[e, SPEED, rows].mean())
            for m in rows[whole[e, PIECE, rows] != before[e, rows]].tolist():
                piece = whole[e, PIECE, m]
                if world.piece_signal[piece] >= 0 and whole[e, BEFORE, m] == before[e, m]:
                    entered += 1
                    assert shown(one.map, world.piece_signal[piece], one.state.clock[e]) >= 3
            if step % 10 == 0:
                boxes = real[e][[X, Y, HEADING, LENGTH, WIDTH]][:, rows].T * [1, 1, 1, 0.5, 0.5]
                for k, a in enumerate(boxes):
                    assert not any(boxes_touch(*a, *b) for b in boxes[k + 1 :])
    assert entered > 5
    assert np.mean(speeds[-1200:]) > 0.6 * np.mean(speeds[:1200])


def test_a_recording_drives_again_to_the_same_digests_and_says_where_it_does_not(world, tmp_path):
    told = []
    driven(world, {"goal_m": 60.0, "density": 8.0}, 3, 7, say=told.append,
           record=tmp_path / "drive.npz")  # fmt: skip
    recording = read_recording(tmp_path / "drive.npz")
    assert replay(recording, world) == len(recording.actions) > 50
    assert sum("episode 3" in line for line in told) >= 1
    recording.actions[60:62, 0, 1] = -1.0
    with pytest.raises(InputError, match="differs from the recorded one at step 100"):
        replay(recording, world)


def test_what_is_no_recording_is_refused(tmp_path):
    (tmp_path / "drive.npz").write_bytes(b"PK")
    with pytest.raises(InputError, match="is no recording of an episode"):
        read_recording(tmp_path / "drive.npz")


def test_the_command_drives_records_and_drives_again(town, tmp_path):
    record, film = tmp_path / "drive.npz", tmp_path / "drive.gif"
    run = CliRunner().invoke(app, ["sim", str(town), "--episodes", "2", "--goal-m", "50",
                                   "--record", str(record), "--picture", str(film)])  # fmt: skip
    assert run.exit_code == 0, run.output
    assert re.search(r"m of lanes, of which fit small_car \d+\.\d%, car", run.output)
    assert re.search(r"episode 2, [\d.]+ s: goal at", run.output)
    assert "2 of 2 reached their goal" in run.output
    assert film.read_bytes()[:3] == b"GIF"
    strip = tmp_path / "drive.png"
    run = CliRunner().invoke(app, ["sim", str(town), "--episodes", "1", "--picture", str(strip)])
    assert run.exit_code == 0, run.output
    with Image.open(strip) as image:
        assert image.size == (1280, 640)
    again = CliRunner().invoke(app, ["sim", str(town), "--replay", str(record)])
    assert re.search(r"\d+ steps again, every digest the same", again.output)
