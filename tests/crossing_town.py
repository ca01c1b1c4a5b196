"""A crossroads with walks, a plaza and two houses, made by code: a small place to walk in."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pandas as pd
import shapely

from cityx.city import City, Frame, Instances, Layout, make_table, one_mesh
from cityx.city.scene import Prototype
from cityx.road.ground.ground_surface import ground
from cityx.road.network.lane_graph import lanes
from cityx.road.network.network import network

HALF = 70.0  # metres from the middle to the border
ARMS = [[(-90, 0), (0, 0), (90, 0)], [(0, -90), (0, 0), (0, 90)]]
PLAZA = shapely.box(6.0, 6.0, 40.0, 40.0)
HOUSES = [shapely.box(-30, 8, -12, 20), shapely.box(-30, -20, -12, -8)]


def crossing_town(
    *, longitude: float = 13.0, walks: float = 2.5, plaza: bool = True, width: float = 6.0,
    oneway: bool = False, main: bool = False, footbridge: bool = False,
) -> City:  # fmt: skip
    """Lay out the place; at longitude 13 one keeps to the right, at -1 to the left.

    A main road goes straight on from west to east without houses beside it; so far out of town its
    kerbs are not lowered. A footbridge leads over the eastern arm.
    """
    count = 1 if oneway else 2
    lines, kinds = [shapely.LineString(arm) for arm in ARMS], ["residential"] * 2
    kinds[0] = "secondary" if main else kinds[0]
    roads = make_table(
        "roads", lines, id=[1, 2], kind=kinds, lanes=[count] * 2, lanes_forward=[1] * 2,
        lane_width=[3.0] * 2, width=[width] * 2, sidewalk_left=[walks] * 2,
        sidewalk_right=[walks] * 2, oneway=[oneway] * 2,
    )  # fmt: skip
    if footbridge:
        over = make_table("roads", [shapely.LineString([(40, -12), (40, 12)])], id=[3],
                          kind=["footway"], width=[2.0], bridge=[True], layer=[1])  # fmt: skip
        roads = pd.concat([roads, over], ignore_index=True)
    tables = {"roads": roads}
    if not main:
        tables["buildings"] = make_table(
            "buildings", HOUSES, id=[11, 12], use=["apartments", "retail"]
        )
        tables["parts"] = make_table(
            "parts", HOUSES, id=[21, 22], building=[11, 12], base=[0.0] * 2, top=[9.0] * 2,
            levels=[3] * 2, walls=[True] * 2,
        )  # fmt: skip
    if plaza:
        tables["areas"] = make_table("areas", [PLAZA], id=[7], kind=["pedestrian"])
    layout = Layout((-HALF, -HALF, HALF, HALF), **tables)
    city = City("crossing", Frame(52.0, longitude), layout, lod=2)
    return ground(lanes(network(city)))


def with_post(city: City, x: float, y: float, size: float = 0.6) -> City:
    """Put a square post of 1 m height on the ground."""
    h = size / 2
    corners = [(-h, -h), (h, -h), (h, h), (-h, h)]
    vertices = [(a, b, z) for z in (0.0, 0.5, 1.0) for a, b in corners]
    mesh = one_mesh(1, vertices, [[8, 9, 10, 11], [3, 2, 1, 0]])
    rows = Instances(
        np.zeros(1, np.int32), np.array([99], np.uint64), np.zeros(1, np.uint64),
        np.array([[x, y, 0.12]]), np.zeros((1, 3), np.float32), np.ones((1, 3), np.float32),
        np.ones((1, 3), np.float32),
    )  # fmt: skip
    post = Prototype("post", "furniture", mesh)
    return replace(city, scene=city.scene.with_instances("street_furniture", [post], rows))
