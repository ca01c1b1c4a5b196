"""The USD writer; all but the refusal without its library need ``pip install "cityx[usd]"``."""

import json
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest
from glb_scenes import box, rows, small_city, view
from scipy.spatial.transform import Rotation
from town import small_town

from cityx.assets.furniture.street_furniture import furniture
from cityx.assets.styles.materials import MATERIALS
from cityx.assets.textures import texture
from cityx.city import Environment, Prototype, Scene, concatenate
from cityx.city.mesh import NO_VERTEX
from cityx.city.store import read_view
from cityx.cli.main import main
from cityx.errors import EngineError, MissingExtra
from cityx.ids import id_text
from cityx.options import BuildOptions
from cityx.outputs.usd import write_usd
from cityx.projects.build import build

needs_usd = pytest.mark.skipif(
    find_spec("pxr") is None, reason='usd-core is not installed: pip install "cityx[usd]"'
)


def opened(path):
    from pxr import Usd

    return Usd.Stage.Open(str(path))


def written(city, folder, **options):
    """Write without textures and open the stage."""
    path = folder / "city.usda"
    stats = write_usd(city, path, **{"texture_size": 0, **options})
    assert stats.size == path.stat().st_size
    return opened(path), stats


def faults(stage):
    from pxr import UsdValidation

    validators = UsdValidation.ValidationRegistry().GetOrLoadAllValidators()
    assert len(validators) >= 30
    return [e.GetMessage() for e in UsdValidation.ValidationContext(validators).Validate(stage)]


def layer_meshes(stage, layer):
    return [p for p in stage.GetPrimAtPath(f"/City/{layer}").GetChildren() if p.IsA("Mesh")]


def triangle_count(prim):
    return int((np.array(prim.GetAttribute("faceVertexCounts").Get()) - 2).sum())


def points_of(prim):
    """(n, 3) points in the frame of the city."""
    place = prim.GetAttribute("xformOp:translate").Get() or (0, 0, 0)
    return np.array(prim.GetAttribute("points").Get(), float) + place


def instance_points(stage, layer):
    """(n, 3) points of all instances of a layer, in the frame of the city."""
    from pxr import Usd, UsdGeom

    time = Usd.TimeCode.Default()
    instancer = UsdGeom.PointInstancer.Get(stage, f"/City/{layer}")
    origin = instancer.GetPrim().GetAttribute("xformOp:translate").Get()
    targets = instancer.GetPrototypesRel().GetTargets()
    shapes = [points_of(stage.GetPrimAtPath(path)) for path in targets]
    turns = np.array(instancer.ComputeInstanceTransformsAtTime(time, time))  # (n, 4, 4), rows
    index = instancer.GetProtoIndicesAttr().Get()
    placed = [shapes[i] @ turn[:3, :3] + turn[3, :3] for i, turn in zip(index, turns, strict=True)]
    return np.concatenate(placed) + origin


def scene_points(scene, layer):
    """(n, 3) the same from the arrays of the scene, whether it is of meshes or instances."""
    if layer in scene.meshes:
        batch = scene.meshes[layer]
        return batch.vertices[np.unique(batch.faces[batch.faces != NO_VERTEX])]
    table = scene.instances[layer]
    turns = Rotation.from_euler("xyz", table.rotation)
    return np.concatenate(
        [
            turn.apply(scene.prototypes[p].mesh.vertices * scale) + place
            for p, turn, scale, place in zip(
                table.prototype, turns, table.scale, table.position, strict=True
            )
        ]
    )


def bounds(points):
    return np.array([points.min(axis=0), points.max(axis=0)])


@pytest.fixture(scope="module")
def town(tmp_path_factory):
    """A rainy night in the town: wet materials and lamps that glow."""
    folder = tmp_path_factory.mktemp("town")
    options = BuildOptions(formats=("usd",), render=False, weather="rain", time="21:30")
    build([small_town().write(folder / "town.osm")], folder / "city", options)
    return folder / "city", read_view(folder / "city" / "city").scene


@needs_usd
def test_a_town_as_built_passes_every_validator(town):
    out, _ = town
    assert {"city.usdc", "city_textures"} <= {path.name for path in out.iterdir()}
    assert faults(opened(out / "city.usdc")) == []


@needs_usd
def test_a_town_has_the_meshes_triangles_and_ids_of_its_scene(town):
    out, scene = town
    stage = opened(out / "city.usdc")
    assert scene.meshes
    for layer, batch in scene.meshes.items():
        meshes = layer_meshes(stage, layer)
        full = np.diff(batch.face_start) > 0
        ids = [prim.GetAttribute("cityx:id").Get() for prim in meshes]
        assert sorted(ids) == sorted(map(id_text, batch.object_id[full].tolist()))
        assert all(prim.GetName().endswith(text) for prim, text in zip(meshes, ids, strict=True))
        assert sum(map(triangle_count, meshes)) == batch.triangle_count


@needs_usd
def test_a_town_has_the_instances_and_ids_of_its_scene(town):
    from pxr import UsdGeom

    out, scene = town
    stage = opened(out / "city.usdc")
    assert scene.instances
    for layer, table in scene.instances.items():
        instancer = UsdGeom.PointInstancer.Get(stage, f"/City/{layer}")
        ids = np.array(instancer.GetIdsAttr().Get(), np.int64).view(np.uint64)
        owners = np.array(instancer.GetPrim().GetAttribute("cityx:owner").Get(), np.int64)
        np.testing.assert_array_equal(ids, table.object_id)
        np.testing.assert_array_equal(owners.view(np.uint64), table.owner)
        assert triangle_counts(stage, instancer) == [
            scene.prototypes[p].mesh.triangle_count for p in table.prototype.tolist()
        ]


@needs_usd
def test_things_that_can_be_pushed_are_rigid_bodies_and_walls_collide_by_their_faces(tmp_path):
    from pxr import UsdPhysics, UsdShade

    bench = furniture("bench")
    scene = (
        Scene().with_mesh("buildings", box(1)).with_instances("things", [bench], rows([[0, 0, 0]]))
    )
    stage, _ = written(view(scene), tmp_path)
    assert faults(stage) == []
    piece = stage.GetPrimAtPath("/City/things/Prototypes").GetChildren()[0]
    assert piece.HasAPI(UsdPhysics.RigidBodyAPI)
    assert 35 < UsdPhysics.MassAPI(piece).GetMassAttr().Get() < 80
    (wall,) = layer_meshes(stage, "buildings")
    assert not wall.HasAPI(UsdPhysics.RigidBodyAPI)
    assert wall.HasAPI(UsdPhysics.CollisionAPI)
    assert UsdPhysics.MeshCollisionAPI(wall).GetApproximationAttr().Get() == "none"
    touch, _ = UsdShade.MaterialBindingAPI(wall).ComputeBoundMaterial("physics")
    assert UsdPhysics.MaterialAPI(touch).GetDynamicFrictionAttr().Get() == pytest.approx(0.65)
    assert (
        UsdPhysics.Scene(stage.GetPrimAtPath("/City/Physics")).GetGravityMagnitudeAttr().Get() > 9
    )


def triangle_counts(stage, instancer):
    """Triangles of each instance."""
    targets = instancer.GetPrototypesRel().GetTargets()
    counts = [triangle_count(stage.GetPrimAtPath(path)) for path in targets]
    return [counts[index] for index in instancer.GetProtoIndicesAttr().Get()]


@needs_usd
def test_a_town_has_the_bounds_of_its_scene_layer_by_layer(town):
    out, scene = town
    stage = opened(out / "city.usdc")
    assert scene.meshes
    for layer in scene.meshes:
        points = np.concatenate([points_of(prim) for prim in layer_meshes(stage, layer)])
        np.testing.assert_allclose(bounds(points), bounds(scene_points(scene, layer)), atol=1e-4)
    assert scene.instances
    for layer in scene.instances:
        found, wanted = instance_points(stage, layer), scene_points(scene, layer)
        np.testing.assert_allclose(bounds(found), bounds(wanted), atol=1e-4, err_msg=layer)


@needs_usd
def test_every_face_of_a_town_has_a_material_and_every_texture_lies_on_disk(town):
    from pxr import Sdf, UsdGeom, UsdShade

    out, _ = town
    stage = opened(out / "city.usdc")
    for prim in filter(UsdGeom.Mesh, stage.Traverse()):
        binding = UsdShade.MaterialBindingAPI(prim)
        for part in binding.GetMaterialBindSubsets() or [prim]:
            material, _ = UsdShade.MaterialBindingAPI(part).ComputeBoundMaterial()
            assert material.ComputeSurfaceSource()[0].GetShaderId() == "UsdPreviewSurface"
    files = {
        attribute.Get().resolvedPath
        for prim in stage.Traverse()
        for attribute in prim.GetAttributes()
        if attribute.GetTypeName() == Sdf.ValueTypeNames.Asset
    }
    assert files == {str(path) for path in (out / "city_textures").iterdir()}
    assert len(files) > 10


BLENDER = """
import json, sys
import bpy
import numpy as np
bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True, load_ui=False)
bpy.ops.wm.usd_import(filepath=sys.argv[1])
low, high, count = np.full(3, np.inf), np.full(3, -np.inf), 0
for instance in bpy.context.evaluated_depsgraph_get().object_instances:
    if instance.object.type == "MESH":
        points = np.empty(3 * len(instance.object.data.vertices), np.float32)
        instance.object.data.vertices.foreach_get("co", points)
        turn = np.array(instance.matrix_world)
        points = points.reshape(-1, 3) @ turn[:3, :3].T + turn[:3, 3]
        low, high = np.minimum(low, points.min(axis=0)), np.maximum(high, points.max(axis=0))
        count += 1
images = [image.name for image in bpy.data.images if image.size[0]]
print("@" + json.dumps([[low.tolist(), high.tolist()], count, images]))
"""


@needs_usd
@pytest.mark.blender
@pytest.mark.skipif(find_spec("bpy") is None, reason="bpy is not installed")
def test_blender_opens_a_town_with_the_same_bounds_objects_and_textures(town):
    out, scene = town
    command = [sys.executable, "-c", BLENDER, out / "city.usdc"]
    words = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    line = next(line for line in words.splitlines() if line.startswith("@["))
    box_found, count, images = json.loads(line[1:])
    layers = [*scene.meshes, *scene.instances]
    points = np.concatenate([scene_points(scene, layer) for layer in layers])
    np.testing.assert_allclose(box_found, bounds(points), atol=0.001)
    objects = sum(np.count_nonzero(np.diff(b.face_start)) for b in scene.meshes.values())
    assert count == objects + sum(table.count for table in scene.instances.values())
    assert set(images) == {path.name for path in (out / "city_textures").iterdir()}


@needs_usd
def test_frame_units_seed_and_attribution_travel_with_the_file(tmp_path):
    from pxr import UsdGeom, UsdPhysics

    stage, _ = written(small_city(), tmp_path)
    assert UsdGeom.GetStageUpAxis(stage) == "Z"
    assert UsdGeom.GetStageMetersPerUnit(stage) == 1
    assert UsdPhysics.GetStageKilogramsPerUnit(stage) == 1
    assert stage.GetDefaultPrim().GetPath() == "/City"
    record = stage.GetRootLayer().customLayerData
    assert record["projection"].startswith("+proj=tmerc +lat_0=51.5")
    assert (record["latitude"], record["longitude"], record["seed"]) == (51.5, -0.13, 3)
    assert list(record["attribution"]) == ["© OpenStreetMap contributors, ODbL 1.0"]


@needs_usd
def test_objects_carry_their_id_class_and_what_is_known_of_them(tmp_path):
    from pxr import UsdSemantics

    stage, _ = written(small_city(), tmp_path)
    prim = stage.GetPrimAtPath("/City/buildings/building_0000000000000001")
    facts = {a.GetBaseName(): a.Get() for a in prim.GetAttributes() if a.GetNamespace() == "cityx"}
    assert facts == {
        "id": "0000000000000001",
        "kind": "building",
        "name": "Town Hall",
        "source": "osm/way/1",
        "use": "civic",
    }
    for path, word in [
        (prim.GetPath(), "building"),
        ("/City/ground/ground_0000000000000007", "ground"),
        ("/City/lamps/Prototypes/lamp_24_0_0", "furniture"),
    ]:
        labels = UsdSemantics.LabelsAPI(stage.GetPrimAtPath(path), "class").GetLabelsAttr().Get()
        assert list(labels) == [word]


@needs_usd
def test_every_face_has_a_normal_that_points_out_of_a_solid(tmp_path):
    stage, _ = written(view(Scene().with_mesh("buildings", box(1))), tmp_path)
    (mesh,) = layer_meshes(stage, "buildings")
    points = np.array(mesh.GetAttribute("points").Get())
    corners = points[np.array(mesh.GetAttribute("faceVertexIndices").Get()).reshape(6, 4)]
    outward = corners.mean(axis=1) - points.mean(axis=0)
    normals = np.array(mesh.GetAttribute("normals").Get())
    np.testing.assert_allclose(normals, outward / 5, atol=1e-6)


@needs_usd
def test_texture_coordinates_count_tiles_and_t_runs_up(tmp_path):
    stage, _ = written(view(Scene().with_mesh("buildings", box(1))), tmp_path)
    (mesh,) = layer_meshes(stage, "buildings")
    st = np.array(mesh.GetAttribute("primvars:st").Get())[: 4 * 4]  # bricks come first
    assert st.max(axis=0).tolist() == [10 / MATERIALS["brick"].tile] * 2
    assert st.min(axis=0).tolist() == [0, 0]


@needs_usd
def test_a_tint_scales_the_texture_and_colors_the_face(tmp_path):
    scene = Scene().with_mesh("buildings", box(1, tint=(0.25, 1, 1), materials=("brick", "glass")))
    stage, _ = written(view(scene), tmp_path, texture_size=32)
    (mesh,) = layer_meshes(stage, "buildings")
    brick, glass = mesh.GetChildren()
    assert brick.GetName() == "brick_12_24_24"
    assert list(brick.GetAttribute("indices").Get()) == [0, 1, 2, 3]
    scale = stage.GetAttributeAtPath("/City/Materials/brick_12_24_24/Color.inputs:scale").Get()
    full = min(1, MATERIALS["brick"].color[0] / texture("brick", 32).mean)
    np.testing.assert_allclose(scale, [full / 4, full, full, 1], atol=1e-6)
    shown = np.array(mesh.GetAttribute("primvars:displayColor").Get())
    np.testing.assert_allclose(shown, [[0.2, 0.8, 0.8], MATERIALS["glass"].color], atol=1e-6)
    assert glass.GetRelationship("material:binding").GetTargets() == ["/City/Materials/glass"]


@needs_usd
def test_without_a_texture_the_material_reads_the_color_of_the_face(tmp_path):
    stage, _ = written(small_city(), tmp_path)
    paint = stage.GetPrimAtPath("/City/Materials/brick/Paint")
    assert paint.GetAttribute("info:id").Get() == "UsdPrimvarReader_float3"
    assert paint.GetAttribute("inputs:varname").Get() == "displayColor"
    assert not stage.GetPrimAtPath("/City/Materials/brick/Color")
    assert not (tmp_path / "city_textures").exists()


@needs_usd
def test_tints_of_instances_become_prototypes_that_share_all_but_color(tmp_path):
    stage, stats = written(small_city(), tmp_path)
    lamps = stage.GetPrimAtPath("/City/lamps/Prototypes").GetChildren()
    assert [prim.GetName() for prim in lamps] == ["lamp_0_24_0", "lamp_24_0_0"]
    assert stats.prototypes == 2
    for prim, tint in zip(lamps, ([0, 1, 0], [1, 0, 0]), strict=True):
        spec = stage.GetRootLayer().GetPrimAtPath(prim.GetPath())
        assert "points" not in spec.properties
        assert len(prim.GetAttribute("points").Get()) == 8
        dark, sign = np.array(prim.GetAttribute("primvars:displayColor").Get())
        np.testing.assert_allclose(dark, MATERIALS["metal_dark"].color, atol=1e-6)
        own = np.multiply(MATERIALS["sign"].color, (0.5, 0.25, 0.1))  # small_city's lamps
        np.testing.assert_allclose(sign, own * tint, atol=0.01)


@needs_usd
def test_turned_and_stretched_instances_stand_where_the_scene_has_them(tmp_path):
    rng = np.random.default_rng(4)
    angles, scale = rng.uniform(-3, 3, (6, 3)), rng.uniform(0.5, 2, (6, 3))
    table = rows(rng.uniform(-900, 900, (6, 3)), rotation=angles, scale=scale)
    lamp = Prototype("lamp", "furniture", box(0, (0, 0, 0), (0.2, 0.5, 4)))
    scene = Scene().with_instances("lamps", [lamp], table)
    stage, _ = written(view(scene), tmp_path)
    np.testing.assert_allclose(
        instance_points(stage, "lamps"), scene_points(scene, "lamps"), atol=1e-4
    )


@needs_usd
def test_lamps_glow_at_night_only(tmp_path):
    scene = Scene().with_mesh("buildings", box(1, materials=("window_lit", "brick")))
    path = "/City/Materials/window_lit/Surface.inputs:emissiveColor"
    day, _ = written(view(scene), tmp_path / "day")
    night, _ = written(view(scene, environment=Environment(night_lights=0.6)), tmp_path / "night")
    assert not day.GetAttributeAtPath(path)
    assert max(night.GetAttributeAtPath(path).Get()) == MATERIALS["window_lit"].emission


@needs_usd
def test_the_sun_shines_from_where_it_stands_and_not_at_night(tmp_path):
    from pxr import Gf, UsdGeom

    up, turn = np.radians(25.0), np.radians(250.0)
    scene = Scene().with_mesh("buildings", box(1))
    light = Environment(sun_elevation=up, sun_azimuth=turn)
    day, _ = written(view(scene, environment=light), tmp_path / "day")
    matrix = UsdGeom.Xformable(day.GetPrimAtPath("/City/Sun")).GetLocalTransformation()
    shines = matrix.TransformDir(Gf.Vec3d(0, 0, -1))
    toward = [np.sin(turn) * np.cos(up), np.cos(turn) * np.cos(up), np.sin(up)]
    np.testing.assert_allclose(shines, -np.array(toward), atol=1e-5)
    dark = Environment(sun_elevation=-0.3)
    night, _ = written(view(scene, environment=dark), tmp_path / "night")
    assert not night.GetPrimAtPath("/City/Sun")


@needs_usd
def test_thin_sheets_are_seen_from_both_sides(tmp_path):
    boxes = concatenate([box(1, materials=("cloth", "brick")), box(2)])
    stage, _ = written(view(Scene().with_mesh("buildings", boxes)), tmp_path)
    sides = [mesh.GetAttribute("doubleSided").Get() for mesh in layer_meshes(stage, "buildings")]
    assert sides == [True, False]


@needs_usd
def test_too_many_objects_are_merged_by_tile_and_keep_their_ids(tmp_path, monkeypatch):
    monkeypatch.setattr("cityx.outputs.usd_layer.MOST_OBJECTS", 2)
    boxes = concatenate([box(1), box(2, (-300, 0, 0)), box(3, (20, 0, 0))])
    stage, stats = written(view(Scene().with_mesh("buildings", boxes)), tmp_path)
    meshes = layer_meshes(stage, "buildings")
    assert [mesh.GetName() for mesh in meshes] == ["buildings_tile__2_0", "buildings_tile_0_0"]
    ids = [list(mesh.GetAttribute("primvars:cityx:id").Get()) for mesh in meshes]
    assert [sorted(part) for part in ids] == [[2] * 6, [1] * 6 + [3] * 6]
    assert stats.triangles_unique == 36
    assert faults(stage) == []


@needs_usd
def test_names_from_elsewhere_become_names_that_usd_allows(tmp_path):
    models = [Prototype(name, "furniture", box(0)) for name in ("old lamp", "old-lamp", "灯")]
    table = rows([[0, 0, 0], [20, 0, 0], [40, 0, 0]], prototype=[0, 1, 2])
    scene = Scene().with_mesh("my lamps", box(1, materials=("Material.001", "brick")))
    stage, _ = written(view(scene.with_instances("my lamps", models, table)), tmp_path)
    names = [prim.GetName() for prim in stage.GetDefaultPrim().GetAllChildren()]
    assert names == [
            "Materials", "Sun", "Physics", "Touch", "Prototypes", "my_lamps", "my_lamps_2",
        ]  # fmt: skip
    lamps = [prim.GetName() for prim in stage.GetPrimAtPath("/City/Prototypes").GetAllChildren()]
    assert len(set(lamps)) == 3
    assert faults(stage) == []


@needs_usd
def test_broken_numbers_do_not_reach_the_file(tmp_path):
    mesh = box(1)
    mesh.vertices[0, 0] = np.nan
    mesh.uv[0, 0] = np.inf
    mesh.tint[0] = np.nan
    scene = Scene().with_mesh("buildings", mesh)
    scene = scene.with_instances(
        "lamps", [Prototype("lamp", "furniture", box(0))], rows([[np.nan, 0, 0]])
    )
    stage, _ = written(view(scene), tmp_path)
    text = stage.GetRootLayer().ExportToString()
    assert "nan" not in text
    assert "inf," not in text
    assert faults(stage) == []


@needs_usd
def test_an_empty_city_is_a_file(tmp_path):
    stage, stats = written(view(Scene()), tmp_path)
    assert (stats.meshes, stats.instances) == (0, 0)
    assert faults(stage) == []


@needs_usd
def test_the_same_city_is_the_same_text_and_the_same_bytes(tmp_path):
    for place in (tmp_path / "1", tmp_path / "2"):
        for name in ("city.usda", "city.usdc"):
            write_usd(small_city(), place / name, texture_size=16)
    one, two = (
        {path.relative_to(place): path.read_bytes() for path in place.rglob("*.*")}
        for place in (tmp_path / "1", tmp_path / "2")
    )
    assert one == two
    stages = [opened(tmp_path / "1" / name) for name in ("city.usda", "city.usdc")]
    text, again = (stage.GetRootLayer().ExportToString() for stage in stages)
    assert text == again


@needs_usd
def test_a_write_that_fails_keeps_the_old_file_and_leaves_nothing_beside_it(tmp_path, monkeypatch):
    from cityx.outputs.usd_layer import UsdWriter

    class FullDisk:
        def Export(self, path):  # noqa: N802
            Path(path).write_text("half")
            return False

    def fill(self):
        self.layer = FullDisk()

    target = tmp_path / "city.usdc"
    target.write_text("old")
    monkeypatch.setattr(UsdWriter, "author_extents", fill)
    with pytest.raises(EngineError, match="could not write"):
        write_usd(small_city(), target, texture_size=0)
    assert target.read_text() == "old"
    assert list(tmp_path.iterdir()) == [target]


@pytest.fixture
def without_usd(monkeypatch):
    monkeypatch.setitem(sys.modules, "pxr", None)
    monkeypatch.setitem(sys.modules, "pxr.Usd", None)


@pytest.mark.usefixtures("without_usd")
def test_without_the_library_the_command_ends_with_code_two_before_it_begins(
    monkeypatch, capsys, tmp_path
):
    out = tmp_path / "out"
    words = ["cityx", "build", str(tmp_path / "no.osm"), "-o", str(out), "--formats", "glb,usd"]
    monkeypatch.setattr(sys, "argv", words)
    with pytest.raises(SystemExit) as stop:
        main()
    assert stop.value.code == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith("error: The format usd needs usd-core (")
    assert line.endswith('); install it with: pip install "cityx[usd]"')
    assert list(tmp_path.iterdir()) == []


@pytest.mark.usefixtures("without_usd")
def test_without_the_library_nothing_is_written(tmp_path):
    with pytest.raises(MissingExtra, match=r"cityx\[usd\]"):
        write_usd(small_city(), tmp_path / "city.usdc")
    assert list(tmp_path.iterdir()) == []
