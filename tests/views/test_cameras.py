from dataclasses import replace
from math import degrees, pi
from types import MappingProxyType

import numpy as np
import pytest
import shapely

from cityx.city import (
    Environment,
    Frame,
    Instances,
    RoadNetwork,
    Scene,
    concatenate,
    flat_terrain,
    one_mesh,
)
from cityx.city.store import View
from cityx.views.cameras import CHOOSERS, aerial_camera, street_camera, top_camera

SIDES = [(0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7), (4, 5, 6, 7)]


def house(number, x, y, size=12.0, height=15.0):
    foot = [(x, y), (x + size, y), (x + size, y + size), (x, y + size)]
    return one_mesh(number, [(*p, z) for z in (0.0, height) for p in foot], SIDES)


def network(*lines):
    points = np.array([p for line in lines for p in line], float)
    count = len(lines)
    return RoadNetwork(
        points,
        np.ones(len(points), np.int32),
        np.arange(2 * count, dtype=np.int32).reshape(-1, 2),
        np.zeros(count, np.int32),
        np.arange(1, count + 1, dtype=np.uint64),
        np.cumsum([0] + [len(line) for line in lines]),
        points,
        np.full(count, 4.0),
        np.zeros((count, 2)),
        np.zeros((count, 2), bool),
        np.zeros(count, bool),
        np.zeros(len(points)),
        np.zeros(len(points)),
    )


def town(houses, roads=None, trees=()):
    scene = Scene(MappingProxyType({"buildings": concatenate(houses)} if houses else {}))
    if len(trees):
        count = len(trees)
        rows = Instances(
            np.zeros(count, np.int32),
            np.arange(1, count + 1, dtype=np.uint64),
            np.zeros(count, np.uint64),
            np.array(trees, float),
            *(np.zeros((count, 3), np.float32) for _ in range(3)),
        )
        scene = replace(scene, instances=MappingProxyType({"trees": rows}))
    extent = (-300.0, -300.0, 300.0, 300.0)
    empty = Environment()
    return View(
        "T", Frame(0, 0), extent, 0, 2, scene, empty, roads, None, flat_terrain(), None, None, 0.0,
        (), {},
    )  # fmt: skip


@pytest.fixture
def lined():
    """Two streets: the northward one at x = 0 has houses, the eastward one has none."""
    houses = [house(10 + 2 * k, -22.0, -200 + 13.0 * k) for k in range(28)]
    houses += [house(11 + 2 * k, 10.0, -200 + 13.0 * k) for k in range(28)]
    return town(houses, network([(0, -280), (0, 280)], [(-280, -250), (280, -250)]))


def test_the_street_camera_looks_along_the_lined_street(lined):
    camera = street_camera(lined)
    x, y, z = camera.position
    assert abs(x) < 4.0
    assert -200 < y < 170
    assert z == pytest.approx(1.7)
    assert min(degrees(camera.heading) % 180, 180 - degrees(camera.heading) % 180) < 8


def test_the_street_camera_keeps_clear_of_trees(lined):
    plain = street_camera(lined)
    view = town([], lined.network, [(*plain.position[:2], 0.0)])
    view = replace(view, scene=replace(lined.scene, instances=view.scene.instances))
    moved = street_camera(view)
    assert np.hypot(*np.subtract(moved.position[:2], plain.position[:2])) > 3.0


def test_the_street_camera_is_outside_of_every_building(lined):
    batch = lined.scene.meshes["buildings"]
    corners = batch.vertices.reshape(-1, 8, 3)
    boxes = shapely.box(*corners[:, 0, :2].T, *corners[:, 2, :2].T)
    for view in (lined, replace(lined, network=None)):
        eye = shapely.Point(street_camera(view).position[:2])
        assert shapely.distance(boxes, eye).min() > 1.0


def test_the_choice_does_not_depend_on_the_order_of_edges(lined):
    flipped = network([(-280, -250), (280, -250)], [(0, -280), (0, 280)])
    flipped = replace(flipped, edge_id=flipped.edge_id[::-1].copy())
    assert street_camera(replace(lined, network=flipped)) == street_camera(lined)


def test_the_aerial_camera_looks_at_the_densest_part():
    crowd = [house(i, 150 + 14 * (i % 5), 150 + 14 * (i // 5)) for i in range(25)]
    camera = aerial_camera(town([house(99, -250, -250), *crowd]))
    way = np.array([np.sin(camera.heading), np.cos(camera.heading)])
    level = way * (camera.position[2] - 7.5) / np.tan(-camera.pitch)
    hit = np.array(camera.position[:2]) + level
    assert np.hypot(*(hit - (185, 185))) < 60


def test_the_top_camera_sees_the_whole_site_with_north_up(lined):
    camera = top_camera(lined, width=400, height=200)
    assert (camera.heading, camera.pitch) == (0.0, -pi / 2)
    assert 2 * camera.position[2] * np.tan(camera.hfov / 2) == pytest.approx(1200)


@pytest.mark.parametrize("name", sorted(CHOOSERS))
def test_an_empty_site_still_has_cameras(name):
    camera = CHOOSERS[name](town([]), width=32, height=32)
    assert np.isfinite([*camera.position, camera.heading, camera.pitch]).all()
    assert camera.width == 32
