import numpy as np
import shapely

from cityx.city import RoadNetwork, make_table
from cityx.city.lanes import MOVEMENTS
from cityx.city.layout import Layout
from cityx.ground.tyre_tracks import GAUGE, tyre_tracks, wheel_offsets
from cityx.road.network.lane_graph import lane_graph
from cityx.road.network.network import road_network

CELL = 0.14
SIZE = (428, 285)  # 60 m x 40 m


def tracks(network, lanes=None):
    return tyre_tracks(network, lanes, (0.0, 0.0), SIZE, CELL)


def street(half, *points):
    points = np.array(points, float)
    return RoadNetwork(
        node_position=points[[0, -1]], node_degree=np.ones(2, np.int32),
        edge_nodes=np.array([[0, 1]], np.int32), edge_road=np.zeros(1, np.int32),
        edge_id=np.ones(1, np.uint64), point_start=np.array([0, len(points)]), points=points,
        half_width=np.array([half]), trim=np.zeros((1, 2)), crossing=np.zeros((1, 2), bool),
        left_hand=np.zeros(1, bool), z=np.zeros(len(points)), lift=np.zeros(len(points)),
    )  # fmt: skip


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
