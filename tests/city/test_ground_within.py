import numpy as np
import pytest
import shapely

from cityx.city.ground import KERB_HEIGHT, LABEL
from cityx.city.layout import Layout, make_table
from cityx.city.mesh import one_mesh
from cityx.road.ground.ground_surface import ground_of

BOX = (20.0, 1.0, 40.0, 25.0)


@pytest.fixture(scope="module")
def crossing():
    roads = make_table(
        "roads", [shapely.LineString([(-90, 0), (90, 0)]), shapely.LineString([(0, -90), (0, 90)])],
        id=[1, 2], kind=["residential"] * 2, width=[6.0] * 2, sidewalk_left=[2.0] * 2,
    )  # fmt: skip
    return ground_of(Layout((-80.0, -80.0, 80.0, 80.0), roads=roads))


def test_ground_within_a_box_answers_there_as_the_whole(crossing):
    part = crossing.within(BOX)
    assert 0 < len(part.triangles) < len(crossing.triangles)
    assert 0 < len(part.edges) < len(crossing.edges)
    xy = np.random.default_rng(0).uniform(BOX[:2], BOX[2:], (400, 2))
    names = list(LABEL)
    assert (part.face_at(xy, *names) == crossing.face_at(xy, *names)).all()
    assert (part.face_at(xy, *names) >= 0).all()


def test_a_mesh_with_some_faces_keeps_its_objects():
    square = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, KERB_HEIGHT)])
    mesh = one_mesh(7, square, np.array([[0, 1, 2], [0, 2, 3]]))
    part = mesh.with_faces(np.array([False, True]))
    assert part.object_id.tolist() == [7]
    assert part.face_start.tolist() == [0, 1]
    assert part.faces[0, :3].tolist() == [0, 2, 3]
    assert len(part.vertices) == 4
