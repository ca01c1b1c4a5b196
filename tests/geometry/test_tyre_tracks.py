import numpy as np

from cityx.city import RoadNetwork
from cityx.geometry.tyre_tracks import GAUGE, tyre_tracks, wheel_offsets

CELL = 0.14
SIZE = (428, 285)  # 60 m x 40 m


def tracks(network):
    return tyre_tracks(network, (0.0, 0.0), SIZE, CELL)


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
