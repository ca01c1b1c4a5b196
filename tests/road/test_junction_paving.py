"""Setts across the mouths of side streets, and coats amid crossroads."""

import numpy as np
import pytest
import shapely

from cityx.city.city import City
from cityx.city.frame import Frame
from cityx.city.ground import LABEL
from cityx.ground.walking.crosswalks import crosswalks_of
from cityx.places.profiles import profile_of
from cityx.road.ground.ground_surface import ground
from cityx.road.network.network import network, road_network
from cityx.road.surface.street_surfaces import street_regions

LONDON, TOKYO, BERLIN = Frame(51.5, -0.1), Frame(35.7, 139.8), Frame(52.5, 13.4)
MAIN = {"kind": "secondary", "width": 7.0, "lane_width": 3.5}
ALONG, SIDE = [(-90, 0), (0, 0), (90, 0)], [(0, -90), (0, 0)]
OVER = [(0, -90), (0, 0), (0, 90)]
HOUSES = [(x, y, x + 12, y + 12) for x in (-24, 12) for y in (-24, 12)]
TEE = [(ALONG, MAIN), (SIDE, {})]


def laid(layout, frame):
    """Return the streets' regions by name of surface, each as one shape."""
    found, _ = street_regions(layout, road_network(layout), profile_of(frame).painting)
    return {
        name: shapely.union_all(found.polygons[found.label == label])
        for name, label in LABEL.items()
        if (found.label == label).any()
    }


def test_setts_lead_walks_across_the_mouth_of_a_side_street(layout_of):
    layout = layout_of(TEE, houses=HOUSES)
    found = laid(layout, LONDON)
    setts = found["mouth_setts"]
    low_x, low_y, high_x, high_y = setts.bounds
    assert high_x == pytest.approx(-low_x, abs=0.1)
    assert high_x > 2.9  # from kerb to kerb
    assert high_y < -3.5  # not on the road that the street meets
    assert 2.0 < high_y - low_y < 5.0
    carriageway = shapely.union_all([found["carriageway"], found["junction"]])
    assert shapely.area(shapely.difference(setts, carriageway)) < 1e-6
    rows = shapely.intersection(found["threshold"], shapely.buffer(setts, 0.5))
    assert len(shapely.get_parts(rows)) == 2
    assert shapely.area(shapely.intersection(rows, setts)) < 1e-6


@pytest.mark.parametrize("frame", [LONDON, BERLIN])
def test_people_cross_a_mouth_where_its_kerbs_are_lowered(layout_of, frame):
    layout = layout_of(TEE, houses=HOUSES)
    city = ground(network(City("test", frame, layout, lod=2)))
    found = crosswalks_of(city.ground, layout, city.network)
    south = found.take(found.ends[:, :, 1].max(axis=1) < -3.0)
    assert south.count == 1
    lowered = city.ground.vertices[city.ground.triangles_of("kerb_dropped")].mean(axis=1)
    lowered = lowered[np.abs(lowered[:, 0]) < 8.0]
    for side in (-1.0, 1.0):
        beside = lowered[side * lowered[:, 0] > 0.0, 1]
        assert abs(south.ends.mean(axis=1)[0, 1] - (beside.min() + beside.max()) / 2) < 0.6


def test_who_gives_way_does_so_ahead_of_setts_and_reads_it_behind(layout_of):
    found = laid(layout_of(TEE, houses=HOUSES), LONDON)
    setts, white = found["mouth_setts"], found["marking"]
    lane = shapely.box(0.1, -40.0, 3.2, -3.6)
    marks = shapely.get_parts(shapely.intersection(white, lane))
    y = shapely.get_coordinates(shapely.centroid(marks))[:, 1]
    ahead, behind = y > setts.bounds[3], y < setts.bounds[1]
    assert ahead.sum() >= 3
    assert behind.sum() >= 1
    assert (ahead | behind).all()
    assert shapely.area(shapely.intersection(white, setts)) < 1e-6


@pytest.mark.parametrize("frame", [TOKYO, BERLIN])
def test_other_countries_lay_no_setts(layout_of, frame):
    assert "mouth_setts" not in laid(layout_of(TEE, houses=HOUSES), frame)


@pytest.mark.parametrize(
    ("streets", "options"),
    [
        (TEE, {}),  # open country
        ([(ALONG, MAIN), (OVER, MAIN)], {"houses": HOUSES}),  # equals
        ([(ALONG, MAIN), (SIDE, {"width": 10.0})], {"houses": HOUSES}),  # too wide
        (TEE, {"houses": HOUSES, "points": [((0, 0), "traffic_signals")]}),
    ],
)
def test_setts_lie_only_across_narrow_streets_in_town_that_end_at_a_greater_road(
    layout_of, streets, options
):
    assert "mouth_setts" not in laid(layout_of(streets, **options), LONDON)


def test_crossroads_of_minor_streets_are_coated_in_japan_alone(layout_of):
    layout = layout_of([(ALONG, {}), (OVER, {})], houses=HOUSES)
    found = laid(layout, TOKYO)
    coat = found["coat"]
    assert shapely.contains(coat, shapely.Point(0.0, 0.0))
    assert np.abs(coat.bounds).max() < 12.0
    assert 20.0 < coat.area < 140.0  # curves of the corners reach far into it
    paved = shapely.union_all([found["carriageway"], found["junction"]])
    assert shapely.area(shapely.difference(coat, paved)) < 1e-6
    for frame in (LONDON, BERLIN):
        assert "coat" not in laid(layout, frame)


@pytest.mark.parametrize(
    ("streets", "points"),
    [
        (TEE, []),
        ([(ALONG, MAIN), (OVER, {})], []),
        ([(ALONG, {}), (SIDE, {})], []),
        ([(ALONG, {}), (OVER, {})], [((0, 0), "traffic_signals")]),
    ],
)
def test_no_coat_lies_where_three_meet_a_road_is_greater_or_signals_rule(
    layout_of, streets, points
):
    assert "coat" not in laid(layout_of(streets, houses=HOUSES, points=points), TOKYO)


def test_lines_along_kerbs_end_at_setts(layout_of):
    layout = layout_of([(ALONG, MAIN), (SIDE, {"width": 5.5})], houses=HOUSES)
    found = laid(layout, LONDON)
    city = ground(network(City("test", LONDON, layout, lod=2)))
    yellow = city.ground.vertices[city.ground.triangles_of("marking_yellow")]
    shapes = shapely.union_all(shapely.polygons(yellow))
    assert shapely.area(shapely.intersection(shapes, found["mouth_setts"])) < 1e-6
    before = shapely.buffer(found["mouth_setts"], 1.0)
    assert shapely.area(shapely.intersection(shapes, before)) > 0.1
