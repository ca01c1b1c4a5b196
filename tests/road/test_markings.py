"""What is painted where streets meet, and along kerbs."""

from types import SimpleNamespace

import numpy as np
import pytest
import shapely

from cityx.city.frame import Frame
from cityx.city.ground import LABEL
from cityx.places.painting import Painting
from cityx.places.profiles import profile_of
from cityx.road.markings.arrows import lane_symbols, speed_figures
from cityx.road.markings.box_junctions import box_junctions
from cityx.road.markings.halts import halt_lines
from cityx.road.markings.lane_lines import SOLID, corner_lines, kerb_lines, lane_lines, partings_of
from cityx.road.markings.markings import _lined
from cityx.road.markings.marks import street_of
from cityx.road.markings.symbols import word
from cityx.road.markings.zebras import KERB_GAP, _on_road
from cityx.road.network.junction_ways import junction_ways
from cityx.road.network.lane_graph import lane_graph
from cityx.road.network.network import road_network
from cityx.road.network.sections import bands_of
from cityx.road.network.through_roads import stems, through_roads
from cityx.road.surface.carriageway import build_carriageway
from cityx.road.surface.street_surfaces import street_regions

MAIN = {"kind": "secondary", "width": 7.0, "lane_width": 3.5}
WIDE = {"kind": "secondary", "width": 14.0, "lanes": 4, "lanes_forward": 2, "lane_width": 3.5}
TEE = ([(-90, 0), (0, 0), (90, 0)], [(0, -90), (0, 0)])
ACROSS_EXIT = 0.08  # square metres; its dashes have 0.06, those to give way 0.12


def street(layout):
    network = road_network(layout)
    return street_of(layout, network, bands_of(layout, network))


def everywhere(found):
    return np.ones(found.network.edge_count, bool)


def painted(layout, painting):
    """Return the polygons of white and of yellow paint."""
    found, _ = street_regions(layout, road_network(layout), painting)
    return [found.polygons[found.label == LABEL[name]] for name in ("marking", "marking_yellow")]


def halts(layout, painting):
    found = street(layout)
    road = build_carriageway(layout, found.network, everywhere(found))
    return halt_lines(found, everywhere(found), painting, through_roads(found), road)[0]


def test_the_middle_line_of_a_major_road_leads_past_a_side_street(layout_of):
    layout = layout_of([(TEE[0], MAIN), (TEE[1], {})])
    inside = shapely.box(-2.5, -0.2, 2.5, 0.2)
    white, _ = painted(layout, Painting())
    assert shapely.intersection(shapely.union_all(white), inside).area > 0.1
    tee = layout_of([(line, MAIN) for line in TEE])
    for stems_yield in (True, False):
        white, _ = painted(tee, Painting(stems=stems_yield))
        line = shapely.intersection(shapely.union_all(white), inside).area
        assert (line > 0.1) == stems_yield
    equal, _ = painted(layout_of([(TEE[0], MAIN), ([(0, -90), (0, 0), (0, 90)], MAIN)]), Painting())
    assert shapely.intersection(shapely.union_all(equal), inside).area == 0.0
    over = layout_of([(TEE[0], MAIN), ([(0, -90), (0, 0), (0, 90)], {})])
    assert shapely.intersection(shapely.union_all(painted(over, Painting())[0]), inside).area == 0


def test_cycle_lanes_are_led_across_signals_and_the_middle_line_is_not(layout_of):
    section = "cycle 1.5 - | drive 3.5 - | drive 3.5 + | cycle 1.5 +"
    main = MAIN | {"width": 10.0, "section": section}
    layout = layout_of([(TEE[0], main), ([(0, -90), (0, 0), (0, 90)], {})],
                       points=[((0, 0), "traffic_signals")])  # fmt: skip
    white = shapely.union_all(painted(layout, Painting())[0])
    for y, crossed in ((3.5, True), (-3.5, True), (0.0, False)):
        line = shapely.intersection(white, shapely.box(-3, y - 0.3, 3, y + 0.3)).area
        assert (line > 0.3) == crossed


def test_a_bicycle_lies_where_each_cycle_lane_enters_a_junction(layout_of):
    section = "cycle 1.5 - | drive 3.5 - | drive 3.5 + | cycle 1.5 +"
    main = MAIN | {"width": 10.0, "section": section}
    layout = layout_of([(TEE[0], main), ([(0, -90), (0, 0), (0, 90)], {"width": 12.0})],
                       points=[((0, 0), "traffic_signals")])  # fmt: skip
    white = shapely.union_all(painted(layout, Painting(red_furten=True))[0])
    between = shapely.box(-13, -4.65, 13, -3.65), shapely.box(-13, 3.65, 13, 4.65)
    for lane, entry in zip(between, (-1, 1), strict=True):  # one rides east on the right
        symbol = shapely.intersection(white, lane)
        assert symbol.area > 0.1
        assert symbol.centroid.x * entry > 1.0


def test_lines_have_the_dashes_of_the_country(layout_of):
    layout = layout_of([([(-90, 0), (90, 0)], MAIN)])
    found = street(layout)
    partings = partings_of(found, everywhere(found), everywhere(found), (2.0, 4.0))
    (marks, _), _ = lane_lines(found, partings, closing=False)
    box = shapely.bounds(marks)
    box = box[np.argsort(box[:, 0])]
    assert np.allclose(box[:, 2] - box[:, 0], 2.0)
    assert np.allclose(np.diff(box[:, 0]), 6.0, atol=0.3)


@pytest.mark.parametrize(("width", "lined"), [(6.0, False), (7.5, True)])
def test_narrow_streets_of_one_way_have_no_line_amid_them(layout_of, width, lined):
    kind = {"kind": "tertiary", "oneway": True, "lanes": 2, "lanes_forward": 2, "width": width,
            "lane_width": width / 2}  # fmt: skip
    white, _ = painted(layout_of([([(-90, 0), (90, 0)], kind)]), Painting())
    assert (len(white) > 0) == lined


def test_stop_lines_are_as_broad_as_the_country_paints_them(layout_of):
    layout = layout_of([(TEE[0], MAIN), (TEE[1], {})])
    for breadth in (0.3, 0.5):
        (box,) = shapely.bounds(halts(layout, Painting(give_way="stop", stop_line=breadth)))
        assert box[3] - box[1] == pytest.approx(breadth)


def test_give_way_marks_end_before_lines_round_corners(layout_of):
    layout = layout_of([(TEE[0], MAIN), (TEE[1], {"width": 6.0})])
    british = Painting(give_way="double dashes", stems=True, yellow_kerbs=True)
    white, yellow = (shapely.union_all(of) for of in painted(layout, british))
    dashes = [part for part in shapely.get_parts(white) if part.bounds[3] < 0 < part.centroid.x]
    assert len(dashes) >= 6
    assert shapely.distance(shapely.union_all(dashes), yellow) > 0.05


def test_lines_are_unbroken_before_signals(layout_of):
    cross = [([(-90, 0), (0, 0), (90, 0)], WIDE), ([(0, -90), (0, 0), (0, 90)], {})]
    layout = layout_of(cross, points=[((0, 0), "traffic_signals")])
    found = street(layout)
    partings = partings_of(found, everywhere(found), everywhere(found))
    (marks, edge), centre = lane_lines(found, partings)
    lane = marks[(edge == 0) & ~centre & (shapely.get_coordinates(
        shapely.centroid(marks))[:, 1] < 0)]  # fmt: skip
    longest = max(float(np.ptp(shapely.get_coordinates(mark)[:, 0])) for mark in lane)
    assert longest == pytest.approx(SOLID)


@pytest.mark.parametrize(("signals", "arrows"), [(True, 2 * 2 * 2), (False, 0)])
def test_lanes_under_signals_get_arrows_that_no_tag_tells(layout_of, signals, arrows):
    points = [((0, 0), "traffic_signals")] if signals else []
    found = street(layout_of([(TEE[0], WIDE), ([(0, -90), (0, 0), (0, 90)], {})], points=points))
    marks, _ = lane_symbols(found, everywhere(found))
    # Two lanes arrive from each side, with arrows at two places.
    assert len(shapely.get_parts(shapely.union_all(marks))) == arrows


def test_a_stem_of_equals_gives_way_where_the_country_says_so(layout_of):
    layout = layout_of([(line, {}) for line in TEE])
    assert len(halts(layout, Painting(give_way="double dashes"))) == 0
    marks = halts(layout, Painting(give_way="double dashes", stems=True))
    marks = marks[shapely.area(marks) > ACROSS_EXIT]
    box = shapely.bounds(marks)
    assert len(marks) > 4
    assert (box[:, 3] < 0).all()  # all on the stem
    dashes = box[shapely.area(marks) < 0.13]
    assert len(np.unique(np.round(dashes[:, 1], 2))) == 2
    middle, triangle = box[shapely.area(marks) > 0.13]
    assert middle[3] - middle[1] > 1.0
    assert middle[3] < dashes[:, 1].min() - 0.5
    assert triangle[3] - triangle[1] > 3.0
    # One keeps to the right: those who arrive from the south do so east of the middle.
    assert (box[:, 0] > -0.1).all()


def test_minor_roads_of_the_americas_and_japan_have_a_word_behind_the_line(layout_of):
    layout = layout_of([(TEE[0], MAIN), (TEE[1], {"width": 7.0, "lane_width": 3.5})])
    for text in ("STOP", "止まれ"):
        marks = halts(layout, Painting(give_way="stop", stop_word=text))
        letters = shapely.union_all(marks[1:])
        assert letters.area == pytest.approx(word(text).area, rel=1e-6)
        assert letters.bounds[3] < shapely.bounds(marks[0])[1] - 1.0


def test_each_lane_that_arrives_has_its_word(layout_of):
    stem = {"section": "drive 3.5 + | drive 3.5 +", "oneway": True, "width": 7.0}
    layout = layout_of([(TEE[0], MAIN), ([(0, -90), (0, 0)], stem)])
    marks = halts(layout, Painting(give_way="stop", stop_word="STOP"))
    letters = shapely.union_all(marks[1:])
    assert letters.area == pytest.approx(2 * word("STOP").area, rel=1e-6)
    assert np.allclose(letters.centroid.x, 0.0, atol=0.1)
    assert letters.intersection(shapely.box(-0.3, -90, 0.3, 0)).is_empty


def test_the_stem_is_what_does_not_go_straight_on(layout_of):
    turned = [[(x * 0.6 - y * 0.8, x * 0.8 + y * 0.6) for x, y in line] for line in TEE]
    for lines in (TEE, turned):
        found = street(layout_of([(line, {}) for line in lines]))
        through = through_roads(found)
        assert len(through.node) == 1
        assert not through.major.any()
        ends = stems(found, through)
        assert ends.sum() == 1
        assert found.network.edge_road[np.nonzero(ends)[0]].tolist() == [1]
    star = [[(0, 0), (80 * np.cos(a), 80 * np.sin(a))] for a in np.radians([0, 120, 240])]
    found = street(layout_of([(line, {}) for line in star]))
    assert not stems(found, through_roads(found)).any()


def test_yellow_lines_follow_kerbs_without_parked_cars(layout_of):
    line = [(-80, 0), (80, 0)]
    narrow = street(layout_of([(line, {"width": 6.0})]))
    marks, _ = kerb_lines(narrow, everywhere(narrow))
    assert shapely.area(marks).sum() == pytest.approx(4 * 158 * 0.1)
    cross = street(layout_of([(each, {}) for each in TEE]))
    road = build_carriageway(cross.layout, cross.network, everywhere(cross))
    marks, _ = kerb_lines(cross, everywhere(cross))
    assert shapely.distance(marks, shapely.union_all(road.stars)).min() > 0.0
    wide = street(layout_of([(line, {"width": 9.0, "parking_left": True})]))
    marks, _ = kerb_lines(wide, everywhere(wide))
    assert shapely.area(marks).sum() == pytest.approx(158 * 0.1)  # one, at the right
    assert (shapely.bounds(marks)[:, 3] < 0).all()


def test_yellow_lines_go_round_corners_at_their_distance_from_the_kerb(layout_of):
    tight = {"kind": "tertiary", "width": 6.0}
    found = street(layout_of([(line, tight) for line in TEE]))
    road = build_carriageway(found.layout, found.network, everywhere(found))
    marks, _ = corner_lines(found, everywhere(found), road)
    surfaces = np.concatenate([road.strips, road.stars, road.curves])
    kerbs = shapely.boundary(shapely.union_all(shapely.buffer(surfaces, 0.01)))
    off = shapely.distance(shapely.centroid(marks), kerbs)
    assert (np.abs(off[:, None] - [0.25, 0.45]).min(axis=1) < 0.12).all()
    # Two lines round each of two corners of 6 m, and straight on along the other side.
    assert shapely.area(marks).sum() / 0.1 > 2 * 2 * 8 + 2 * 15
    assert not len(corner_lines(found, ~everywhere(found), road)[0])


def test_dashes_to_give_way_reach_from_the_middle_to_the_curved_kerb(layout_of):
    british = Painting(give_way="double dashes", stems=True)
    marks = halts(layout_of([(line, {}) for line in TEE]), british)
    area = shapely.area(marks)
    bounds = shapely.bounds(marks[(area > ACROSS_EXIT) & (area < 0.13)])
    assert bounds[:, 0].min() == pytest.approx(0.2, abs=0.2)
    assert bounds[:, 2].max() == pytest.approx(3.6, abs=0.4)
    # One thin row across the half of those who leave, in line with the first of the two.
    thin = shapely.bounds(marks[area < ACROSS_EXIT])
    assert thin[:, 0].min() == pytest.approx(-3.6, abs=0.4)
    assert thin[:, 2].max() == pytest.approx(-0.2, abs=0.2)
    assert np.ptp(thin[:, 3]) < 0.01
    assert thin[0, 3] == pytest.approx(bounds[:, 3].max(), abs=0.01)


def test_no_thin_row_crosses_a_mouth_that_nobody_leaves_by(layout_of):
    british = Painting(give_way="double dashes", stems=True)
    stem = ([(0, -90), (0, 0)], {"oneway": True})
    marks = halts(layout_of([(TEE[0], {}), stem]), british)
    assert (shapely.area(marks) > ACROSS_EXIT).all()
    assert len(marks) > 4


def test_a_short_arm_to_give_way_has_its_triangle(layout_of):
    british = Painting(give_way="double dashes", stems=True)
    for south, told in ((-17, True), (-15, False)):
        marks = halts(layout_of([(TEE[0], {}), ([(0, south), (0, 0)], {})]), british)
        bounds = shapely.bounds(marks)
        assert (bounds[:, 3] - bounds[:, 1] > 3.0).any() == told


def test_a_box_is_hatched_under_signals_of_classified_roads_only(layout_of):
    cross = [[(-90, 0), (0, 0), (90, 0)], [(0, -90), (0, 0), (0, 90)]]
    signals = [((0, 0), "traffic_signals")]

    def box(options, points):
        layout = layout_of([(line, options) for line in cross], points=points)
        found = street(layout)
        road = build_carriageway(layout, found.network, everywhere(found))
        return box_junctions(
            found, junction_ways(found, lane_graph(found.layout, found.network)), road
        ).polygons

    assert len(box({}, signals)) == 0
    assert len(box(MAIN, [])) == 0
    (hatch,) = box(MAIN, signals)
    assert 0.1 < hatch.area / shapely.convex_hull(hatch).area < 0.5
    assert hatch.is_valid


@pytest.mark.parametrize(
    ("place", "give_way", "stop_word", "stems", "boxes"),
    [
        ((51.51, -0.13), "double dashes", "", True, True),
        ((52.5, 13.4), "dashes", "", False, False),
        ((48.85, 2.35), "teeth", "", False, False),
        ((40.7, -74.0), "stop", "STOP", True, False),
        ((35.69, 139.78), "stop", "止まれ", True, False),
        ((-34.6, -58.4), "stop", "PARE", False, False),
    ],
)
def test_countries_paint_in_their_own_way(place, give_way, stop_word, stems, boxes):
    found = profile_of(Frame(*place)).painting
    assert (found.give_way, found.stop_word) == (give_way, stop_word)
    assert (found.stems, found.boxes, found.yellow_kerbs) == (stems, boxes, boxes)


def test_lanes_have_the_limit_that_is_told_and_quiet_one_way_streets_the_usual_one(layout_of):
    def count(**more):
        found = street(layout_of([([(0, 0), (60, 0)], {"width": 6.0, **more})]))
        return len(speed_figures(found, everywhere(found))[0])

    assert count(maxspeed_kmh=np.nan) == 0
    assert count(maxspeed_kmh=40.0) >= 2  # one on each lane
    assert count(kind="residential", oneway=True, lanes=1, maxspeed_kmh=np.nan) > 0
    assert count(kind="residential", oneway=True, lanes=1, maxspeed_kmh=37.0) == 0


def test_only_the_side_without_parked_cars_has_an_edge_line_along_its_kerb(layout_of):
    def lined(**parking):
        line = [(0, 0), (90, 0)]
        found = street(layout_of([(line, {"kind": "tertiary", "width": 9.0, **parking})]))
        return _lined(found, everywhere(found)).tolist()

    assert lined() == [[True, True]]
    assert lined(parking_left=True) == [[False, True]]


@pytest.mark.parametrize("kerbed", [[], [(40, 40, 50, 50)], [(0, 0, 3, 20)], [(0, 0, 10, 20)]])
def test_marks_of_a_flared_crossing_lie_between_kerbs_or_are_left_out(kerbed):
    marks = shapely.box([1, 4, 7], 5, [2, 5, 8], 9)
    road = SimpleNamespace(kerbed=np.array([shapely.box(*one) for one in kerbed], object))
    zebras = SimpleNamespace(flared=np.array([True]))
    edge = np.arange(3)
    (kept, _), _ = _on_road(marks, edge, np.zeros(3, np.int64), zebras, road)
    inside = shapely.union_all(shapely.buffer(road.kerbed, -KERB_GAP))
    assert list(kept) == [mark for mark in marks if shapely.covers(inside, mark)]
