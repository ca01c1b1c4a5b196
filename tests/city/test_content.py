from dataclasses import replace

import numpy as np

from cityx.city import Environment, Instances, concatenate, make_table
from cityx.city.content import content_hash, hash_instances


def test_one_moved_vertex_changes_its_object_alone(small_city):
    batch = small_city.scene.meshes["buildings"]
    vertices = batch.vertices.copy()
    vertices[0, 2] += 0.01
    moved = replace(small_city, scene=small_city.scene.with_mesh(
        "buildings", replace(batch, vertices=vertices)))  # fmt: skip
    before, after = content_hash(small_city), content_hash(moved)
    assert before.total != after.total
    assert before.of_object(5) != after.of_object(5)
    assert before.of_object(2**63 + 7) == after.of_object(2**63 + 7)


def test_the_order_of_objects_and_rows_does_not_count(small_city):
    batch = small_city.scene.meshes["buildings"]
    scene = small_city.scene.with_mesh("buildings", batch.take([1, 0]))
    table = small_city.layout.buildings.iloc[::-1]
    columns = {name: table[name].to_numpy() for name in table.columns if name != "geometry"}
    layout = replace(
        small_city.layout, buildings=make_table("buildings", table.geometry.to_numpy(), **columns)
    )
    turned = replace(small_city, scene=scene, layout=layout)
    assert content_hash(turned).total == content_hash(small_city).total


def test_the_order_of_material_names_does_not_count(small_city):
    batch = small_city.scene.meshes["buildings"]
    other = replace(batch, materials=("x", *batch.materials), material=batch.material + 1)
    scene = small_city.scene.with_mesh("buildings", concatenate([other]))
    assert content_hash(replace(small_city, scene=scene)).total == content_hash(small_city).total


def test_attributes_and_light_count(small_city):
    base = content_hash(small_city).total
    foggy = replace(small_city, environment=Environment(weather="fog"))
    assert content_hash(foggy).total != base
    table = small_city.layout.buildings.assign(use=["yes", "mosque"])
    other = replace(small_city, layout=replace(small_city.layout, buildings=table))
    assert content_hash(other).total != base


def test_a_millionth_of_a_metre_does_not_count(small_city):
    batch = small_city.scene.meshes["buildings"]
    shifted = replace(batch, vertices=batch.vertices + 1e-7)
    scene = small_city.scene.with_mesh("buildings", shifted)
    assert content_hash(replace(small_city, scene=scene)).total == content_hash(small_city).total


def test_the_last_bits_of_half_a_millimetre_do_not_count():
    def rows(z):
        zero, ones = np.zeros((1, 3), np.float32), np.ones((1, 3), np.float32)
        return Instances(np.zeros(1, np.int32), np.ones(1, np.uint64), np.zeros(1, np.uint64),
                         np.array([[0.0, 0.0, z]]), zero, ones, ones)  # fmt: skip

    names = np.ones(1, np.uint64)
    hashes = [hash_instances(rows(30.1855 + noise), names)[1] for noise in (-7e-10, 0.0, 7e-10)]
    assert len(np.unique(hashes)) == 1
    assert hash_instances(rows(30.1875), names)[1] != hashes[0]
