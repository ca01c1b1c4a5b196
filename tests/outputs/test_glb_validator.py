"""The Khronos validator on our files: ``npm install`` at the project root brings it."""

import json
import os
import shutil
import subprocess
from pathlib import Path

import pytest
from glb_scenes import box, small_city, view

from cityx.city import Environment, Scene, concatenate
from cityx.outputs import glb as glb_module
from cityx.outputs.glb import write_glb

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
    pytest.skip(f"no npm package gltf-validator in {folder}; run: npm install")
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
