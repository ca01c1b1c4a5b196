import json
import subprocess
import sys
from dataclasses import replace
from math import cos, pi, radians, sin
from pathlib import Path

import numpy as np
import pytest
from conftest import box, quarter
from PIL import Image

from cityx.assets import trees
from cityx.assets.furniture.street_furniture import furniture
from cityx.blender.client import BlenderJob, RenderRequest, run_worker
from cityx.city import Environment, Instances, Scene, concatenate, one_mesh
from cityx.city.camera import Camera
from cityx.city.signals import STATE, Signals
from cityx.city.store import write_city

pytestmark = pytest.mark.blender
SNOWED = Environment(cloud_cover=1.0, snow=1.0, visibility=40_000.0)
ONE = np.ones(1, np.uint64)
# One head, for who comes from the south: green for ten seconds, then red.
SIGNALS = Signals(
    head_id=ONE, lane=ONE, onto=2 * ONE, crossing=0 * ONE, position=np.array([(-3.0, -1.0, 0.0)]),
    heading=np.array([np.pi / 2]), cycle=np.array([20.0]), change_start=np.array([0, 2]),
    time=np.array([0.0, 10.0]), state=np.array([STATE["green"], STATE["red"]], np.uint8),
)  # fmt: skip
BEFORE = Camera("before", (0.0, -3.0, 2.775), 0.0, 0.0, np.radians(22), 64, 64)


def rendered(folder, city, environment, camera, samples=32):
    write_city(replace(city, environment=environment), folder / "city")
    run_worker(
        BlenderJob(folder / "city", None, (RenderRequest(camera, folder / "p.png", samples),))
    )
    with Image.open(folder / "p.png") as picture:
        return np.asarray(picture.convert("RGB"), float).mean(axis=2)


@pytest.fixture(scope="module")
def changed(tmp_path_factory):
    """The made-up quarter, with two trees, under one weather after another."""
    city = quarter(2)
    forest = [trees.plant("lime", 0, "light"), trees.plant("spruce", 0, "light")]
    spots = np.array([(-5.0, -5.0, 0.0), (-9.0, -5.0, 0.0)])
    ones = np.ones((2, 3), np.float32)
    rows = Instances(np.arange(2, dtype=np.int32), np.array([5, 6], np.uint64),
                     np.zeros(2, np.uint64), spots, 0 * ones, ones, ones)  # fmt: skip
    city = replace(city, scene=city.scene.with_instances("trees", forest, rows))
    folder = tmp_path_factory.mktemp("light")
    write_city(city, folder / "city")
    script = Path(__file__).with_name("inspect_light.py")
    words = subprocess.run(
        [sys.executable, script, folder / "city"], capture_output=True, text=True, check=True
    ).stdout
    return json.loads(next(line for line in words.splitlines() if line.startswith("@{"))[1:])


def test_changing_the_weather_touches_no_geometry(changed):
    assert len(changed["before"]) > 5
    for change, after in changed["after"].items():
        assert after == changed["before"], change


def test_changing_the_weather_takes_less_than_two_seconds_of_a_core(changed):
    assert max(changed["seconds"].values()) < 2.0


def test_the_scene_shows_the_weather_it_was_changed_to_and_nothing_of_the_last(changed):
    assert changed["knobs"]["storm"] == [1.0, 0.0]
    assert changed["knobs"]["snow dusk"][1] == pytest.approx(0.85)
    assert changed["knobs"]["clear"] == [0.0, 0.0]
    assert changed["falling"]["storm"] > 1000
    assert changed["falling"]["snow dusk"] > 1000
    assert changed["falling"]["clear"] == changed["falling"]["night"] == 0
    assert (changed["worlds"], changed["moons"]) == (1, 0)


def test_ground_behind_a_wall_is_metered_by_the_half_of_the_sky_it_sees(changed):
    # The sun gives 5 sin 30 degrees of the sky's light, walls a quarter of what they hide.
    assert changed["light"]["sun"] == pytest.approx([(2.5 + 0.625) / 3.5])
    assert changed["light"]["shade"] == pytest.approx([0.625 / 3.5])


def test_deciduous_trees_alone_are_bare_under_snow(changed):
    assert changed["bare"] == {
        "snow dusk": [True], "night": [False], "storm": [False], "clear": [False],
    }  # fmt: skip


def ball(radius, steps=48, material="bitumen"):
    """A ball about the origin."""
    polar = np.linspace(0, pi, steps // 2 + 1)
    around = np.linspace(0, 2 * pi, steps, endpoint=False)
    points = [(sin(p) * cos(a), sin(p) * sin(a), cos(p)) for p in polar for a in around]
    faces = [
        (r * steps + c, (r + 1) * steps + c, (r + 1) * steps + (c + 1) % steps,
         r * steps + (c + 1) % steps)
        for r in range(steps // 2) for c in range(steps)
    ]  # fmt: skip
    uv = np.zeros((len(faces), 4, 2))
    return one_mesh(1, np.array(points) * radius, faces, materials=(material,), uv=uv,
                    tint=(0.06, 0.06, 0.06))  # fmt: skip


def snow_on_ball(folder, material):
    """What snow adds to a ball, (64, 64): its light, how far its surface faces up, what is ball."""
    city = replace(quarter(1), scene=Scene().with_mesh("ground", ball(2.0, material=material)))
    # So far off that the picture is as good as an orthographic one: two metres are 30 pixels.
    camera = Camera("side", (0.0, -120.0, 0.0), 0.0, 0.0, 2 * np.arctan(32 / 15 / 120), 64, 64)
    bare, snowed = (rendered(folder, city, light, camera)
                    for light in (replace(SNOWED, snow=0.0), SNOWED))  # fmt: skip
    row, column = np.indices((64, 64)) - 31.5
    inside = np.hypot(row, column) < 29
    # The white land around brightens what faces down; snow brightens much more.
    return np.clip(snowed - bare - 25.0, 0, None) * inside, -row / 30.0, inside


def test_snow_dusts_the_sides_of_a_hedge_less_than_its_top(tmp_path):
    gain, up, inside = snow_on_ball(tmp_path, "hedge")
    top, side = gain[inside & (up > 0.85)].mean(), gain[inside & (np.abs(up) < 0.3)].mean()
    assert top > 60
    assert 5 < side < 0.6 * top


def test_snow_lies_on_what_faces_up_alone(tmp_path):
    gain, up, inside = snow_on_ball(tmp_path, "bitumen")
    assert gain[inside & (up > 0.85)].mean() > 60
    assert gain[up > 0.5].sum() > 0.95 * gain.sum()


def test_no_snow_lies_under_a_roof(tmp_path):
    square = [(-30, -30, 0), (30, -30, 0), (30, 30, 0), (-30, 30, 0)]
    ground = one_mesh(1, square, [(0, 1, 2, 3)], materials=("paving",), tint=(0.2, 0.2, 0.2))
    roof = box(2, (-6, 0, 2.6), (6, 9, 2.8), materials=("bitumen",))
    city = replace(quarter(1), scene=Scene().with_mesh("ground", concatenate([ground, roof])))
    camera = Camera("eye", (0.0, -9.0, 1.6), 0.0, radians(-12), radians(50), 64, 64)
    bare, snowed = (rendered(tmp_path, city, light, camera)
                    for light in (replace(SNOWED, snow=0.0), SNOWED))  # fmt: skip
    gain = snowed - bare

    # Rows of the picture by the depression of the ground there: 5 m behind the roof's edge, and
    # 5 m before it.
    def row(distance):
        return round(
            31.5 + 32 / np.tan(radians(25)) * np.tan(np.arctan(1.6 / distance) - radians(12))
        )

    assert gain[row(4.0), 24:40].mean() > 50
    assert gain[row(14.0), 24:40].mean() < 25


def test_asphalt_alone_shows_its_use_in_few_places(tmp_path):
    square = [(-30, -30, 0), (30, -30, 0), (30, 30, 0), (-30, 30, 0)]
    camera = Camera("top", (0.0, 0.0, 40.0), 0.0, radians(-90), radians(60), 800, 800)
    dark = []
    for material in ("asphalt", "asphalt_red"):
        ground = one_mesh(1, square, [(0, 1, 2, 3)], materials=(material,),
                          uv=np.array(square, float)[None, :, :2])  # fmt: skip
        city = replace(quarter(1), scene=Scene().with_mesh("ground", ground))
        picture = rendered(tmp_path, city, Environment(cloud_cover=1.0), camera)
        dark.append((picture < 0.94 * np.median(picture)).mean())
    assert 0.001 < dark[0] < 0.1  # cracks, drips of oil and repairs
    assert dark[1] < 0.2 * dark[0]


def test_rain_is_seen_as_streaks(tmp_path):
    wall = box(2, (-30, 20, 0), (30, 21, 40), materials=("metal_dark",))
    city = replace(quarter(1), scene=Scene().with_mesh("ground", wall))
    camera = Camera("eye", (0.0, 0.0, 9.0), 0.0, 0.0, radians(60), 96, 96)
    dry = Environment(cloud_cover=1.0)
    before, after = (
        rendered(tmp_path, city, light, camera) for light in (dry, replace(dry, rain=10.0))
    )
    gain = after - before
    assert (gain > 8).mean() > 0.02
    # Streaks stand upright: the picture varies faster across than down.
    across, down = np.abs(np.diff(gain, axis=1)).mean(), np.abs(np.diff(gain, axis=0)).mean()
    assert across > 1.1 * down


def lamps(folder, moment):
    """Return the colours, 0 to 255, of the red and the green lamp at a moment."""
    pole = furniture("traffic_signal")
    at = Instances(
        prototype=np.zeros(1, np.int32), object_id=ONE, position=np.zeros((1, 3)),
        rotation=np.zeros((1, 3)), scale=np.ones((1, 3)), tint=np.ones((1, 3), np.float32),
        owner=np.zeros(1, np.uint64),
    )  # fmt: skip
    scene = Scene().with_instances("street_furniture", [pole], at)
    write_city(replace(quarter(1), scene=scene, signals=SIGNALS, moment=moment), folder / "city")
    run_worker(BlenderJob(folder / "city", None, (RenderRequest(BEFORE, folder / "p.png", 16),)))
    with Image.open(folder / "p.png") as picture:
        pixels = np.asarray(picture.convert("RGB"), float)
    per_metre = 32 / (2.88 * np.tan(np.radians(11)))  # at the lamps
    rows = (round(31.5 - dz * per_metre) for dz in (0.26, -0.35))
    return [pixels[row - 1 : row + 2, 30:34].mean(axis=(0, 1)) for row in rows]


@pytest.mark.parametrize(("moment", "lit", "dark"), [(5.0, 1, 0), (15.0, 0, 1)])
def test_the_light_burns_that_the_head_shows(tmp_path, moment, lit, dark):
    pair = lamps(tmp_path, moment)
    assert pair[lit].max() > 150
    assert pair[lit].max() > pair[dark].max() + 60
    assert pair[lit].argmax() == lit  # red, or green
