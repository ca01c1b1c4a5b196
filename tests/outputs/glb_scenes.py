"""Small scenes and a reader for the tests of the GLB writer."""

import json
import struct
from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np

from cityx.city import Environment, Frame, Instances, Prototype, Scene, concatenate, one_mesh

CUBE = np.array(
    [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]], float
)
SIDES = np.array(
    [[0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7], [4, 5, 6, 7], [3, 2, 1, 0]]
)
TYPES = {5122: np.int16, 5121: np.uint8, 5123: np.uint16, 5125: np.uint32, 5126: np.float32}
WIDTHS = {"MAT4": 16, "SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}


def box(object_id, place=(0, 0, 0), size=(10, 10, 10), materials=("brick", "bitumen"), **options):
    uv = np.tile(np.array([[0, 0], [10, 0], [10, 10], [0, 10]], np.float32), (6, 1, 1))
    options = {"material": [0, 0, 0, 0, 1, 1], "tint": (0.5, 0.25, 0.1), **options}
    vertices = CUBE * size + place
    return one_mesh(object_id, vertices, SIDES, materials=materials, uv=uv, **options)


def rows(position, *, rotation=None, scale=None, tint=None, prototype=None):
    count = len(position)
    return Instances(
        np.zeros(count, np.int32) if prototype is None else np.asarray(prototype, np.int32),
        np.arange(1, count + 1).astype(np.uint64) << np.uint64(40),
        np.full(count, 5, np.uint64),
        np.asarray(position, float),
        np.zeros((count, 3), np.float32) if rotation is None else np.asarray(rotation, np.float32),
        np.ones((count, 3), np.float32) if scale is None else np.asarray(scale, np.float32),
        np.ones((count, 3), np.float32) if tint is None else np.asarray(tint, np.float32),
    )


def view(scene, **options):
    values = {
        "name": "Test",
        "frame": Frame(51.5, -0.13),
        "seed": 3,
        "environment": Environment(),
        "tracks": None,
        "moment": 0.0,
        "attribution": ("© OpenStreetMap contributors, ODbL 1.0",),
        "objects": {},
    }
    return SimpleNamespace(scene=scene, **{**values, **options})


def small_city(**options):
    """Two houses on a square of grass with four lamps of two colours."""
    ground = one_mesh(
        7,
        [[-20, -20, 0], [40, -20, 0], [40, 40, 0], [-20, 40, 0]],
        [[0, 1, 2], [0, 2, 3]],
        materials=("grass",),
        uv=np.array([[[-20, -20], [40, -20], [40, 40], [0, 0]]] * 2, np.float32),
    )
    scene = Scene().with_mesh("buildings", concatenate([box(1), box(2, (20, 0, 0), (5, 5, 30))]))
    scene = scene.with_mesh("ground", ground)
    lamp = Prototype("lamp", "furniture", box(0, (0, 0, 0), (0.2, 0.2, 4), ("metal_dark", "sign")))
    places = [[-5, -5, 0], [-5, 30, 0], [30, -5, 0], [30, 30, 0]]
    tints = [[1, 0, 0], [0, 1, 0], [1, 0, 0], [0, 1, 0]]
    scene = scene.with_instances("lamps", [lamp], rows(places, tint=tints))
    objects = {1: {"kind": "building", "name": "Town Hall", "source": "osm/way/1", "use": "civic"}}
    return view(scene, objects=objects, **options)


@dataclass
class Glb:
    json: dict
    data: bytes

    def array(self, accessor):
        item = self.json["accessors"][accessor]
        place = self.json["bufferViews"][item["bufferView"]]
        width, kind = WIDTHS[item["type"]], TYPES[item["componentType"]]
        start = place.get("byteOffset", 0) + item.get("byteOffset", 0)
        values = np.frombuffer(self.data, kind, item["count"] * width, start)
        return values.reshape(item["count"], width)

    def nodes(self, name):
        return [node for node in self.json["nodes"] if node["name"] == name]

    def children(self, node):
        return [self.json["nodes"][index] for index in node.get("children", ())]

    def triangles(self, mesh):
        """(t, 3, 3) corners of a mesh in its own frame."""
        parts = []
        for primitive in self.json["meshes"][mesh]["primitives"]:
            points = self.array(primitive["attributes"]["POSITION"])
            parts.append(points[self.array(primitive["indices"]).ravel()].reshape(-1, 3, 3))
        return np.concatenate(parts)


def read_glb(path):
    content = path.read_bytes()
    magic, version, length = struct.unpack_from("<4sII", content)
    assert (magic, version, length) == (b"glTF", 2, len(content))
    size, kind = struct.unpack_from("<I4s", content, 12)
    assert kind == b"JSON"
    data = content[20 + size + 8 :] if len(content) > 20 + size else b""
    return Glb(json.loads(content[20 : 20 + size]), data)
