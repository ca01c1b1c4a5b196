from dataclasses import replace

import numpy as np
import pytest
import shapely

from cityx.checks.street_checks import check_lanes
from cityx.city.lanes import MOVEMENTS
from cityx.city.layout import make_table
from cityx.city.routes import cars, lane_lengths, nearest_lane, pieces_of, route, side_by_side
from cityx.city.section import BAND_KINDS, KIND, TURN
from cityx.errors import UsageError
from cityx.road.network.lane_graph import lane_graph, lanes
from cityx.road.network.network import network, road_network
from cityx.road.network.sections import bands_of

WEST, EAST, NORTH, SOUTH, MIDDLE = (-90, 0), (90, 0), (0, 90), (0, -90), (0, 0)
CROSS = [([WEST, MIDDLE, EAST], {}), ([SOUTH, MIDDLE, NORTH], {})]
WIDE = "drive 3 - | drive 3 - | drive 3 + left | drive 3 + through | drive 3 + right"


def graph_of(layout, **options):
    found = road_network(layout, **options)
    return lane_graph(layout, found), found


def lane_at(graph, place):
    return nearest_lane(graph, np.array(place, float))


def goals(graph, lane):
    """Where the lanes end that a lane leads into, as compass words."""
    words = []
    for row in np.flatnonzero(graph.connection[:, 0] == lane):
        x, y = graph.lane_points(int(graph.connection[row, 1]))[-1]
        words.append(
            ("east" if x > 0 else "west") if abs(x) > abs(y) else ("north" if y > 0 else "south")
        )
    return sorted(words)


def test_bands_fill_the_carriageway_from_left_to_right(layout_of):
    layout = layout_of([([WEST, EAST], {"width": 11.2, "parking_left": True,
                                        "parking_right": True, "lanes": 2})])  # fmt: skip
    bands = bands_of(layout, road_network(layout))
    kinds = [BAND_KINDS[kind] for kind in bands.kind]
    assert kinds == ["walk", "parking", "drive", "drive", "parking", "walk"]
    inside = np.flatnonzero(bands.kind != KIND["walk"])
    assert bands.left[inside[0]] == pytest.approx(5.6)
    assert bands.right[inside[-1]] == pytest.approx(-5.6)
    assert np.allclose(bands.right[inside[:-1]], bands.left[inside[1:]])
    assert bands.direction[2:4].tolist() == [-1, 1]


def test_where_one_keeps_left_the_lanes_change_sides(layout_of):
    layout = layout_of([([WEST, EAST], {})])
    for left_hand, first in ((False, -1), (True, 1)):
        bands = bands_of(layout, road_network(layout, left_hand=left_hand))
        moving = bands.direction[bands.kind == KIND["drive"]]
        assert moving.tolist() == [first, -first]


def test_a_measured_section_is_the_asked_one_to_the_centimetre(layout_of):
    text = "parking 2.1 | cycle 1.6 - | drive 3.25 - | drive 3.25 + | cycle 1.6 +"
    layout = layout_of([([WEST, EAST], {"section": text, "width": 11.8})])
    bands = bands_of(layout, road_network(layout))
    inside = bands.kind != KIND["walk"]
    assert np.allclose(bands.width[inside], [2.1, 1.6, 3.25, 3.25, 1.6], atol=0.01)


def test_where_it_is_tight_parked_cars_give_way_before_lanes(layout_of):
    text = "parking 2.1 | drive 3 - | drive 3 + | parking 2.1"
    layout = layout_of([([WEST, EAST], {"section": text, "width": 5.0})])
    bands = bands_of(layout, road_network(layout))
    assert [BAND_KINDS[k] for k in bands.kind if k != KIND["walk"]] == ["drive", "drive"]


def test_every_lane_of_a_crossroads_leads_into_the_three_other_arms(layout_of):
    graph, _ = graph_of(layout_of(CROSS))
    from_west = lane_at(graph, (-50, -1.5))
    assert goals(graph, from_west) == ["east", "north", "south"]


def test_curves_join_lanes_and_run_along_them_at_both_ends(layout_of):
    graph, _ = graph_of(layout_of(CROSS))
    assert len(graph.connection)
    for row, (origin, goal) in enumerate(graph.connection):
        curve = graph.curve[graph.curve_start[row] : graph.curve_start[row + 1]]
        a, b = graph.lane_points(int(origin)), graph.lane_points(int(goal))
        assert np.allclose(curve[0], a[-1])
        assert np.allclose(curve[-1], b[0])
        for one, two in (
            (a[-1] - a[-2], curve[1] - curve[0]),
            (b[1] - b[0], curve[-1] - curve[-2]),
        ):
            cosine = one @ two / (np.hypot(*one) * np.hypot(*two))
            assert cosine > np.cos(np.radians(12))


def test_arrows_of_the_map_say_which_lane_turns_where(layout_of):
    streets = [([WEST, MIDDLE], {"section": WIDE, "width": 15.0, "lanes": 5}),
               ([MIDDLE, EAST], {}), ([SOUTH, MIDDLE, NORTH], {})]  # fmt: skip
    graph, _ = graph_of(layout_of(streets))
    found = [goals(graph, lane_at(graph, (-50, y))) for y in (0.0, -3.0, -6.0)]
    assert found == [["north"], ["east"], ["south"]]


def test_an_arrow_means_the_exit_in_its_place_when_no_angle_fits(layout_of):
    fork = [([WEST, MIDDLE], {"section": "drive 3 + left | drive 3 + through", "oneway": True,
                              "lanes": 2}),
            ([MIDDLE, (90, 30)], {"oneway": True}),
            ([MIDDLE, (90, -8)], {"oneway": True})]  # fmt: skip
    graph, _ = graph_of(layout_of(fork))
    left, right = lane_at(graph, (-50, 1.5)), lane_at(graph, (-50, -1.5))
    ends = {
        lane: {graph.lane_points(int(goal))[-1][1] > 10 for origin, goal in graph.connection
               if origin == lane}
        for lane in (left, right)
    }  # fmt: skip
    assert ends == {left: {True}, right: {False}}


def restricted(layout, begin, *ends, only):
    size = len(ends)
    rules = make_table(
        "restrictions", np.array([shapely.Point(MIDDLE)] * size, object), id=np.arange(1, 1 + size),
        source=["r"] * size, from_source=[begin] * size, to_source=list(ends), only=[only] * size,
    )  # fmt: skip
    return replace(layout, restrictions=rules)


@pytest.mark.parametrize(("only", "left"), [(False, ["east", "south"]), (True, ["north"])])
def test_turn_restrictions_close_movements(layout_of, only, left):
    streets = [([WEST, MIDDLE], {"source": "w"}), ([MIDDLE, EAST], {"source": "e"}),
               ([MIDDLE, NORTH], {"source": "n"}), ([MIDDLE, SOUTH], {"source": "s"})]  # fmt: skip
    layout = restricted(layout_of(streets), "w", "n", only=only)
    graph, _ = graph_of(layout)
    assert goals(graph, lane_at(graph, (-50, -1.5))) == left


def test_a_restriction_from_a_way_that_became_part_of_another_counts(layout_of):
    streets = [([WEST, (-8, 0)], {"source": "w"}),
               ([(-8, 0), MIDDLE], {"source": "v", "width": 9.0}),
               ([MIDDLE, EAST], {"source": "e"}), ([MIDDLE, NORTH], {"source": "n"})]  # fmt: skip
    graph, _ = graph_of(restricted(layout_of(streets), "v", "n", only=False))
    assert goals(graph, lane_at(graph, (-50, -1.5))) == ["east"]


def test_a_restriction_that_would_close_a_street_is_passed_over(layout_of):
    layout = restricted(layout_of([([WEST, MIDDLE], {"source": "w"}), ([MIDDLE, EAST], {}),
                                   ([MIDDLE, NORTH], {})]), "w", "nowhere", only=True)  # fmt: skip
    graph, _ = graph_of(layout)
    assert goals(graph, lane_at(graph, (-50, -1.5))) == ["east", "north"]


def test_what_two_restrictions_each_allow_alone_is_both_allowed(layout_of):
    streets = [([WEST, MIDDLE], {"source": "w"}), ([MIDDLE, EAST], {"source": "e"}),
               ([MIDDLE, NORTH], {"source": "n"}), ([MIDDLE, SOUTH], {"source": "s"})]  # fmt: skip
    graph, _ = graph_of(restricted(layout_of(streets), "w", "n", "e", only=True))
    assert goals(graph, lane_at(graph, (-50, -1.5))) == ["east", "north"]


def test_a_restriction_to_a_street_against_its_traffic_is_passed_over(layout_of):
    streets = [([WEST, MIDDLE], {"source": "w"}), ([MIDDLE, EAST], {"source": "e"}),
               ([NORTH, MIDDLE], {"source": "n", "oneway": True, "lanes": 1})]  # fmt: skip
    graph, _ = graph_of(restricted(layout_of(streets), "w", "n", only=True))
    assert goals(graph, lane_at(graph, (-50, -1.5))) == ["east"]


def test_at_a_dead_end_one_turns_round(layout_of):
    graph, _ = graph_of(layout_of([([WEST, EAST], {})]))
    out = lane_at(graph, (50, -1.5))
    back = lane_at(graph, (50, 1.5))
    assert [out, back] in graph.connection.tolist()


def test_a_narrow_street_is_driven_both_ways_on_one_band(layout_of):
    graph, _ = graph_of(layout_of([([WEST, EAST], {"width": 3.5, "lanes": 1})]))
    rows = np.flatnonzero(cars(graph))
    assert graph.direction[rows].tolist() == [1, -1]
    assert np.allclose(graph.left[rows[0]], graph.left[rows[1]])


def test_bicycles_go_on_among_the_cars_where_their_lane_ends(layout_of):
    text = "drive 3 - | drive 3 + | cycle 1.6 +"
    graph, _ = graph_of(layout_of([([WEST, MIDDLE], {"section": text}), ([MIDDLE, EAST], {})]))
    lane = int(np.flatnonzero(graph.kind == KIND["cycle"])[0])
    into = graph.connection[graph.connection[:, 0] == lane, 1]
    assert len(into) == 1
    assert graph.kind[into[0]] == KIND["drive"]


@pytest.mark.parametrize("left_hand", [False, True])
def test_bicycles_leave_the_lane_at_the_kerb_for_one_of_their_own(layout_of, left_hand):
    before = {"section": "drive 3 + | drive 3 +", "oneway": True, "lanes": 2}
    kerb = "cycle 1.6 + | drive 4 +" if left_hand else "drive 4 + | cycle 1.6 +"
    after = {"section": kerb, "oneway": True, "lanes": 1}
    layout = layout_of([([WEST, MIDDLE], before), ([MIDDLE, EAST], after)])
    graph, _ = graph_of(layout, left_hand=left_hand)
    own = int(np.flatnonzero(graph.kind == KIND["cycle"])[0])
    (origin,) = graph.connection[graph.connection[:, 1] == own, 0]
    west = np.flatnonzero((graph.edge == graph.edge[origin]) & cars(graph))
    side = graph.left[west] if left_hand else -graph.left[west]
    assert origin == west[np.argmax(side)]
    row = int(np.flatnonzero((graph.connection == (origin, own)).all(axis=1))[0])
    assert graph.movement[row] == MOVEMENTS.index("through")


def test_nobody_crosses_into_a_cycle_lane_beside_one_that_goes_on(layout_of):
    both = {"section": "drive 4 + | cycle 1.6 +", "oneway": True, "lanes": 1}
    away = ([MIDDLE, NORTH], {"oneway": True, "lanes": 1})
    graph, _ = graph_of(layout_of([([WEST, MIDDLE], both), ([MIDDLE, EAST], both), away]))
    into = graph.connection[graph.kind[graph.connection[:, 1]] == KIND["cycle"], 0]
    assert (graph.kind[into] == KIND["cycle"]).all()
    assert len(into) == 1


def test_a_route_takes_the_quicker_way_and_is_one_line(layout_of):
    ring = [([(-50, 0), (0, 0)], {}), ([(0, 0), (50, 0)], {}),
            ([(0, 0), (0, 60), (50, 60), (50, 0)], {"maxspeed_kmh": 20.0}),
            ([(50, 0), (90, 0)], {})]  # fmt: skip
    graph, _ = graph_of(layout_of(ring))
    origin, goal = lane_at(graph, (-30, -1.5)), lane_at(graph, (80, -1.5))
    found = route(graph, origin, goal)
    assert found.lanes[0] == origin
    assert found.lanes[-1] == goal
    assert found.points[:, 1].max() < 1.0
    steps = np.hypot(*np.diff(found.points, axis=0).T)
    assert steps.sum() == pytest.approx(140.0, abs=2.0)
    assert found.seconds == pytest.approx(140 / (50 / 3.6), rel=0.05)


def test_against_a_one_way_street_there_is_no_route(layout_of):
    graph, _ = graph_of(layout_of([([WEST, MIDDLE], {"oneway": True}),
                                   ([MIDDLE, EAST], {"oneway": True, "width": 7.0})]))  # fmt: skip
    first, second = lane_at(graph, (-50, 0)), lane_at(graph, (50, 0))
    assert route(graph, first, second) is not None
    assert route(graph, second, first) is None


def test_a_route_may_change_lanes(layout_of):
    text = "drive 3 + left | drive 3 + through"
    graph, _ = graph_of(layout_of([
        ([(-90, 0), (-20, 0)], {"oneway": True, "section": "drive 3 + | drive 3 +", "lanes": 2}),
        ([(-20, 0), MIDDLE], {"oneway": True, "section": text, "lanes": 2}),
        ([MIDDLE, EAST], {"oneway": True, "lanes": 1}),
        ([MIDDLE, NORTH], {"oneway": True, "lanes": 1}),
    ]))  # fmt: skip
    assert len(side_by_side(graph)) == 2
    found = route(graph, lane_at(graph, (-60, -1.5)), lane_at(graph, (0, 60)))
    assert found is not None


def test_routes_ask_for_lanes_of_cars(layout_of):
    graph, _ = graph_of(layout_of([([WEST, EAST], {})]))
    walk = int(np.flatnonzero(graph.kind == KIND["walk"])[0])
    with pytest.raises(UsageError, match=f"lane {walk}"):
        route(graph, walk, 1)
    empty, _ = graph_of(layout_of([]))
    with pytest.raises(UsageError, match="no lane"):
        nearest_lane(empty, np.zeros(2))


def test_the_graph_is_in_as_many_pieces_as_the_map(layout_of, city_of):
    streets = [*CROSS, ([(-90, 70), (-60, 70)], {})]
    city = lanes(network(city_of(layout_of(streets))))
    checks = {check.name: check for check in check_lanes(city)}
    assert checks["lane_graph_pieces"].value == 0
    assert len(np.unique(pieces_of(city.lanes)[cars(city.lanes)])) == 2
    graph = city.lanes
    cut = replace(graph, connection=graph.connection[:0], movement=graph.movement[:0],
                  curve_start=np.zeros(1, np.int64), curve=graph.curve[:0])  # fmt: skip
    broken = {check.name: check for check in check_lanes(replace(city, lanes=cut))}
    assert broken["lane_graph_pieces"].value > 0
    assert broken["lanes_without_exit"].value > 0.3


def test_lanes_end_where_junction_surfaces_begin(layout_of):
    graph, found = graph_of(layout_of(CROSS))
    rows = np.flatnonzero(cars(graph))
    expected = 90 - found.trim.sum(axis=1)[graph.edge[rows]]
    assert np.allclose(lane_lengths(graph)[rows], expected, atol=0.01)


def test_lane_ids_do_not_depend_on_the_order_of_the_streets(layout_of):
    streets = [([WEST, MIDDLE], {}), ([MIDDLE, EAST], {"width": 7.0}), ([MIDDLE, NORTH], {})]
    layout = layout_of(streets)
    one, _ = graph_of(layout)
    mixed = layout.roads.iloc[[2, 0, 1]].reset_index(drop=True)
    other, _ = graph_of(replace(layout, roads=mixed))
    assert sorted(one.lane_id.tolist()) == sorted(other.lane_id.tolist())
    assert len(set(one.lane_id.tolist())) == one.count


def test_turn_bits_reach_the_graph(layout_of):
    layout = layout_of([([WEST, EAST], {"section": WIDE, "width": 15.0})])
    graph, _ = graph_of(layout)
    assert TURN["left"] in graph.turns.tolist()
