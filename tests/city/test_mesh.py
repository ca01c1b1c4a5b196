import numpy as np

from cityx.city import concatenate, one_mesh

SQUARE = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]


def quad(object_id, material="brick"):
    return one_mesh(object_id, SQUARE, [[0, 1, 2, 3]], materials=(material,))


def triangle(object_id, material="glass"):
    return one_mesh(object_id, SQUARE[:3], [[0, 1, 2]], materials=(material,))


def test_joined_batches_keep_objects_and_merge_materials():
    batch = concatenate([quad(1), triangle(2), quad(3)])
    assert batch.object_id.tolist() == [1, 2, 3]
    assert batch.materials == ("brick", "glass")
    assert batch.material.tolist() == [0, 1, 0]
    assert batch.faces.tolist() == [[0, 1, 2, 3], [4, 5, 6, -1], [7, 8, 9, 10]]


def test_quads_split_into_two_triangles_that_know_their_face():
    corners, face = concatenate([quad(1), triangle(2)]).triangles()
    assert corners.tolist() == [[0, 1, 2], [4, 5, 6], [0, 2, 3]]
    assert face.tolist() == [0, 1, 0]


def test_taking_objects_reorders_and_renumbers_them():
    batch = concatenate([quad(1), triangle(2), quad(3)]).take([2, 1])
    assert batch.object_id.tolist() == [3, 2]
    assert batch.faces.tolist() == [[0, 1, 2, 3], [4, 5, 6, -1]]
    assert batch.vertex_start.tolist() == [0, 4, 7]


def test_joining_nothing_gives_an_empty_batch():
    assert concatenate([]).count == 0
    assert concatenate([]).triangle_count == 0
    assert np.array_equal(concatenate([]).face_start, [0])
