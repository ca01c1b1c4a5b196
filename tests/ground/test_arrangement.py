from dataclasses import replace

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from cityx.city.ground import LABEL
from cityx.ground.arrangement import (
    absorb_scraps,
    arrange,
    check_arrangement,
    face_areas,
    join_regions,
    owners,
    regions,
)

SITE = (0.0, 0.0, 100.0, 80.0)
ROAD, PARK, HOUSE = LABEL["carriageway"], LABEL["park"], LABEL["building"]


def area_of(ground, label):
    return face_areas(ground)[ground.face_label == label].sum()


def test_a_site_without_regions_is_one_block():
    ground = arrange(regions([], 0, 0), SITE)
    assert check_arrangement(ground) == (0, 0, 0.0)
    assert ground.face_label.tolist() == [LABEL["block"]]
    assert len(ground.edges) == 4


def test_the_region_of_the_highest_priority_wins():
    given_ = join_regions([
        regions([shapely.box(0, 0, 60, 80)], PARK, 1, 5),
        regions([shapely.box(40, 0, 100, 80)], ROAD, 2, 6),
    ])  # fmt: skip
    ground = arrange(given_, SITE)
    assert np.isclose(area_of(ground, PARK), 40 * 80)
    assert np.isclose(area_of(ground, ROAD), 60 * 80)
    assert set(ground.face_object.tolist()) == {5, 6}


def test_a_tie_goes_to_the_lower_id_in_any_order():
    shapes = np.array([shapely.box(0, 0, 60, 80), shapely.box(40, 0, 100, 80)])
    one = arrange(regions(shapes, PARK, 1, [9, 4]), SITE)
    other = arrange(regions(shapes[::-1], PARK, 1, [4, 9]), SITE)
    area = np.bincount(one.face_object == 4, face_areas(one))
    assert np.allclose(area, [40 * 80, 60 * 80])
    for name in ("vertices", "triangles", "face_object", "edges"):
        assert np.array_equal(getattr(one, name), getattr(other, name))


def test_a_house_that_stands_apart_is_a_hole_in_its_surroundings():
    given_ = regions([shapely.box(10, 10, 20, 20), shapely.box(5, 5, 90, 70)], [HOUSE, PARK],
                     [2, 1], [1, 2])  # fmt: skip
    ground = arrange(given_, SITE)
    assert check_arrangement(ground) == (0, 0, 0.0)
    assert np.isclose(area_of(ground, HOUSE), 100.0)
    assert np.isclose(area_of(ground, PARK), 85 * 65 - 100)


def test_regions_are_cut_at_the_border():
    ground = arrange(regions([shapely.box(-50, -50, 50, 40)], PARK, 1), SITE)
    assert check_arrangement(ground) == (0, 0, 0.0)
    assert np.isclose(area_of(ground, PARK), 50 * 40)


def test_an_invalid_polygon_does_no_harm():
    bow = shapely.Polygon([(10, 10), (60, 60), (60, 10), (10, 60)])
    assert check_arrangement(arrange(regions([bow], PARK, 1), SITE)) == (0, 0, 0.0)


def test_slivers_take_the_label_of_their_longest_neighbour():
    given_ = regions([shapely.box(0, 0, 50, 80), shapely.box(50.01, 0, 100, 80)], ROAD, 1, [1, 2])
    assert set(arrange(given_, SITE).face_label.tolist()) == {ROAD}


def test_a_sliver_among_slivers_goes_where_the_longest_edges_lead():
    # Hidden rims cut a strip of 0.14 m across, 1 cm and 11 cm apart: what lies between is small.
    road, strip = shapely.box(0, 0, 100, 40), shapely.box(0, 40, 100, 40.14)
    rims = [shapely.box(10, 40, x, 70) for x in (50.0, 50.11, 50.12, 50.23)]
    found = regions([road, strip, *rims], [ROAD, LABEL["kerb"], *[PARK] * 4], [70, 60, 1, 1, 1, 1])
    ground = arrange(found, SITE)
    assert area_of(ground, LABEL["kerb"]) == pytest.approx(14.0, abs=1e-4)


def test_hidden_lines_cut_nothing_off_a_mark():
    road, mark = shapely.box(0, 0, 100, 80), shapely.box(50, 39.94, 51, 40.06)
    # Rims of surfaces below the road run across the mark, 15 cm apart.
    below = [shapely.box(10, 10, x, 70) for x in (50.4, 50.55)]
    found = regions([road, mark, *below], [ROAD, LABEL["marking"], PARK, PARK], [70, 80, 16, 16])
    assert area_of(arrange(found, SITE), LABEL["marking"]) == pytest.approx(0.12, abs=1e-3)


def test_no_mark_grows_by_a_sliver_beside_it():
    road, mark = shapely.box(0, 0, 100, 80), shapely.box(50, 39.94, 51, 40.06)
    below = shapely.Polygon([(50.2, 39.9), (50.8, 39.9), (50.5, 40.12)])
    found = regions([road, mark, below], [ROAD, LABEL["marking"], PARK], [70, 80, 16])
    assert area_of(arrange(found, SITE), LABEL["marking"]) == pytest.approx(0.12, abs=1e-3)


def test_a_scrap_among_scraps_goes_to_the_surface_around_them():
    boxes = [shapely.box(-50, -50, 50, 50), shapely.box(-40, -10, -20, 10), shapely.box(0, 0, 1, 1)]
    junction = LABEL["junction"]
    labels = [ROAD, junction, junction]
    found = regions(boxes, labels, [60, 72, 72], np.array([3, 7, 7], np.uint64))
    at = [0.3, 0.6]
    cuts = [[(a, -2), (a, 2)] for a in at] + [[(-2, a), (2, a)] for a in at]
    ground = arrange(found, (-50, -50, 50, 50), lines=shapely.linestrings(cuts))
    assert area_of(ground, junction) == pytest.approx(401.0)
    absorbed = absorb_scraps(ground, junction, 3.0, ("marking",))
    assert area_of(absorbed, junction) == pytest.approx(400.0)


@pytest.mark.parametrize("cut_off", [5.0, 15.0, 39.0])
def test_a_larger_piece_that_was_cut_off_goes_to_the_road_alone(cut_off):
    # A way of steps lies across a junction; its smaller part meets a road, a park and the steps.
    junction, steps = LABEL["junction"], LABEL["path"]
    boxes = [
        shapely.box(0, 0, 100, 80), shapely.box(30, 30, 80, 40), shapely.box(50, 29, 52, 41),
        shapely.box(52 + cut_off / 10, 28, 90, 42),
    ]  # fmt: skip
    found = regions(boxes, [PARK, junction, steps, ROAD], [16, 72, 90, 80],
                    np.array([1, 7, 2, 3], np.uint64))  # fmt: skip
    # The road takes what meets it, and then what lies behind that.
    ground = arrange(found, SITE, lines=shapely.linestrings([[(50 + k, 29), (50 + k, 41)]
                                                             for k in (2.25, 3, 5)]))  # fmt: skip
    assert area_of(ground, junction) == pytest.approx(200.0 + cut_off)
    absorbed = absorb_scraps(ground, junction, 3.0, ("marking",), ("carriageway",))
    gained = area_of(absorbed, ROAD) - area_of(ground, ROAD)
    assert area_of(absorbed, junction) == pytest.approx(200.0)
    assert gained == pytest.approx(cut_off)
    kept = absorb_scraps(ground, junction, 3.0, ("marking",))
    assert area_of(kept, junction) == pytest.approx(200.0 + cut_off)


def test_a_sliver_by_which_a_surface_touches_itself_goes_to_its_neighbour():
    # A sliver hangs on the upper box by a side and meets the lower one at a corner alone.
    upper = shapely.box(-10, 0.1, 10, 10)
    sliver = shapely.Polygon([(0, 0), (0.1, 0.1), (-0.1, 0.1)])
    lower = shapely.Polygon([(0, 0), (-5, -4), (-20, -4), (-20, 12), (-10, 12), (-10, 10),
                             (-12, 10), (-12, -3), (-6, -3), (-5, -3)])  # fmt: skip
    junction = LABEL["junction"]
    shapes = [shapely.box(-50, -50, 50, 50), upper, sliver, lower.buffer(0)]
    found = regions(shapes, [ROAD] + [junction] * 3, [60, 72, 72, 72], np.full(4, 7, np.uint64))
    cut = shapely.linestrings([[(-1, 0.1), (1, 0.1)]])
    ground = arrange(found, (-50, -50, 50, 50), lines=cut)
    before, after = (
        area_of(ground, junction),
        area_of(absorb_scraps(ground, junction, 0.0, ("marking",)), junction),
    )
    assert before - after == pytest.approx(sliver.area)


def test_an_edge_knows_the_faces_on_both_hands():
    ground = arrange(regions([shapely.box(0, 0, 50, 80)], ROAD, 1), SITE)
    inner = ground.edges[ground.edge_faces[:, 1] >= 0]
    left, right = ground.edge_faces[ground.edge_faces[:, 1] >= 0][0]
    a, b = ground.vertices[inner[0]]
    labels = [ground.face_label[left] == ROAD, ground.face_label[right] == ROAD]
    assert labels == [b[1] > a[1], b[1] < a[1]]  # the road lies west of the edge


def test_the_check_sees_a_missing_and_a_doubled_triangle():
    ground = arrange(regions([shapely.box(20, 20, 50, 50)], PARK, 1), SITE)
    inside = np.flatnonzero(ground.face_label[ground.triangle_face] == PARK)
    holed = np.setdiff1d(np.arange(len(ground.triangles)), inside)
    torn = replace(ground, triangles=ground.triangles[holed],
                   triangle_face=ground.triangle_face[holed])  # fmt: skip
    assert check_arrangement(torn)[0] == 4
    assert check_arrangement(torn)[2] > 0.1
    twice = np.r_[np.arange(len(ground.triangles)), inside[:1]]
    doubled = replace(ground, triangles=ground.triangles[twice],
                      triangle_face=ground.triangle_face[twice])  # fmt: skip
    assert check_arrangement(doubled)[1] == 1


box = st.tuples(st.floats(-20, 110), st.floats(-20, 90), st.floats(0.5, 60), st.floats(0, 3))


@settings(max_examples=25, deadline=None, derandomize=True)
@given(st.lists(box, max_size=12))
def test_any_heap_of_turned_boxes_leaves_no_gap_and_no_overlap(boxes):
    shapes = [
        shapely.affinity.rotate(shapely.box(x, y, x + size, y + size / 3), angle, use_radians=True)
        for x, y, size, angle in boxes
    ]
    ids = np.arange(1, len(shapes) + 1)
    ground = arrange(regions(shapes, PARK, ids % 3, ids), SITE)
    assert check_arrangement(ground) == (0, 0, 0.0)
    covered = shapely.intersection(shapely.unary_union(shapes), shapely.box(*SITE)).area
    assert abs(area_of(ground, PARK) - covered) < 2.0


def test_a_band_that_lines_have_cut_lengthwise_still_belongs_to_its_junction():
    junction, red = LABEL["junction"], LABEL["cycle_lane"]
    given_ = join_regions([
        regions([shapely.box(20, 0, 60, 80)], junction, 1, 5),
        regions([shapely.box(40, 0, 41.2, 80)], red, 2),
        regions([shapely.box(60, 0, 61.2, 80)], red, 2),
    ])  # fmt: skip
    cuts = [
        shapely.LineString([(40.5, 0), (40.6, 80)]),
        shapely.LineString([(60.5, 0), (60.6, 80)]),
    ]
    ground = arrange(given_, SITE, lines=cuts)
    owner = owners(ground, junction, ("cycle_lane",))
    x = np.array([ground.vertices[ground.triangles[ground.triangle_face == face]][..., 0].mean()
                  for face in range(len(owner))])  # fmt: skip
    inside = (x > 39) & (x < 42)
    assert inside.sum() >= 2
    assert (owner[inside] == 1).all()
    assert not owner[x > 60.6].any()


def test_a_rail_that_goes_on_beyond_its_junction_belongs_to_it_where_it_crosses():
    junction, rail = LABEL["junction"], LABEL["tramway"]
    setts = regions([shapely.box(0, 20, 100, 60)], LABEL["setts"], 0)
    crossed = join_regions([
        setts,
        regions([shapely.box(45, 20, 55, 60)], junction, 1, 5),
        regions([shapely.box(0, 40, 100, 40.07)], rail, 2),
    ])  # fmt: skip
    # Kerbs below cut it twice where it comes to the junction and leaves it: slivers remain.
    cuts = [shapely.LineString([(x, 39), (x, 41)]) for x in (44.99, 45.01, 54.99, 55.01)]
    ground = arrange(crossed, SITE, lines=cuts)
    owner = owners(ground, junction, ("tramway",))
    middle = [f for f in np.flatnonzero(ground.face_label == rail)
              if abs(ground.vertices[ground.triangles[ground.triangle_face == f]][..., 0].mean()
                     - 50.0) < 1.0]  # fmt: skip
    assert middle
    assert (owner[middle] == 1).all()


def test_of_regions_alike_the_same_wins_whatever_else_there_is():
    one, other = LABEL["path"], LABEL["sidewalk"]
    shapes = [shapely.box(10, 10, 30, 30), shapely.box(20, 10, 40, 30)]
    far = [shapely.box(x, y, x + 3, y + 3) for x in range(50, 400, 5) for y in range(50, 400, 5)]
    for more in ([], far):
        for labels in ((one, other), (other, one)):
            found = regions([*shapes, *more], [*labels, *[one] * len(more)], 40)
            ground = arrange(found, (0, 0, 400, 400))
            assert ground.on([(25.0, 20.0)], "path").all()
