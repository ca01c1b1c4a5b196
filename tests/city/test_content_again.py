"""Hashes of a city that shares most with another: the same as hashed whole."""

from dataclasses import replace

import numpy as np

from cityx.city.content import content_hash, read_hash, write_hash
from cityx.city.mesh import concatenate, same_objects
from cityx.city.store import read_city, write_city
from cityx.protocol.example_city import example_city


def painted(city, row):
    batch = city.scene.meshes["buildings"]
    tint = batch.tint.copy()
    tint[batch.face_start[row] : batch.face_start[row + 1]] *= 0.5
    scene = city.scene.with_mesh("buildings", replace(batch, tint=tint))
    return replace(city, scene=scene)


def test_what_two_cities_share_is_hashed_the_same(tmp_path):
    city = example_city(built=True)
    held = content_hash(city)
    write_hash(held, tmp_path / "hashes.npz")
    again = read_hash(tmp_path / "hashes.npz")
    assert again.total == held.total
    other = painted(city, 1)
    table = other.layout.buildings.copy()
    table.loc[0, "height"] += 1.0
    other = replace(other, layout=replace(other.layout, buildings=table))
    quick, whole = content_hash(other, (city, again)), content_hash(other)
    assert quick.total == whole.total != held.total
    assert all(np.array_equal(quick.layers[k][1], whole.layers[k][1]) for k in whole.layers)


def test_objects_are_the_same_wherever_they_stand_in_a_batch():
    batch = example_city(built=True).scene.meshes["buildings"]
    assert same_objects(batch, batch).all()
    fewer = batch.take(np.arange(1, batch.count))
    assert same_objects(fewer, batch).all()
    assert same_objects(batch, fewer).tolist() == [False] + [True] * (batch.count - 1)
    moved = replace(batch, vertices=np.add(batch.vertices, [0.0, 0.0, 1.0]))
    assert not same_objects(batch, moved).any()
    half = concatenate([batch.one(0), moved.take(np.arange(1, batch.count))])
    assert same_objects(batch, half).tolist() == [True] + [False] * (batch.count - 1)


def test_prototypes_that_a_change_adds_get_a_file_of_their_own(tmp_path):
    from cityx.assets.furniture.street_furniture import furniture

    city = example_city(built=True)
    write_city(city, tmp_path / "one")
    rows = next(iter(city.scene.instances.values()), None)
    empty = replace(rows, **{n: getattr(rows, n)[:0] for n in rows.__dataclass_fields__})
    scene = city.scene.with_instances("more", [furniture("bench")], empty)
    other = replace(city, scene=scene)
    write_city(other, tmp_path / "two", like=(city, tmp_path / "one"))
    assert (tmp_path / "two" / "prototypes-1.npz").exists()
    one, two = (tmp_path / name / "prototypes.npz" for name in ("one", "two"))
    assert one.samefile(two)
    back = read_city(tmp_path / "two")
    assert [p.name for p in back.scene.prototypes] == [p.name for p in scene.prototypes]
    assert content_hash(back).total == content_hash(other).total


def test_rows_that_changed_are_hashed_anew_and_no_others():
    city = example_city(built=True)
    layer, rows = max(city.scene.instances.items(), key=lambda item: item[1].count)
    held = content_hash(city)
    order = np.argsort(rows.object_id, kind="stable")
    twins = rows.object_id[order].copy()
    twins[2] = twins[1]  # two rows of one id
    columns = {n: getattr(rows, n)[order] for n in rows.__dataclass_fields__}
    moved = columns["position"] + np.eye(rows.count, 3) * 0.5
    for change in ({"position": moved}, {"object_id": twins}, {"owner": columns["owner"] + 1}):
        other = replace(rows, **(columns | change))
        scene = city.scene.with_instances(layer, city.scene.prototypes, other)
        then = replace(city, scene=scene)
        quick, whole = content_hash(then, (city, held)), content_hash(then)
        assert quick.total == whole.total != held.total
        assert np.array_equal(quick.layers[f"instances/{layer}"][1],
                              whole.layers[f"instances/{layer}"][1])  # fmt: skip
        back = content_hash(city, (then, whole))
        assert back.total == held.total
