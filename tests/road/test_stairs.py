import numpy as np
import pytest

from cityx.city.mesh_measures import check_closed
from cityx.city.terrain import Terrain, flat_terrain
from cityx.road.ground.ground_surface import ground

STEPS = {"kind": "steps", "width": 2.0, "sidewalk_left": 0.0, "sidewalk_right": 0.0}
LINE = [(-10, 30), (10, 30)]


def stairs_of(layout_of, city_of, terrain, lod=2, options=STEPS):
    layout = layout_of([([(-90, 0), (90, 0)], {}), (LINE, options)])
    return ground(city_of(layout, lod=lod, terrain=terrain)).scene.meshes.get("stairs")


@pytest.fixture
def hill():
    slope = 0.3 * np.arange(-200.0, 201.0, 10.0)[None, :] * np.ones((41, 1))
    return Terrain((-200.0, -200.0), 10.0, slope)


def test_steps_on_a_slope_are_stairs(layout_of, city_of, hill):
    stairs = stairs_of(layout_of, city_of, hill)
    assert check_closed(stairs).all()
    assert len(np.unique(stairs.object_id)) == stairs.count
    tops = np.unique(stairs.vertices[:, 2].round(3))
    assert stairs.count >= 30
    assert tops.max() - tops.min() > 6.0
    again = stairs_of(layout_of, city_of, hill)
    assert again.vertices.tobytes() == stairs.vertices.tobytes()


@pytest.mark.parametrize("lod", [0, 1])
def test_coarse_cities_have_no_stairs(layout_of, city_of, hill, lod):
    assert stairs_of(layout_of, city_of, hill, lod=lod) is None


def test_level_steps_and_footways_are_no_stairs(layout_of, city_of, hill):
    assert stairs_of(layout_of, city_of, flat_terrain()) is None
    assert stairs_of(layout_of, city_of, hill, options=STEPS | {"kind": "footway"}) is None
