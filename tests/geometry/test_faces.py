import itertools

import numpy as np
import shapely

from cityx.geometry.faces import OUTSIDE, doubled_areas, trace_faces
from cityx.geometry.noding import FINE, snap_round


def faces_of(*rings):
    lines = [np.array(pair) for ring in rings for pair in itertools.pairwise(ring)]
    spots = np.array(lines) * FINE
    return trace_faces(*snap_round(spots[:, 0], spots[:, 1]))


def box(x, y, size):
    return [(x, y), (x + size, y), (x + size, y + size), (x, y + size), (x, y)]


def areas(faces):
    triangles, face = faces.triangles()
    area = doubled_areas(faces.points, triangles)
    assert (area > 0).all()
    return (np.bincount(face, area) / 2).tolist()


def test_an_island_in_an_island_is_cut_out_of_what_lies_around_it():
    faces = faces_of(box(0, 0, 20), box(2, 2, 10), box(4, 4, 3))
    assert areas(faces) == [300.0, 91.0, 9.0]
    shapes = faces.polygons(np.arange(3))
    assert shapely.get_num_interior_rings(shapes).tolist() == [1, 1, 0]


def test_a_hole_that_touches_its_shell_at_a_corner_is_a_ring_of_its_own():
    faces = faces_of(box(0, 0, 20), [(0, 10), (5, 5), (5, 15), (0, 10)])
    assert faces.count == 2
    assert shapely.is_valid(faces.polygons(np.arange(2))).all()
    assert areas(faces) == [375.0, 25.0]


def test_islands_that_touch_in_a_corner_are_two_holes():
    faces = faces_of(box(0, 0, 30), box(5, 5, 5), box(10, 10, 5))
    assert areas(faces) == [850.0, 25.0, 25.0]
    assert shapely.is_valid(faces.polygons(np.arange(3))).all()


def test_lines_that_bound_nothing_are_left_out():
    whisker = [(5, 5), (8, 8), (12, 8)]
    bridge = [(10, 20), (10, 25)]
    faces = faces_of(box(0, 0, 20), whisker, bridge, box(5, 25, 10))
    assert areas(faces) == [400.0, 100.0]
    assert len(faces.points) == len(faces.edges) == 10  # the bridge has cut two sides


def test_an_edge_knows_its_faces_and_runs_round_what_is_outermost():
    faces = faces_of(box(0, 0, 10), box(10, 0, 10))
    inner = (faces.edge_faces != OUTSIDE).all(axis=1)
    assert faces.points[faces.edges[inner][0]].tolist() == [[10, 0], [10, 10]]
    assert faces.edge_faces[inner].tolist() == [[0, 1]]
    assert (faces.edge_faces[~inner, 1] == OUTSIDE).all()
    ends = faces.points[faces.edges[~inner]]
    assert (np.cross(ends[:, 0] - (10, 5), ends[:, 1] - (10, 5)) > 0).all()


def test_a_dented_quadrilateral_is_cut_at_its_dent():
    faces = faces_of([(0, 0), (10, 0), (3, 3), (0, 10), (0, 0)])
    assert areas(faces) == [30.0]
    assert len(faces.triangles()[0]) == 2


def test_a_quadrilateral_is_cut_as_delaunay_would():
    rng = np.random.default_rng(5)
    for _ in range(20):
        turn = np.sort(rng.uniform(0, 2 * np.pi, 4))
        ring = np.rint(np.column_stack([np.cos(turn), np.sin(turn)]) * rng.uniform(20, 90, (4, 1)))
        shape = shapely.Polygon(ring)
        if not shape.is_valid or shape.area < 50 or not shape.exterior.is_ccw:
            continue
        faces = faces_of([*map(tuple, ring.astype(int)), tuple(ring[0].astype(int))])
        cut, _ = faces.triangles()
        mine = {frozenset(map(tuple, faces.points[row].tolist())) for row in cut}
        theirs = shapely.get_parts(shapely.constrained_delaunay_triangles(shape))
        assert mine == {
            frozenset((int(x), int(y)) for x, y in shapely.get_coordinates(one)) for one in theirs
        }
