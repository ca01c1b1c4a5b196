import numpy as np
import pytest
import shapely

from cityx.geometry.convex import (
    THIN,
    Box,
    Cylinder,
    Hull,
    box_round,
    convex_pieces,
    fewer_corners,
    hull_of,
    hulls_round,
    pieces_of_mesh,
    simplest,
    upright_hulls,
)
from cityx.geometry.extrude import prisms
from cityx.geometry.solids import as_quads, volumes_by_group

CUBE = np.array([[i, j, k] for i in (0, 1) for j in (0, 1) for k in (0, 1)], float)
ELL = shapely.Polygon([(0, 0), (20, 0), (20, 6), (6, 6), (6, 18), (0, 18)])
YARD = shapely.box(0, 0, 30, 20).difference(shapely.box(8, 8, 20, 14))
STAR = shapely.Polygon(
    [((9, 4)[i % 2] * np.cos(i * np.pi / 8), (9, 4)[i % 2] * np.sin(i * np.pi / 8))
     for i in range(16)]
)  # fmt: skip


def turned(points, angle):
    c, s = np.cos(angle), np.sin(angle)
    return points @ np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]])


def ring(sides, radius, height):
    angle = np.arange(sides) * 2 * np.pi / sides
    flat = radius * np.column_stack([np.cos(angle), np.sin(angle), 0 * angle])
    return np.concatenate([flat, flat + np.array([0, 0, height])])


def ball(count):
    points = np.random.default_rng(3).normal(size=(count, 3))
    return points / np.linalg.norm(points, axis=1)[:, None]


def test_a_hull_holds_its_points_and_tells_what_is_outside():
    hull = hull_of([*CUBE, (0.5, 0.5, 0.5)])
    assert len(hull.points) == 8
    assert hull.volume == pytest.approx(1.0)
    np.testing.assert_allclose(
        hull.outside(np.array([(0.5, 0.5, 0.9), (0.5, 0.5, 3.0)])), [-0.1, 2.0], atol=1e-9
    )


@pytest.mark.parametrize("flat", [CUBE[:1], CUBE[:2], CUBE[CUBE[:, 2] == 0]])
def test_what_is_flat_gets_a_thickness(flat):
    hull = hull_of(flat)
    assert hull.volume > 0
    assert np.ptp(hull.points[:, 2]).min() >= THIN - 1e-9
    assert hull.outside(flat).max() < 0


@pytest.mark.parametrize("size", [(1, 1, 1), (0.2, 12, 3)])
def test_a_hull_in_few_corners_holds_the_one_of_many(size):
    points = ball(600) * size
    hull = hull_of(points)
    few = fewer_corners(hull)
    assert len(few.points) < len(hull.points) / 3
    assert few.outside(points).max() < 1e-5
    assert few.volume < 1.25 * hull.volume


def test_a_turned_beam_is_taken_for_a_box_of_its_size():
    box = simplest(hull_of(turned(CUBE * (6, 2, 1), 0.3)))
    assert isinstance(box, Box)
    np.testing.assert_allclose(box.half, (3, 1, 0.5))
    assert box.yaw == pytest.approx(0.3)
    assert hull_of(box.corners()).outside(turned(CUBE * (6, 2, 1), 0.3)).max() < 1e-6


def test_a_box_needs_no_turn_where_its_sides_lie_along_the_axes():
    box = box_round(CUBE * (2, 5, 1))
    assert box.yaw == pytest.approx(0.0)
    np.testing.assert_allclose(box.half, (1, 2.5, 0.5))


def test_a_post_of_eight_sides_is_taken_for_a_cylinder_and_a_square_one_for_a_box():
    post = simplest(hull_of(ring(8, 0.1, 4)))
    assert isinstance(post, Cylinder)
    assert (post.radius, post.half_height) == (pytest.approx(0.1), 2.0)
    assert isinstance(simplest(hull_of(ring(4, 0.1, 4))), Box)


def test_a_wedge_stays_a_hull():
    wedge = hull_of(CUBE[[0, 1, 2, 4, 5, 6]])
    assert isinstance(simplest(wedge), Hull)


def test_a_mast_and_its_arm_stay_apart_and_the_planks_of_a_seat_become_one():
    mast, arm = CUBE * (0.2, 0.2, 8), CUBE * (3, 0.1, 0.1) + (0, 0, 7.9)
    assert len(hulls_round([mast, arm], most=4, slack=0.04)) == 2
    planks = [CUBE * (1.8, 0.1, 0.04) + (0, 0.12 * row, 0.4) for row in range(4)]
    (seat,) = hulls_round(planks, most=4, slack=0.2)
    assert seat.volume == pytest.approx(1.8 * 0.46 * 0.04)


def test_no_more_hulls_are_made_than_asked_and_they_hold_every_piece():
    pieces = [CUBE + np.array([3 * i, 5 * (i % 2), 0]) for i in range(6)]
    hulls = hulls_round(pieces, most=2, slack=0.0)
    assert len(hulls) == 2
    outside = np.min([hull.outside(np.concatenate(pieces)) for hull in hulls], axis=0)
    assert outside.max() < 1e-9


def hulls_of_shell(vertices, faces):
    (hulls,) = upright_hulls(vertices, faces, np.zeros(len(faces), np.int64), 1)
    return hulls


def raised(*shapes, height=9.0):
    count = len(shapes)
    solids, failed = prisms(
        np.array(shapes, object), np.zeros(count), np.full(count, height), np.zeros(count)
    )
    assert not failed.any()
    return solids.vertices, solids.faces


@pytest.mark.parametrize("shape", [shapely.box(0, 0, 4, 3), ELL, YARD, STAR])
def test_pieces_are_convex_and_cover_the_polygon_once(shape):
    pieces = [shapely.Polygon(ring) for ring in convex_pieces([shape])[0]]
    assert sum(piece.area for piece in pieces) == pytest.approx(shape.area)
    assert shapely.union_all(pieces).symmetric_difference(shape).area < 1e-6
    assert all(piece.convex_hull.area < piece.area + 1e-6 for piece in pieces)


def test_an_l_needs_two_pieces_and_a_star_of_eight_points_at_most_nine():
    assert len(convex_pieces([ELL])[0]) == 2
    assert len(convex_pieces([STAR])[0]) <= 9
    assert convex_pieces([shapely.Polygon(), ELL])[0] == []


@pytest.mark.parametrize("shape", [ELL, YARD, STAR])
def test_hulls_of_a_prism_fill_it_and_nothing_else(shape):
    vertices, faces = raised(shape)
    hulls = hulls_of_shell(vertices, faces)
    assert sum(hull.volume for hull in hulls) == pytest.approx(9.0 * shape.area, rel=0.03)
    assert np.min([hull.outside(vertices) for hull in hulls], axis=0).max() < 0.02


def test_houses_that_do_not_touch_are_pieces_of_their_own():
    vertices, faces = raised(shapely.box(0, 0, 5, 5), shapely.box(9, 0, 12, 5))
    assert [len(rows) for rows in pieces_of_mesh(vertices, faces)] == [8, 8]
    assert len(hulls_of_shell(vertices, faces)) == 2


def test_a_ridge_over_an_l_is_kept_where_the_plan_is_cut():
    """Two gabled wings that meet: hulls go up to the ridge along both, not to a lid."""
    foot = np.array([(0, 0), (20, 0), (20, 6), (6, 6), (6, 18), (0, 18)], float)
    ridge = np.array([(20, 3), (3, 3), (3, 18)], float)
    top = np.concatenate([np.column_stack([foot, np.full(6, 6.0)]),
                          np.column_stack([ridge, np.full(3, 9.0)])])  # fmt: skip
    vertices = np.concatenate([np.column_stack([foot, np.zeros(6)]), top])  # 0-5, 6-11, 12-14
    floor = [(0, 2, 1), (0, 3, 2), (0, 4, 3), (0, 5, 4)]
    walls = [(i, (i + 1) % 6, 6 + (i + 1) % 6, 6 + i) for i in range(6)]
    roof = [(6, 7, 12, 13), (9, 13, 12, 8), (10, 14, 13, 9), (6, 13, 14, 11)]
    gables = as_quads(np.array([(8, 12, 7), (11, 14, 10)]))
    faces = np.concatenate([as_quads(np.array(floor)), np.array(walls), np.array(roof), gables])
    held = float(volumes_by_group(vertices, faces, np.zeros(len(faces), np.int64), 1)[0])
    hulls = hulls_of_shell(vertices, faces)
    assert sum(hull.volume for hull in hulls) == pytest.approx(held)
    assert hull_of(vertices).volume > 1.5 * held
    assert np.min([hull.outside(vertices) for hull in hulls], axis=0).max() < 0.02
