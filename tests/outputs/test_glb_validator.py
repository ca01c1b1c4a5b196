"""The Khronos validator on our files: ``make validator`` brings it."""

import json
import os
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest
from glb_scenes import box, read_glb, small_city, view
from town import small_town

from cityx.city import Environment, Scene, concatenate
from cityx.city.store import read_city
from cityx.options import BuildOptions
from cityx.outputs import glb as glb_module
from cityx.outputs.glb import write_glb
from cityx.projects.build import build

SCRIPT = """
const validator = require(process.argv[1]);
const bytes = new Uint8Array(require('fs').readFileSync(process.argv[2]));
validator.validateBytes(bytes).then(report => console.log(JSON.stringify(report)));
"""
# Tangents are left to the viewer (MikkTSpace), which halves the size; the validator says so.
EXPECTED = {"MESH_PRIMITIVE_GENERATED_TANGENT_SPACE", "UNSUPPORTED_EXTENSION"}


def validator():
    root = Path(__file__).parents[2] / "node_modules" / "gltf-validator"
    folder = Path(os.environ.get("GLTF_VALIDATOR_DIR", root))
    if shutil.which("node") is None:
        pytest.skip("node is not installed")
    for place in (folder, folder / "gltf-validator", folder / "node_modules" / "gltf-validator"):
        if (place / "package.json").is_file() and place.name == "gltf-validator":
            return place
    pytest.skip(f"no npm package gltf-validator in {folder}; run: make validator")
    return folder


def messages(path):
    command = ["node", "-e", SCRIPT, str(validator()), str(path)]
    answer = subprocess.run(command, capture_output=True, text=True, timeout=120, check=True)
    report = json.loads(answer.stdout)
    assert report["issues"]["numErrors"] == 0, report["issues"]["messages"][:5]
    return {m["code"] for m in report["issues"]["messages"] if m["severity"] <= 1}


@pytest.mark.parametrize("instancing", [True, False])
def test_a_small_city_is_valid(tmp_path, instancing):
    city = small_city(environment=Environment(night_lights=0.5, wetness=1.0))
    write_glb(city, tmp_path / "city.glb", instancing=instancing, texture_size=64)
    assert messages(tmp_path / "city.glb") <= EXPECTED


def test_merged_tiles_are_valid(tmp_path, monkeypatch):
    monkeypatch.setattr(glb_module, "MOST_OBJECTS", 1)
    scene = Scene().with_mesh("buildings", concatenate([box(1), box(2, (400, 0, 0))]))
    write_glb(view(scene), tmp_path / "city.glb", texture_size=0)
    assert messages(tmp_path / "city.glb") <= EXPECTED


def test_an_empty_city_is_valid(tmp_path):
    write_glb(view(Scene()), tmp_path / "city.glb")
    assert messages(tmp_path / "city.glb") <= EXPECTED


@pytest.fixture(scope="module")
def town(tmp_path_factory):
    folder = tmp_path_factory.mktemp("town")
    options = BuildOptions(formats=("glb",), render=False, weather="rain", time="21:30")
    build([small_town().write(folder / "town.osm")], folder / "city", options)
    return folder / "city"


def test_a_town_as_built_is_valid(town):
    glb = read_glb(town / "city.glb")
    assert glb.json["extensionsRequired"] == ["EXT_mesh_gpu_instancing"]
    assert len(glb.json["images"]) > 10
    assert messages(town / "city.glb") <= EXPECTED


def test_a_town_without_the_extension_is_valid(town, tmp_path):
    write_glb(read_city(town / "city"), tmp_path / "city.glb", instancing=False, texture_size=64)
    assert messages(tmp_path / "city.glb") <= {"MESH_PRIMITIVE_GENERATED_TANGENT_SPACE"}


def test_what_the_validator_cannot_see_of_instances_holds(town):
    """EXT_mesh_gpu_instancing: equal counts, unit turns, finite numbers, no node without rows."""
    glb = read_glb(town / "city.glb")
    owned = [
        node
        for node in glb.json["nodes"]
        if "EXT_mesh_gpu_instancing" in node.get("extensions", {})
    ]
    assert owned
    for node in owned:
        attributes = node["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]
        arrays = {name: glb.array(number) for name, number in attributes.items()}
        assert {"TRANSLATION", "ROTATION", "SCALE", "_CITYX_ID"} <= set(arrays)
        assert len({len(array) for array in arrays.values()}) == 1
        assert len(arrays["TRANSLATION"]) > 0
        assert np.isfinite(arrays["TRANSLATION"]).all()
        assert (arrays["SCALE"] > 0).all()
        np.testing.assert_allclose(np.linalg.norm(arrays["ROTATION"], axis=1), 1, atol=1e-6)
        assert [arrays[kind].shape[1] for kind in ("TRANSLATION", "ROTATION", "SCALE")] == [3, 4, 3]
