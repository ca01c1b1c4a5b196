from dataclasses import replace

import numpy as np
import pytest

from cityx.city.frame import Frame
from cityx.city.layout import SCHEMA, make_table
from cityx.geometry.polylines import arc_lengths
from cityx.road.network.network import junction_clusters, network, road_network

WEST, EAST, NORTH, SOUTH = (-90, 0), (90, 0), (0, 90), (0, -90)
MIDDLE = (0, 0)


def lengths(network):
    return arc_lengths(network.lines)[1]


def test_a_side_street_splits_the_street_it_joins(layout_of):
    network = road_network(layout_of([([WEST, MIDDLE, EAST], {}), ([MIDDLE, NORTH], {})]))
    assert network.edge_count == 3
    assert sorted(network.node_degree.tolist()) == [1, 1, 1, 3]
    assert np.allclose(lengths(network), 90)


def test_a_bridge_passes_over_a_shared_coordinate(layout_of):
    over = {"bridge": True, "layer": 1}
    network = road_network(layout_of([([WEST, MIDDLE, EAST], {}), ([SOUTH, MIDDLE, NORTH], over)]))
    assert network.edge_count == 2
    assert network.node_degree.tolist() == [1, 1, 1, 1]


def test_a_bridge_joins_the_ground_at_its_ends(layout_of):
    over = {"bridge": True, "layer": 1}
    network = road_network(layout_of([([WEST, MIDDLE], {}), ([MIDDLE, EAST], over)]))
    assert sorted(network.node_degree.tolist()) == [1, 1, 2]


def test_a_bridge_that_ends_in_the_middle_of_a_street_joins_it(layout_of):
    over = {"bridge": True, "layer": 1}
    street = ([WEST, MIDDLE, EAST], {})
    network = road_network(layout_of([street, ([MIDDLE, NORTH], over)]))
    assert sorted(network.node_degree.tolist()) == [1, 1, 1, 3]


def test_a_bridge_of_two_ways_passes_over_a_shared_coordinate(layout_of):
    over = {"bridge": True, "layer": 1}
    street = ([WEST, MIDDLE, EAST], {})
    network = road_network(layout_of([street, ([SOUTH, MIDDLE], over), ([MIDDLE, NORTH], over)]))
    assert sorted(network.node_degree.tolist()) == [1, 1, 1, 1]


def test_ways_of_one_section_become_one_edge(layout_of):
    network = road_network(layout_of([([WEST, MIDDLE], {}), ([MIDDLE, EAST], {"name": "other"})]))
    assert network.edge_count == 1
    assert network.points.tolist() == [list(WEST), list(MIDDLE), list(EAST)]


def test_a_change_of_width_ends_an_edge(layout_of):
    network = road_network(layout_of([([WEST, MIDDLE], {}), ([MIDDLE, EAST], {"width": 9.0})]))
    assert network.half_width.tolist() == [3.0, 4.5]


@pytest.mark.parametrize("turned", [False, True])
def test_the_last_metres_before_a_junction_have_the_section_of_the_street_behind(layout_of, turned):
    near = [MIDDLE, (8, 0)][:: -1 if turned else 1]
    streets = [([WEST, MIDDLE], {}), ([SOUTH, MIDDLE, NORTH], {}),
               (near, {"width": 9.0}), ([(8, 0), EAST], {})]  # fmt: skip
    network = road_network(layout_of(streets))
    assert network.half_width.tolist() == [3.0] * 4
    assert sorted(lengths(network).tolist()) == [90.0] * 4


def test_a_short_one_way_piece_keeps_its_direction(layout_of):
    streets = [([WEST, MIDDLE], {}), ([MIDDLE, (8, 0)], {"oneway": True}), ([(8, 0), EAST], {})]
    assert road_network(layout_of(streets)).edge_count == 3


def test_garage_tunnels_footways_and_repeated_ways_are_left_out(layout_of):
    network = road_network(
        layout_of([
            ([WEST, EAST], {}), ([EAST, WEST], {}),
            ([SOUTH, NORTH], {"tunnel": True, "kind": "service"}),
            ([(1, 50), (80, 50)], {"kind": "footway"}),
        ])
    )  # fmt: skip
    assert network.edge_road.tolist() == [0]


def test_a_dead_end_shorter_than_three_metres_is_a_mistake(layout_of):
    network = road_network(layout_of([([WEST, MIDDLE, EAST], {}), ([MIDDLE, (0, 2)], {})]))
    assert network.edge_count == 1


def test_a_facade_narrows_the_carriageway_but_not_in_a_passage(layout_of):
    houses = [(-50, 2, 50, 20)]
    open_air = road_network(layout_of([([WEST, EAST], {})], houses=houses))
    assert open_air.half_width.tolist() == [pytest.approx(1.7)]
    passage = road_network(layout_of([([WEST, EAST], {"passage": True})], houses=houses))
    assert passage.half_width.tolist() == [3.0]


def test_trims_at_a_right_angle_are_half_a_width_and_the_fillet(layout_of):
    network = road_network(layout_of([([WEST, MIDDLE, EAST], {}), ([MIDDLE, NORTH], {})]))
    assert np.allclose(network.trim.max(axis=1), 3.0 + 4.0)
    assert np.allclose(network.trim.min(axis=1), 0.0)


def test_trims_of_acute_arms_end_somewhere(layout_of):
    network = road_network(
        layout_of([([WEST, MIDDLE, EAST], {}), ([MIDDLE, (90, 3)], {}), ([MIDDLE, SOUTH], {})])
    )
    assert network.trim.max() <= 25.0


def test_a_short_link_joins_two_junctions_to_one(layout_of):
    network = road_network(
        layout_of([
            ([WEST, MIDDLE, (4, 0), EAST], {}), ([MIDDLE, NORTH], {}), ([(4, 0), (4, -90)], {}),
        ])
    )  # fmt: skip
    short = np.argmin(lengths(network))
    a, b = network.edge_nodes[short]
    assert network.trim[short].sum() == pytest.approx(4.0)
    assert junction_clusters(network)[a] == junction_clusters(network)[b]


def test_a_mapped_crossing_near_the_junction_marks_the_end_of_its_arm(layout_of):
    streets = [([WEST, MIDDLE, (12, 0), EAST], {}), ([MIDDLE, NORTH], {})]
    network = road_network(layout_of(streets, points=[((12, 0), "crossing")]))
    assert network.crossing.sum() == 1


def test_the_order_of_ways_changes_nothing(layout_of):
    streets = [([WEST, MIDDLE, EAST], {}), ([MIDDLE, NORTH], {"width": 5.0}), ([SOUTH, MIDDLE], {})]
    layout = layout_of(streets)
    one = road_network(layout)
    turned = layout.roads.iloc[::-1]
    columns = {key: turned[key].to_numpy() for key in SCHEMA["roads"]}
    table = make_table("roads", turned.geometry.to_numpy(), **columns)
    other = road_network(replace(layout, roads=table))
    assert np.array_equal(one.edge_id, other.edge_id)
    assert np.array_equal(one.points, other.points)
    assert np.array_equal(one.trim, other.trim)


def test_a_layout_without_roads_has_a_network_without_edges(layout_of):
    network = road_network(layout_of([]))
    assert network.edge_count == 0
    assert network.point_start.tolist() == [0]


@pytest.mark.parametrize(
    ("frame", "asked", "left"),
    [(Frame(52.5, 13.4), "auto", False), (Frame(-33.9, 151.2), "auto", True),
     (Frame(52.5, 13.4), "left", True), (Frame(-33.9, 151.2), "right", False)],
)  # fmt: skip
def test_traffic_keeps_to_the_side_of_the_country_or_the_one_asked_for(
    layout_of, city_of, frame, asked, left
):
    city = replace(city_of(layout_of([([WEST, EAST], {})])), frame=frame)
    assert network(city, drive_on=asked).network.left_hand.tolist() == [left]
