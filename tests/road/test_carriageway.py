"""Surfaces of streets: how kerbs run where widths change and arms part."""

import numpy as np
import pytest
import shapely
import shapely.affinity

from cityx.geometry.polylines import SAGITTA
from cityx.road.network.network import road_network
from cityx.road.surface.carriageway import Unions, _closed, build_carriageway, joined_by
from cityx.road.surface.corners import NOSE_RADIUS


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


def test_arms_that_bend_away_leave_the_land_between_them(layout_of):
    # The two stubs leave to both sides and turn back; the third makes them a junction early.
    stub = {"kind": "service", "width": 3.0, "sidewalk_left": 0.0, "sidewalk_right": 0.0}
    stubs = [[(0, 0), (-9.4, 1.2), (-10.3, 8.5)], [(0, 0), (7.8, 2.8), (15, 13)],
             [(0, 0), (-8.3, -5.3)]]  # fmt: skip
    layout = layout_of([([(0, 0), (0, -80)], {}), *((line, stub) for line in stubs)])
    assert not driven(layout).contains(shapely.Point(-0.8, 4.0))


@pytest.mark.parametrize("radius", [3.0, 6.0, 12.0])
def test_chords_of_a_curve_stay_within_their_sagitta(radius):
    notch = shapely.Polygon([(0, 0), (60, 0), (60, 60), (30, 60), (30, 30), (0, 30)])
    closed = _closed(np.array([notch], object), np.array([radius]))[0]
    points = shapely.get_coordinates(closed)
    centre = np.array([30 - radius, 30 + radius])
    away = points - centre
    arc = points[
        (np.abs(np.hypot(*away.T) - radius) < 0.02) & (away[:, 0] >= 0) & (away[:, 1] <= 0)
    ]
    middles = (arc[1:] + arc[:-1]) / 2 - centre
    assert len(arc) > 8
    assert np.abs(np.hypot(*middles.T) - radius).max() < SAGITTA + 0.001


def test_unions_of_the_same_shapes_are_made_once():
    squares = shapely.box(*np.array([(n, 0, n + 1.5, 1) for n in range(5)], float).T)
    unions = Unions(squares)
    rows, group = np.array([3, 0, 1, 4, 1, 0]), np.array([7, 2, 2, 7, 9, 9])
    made, groups = unions.of(rows, group)
    plain, same = joined_by(squares[rows], group)
    assert groups.tolist() == same.tolist() == [2, 7, 9]
    assert shapely.equals(made, plain).all()
    assert made[0] is made[2]  # of the same two, in another order
    again, _ = unions.of(np.array([4, 3]), np.array([0, 0]))
    assert again[0] is made[1]
    none, nowhere = unions.of(np.zeros(0, np.int64), np.zeros(0, np.int64))
    assert len(none) == len(nowhere) == 0


def test_unions_are_of_wider_shapes_where_they_are_to_be():
    squares = shapely.box(np.array([0.0, 2.2]), 0.0, np.array([2.0, 4.2]), 1.0)
    (made,), _ = Unions(squares, 0.5).of(np.array([0, 1]), np.array([0, 0]))
    assert made.bounds == (-0.5, -0.5, 4.7, 1.5)
    assert made.area == pytest.approx(5.2 * 2.0)


@pytest.mark.parametrize("turned", [0.0, 90.0, 180.0, 270.0])
def test_a_street_that_leaves_the_site_askew_has_no_kerb_across_it(layout_of, turned):
    # The stub between the junction and the border is shorter than the junction is wide.
    lines = [[(0, 0), (95, 0)], [(95, 0), (60, -60)], [(95, 0), (100, 5)]]
    shapes = shapely.affinity.rotate(shapely.MultiLineString(lines), turned, origin=(0, 0)).geoms
    layout = layout_of([(list(line.coords), {}) for line in shapes])
    street = shapely.buffer(shapely.LineString([(95, 0), (110, 15)]), 2.9, cap_style="flat")
    inside = shapely.affinity.rotate(street, turned, origin=(0, 0)) & shapely.box(*layout.extent)
    assert shapely.difference(inside, driven(layout)).area < 0.01


def test_shapes_that_but_touch_are_joined_without_their_lines():
    touching = shapely.from_wkt(
        "GEOMETRYCOLLECTION (POLYGON ((0 0, 2 0, 2 2, 0 2, 0 0)), LINESTRING (5 0, 6 0))"
    )
    line = shapely.LineString([(0, 0), (1, 0)])
    found, groups = joined_by(
        np.array([touching, line, shapely.box(1, 0, 3, 2)], object), np.array([4, 7, 4])
    )
    assert groups.tolist() == [4, 7]
    assert shapely.area(found).tolist() == [6.0, 0.0]
