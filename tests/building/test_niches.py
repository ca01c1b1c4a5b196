from dataclasses import replace

import numpy as np
import pytest
from test_facade import terrace

from cityx.building.facade.facade import facade
from cityx.building.facade.facade_plan import facade_of
from cityx.building.facade.slabs import Pieces, around, coursed, slabs
from cityx.building.growth import Piece, grown
from cityx.building.shell import prism, shell
from cityx.city.mesh import concatenate, one_mesh
from cityx.city.mesh_measures import check_closed, plan_area, volume

OPENINGS = ("windows", "doors", "shopfronts")


def town(lod, *, use="apartments"):
    return facade(shell(replace(terrace(use=use), lod=lod)))


@pytest.mark.parametrize("use", ["apartments", "retail", "church", "warehouse"])
def test_a_switch_of_level_keeps_every_opening(use):
    plain, fine = town(2, use=use), town(3, use=use)
    for layer in OPENINGS:
        a, b = plain.scene.instances[layer], fine.scene.instances[layer]
        assert np.array_equal(a.object_id, b.object_id)
        assert np.array_equal(a.owner, b.owner)
        assert np.array_equal(a.rotation, b.rotation)
        assert np.array_equal(a.scale[:, [0, 2]], b.scale[:, [0, 2]])
        # Only along the normal of the wall may they differ, by what is squeezed flat.
        gap = b.position - a.position
        yaw = a.rotation[:, 2].astype(float)
        along = gap[:, 0] * np.cos(yaw) + gap[:, 1] * np.sin(yaw)
        assert np.abs(along).max(initial=0) < 1e-6
        assert np.abs(gap).max(initial=0) < 0.1
        assert np.abs(gap[:, 2]).max(initial=0) == 0


def test_buildings_have_the_same_ids_at_every_level():
    ids = [prism(replace(terrace(), lod=0)).scene.meshes["buildings"].object_id]
    ids += [town(lod).scene.meshes["buildings"].object_id for lod in (1, 2, 3)]
    assert all(np.array_equal(ids[0], other) for other in ids[1:])


@pytest.mark.parametrize("use", ["apartments", "retail", "church"])
def test_niches_leave_shells_closed_and_their_plan_as_it_was(use):
    plain, fine = town(2, use=use).scene.meshes, town(3, use=use).scene.meshes
    assert check_closed(fine["buildings"]).all()
    assert np.allclose(plan_area(plain["buildings"]), plan_area(fine["buildings"]), rtol=2e-3)
    assert fine["buildings"].triangle_count > 4 * plain["buildings"].triangle_count


def test_niches_are_cut_by_what_the_openings_measure():
    raised = shell(replace(terrace(), lod=3))
    found = facade_of(raised)
    fine = facade(raised)
    taken = volume(raised.scene.meshes["buildings"]) - volume(fine.scene.meshes["buildings"])
    size = (found.openings.width * found.openings.height).sum()
    assert any("are set back" in note for note in fine.notes)
    # Mouldings and facings add a little volume, so the loss lies below the deepest possible.
    assert -0.1 * size < taken.sum() < 0.25 * size


def test_levels_below_have_no_niches():
    assert not any("set back" in note for note in town(2).notes)


def test_facings_leave_holes_free():
    wall = Pieces(np.zeros(1, int), np.zeros(1), np.full(1, 10.0), np.zeros(1), np.full(1, 4.0))
    holes = Pieces(
        np.array([0, 0, 1]), np.array([1.0, 5, 2]), np.array([2.0, 8, 3]), np.array([0.0, 1, 0]),
        np.array([3.0, 5, 9]),
    )  # fmt: skip
    made = around(wall, np.zeros(1, int), holes)
    area = ((made.x1 - made.x0) * (made.z1 - made.z0)).sum()
    assert area == pytest.approx(40 - 1 * 3 - 3 * 3)
    courses = coursed(made, np.zeros(len(made.x0)), 0.5)
    assert ((courses.x1 - courses.x0) * (courses.z1 - courses.z0)).sum() == pytest.approx(area)
    assert (courses.z1 - courses.z0).max() <= 0.5 + 1e-9


def test_slabs_are_closed():
    feet = np.array([[0.0, 0.0]]), np.array([[2.0, 0.0]])
    vertices, faces = slabs(
        *feet, np.array([[0.0, -1.0]]), np.zeros(1), np.ones(1), out=0.1, chamfer=0.02
    )
    mesh = one_mesh(0, vertices[0], faces)
    assert check_closed(mesh)[0]
    assert volume(mesh)[0] == pytest.approx(2 * (0.1 * 1.0 - 0.02**2))


def test_grown_objects_keep_their_faces_and_get_new_ones():
    square = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
    batch = concatenate([one_mesh(n, square, [[0, 1, 2, 3]]) for n in (3, 5)])
    piece = Piece(
        np.array([[0.0, 0, 1]]), np.array([0]), np.array([[0, 1, 8, -1]]), np.array([0]),
        np.zeros(1, np.int16), ("brick",), np.zeros((1, 4, 2), np.float32),
        np.ones((1, 3), np.float32),
    )  # fmt: skip
    made = grown(batch, [piece], np.array([True, False]))
    assert made.face_start.tolist() == [0, 2, 2]
    assert made.vertex_start.tolist() == [0, 5, 9]
    assert made.faces.tolist() == [[0, 1, 2, 3], [0, 1, 4, -1]]
    assert [made.materials[i] for i in made.material] == ["plaster", "brick"]
