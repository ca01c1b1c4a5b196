import numpy as np
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from cityx.geometry.triangle_cells import in_triangles


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


def test_no_triangle_and_no_point_is_no_error():
    vertices = np.array([(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)])
    none = np.zeros((0, 3), np.int32)
    assert not in_triangles([(0.2, 0.2)], vertices, none).any()
    assert len(in_triangles(np.zeros((0, 2)), vertices, np.array([(0, 1, 2)], np.int32))) == 0
