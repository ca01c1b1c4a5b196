"""What is painted amid junctions: guides of turns, boxes, centre marks."""

from dataclasses import replace

import numpy as np
import pytest
import shapely

from cityx.city.lanes import MOVEMENTS
from cityx.geometry.polylines import to_linestrings
from cityx.places.painting import Painting
from cityx.road.markings import turn_guides as turning
from cityx.road.markings.arrows import lane_symbols
from cityx.road.markings.box_junctions import box_junctions
from cityx.road.markings.centre_marks import centre_marks
from cityx.road.markings.marks import street_of
from cityx.road.markings.turn_guides import WIDTH, crossing_boxes, turn_guides
from cityx.road.markings.unused_ground import _hatching, unused_ground
from cityx.road.markings.zebras import zebras_of
from cityx.road.network.junction_ways import conflicts, junction_ways
from cityx.road.network.lane_graph import lane_graph
from cityx.road.network.network import junction_clusters, road_network
from cityx.road.network.sections import bands_of
from cityx.road.network.through_roads import across_junctions, through_roads
from cityx.road.surface.carriageway import build_carriageway

WIDE = {"kind": "secondary", "width": 14.0, "lanes": 4, "lanes_forward": 2, "lane_width": 3.5}
ONE_WAY = {"kind": "tertiary", "oneway": True, "lanes": 1, "width": 6.0}
CROSS = [[(-90, 0), (0, 0), (90, 0)], [(0, -90), (0, 0), (0, 90)]]
SIGNALS = [((0, 0), "traffic_signals")]
NONE = np.zeros(0, object)


def built(layout, **painting):
    network = road_network(layout, left_hand=painting.pop("left_hand", False))
    street = street_of(layout, network, bands_of(layout, network), Painting(**painting))
    every = np.ones(network.edge_count, bool)
    road = build_carriageway(layout, network, every)
    return (
        street,
        junction_ways(street, lane_graph(layout, network)),
        zebras_of(street, every, road),
        road,
    )


def star_of():
    """Six streets that meet, every second one towards the middle."""
    angles = np.radians([0, 50, 100, 180, 230, 280])
    ends = [tuple(np.round(90 * np.array([np.cos(a), np.sin(a)]), 3)) for a in angles]
    return [([end, (0, 0)] if n < 3 else [(0, 0), end], ONE_WAY) for n, end in enumerate(ends)]


def test_every_arm_has_ways_to_the_three_others(layout_of):
    street, ways, _, _ = built(layout_of([(line, {}) for line in CROSS]))
    assert len(ways.hub) == 12
    assert np.bincount(ways.movement, minlength=4).tolist() == [4, 4, 4, 0]
    assert (street.network.node_position[ways.hub] == 0).all()


def test_a_way_leads_through_all_nodes_of_a_junction_in_one_piece(layout_of):
    # Two carriageways of 7 m apart: both crossings are one junction.
    lines = [[(-90, 4), (0, 4), (90, 4)], [(90, -4), (0, -4), (-90, -4)]]
    one_way = {"oneway": True, "lanes": 1, "width": 5.0}
    streets = [(line, one_way) for line in lines] + [([(0, -90), (0, -4), (0, 4), (0, 90)], {})]
    street, ways, _, _ = built(layout_of(streets))
    cluster = junction_clusters(street.network)
    assert len(np.unique(ways.hub)) == 1
    ends = cluster[street.network.edge_nodes[ways.edge]]
    assert (ends[:, 0] != ends[:, 1]).all()
    first, last = ways.line.start[:-1], ways.line.start[1:] - 1
    onward = ways.line.points[last][:, 1] - ways.line.points[first][:, 1] > 20
    assert (onward & (ways.movement == MOVEMENTS.index("through"))).sum() == 1


def test_a_road_goes_on_past_all_nodes_of_a_junction(layout_of):
    lines = [[(-90, 4), (0, 4), (90, 4)], [(90, -4), (0, -4), (-90, -4)]]
    streets = [(line, ONE_WAY) for line in lines]
    main = {"kind": "secondary"}
    street = built(layout_of([*streets, ([(0, -90), (0, -4), (0, 4), (0, 90)], main)]))[0]
    single = through_roads(street)
    whole = across_junctions(street, single)
    assert len(single.node) == 2  # from either side to the piece between the nodes
    assert street.length[whole.edge].tolist() == [[86.0, 86.0]]
    assert sorted(whole.side[0]) == [0, 1]
    assert whole.major.tolist() == [True]


def test_ways_cross_where_arms_do(layout_of):
    _, ways, _, _ = built(layout_of([(line, {}) for line in CROSS]))
    places = conflicts(ways)
    assert len(places)
    assert shapely.bounds(shapely.union_all(places)) == pytest.approx([-4, -4, 4, 4], abs=2)


def own_lanes(ways):
    """Ways where the innermost lanes do not go straight on as well."""
    turning = ways.origin[ways.movement == MOVEMENTS.index("left")]
    onward = ways.movement == MOVEMENTS.index("through")
    return ways.take(~(onward & np.isin(ways.origin, turning)))


def beside_others(ways):
    """Ways where as many again turn left from lanes beside."""
    left = np.flatnonzero(ways.movement == MOVEMENTS.index("left"))
    more = ways.take(np.concatenate([np.arange(len(ways.origin)), left]))
    origin = more.origin.copy()
    origin[len(ways.origin) :] += 1000
    return replace(more, origin=origin)


def test_who_turns_from_a_lane_of_its_own_is_led_across_signals(layout_of, monkeypatch):
    streets = [(line, WIDE) for line in CROSS]
    street, ways, zebras, road = built(layout_of(streets, points=SIGNALS))
    # Without arrows of the map the innermost lane also goes straight on: nobody has its own.
    assert (ways.movement == MOVEMENTS.index("left")).any()
    assert not len(turn_guides(street, ways, zebras, road, NONE, "both")[0])
    alone = own_lanes(ways)
    assert len(turn_guides(street, alone, zebras, road, NONE, "outer")[0]) >= 4
    monkeypatch.setattr(turning, "WIDE_AREA", 1000.0)
    assert not len(turn_guides(street, alone, zebras, road, NONE, "outer")[0])
    outer = turn_guides(street, beside_others(alone), zebras, road, NONE, "outer")[0]
    both = turn_guides(street, alone, zebras, road, NONE, "both")[0]
    assert 8 <= len(outer) < len(both)
    assert shapely.covered_by(both, shapely.union_all(road.stars)).all()
    assert shapely.area(both).max() < 1.5 * WIDTH
    assert shapely.area(both).min() > 0.5 * WIDTH
    gap = shapely.distance(both[:, None], both[None])
    assert (gap[~np.eye(len(both), dtype=bool)] > 0.2).all()
    assert not len(turn_guides(street, alone, zebras, road, NONE, "")[0])


def test_where_turns_would_cross_only_those_of_one_road_are_led(layout_of):
    greater = WIDE | {"kind": "primary"}
    layout = layout_of([(CROSS[0], WIDE), (CROSS[1], greater)], points=SIGNALS)
    street, ways, zebras, road = built(layout)
    edge = turn_guides(street, own_lanes(ways), zebras, road, NONE, "both")[1]
    assert street.kind[np.unique(edge)].tolist() == ["primary", "primary"]


def test_single_lanes_find_their_way_straight_on(layout_of):
    streets = [(line, ONE_WAY | {"width": 16.0}) for line in CROSS]
    street, ways, zebras, road = built(layout_of(streets, points=SIGNALS))
    assert shapely.area(road.stars).max() > 300
    assert not len(turn_guides(street, ways, zebras, road, NONE, "both")[0])


def test_who_goes_straight_on_where_six_roads_meet_is_led(layout_of):
    street, ways, zebras, road = built(layout_of(star_of(), points=SIGNALS))
    marks, edge = turn_guides(street, ways, zebras, road, NONE, "both")
    assert len(marks) >= 10
    assert len(np.unique(edge)) == 1  # ways straight on cross here; one of them is led
    (own,) = np.unique(edge)
    onward = ways.movement == MOVEMENTS.index("through")
    led = to_linestrings(ways.take(onward & (ways.edge == own)).line)
    apart = shapely.distance(shapely.union_all(marks), led)
    assert apart.min() == pytest.approx(3.25 / 2 - WIDTH / 2, abs=0.1)
    assert not len(turn_guides(street, ways, zebras, road, NONE, "outer")[0])


DUAL = [([(-90, 6), (0, 6), (90, 6)], ONE_WAY), ([(90, -6), (0, -6), (-90, -6)], ONE_WAY)]


@pytest.mark.parametrize(
    ("streets", "directions"),
    [
        (star_of(), 6),
        ([(line, {}) for line in CROSS], 4),
        ([(line, {}) for line in CROSS] + [([(0, 0), (60, 60)], {"kind": "service"})], 4),
        ([*DUAL, ([(0, -90), (0, -6), (0, 6), (0, 90)], {})], 4),
    ],
)
def test_a_drive_and_a_second_carriageway_are_no_directions_of_their_own(
    streets, directions, layout_of
):
    street = built(layout_of(streets, points=SIGNALS))[0]
    assert street.directions.max() == directions


def test_a_main_road_that_bends_is_led_where_both_sides_have_lines(layout_of):
    bent = [(-90, 0), (0, 0), (85, 31)]
    layout = layout_of([(bent, WIDE), (CROSS[1], ONE_WAY | {"width": 9.0})], points=SIGNALS)
    street, ways, zebras, road = built(layout)
    marks, edge = turn_guides(street, ways, zebras, road, NONE, "both")
    assert len(marks) >= 8
    assert set(street.kind[edge]) == {"secondary"}
    assert not len(turn_guides(street, ways, zebras, road, NONE, "outer")[0])


def test_a_guide_keeps_off_what_is_taken(layout_of):
    layout = layout_of([(line, WIDE) for line in CROSS], points=SIGNALS)
    street, ways, zebras, road = built(layout)
    alone = beside_others(own_lanes(ways))
    whole, edges = turn_guides(street, alone, zebras, road, NONE, "outer")
    taken = np.array([shapely.buffer(whole[1], 0.1)], object)
    left, of = turn_guides(street, alone, zebras, road, taken, "outer")
    assert 0 < len(left) < len(whole)
    assert not shapely.intersects(left, taken[0]).any()
    # At least four dashes are left of a line.
    assert np.unique(of, return_counts=True)[1].min() >= 4
    assert len(np.unique(edges)) == 2


def test_a_guide_goes_on_beyond_what_crosses_it(layout_of):
    layout = layout_of([(line, WIDE) for line in CROSS], points=SIGNALS)
    street, ways, zebras, road = built(layout)
    alone = beside_others(own_lanes(ways))
    whole, edges = turn_guides(street, alone, zebras, road, NONE, "outer")
    row = whole[edges == edges[0]]
    across = np.array([shapely.buffer(row[len(row) // 2], 0.3)], object)
    left, of = turn_guides(street, alone, zebras, road, across, "outer")
    left = left[of == edges[0]]
    assert 0 < len(left) < len(row)
    for end in (row[0], row[-1]):
        assert shapely.equals_exact(left, end, 1e-9).any()


def test_a_box_covers_what_ways_cross_and_stays_in_the_junction(layout_of):
    main = {"kind": "secondary", "width": 7.0, "lane_width": 3.5}
    street, ways, _, road = built(layout_of([(line, main) for line in CROSS], points=SIGNALS))
    (box,) = box_junctions(street, ways, road).polygons
    (star,) = road.stars
    assert star.contains(box)
    hull = shapely.convex_hull(box)
    assert hull.contains(shapely.union_all(conflicts(ways)))
    assert hull.area < 0.75 * star.area


def test_a_lozenge_lies_amid_signals_and_a_cross_amid_minor_streets(layout_of):
    street, ways, _, road = built(layout_of([(line, WIDE) for line in CROSS], points=SIGNALS))
    (lozenge,) = centre_marks(street, ways, road)
    assert shapely.distance(lozenge, shapely.Point(0, 0)) < 1.0
    street, ways, _, road = built(layout_of([(line, {}) for line in CROSS]))
    (cross,) = centre_marks(street, ways, road)
    assert cross.area == pytest.approx(4 * 0.9 * 0.15 - 0.15**2, abs=0.01)
    street, ways, _, road = built(layout_of([(line, WIDE) for line in CROSS]))
    assert not len(centre_marks(street, ways, road))
    street, ways, _, road = built(layout_of(star_of(), points=SIGNALS))
    assert not len(centre_marks(street, ways, road))  # six arms have no such middle


def test_lozenges_tell_of_zebras_ahead_but_not_of_signals(layout_of):
    crossing = [((12, 0), "crossing")]

    def diamonds(points):
        street, *_ = built(layout_of([(line, {}) for line in CROSS], points=points))
        every = np.ones(street.network.edge_count, bool)
        with_them = lane_symbols(street, every, diamonds=True)[0]
        return len(with_them) - len(lane_symbols(street, every)[0])

    assert diamonds(crossing) == 2
    assert diamonds(crossing + SIGNALS) == 0


def unused(layout, taken=NONE, keep=slice(None)):
    """Return the pieces that are hatched, the ways that are kept, and the junction's surface."""
    street, ways, zebras, road = built(layout)
    ways = ways.take(keep)
    found = unused_ground(
        street, [ways], road, np.concatenate([taken, crossing_boxes(street, zebras)])
    )
    return found, ways, road


def test_what_no_way_comes_near_is_hatched_under_signals(layout_of):
    wide = [(line, WIDE | {"width": 24.0}) for line in CROSS]
    layout = layout_of(wide, points=SIGNALS)
    straight = np.flatnonzero(built(layout)[1].movement == MOVEMENTS.index("through"))
    found, ways, road = unused(layout, keep=straight)
    marks = shapely.union_all(found.polygons)
    lines = shapely.multilinestrings(to_linestrings(ways.line))
    assert marks.area > 10.0
    assert shapely.distance(marks, lines) > 1.7
    assert shapely.covered_by(marks, shapely.union_all([*road.stars, *road.curves]))
    bars = shapely.area(marks) / shapely.area(shapely.convex_hull(marks))
    assert bars < 0.8  # bars, with gaps between
    blocked = np.array([marks.centroid.buffer(30.0)], object)
    assert not len(unused(layout, taken=blocked, keep=straight)[0].polygons)
    assert not len(unused(layout_of(wide), keep=straight)[0].polygons)  # no signals


def test_bicycles_keep_their_ways_free_of_hatching(layout_of):
    section = "cycle 2 - | drive 10 - | drive 10 + | cycle 2 +"
    wide = [(line, WIDE | {"width": 24.0, "lanes": 2, "section": section}) for line in CROSS]
    street, ways, zebras, road = built(layout_of(wide, points=SIGNALS))
    straight = ways.take(ways.movement == MOVEMENTS.index("through"))
    graph = lane_graph(street.layout, street.network)
    bicycles = junction_ways(street, graph, bicycles=True)
    assert (street.network.node_position[bicycles.hub] == 0).all()
    assert (bicycles.movement == MOVEMENTS.index("through")).sum() == 4
    taken = crossing_boxes(street, zebras)
    without, found = (
        shapely.union_all(unused_ground(street, some, road, taken).polygons)
        for some in ([straight], [straight, bicycles])
    )
    lines = shapely.multilinestrings(to_linestrings(bicycles.line))
    assert shapely.distance(without, lines) == 0.0
    assert found.area > 0.0
    assert shapely.distance(found, lines) > 1.7


def test_a_piece_is_hatched_aslant_of_its_longer_side():
    shape = shapely.box(0.0, 0.0, 10.0, 3.0)
    made = _hatching(shape)
    assert 0.3 < made.area / shape.area < 0.6
    turned = _hatching(shapely.affinity.rotate(shape, 30.0, origin=(0, 0)))
    assert turned.area == pytest.approx(made.area, rel=0.15)
