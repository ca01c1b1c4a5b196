"""A packed GLB is a quarter of the plain one, and holds the same city within three millimetres."""

import sys
from io import BytesIO
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).parents[1] / "viewer"))  # for glb, validating
pytest.importorskip("meshopt", reason="packed GLB needs the extra view")

from glb import Glb
from PIL import Image
from scipy.spatial.transform import Rotation

from cityx.city.store import read_view
from cityx.errors import InputError
from cityx.outputs import packing
from cityx.outputs.glb import write_glb
from cityx.outputs.packed_glb import pack_glb

INSTANCING = "EXT_mesh_gpu_instancing"


@pytest.fixture(scope="module")
def files(built_town, tmp_path_factory):
    folder = tmp_path_factory.mktemp("packed")
    write_glb(read_view(built_town(lod=2) / "city"), folder / "plain.glb")
    pack_glb(folder / "plain.glb", folder / "packed.glb")
    return folder / "plain.glb", folder / "packed.glb"


def turned(values):
    scale = 32767 if values.dtype == np.int16 else 1
    return Rotation.from_quat(values / scale)


def placed(glb, node):
    """Corners of the first instance of a node in metres, as a viewer puts them."""
    part = glb.json["meshes"][node["mesh"]]["primitives"][0]
    points = glb.array(part["attributes"]["POSITION"]).astype(float)
    points = points[glb.array(part["indices"])[:, 0]]
    if INSTANCING in node.get("extensions", {}):
        rows = node["extensions"][INSTANCING]["attributes"]
        place, turn, scale = (glb.array(rows[k]) for k in ("TRANSLATION", "ROTATION", "SCALE"))
        points = turned(turn[:1]).apply(points * scale[0]) + place[0]
    points = points * node.get("scale", [1, 1, 1])
    if "rotation" in node:
        points = Rotation.from_quat(node["rotation"]).apply(points)
    return points + node.get("translation", [0, 0, 0])


def apart(one, other):
    """How far corners of triangles are apart at most; a stream may begin each at another."""
    one, other = one.reshape(-1, 3, 3), other.reshape(-1, 3, 3)
    turns = [np.abs(one - np.roll(other, turn, axis=1)).max(axis=(1, 2)) for turn in range(3)]
    return np.min(turns, axis=0).max()


def test_every_corner_lies_within_three_millimetres_of_its_place(files):
    plain, packed = (Glb(path.read_bytes()) for path in files)
    nodes = [(one, other) for one, other in zip(plain.json["nodes"], packed.json["nodes"],
                                                strict=True) if "mesh" in one]  # fmt: skip
    moved = [apart(placed(plain, one), placed(packed, other)) for one, other in nodes]
    assert len(moved) > 200
    assert max(moved) < 0.003


def test_names_ids_materials_and_pictures_stay(files):
    plain, packed = (Glb(path.read_bytes()).json for path in files)
    for key in ("name", "extras"):
        told = [[node.get(key) for node in file["nodes"]] for file in (plain, packed)]
        assert told[0] == told[1]
    names = [[item["name"] for item in file["materials"]] for file in (plain, packed)]
    assert names[0] == names[1]
    assert len(plain["images"]) == len(packed["images"])
    rows = [node["extensions"][INSTANCING]["attributes"] for node in plain["nodes"]
            if INSTANCING in node.get("extensions", {})]  # fmt: skip
    again = [node["extensions"][INSTANCING]["attributes"] for node in packed["nodes"]
             if INSTANCING in node.get("extensions", {})]  # fmt: skip
    before, after = (Glb(path.read_bytes()) for path in files)
    for one, other in zip(rows, again, strict=True):
        assert (before.array(one["_CITYX_ID"]) == after.array(other["_CITYX_ID"])).all()


def test_pictures_are_smaller_and_look_the_same(files):
    plain, packed = (Glb(path.read_bytes()) for path in files)
    sizes = []
    for one, other in zip(plain.json["images"], packed.json["images"], strict=True):
        data = [glb.view(item["bufferView"])[0] for glb, item in ((plain, one), (packed, other))]
        sizes.append([len(part) for part in data])
        before, after = (np.asarray(Image.open(BytesIO(part)), float) for part in data)
        assert np.abs(before - after).mean() < 1.0
    before, after = np.sum(sizes, axis=0)
    assert after < 0.93 * before


def test_it_is_small_and_the_same_every_time(files, tmp_path):
    plain, packed = files
    assert packed.stat().st_size < plain.stat().st_size / 2.2
    pack_glb(plain, tmp_path / "again.glb")
    assert (tmp_path / "again.glb").read_bytes() == packed.read_bytes()


def test_the_validator_finds_no_error_in_either_form(files, tmp_path, monkeypatch):
    from validating import errors_of

    monkeypatch.setattr(packing, "codec", lambda: None)  # it does not look into streams
    pack_glb(files[0], tmp_path / "quantised.glb")
    assert errors_of([files[1], tmp_path / "quantised.glb"]) == []


def test_what_is_no_plain_glb_is_refused(files, tmp_path):
    (tmp_path / "text.glb").write_text("not a city")
    for path, said in ((tmp_path / "text.glb", "is no GLB"), (files[1], "packed already")):
        with pytest.raises(InputError, match=said):
            pack_glb(path, tmp_path / "out.glb")
    assert not (tmp_path / "out.glb").exists()
