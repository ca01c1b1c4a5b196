from dataclasses import replace

import numpy as np
import pytest
import shapely

from cityx.city.ground import LABEL
from cityx.city.terrain import Terrain, flat_terrain
from cityx.geometry.triangle_cells import cells_of_triangles, triangle_at
from cityx.ground.arrangement import arrange, join_regions, regions
from cityx.ground.drape import drape
from cityx.ground.standing import NOWHERE, find_by_ground, stand_on


@pytest.fixture(scope="module")
def slope():
    lawn = regions([shapely.box(2, 2, 8, 8)], LABEL["grass"], 12)
    house = regions([shapely.box(4, 4, 6, 6)], LABEL["building"], 60)
    terrain = Terrain((-5.0, -5.0), 20.0, np.array([[0.0, 2.0], [0.0, 2.0]]))
    return drape(arrange(join_regions([lawn, house]), (0.0, 0.0, 10.0, 10.0)), terrain)


def test_the_surface_and_height_under_a_point_are_those_of_the_mesh(slope):
    found = stand_on(slope, [[3.0, 3.0], [1.0, 9.0]])
    assert found.label.tolist() == [LABEL["grass"], LABEL["block"]]
    assert found.z == pytest.approx([0.8 + 0.12, 0.6 + 0.12], abs=1e-3)


def test_there_is_no_ground_under_houses_and_beyond_the_site(slope):
    found = stand_on(slope, [[5.0, 5.0], [20.0, 5.0]])
    assert found.label.tolist() == [NOWHERE, NOWHERE]
    assert np.isnan(found.z).all()


def test_triangles_are_found_far_from_the_points_that_ask():
    vertices = np.array([[0, 0], [1, 0], [0, 1], [1000, 1000], [1001, 1000], [1000, 1001.0]])
    triangles = np.array([[0, 1, 2], [3, 4, 5]], np.int32)
    spots = np.array([[0.2, 0.2], [1000.2, 1000.2], [500.0, 500.0]])
    assert triangle_at(spots, cells_of_triangles(vertices, triangles)).tolist() == [0, 1, -1]


def test_the_triangles_of_the_ground_find_the_same_faces_as_those_of_its_mesh():
    lawn = regions(shapely.box(2.0, 2.0, 8.0, 8.0), LABEL["grass"], 10)
    house = regions(shapely.box(4.0, 4.0, 6.0, 6.0), LABEL["building"], 20)
    ground = arrange(join_regions([lawn, house]), (0.0, 0.0, 10.0, 10.0))
    mesh = drape(ground, flat_terrain())
    side = np.linspace(-1.0, 11.0, 49)  # many lie on rims, where several faces hold them
    spots = np.stack(np.meshgrid(side, side), axis=2).reshape(-1, 2)
    find_by_ground(ground, mesh)
    found = stand_on(mesh, spots)
    alike = replace(mesh, vertices=mesh.vertices.copy())  # another mesh, looked up by itself
    wanted = stand_on(alike, spots)
    assert np.array_equal(found.face, wanted.face)
    assert np.array_equal(found.label, wanted.label)
    assert np.array_equal(found.z, wanted.z, equal_nan=True)
    assert (found.face >= 0).sum() > 1000
