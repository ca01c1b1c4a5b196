import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from cityx.building.roofs.roof_meshes import (
    bend_mesh,
    crossed_mesh,
    cut_mesh,
    edge_slopes,
    flat_mesh,
    raised,
)
from cityx.building.roofs.roof_skeletons import skeleton_roofs
from cityx.geometry.polygons import clean_polygons
from cityx.geometry.solids import open_parts, volumes_by_group

ELL = shapely.Polygon([(0, 0), (14, 0), (14, 6), (6, 6), (6, 16), (0, 16)])
ONE = np.ones(1)


def star(seed):
    rng = np.random.default_rng(seed)
    count = int(rng.integers(3, 14))
    angle = np.sort(rng.uniform(0, 2 * np.pi, count))
    ring = rng.uniform(3, 15, (count, 1)) * np.column_stack([np.cos(angle), np.sin(angle)])
    return clean_polygons([shapely.Polygon(ring)])[0]


def plan_area(mesh):
    a, b, c = (mesh.points[mesh.faces[:, k], :2] for k in range(3))
    return np.cross(b - a, c - a).sum() / 2


@settings(max_examples=40, deadline=None, derandomize=True)
@given(st.integers(0, 10_000), st.floats(0, 6.2), st.floats(-4, 4))
def test_cuts_keep_the_plan_and_leave_no_triangle_on_both_sides(seed, angle, offset):
    shape = star(seed)
    if shape.is_empty:
        return
    mesh = flat_mesh(np.array([shape], object), ONE * 5.0)
    direction = np.array([np.cos(angle), np.sin(angle)])
    cut = cut_mesh(mesh, mesh.points[:, :2] @ direction - offset)
    assert plan_area(cut) == pytest.approx(shape.area, rel=1e-6)
    value = (cut.points[:, :2] @ direction - offset)[cut.faces]
    assert not ((value.min(axis=1) < -0.02) & (value.max(axis=1) > 0.02)).any()
    solids = raised(cut, 0 * ONE, 0 * ONE)
    assert not open_parts(solids, 1).any()
    assert volumes_by_group(solids.vertices, solids.faces, solids.face_part, 1) == pytest.approx(
        [5.0 * shape.area], rel=1e-6
    )


@settings(max_examples=25, deadline=None, derandomize=True)
@given(st.integers(0, 10_000))
def test_bent_and_crossed_roofs_are_closed_over_any_outline(seed):
    shapes = np.array([star(seed), ELL], object)
    two = np.ones(2)
    bent = bend_mesh(
        skeleton_roofs(shapes, 6 * two, 3 * two), 6 * two, 3 * two,
        np.tile([0.0, 0.2, 0.6, 1.0], (2, 1)), np.tile([0.0, 0.7, 0.9, 1.0], (2, 1)),
    )  # fmt: skip
    for mesh in (bent, crossed_mesh(shapes, 0.3 * two, 6 * two, 3 * two)):
        solids = raised(mesh, 0 * two, 0 * two)
        assert not open_parts(solids, 2).any()
        assert solids.vertices[:, 2].max() <= 9.0 + 1e-9


def test_a_bend_moves_points_to_its_heights_and_keeps_eaves_and_ridge():
    mesh = skeleton_roofs(np.array([ELL], object), 6 * ONE, 3 * ONE)
    knots, heights = np.array([[0.0, 0.5, 1.0]]), np.array([[0.0, 0.8, 1.0]])
    bent = bend_mesh(mesh, 6 * ONE, 3 * ONE, knots, heights)
    z = np.unique(bent.points[:, 2].round(6))
    assert z[0] == 6.0
    assert z[-1] == 9.0
    assert 8.4 in z


def test_the_slope_beside_an_eave_is_that_of_its_face():
    mesh = skeleton_roofs(np.array([ELL], object), 6 * ONE, 3 * ONE)
    slope = edge_slopes(mesh)
    vector = mesh.rings.points[mesh.rings.following()] - mesh.rings.points
    normal = np.column_stack([vector[:, 1], -vector[:, 0]])
    normal /= np.hypot(*vector.T)[:, None]
    assert (slope * normal).sum(axis=1) == pytest.approx(np.full(6, -1.0))
