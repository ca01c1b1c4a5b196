"""Stones along the edges of lawns."""

from dataclasses import replace

import numpy as np
import pytest
import shapely

from cityx.city import make_table
from cityx.city.ground import KERB_HEIGHT
from cityx.nature.land.gardens import gardens
from cityx.nature.land.lawn_edges import (
    BROAD,
    HARD,
    HIGH,
    LAYER,
    LEAST,
    edging_lines,
    lawn_edges,
)
from cityx.road.ground.ground_surface import ground
from cityx.road.network.lane_graph import lanes

NONE = np.zeros(0, object)


@pytest.fixture(scope="module")
def town(crossroads):
    """Houses 20 m behind the streets of a town, with plots between."""
    walls = [shapely.box(x, y, x + 50, y + 50) for x in (-80, 30) for y in (-80, 30)]
    ids = np.arange(21, 25)
    houses = make_table("buildings", walls, id=ids, place=["core"] * 4)
    parts = make_table("parts", walls, id=ids, building=ids, base=[0.0] * 4, top=[9.0] * 4,
                       walls=[True] * 4)  # fmt: skip
    roads = crossroads.layout.roads.assign(sidewalk_left=2.0, sidewalk_right=2.0)
    layout = replace(crossroads.layout, roads=roads, buildings=houses, parts=parts,
                     areas=crossroads.layout.areas[:0], points=crossroads.layout.points[:0],
                     lines=crossroads.layout.lines[:0])  # fmt: skip
    city = replace(crossroads, layout=layout, stages_done=frozenset({"layout", "terrain"}))
    return ground(lanes(city))


def test_edges_have_the_lawn_on_their_left_and_paving_on_their_right(town):
    ends = edging_lines(town.ground)
    assert len(ends) > 10
    way = ends[:, 1] - ends[:, 0]
    left = np.column_stack([-way[:, 1], way[:, 0]]) / np.hypot(*way.T)[:, None]
    middle = ends.mean(axis=1)
    assert town.ground.on(middle + 0.01 * left, "grass", "bare").all()
    assert town.ground.on(middle - 0.01 * left, *HARD).all()


def test_stones_stand_over_the_paving_and_face_outwards(town):
    stones = lawn_edges(town, NONE)
    points = stones.vertices[stones.faces]  # (f, 4, 3)
    normal = np.cross(points[:, 1] - points[:, 0], points[:, 3] - points[:, 0])
    top = normal[:, 2] > 1e-9
    assert top.sum() == len(points) / 3
    assert np.allclose(points[top][..., 2], KERB_HEIGHT + HIGH, atol=0.01)
    length = shapely.length(shapely.linestrings(edging_lines(town.ground))).sum()
    assert np.linalg.norm(normal[top], axis=1).sum() == pytest.approx(BROAD * length)


def test_no_stone_lies_across_a_path(town):
    ends = edging_lines(town.ground)
    middle = ends[np.argmax(np.hypot(*(ends[:, 1] - ends[:, 0]).T))].mean(axis=0)
    path = shapely.buffer(shapely.Point(middle), 0.6)
    stones = lawn_edges(town, np.array([path], object))
    plan = shapely.polygons(stones.vertices[stones.faces[1::3]][..., :2])
    assert not shapely.intersects(plan, shapely.buffer(path, -LEAST)).any()
    assert stones.triangle_count > 0


def test_the_same_city_gets_the_same_stones_from_level_two_on(town):
    one, two = (gardens(town).scene.meshes[LAYER] for _ in range(2))
    assert one.vertices.tobytes() == two.vertices.tobytes()
    assert LAYER not in gardens(replace(town, lod=1)).scene.meshes
