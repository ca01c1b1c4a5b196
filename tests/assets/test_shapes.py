from collections import Counter

import numpy as np
import pytest

from cityx.assets.shapes import box, cards, cylinder, disc, fuse, lathe, moved, prism, tube


def volume(mesh):
    triangles, _ = mesh.triangles()
    p = mesh.vertices[triangles]
    return np.einsum("ij,ij->i", p[:, 0], np.cross(p[:, 1], p[:, 2])).sum() / 6


def closed(mesh):
    triangles, _ = mesh.triangles()
    edges = Counter()
    for a, b, c in triangles.tolist():
        for edge in ((a, b), (b, c), (c, a)):
            edges[edge] += 1
    return all(edges[e[::-1]] == n == 1 for e, n in edges.items())


SOLIDS = {
    "box": (lambda: box((0, 0, 0), (1, 2, 3), "metal_grey"), 6.0),
    "cylinder": (lambda: cylinder((0, 0, 0), (0, 0, 2), 1.0, "metal_grey", sides=256), 2 * np.pi),
    "cone": (lambda: lathe([(1.0, 0.0), (0.0, 3.0)], "stone", sides=256), np.pi),
    "ball": (
        lambda: lathe([(np.cos(a), np.sin(a)) for a in np.linspace(-np.pi / 2, np.pi / 2, 65)],
                      "stone", sides=128), 4 / 3 * np.pi),
    "prism": (lambda: prism([(0, 0), (2, 0), (2, 1), (0, 1)], 0.0, 3.0, "sign"), 6.0),
    "disc": (lambda: disc((0, 0, 2), 1.0, "sign", sides=256, thickness=0.5), np.pi / 2),
    "tube": (lambda: tube([[0, 0, 0], [0, 1, 0], [0, 3, 0]], 0.5, "bark", sides=256),
             0.75 * np.pi),
}  # fmt: skip


@pytest.mark.parametrize("name", SOLIDS)
def test_solids_are_closed_and_have_their_volume_outwards(name):
    make, expected = SOLIDS[name]
    assert closed(make())
    assert volume(make()) == pytest.approx(expected, rel=0.01)


def test_a_turn_moves_the_front_from_south_to_east():
    shape = moved(box((0, -2, 0), (0.1, -1, 1), "sign"), yaw=np.pi / 2)
    assert shape.vertices[:, 0].min() == pytest.approx(1.0)


def test_fused_shapes_are_one_object_with_all_faces():
    both = fuse([box((0, 0, 0), (1, 1, 1), "sign"), box((2, 0, 0), (3, 1, 1), "stone")])
    assert both.count == 1
    assert both.materials == ("sign", "stone")
    assert len(both.faces) == 12


def test_a_card_is_a_quad_of_two_triangles_that_face_its_normal():
    mesh = cards(np.zeros((1, 3)), np.array([[0, 1.0, 0]]), np.array([[-1.0, 0, 0]]), "leaf",
                 np.ones((1, 3)), fold=0.0)  # fmt: skip
    triangles, _ = mesh.triangles()
    p = mesh.vertices[triangles]
    normal = np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0])
    assert len(mesh.faces) == 1
    assert len(triangles) == 2
    assert (np.abs(normal[:, 2]) > 0).all()
    assert np.sign(normal[0, 2]) == np.sign(normal[1, 2])
