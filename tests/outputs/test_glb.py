from dataclasses import asdict

import numpy as np
import pytest
from glb_scenes import box, read_glb, rows, small_city, view
from hypothesis import given, settings
from hypothesis import strategies as st

from cityx.assets.furniture.street_furniture import furniture
from cityx.assets.styles.materials import MATERIALS
from cityx.assets.textures import texture
from cityx.city import Environment, Prototype, Scene, concatenate, one_mesh
from cityx.outputs import glb as glb_module
from cityx.outputs.glb import write_glb
from cityx.outputs.gltf_instances import id_words, tint_groups, y_up_quaternions
from cityx.outputs.gltf_mesh import flat_mesh, y_up

PLAIN = {"texture_size": 0}


def written(city, tmp_path, **options):
    path = tmp_path / "city.glb"
    stats = write_glb(city, path, **{**PLAIN, **options})
    assert stats.size == path.stat().st_size
    return read_glb(path), stats


def test_nodes_form_city_layer_object(tmp_path):
    glb, _ = written(small_city(), tmp_path)
    (root,) = glb.nodes("city")
    assert [node["name"] for node in glb.children(root)] == ["buildings", "ground", "lamps"]
    names = [node["name"] for node in glb.children(glb.children(root)[0])]
    assert names == ["building_0000000000000001", "building_0000000000000002"]


def test_objects_carry_their_id_and_what_is_known_of_them(tmp_path):
    glb, _ = written(small_city(), tmp_path)
    (node,) = glb.nodes("building_0000000000000001")
    body = node["extras"].pop("body")
    assert body["motion"] == "fixed"
    assert body["mass"] == 350.0 * 1000  # ten metres each way
    assert node["extras"] == {
        "cityx_id": "0000000000000001",
        "kind": "building",
        "name": "Town Hall",
        "source": "osm/way/1",
        "use": "civic",
    }


@pytest.mark.parametrize("instancing", [True, False])
def test_things_carry_their_bodies(tmp_path, instancing):
    bench = furniture("bench")
    scene = Scene().with_instances("street_furniture", [bench], rows([[0, 0, 0]]))
    glb, _ = written(view(scene), tmp_path, instancing=instancing)
    (body,) = (n["extras"]["body"] for n in glb.json["nodes"] if "body" in n.get("extras", {}))
    assert (body["kind"], body["motion"]) == ("bench", "free")
    assert 35 < body["mass"] < 80


def test_frame_and_attribution_travel_with_the_file(tmp_path):
    glb, _ = written(small_city(), tmp_path)
    extras = glb.nodes("city")[0]["extras"]
    assert extras["projection"].startswith("+proj=tmerc +lat_0=51.5")
    assert extras["attribution"] == ["© OpenStreetMap contributors, ODbL 1.0"]
    assert glb.json["asset"]["copyright"] == "© OpenStreetMap contributors, ODbL 1.0"


def test_up_is_y_and_north_is_minus_z(tmp_path):
    scene = Scene().with_mesh("buildings", box(1, (100, 200, 5), (10, 20, 30)))
    glb, _ = written(view(scene), tmp_path)
    (node,) = glb.nodes("building_0000000000000001")
    corners = glb.triangles(node["mesh"]).reshape(-1, 3) + node["translation"]
    np.testing.assert_allclose(corners.min(axis=0), [100, 5, -220], atol=1e-5)
    np.testing.assert_allclose(corners.max(axis=0), [110, 35, -200], atol=1e-5)


def test_bounds_of_accessors_are_those_of_the_values(tmp_path):
    glb, _ = written(small_city(), tmp_path)
    assert any("min" in accessor for accessor in glb.json["accessors"])
    for index, accessor in enumerate(glb.json["accessors"]):
        if "min" in accessor:
            values = glb.array(index)
            np.testing.assert_array_equal(values.min(axis=0), np.float32(accessor["min"]))
            np.testing.assert_array_equal(values.max(axis=0), np.float32(accessor["max"]))


def test_normals_point_out_of_a_solid(tmp_path):
    glb, _ = written(view(Scene().with_mesh("buildings", box(1))), tmp_path)
    middle = np.array([0, 5, 0])
    assert glb.json["meshes"][0]["primitives"]
    for primitive in glb.json["meshes"][0]["primitives"]:
        normal = glb.array(primitive["attributes"]["NORMAL"])
        corner = glb.array(primitive["attributes"]["POSITION"])
        for a, b, c in glb.array(primitive["indices"]).reshape(-1, 3):
            cross = np.cross(corner[b] - corner[a], corner[c] - corner[a])
            np.testing.assert_allclose(cross / np.linalg.norm(cross), normal[a], atol=1e-6)
            assert (corner[a] - middle) @ normal[a] > 0


def test_triangles_are_counted_once_and_per_instance(tmp_path):
    glb, stats = written(small_city(), tmp_path)
    assert (stats.triangles_unique, stats.triangles_instanced) == (12 + 12 + 2 + 12, 26 + 4 * 12)
    assert stats.instances == 4
    assert len(glb.json["nodes"]) == stats.nodes


def test_a_flat_sheet_shares_its_vertices():
    steps = np.arange(11.0)
    grid = np.stack(np.meshgrid(steps, steps), axis=-1).reshape(-1, 2)
    corner = (np.arange(10)[:, None] * 11 + np.arange(10)).ravel()
    faces = np.column_stack([corner, corner + 1, corner + 12, corner + 11])
    points = np.column_stack([grid, np.zeros(len(grid))])
    uv = points[faces][:, :, :2]
    sheet = one_mesh(1, points, faces, materials=("grass",), uv=uv)
    assert len(flat_mesh(sheet, np.zeros((1, 3))).position) == 121
    cube = flat_mesh(box(1), np.zeros((1, 3)))
    assert len(cube.position) == 24  # three normals at each corner


@settings(max_examples=20, deadline=None, derandomize=True)
@given(seed=st.integers(0, 1000), objects=st.integers(1, 5), piece=st.sampled_from([3, 7, 1000]))
def test_flattening_keeps_every_triangle(seed, objects, piece):
    """Whatever the order of materials and however faces are cut into pieces."""
    from cityx.outputs import gltf_mesh

    rng = np.random.default_rng(seed)
    names = ("brick", "glass", "grass")
    parts = []
    for number in range(objects):
        points = rng.uniform(-9, 9, (8, 3))
        faces = np.array([rng.permutation(8)[:4] for _ in range(rng.integers(1, 9))])
        faces[rng.random(len(faces)) < 0.5, 3] = -1
        parts.append(
            one_mesh(
                number + 1,
                points,
                faces,
                material=rng.integers(0, 3, len(faces)),
                materials=names,
                uv=rng.uniform(size=(len(faces), 4, 2)),
                tint=rng.uniform(size=(len(faces), 3)),
            )
        )
    batch = concatenate(parts)
    before, gltf_mesh.PIECE = gltf_mesh.PIECE, piece
    try:
        flat = flat_mesh(batch, np.zeros((objects, 3)))
    finally:
        gltf_mesh.PIECE = before
    corners, face = batch.triangles()
    wanted = sorted(
        (int(owner), int(material), *map(float, np.float32(y_up(batch.vertices[c])).ravel()))
        for c, owner, material in zip(
            corners, batch.face_object()[face], batch.material[face], strict=True
        )
    )
    got = []
    for s, (owner, material) in enumerate(
        zip(flat.section_object, flat.section_material, strict=True)
    ):
        index = flat.index[flat.section_start[s] : flat.section_start[s + 1]].astype(int)
        for triangle in (index + flat.vertex_start[owner]).reshape(-1, 3):
            assert flat.vertex_start[owner] <= triangle.min()
            assert triangle.max() < flat.vertex_start[owner + 1]
            got.append((int(owner), int(material), *map(float, flat.position[triangle].ravel())))
    assert sorted(got) == wanted


def test_colors_are_tints_where_the_material_takes_one(tmp_path):
    scene = Scene().with_mesh("buildings", box(1, materials=("brick", "glass")))
    glb, _ = written(view(scene), tmp_path)
    names = [material["name"] for material in glb.json["materials"]]
    assert {"brick", "glass"} <= set(names)
    for primitive in glb.json["meshes"][0]["primitives"]:
        rows_used = np.unique(glb.array(primitive["indices"]))
        color = np.unique(glb.array(primitive["attributes"]["COLOR_0"])[rows_used], axis=0)
        plain = names[primitive["material"]] == "glass"
        assert color.tolist() == [[255] * 4 if plain else [128, 64, 26, 255]]


def test_texture_coordinates_count_tiles_and_v_runs_down(tmp_path):
    glb, _ = written(view(Scene().with_mesh("buildings", box(1))), tmp_path)
    (wall, *_rest) = glb.json["meshes"][0]["primitives"]
    used = np.unique(glb.array(wall["indices"]))
    uv = glb.array(wall["attributes"]["TEXCOORD_0"])[used]
    tiles = 10 / MATERIALS["brick"].tile
    assert uv.min(axis=0).tolist() == [0, -tiles]
    assert uv.max(axis=0).tolist() == [tiles, 0]


def test_instances_stand_where_the_scene_has_them(tmp_path):
    glb, _ = written(small_city(), tmp_path)
    assert glb.json["extensionsRequired"] == ["EXT_mesh_gpu_instancing"]
    places, ids = [], []
    for node in (
        node
        for node in glb.json["nodes"]
        if "EXT_mesh_gpu_instancing" in node.get("extensions", {})
    ):
        attributes = node["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]
        places.append(glb.array(attributes["TRANSLATION"]) + np.array(node["translation"]))
        ids.append(np.ascontiguousarray(glb.array(attributes["_CITYX_ID"])).view("<u8").ravel())
    order = np.argsort(np.concatenate(ids))
    expected = [[-5, 0, 5], [-5, 0, -30], [30, 0, 5], [30, 0, -30]]
    np.testing.assert_allclose(np.concatenate(places)[order], expected, atol=1e-5)
    assert (np.concatenate(ids)[order] >> np.uint64(40)).tolist() == [1, 2, 3, 4]


def test_tints_of_instances_become_meshes_that_share_all_but_color(tmp_path):
    glb, _ = written(small_city(), tmp_path)
    lamps = [mesh for mesh in glb.json["meshes"] if mesh["name"] == "lamp"]
    assert len(lamps) == 2
    one, two = (mesh["primitives"][1]["attributes"] for mesh in lamps)
    assert one["POSITION"] == two["POSITION"]
    assert one["COLOR_0"] != two["COLOR_0"]


def test_without_the_extension_every_instance_is_a_node(tmp_path):
    glb, _ = written(small_city(), tmp_path, instancing=False)
    assert "EXT_mesh_gpu_instancing" not in glb.json["extensionsUsed"]
    (layer,) = glb.nodes("lamps")
    nodes = glb.children(layer)
    assert len(nodes) == 4
    assert nodes[0]["extras"]["owner"] == "0000000000000005"


@settings(max_examples=30, deadline=None, derandomize=True)
@given(st.tuples(*[st.floats(-7, 7)] * 3), st.tuples(*[st.floats(-5, 5)] * 3))
def test_quaternions_turn_like_euler_angles(angles, point):
    from scipy.spatial.transform import Rotation

    turned = y_up(Rotation.from_euler("xyz", angles).apply(point))
    quaternion = y_up_quaternions([angles])[0]
    np.testing.assert_allclose(Rotation.from_quat(quaternion).apply(y_up(point)), turned, atol=1e-5)


def test_many_tints_become_a_few_near_ones():
    tint = np.random.default_rng(0).uniform(0.2, 1, (500, 3))
    group, color = tint_groups(tint)
    assert len(color) == 8
    assert np.abs(color[group] - tint).mean() < 0.2
    exact_group, exact = tint_groups(np.repeat([[1, 0, 0], [0, 0.2, 1]], 5, axis=0))
    np.testing.assert_allclose(exact[exact_group][[0, -1]], [[1, 0, 0], [0, 0.2, 1]], atol=1e-6)


def test_ids_survive_as_words():
    ids = np.array([0xFEDCBA9876543210, 1], np.uint64)
    assert id_words(ids)[0].tolist() == [0x3210, 0x7654, 0xBA98, 0xFEDC]


def test_textures_are_embedded_and_keep_the_base_color(tmp_path):
    glb, stats = written(small_city(), tmp_path, texture_size=32)
    (brick,) = [m for m in glb.json["materials"] if m["name"] == "brick"]
    surface = brick["pbrMetallicRoughness"]
    factor = min(1, MATERIALS["brick"].color[0] / texture("brick", 32).mean)
    assert surface["baseColorFactor"] == pytest.approx([factor] * 3 + [1], abs=1e-4)
    assert "baseColorTexture" in surface
    assert "normalTexture" in brick
    image = glb.json["images"][0]
    start = glb.json["bufferViews"][image["bufferView"]]["byteOffset"]
    assert glb.data[start : start + 3] == b"\xff\xd8\xff"
    assert stats.textures == len(glb.json["images"])


def test_lamps_glow_at_night_only(tmp_path):
    scene = Scene().with_mesh("buildings", box(1, materials=("window_lit", "brick")))
    day, _ = written(view(scene), tmp_path)
    night, _ = written(view(scene, environment=Environment(night_lights=0.6)), tmp_path)
    assert "emissiveFactor" not in day.json["materials"][0]
    assert "emissiveFactor" in night.json["materials"][0]
    assert "KHR_materials_emissive_strength" in night.json["extensionsUsed"]


def turned(quaternion, vector):
    x, y, z, w = quaternion
    axis = np.array([x, y, z])
    return vector + 2 * np.cross(axis, np.cross(axis, vector) + w * np.asarray(vector))


@pytest.mark.parametrize(("elevation", "azimuth"), [(40, 200), (5, 0), (60, 90), (20, 300)])
def test_the_sun_shines_from_where_it_stands(tmp_path, elevation, azimuth):
    up, turn = np.radians(elevation), np.radians(azimuth)
    light = Environment(sun_elevation=up, sun_azimuth=turn)
    glb, _ = written(view(Scene().with_mesh("ground", box(1)), environment=light), tmp_path)
    (node,) = glb.nodes("sun")
    assert node["extensions"]["KHR_lights_punctual"] == {"light": 0}
    assert glb.json["extensions"]["KHR_lights_punctual"]["lights"][0]["type"] == "directional"
    toward = np.array([np.sin(turn) * np.cos(up), np.cos(turn) * np.cos(up), np.sin(up)])
    shines = turned(node["rotation"], [0.0, 0.0, -1.0])
    np.testing.assert_allclose(shines, -y_up(toward[None])[0], atol=1e-6)


def test_clouds_dim_the_sun_and_at_night_there_is_none(tmp_path):
    def sun(**values):
        light = Environment(**values)
        glb, _ = written(view(Scene().with_mesh("ground", box(1)), environment=light), tmp_path)
        assert glb.nodes("city")[0]["extras"]["environment"] == asdict(light)
        lights = glb.json.get("extensions", {}).get("KHR_lights_punctual", {"lights": []})
        return [light["intensity"] for light in lights["lights"]]

    assert 1.0 < sun()[0] < np.pi
    assert sun(cloud_cover=0.5)[0] == pytest.approx(sun()[0] / 4, rel=1e-3)
    assert sun(sun_elevation=-0.1) == []


def test_snow_whitens_level_ground_and_slush_the_street(tmp_path):
    materials = ("grass", "asphalt")
    scene = Scene().with_mesh("ground", box(1, materials=materials))
    glb, _ = written(view(scene, environment=Environment(snow=1.0)), tmp_path)
    white = {m["name"]: m["pbrMetallicRoughness"]["baseColorFactor"] for m in glb.json["materials"]}
    assert min(white["grass"][:3]) > 0.75
    assert 0.2 < min(white["asphalt"][:3]) < 0.5


def test_too_many_objects_are_merged_by_tile_and_keep_their_ids(tmp_path, monkeypatch):
    monkeypatch.setattr(glb_module, "MOST_OBJECTS", 2)
    boxes = concatenate([box(1), box(2, (300, 0, 0)), box(3, (20, 0, 0))])
    glb, stats = written(view(Scene().with_mesh("buildings", boxes)), tmp_path)
    (layer,) = glb.nodes("buildings")
    names = [node["name"] for node in glb.children(layer)]
    assert names == ["buildings_tile_0_0", "buildings_tile_1_0"]
    words = glb.array(glb.json["meshes"][0]["primitives"][0]["attributes"]["_CITYX_ID"])
    assert set(np.ascontiguousarray(words).view("<u8").ravel().tolist()) == {1, 3}
    assert stats.triangles_unique == 36


def test_an_empty_city_is_a_file(tmp_path):
    glb, stats = written(view(Scene()), tmp_path)
    assert stats.meshes == 0
    assert [node["name"] for node in glb.json["nodes"]] == ["city", "sun"]


def test_broken_numbers_and_flat_faces_do_not_reach_the_file(tmp_path):
    mesh = box(1, size=(10, 10, 0))
    mesh.vertices[0, 0] = np.nan
    mesh.uv[0, 0] = np.inf
    lamp = Prototype("lamp", "furniture", box(0))
    scene = Scene().with_mesh("buildings", mesh)
    scene = scene.with_instances("lamps", [lamp], rows([[np.nan, 0, 0]]))
    glb, _ = written(view(scene), tmp_path)
    for index, accessor in enumerate(glb.json["accessors"]):
        if accessor["componentType"] == 5126:
            assert np.isfinite(glb.array(index)).all()
    normal = glb.array(glb.json["meshes"][0]["primitives"][0]["attributes"]["NORMAL"])
    np.testing.assert_allclose(np.linalg.norm(normal, axis=1), 1, atol=1e-5)


def test_the_same_city_is_the_same_file(tmp_path):
    one, two = tmp_path / "1.glb", tmp_path / "2.glb"
    for path in (one, two):
        write_glb(small_city(), path, texture_size=16)
    assert one.read_bytes() == two.read_bytes()
