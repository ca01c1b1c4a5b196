import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from cityx.geometry.polygons import (
    clean_polygons,
    corners,
    cut_at_waists,
    offset_points,
    polygons_of,
    rings_of,
    run_along,
    triangulate,
)

FRAME = shapely.box(0, 0, 10, 8).difference(shapely.box(3, 3, 5, 5))


def star(seed: int) -> shapely.Polygon:
    rng = np.random.default_rng(seed)
    count = int(rng.integers(3, 14))
    angle = np.sort(rng.uniform(0, 2 * np.pi, count))
    radius = rng.uniform(3, 15, count)
    return shapely.Polygon(np.column_stack([radius * np.cos(angle), radius * np.sin(angle)]))


def test_shells_run_left_and_holes_right():
    rings = rings_of([shapely.reverse(FRAME)])
    assert rings.hole.tolist() == [False, True]
    signed = [
        shapely.LinearRing(rings.points[:4]).is_ccw,
        shapely.LinearRing(rings.points[4:]).is_ccw,
    ]
    assert signed == [True, False]


def test_rings_and_polygons_are_inverse():
    shapes = shapely.orient_polygons(np.array([FRAME, shapely.Polygon(), shapely.box(0, 0, 1, 1)]))
    assert shapely.equals(polygons_of(rings_of(shapes), 3), shapes).tolist() == [True, True, True]


def test_following_and_preceding_stay_on_their_ring():
    rings = rings_of([FRAME])
    assert rings.following().tolist() == [1, 2, 3, 0, 5, 6, 7, 4]
    assert (rings.preceding()[rings.following()] == np.arange(8)).all()


@settings(max_examples=40, deadline=None, derandomize=True)
@given(st.integers(0, 10_000))
def test_triangles_cover_the_polygon_exactly(seed):
    shapes = clean_polygons([star(seed), FRAME])
    shapes = shapely.orient_polygons(shapes)
    rings = rings_of(shapes)
    mesh = triangulate(shapes, rings)
    a, b, c = (rings.points[mesh.triangles[:, i]] for i in range(3))
    area = np.bincount(mesh.polygon, np.cross(b - a, c - a) / 2, minlength=2)
    assert not mesh.failed.any()
    assert area == pytest.approx(shapely.area(shapes), rel=1e-9, abs=1e-9)


def test_a_bow_tie_is_repaired_to_its_larger_half():
    bow = shapely.Polygon([(0, 0), (4, 4), (4, 0), (0, 1)])
    cleaned = clean_polygons([bow])[0]
    assert cleaned.is_valid
    assert cleaned.geom_type == "Polygon"
    assert 0 < cleaned.area < 8


def test_outlines_without_area_or_with_nan_become_empty():
    line = shapely.Polygon([(0, 0), (5, 0), (9, 0)])
    with np.errstate(invalid="ignore"):
        broken = shapely.Polygon([(0, 0), (np.nan, 0), (1, 1)])
    assert shapely.is_empty(clean_polygons([line, broken])).all()


def test_points_on_a_straight_line_are_no_corners():
    shape = shapely.Polygon([(0, 0), (5, 0.02), (10, 0), (10, 8), (0, 8)])
    assert corners(rings_of([shape])).sum() == 4


def test_a_finely_drawn_circle_keeps_its_points():
    circle = shapely.Point(0, 0).buffer(20, quad_segs=40)
    assert corners(rings_of([circle])).sum() == 160


def test_run_along_starts_again_on_every_ring():
    run = run_along(rings_of([FRAME]))
    assert run[[0, 4, 5, 6, 7]].tolist() == pytest.approx([0, 0, 2, 4, 6])


def test_an_offset_square_grows_on_every_side():
    rings = rings_of([shapely.box(0, 0, 4, 4)])
    points, sound = offset_points(rings, np.full(4, 0.5))
    assert sound.all()
    assert shapely.Polygon(points).bounds == pytest.approx((-0.5, -0.5, 4.5, 4.5))


def test_an_offset_that_turns_an_edge_round_is_unsound():
    notch = shapely.Polygon([(0, 0), (10, 0), (10, 10), (5.1, 10), (5, 10.1), (4.9, 10), (0, 10)])
    _, sound = offset_points(rings_of([notch]), np.full(7, -1.0))
    assert not sound.any()


def test_of_several_pieces_the_largest_is_kept():
    both = shapely.MultiPolygon([shapely.box(0, 0, 1, 1), shapely.box(2, 0, 5, 3)])
    assert clean_polygons([both])[0].area == 9.0


def test_an_outline_that_almost_touches_itself_is_snapped_open_or_shut():
    slit = shapely.box(0, 0, 9, 9).difference(shapely.box(0, 4, 8, 4.002))
    cleaned = clean_polygons([slit])[0]
    assert cleaned.is_valid
    assert shapely.minimum_clearance(cleaned) > 0.005


def test_a_waist_of_a_millimetre_is_cut_and_nothing_is_lost():
    hourglass = shapely.Polygon([(0, 0), (9, 0), (4.5003, 5), (9, 10), (0, 10), (4.4998, 5)])
    cut = cut_at_waists(np.array([hourglass, FRAME], object))
    pieces = clean_polygons(shapely.get_parts(cut[0]))
    assert shapely.area(pieces).sum() == pytest.approx(hourglass.area, rel=0.001)
    assert len(pieces) == 2
    assert shapely.equals_exact(cut[1], FRAME)
