"""What a build leaves, opened by Blender as a stranger would: the GLB and the .blend files."""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from cityx.blender.scene import title
from cityx.city.mesh import NO_VERTEX
from cityx.city.store import read_city
from cityx.ids import id_text
from cityx.options import BuildOptions
from cityx.projects.build import build

pytestmark = pytest.mark.blender


@pytest.fixture(scope="module")
def detailed(town_map, tmp_path_factory):
    out = tmp_path_factory.mktemp("detailed") / "town"
    build([town_map], out, BuildOptions(render=False, seed=2))
    return out, read_city(out / "city")


def inspected(script, path):
    command = [sys.executable, Path(__file__).with_name(script), path]
    words = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    return json.loads(next(line for line in words.splitlines() if line.startswith("@{"))[1:])


@pytest.fixture(scope="module")
def imported(detailed):
    return inspected("inspect_glb.py", detailed[0] / "city.glb")


@pytest.fixture(scope="module")
def reopened(detailed):
    return inspected("inspect_city.py", detailed[0] / "city.blend")


def building_ids(city):
    batch = city.scene.meshes["buildings"]
    return [id_text(i) for i in batch.object_id[np.diff(batch.face_start) > 0].tolist()]


def used(mesh):
    return mesh.vertices[np.unique(mesh.faces[mesh.faces != NO_VERTEX])]


def turned(points, euler):
    """Rotate (n, 3) points by XYZ Euler angles, first about x."""
    (cx, cy, cz), (sx, sy, sz) = np.cos(euler), np.sin(euler)
    about_x = np.array([(1, 0, 0), (0, cx, -sx), (0, sx, cx)])
    about_y = np.array([(cy, 0, sy), (0, 1, 0), (-sy, 0, cy)])
    about_z = np.array([(cz, -sz, 0), (sz, cz, 0), (0, 0, 1)])
    return points @ (about_z @ about_y @ about_x).T


def layer_boxes(scene):
    """Bounding box per layer, from the arrays of the city."""
    clouds = {name: used(batch) for name, batch in scene.meshes.items() if batch.count}
    for name, rows in scene.instances.items():
        clouds[name] = np.concatenate(
            [
                turned(used(scene.prototypes[p].mesh) * scale, euler) + place
                for p, place, euler, scale in zip(
                    rows.prototype, rows.position, rows.rotation, rows.scale, strict=True
                )
            ]
        )
    return {name: (points.min(axis=0), points.max(axis=0)) for name, points in clouds.items()}


def test_the_glb_has_the_bounding_box_of_the_city_layer_by_layer(detailed, imported):
    wanted = layer_boxes(detailed[1].scene)
    assert set(imported["boxes"]) == set(wanted)
    for name, box in wanted.items():
        np.testing.assert_allclose(imported["boxes"][name], box, atol=0.01, err_msg=name)


def test_the_glb_has_an_object_for_every_building_and_every_instance(detailed, imported):
    _, city = detailed
    wanted = {name: table.count for name, table in city.scene.instances.items()}
    for name, batch in city.scene.meshes.items():
        wanted[name] = int(np.count_nonzero(np.diff(batch.face_start)))
    assert imported["counts"] == wanted
    assert [key for key, _ in imported["buildings"]] == sorted(building_ids(city))
    assert all(slots > 0 for _, slots in imported["buildings"])


def test_the_glb_brings_its_materials_and_textures(detailed, imported):
    shells = detailed[1].scene.meshes["buildings"]
    assert {shells.materials[i] for i in np.unique(shells.material)} <= set(imported["materials"])
    assert {"brick_color", "brick_normal", "asphalt_color"} <= set(imported["images"])


def test_every_building_of_the_store_is_an_object_with_its_id(detailed, reopened):
    _, city = detailed
    ids = building_ids(city)
    assert sorted(ids) == sorted(id_text(i) for i in city.layout.buildings["id"])
    assert sorted(reopened["buildings"]) == sorted(ids)
    faces = np.diff(city.scene.meshes["buildings"].face_start)
    wanted = {key: [f"building_{key}", count] for key, count in zip(ids, faces, strict=True)}
    assert reopened["buildings"] == wanted


def test_every_instance_keeps_its_id_on_its_point(detailed, reopened):
    assert detailed[1].scene.instances
    for name, rows in detailed[1].scene.instances.items():
        assert sorted(reopened["rows"][name]) == sorted(map(id_text, rows.object_id.tolist()))
        assert set(reopened["rows"][name].values()) == {1}
        assert (name in reopened["owners"]) == bool(rows.owner.any())


def test_collections_materials_and_images_are_all_there(detailed, reopened):
    scene = detailed[1].scene
    layers = [*scene.meshes, *scene.instances]
    assert {title(layer) for layer in layers} <= set(reopened["collections"])
    assert "Prototypes" in reopened["collections"]
    assert reopened["bare"] == []
    assert reopened["missing"] == []
    assert reopened["images"] > 10
    assert "OpenStreetMap" in reopened["attribution"]


def test_tiles_of_plain_prisms_keep_the_id_of_every_face(town_map, tmp_path):
    build([town_map], tmp_path / "town", BuildOptions(formats=("blend",), render=False, lod=0))
    city = read_city(tmp_path / "town" / "city")
    found = inspected("inspect_city.py", tmp_path / "town" / "city.blend")
    batch = city.scene.meshes["buildings"]
    wanted = {
        id_text(key): count
        for key, count in zip(batch.object_id.tolist(), np.diff(batch.face_start), strict=True)
    }
    assert {key: count for tile in found["faces"] for key, count in tile.items()} == wanted
    assert sum(map(len, found["faces"])) == len(wanted)  # no building lies in two tiles
    assert found["listed"] == sorted(wanted)
    assert sorted(wanted) == sorted(id_text(i) for i in city.layout.buildings["id"])
