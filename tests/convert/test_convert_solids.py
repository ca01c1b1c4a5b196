import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from cityx.city.mesh_measures import check_closed, volume
from cityx.convert.numbers import cube_generation
from cityx.convert.solids import (
    box_to_face_conversion,
    box_to_point_conversion,
    mesh_to_box_conversion,
    mesh_to_face_conversion,
    mesh_to_point_conversion,
    object_meshing,
)
from cityx.protocol.values import make_boxes

quick = settings(max_examples=30, deadline=None, derandomize=True)
SIZE = st.tuples(*[st.floats(0.5, 40)] * 3)


@quick
@given(size=SIZE, heading=st.floats(0, 6.28), x=st.floats(-1e4, 1e4), z=st.floats(-50, 50))
def test_meshed_boxes_are_closed_and_have_their_volume(size, heading, x, z):
    batch = object_meshing(make_boxes([[x, 7, z]], size, heading, object_id=3))
    assert check_closed(batch).all()
    assert volume(batch)[0] == pytest.approx(np.prod(size), rel=1e-6)
    assert batch.uv[:, 2].max() == pytest.approx(max(size), rel=1e-5)


@quick
@given(size=SIZE, heading=st.floats(0, 3.1))
def test_a_mesh_of_a_box_gives_the_box_back(size, heading):
    boxes = make_boxes([[4, 5, 6]], size, heading, object_id=3)
    again = mesh_to_box_conversion(object_meshing(boxes))
    assert again.size[0] == pytest.approx([*sorted(size[:2])[::-1], size[2]], rel=1e-6)
    assert again.base[0] == pytest.approx([4, 5, 6], abs=1e-6)


def test_the_outline_of_a_mesh_is_what_one_sees_from_above():
    boxes = make_boxes([[0, 0, 0], [20, 0, 0]], (6, 4, 9), 0.4, object_id=[3, 8])
    faces = mesh_to_face_conversion(object_meshing(boxes))
    assert shapely.area(faces.geometry).tolist() == pytest.approx([24, 24], rel=1e-4)
    assert faces.height.tolist() == pytest.approx([9, 9])
    assert faces.object_id.tolist() == [3, 8]
    base = box_to_face_conversion(boxes)
    apart = [
        a.symmetric_difference(b).area for a, b in zip(faces.geometry, base.geometry, strict=True)
    ]
    assert max(apart) < 0.01


def test_every_used_vertex_becomes_a_point_of_its_object():
    points = mesh_to_point_conversion(object_meshing(cube_generation(2.0, count=3, gap=1.0)))
    assert points.count == 24
    assert np.bincount(points.group).tolist() == [0, 8, 8, 8]


def test_boxes_become_the_centres_they_stand_on():
    points = box_to_point_conversion(make_boxes([[1, 2, 3]], (1, 1, 1), kind="crate"))
    assert points.position.tolist() == [[1, 2, 3]]
    assert points.kind.tolist() == ["crate"]
