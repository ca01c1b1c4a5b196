"""A crossroads with houses, a lawn, a window, a car and a walker, to be pictured."""

from dataclasses import replace

import numpy as np
from crossing_town import crossing_town
from moving_city import CAR, MAN, moving

from cityx.city import Instances, concatenate, one_mesh
from cityx.city.camera import Camera
from cityx.city.scene import Prototype

EYE = Camera("eye", (-36.0, -1.5, 1.7), np.pi / 2, 0.0, width=48, height=32)
HOUSES = ((11, (-30.0, 8.0), (-12.0, 20.0)), (12, (-30.0, -20.0), (-12.0, -8.0)),
          (13, (14.0, -20.0), (30.0, -8.0)))  # fmt: skip
SIDES = np.array([(0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7), (4, 5, 6, 7)])


def block(object_id, low, high, material="plaster"):
    """Make an open box with UV in metres."""
    corners = np.array([(0, 0), (1, 0), (1, 1), (0, 1)], float)
    points = np.array([(x, y, z) for z in (0, 1) for x, y in corners])
    size = np.subtract(high, low)
    uv = np.tile(corners, (5, 1, 1)) * [size[0], size[2]]
    return one_mesh(object_id, points * size + low, SIDES, materials=(material,), uv=uv)


def dataset_town():
    """Return the place; its houses are 11, 12, 13, its windows 21, 22, its car 8, its walker 9."""
    city = crossing_town()
    houses = concatenate([block(i, (*a, 0.0), (*b, 9.0)) for i, a, b in HOUSES])
    pane = Prototype(
        "window_plain", "window", block(1, (-0.9, -0.05, 0), (0.9, 0.05, 1.6), "glass")
    )
    ones = np.ones((2, 3), np.float32)
    windows = Instances(
        np.zeros(2, np.int32), np.array([21, 22], np.uint64), np.full(2, 13, np.uint64),
        np.array([(14.0, -12.0, 1.5), (14.0, -16.0, 1.5)]),
        np.array([(0, 0, -np.pi / 2)] * 2, np.float32), ones, ones,
    )  # fmt: skip
    scene = city.scene.with_mesh("buildings", houses).with_instances("windows", [pane], windows)
    return replace(city, scene=scene, tracks=moving(CAR, MAN).tracks)
