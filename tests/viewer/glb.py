"""Reads GLBs whose arrays are compressed, independently of what wrote them."""

import json
import struct

import meshopt
import numpy as np

KINDS = {5120: np.int8, 5121: np.uint8, 5122: np.int16, 5123: np.uint16, 5125: np.uint32,
         5126: np.float32}  # fmt: skip
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}


class Glb:
    def __init__(self, data):
        magic, version, length = struct.unpack_from("<4sII", data)
        assert (magic, version, length) == (b"glTF", 2, len(data))
        size = struct.unpack_from("<I", data, 12)[0]
        self.json = json.loads(data[20 : 20 + size])
        self.binary = data[28 + size :]

    def view(self, number):
        view = self.json["bufferViews"][number]
        packed = view.get("extensions", {}).get("EXT_meshopt_compression")
        if packed is None:
            first = view.get("byteOffset", 0)
            return self.binary[first : first + view["byteLength"]], view.get("byteStride")
        stream = self.binary[packed["byteOffset"] :][: packed["byteLength"]]
        count, stride = packed["count"], packed["byteStride"]
        return meshopt.decode_gltf_buffer(stream, count, stride, packed["mode"]).tobytes(), stride

    def array(self, number):
        item = self.json["accessors"][number]
        data, stride = self.view(item["bufferView"])
        width, kind = WIDTHS[item["type"]], np.dtype(KINDS[item["componentType"]])
        stride = stride or width * kind.itemsize
        first = item.get("byteOffset", 0)
        data = np.frombuffer(data, np.uint8)[first : first + item["count"] * stride]
        rows = data.reshape(item["count"], stride)
        return np.ascontiguousarray(rows[:, : width * kind.itemsize]).view(kind)

    def ids(self, layer=""):
        """The ids of the property table by feature id, "" for those of other layers than one."""
        extension = self.json.get("extensions", {}).get("EXT_structural_metadata")
        if extension is None:
            return []
        (table,) = extension["propertyTables"]
        text, _ = self.view(table["properties"]["id"]["values"])
        which, _ = self.view(table["properties"]["layer"]["values"])
        names = [each["name"] for each in extension["schema"]["enums"]["layer"]["values"]]
        ids = [text[i : i + 16].decode() for i in range(0, 16 * table["count"], 16)]
        return [key if not layer or names[which[row]] == layer else ""
                for row, key in enumerate(ids)]  # fmt: skip

    def layers(self):
        return [self.json["nodes"][n] for n in self.json["scenes"][0]["nodes"]]

    def triangles(self, layer):
        """Corners of triangles in metres, z up, (t, 3, 3), and the id of each, (t,)."""
        corners, owners = [], []
        for node in self.json["nodes"]:
            if node["name"] != layer or "mesh" not in node:
                continue
            ids = np.array(self.ids(layer))
            scale, shift = node.get("scale", [1, 1, 1]), node["translation"]
            for part in self.json["meshes"][node["mesh"]]["primitives"]:
                place = self.array(part["attributes"]["POSITION"]) * np.array(scale) + shift
                place = place[:, [0, 2, 1]] * [1, -1, 1]
                feature = self.array(part["attributes"]["_FEATURE_ID_0"])[:, 0].astype(int)
                index = self.array(part["indices"]).reshape(-1, 3)
                corners.append(place[index])
                owners.append(ids[feature[index[:, 0]]])
        return np.concatenate(corners), np.concatenate(owners)
