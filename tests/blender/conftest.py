"""A made-up quarter: boxes on a plane, windows and lamps as instances."""

from __future__ import annotations

import importlib.util

import numpy as np
import pytest
import shapely

from cityx.city import (
    City,
    Frame,
    Instances,
    Layout,
    Prototype,
    RoadNetwork,
    Scene,
    concatenate,
    make_table,
    one_mesh,
)
from cityx.ids import stable_id, uniform

BOX = np.array([(x, y, z) for z in (0, 1) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))], float)
SIDES = np.array([(0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7), (4, 5, 6, 7)])


def box(object_id, low, high, *, material=0, materials=("plaster",), tint=(1.0, 1.0, 1.0)):
    """Make an open box with UV in metres."""
    size = np.subtract(high, low)
    uv = np.tile(np.array([(0, 0), (1, 0), (1, 1), (0, 1)], float), (5, 1, 1))
    uv[:4] *= np.array([size[0], size[2]])
    uv[4] *= size[:2]
    return one_mesh(
        object_id, BOX * size + low, SIDES, material=material, materials=materials, uv=uv, tint=tint
    )


def quarter(side=3, *, lod=2):
    """Make side x side buildings of 12 m along streets of 10 m, with windows and lamps."""
    ids = np.array([stable_id("test", i) for i in range(side * side)], np.uint64)
    heights = 9 + 12 * uniform(0, "height", ids)
    low = np.array([(i * 22.0, j * 22.0, 0.0) for i in range(side) for j in range(side)])
    names = ("plaster", "brick", "bitumen")
    shells = [
        box(
            int(i), p, p + np.array([12, 12, h]), material=[n % 2] * 4 + [2], materials=names,
            tint=[(0.7, 0.55, 0.4)] * 4 + [(0.3, 0.3, 0.3)],
        )
        for n, (i, p, h) in enumerate(zip(ids, low, heights, strict=True))
    ]  # fmt: skip
    far = side * 22.0
    corners = np.array(
        [(-40, -40, 0), (far + 40, -40, 0), (far + 40, far + 40, 0), (-40, far + 40, 0)]
    )
    ground = one_mesh(1, corners, [(0, 1, 2, 3)], materials=("asphalt",), uv=corners[None, :, :2])
    window = Prototype(
        "window_plain", "window",
        concatenate([box(1, (-0.6, -0.05, 0), (0.6, 0.05, 1.6), materials=("glass",))]),
    )  # fmt: skip
    post = Prototype(
        "lamp_post", "furniture",
        concatenate([box(1, (-0.08, -0.08, 0), (0.08, 0.08, 5), material=[0, 0, 0, 0, 1],
                         materials=("bark", "lamp_glow"))]),
    )  # fmt: skip
    spots = [
        p + np.array([2.0 + 3 * k, 0.0, 1.0 + 3 * f])
        for p in low
        for k in range(3)
        for f in range(2)
    ]
    scene = (
        Scene()
        .with_mesh("buildings", concatenate(shells))
        .with_mesh("ground", ground)
        .with_instances("windows", [window], rows("window", spots, np.repeat(ids, 6)))
        .with_instances("street_furniture", [post], rows("post", low - (3.0, 3.0, 0.0)))
    )
    outlines = [shapely.box(*p[:2], *(p[:2] + 12)) for p in low]
    table = make_table(
        "buildings", outlines, id=ids, height=heights, use=["yes"] * len(ids),
        name=["Town hall"] + [""] * (len(ids) - 1), source=[f"test/{i}" for i in range(len(ids))],
    )  # fmt: skip
    layout = Layout((-40.0, -40.0, far + 40, far + 40), buildings=table)
    return City("Quarter", Frame(52.5, 13.4), layout, lod=lod, scene=scene, network=streets(side))


def rows(name, spots, owner=None):
    """Place prototype 0 upright at each spot."""
    count = len(spots)
    return Instances(
        np.zeros(count, np.int32),
        np.array([stable_id(name, i) for i in range(count)], np.uint64),
        np.zeros(count, np.uint64) if owner is None else owner,
        np.array(spots, float),
        np.zeros((count, 3), np.float32),
        np.ones((count, 3), np.float32),
        np.ones((count, 3), np.float32),
    )


def streets(side):
    """Make the north-south streets between the buildings, one edge each."""
    x = [i * 22.0 - 5.0 for i in range(1, side)]
    far = side * 22.0
    points = np.array([(a, b) for a in x for b in (-10.0, far)]).reshape(-1, 2)
    count = len(x)
    return RoadNetwork(
        node_position=points,
        node_degree=np.ones(2 * count, np.int32),
        edge_nodes=np.arange(2 * count, dtype=np.int32).reshape(-1, 2),
        edge_road=np.zeros(count, np.int32),
        edge_id=np.array([stable_id("edge", i) for i in range(count)], np.uint64),
        point_start=np.arange(0, 2 * count + 1, 2, dtype=np.int64),
        points=points,
        half_width=np.full(count, 3.0),
        trim=np.zeros((count, 2)),
        crossing=np.zeros((count, 2), bool),
        left_hand=np.zeros(count, bool),
        z=np.zeros(len(points)),
        lift=np.zeros(len(points)),
    )


@pytest.fixture(scope="session")
def small_city():
    return quarter()


def pytest_collection_modifyitems(items):
    """Skip what needs Blender where its module is not installed."""
    if importlib.util.find_spec("bpy") is None:
        skip = pytest.mark.skip(reason="bpy is not installed")
        for item in items:
            if "blender" in item.keywords:
                item.add_marker(skip)
