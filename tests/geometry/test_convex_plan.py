import numpy as np
import pytest
import shapely

from cityx.geometry.convex import convex_pieces, hull_of, pieces_of_mesh, upright_hulls
from cityx.geometry.extrude import prisms
from cityx.geometry.solids import as_quads, volumes_by_group

ELL = shapely.Polygon([(0, 0), (20, 0), (20, 6), (6, 6), (6, 18), (0, 18)])
YARD = shapely.box(0, 0, 30, 20).difference(shapely.box(8, 8, 20, 14))
STAR = shapely.Polygon(
    [((9, 4)[i % 2] * np.cos(i * np.pi / 8), (9, 4)[i % 2] * np.sin(i * np.pi / 8))
     for i in range(16)]
)  # fmt: skip


def raised(*shapes, height=9.0):
    count = len(shapes)
    solids, failed = prisms(
        np.array(shapes, object), np.zeros(count), np.full(count, height), np.zeros(count)
    )
    assert not failed.any()
    return solids.vertices, solids.faces


@pytest.mark.parametrize("shape", [shapely.box(0, 0, 4, 3), ELL, YARD, STAR])
def test_pieces_are_convex_and_cover_the_polygon_once(shape):
    pieces = [shapely.Polygon(ring) for ring in convex_pieces(shape)]
    assert sum(piece.area for piece in pieces) == pytest.approx(shape.area)
    assert shapely.union_all(pieces).symmetric_difference(shape).area < 1e-6
    assert all(piece.convex_hull.area < piece.area + 1e-6 for piece in pieces)


def test_an_l_needs_two_pieces_and_a_star_of_eight_points_at_most_nine():
    assert len(convex_pieces(ELL)) == 2
    assert len(convex_pieces(STAR)) <= 9
    assert convex_pieces(shapely.Polygon()) == []


@pytest.mark.parametrize("shape", [ELL, YARD, STAR])
def test_hulls_of_a_prism_fill_it_and_nothing_else(shape):
    vertices, faces = raised(shape)
    hulls = upright_hulls(vertices, faces)
    assert sum(hull.volume for hull in hulls) == pytest.approx(9.0 * shape.area, rel=0.03)
    assert np.min([hull.outside(vertices) for hull in hulls], axis=0).max() < 0.02


def test_houses_that_do_not_touch_are_pieces_of_their_own():
    vertices, faces = raised(shapely.box(0, 0, 5, 5), shapely.box(9, 0, 12, 5))
    assert [len(rows) for rows in pieces_of_mesh(vertices, faces)] == [8, 8]
    assert len(upright_hulls(vertices, faces)) == 2


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
    hulls = upright_hulls(vertices, faces)
    assert sum(hull.volume for hull in hulls) == pytest.approx(held)
    assert hull_of(vertices).volume > 1.5 * held
    assert np.min([hull.outside(vertices) for hull in hulls], axis=0).max() < 0.02
