import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from cityx.geometry.polygons import rings_of
from cityx.geometry.solids import area_vectors, open_parts, volumes_by_group
from cityx.geometry.sweeps import SHARPEST, joints_of, profile_of, sweep

SQUARE = profile_of([(0, 0), (0.4, 0), (0.4, 0.5), (0, 0.5)])
MOULD = profile_of(
    [(-0.02, -0.6), (0.06, -0.6), (0.12, -0.3), (0.38, -0.04), (0.38, 0), (-0.02, 0)]
)


def pieces(polygon):
    rings = rings_of([polygon])
    return rings.points, rings.points[rings.following()]


def run(profile, polygon, z=10.0):
    start, end = pieces(polygon)
    return sweep(profile, start, end, np.full(len(start), z), np.zeros(len(start), int))


def test_a_band_round_a_rectangle_closes_at_its_mitres():
    solids = run(SQUARE, shapely.box(0, 0, 10, 6))
    assert not open_parts(solids, 1).any()
    ring = shapely.box(-0.4, -0.4, 10.4, 6.4).area - 60.0
    assert volumes_by_group(solids.vertices, solids.faces, solids.face_part, 1) == pytest.approx(
        [0.5 * ring]
    )
    assert len(solids.faces) == 16  # no caps


def test_inner_corners_close_as_well():
    ell = shapely.Polygon([(0, 0), (8, 0), (8, 3), (3, 3), (3, 8), (0, 8)])
    solids = run(SQUARE, ell)
    ring = ell.buffer(0.4, join_style="mitre").area - ell.area
    assert volumes_by_group(solids.vertices, solids.faces, solids.face_part, 1) == pytest.approx(
        [0.5 * ring]
    )


def test_the_ends_beside_a_neighbour_are_capped_square():
    start, end = pieces(shapely.box(0, 0, 10, 6))
    free = [0, 1]
    solids = sweep(SQUARE, start[free], end[free], np.full(2, 4.0), np.zeros(2, int))
    assert not open_parts(solids, 1).any()
    assert len(solids.faces) == 2 * 4 + 2 * 2
    assert (volumes_by_group(solids.vertices, solids.faces, solids.face_part, 1) > 0).all()


def test_bands_of_two_heights_do_not_meet():
    start, end = pieces(shapely.box(0, 0, 10, 6))
    joints = joints_of(start, end, np.array([4.0, 4.0, 5.0, 5.0]), np.zeros(4, int), (0.0, 0.4))
    assert (joints.following < 0).sum() == 2


def test_a_corner_too_sharp_for_a_mitre_ends_square():
    needle = shapely.Polygon([(0, 0), (20, 0), (20, 2)])
    start, end = pieces(needle)
    joints = joints_of(start, end, np.zeros(3), np.zeros(3, int), (0.0, 0.4))
    assert (joints.following < 0).sum() == 1
    assert np.hypot(*joints.mitre.T).max() <= 1 / np.cos(SHARPEST / 2) + 1e-9


@settings(max_examples=40, deadline=None, derandomize=True)
@given(st.integers(0, 10_000))
def test_any_outline_gets_closed_bands_whose_lines_never_turn_back(seed):
    rng = np.random.default_rng(seed)
    count = int(rng.integers(3, 16))
    angle = np.sort(rng.uniform(0, 2 * np.pi, count))
    ring = rng.uniform(2, 14, (count, 1)) * np.column_stack([np.cos(angle), np.sin(angle)])
    polygon = shapely.Polygon(ring)
    if not polygon.is_valid or polygon.area < 1.0:
        return
    solids = run(MOULD, polygon)
    assert not open_parts(solids, 1).any()
    start, end = pieces(polygon)
    k = len(MOULD.points)
    sides = solids.faces[: len(start) * k]
    ahead = solids.vertices[sides[:, 1]] - solids.vertices[sides[:, 0]]
    along = np.repeat(end - start, k, axis=0)
    assert ((ahead[:, :2] * along).sum(axis=1) > 0).all()


def test_a_convex_outline_has_bands_that_face_outward():
    solids = run(SQUARE, shapely.box(0, 0, 10, 6))
    vector = area_vectors(solids.vertices, solids.faces)
    middle = solids.vertices[solids.faces].mean(axis=1)
    outer = np.abs(middle[:, 1] + 0.4) < 1e-9
    assert (vector[outer, 1] < 0).all()
