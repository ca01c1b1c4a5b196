"""Feathers that tell where bicycles ride, along roads and across junctions."""

import numpy as np
import pytest
import shapely

from cityx.city.frame import Frame
from cityx.city.ground import LABEL
from cityx.places.profiles import profile_of
from cityx.road.markings.symbols import FEATHER, feather
from cityx.road.network.network import road_network
from cityx.road.surface.street_surfaces import street_regions

TOKYO, LONDON = Frame(35.7, 139.8), Frame(51.5, -0.1)
ROAD = {"kind": "tertiary", "width": 8.0, "lane_width": 4.0}
ALONG, OVER, SIDE = [(-90, 0), (0, 0), (90, 0)], [(0, -90), (0, 0), (0, 90)], [(0, -90), (0, 0)]


def painted(layout, frame=TOKYO, *, left_hand=True):
    """Return feathers, and all other paint as one shape."""
    network = road_network(layout, left_hand=left_hand)
    found, _ = street_regions(layout, network, profile_of(frame).painting)
    white = found.polygons[found.label == LABEL["marking"]]
    return found.polygons[found.label == LABEL["feather"]], shapely.union_all(white)


def heading(shape):
    """Return the unit vector from the notch of a feather to its tip."""
    points = shapely.get_coordinates(shape)
    ahead = points[0] - points[3]
    return ahead / np.hypot(*ahead)


def test_a_feather_is_as_long_and_wide_as_the_guideline_says():
    low_x, low_y, high_x, high_y = feather().bounds
    assert (high_x - low_x, high_y - low_y) == pytest.approx(FEATHER[:2])
    assert heading(feather()) == pytest.approx((1.0, 0.0))


@pytest.mark.parametrize("left_hand", [True, False])
def test_feathers_lie_along_the_kerb_that_traffic_keeps_to_and_point_ahead(layout_of, left_hand):
    shapes, white = painted(layout_of([([(-90, 0), (90, 0)], ROAD)]), left_hand=left_hand)
    y = shapely.get_coordinates(shapely.centroid(shapes))[:, 1]
    ahead = np.array([heading(shape) for shape in shapes])
    assert len(shapes) > 20
    assert np.allclose(np.abs(ahead[:, 0]), 1.0)
    side = 1 if left_hand else -1
    assert (np.sign(y) == side * np.sign(ahead[:, 0])).all()
    assert np.allclose(4.0 - np.abs(y), 1.1, atol=0.15)  # metres from the kerb
    for row in (y > 0, y < 0):
        x, own = np.sort(shapely.get_coordinates(shapely.centroid(shapes[row]))[:, 0]), y[row][0]
        steps = np.diff(x) / 10.0
        assert np.allclose(steps, np.round(steps))
        # Only where a limit of speed is painted does one give way.
        absent = [
            (x[i] + 10.0 * k, own) for i in range(len(steps)) for k in range(1, round(steps[i]))
        ]
        assert len(absent) <= 2
        assert all(white.distance(shapely.Point(at)) < 1.0 for at in absent)
    assert shapely.distance(shapes, white).min() > 0.1


def test_a_bicycle_lies_behind_the_first_feather_of_a_lane(layout_of):
    layout = layout_of([([(-90, 0), (90, 0)], ROAD)])
    shapes, white = painted(layout)
    for side in (1.0, -1.0):
        row = shapes[shapely.get_coordinates(shapely.centroid(shapes))[:, 1] * side > 0]
        x = shapely.get_coordinates(shapely.centroid(row))[:, 0] * side
        first = row[np.argmin(x)]
        behind = shapely.box(-95 * side, side * 2.5, x.min() * side - side, side * 3.35)
        assert 0.15 < shapely.area(shapely.intersection(white, behind)) < 1.0
        assert not shapely.intersects(first, white)


def test_feathers_go_straight_on_past_a_side_street(layout_of):
    shapes, _ = painted(layout_of([(ALONG, ROAD), (SIDE, {})]))
    spots = shapely.get_coordinates(shapely.centroid(shapes))
    beside = spots[(np.abs(spots[:, 0]) < 7.0) & (spots[:, 1] < 0)]
    assert len(beside) >= 3
    assert np.ptp(beside[:, 1]) < 0.1
    assert np.ptp(np.diff(np.sort(beside[:, 0]))) < 2.0
    assert (np.abs(spots[:, 1]) < 4.0).all()  # none into the side street


def test_where_two_rows_cross_no_feather_lies_on_another(layout_of):
    shapes, white = painted(layout_of([(ALONG, ROAD), (OVER, ROAD)]))
    one, other = shapely.STRtree(shapes).query(shapes, predicate="intersects")
    assert (one == other).all()
    assert not shapely.intersects(shapes, white).any()
    ahead = np.abs([heading(shape) for shape in shapes])
    assert (ahead.max(axis=1) > 0.99).all()  # none turns
    middle = shapely.get_coordinates(shapely.centroid(shapes))
    assert (np.abs(middle).max(axis=1) < 4.0).sum() >= 4


@pytest.mark.parametrize(
    ("road", "frame"),
    [
        ({"kind": "residential"}, TOKYO),
        ({"kind": "motorway"}, TOKYO),
        ({"width": 11.0, "section": "cycle 1.5 - | drive 4 - | drive 4 + | cycle 1.5 +"}, TOKYO),
        ({"width": 5.0, "lane_width": 2.5}, TOKYO),
        ({}, LONDON),
    ],
)
def test_no_feathers_where_no_bicycle_shares_a_lane_with_room(layout_of, road, frame):
    shapes, _ = painted(layout_of([([(-90, 0), (90, 0)], ROAD | road)]), frame)
    assert len(shapes) == 0
