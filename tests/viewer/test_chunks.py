"""Chunks hold the city as it is stored, under names that follow from what is in them."""

import json
from dataclasses import replace

import numpy as np
import pytest
from glb import Glb

from cityx.assets.styles.materials import material_named
from cityx.city.content import HASHES, read_hash
from cityx.city.environment import Environment
from cityx.city.store import read_view
from cityx.outputs.gltf_material import weather_look
from cityx.projects.desk import Desk
from cityx.protocol.gate import Call
from cityx.viewer.chunks import CELL, chunks_of, edge_of, group_of
from cityx.viewer.content import ANY_SLOPE, chunk_bytes, pack_bytes, paints_bytes, weathering
from cityx.viewer.library import packs_of, paints_of
from cityx.viewer.scenery import read_scenery, scenery_of


@pytest.fixture(scope="module")
def store(built_town):
    return built_town(lod=2) / "city"


@pytest.fixture(scope="module")
def scenery(store):
    return read_scenery(store)


def test_names_and_bytes_are_the_same_whatever_the_order_of_objects(store, scenery):
    view, content = read_view(store), read_hash(store / HASHES)
    batch = view.scene.meshes["buildings"]
    turned = view.scene.with_mesh("buildings", batch.take(np.arange(batch.count)[::-1]))
    windows = view.scene.instances["windows"]
    rows = np.random.default_rng(1).permutation(windows.count)
    shuffled = {name: getattr(windows, name)[rows] for name in vars(windows)}
    turned = turned.with_instances("windows", view.scene.prototypes, replace(windows, **shuffled))
    again = scenery_of(replace(view, scene=turned), content)
    assert [chunk.name for chunk in again.chunks] == [chunk.name for chunk in scenery.chunks]
    packs = [pack.name for pack in again.packs]
    assert packs == [pack.name for pack in scenery.packs]
    first, second = (next(c for c in s.chunks if c.group == "buildings") for s in (scenery, again))
    assert len(chunk_bytes(first)) > 10_000
    assert chunk_bytes(first) == chunk_bytes(second)


def test_all_triangles_are_in_their_chunks_within_three_millimetres(store, scenery):
    view = read_view(store)
    for layer in ("buildings", "ground"):
        batch = view.scene.meshes[layer]
        corners, owners = [], []
        for chunk in scenery.chunks:
            if layer in chunk.meshes:
                found, ids = Glb(chunk_bytes(chunk)).triangles(layer)
                corners.append(found)
                owners.append(ids)
        corners, owners = np.concatenate(corners), np.concatenate(owners)
        triangles, face = batch.triangles()
        wanted = batch.vertices[triangles]
        told = np.array([f"{number:016x}" for number in batch.object_id.tolist()])
        whose = told[batch.face_object()[face]]
        assert len(corners) == len(wanted)
        for name in told.tolist():
            one, other = corners[owners == name], wanted[whose == name]
            assert len(one) == len(other)
            middles = [np.sort(part.mean(axis=1).round(1), axis=0) for part in (one, other)]
            assert np.abs(middles[0] - middles[1]).max(initial=0) < 0.11
            low, high = one.reshape(-1, 3).min(axis=0), one.reshape(-1, 3).max(axis=0)
            assert np.abs(low - other.reshape(-1, 3).min(axis=0)).max() < 0.003
            assert np.abs(high - other.reshape(-1, 3).max(axis=0)).max() < 0.003


def test_every_vertex_lies_within_three_millimetres_of_one_of_the_store(store, scenery):
    from scipy.spatial import cKDTree

    view = read_view(store)
    for layer in ("buildings", "ground"):
        tree = cKDTree(view.scene.meshes[layer].vertices)
        for chunk in scenery.chunks:
            if layer in chunk.meshes:
                corners, _ = Glb(chunk_bytes(chunk)).triangles(layer)
                away, _ = tree.query(corners.reshape(-1, 3))
                assert away.max() < 0.004  # in space; on each axis half a step, 2 mm


def test_rows_have_ids_owners_and_places_of_the_store(store, scenery):
    view = read_view(store)
    for layer, table in view.scene.instances.items():
        ids, owners, places = [], [], []
        for chunk in scenery.chunks:
            if layer not in chunk.rows:
                continue
            glb = Glb(chunk_bytes(chunk))
            told = next(node for node in glb.layers() if node["name"] == layer)["extras"]
            arrays = {name: glb.array(number) for name, number in told["rows"].items()}
            assert sum(count for _, count in told["counts"]) == len(arrays["_CITYX_ID"])
            ids += np.ascontiguousarray(arrays["_CITYX_ID"]).view("<u8")[:, 0].tolist()
            owners += np.ascontiguousarray(arrays["_CITYX_OWNER"]).view("<u8")[:, 0].tolist()
            places += [arrays["TRANSLATION"] + told["origin"]]
        known = sorted(zip(table.object_id.tolist(), table.owner.tolist(), strict=True))
        assert sorted(zip(ids, owners, strict=True)) == known
        place = np.concatenate(places)[:, [0, 2, 1]] * [1, -1, 1]
        one, other = (np.sort(values.round(2), axis=0) for values in (place, table.position))
        assert np.abs(one - other).max() < 0.011


def test_a_chunk_lies_in_its_cell_but_for_what_reaches_out(scenery):
    for chunk in scenery.chunks:
        if chunk.group != "surroundings":
            middle = chunk.box[:, :2].mean(axis=0)
            assert (np.abs(middle - (np.array(chunk.cell) + 0.5) * CELL) < CELL).all()


def test_an_edit_of_one_building_changes_its_chunk_alone(town):
    before = read_scenery(town / "city")
    number = int(before.view.scene.meshes["buildings"].object_id[0])
    args = {"scaled_obj_name": f"{number:016x}", "scale_factor": [1, 1, 1.5]}
    with Desk(town) as desk:
        desk.change([Call("scale_object", args)])
    after = read_scenery(town / "city")
    old = {chunk.name: chunk for chunk in before.chunks}
    new = {chunk.name: chunk for chunk in after.chunks}
    gone = [old[name] for name in old.keys() - new.keys()]
    come = [new[name] for name in new.keys() - old.keys()]
    assert [(c.group, c.cell) for c in gone] == [(c.group, c.cell) for c in come]
    assert {c.group for c in come} == {"buildings"}
    assert len(come) == 1
    assert number in come[0].meshes["buildings"].object_id
    assert len(chunk_bytes(come[0])) < 2e6
    again = read_scenery(town / "city", before)  # layers that are the same are not cut again
    assert [chunk.to_json() for chunk in again.chunks] == [c.to_json() for c in after.chunks]
    assert again.cuts.rows.keys() & before.cuts.rows.keys()


def test_the_weather_changes_no_file(store, scenery):
    view = read_view(store)
    wet = replace(view, environment=replace(view.environment, wetness=1.0, snow=0.5))
    again = scenery_of(wet, read_hash(store / HASHES))
    assert again.names() == scenery.names()
    assert again.to_json()["environment"]["wetness"] == 1.0


def test_what_rain_and_snow_do_is_told_of_each_material():
    def told(name):
        return dict(zip(("porosity", "pools", "snow", "share"), weathering(material_named(name)),
                        strict=True))  # fmt: skip

    assert told("asphalt")["snow"] == told("asphalt_a2w1r0")["snow"]  # a state of it
    assert 0 < told("asphalt")["snow"] < told("roof_tiles")["snow"] == 1
    assert [told(name)["snow"] for name in ("water", "pane", "room_wall")] == [0, 0, 0]
    assert told("leaf")["snow"] == ANY_SLOPE
    assert [told(name)["pools"] for name in ("paving", "brick")] == [1, 0]
    snowy = Environment(snow=1.0)
    for name in ("grass", "asphalt", "brick"):  # the share that a plain GLB has
        material = material_named(name)
        before, after = np.array(material.color), weather_look(material, snowy)[0]
        white = before + (np.array([0.80, 0.82, 0.86]) - before) * told(name)["share"]
        assert after == pytest.approx(white)


def test_far_forms_of_trees_are_light_and_in_packs_that_come_first(store):
    view, content = read_view(store), read_hash(store / HASHES)
    packs = [pack for pack in packs_of(view, content) if pack.kind == "tree"]
    assert [pack.beyond for pack in packs] == sorted((p.beyond for p in packs), reverse=True)
    far, near = packs[0], packs[-1]
    assert max(shape.prototype.mesh.triangle_count for shape in far.shapes) < 100
    assert {shape.of for shape in far.shapes} == {shape.of for shape in near.shapes}
    assert len(pack_bytes(far)) * 20 < len(pack_bytes(near))


def test_a_large_city_has_larger_cells_where_what_an_edit_sends_stays_small():
    def edge(kilometres, lod):
        return edge_of((0.0, 0.0, kilometres * 1000, kilometres * 1000), lod)

    assert [edge(1.0, lod) for lod in range(4)] == [200, 200, 200, 200]
    assert [edge(3.6, lod) for lod in range(4)] == [400, 400, 200, 200]
    assert [edge(30.0, lod) for lod in range(4)] == [800, 400, 200, 200]


def test_larger_cells_hold_the_same_city_in_fewer_chunks(store, scenery):
    view, content = read_view(store), read_hash(store / HASHES)
    small, cuts = chunks_of(view, content, scenery.cuts, edge=50.0)
    large, _ = chunks_of(view, content, cuts, edge=100.0)
    assert len(large) < len(small)
    assert {chunk.name for chunk in large}.isdisjoint(chunk.name for chunk in small)

    def held(chunks):
        rows = [sum(n for _, n in table.counts) for c in chunks for table in c.rows.values()]
        return sum(rows), sum(c.triangles for c in chunks)

    assert held(large) == held(small) == held(scenery.chunks)
    for chunk in large:
        for batch in chunk.meshes.values():
            middle = (batch.vertices.min(axis=0) + batch.vertices.max(axis=0))[:2] / 2
            assert (np.abs(middle - (np.array(chunk.cell) + 0.5) * 100) < 100).all() or (
                chunk.group == "surroundings"
            )


def test_layers_without_a_group_of_their_own_are_of_the_street():
    assert group_of("windows") == "buildings"
    assert group_of("something_of_a_package") == "street"


def test_all_files_are_valid(tmp_path, scenery):
    from validating import errors_of

    view = scenery.view
    files = {f"{chunk.group}{n}": chunk_bytes(chunk) for n, chunk in enumerate(scenery.chunks)}
    files |= {f"pack{n}": pack_bytes(pack) for n, pack in enumerate(scenery.packs[:4])}
    files["paints"] = paints_bytes(paints_of(view, scenery.packs))
    for name, data in files.items():
        (tmp_path / f"{name}.glb").write_bytes(data)
    assert errors_of(sorted(tmp_path.glob("*.glb"))) == []


def test_the_scene_is_json_of_bounded_size(scenery):
    text = json.dumps(scenery.to_json(), allow_nan=False)
    assert len(text) < 400 * (len(scenery.chunks) + 20)
