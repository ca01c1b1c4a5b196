import numpy as np
import pytest
import shapely
import shapely.affinity
from hypothesis import given, settings
from hypothesis import strategies as st

from cityx.geometry.extrude import prisms
from cityx.geometry.polygons import clean_polygons
from cityx.geometry.solids import ROOF, WALL, open_parts, volumes_by_group


def raised(shapes, height=5.0):
    shapes = np.array(shapes, dtype=object)
    count = len(shapes)
    return prisms(shapes, np.zeros(count), np.full(count, height), np.zeros(count))


def volumes(solids, count):
    return volumes_by_group(solids.vertices, solids.faces, solids.face_part, count)


@settings(max_examples=30, deadline=None, derandomize=True)
@given(st.integers(0, 10_000))
def test_prisms_are_closed_and_hold_area_times_height(seed):
    rng = np.random.default_rng(seed)
    count = int(rng.integers(3, 12))
    angle = np.sort(rng.uniform(0, 2 * np.pi, count))
    ring = rng.uniform(2, 12, (count, 1)) * np.column_stack([np.cos(angle), np.sin(angle)])
    shapes = clean_polygons([shapely.Polygon(ring), shapely.box(0, 0, 3, 4)])
    solids, failed = raised(shapes)
    assert (failed == shapely.is_empty(shapes)).all()
    assert not open_parts(solids, 2).any()
    assert volumes(solids, 2) == pytest.approx(shapely.area(shapes) * 5.0)


def test_a_courtyard_stays_open():
    yard = shapely.box(0, 0, 10, 10).difference(shapely.box(4, 4, 6, 6))
    solids, _ = raised([yard])
    assert volumes(solids, 1) == pytest.approx([96 * 5.0])


def test_a_courtyard_that_touches_the_outline_still_closes():
    corner = shapely.Polygon([(0, 0), (9, 0), (9, 9), (0, 9)], [[(0, 0), (4, 2), (2, 4)]])
    edge = shapely.Polygon([(0, 0), (9, 0), (9, 9), (0, 9)], [[(4, 0), (6, 2), (2, 4)]])
    solids, failed = raised([corner, edge])
    assert not failed.any()
    assert not open_parts(solids, 2).any()


def test_a_wide_outline_with_a_courtyard_at_a_corner_closes_too():
    shell = [(-1052, -1041), (-931, -1030), (1103, 1058), (-957, -949), (-971, -1006),
             (-982.633, -1009.019), (-963, -955)]  # fmt: skip
    holes = [[(-1021, -1018.2), (-982.633, -1009.019), (-986, -1018.2)],
             [(-945, -992), (-945, -1016), (-961, -1016), (-961, -992)]]  # fmt: skip
    outline = shapely.Polygon(shell, holes)
    assert outline.is_valid
    solids, failed = raised([outline])
    assert not failed.any()
    assert volumes(solids, 1) == pytest.approx([outline.area * 5.0], rel=0.002)


def test_wall_texture_runs_round_the_corners_in_metres():
    solids, _ = raised([shapely.box(0, 0, 4, 3)])
    walls = solids.uv[solids.role == WALL][:4]
    assert walls[:, 0, 0].tolist() == pytest.approx([0, 3, 7, 10])
    assert walls[:, 1, 0].tolist() == pytest.approx([3, 7, 10, 14])
    assert walls[:, 2, 1].tolist() == [5.0] * 4


def test_roof_texture_lies_along_the_longest_edge():
    turned = shapely.affinity.rotate(shapely.box(0, 0, 10, 2), 30, origin=(0, 0))
    solids, _ = raised([turned])
    top = solids.uv[solids.role == ROOF][:, :3].reshape(-1, 2)
    assert np.ptp(top, axis=0) == pytest.approx([10, 2], abs=1e-4)


def test_an_empty_outline_fails_alone():
    solids, failed = raised([shapely.Polygon(), shapely.box(0, 0, 1, 1)])
    assert failed.tolist() == [True, False]
    assert set(solids.face_part.tolist()) == {1}
