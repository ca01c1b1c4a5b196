import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from cityx.geometry import triangle_cells
from cityx.geometry.triangle_cells import (
    CELL,
    MOST_CELLS,
    cells_of_triangles,
    in_triangles,
    near_boxes,
    reaching,
    triangles_at,
)


@given(seed=st.integers(0, 10_000), size=st.floats(1.0, 900.0))
@settings(max_examples=30, deadline=None, derandomize=True)
def test_points_are_found_in_the_triangles_that_hold_them(seed, size):
    rng = np.random.default_rng(seed)
    vertices = rng.uniform(-size, size, (60, 2))
    triangles = rng.integers(0, 60, (25, 3)).astype(np.int32)
    points = np.concatenate([rng.uniform(-size, size, (200, 2)), vertices[triangles[:3, 0]]])
    shapes = shapely.polygons(vertices[triangles])
    solid = shapely.area(shapes) > 1e-9
    wanted = shapely.intersects(shapes[solid][None], shapely.points(points)[:, None]).any(axis=1)
    assert np.array_equal(in_triangles(points, vertices, triangles[solid]), wanted)


@given(seed=st.integers(0, 10_000), reach=st.integers(2, 400))
@settings(max_examples=60, deadline=None, derandomize=True)
def test_sides_and_points_on_the_borders_of_cells_are_found_exactly(seed, reach):
    """Corners and points lie on half cells, so that sides are level and points lie on them."""
    rng = np.random.default_rng(seed)
    corner = rng.integers(-reach, reach + 1, (40, 2))
    triangles = rng.integers(0, 40, (30, 3)).astype(np.int32)
    spots = np.concatenate([rng.integers(-reach, reach + 1, (200, 2)), corner])
    a, b, c = corner[triangles].transpose(1, 0, 2)[:, None]  # (1, t, 2) each, whole numbers
    at = spots[:, None]

    def side(p, q):
        u, v = q - p, at - p
        return u[..., 0] * v[..., 1] - u[..., 1] * v[..., 0]

    turns = np.stack([side(a, b), side(b, c), side(c, a)])
    held = (turns >= 0).all(axis=0) | (turns <= 0).all(axis=0)
    low, high = np.minimum(np.minimum(a, b), c), np.maximum(np.maximum(a, b), c)
    held &= ((low <= at) & (at <= high)).all(axis=2)
    step = CELL / 2
    prepared = cells_of_triangles(corner * step, triangles)
    pairs = [np.column_stack(found) for found in triangles_at(spots * step, prepared)]
    found = np.concatenate(pairs)
    assert np.array_equal(np.unique(found, axis=0), np.argwhere(held))
    assert len(found) == held.sum()  # each once


@pytest.mark.parametrize("lone", [False, True])
def test_many_points_are_found_as_few_are(monkeypatch, lone):
    """By a compiled kernel: the same pairs, with corners and borders of cells among the points."""
    rng = np.random.default_rng(4)
    corner = np.concatenate([rng.integers(-60, 61, (90, 2)), rng.integers(-2000, 2001, (10, 2))])
    triangles = rng.integers(0, 100, (80, 3)).astype(np.int32)
    spots = np.concatenate([rng.integers(-60, 61, (3000, 2)), corner]) * (CELL / 2)
    prepared = cells_of_triangles((corner * (CELL / 2)).astype(np.float32 if lone else float),
                                  triangles)  # fmt: skip
    among = None if lone else rng.random(80) < 0.5

    def pairs():
        found = [np.column_stack(some) for some in triangles_at(spots, prepared, among)]
        return np.unique(np.concatenate(found), axis=0)

    few = pairs()
    monkeypatch.setattr(triangle_cells, "MANY", 1)
    assert np.array_equal(pairs(), few)
    assert len(few) > len(spots)  # more than there is room for at first


@given(seed=st.integers(0, 10_000), reach=st.integers(2, 2000))
@settings(max_examples=40, deadline=None, derandomize=True)
def test_many_triangles_meet_the_cells_that_few_do(seed, reach):
    """By compiled kernels: corners lie on half cells, sides are level, and some are needles."""
    rng = np.random.default_rng(seed)
    corner = rng.integers(-reach, reach + 1, (60, 2)) * (CELL / 2)
    triangles = rng.integers(0, 60, (40, 3)).astype(np.int32)
    few = cells_of_triangles(corner, triangles)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(triangle_cells, "MANY", 1)
        many = cells_of_triangles(corner, triangles)
    assert np.array_equal(few.boxes, many.boxes)
    for one, other in zip(few.levels, many.levels, strict=True):
        assert (one.size, one.rows) == (other.size, other.rows)
        for name in ("low", "cell", "start", "triangle"):
            assert np.array_equal(getattr(one, name), getattr(other, name))


@pytest.mark.parametrize("kind", [np.float32, np.float64])
@pytest.mark.parametrize("rise", [0.0, 2e-6, 0.4, 40.0, -37.3])
@pytest.mark.parametrize("reach", [30.0, 60.0, 700.0, 30_000.0])
def test_needles_are_found_along_all_their_length(kind, rise, reach):
    """Of different sizes, so that they are looked up by cells of different sizes."""
    vertices = np.array([(-reach, 0.7), (reach, 0.7 + rise), (-reach, 0.75)], kind)
    triangles = np.array([(0, 1, 2)], np.int32)
    first, second, third = vertices.astype(float)
    share = np.linspace(0.01, 0.99, 500)[:, None]
    points = (first + third) / 2 * (1 - share) + second * share
    assert in_triangles(points, vertices, triangles).all()
    assert not in_triangles(points + np.array([0.0, 1.0]), vertices, triangles).any()


def test_each_triangle_is_looked_up_by_cells_of_one_size_and_by_few():
    rng = np.random.default_rng(3)
    sizes = 10.0 ** rng.uniform(-1, 4, 300)
    vertices = (rng.uniform(-1, 1, (300, 3, 2)) * sizes[:, None, None]).reshape(-1, 2)
    triangles = np.arange(900, dtype=np.int32).reshape(-1, 3)
    levels = cells_of_triangles(vertices, triangles).levels
    assert len(levels) > 3
    assert np.array_equal(
        np.sort(np.concatenate([np.unique(level.triangle) for level in levels])), np.arange(300)
    )
    for level in levels:
        assert np.bincount(level.triangle).max() <= MOST_CELLS
        assert (np.diff(level.cell) > 0).all()


def test_no_triangle_and_no_point_is_no_error():
    vertices = np.array([(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)])
    none = np.zeros((0, 3), np.int32)
    assert not in_triangles([(0.2, 0.2)], vertices, none).any()
    assert len(in_triangles(np.zeros((0, 2)), vertices, np.array([(0, 1, 2)], np.int32))) == 0


def test_shapes_near_boxes_are_all_that_meet_one_and_few_others():
    rng = np.random.default_rng(3)
    corners = rng.uniform(-200, 200, (400, 1, 2)) + rng.uniform(-4, 4, (400, 3, 2))
    low = rng.uniform(-200, 200, (30, 2))
    boxes = np.concatenate([low, low + rng.uniform(0, 9, (30, 2))], axis=1)
    found = near_boxes(corners.reshape(-1, 2), np.arange(1200).reshape(-1, 3), boxes, 5.0)
    bounds = shapely.box(*np.concatenate([corners.min(axis=1), corners.max(axis=1)], axis=1).T)
    met = np.unique(shapely.STRtree(bounds).query(shapely.box(*boxes.T), "intersects")[1])
    assert set(met) <= set(found)
    assert len(found) < 4 * len(met)
    assert len(near_boxes(corners.reshape(-1, 2), np.zeros((0, 3), int), boxes, 5.0)) == 0


def test_shapes_reach_a_box_if_theirs_meets_it():
    rng = np.random.default_rng(3)
    points = np.round(rng.uniform(-5, 5, (60, 2)), 1)
    corners = rng.integers(0, 60, (200, 3)).astype(np.int32)
    box = (-1.0, -0.5, 1.5, points[7, 1])
    low, high = points[corners].min(axis=1), points[corners].max(axis=1)
    met = ((low <= box[2:]) & (high >= box[:2])).all(axis=1)
    assert 0 < np.count_nonzero(met) < 200
    assert np.array_equal(reaching(points, corners, box), met)
