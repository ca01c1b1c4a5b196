"""Where people cross, what marks it, and which junctions warrant signals of their own."""

from dataclasses import replace

import numpy as np
import pytest
import shapely

from cityx.checks.junction_checks import check_junctions
from cityx.checks.walkway_checks import check_walkways
from cityx.city.city import City
from cityx.city.frame import Frame
from cityx.city.ground import LABEL
from cityx.ground.arrangement import face_areas
from cityx.ground.walking.crosswalks import crosswalks_of
from cityx.places.painting import Painting
from cityx.places.profiles import profile_of
from cityx.road.ground.ground_surface import ground
from cityx.road.markings.arrows import lane_symbols
from cityx.road.markings.crossing_places import FLARE, SETBACK
from cityx.road.markings.marks import DOTTED, PLAIN, STRIPED, street_of
from cityx.road.network.network import network, road_network
from cityx.road.network.sections import bands_of
from cityx.road.surface.street_surfaces import street_regions

MAIN = {"kind": "secondary", "width": 7.0, "lane_width": 3.5}
CROSS = [([(-90, 0), (0, 0), (90, 0)], MAIN), ([(0, -90), (0, 0), (0, 90)], MAIN)]
HOUSES = [(x, y, x + 12, y + 12) for x in (-24, 12) for y in (-24, 12)]
LONDON, BERLIN, TOKYO = (51.5, -0.1), (52.5, 13.4), (35.7, 139.8)


def told(layout, tags):
    points = layout.points
    return replace(
        layout, points=points.assign(tags=np.where(points["kind"] == "crossing", tags, ""))
    )


def street(layout, painting=None):
    roads = road_network(layout)
    return street_of(layout, roads, bands_of(layout, roads), painting or Painting())


def arm_at(found, x):
    """Return the edge and the end that leave the middle towards a side."""
    edge = next(
        e for e in range(found.network.edge_count)
        if np.sign(found.network.edge_points(e)[:, 0].sum()) == x
    )  # fmt: skip
    return edge, int(np.hypot(*found.network.edge_points(edge)[0]) > 1)


def test_a_mapped_crossing_lies_where_the_map_has_it_but_not_behind_its_curves(layout_of):
    middles = []
    for at in (7.0, 10.0, 30.0):
        found = street(layout_of(CROSS, points=[((at, 0), "crossing")]))
        edge, end = arm_at(found, 1)
        assert found.network.crossing[edge, end] == (at < 30)
        trim, depth = found.network.trim[edge, end], found.depth[edge]
        middles.append(trim + found.setback[edge, end] + depth / 2)
        assert found.mouth[edge, end] + depth / 2 - 1e-6 <= middles[-1]
        assert middles[-1] <= trim + SETBACK + depth / 2 + 1e-6
    inner, mapped, usual = middles
    assert mapped == pytest.approx(10.0)
    assert inner < mapped < usual


def test_the_kerb_has_left_its_street_by_the_flare_at_the_mouth(layout_of):
    layout = layout_of(CROSS)
    found = street(layout)
    edge, end = arm_at(found, 1)
    _, road = street_regions(layout, found.network)
    driven = shapely.union_all(road.driven)
    x = found.mouth[edge, end]
    across = shapely.intersection(shapely.LineString([(x, -20), (x, 20)]), driven)
    assert across.length == pytest.approx(7.0 + 2 * FLARE, abs=0.1)


@pytest.mark.parametrize(
    ("place", "tags", "signals", "kind"),
    [
        (BERLIN, "", True, DOTTED), (LONDON, "", True, DOTTED), (TOKYO, "", True, STRIPED),
        (BERLIN, "", False, PLAIN), (LONDON, "", False, PLAIN), (TOKYO, "", False, STRIPED),
        (BERLIN, '{"crossing": "zebra"}', False, STRIPED),
        (TOKYO, '{"crossing": "unmarked"}', False, PLAIN),
        (TOKYO, '{"crossing:markings": "no"}', True, PLAIN),
    ],
)  # fmt: skip
def test_crossings_look_as_the_map_the_signals_and_the_country_say(
    layout_of, place, tags, signals, kind
):
    points = [((9, 0), "crossing")] + [((0, 0), "traffic_signals")] * signals
    found = street(told(layout_of(CROSS, points=points), tags), profile_of(Frame(*place)).painting)
    assert found.crossing[arm_at(found, 1)] == kind


@pytest.mark.parametrize("width", [7.0, 10.3, 13.0, 13.9, 14.6])
@pytest.mark.parametrize("angle", [90.0, 67.0])
def test_people_cross_main_streets_in_town_between_lowered_kerbs(layout_of, width, angle):
    ahead = np.array([np.cos(np.radians(angle)), np.sin(np.radians(angle))])
    main = MAIN | {"width": width, "lane_width": width / 2}
    streets = [([(-90, 0), (0, 0), (90, 0)], main), ([-90 * ahead, (0, 0), 90 * ahead], {})]
    layout = layout_of(streets, houses=HOUSES)
    made = ground(network(City("test", Frame(*BERLIN), layout, lod=1)))
    assert made.network.crossing.sum() == 4
    found = crosswalks_of(made.ground, made.layout, made.network)
    assert found.lowered.tolist() == [True] * 4
    stones = made.ground.vertices[made.ground.triangles_of("kerb_dropped")].reshape(-1, 2)
    for ends in found.ends:
        along = (ends[1] - ends[0])[::-1] * (-1, 1) / np.hypot(*(ends[1] - ends[0]))
        for end in ends:
            near = (stones[np.hypot(*(stones - end).T) < 4.0] - end) @ along
            assert near.min() < -1.0
            assert near.max() > 1.0
    (check,) = check_walkways(made)
    assert check.value == pytest.approx(0.0)


@pytest.mark.parametrize(
    ("width", "houses", "told", "crossed"),
    [(13.9, 1, False, 4), (10.0, 1, False, 0), (13.9, 0, False, 0), (13.9, 1, True, 1)],
)
def test_roads_too_wide_to_cross_anywhere_have_crossings_in_sparse_town(
    layout_of, width, houses, told, crossed
):
    main = MAIN | {"width": width, "lane_width": width / 2}
    streets = [([(-90, 0), (0, 0), (90, 0)], main), ([(0, -90), (0, 0), (0, 90)], main)]
    points = [((13.0, 0.0), "crossing")] * told
    layout = layout_of(streets, houses=HOUSES[:houses], points=points)
    assert road_network(layout).crossing.sum() == crossed


def test_crossings_under_signals_have_rows_that_crosswalks_are_found_by(layout_of):
    points = [((10, 0), "crossing"), ((0, 0), "traffic_signals")]
    layout = layout_of(CROSS, points=points)
    made = ground(network(City("test", Frame(*BERLIN), layout, lod=2)))
    assert made.ground.labelled("crossing_row").any()
    crosswalks = crosswalks_of(made.ground, layout, made.network)
    east = crosswalks.marked & (crosswalks.ends[:, :, 0].mean(axis=1) > 0)
    assert east.sum() == 1
    found = crosswalks.take(east)
    assert np.allclose(found.ends[0].mean(axis=0), (10, 0), atol=0.2)
    assert found.depth[0] == pytest.approx(4.0, abs=0.2)


@pytest.mark.parametrize("angle", [90.0, 60.0, 45.0, 35.0])
def test_people_cross_on_the_bars_alone_even_where_a_junction_cuts_them(layout_of, angle):
    ahead = np.array([np.cos(np.radians(angle)), np.sin(np.radians(angle))])
    streets = [([(-90, 0), (0, 0), (90, 0)], MAIN), ([-90 * ahead, (0, 0), 90 * ahead], MAIN)]
    points = [(tuple(way), "crossing") for way in 9.0 * np.array([(1, 0), (-1, 0), ahead, -ahead])]
    layout = layout_of(streets, points=points)
    made = ground(network(City("test", Frame(*TOKYO), layout, lod=2)))
    found = crosswalks_of(made.ground, layout, made.network)
    assert found.marked.tolist() == [True] * 4
    assert found.depth == pytest.approx([4.0] * 4, abs=0.1)


def test_a_crossing_without_paint_has_lowered_kerbs_and_no_line_before_it(layout_of):
    layout = told(layout_of(CROSS, points=[((9, 0), "crossing")]), '{"crossing": "unmarked"}')
    regions, _ = street_regions(layout, road_network(layout), profile_of(Frame(*TOKYO)).painting)
    beside = shapely.box(5, 3, 14, 6)
    white = regions.polygons[regions.label == LABEL["marking"]]
    lowered = regions.polygons[regions.label == LABEL["kerb_dropped"]]
    assert shapely.intersects(lowered, beside).any()
    assert shapely.intersection(shapely.union_all(white), shapely.box(6, -3.4, 12, -0.5)).area < 0.2


def signal_count(layout, place=BERLIN):
    made = network(City("test", Frame(*place), layout))
    return int((made.layout.points["kind"] == "traffic_signals").sum()), made


def test_main_roads_that_cross_in_town_warrant_signals(layout_of):
    count, made = signal_count(layout_of(CROSS, houses=HOUSES))
    assert count == 1
    assert made.network.crossing.sum() == 4
    assert any("1 junctions have signals" in note for note in made.notes)
    assert signal_count(layout_of(CROSS))[0] == 0  # open country
    quiet = [(line, {}) for line, _ in CROSS]
    assert signal_count(layout_of(quiet, houses=HOUSES))[0] == 0
    for sign in ("stop", "give_way"):
        assert signal_count(layout_of(CROSS, houses=HOUSES, points=[((8, 0), sign)]))[0] == 0


def test_a_map_that_knows_its_signals_gets_no_more(layout_of):
    far = [([(-90, 80), (0, 80), (90, 80)], MAIN)]
    both = [(CROSS[0][0], MAIN), ([(0, -90), (0, 0), (0, 80), (0, 95)], MAIN), *far]
    houses = HOUSES + [(x, y + 80, x + 12, y + 92) for x in (-24, 12) for y in (-24,)]
    houses += [(x, 88, x + 12, 98) for x in (-24, 12)]
    assert signal_count(layout_of(both, houses=houses))[0] == 2
    known = layout_of(both, houses=houses, points=[((0, 80), "traffic_signals")])
    assert signal_count(known)[0] == 1


def test_many_streets_that_meet_and_are_crossed_warrant_signals(layout_of):
    angles = np.radians([0, 72, 144, 216, 288])
    ways = np.column_stack([np.cos(angles), np.sin(angles)])
    streets = [([(0, 0), tuple(90 * way)], {}) for way in ways]
    houses = [(x - 6, y - 6, x + 6, y + 6) for x, y in 28 * np.column_stack(
        [np.cos(angles + np.radians(36)), np.sin(angles + np.radians(36))])]  # fmt: skip
    points = [(tuple(np.round(15 * way, 6)), "crossing") for way in ways]
    assert signal_count(layout_of(streets, houses=houses, points=points))[0] == 1
    assert signal_count(layout_of(streets, houses=houses, points=points[:3]))[0] == 0


def test_arrows_tell_of_one_way_streets_where_the_country_has_them(layout_of):
    layout = layout_of([([(-90, 0), (90, 0)], {"oneway": True, "lanes": 1})])
    found = street(layout)
    chosen = np.ones(1, bool)
    assert len(lane_symbols(found, chosen)[0]) == 0
    marks = lane_symbols(found, chosen, one_way=True)[0]
    assert 2 <= len(marks) <= 10
    assert not len(lane_symbols(street(layout_of([([(-90, 0), (90, 0)], {})])), chosen,
                                one_way=True)[0])  # fmt: skip


def test_a_drive_does_not_decide_how_the_street_it_meets_is_paved(layout_of):
    sett = {"surface": "sett"}
    drive = {"kind": "service", "width": 3.0, "sidewalk_left": 0.0, "sidewalk_right": 0.0}
    for side, paved in ((drive, "setts"), ({}, "junction")):
        layout = layout_of([([(-90, 0), (0, 0), (90, 0)], sett), ([(0, 0), (0, 60)], side)])
        made = ground(network(City("test", Frame(*BERLIN), layout, lod=2)))
        assert made.ground.on(np.array([[0.0, 0.5]]), paved).all()


def test_the_red_way_of_a_cycle_lane_leaves_the_junction_one_surface(layout_of):
    section = "cycle 1.5 - | drive 3.5 - | drive 3.5 + | cycle 1.5 +"
    main = MAIN | {"width": 10.0, "section": section}
    layout = layout_of([(CROSS[0][0], main), (CROSS[1][0], {})])
    made = ground(network(City("test", Frame(*BERLIN), layout, lod=2)))
    way = made.ground.labelled("cycle_lane")
    assert face_areas(made.ground)[way].sum() > 8.0
    checks = {check.name: check for check in check_junctions(made)}
    assert checks["junction_surfaces"].value == 0.0


ALONG = [([(-90, 0), (90, 0)], MAIN)]
ACROSS = ([(40, -60), (40, 60)], {"kind": "footway", "width": 2.0, "sidewalk_left": 0.0,
                                  "sidewalk_right": 0.0})  # fmt: skip


def made_with(layout, tags):
    return ground(network(City("test", Frame(*BERLIN), told(layout, tags), lod=1)))


def walks_across(made, x):
    found = crosswalks_of(made.ground, made.layout, made.network)
    return int((np.hypot(*(found.ends.mean(axis=1) - (x, 0)).T) < 1.0).sum())


@pytest.mark.parametrize(
    ("tags", "across", "lowered"),
    [('{"crossing": "unmarked"}', 1, True), ('{"crossing": "zebra"}', 1, True),
     ('{"crossing": "unmarked", "kerb": "raised"}', 1, False),
     ('{"crossing": "unmarked", "kerb": "lowered"}', 1, True), ('{"crossing": "no"}', 0, False)],
)  # fmt: skip
def test_crossings_between_junctions_are_walked_and_have_the_kerbs_that_are_told(
    layout_of, tags, across, lowered
):
    made = made_with(layout_of(ALONG, points=[((40, 0), "crossing")]), tags)
    assert walks_across(made, 40) == across
    assert bool(len(made.ground.triangles_of("kerb_dropped"))) == lowered


@pytest.mark.parametrize(("tags", "across"), [('{"crossing": "no"}', 0), ("", 1)])
def test_a_footway_does_not_lead_over_a_street_where_nobody_may_cross(layout_of, tags, across):
    made = made_with(layout_of([*ALONG, ACROSS], points=[((40, 0), "crossing")]), tags)
    assert walks_across(made, 40) == across


@pytest.mark.parametrize(("kerb", "sides"), [("raised", 1), ("lowered", 2), ("flush", 2)])
def test_a_kerb_that_is_drawn_at_one_side_of_a_crossing_is_as_told(layout_of, kerb, sides):
    layout = layout_of(ALONG, points=[((40, 0), "crossing"), ((40, 3.6), "kerb")])
    tags = np.where(layout.points["kind"] == "kerb", f'{{"kerb": "{kerb}"}}', "")
    made = ground(network(City("test", Frame(*BERLIN), replace(
        layout, points=layout.points.assign(tags=tags)), lod=1)))  # fmt: skip
    stones = made.ground.vertices[made.ground.triangles_of("kerb_dropped")].mean(axis=1)
    assert len(np.unique(np.sign(stones[:, 1]))) == sides
