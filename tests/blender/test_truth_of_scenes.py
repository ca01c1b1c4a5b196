"""Truth and Blender's scene hold the same surfaces in the same places."""

import json
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from made_view import shot
from moving_city import BIKE, CAR, MAN, moving

from cityx.city.camera import rays
from cityx.city.store import read_view, write_city
from cityx.dataset.stage import stage_of

pytestmark = [pytest.mark.blender, pytest.mark.slow]
CLOSE = 2e-3  # metres; Blender's rays are float32


def both(city, shots, folder, *, every, snow=0.0, moment=0.0):
    """Distances along the rays of every so many pixels, of our rays and of Blender's."""
    view = read_view(city)
    view = replace(view, environment=replace(view.environment, snow=snow))
    ahead = [rays(one.camera).reshape(-1, 3)[::every] for one in shots]
    eyes = np.repeat([one.camera.position for one in shots], [len(a) for a in ahead], axis=0)
    directions = np.concatenate(ahead)
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    ours = stage_of(view, moment).cast(eyes, directions).distance
    job = folder / "job.json"
    pairs = np.stack([eyes, directions], axis=1).tolist()
    job.write_text(json.dumps({"city": str(city), "snow": snow, "moment": moment, "rays": pairs}))
    script = Path(__file__).with_name("inspect_rays.py")
    done = subprocess.run([sys.executable, script, job], capture_output=True, text=True, check=True)
    line = next(line for line in done.stdout.splitlines() if line.startswith("@["))
    theirs = np.array([np.inf if d is None else d for d in json.loads(line[1:])])
    both_miss = np.isinf(ours) & np.isinf(theirs)
    with np.errstate(invalid="ignore"):
        alike = both_miss | (np.abs(ours - theirs) < CLOSE + 1e-5 * theirs)
    return ours, alike


def test_rays_end_where_blenders_do_in_a_town(scene_folder, tmp_path):
    places = [((0.0, 0.0, 2.0), 0.4, 0.0), ((-30.0, 20.0, 2.0), 2.0, 0.1),
              ((0.0, -60.0, 60.0), 0.0, -0.6)]  # fmt: skip
    shots = [shot(*place, width=320, height=240) for place in places]
    ours, alike = both(scene_folder("grid_s") / "city", shots, tmp_path, every=331)
    assert np.isfinite(ours).mean() > 0.3
    assert alike.mean() > 0.995  # the rest pass an edge by a hair


def test_rays_end_where_blenders_do_on_what_moves(tmp_path):
    write_city(moving(CAR, MAN, BIKE), tmp_path / "city")
    shots = [shot((2.0, -6.0, 1.4), width=320, height=240)]
    ours, alike = both(tmp_path / "city", shots, tmp_path, every=37, moment=1.3)
    assert np.isfinite(ours).sum() > 100
    assert alike.mean() > 0.99


def test_under_snow_both_see_through_bare_trees(scene_folder, tmp_path):
    folder = scene_folder("park_s") / "city"
    x, y, z = (read_view(folder).scene.instances["trees"].position[0] + [0, -12.0, 1.7]).tolist()
    shots = [shot((x, y, z), 0.0, 0.3, width=320, height=240)]
    met = {}
    for snow in (0.0, 0.8):
        ours, alike = both(folder, shots, tmp_path, every=97, snow=snow)
        assert alike.mean() > 0.97
        met[snow] = np.isfinite(ours).sum()
    assert met[0.8] < met[0.0]
