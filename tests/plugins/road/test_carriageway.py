"""Surfaces of streets: how kerbs run where widths change and arms part."""

import numpy as np
import pytest
import shapely

from cityx.plugins.road.carriageway import build_carriageway
from cityx.plugins.road.corners import NOSE_RADIUS
from cityx.plugins.road.network import road_network


def driven(layout):
    network = road_network(layout)
    road = build_carriageway(layout, network, np.ones(network.edge_count, bool))
    return shapely.union_all(road.driven)


def width_at(shape, x):
    return shapely.intersection(shape, shapely.LineString([(x, -50), (x, 50)])).length


def test_a_street_narrows_without_a_step(layout_of):
    shape = driven(layout_of([([(-90, 0), (0, 0)], {"width": 9.0}), ([(0, 0), (90, 0)], {})]))
    widths = [width_at(shape, x) for x in (-5.0, -0.1, 0.1, 4.0, 8.1)]
    assert widths == pytest.approx([9.0, 9.0, 9.0, 7.5, 6.0], abs=0.1)


def test_where_a_ramp_leaves_the_land_between_has_a_round_nose(layout_of):
    kind = {"kind": "motorway", "oneway": True}
    streets = [([(-90, 0), (0, 0), (90, 0)], kind), ([(0, 0), (90, 22)], kind)]
    land = shapely.difference(shapely.box(5, 0, 80, 20), driven(layout_of(streets)))
    (wedge,) = (part for part in shapely.get_parts(land) if part.covers(shapely.Point(70, 8)))
    opened = shapely.buffer(shapely.buffer(wedge, -0.95 * NOSE_RADIUS), 0.95 * NOSE_RADIUS)
    left = wedge.bounds[0]
    tip = shapely.intersection(wedge, shapely.box(left, 0, left + 3, 20))
    assert shapely.difference(tip, opened).area < 0.15
