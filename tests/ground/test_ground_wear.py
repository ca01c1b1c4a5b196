from dataclasses import replace

import numpy as np
import shapely

from cityx.city import RoadNetwork, make_table, one_mesh
from cityx.city.lanes import MOVEMENTS
from cityx.city.layout import Layout
from cityx.ground.ground_wear import (
    FORECOURT,
    GAUGE,
    NEUTRAL,
    REACH,
    ground_wear,
    tyre_tracks,
    wheel_offsets,
    yard_fields,
)
from cityx.ground.street_repairs import (
    OVER_KERB,
    PAVER,
    lane_seams,
    mouth_seams,
    street_repairs,
)
from cityx.road.network.lane_graph import lane_graph
from cityx.road.network.network import road_network

EXTENT = (0.0, 0.0, 600.0, 40.0)
CELL = 0.14
SIZE = (428, 285)  # 60 m x 40 m


def street(half, *points):
    points = np.array(points, float)
    return RoadNetwork(
        node_position=points[[0, -1]], node_degree=np.ones(2, np.int32),
        edge_nodes=np.array([[0, 1]], np.int32), edge_road=np.zeros(1, np.int32),
        edge_id=np.ones(1, np.uint64), point_start=np.array([0, len(points)]), points=points,
        half_width=np.array([half]), trim=np.zeros((1, 2)), crossing=np.zeros((1, 2), bool),
        left_hand=np.zeros(1, bool), z=np.zeros(len(points)), lift=np.zeros(len(points)),
    )  # fmt: skip


LONG = street(3.0, (5, 20), (595, 20))


def shell(angle):
    """A house of 20 x 8 m whose long wall runs at an angle."""
    box = np.array(
        [(x, y, z) for z in (0, 9) for x, y in ((0, 0), (20, 0), (20, 8), (0, 8))], float
    )
    cosine, sine = np.cos(angle), np.sin(angle)
    turned = box[:, :2] @ np.array([(cosine, sine), (-sine, cosine)])
    sides = [(0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)]
    return one_mesh(5, np.column_stack([turned, box[:, 2]]), sides, materials=("plaster",))


def test_repairs_lie_in_the_street_but_for_connections_of_houses():
    found = street_repairs(LONG)
    assert len(found.outline) > 20
    away = np.abs(found.outline[..., 1] - 20.0).max(axis=1)
    assert (away < 3.0 + OVER_KERB[1] + 1e-9).all()
    assert 0 < (away > 3.0).sum() < len(away) / 2
    assert shapely.is_valid(shapely.polygons(found.outline)).all()
    assert (np.abs(found.tone) <= 1).all()
    assert (found.tone < 0).mean() > 0.5


def test_repairs_depend_on_their_street_alone():
    other = replace(LONG, edge_id=np.array([7], np.uint64))
    assert np.array_equal(street_repairs(LONG).outline, street_repairs(LONG).outline)
    assert not np.array_equal(street_repairs(LONG).tone, street_repairs(other).tone)


def test_streets_wider_than_a_paver_have_joints_short_of_their_junctions():
    (seam,) = lane_seams(replace(LONG, trim=np.array([[9.0, 4.0]])))
    assert np.allclose(sorted(seam[[0, -1], 0]), [14.0, 591.0])
    assert np.allclose(seam[:, 1], 20.0)
    assert not lane_seams(street(PAVER / 2, (5, 20), (55, 20)))


def test_the_field_of_a_house_lies_square_to_it_and_holds_it():
    house = shell(0.4)
    (outline,), tone = yard_fields(house)
    field = shapely.Polygon(outline)
    assert field.contains(shapely.MultiPoint(house.vertices[:, :2]))
    side = outline[1] - outline[0]
    assert np.isclose(side @ (-np.sin(0.4), np.cos(0.4)), 0.0, atol=1e-9)
    assert 20 + 2 * REACH[0] <= np.hypot(*side) <= 20 + 2 * REACH[1]
    assert abs(tone[0]) <= 1


def test_the_picture_is_neutral_at_its_rim_and_coarser_on_a_large_site():
    picture, cell = ground_wear(LONG, shell(0.0), EXTENT)
    assert (picture[0, :, 0] == 0).all()
    assert (picture[:, -1, 1:] == NEUTRAL).all()
    assert picture[..., 0].any()
    assert (picture[..., 1] != NEUTRAL).any()
    assert (picture[..., 2] != NEUTRAL).any()
    assert cell < 0.2
    large, coarse = ground_wear(LONG, None, (0.0, 0.0, 9000.0, 40.0))
    assert large.shape[1] <= 4096
    assert coarse > 1.0
    assert (large[..., 2] == NEUTRAL).all()


def test_what_lies_before_houses_is_paved_with_the_street():
    picture, cell = ground_wear(LONG, shell(0.0), EXTENT)
    reach = 3.0 + FORECOURT - 2 * cell
    low, high = (int((20.0 + sign * reach) / cell) for sign in (-1, 1))
    across = picture[low:high, int(10.0 / cell) : int(580.0 / cell), 2]
    assert (across == NEUTRAL).all()


def test_junctions_have_joints_across_their_mouths():
    seams = mouth_seams(replace(LONG, trim=np.array([[9.0, 0.0]])))
    assert seams.shape == (1, 2, 2)
    assert np.allclose(seams[0, :, 0], 14.0)
    assert np.allclose(sorted(seams[0, :, 1]), [17.0, 23.0])


def test_junctions_are_repaired_too_and_ends_of_streets_are_not():
    joined = replace(LONG, node_degree=np.array([3, 1], np.int32), trim=np.array([[9.0, 9.0]]))
    ids = [np.array([n], np.uint64) for n in range(1, 40)]
    more = [street_repairs(replace(joined, edge_id=n)).outline for n in ids]
    most = [street_repairs(replace(LONG, edge_id=n)).outline for n in ids]
    added = [a[len(b) :] for a, b in zip(more, most, strict=True)]
    count = np.array([len(each) for each in added])
    assert set(count) == {0, 1, 2}
    assert 0.9 < count.mean() < 1.8
    places = np.concatenate(added)
    assert (places[..., 0].min(axis=1) < 5.0 + 9.0).all()  # all reach into the junction
    assert (np.abs(places[..., 1] - 20.0) < 3.0).all()


def tracks(network, lanes=None):
    return tyre_tracks(network, lanes, (0.0, 0.0), SIZE, CELL)


def test_each_lane_has_a_path_for_either_wheel():
    across = tracks(street(3.2, (5, 20), (55, 20)))[:, round(30 / CELL)] > 128
    edges = np.flatnonzero(np.diff(across.astype(int)) == 1) * CELL
    assert len(edges) == 4
    assert np.allclose(np.diff(edges)[[0, 2]], GAUGE, atol=2 * CELL)
    middle = np.flatnonzero(across).mean() * CELL
    assert abs(middle - 20.0) < 0.2


def test_a_lane_has_one_car_and_a_footway_none():
    assert len(wheel_offsets(1.8)) == 2
    assert len(wheel_offsets(6.3)) == 8
    assert not tracks(street(1.0, (5, 20), (55, 20))).any()


def test_paths_follow_a_bend_and_stay_inside_the_street():
    row, column = np.nonzero(tracks(street(3.0, (10, 5), (30, 5), (30, 35))) > 128)
    x, y = (column + 0.5) * CELL, (row + 0.5) * CELL
    off = np.minimum(np.where(x < 33, np.abs(y - 5), 99), np.where(y > 2, np.abs(x - 30), 99))
    assert off.max() < 3.4
    assert (y > 30).any()


def test_lanes_and_turns_are_worn_where_the_lane_graph_leads():
    ways = [[(-60, 0), (0, 0), (60, 0)], [(0, -60), (0, 0)]]
    roads = make_table(
        "roads", [shapely.LineString(way) for way in ways], id=[1, 2], kind=["residential"] * 2,
        lanes=[2] * 2, lanes_forward=[1] * 2, width=[6.0] * 2, surface=["asphalt"] * 2,
    )  # fmt: skip
    layout = Layout((-60.0, -60.0, 60.0, 60.0), roads=roads)
    network = road_network(layout)
    graph = lane_graph(layout, network)
    picture = tyre_tracks(network, graph, (-60.0, -60.0), (857, 857), CELL)

    def worn(x, y):
        return int(picture[round((y + 60) / CELL), round((x + 60) / CELL)])

    # The lane in the right half of the street, its wheels 1.5 m apart.
    assert min(worn(30, -1.5 + side * GAUGE / 2) for side in (-1, 1)) > 200
    assert worn(30, -1.5) < 60
    turn = next(
        graph.curve[graph.curve_start[row] : graph.curve_start[row + 1]]
        for row in np.flatnonzero(graph.movement == MOVEMENTS.index("right"))
    )
    ahead = turn[5] - turn[3]
    aside = np.array([-ahead[1], ahead[0]]) / np.hypot(*ahead) * GAUGE / 2
    assert 100 < worn(*(turn[4] - aside)) < 200
