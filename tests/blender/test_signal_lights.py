"""Lights of signals in pictures: they show what rules who moves at that moment."""

from dataclasses import replace

import numpy as np
import pytest
from conftest import quarter
from PIL import Image

from cityx.assets.furniture.street_furniture import furniture
from cityx.blender.client import BlenderJob, RenderRequest, run_worker
from cityx.city import Scene
from cityx.city.camera import Camera
from cityx.city.scene import Instances
from cityx.city.signals import STATE, Signals
from cityx.city.store import write_city

pytestmark = pytest.mark.blender
ONE = np.ones(1, np.uint64)
# One head, for who comes from the south: green for ten seconds, then red.
SIGNALS = Signals(
    head_id=ONE, lane=ONE, onto=2 * ONE, crossing=0 * ONE, position=np.array([(-3.0, -1.0, 0.0)]),
    heading=np.array([np.pi / 2]), cycle=np.array([20.0]), change_start=np.array([0, 2]),
    time=np.array([0.0, 10.0]), state=np.array([STATE["green"], STATE["red"]], np.uint8),
)  # fmt: skip
BEFORE = Camera("before", (0.0, -3.0, 2.775), 0.0, 0.0, np.radians(22), 64, 64)


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
