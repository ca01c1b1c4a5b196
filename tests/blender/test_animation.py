import json
import subprocess
import sys
from dataclasses import replace
from math import radians
from pathlib import Path

import numpy as np
import pytest
from moving_city import BIKE, CAR, MAN, RUNNER, moving
from PIL import Image
from scipy.spatial.transform import Rotation

from cityx.assets.people.gaits import going, stride_of
from cityx.assets.vehicles.movers import figure_of, vehicle
from cityx.assets.vehicles.moving import gait_phase
from cityx.blender.client import BlenderJob, RenderRequest, run_worker
from cityx.city.camera import Camera
from cityx.city.store import write_city
from cityx.city.tracks import GAIT

pytestmark = pytest.mark.blender
FRAMES = (0, 34, 100, 247)
SIDE = Camera("side", (5.0, -12.0, 1.5), 0.0, 0.0, radians(60), 64, 64)


@pytest.fixture(scope="module")
def blend(tmp_path_factory):
    """A .blend of things that move, opened in another process and played."""
    folder = tmp_path_factory.mktemp("moving")
    write_city(moving(CAR, MAN, RUNNER, BIKE), folder / "city")
    run_worker(BlenderJob(folder / "city", folder / "city.blend"), timeout_s=300)
    script = Path(__file__).with_name("inspect_moving.py")
    command = [sys.executable, script, folder / "city.blend", *map(str, FRAMES)]
    words = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    return json.loads(next(line for line in words.splitlines() if line.startswith("@{"))[1:])


def test_the_file_plays_the_tracks_at_25_frames_a_second(blend):
    assert (blend["range"], blend["rate"]) == ([0, 250], 25)


@pytest.mark.parametrize("frame", FRAMES)
@pytest.mark.parametrize("mover", [MAN, RUNNER], ids=["walk", "run"])
def test_a_person_is_the_figure_in_its_gait_where_the_track_has_it(blend, mover, frame):
    object_id, look, _, gait, start, heading, speed = mover
    figure = figure_of(look, 2)
    gone = speed * frame / 25
    ids = np.array([object_id], np.uint64)
    phase = gait_phase(stride_of(figure, GAIT[gait]), np.array([gone]), ids)[0]
    turn = Rotation.from_euler("z", heading + np.pi / 2).as_matrix()
    wanted = going(figure, GAIT[gait], float(phase)).vertices @ turn.T + np.array(start)
    wanted += gone * np.array([np.cos(heading), np.sin(heading), 0])
    found = blend["frames"][str(frame)][f"pedestrian_{object_id:016x}_body"]
    assert found["low"] == pytest.approx(wanted.min(axis=0), abs=0.04)
    assert found["high"] == pytest.approx(wanted.max(axis=0), abs=0.04)
    assert found["low"][2] > start[2] - 0.02


@pytest.mark.parametrize("frame", FRAMES)
def test_wheels_are_on_the_ground_and_turn_by_the_metres_gone(blend, frame):
    held = blend["frames"][str(frame)]
    radius = vehicle("car_sedan").wheels[0].radius
    angle = CAR[6] * frame / 25 / radius
    for number in range(4):
        wheel = held[f"car_{8:016x}_wheel_{number}"]
        assert wheel["low"][2] == pytest.approx(0.0, abs=0.01)
        assert wheel["axis"] == pytest.approx([np.sin(angle), 0, np.cos(angle)], abs=2e-3)
    assert held[f"car_{8:016x}"]["id"] == f"{8:016x}"
    assert held[f"bicycle_{10:016x}_rider_body"]["high"][2] > 1.5


def test_a_span_of_frames_is_a_picture_each_and_they_differ(tmp_path):
    write_city(replace(moving(CAR, MAN), moment=2.0), tmp_path / "city")
    request = RenderRequest(SIDE, tmp_path / "side.png", 2)
    made = run_worker(
        BlenderJob(tmp_path / "city", renders=(request,), frames=(10, 14, 2)), timeout_s=300
    )
    names = [path.name for path in made.files]
    assert names == ["side_0010.png", "side_0012.png", "side_0014.png"]
    first, last = (np.asarray(Image.open(made.files[i])).astype(float) for i in (0, -1))
    assert np.abs(first - last).max() > 20
    alone = BlenderJob(tmp_path / "city", renders=(request,), frames=(14, 14, 1))
    assert np.array_equal(np.asarray(Image.open(run_worker(alone).files[0])), last)
    still = run_worker(BlenderJob(tmp_path / "city", renders=(request,)), timeout_s=300)
    assert [path.name for path in still.files] == ["side.png"]


def test_a_picture_has_a_moment_of_its_own_with_keyframes_or_without(tmp_path):
    write_city(replace(moving(CAR, MAN), moment=2.0), tmp_path / "city")

    def pictures(name, blend=None, moment=1.0):
        request = RenderRequest(SIDE, tmp_path / f"{name}.png", 8, moment=moment)
        job = BlenderJob(tmp_path / "city", blend=blend, renders=(request,))
        run_worker(job, timeout_s=300)
        return np.asarray(Image.open(request.path)).astype(float)[..., :3]

    staged, keyed = pictures("staged"), pictures("keyed", tmp_path / "city.blend")
    assert np.abs(staged - keyed).mean() < 3.0
    assert np.abs(staged - pictures("own", moment=None)).mean() > 3.0
