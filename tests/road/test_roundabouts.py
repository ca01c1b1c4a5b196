import numpy as np
import pytest
import shapely

from cityx.checks.junction_checks import check_junctions
from cityx.city.ground import LABEL
from cityx.city.lanes import MOVEMENTS
from cityx.geometry.polylines import SAGITTA
from cityx.ground.arrangement import check_arrangement, face_areas
from cityx.road.ground.ground_surface import ground, ground_of
from cityx.road.network.lane_graph import lane_graph, lanes
from cityx.road.network.network import network, road_network
from cityx.road.surface.roundabouts import rings_of, round_rings

ANGLES = np.arange(0, 8) * np.pi / 4
RING = [(12 * np.cos(a), 12 * np.sin(a)) for a in ANGLES]
ONEWAY = {"oneway": True, "roundabout": True, "lanes": 1, "sidewalk_left": 0.0}
ARMS = [([RING[2 * k], (90 * np.cos(a), 90 * np.sin(a))], {"width": 7.0})
        for k, a in enumerate(ANGLES[::2])]  # fmt: skip
ROUNDABOUT = [([*RING, RING[0]], ONEWAY), *ARMS]


def areas(found):
    total = np.bincount(found.face_label, face_areas(found), minlength=len(LABEL))
    return {name: total[label] for name, label in LABEL.items()}


def test_a_ring_drawn_with_corners_becomes_round_through_its_points():
    line = shapely.LineString([*RING, RING[0]])
    drawn = round_rings(np.array([line], object), np.array([True]))[0]
    points = shapely.get_coordinates(drawn)
    assert np.hypot(*points.T) == pytest.approx(12.0, abs=0.03)
    assert len(points) > 4 * len(RING)
    places = {tuple(p) for p in np.round(points, 3).tolist()}
    assert {tuple(p) for p in np.round(RING, 3).tolist()} <= places


def test_an_open_piece_of_a_ring_is_round_as_well():
    drawn = round_rings(np.array([shapely.LineString(RING[:4])], object), np.array([True]))[0]
    assert np.hypot(*shapely.get_coordinates(drawn).T) == pytest.approx(12.0, abs=0.03)


def test_the_middle_is_an_island_with_apron_kerb_and_lawn(layout_of):
    found = ground_of(layout_of(ROUNDABOUT))
    assert check_arrangement(found) == (0, 0, 0.0)
    area = areas(found)
    inner = 12.0 - 3.0
    assert area["apron"] == pytest.approx(np.pi * (inner**2 - (inner - 1.5) ** 2), rel=0.03)
    assert area["grass"] == pytest.approx(np.pi * (inner - 1.65) ** 2, rel=0.03)


def test_a_tiny_ring_is_narrowed_until_an_island_fits(layout_of):
    small = [(4 * np.cos(a), 4 * np.sin(a)) for a in ANGLES]
    streets = [([*small, small[0]], ONEWAY), ([small[0], (90, 0)], {}), ([small[4], (-90, 0)], {}),
               ([small[2], (0, 90)], {})]  # fmt: skip
    found = ground_of(layout_of(streets))
    assert areas(found)["courtyard"] > 3.0
    ring = rings_of(np.array([shapely.LineString([*small, small[0]])], object))
    assert ring.radius == pytest.approx([4.0], rel=0.06)


@pytest.mark.parametrize("left_hand", [False, True])
def test_traffic_runs_round_the_island_in_the_sense_of_the_country(layout_of, left_hand):
    ring = RING[::-1] if left_hand else RING
    streets = [([*ring, ring[0]], ONEWAY), *ARMS]
    layout = layout_of(streets)
    found = road_network(layout, left_hand=left_hand)
    graph = lane_graph(layout, found)
    on_ring = layout.roads["roundabout"].to_numpy()[found.edge_road[graph.edge]]
    for lane in np.flatnonzero(on_ring & graph.travelled):
        points = graph.lane_points(lane)
        turn = np.cross(points[0], points[-1])
        assert (turn < 0) == left_hand
    # From every arm traffic gets onto the ring, and from the ring onto every arm.
    pairs = on_ring[graph.connection]
    assert (~pairs[:, 0] & pairs[:, 1]).sum() == 4
    assert (pairs[:, 0] & ~pairs[:, 1]).sum() == 4
    assert not (graph.movement[pairs.all(axis=1)] == MOVEMENTS.index("reverse")).any()


def test_zebras_stand_back_from_the_ring_and_traffic_gives_way_at_it(layout_of, city_of):
    houses = [(x, y, x + 30, y + 30) for x in (-60, 30) for y in (-60, 30)]
    points = [((30, 1), "crossing")]
    layout = layout_of(ROUNDABOUT, houses=houses, points=points)
    city = ground(lanes(network(city_of(layout))))
    marks = city.ground.face_label == LABEL["marking"]
    middle = city.ground.vertices[city.ground.triangles].mean(axis=1)[
        marks[city.ground.triangle_face]
    ]
    trim = city.network.trim[
        city.layout.roads["roundabout"].to_numpy()[city.network.edge_road] == 0
    ]
    near = np.abs(middle[:, 1]) < 3.4
    east = middle[near & (middle[:, 0] > 0)]
    yield_line = east[east[:, 0] < 12.0 + trim.max() + 1.5]
    assert len(yield_line)


def test_a_turning_circle_widens_the_end_of_a_street(layout_of):
    street = [([(-90, 0), (0, 0)], {})]
    plain = areas(ground_of(layout_of(street)))["carriageway"]
    round_end = areas(ground_of(layout_of(street, points=[((0, 0), "turning_circle")])))
    disc = np.pi * 6.5**2
    # Half of the disc lies beyond the end, and what is wider than the street before it.
    assert plain + disc / 2 < round_end["carriageway"] < plain + disc


def test_a_mini_roundabout_is_a_painted_disc(layout_of):
    cross = [([(-90, 0), (0, 0), (90, 0)], {}), ([(0, -90), (0, 0), (0, 90)], {})]
    found = ground_of(layout_of(cross, points=[((0, 0), "mini_roundabout")]))
    painted = found.face_label[found.triangle_face] == LABEL["marking"]
    middle = found.vertices[found.triangles[painted]].mean(axis=1)
    assert (np.hypot(*middle.T) < 2.0).any()
    assert areas(found)["marking"] > np.pi * 2.0**2 * 0.9


def test_a_splitter_lies_between_the_lanes_beside_parked_cars(layout_of, city_of):
    parked = {"width": 8.1, "parking_left": True, "parking_right": False}
    layout = layout_of([ROUNDABOUT[0], *((line, parked) for line, _ in ARMS)])
    city = ground(lanes(network(city_of(layout))))
    over = {check.name: check.value for check in check_junctions(city)}["sidewalk_on_carriageway"]
    assert over == 0.0
    assert areas(city.ground)["courtyard"] > 4 * 3.0


def test_no_chord_of_a_ring_leaves_its_circle_by_more_than_its_sagitta():
    twelve = np.arange(12) * np.pi / 6
    for radius in (8.0, 15.0, 30.0):
        ring = [(radius * np.cos(a), radius * np.sin(a)) for a in twelve]
        line = shapely.LineString([*ring, ring[0]])
        drawn = round_rings(np.array([line], object), np.array([True]))[0]
        points = shapely.get_coordinates(drawn)
        middles = (points[1:] + points[:-1]) / 2
        assert np.hypot(*middles.T).min() > radius - SAGITTA - 0.001


def test_an_island_lies_between_the_one_way_halves_of_an_arm(layout_of):
    """A street parts 18 m before the ring into a way in and a way out."""
    half = {"oneway": True, "lanes": 1, "width": 3.5}
    ring = [(12 * np.cos(a), 12 * np.sin(a)) for a in np.arange(16) * np.pi / 8]
    fork, way_in, way_out = (30.0, 0.0), ring[15], ring[1]
    streets = [
        ([*ring, ring[0]], ONEWAY), ([(90, 0), fork], {"width": 7.0}),
        ([fork, way_in], half), ([way_out, fork], half), ([ring[8], (-90, 0)], {}),
    ]  # fmt: skip
    found = ground_of(layout_of(streets))
    between = shapely.Polygon([fork, way_in, way_out])
    floor = shapely.polygons(found.vertices[found.triangles_of("courtyard")])
    island = shapely.intersection(shapely.union_all(floor), between)
    assert island.area > 2.0
    for line in ((fork, way_in), (way_out, fork)):
        assert shapely.distance(island, shapely.LineString(line)) > 3.5 / 2 + 0.3
    assert check_arrangement(found) == (0, 0, 0.0)
