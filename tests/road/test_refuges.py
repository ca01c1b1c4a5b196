"""Refuges in crossings, ways through medians, and kerbs dropped at drives."""

import numpy as np
import pytest
import shapely

from cityx.checks.junction_checks import check_junctions
from cityx.city.ground import DROPPED, KERB_HEIGHT, LABEL
from cityx.ground.arrangement import check_arrangement
from cityx.ground.drape import RAMP_SLOPE, ramp_heights
from cityx.road.ground.ground_surface import ground
from cityx.road.network.lane_graph import lanes
from cityx.road.network.network import network

WIDE = {"kind": "secondary", "width": 9.0, "lane_width": 4.5}
ONE = {"oneway": True, "name": "Allee", "lanes": 2}


def built(layout, city_of):
    return ground(lanes(network(city_of(layout, lod=2))))


def shape_of(city, *names):
    found = city.ground
    rows = found.labelled(*names)[found.triangle_face]
    return shapely.union_all(shapely.polygons(found.vertices[found.triangles[rows]]))


def with_tags(layout, tags):
    layout.points["tags"] = tags
    return layout


@pytest.mark.parametrize("tag", ['{"crossing:island": "yes"}', '{"traffic_calming": "island"}'])
def test_a_crossing_with_an_island_has_kerbs_on_both_sides_of_the_way_through(
    layout_of, city_of, tag
):
    layout = layout_of(
        [([(-90, 0), (90, 0)], WIDE)], points=[((0, 0), "crossing")], extent=(-60, -60, 60, 60)
    )
    city = built(with_tags(layout, [tag]), city_of)
    middle = shapely.intersection(shape_of(city, "kerb", "courtyard"), shapely.box(-6, -2, 6, 2))
    assert shapely.get_num_geometries(middle) == 2
    assert middle.bounds == pytest.approx((-4.5, -1, 4.5, 1), abs=0.05)
    floor = shapely.intersection(shape_of(city, "tactile_pale"), shapely.box(-6, -2, 6, 2))
    assert floor.area == pytest.approx(4.0 * 2.0, rel=0.15)
    assert check_arrangement(city.ground) == (0, 0, 0.0)
    assert [check.name for check in check_junctions(city) if not check.ok] == []


def test_no_island_stands_where_lanes_leave_no_room_or_the_map_has_none(layout_of, city_of):
    for width, tag in ((6.0, '{"crossing:island": "yes"}'), (9.0, '{"crossing:island": "no"}')):
        street = WIDE | {"width": width, "lane_width": width / 2}
        layout = layout_of([([(-90, 0), (90, 0)], street)], points=[((0, 0), "crossing")])
        city = built(with_tags(layout, [tag]), city_of)
        assert shape_of(city, "kerb").intersection(shapely.box(-6, -2, 6, 2)).is_empty


def test_a_crossing_leads_through_the_median_without_a_step(layout_of, city_of):
    apart = 6.0 + 3.0
    streets = [([(-90, 0), (90, 0)], ONE), ([(90, apart), (-90, apart)], ONE)]
    layout = layout_of(streets, points=[((0, 0), "crossing"), ((0, apart), "crossing")])
    city = built(with_tags(layout, ["{}", "{}"]), city_of)
    way = shape_of(city, "tactile_pale", "ramp", "kerb_dropped")
    assert way.covers(shapely.LineString([(0, 3.02), (0, apart - 3.02)]))
    rise = ramp_heights(city.ground)
    ramp = city.ground.labelled("ramp")[city.ground.triangle_face]
    own = np.unique(city.ground.triangles[ramp])
    inside = own[(np.abs(city.ground.vertices[own] - [0, apart / 2]) < [1.75, 1.0]).all(axis=1)]
    assert len(inside)
    assert rise[inside].max() <= DROPPED + 0.6 / RAMP_SLOPE + 1e-4


def test_the_kerb_is_lowered_where_a_drive_crosses_the_walk(layout_of, city_of):
    drive = {"kind": "service", "width": 3.0, "sidewalk_left": 0.0, "sidewalk_right": 0.0}
    layout = layout_of([([(-90, 0), (0, 0), (90, 0)], {"kind": "secondary"}),
                        ([(0, 0), (0, 60)], drive)])  # fmt: skip
    city = built(layout, city_of)
    line = shapely.LineString([(-12, 4.5), (12, 4.5)])  # the middle of the walk
    assert shape_of(city, "kerb").intersection(line).is_empty
    dropped = shapely.get_parts(shape_of(city, "kerb_dropped").intersection(line))
    assert len(dropped) == 2
    rise = ramp_heights(city.ground)
    ramp = city.ground.labelled("ramp")[city.ground.triangle_face]
    own = np.unique(city.ground.triangles[ramp])
    assert rise[own].min() == pytest.approx(DROPPED)
    assert rise[own].max() == pytest.approx(KERB_HEIGHT, abs=0.01)
    assert LABEL["ramp"] in city.ground.face_label
    assert check_arrangement(city.ground) == (0, 0, 0.0)


def test_a_street_without_walks_needs_no_lowered_kerb(layout_of, city_of):
    bare = {"sidewalk_left": 0.0, "sidewalk_right": 0.0}
    layout = layout_of([([(-90, 0), (0, 0), (90, 0)], bare),
                        ([(0, 0), (0, 60)], bare | {"kind": "service", "width": 3.0})])  # fmt: skip
    assert shape_of(built(layout, city_of), "kerb_dropped", "ramp").is_empty
