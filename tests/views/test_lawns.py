from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
import shapely

from cityx.blender.lawns import REACH, grass_rows
from cityx.city.camera import Camera
from cityx.city.ground import LABEL
from cityx.city.scene import Scene
from cityx.city.terrain import flat_terrain
from cityx.ground.arrangement import arrange, join_regions, regions
from cityx.ground.drape import drape

EYE = Camera("eye", (0.0, -20.0, 1.8), 0.0, -0.1, np.radians(60), 64, 64)


@pytest.fixture(scope="module")
def view():
    """A lawn of 120 m with a path of 4 m straight ahead of the camera."""
    path = regions([shapely.box(-2, -60, 2, 60)], LABEL["path"], 40)
    lawn = regions([shapely.box(-60, -60, 60, 60)], LABEL["park"], 16)
    ground = arrange(join_regions([lawn, path]), (-60.0, -60.0, 60.0, 60.0))
    terrain = flat_terrain()
    scene = Scene().with_mesh("ground", drape(ground, terrain))
    return SimpleNamespace(scene=scene, seed=3, terrain=terrain, lod=2)


def test_grass_grows_on_the_lawn_before_the_camera_and_not_on_the_path(view):
    rows = grass_rows(view, EYE)
    x, y = rows.position[:, :2].T
    assert rows.count > 2000
    assert np.abs(x).min() >= 2.0
    assert np.hypot(x, y + 20).max() < REACH + 0.3
    ahead = np.hypot(x, y + 20) > 3.0
    assert (np.abs(np.arctan2(x, y + 20))[ahead] < np.radians(45)).all()


def test_grass_thins_with_distance(view):
    away = np.hypot(*(rows_xy(view, EYE) - [0.0, -20.0]).T)
    near = ((away > 4) & (away < 6)).sum() / (36 - 16)
    far = ((away > 30) & (away < 34)).sum() / (34**2 - 30**2)
    assert near > 5 * far > 0


def rows_xy(view, camera):
    return grass_rows(view, camera).position[:, :2]


def test_a_place_has_the_same_blades_for_every_camera(view):
    a = grass_rows(view, EYE)
    b = grass_rows(view, replace(EYE, position=(0.0, -18.0, 1.8)))
    shared = np.isin(a.object_id, b.object_id)
    assert shared.mean() > 0.5
    order = np.searchsorted(np.sort(b.object_id), a.object_id[shared])
    other = b.position[np.argsort(b.object_id)][order]
    assert np.array_equal(a.position[shared], other)


def test_from_high_above_no_blade_is_drawn(view):
    assert grass_rows(view, replace(EYE, position=(0.0, -20.0, 60.0))).count == 0
