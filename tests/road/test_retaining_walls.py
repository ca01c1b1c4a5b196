import numpy as np
import pytest
import shapely

from cityx.checks.height_checks import check_heights
from cityx.city.mesh_measures import check_closed
from cityx.city.terrain import Terrain, flat_terrain
from cityx.geometry.polylines import to_linestrings
from cityx.ground.standing import stand_on
from cityx.road.ground.ground_surface import ground
from cityx.road.heights.retaining_walls import find_walls
from cityx.road.heights.way_heights import heights
from cityx.road.network.network import network

EAST_WEST = ([(-100, 0), (100, 0)], {})
EDGE = 3.0 + 2.5  # metres from the middle of the street to the edge of its strip


def hillside(steep):
    y = -160.0 + 10.0 * np.arange(33.0)
    return Terrain((-160.0, -160.0), 10.0, steep * np.tile(y[:, None], (1, 33)))


def built(city_of, layout, terrain):
    return ground(heights(network(city_of(layout, terrain=terrain, lod=2))))


@pytest.fixture
def walls_on(layout_of, city_of):
    def find(steep, **options):
        layout = layout_of([EAST_WEST], **options)
        city = heights(network(city_of(layout, terrain=hillside(steep), lod=2)))
        return find_walls(city.layout, city.network, city.terrain)

    return find


@pytest.mark.parametrize("steep", [0.0, 0.2, 0.35])
def test_where_soil_stands_there_is_no_wall(walls_on, steep):
    assert walls_on(steep).front.count == 0


def test_a_flat_site_has_no_walls(layout_of, city_of):
    city = network(city_of(layout_of([EAST_WEST])))
    assert find_walls(city.layout, city.network, flat_terrain()).front.count == 0


def test_a_steep_hillside_has_a_wall_above_the_street_and_one_below(walls_on):
    found = walls_on(0.8)
    middle = [line.centroid.y for line in to_linestrings(found.front)]
    assert sorted(np.round(middle, 1)) == [-EDGE, EDGE]
    step = found.land - found.road
    above = found.front.points[:, 1] > 0
    assert (step[above] > 2.0).all()
    assert (step[~above] < -2.0).all()


def test_the_road_lies_on_the_left_of_a_wall(walls_on):
    walls = to_linestrings(walls_on(0.8).front)
    assert len(walls)
    for line in walls:
        (x0, y0), (x1, y1) = line.coords[0], line.coords[-1]
        assert (x1 - x0) * (0 - y0) - (y1 - y0) * (0 - x0) > 0


def test_no_wall_stands_in_a_house_or_a_side_street(layout_of, city_of):
    side = ([(0, 0), (0, 100)], {})
    layout = layout_of([EAST_WEST, side], houses=[(-60, 4, -40, 14)])
    city = heights(network(city_of(layout, terrain=hillside(0.8), lod=2)))
    found = find_walls(city.layout, city.network, city.terrain)
    walls = shapely.union_all(to_linestrings(found.front))
    assert found.front.count
    assert walls.distance(shapely.box(-60, 4, -40, 14)) > 0.3
    assert walls.distance(shapely.LineString([(0, 4), (0, 100)])) > 3.0


def test_the_ground_steps_at_the_wall_which_is_a_closed_solid_clear_of_the_street(
    layout_of, city_of
):
    city = built(city_of, layout_of([EAST_WEST]), hillside(0.8))
    assert check_closed(city.scene.meshes["structures"]).all()
    values = {check.name: check.value for check in check_heights(city)}
    assert values["streets_blocked"] == 0
    x = np.zeros(2)
    before, behind = stand_on(
        city.scene.meshes["ground"], np.column_stack([x, [EDGE - 0.2, EDGE + 0.6]])
    ).z
    assert behind - before > 2.0
    level = stand_on(city.scene.meshes["ground"], np.column_stack([x, [3.6, EDGE - 0.2]])).z
    assert abs(level[0] - level[1]) < 0.3
