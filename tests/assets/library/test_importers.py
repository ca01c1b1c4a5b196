import json
import struct
import zipfile

import numpy as np
import pytest
import shapely
import trimesh

from cityx.assets.library import hostile
from cityx.assets.library.hostile import Refused, inside, lz4_block
from cityx.assets.library.importers import import_folder
from cityx.assets.library.local_text import LocalText
from cityx.assets.library.measure import outline_of
from cityx.assets.library.store import check_library
from cityx.city.mesh import NO_VERTEX
from cityx.errors import InputError, UsageError
from cityx.geometry.extrude import prisms

Y_UP = np.array([[1, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, 0], [0, 0, 0, 1.0]])
ELL = shapely.Polygon([(0, 0), (20, 0), (20, 8), (8, 8), (8, 20), (0, 20)])


def box(size, at=(0, 0, 0), name="wall", color=(150, 60, 40, 255)):
    made = trimesh.creation.box(size)
    made.apply_translation(np.add(at, (0, 0, size[2] / 2)))
    made.apply_transform(Y_UP)
    material = trimesh.visual.material.PBRMaterial(name=name, baseColorFactor=list(color))
    made.visual = trimesh.visual.TextureVisuals(material=material)
    return made


def write_house(path):
    scene = trimesh.Scene()
    scene.add_geometry(box((12, 8, 9), (158.5, 165, 0), "red brick"), node_name="walls")
    scene.add_geometry(box((0.2, 1, 2), (164.6, 165, 0), "Door"), node_name="leaf")
    path.parent.mkdir(parents=True, exist_ok=True)
    scene.export(path)


def write_ell(path, scale=1.0):
    solid, _ = prisms(np.array([ELL], object), np.zeros(1), np.full(1, 10.0), np.zeros(1))
    quads = solid.faces[solid.faces[:, 3] != NO_VERTEX]
    triangles = np.concatenate([solid.faces[:, :3], quads[:, [0, 2, 3]]])
    made = trimesh.Trimesh(solid.vertices, triangles)
    made.apply_transform(Y_UP)
    made.apply_scale(scale)
    path.parent.mkdir(parents=True, exist_ok=True)
    made.export(path)


def imported(folder, out):
    return import_folder(folder, out / "library", LocalText())


def test_a_glb_is_measured_with_centre_front_and_licence(tmp_path):
    write_house(tmp_path / "in" / "buildings" / "house.glb")
    (tmp_path / "in" / "LICENSE").write_text("Creative Commons Zero v1.0 Universal")
    found = imported(tmp_path / "in", tmp_path)
    (record,) = found.library.catalogue.document()["buildings"]
    assert (record["length"], record["width"], record["height"]) == (12.2, 8.0, 9.0)
    assert record["coordinates"] == {"x": 158.6, "y": 165.0}
    assert record["front"] == pytest.approx(np.pi / 2, abs=1e-6)  # east, where the door is
    assert record["licence"] == "CC0-1.0"
    assert record["source"] == "imported"
    assert record["original"] == "buildings/house.glb"
    assert check_library(found.library) == []


def test_the_footprint_of_an_l_is_an_l(tmp_path):
    write_ell(tmp_path / "in" / "block.obj")
    table = imported(tmp_path / "in", tmp_path).library.catalogue
    assert table["footprint_area"][0] == pytest.approx(ELL.area, rel=0.01)
    assert table["area"][0] == pytest.approx(400, rel=0.01)
    assert table["licence"].tolist() == ["unknown"]


def test_the_unit_of_an_obj_is_guessed_and_told(tmp_path):
    write_ell(tmp_path / "in" / "house.obj", scale=100.0)
    found = imported(tmp_path / "in", tmp_path)
    assert found.library.catalogue["length"][0] == pytest.approx(20, rel=0.01)
    assert any("the unit cm is a guess" in note for note in found.notes)


def test_a_sidecar_says_what_cannot_be_measured(tmp_path):
    write_ell(tmp_path / "in" / "thing.obj")
    said = {"group": "furniture", "style": "modern", "licence": "CC-BY-4.0", "unit": "ft",
            "front_deg": 90, "up": "z", "description": "steel sculpture"}  # fmt: skip
    (tmp_path / "in" / "thing.json").write_text(json.dumps(said))
    (record,) = imported(tmp_path / "in", tmp_path).library.catalogue.document()["furniture"]
    assert record["front"] == pytest.approx(np.pi / 2, abs=1e-6)
    assert record["height"] == pytest.approx(20 * 0.3048)
    assert (record["style"], record["licence"]) == ("modern", "CC-BY-4.0")
    assert record["description"].startswith("Steel sculpture")


def gltf(**parts):
    return json.dumps({"asset": {"version": "2.0"}, **parts})


LONG = {"count": 10**9, "type": "VEC3", "componentType": 5126}
BAD = {
    "empty.glb": (b"", "it is empty"),
    "cut.glb": (struct.pack("<5I", 0x46546C67, 2, 999, 400, 0x4E4F534A), "says it has 999 bytes"),
    "other.glb": (b"x" * 50, "it is no GLB file"),
    "list.gltf": (b"[1, 2]", "it is no glTF document"),
    "deep.gltf": (b"[" * 100_000, "its JSON cannot be read"),
    "out.gltf": (gltf(buffers=[{"uri": "../../../etc/passwd"}]), "outside the folder"),
    "coded.gltf": (gltf(buffers=[{"uri": "..%2F..%2Fsecret.bin"}]), "outside the folder"),
    "web.gltf": (gltf(images=[{"uri": "https://example.org/a.png"}]), "an address outside"),
    "gone.gltf": (gltf(buffers=[{"uri": "gone.bin"}]), 'its file "gone.bin" is missing'),
    "long.gltf": (gltf(accessors=[LONG]), "its accessors hold 3000 million numbers"),
    "draco.gltf": (gltf(extensionsRequired=["KHR_draco_mesh_compression"]), "is not read"),
    "nothing.gltf": (gltf(scenes=[{}]), "it holds no geometry"),
    "flat.obj": ("v 0 0 0\nv 9 0 0\nv 9 9 0\nf 1 2 3\n", "it is flat along y"),
    "nan.obj": ("v 0 0 0\nv nan 0 0\nv 9 5 9\nf 1 2 3\n", "coordinates are not finite"),
    "point.obj": ("v 1 1 1\nf 1 1 1\n", "all its points lie in one place"),
    "large.obj": ("v 0 0 0\nv 9e6 0 0\nv 9e6 9e6 5e6\nv 0 5 9e6\nf 1 2 3\nf 1 3 4\n", "it is huge"),
    "cloud.obj": ("v 0 0 0\nv 9 0 0\n", "it has no faces"),
    "mtl.obj": ("mtllib /etc/passwd\nv 0 0 0\nv 1 0 0\nv 1 1 1\nf 1 2 3\n", "outside the folder"),
    "wrong.obj": ("v 0 0 0\nv 1 0 0\nv 1 1 1\nf 1 2 99\n", "it is broken"),
    "text.usdc": ("PXR-USDC but cut", "it is broken"),
    "link.usda": ("#usda 1.0\n(subLayers=[@/etc/a.usd@])", "outside the folder"),
    "no.usd": ("hello", "it is no USD file"),
    "no.blend": ("hello", "it is no Blender file"),
    "old.fbx": ("x", 'files of type ".fbx" are not read'),
}


def test_bad_files_are_refused_by_name_with_the_reason_and_the_rest_is_imported(tmp_path):
    folder = tmp_path / "in"
    write_ell(folder / "good.obj")
    for name, (content, _) in BAD.items():
        (folder / name).write_bytes(content if isinstance(content, bytes) else content.encode())
    with zipfile.ZipFile(folder / "bomb.usdz", "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("a.usda", "#usda 1.0\n" + " " * 1_000_000)
    found = imported(folder, tmp_path)
    assert found.count == 1
    said = {refusal.path: str(refusal) for refusal in found.refusals}
    assert set(said) == {*BAD, "bomb.usdz"}
    for name, (_, words) in BAD.items():
        assert words in said[name]
        assert said[name].startswith(f"{name} is refused: ")
    assert "is compressed, which USDZ forbids" in said["bomb.usdz"]


def test_a_folder_of_bad_files_alone_writes_nothing(tmp_path):
    (tmp_path / "in").mkdir()
    (tmp_path / "in" / "a.glb").write_bytes(b"")
    with pytest.raises(InputError, match=r"a\.glb is refused: it is empty"):
        imported(tmp_path / "in", tmp_path)
    assert not (tmp_path / "library").exists()
    (tmp_path / "none").mkdir()
    with pytest.raises(InputError, match="holds no models"):
        imported(tmp_path / "none", tmp_path)


def test_too_many_triangles_are_refused_before_they_are_read(tmp_path, monkeypatch):
    monkeypatch.setattr(hostile, "MAX_TRIANGLES", 10)
    write_ell(tmp_path / "in" / "a.obj")
    with pytest.raises(InputError, match=r"it is huge: 0\.0 million triangles"):
        imported(tmp_path / "in", tmp_path)


def test_a_link_out_of_the_folder_is_refused(tmp_path):
    write_ell(tmp_path / "elsewhere.obj")
    (tmp_path / "in").mkdir()
    (tmp_path / "in" / "a.obj").symlink_to(tmp_path / "elsewhere.obj")
    with pytest.raises(InputError, match="a link to a file outside the folder"):
        imported(tmp_path / "in", tmp_path)


@pytest.mark.parametrize("name", ["../x", "/x", "C:\\x", "..\\x", "file:///x", "a/../../x", "~/x"])
def test_no_reference_leaves_the_folder(tmp_path, name):
    with pytest.raises(Refused):
        inside(name, tmp_path / "model.gltf", tmp_path)


def test_a_reference_within_the_folder_is_resolved(tmp_path):
    (tmp_path / "sub").mkdir()
    found = inside("../a%20b.bin", tmp_path / "sub" / "m.gltf", tmp_path)
    assert found == (tmp_path / "a b.bin").resolve()


def test_a_file_that_is_there_already_is_not_added_twice(tmp_path):
    write_ell(tmp_path / "in" / "a.obj")
    imported(tmp_path / "in", tmp_path)
    again = imported(tmp_path / "in", tmp_path)
    assert again.count == 0
    assert len(again.library.catalogue) == 1


def test_a_wrong_sidecar_is_a_reason_to_refuse(tmp_path):
    write_ell(tmp_path / "in" / "a.obj")
    (tmp_path / "in" / "a.json").write_text('{"group": "castles", "unit": "league"}')
    with pytest.raises(InputError, match=r'group "castles" is none of .*unit "league" is none of'):
        imported(tmp_path / "in", tmp_path)


def test_another_encoder_is_refused_before_the_library_changes(tmp_path, fake_sight):
    write_ell(tmp_path / "in" / "a.obj")
    imported(tmp_path / "in", tmp_path)
    with pytest.raises(UsageError, match="cannot be compared"):
        import_folder(tmp_path / "in", tmp_path / "library", fake_sight)


def test_lz4_blocks_are_unpacked_and_bombs_refused():
    assert lz4_block(bytes([0x50]) + b"hello", 5) == b"hello"
    run = bytes([0x14]) + b"a" + bytes([1, 0])  # one letter, repeated eight times
    assert lz4_block(run + bytes([0x10]) + b"b", 20) == b"a" * 9 + b"b"
    with pytest.raises(ValueError, match="longer than it says"):
        lz4_block(bytes([0x1F]) + b"a" + bytes([1, 0]) + bytes([255] * 50) + bytes([0]), 1000)


def test_the_outline_of_two_bodies_is_their_hull():
    first, second = trimesh.creation.box((2, 2, 2)), trimesh.creation.box((2, 2, 2))
    second.apply_translation((10, 0, 0))
    both = trimesh.util.concatenate([first, second])
    outline = outline_of(np.asarray(both.vertices), np.asarray(both.faces))
    assert outline.area == pytest.approx(24.0, rel=0.02)


@pytest.mark.blender
def test_blend_and_usd_files_are_read_and_their_scripts_do_not_run(tmp_path):
    import subprocess
    import sys

    folder = tmp_path / "in"
    folder.mkdir()
    script = tmp_path / "make.py"
    script.write_text(MAKE.format(folder=str(folder), mark=str(tmp_path / "ran")))
    subprocess.run([sys.executable, str(script)], check=True, capture_output=True, timeout=100)
    (tmp_path / "ran").unlink(missing_ok=True)  # by the maker's own evaluation
    (folder / "broken.blend").write_bytes(b"BLENDER-v405" + bytes(4000))
    found = imported(folder, tmp_path)
    table = found.library.catalogue
    assert sorted(table["collection"]) == ["eu_1_building_8", "tower"]
    row = table["collection"].tolist().index("eu_1_building_8")
    assert (table["length"][row], table["width"][row]) == (49.0, 38.0)
    assert (table["x"][row], table["y"][row]) == (158.5, 165.0)
    said = {refusal.path: refusal.reason for refusal in found.refusals}
    assert set(said) == {"broken.blend", "outside.blend"}
    assert "outside the folder" in said["outside.blend"]
    assert not (tmp_path / "ran").exists()


MAKE = """
import os
import bpy
bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
def cube(name, at, size):
    group = bpy.data.collections.new(name)
    bpy.context.scene.collection.children.link(group)
    bpy.ops.mesh.primitive_cube_add(size=1, location=at)
    item = bpy.context.object
    item.scale = size
    for held in item.users_collection:
        held.objects.unlink(item)
    group.objects.link(item)
    return item
tower = cube("Tower", (0, 0, 15), (10, 10, 30))
bpy.ops.wm.usd_export(filepath="{folder}/tower.usdc")
bpy.data.collections.remove(bpy.data.collections["Tower"])
bpy.data.objects.remove(tower)
item = cube("Eu_1_building_8", (158.5, 165, 10), (49, 38, 20))
text = bpy.data.texts.new("run.py")
text.write("open('{mark}', 'w').write('x')")
text.use_module = True
driver = item.driver_add("rotation_euler", 0).driver
driver.type = "SCRIPTED"
driver.expression = "__import__('os').mkdir('{mark}') or 0.0"
bpy.ops.wm.save_as_mainfile(filepath="{folder}/Assets.blend")
image = bpy.data.images.new("far", 4, 4)
image.source = "FILE"
image.filepath = "/etc/far.png"
material = bpy.data.materials.new("far")
material.use_nodes = True
node = material.node_tree.nodes.new("ShaderNodeTexImage")
node.image = image
item.data.materials.append(material)
bpy.ops.wm.save_as_mainfile(filepath="{folder}/outside.blend")
os._exit(0)
"""
