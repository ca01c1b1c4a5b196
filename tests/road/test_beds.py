import numpy as np
import shapely

from cityx.city.ground import KERB_WIDTH, LABEL
from cityx.ground.arrangement import face_areas
from cityx.road.ground.beds import DEPTH, FROM_HOUSE, LENGTH, bed_slots
from cityx.road.ground.ground_surface import ground_of
from cityx.road.network.network import road_network

RING = [([(-60, -60), (60, -60), (60, 60), (-60, 60), (-60, -60)], {})]
HOUSES = [(-40, -44, 40, -30), (-40, 30, 40, 44), (-44, -20, -30, 20)]


def laid(layout):
    found = ground_of(layout)
    total = np.bincount(found.face_label, face_areas(found), minlength=len(LABEL))
    return found, total[LABEL["bed"]]


def test_beds_lie_behind_the_walks_of_open_yards(layout_of):
    layout = layout_of(RING, houses=HOUSES)
    found, area = laid(layout)
    assert area > 5 * LENGTH * DEPTH
    middle = found.vertices[found.triangles].mean(axis=1)
    bed = middle[found.face_label[found.triangle_face] == LABEL["bed"]]
    street = shapely.LineString(RING[0][0])
    gap = shapely.distance(shapely.points(bed), street)
    assert gap.min() > 3.0 + KERB_WIDTH + 2.0  # half the carriageway, the kerb and the walk


def test_beds_keep_off_houses_and_let_people_pass_between_them(layout_of):
    layout = layout_of(RING, houses=HOUSES)
    shapes = bed_slots(layout, road_network(layout)).shapes
    houses = shapely.union_all(layout.buildings.geometry.to_numpy())
    assert len(shapes) > 10
    assert shapely.distance(shapes, houses).min() >= FROM_HOUSE
    one, other = shapely.STRtree(shapes).query(shapes, predicate="dwithin", distance=1.0)
    assert (one == other).all()


def test_no_bed_lies_where_the_map_tells_what_is_there(layout_of):
    park = [((-58, -58, 58, 58), "park")]
    layout = layout_of(RING, houses=HOUSES, areas=park)
    middle = bed_slots(layout, road_network(layout)).middle
    assert len(middle)
    assert (np.abs(middle).max(axis=1) > 60).all()


def test_beds_depend_on_their_street_alone(layout_of):
    one = layout_of(RING, houses=HOUSES)
    other = layout_of(RING, houses=HOUSES[::-1])
    first, second = (bed_slots(each, road_network(each)) for each in (one, other))
    assert np.array_equal(first.id, second.id)
    assert np.array_equal(first.middle, second.middle)
