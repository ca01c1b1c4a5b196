"""Cameras of agents see what the rays of the data set see, movers too, the same bytes anywhere."""

import subprocess
import sys
from dataclasses import replace

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from PIL import Image
from typer.testing import CliRunner

import cityx
from cityx.city.signals import GO, STATES
from cityx.city.store import read_city, view_of
from cityx.cli.main import app
from cityx.dataset.classes import CLASS
from cityx.dataset.shots import Shot
from cityx.dataset.sight import sight
from cityx.dataset.stage import stage_of
from cityx.errors import UsageError
from cityx.ids import stable_id
from cityx.sim.cameras import CHANNELS, FARTHEST, Cameras, Mount, mount_of
from cityx.sim.kernels import shade
from cityx.sim.kernels.idm import shown
from cityx.sim.kernels.tables import ALIVE, HEADING, HEIGHT, LENGTH, WIDTH, X, Y, Z
from cityx.sim.places import scenery_of
from cityx.sim.scenery import LAMPS

SMALL = {"size": (64, 48), "fov": 80}


@pytest.fixture(scope="session")
def scenery(town, world):
    return scenery_of(town, world)


@pytest.fixture(scope="session")
def stage(town):
    return stage_of(replace(view_of(read_city(town / "city")), tracks=None))


@pytest.fixture
def cameras(engine, scenery):
    """Return cameras of an engine, with nobody about, and the engine."""

    def made(seed=0, **options):
        one = engine(1, seed, traffic=2)
        one.state.whole[:, ALIVE, 1:] = 0
        return Cameras(one, scenery, Mount(**{"size": (160, 120), **options})), one

    return made


def rays_of(stage, camera):
    """Return depth, class and id of each pixel by the rays of the data set."""
    seen = sight(stage, Shot("one", camera, "one"))
    size = (camera.height, camera.width)
    depth = np.minimum(seen.hits.distance, FARTHEST).reshape(size)
    semantic = np.where(seen.met, stage.semantic[seen.rows], 0).reshape(size)
    return depth, semantic, np.where(seen.met, stage.object_id[seen.rows], 0).reshape(size)


@pytest.mark.parametrize("pitch", [-35.0, 0.0, 30.0])
def test_pictures_and_truth_of_the_data_set_agree(cameras, stage, pitch):
    for seed in range(4):
        own, _ = cameras(seed, pitch=pitch)
        camera = own.camera(0, 0)
        found = own.seen(camera, 0, 0)
        depth, semantic, instance = rays_of(stage, camera)
        assert len(np.unique(instance)) > 3
        assert (found["instance"] == instance).mean() > 0.999
        assert (found["semantic"] == semantic).mean() > 0.999
        assert (np.abs(found["depth"] / depth - 1) < 1e-4).mean() > 0.999


def test_who_moves_is_seen_where_it_is_and_by_its_name(cameras):
    own, engine = cameras()
    real, whole = engine.state.real[0], engine.state.whole[0]
    for row in (LENGTH, WIDTH, HEIGHT, HEADING, Z):
        real[row, 1] = real[row, 0]
    ahead = 8.0
    real[X, 1] = real[X, 0] + ahead * np.cos(real[HEADING, 0])
    real[Y, 1] = real[Y, 0] + ahead * np.sin(real[HEADING, 0])
    empty = own.seen(own.camera(0, 0), 0, 0)
    whole[ALIVE, 1] = 1
    found = own.seen(own.camera(0, 0), 0, 0)
    seen = found["instance"] == stable_id("sim", "traffic:0")
    assert seen.sum() > 200
    assert (empty["instance"][~seen] == found["instance"][~seen]).all()
    assert (found["semantic"][seen] == CLASS["car"]).all()
    # Its rear is 8 m less its length away; it hides what is behind.
    assert found["depth"][seen].min() == pytest.approx(ahead - real[LENGTH, 0], abs=0.3)
    assert (found["depth"][seen] < empty["depth"][seen]).all()


def test_nobody_sees_the_own_body(cameras):
    own, _ = cameras(at=(0.0, 0.0, 0.8))
    camera = own.camera(0, 0)
    mine = stable_id("sim", "agent:0")
    assert mine not in own.seen(camera, 0, 0)["instance"]
    assert (own.seen(camera, 0)["instance"] == mine).mean() > 0.5


def test_the_camera_is_where_it_is_held_and_turns_with_the_agent(cameras):
    own, engine = cameras(at=(2.0, 1.0, 3.0))
    real = engine.state.real[0]
    real[[X, Y, Z, HEADING], 0] = 10.0, 20.0, 5.0, np.pi / 2  # northwards
    camera = own.camera(0, 0)
    assert camera.position == pytest.approx((9.0, 22.0, 8.0))
    assert camera.heading == pytest.approx(0.0)


def test_lamps_show_what_the_clock_of_the_world_has(cameras, scenery, world):
    own, engine = cameras(pitch=-30.0)
    piece = int(np.flatnonzero(world.piece_signal >= 0)[0])
    x, y, _, heading = world.point[world.point_start[piece], :4]
    # The ground before the camera shall be a pole at the line of that way, all of it green lamp.
    camera = own.camera(0, 0)
    instance = own.seen(camera, 0, 0, ("instance",))["instance"][-1, 80]
    row = int(np.flatnonzero(scenery.object_id == instance)[0])
    first = scenery.thing_object[scenery.thing_object <= row].max()
    ground = np.flatnonzero(scenery.thing_object == first)
    lamps = np.full(len(scenery.face_lamp), LAMPS["signal_green"], np.uint8)
    own.scenery = replace(scenery, face_lamp=lamps)
    own._poles = ground
    own._feet = np.tile([x, y], (len(ground), 1))
    own._facing = np.tile([-np.cos(heading), -np.sin(heading)], (len(ground), 1))
    told = set()
    for clock in np.arange(0.0, 64.0, 4.0):
        engine.state.clock[0] = clock
        state = int(shown(engine.map, int(world.piece_signal[piece]), float(clock)))
        go = STATES[state] in GO
        told.add(go)
        red, green, _ = own.seen(camera, 0, 0, ("rgb",))["rgb"][-1, 80].tolist()
        assert (green > 150 and green > 2 * red) == go
    assert told == {True, False}


def test_a_batch_sees_what_single_environments_see(town):
    kept = {"place": town, "observation": ["camera", "state"], "camera": SMALL, "goal_m": 60.0}
    many = cityx.make_vec("CityX/Drive-v0", num_envs=3, threads=2, **kept)
    views, _ = many.reset(seed=5)
    for _ in range(4):
        views, *_ = many.step(np.full((3, 2), 0.2, np.float32))
    for e in range(3):
        one = cityx.make("CityX/Drive-v0", **kept)
        view, _ = one.reset(seed=5 + e)
        for _ in range(4):
            view, *_ = one.step(np.full(2, 0.2, np.float32))
        for name in CHANNELS:
            assert (views[name][e] == view[name]).all()


TOLD = """
import sys, hashlib, cityx, numpy as np
env = cityx.make("CityX/Deliver-v0", sys.argv[1], observation="camera", camera={"size": (64, 48)})
seen = hashlib.sha256()
view, _ = env.reset(seed=3)
for _ in range(6):
    for name in sorted(view):
        seen.update(view[name].tobytes())
    view, *_ = env.step(np.array([0.1, 0.5]))
print(seen.hexdigest())
"""


@pytest.mark.usefixtures("scenery")  # compiled once, here
def test_two_processes_see_the_same_bytes(town):
    told = [subprocess.run([sys.executable, "-c", TOLD, str(town)], capture_output=True, text=True,
                           check=True).stdout for _ in range(2)]  # fmt: skip
    assert told[0] == told[1]
    assert len(told[0]) > 60


def test_the_checker_of_gymnasium_is_content_with_cameras(town):
    for observation in ("rgb", ["camera", "state"]):
        made = gymnasium.make("CityX/Drive-v0", place=town, observation=observation,
                              camera=SMALL, goal_m=60.0, render_mode="rgb_array")  # fmt: skip
        check_env(made.unwrapped, skip_render_check=True)
        made.close()


def test_a_camera_may_be_for_who_looks_on_alone(town):
    env = cityx.make("CityX/Drive-v0", town, render_mode="camera", camera=SMALL, goal_m=60.0)
    view, _ = env.reset(seed=1)
    assert view.shape == (87,)
    before = env.engine.state.digests()
    image = env.render()
    assert image.shape == (48, 64, 3)
    assert image.std() > 10
    assert env.engine.state.digests() == before


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"fow": 60}, ['A camera has no "fow"', "fov"]),
        ({"size": (0, 40)}, ["size", "8 to 2048"]),
        ({"fov": float("nan")}, ["fov", "10 to 150"]),
        ({"at": (1, 2)}, ["three metres"]),
        ("wide", ["takes a dict of size, fov, at, pitch"]),
    ],
)
def test_a_camera_of_no_use_is_refused_in_a_sentence(given, words):
    with pytest.raises(UsageError) as told:
        mount_of(given)
    assert [word for word in words if word not in str(told.value)] == []


def test_a_world_without_its_city_has_nothing_to_be_seen(world, monkeypatch, tmp_path):
    monkeypatch.setenv("CITYX_CACHE", str(tmp_path))
    with pytest.raises(UsageError, match="give the folder of the city"):
        cityx.make("CityX/Drive-v0", world, observation="depth")


def test_a_wall_throws_its_shade_away_from_the_sun():
    top = np.zeros((1, 40), np.float32)
    top[0, 30] = 6.0  # metres, of cells of 1 m
    dark = np.zeros_like(top)
    shade.darken(top, np.array([0.0, 0.0, 1.0, 40.0, 1.0]), 1.0, 0.0, 0.5, 100.0, dark)
    # The sun is in the east, half a metre up for each metre: 12 m of shade to the west of it.
    assert (dark[0, 20:28] > 0).all()
    assert dark[0, 25] == pytest.approx(6.0 - 0.5 * 5.0, abs=0.3)
    assert (dark[0, :17] <= 0).all()
    assert (dark[0, 31:39] <= 0).all()


def test_the_command_films_what_the_camera_sees(town, tmp_path):
    strip = tmp_path / "seen.png"
    told = CliRunner().invoke(app, ["sim", str(town), "--episodes", "1", "--goal-m", "40",
                                    "--picture", str(strip), "--camera"])  # fmt: skip
    assert told.exit_code == 0, told.output
    with Image.open(strip) as image:
        assert image.size == (4 * 320, 2 * 200)
    refused = CliRunner().invoke(app, ["sim", str(town), "--camera"])
    assert refused.exit_code != 0
