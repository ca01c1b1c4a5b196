from dataclasses import replace

import numpy as np
import pytest
import shapely

from cityx.city.ground import LABEL
from cityx.city.mesh import NO_VERTEX
from cityx.city.terrain import Terrain, flat_terrain
from cityx.geometry.triangle_cells import cells_of_triangles, triangle_at
from cityx.ground.arrangement import BEYOND, arrange, regions
from cityx.ground.standing import heights_on
from cityx.ground.surroundings import (
    FAR_TOLERANCE,
    LEVEL_REACH,
    OFFSET,
    OPEN,
    SOIL,
    surroundings,
)

SITE = (0.0, 0.0, 100.0, 80.0)


@pytest.fixture
def ground():
    return arrange(regions([shapely.box(0, 30, 100, 40)], LABEL["carriageway"], 1), SITE)


def hills():
    x = np.arange(-1500.0, 1601.0, 50.0)
    return Terrain((-1500.0, -1500.0), 50.0, 60 * np.sin(x / 300)[None] * np.cos(x / 200)[:, None])


def tops(mesh):
    triangles = mesh.faces[mesh.faces[:, 3] == NO_VERTEX, :3]
    return triangles, np.cross(*np.diff(mesh.vertices[triangles], axis=1).transpose(1, 0, 2))


@pytest.mark.parametrize("around", [None, hills()])
def test_the_land_beyond_shares_the_border(ground, around):
    terrain = flat_terrain() if around is None else around
    mesh, _ = surroundings(ground, terrain, around)
    border = ground.vertices[(ground.vertices % [100, 80] == 0).any(axis=1)]
    wanted = np.column_stack([border, np.round(terrain.height_at(border) + OFFSET, 4)])
    held = {tuple(point) for point in mesh.vertices.tolist()}
    assert {tuple(point) for point in wanted.tolist()} <= held


def test_level_land_reaches_far_and_looks_up(ground):
    mesh, tolerance = surroundings(ground, flat_terrain())
    assert tolerance == 0.0
    assert mesh.vertices[:, :2].max(axis=0).tolist() == [100 + LEVEL_REACH, 80 + LEVEL_REACH]
    _, normal = tops(mesh)
    assert (normal[:, 2] > 0).all()
    assert normal[:, 2].sum() / 2 == pytest.approx(3100 * 3080 - 8000)


def test_hills_keep_to_their_heights_and_leave_no_gap(ground):
    around = hills()
    mesh, tolerance = surroundings(ground, around, around)
    assert tolerance == FAR_TOLERANCE
    triangles, normal = tops(mesh)
    assert (normal[:, 2] > 0).all()
    assert normal[:, 2].sum() / 2 == pytest.approx(3100**2 - 8000, rel=1e-6)
    places = np.random.default_rng(3).uniform(-1500, 1600, (2000, 2))
    found = triangle_at(places, cells_of_triangles(mesh.vertices[:, :2], triangles))
    places, found = places[found >= 0], found[found >= 0]
    z = heights_on(mesh.vertices[triangles[found]], places) - OFFSET
    assert np.abs(z - around.height_at(places)).max() <= 2 * tolerance


def test_the_border_stands_on_soil_and_steep_land_is_green(ground):
    mesh, _ = surroundings(ground, hills(), hills())
    assert set(mesh.material[mesh.faces[:, 3] != NO_VERTEX]) == {SOIL}
    triangles, normal = tops(mesh)
    steep = np.hypot(*normal[:, :2].T) > 0.25 * normal[:, 2]
    assert steep.any()
    assert (mesh.material[: len(triangles)][steep] == OPEN).all()


def test_a_gap_inside_the_site_is_no_border(ground):
    inner = np.flatnonzero(ground.edge_faces[:, 1] != BEYOND)[:1]
    sides = ground.edge_faces.copy()
    sides[inner, 1] = BEYOND
    whole = surroundings(ground, hills(), hills())[0]
    torn = surroundings(replace(ground, edge_faces=sides), hills(), hills())[0]
    assert np.array_equal(whole.vertices, torn.vertices)
