import numpy as np
import pytest
import shapely

from cityx.city.ground import KERB_HEIGHT, LABEL, WATER_LEVEL
from cityx.city.terrain import Terrain, flat_terrain
from cityx.ground.arrangement import arrange, regions
from cityx.ground.drape import drape
from cityx.ids import stable_id

SITE = (0.0, 0.0, 100.0, 80.0)
ROAD, WATER, HOUSE = LABEL["carriageway"], LABEL["water"], LABEL["building"]
YARD = LABEL["courtyard"]  # its sides are of another material than its top


def one_of(mesh, name):
    return mesh.take(np.flatnonzero(mesh.object_id == stable_id("ground", name)))


def normals(mesh):
    triangles, face = mesh.triangles()
    a, b, c = (mesh.vertices[triangles[:, k]] for k in range(3))
    return np.cross(b - a, c - a), face


def test_surfaces_lie_at_their_offsets():
    ground = arrange(regions([shapely.box(0, 30, 100, 40)], ROAD, 1, 7), SITE)
    mesh = drape(ground, flat_terrain())
    assert np.unique(one_of(mesh, "carriageway").vertices[:, 2]).tolist() == [0.0]
    assert np.unique(one_of(mesh, "block").vertices[:, 2]).tolist() == [0.0, KERB_HEIGHT]


def test_tops_look_up_and_kerbs_look_at_the_lower_side():
    ground = arrange(regions([shapely.box(0, 30, 100, 40)], ROAD, 1, 7), SITE, background=YARD)
    yard = one_of(drape(ground, flat_terrain()), "courtyard")
    normal, face = normals(yard)
    upright = yard.material[face] == 1
    assert (normal[~upright, 2] > 0).all()
    assert np.allclose(normal[upright, 2], 0.0)
    y = yard.vertices[yard.faces[face[upright], 0], 1]
    assert (np.sign(normal[upright, 1]) == np.where(y < 35, 1, -1)).all()


def test_area_of_the_kerb_is_its_height_times_its_length():
    ground = arrange(regions([shapely.box(20, 30, 40, 40)], ROAD, 1), SITE, background=YARD)
    yard = one_of(drape(ground, flat_terrain()), "courtyard")
    normal, face = normals(yard)
    area = np.linalg.norm(normal[yard.material[face] == 1], axis=1).sum() / 2
    assert area == pytest.approx(60 * KERB_HEIGHT)


def test_there_is_no_ground_inside_houses():
    ground = arrange(regions([shapely.box(20, 30, 40, 40)], HOUSE, 1), SITE)
    normal, _ = normals(drape(ground, flat_terrain()))
    assert normal[:, 2].sum() / 2 == pytest.approx(100 * 80 - 200)


def test_a_pond_on_a_slope_is_level():
    terrain = Terrain((0.0, 0.0), 100.0, np.array([[0.0, 2.0], [0.0, 2.0]]))
    ground = arrange(regions([shapely.box(40, 30, 60, 50)], WATER, 1, 3), SITE)
    water = one_of(drape(ground, terrain), "water")
    assert np.ptp(water.vertices[:, 2]) == 0.0
    assert water.vertices[0, 2] == pytest.approx(0.8 + WATER_LEVEL, abs=0.1)


def test_a_river_down_a_steep_slope_follows_it():
    terrain = Terrain((0.0, 0.0), 100.0, np.array([[0.0, 20.0], [0.0, 20.0]]))
    ground = arrange(regions([shapely.box(10, 30, 90, 50)], WATER, 1, 3), SITE)
    assert np.ptp(one_of(drape(ground, terrain), "water").vertices[:, 2]) == pytest.approx(16.0)
