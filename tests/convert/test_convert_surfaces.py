import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from cityx.city.mesh_measures import check_closed, volume
from cityx.convert.images import image_to_point_conversion
from cityx.convert.points import point_to_face_conversion
from cityx.convert.surfaces import (
    face_to_box_conversion,
    face_to_image_conversion,
    face_to_layout_conversion,
    face_to_line_conversion,
    face_to_point_conversion,
    face_to_solid_conversion,
)
from cityx.protocol.example_city import example_city
from cityx.protocol.values import make_surfaces

quick = settings(max_examples=30, deadline=None, derandomize=True)
YARD = shapely.Polygon([(0, 0), (20, 0), (20, 12), (0, 12)], [[(5, 4), (5, 8), (15, 8), (15, 4)]])


@quick
@given(
    corners=st.lists(st.tuples(st.floats(-50, 50), st.floats(-50, 50)), min_size=3, max_size=9),
    height=st.floats(0.5, 80),
)
def test_solids_are_closed_and_have_area_times_height(corners, height):
    hull = shapely.convex_hull(shapely.MultiPoint(np.round(corners, 2).tolist()))
    if hull.geom_type != "Polygon" or hull.area < 0.5:
        return
    batch = face_to_solid_conversion(make_surfaces([hull], "", height, 5))
    assert check_closed(batch).all()
    assert volume(batch)[0] == pytest.approx(hull.area * height, rel=1e-6)
    assert batch.object_id.tolist() == [5]


def test_a_courtyard_stays_open():
    batch = face_to_solid_conversion(make_surfaces([YARD], "", 10.0))
    assert volume(batch)[0] == pytest.approx(200 * 10)


def test_rings_become_closed_lines():
    lines = face_to_line_conversion(make_surfaces([YARD], "building", 3.0, 9))
    assert lines.count == 2
    assert shapely.is_closed(lines.geometry).all()
    assert shapely.length(lines.geometry).sum() == pytest.approx(YARD.length)
    assert lines.object_id.tolist() == [9, 9]


@quick
@given(x=st.integers(-9, 9), y=st.integers(-9, 9), w=st.integers(1, 9), d=st.integers(1, 9))
def test_faces_on_the_grid_survive_the_way_through_points(x, y, w, d):
    box = shapely.box(x, y, x + w, y + d)
    points = face_to_point_conversion(make_surfaces([box], "park"))
    assert points.count == w * d
    (again,) = point_to_face_conversion(points).geometry
    assert again.equals(box)


@quick
@given(angle=st.floats(0, 3.1), w=st.floats(2, 50), d=st.floats(2, 50))
def test_the_box_of_a_turned_rectangle_is_that_rectangle(angle, w, d):
    shape = shapely.affinity.rotate(shapely.box(0, 0, w, d), angle, use_radians=True)
    boxes = face_to_box_conversion(make_surfaces([shape], "", 7.0))
    assert boxes.size[0] == pytest.approx([max(w, d), min(w, d), 7.0], rel=1e-6)
    middle = shapely.get_coordinates(shape.centroid)[0]
    assert boxes.base[0] == pytest.approx([*middle, 0], abs=1e-6)


def test_a_semantic_map_reads_back_with_its_classes():
    faces = make_surfaces([shapely.box(0, 0, 8, 4), shapely.box(8, 0, 12, 4)], ["park", "building"])
    image = face_to_image_conversion(faces)
    assert image.pixels.shape == (4, 12, 3)
    again = point_to_face_conversion(image_to_point_conversion(image))
    assert dict(zip(again.kind.tolist(), shapely.area(again.geometry).tolist(), strict=True)) == {
        "park": 32.0,
        "building": 16.0,
    }
    assert shapely.equals(again.geometry[0], faces.geometry[1])


def test_faces_become_buildings_with_parts_and_areas():
    shapes = [shapely.box(0, 0, 9, 9), shapely.box(20, 0, 30, 9), shapely.box(40, 0, 50, 9)]
    surfaces = make_surfaces(shapes, ["building", "park", "swamp thing"], [12.0, np.nan, np.nan])
    layout = face_to_layout_conversion(example_city(), surfaces)
    assert layout.buildings["height"].tolist() == [12.0]
    assert layout.buildings["levels"].tolist() == [4]
    assert layout.parts["building"].tolist() == layout.buildings["id"].tolist()
    assert sorted(layout.areas["kind"]) == ["park", "residential"]


def test_nothing_becomes_nothing():
    none = make_surfaces([])
    assert face_to_line_conversion(none).count == 0
    assert face_to_point_conversion(none).count == 0
    assert face_to_box_conversion(none).count == 0
    assert face_to_solid_conversion(none).count == 0
    assert face_to_image_conversion(none).pixels.shape == (1, 1, 3)
    assert len(face_to_layout_conversion(example_city(), none).buildings) == 0
