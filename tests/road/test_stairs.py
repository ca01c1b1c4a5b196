import numpy as np
import pytest

from cityx.city.mesh_measures import check_closed
from cityx.city.terrain import Terrain, flat_terrain
from cityx.geometry.polylines import Polylines, arc_lengths
from cityx.road.ground.ground_surface import ground
from cityx.road.heights.stairs import FLIGHT, GOING, climbs_of, treads_of

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


def line(*points):
    points = np.array(points, float)
    return Polylines(points[:, :2], np.array([0, len(points)])), points[:, 2]


def test_a_line_over_a_crest_makes_two_climbs_that_go_up():
    lines, z = line((0, 0, 0), (5, 0, 2), (10, 0, 4), (15, 0, 1))
    climbs, high, owner = climbs_of(lines, z)
    assert climbs.count == 2
    assert owner.tolist() == [0, 0]
    assert high.tolist() == [0, 2, 4, 1, 4]
    assert climbs.points[climbs.start[1]].tolist() == [15, 0]


def test_what_hardly_climbs_has_no_steps():
    assert climbs_of(*line((0, 0, 0), (50, 0, 0.2)))[0].count == 0


@pytest.mark.parametrize("length", [4.0, 8.0, 20.0])
def test_steps_are_equal_and_lead_from_the_foot_to_the_top(length):
    lines, z = line((0, 0, 10), (length / 2, 0, 12), (length, 0, 13.2))
    treads = treads_of(*climbs_of(lines, z)[:2])
    assert len(treads.top) == 20
    assert np.allclose(np.diff(treads.top, prepend=10), 0.16)
    assert treads.top[-1] == pytest.approx(13.2)
    assert (treads.end > treads.begin).all()
    assert treads.begin[0] == 0.0
    assert treads.end[-1] == pytest.approx(length)
    assert np.allclose(treads.end[:-1], treads.begin[1:])


def test_a_long_climb_has_landings_between_flights():
    treads = treads_of(*climbs_of(*line((0, 0, 0), (24, 0, 6.4)))[:2])
    depth = treads.end - treads.begin
    landing = np.flatnonzero(depth > 2 * GOING)
    assert landing.tolist() == [FLIGHT - 1, 2 * FLIGHT - 1, len(depth) - 1]
    assert np.allclose(np.delete(depth, landing), GOING)


def test_treads_lie_on_the_slope_or_above_it():
    lines, z = line((0, 0, 0), (3, 4, 1.5), (9, 4, 3.6), (9, 16, 9))
    treads = treads_of(*climbs_of(lines, z)[:2])
    along = arc_lengths(lines)[0]
    assert (treads.top >= np.interp(treads.end, along, z) - 1e-9).all()
