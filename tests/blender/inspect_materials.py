"""Tell of a .blend what its materials and groups are made of, on a line that begins with @."""

import hashlib
import json
import sys

import bpy  # noqa: TID251

from cityx.blender.operators import call

PLAIN = (int, float, str, bool)


def told(value):
    """Return a value of a node as JSON has it."""
    if isinstance(value, bpy.types.ID):
        return value.name
    if value is None or isinstance(value, PLAIN):
        return value
    try:
        return [round(float(part), 6) for part in value]
    except TypeError:
        return type(value).__name__


def tree(held):
    """Return nodes with their properties and values, and links."""
    nodes = {
        node.name: [
            {p.identifier: told(getattr(node, p.identifier)) for p in node.bl_rna.properties
             if p.type in ("BOOLEAN", "INT", "FLOAT", "STRING", "ENUM")
             and p.identifier not in ("location_absolute", "dimensions", "width_hidden")},
            [told(getattr(socket, "default_value", None)) for socket in node.inputs],
            told(getattr(node, "image", None)), told(getattr(node, "node_tree", None)),
        ]
        for node in held.nodes
    }  # fmt: skip
    links = sorted(
        [link.from_node.name, link.from_socket.identifier, link.to_node.name,
         link.to_socket.identifier] for link in held.links
    )  # fmt: skip
    return [nodes, links]


call("wm.open_mainfile", filepath=sys.argv[1], load_ui=False)
images = {
    image.name: [image.filepath, image.colorspace_settings.name, image.use_fake_user,
                 hashlib.md5(image.packed_file.data, usedforsecurity=False).hexdigest()]
    for image in bpy.data.images if image.packed_file
}  # fmt: skip
found = {
    "materials": {m.name: [tree(m.node_tree), m.use_fake_user, list(m.diffuse_color)]
                  for m in bpy.data.materials},
    "groups": {g.name: tree(g) for g in bpy.data.node_groups if g.bl_idname == "ShaderNodeTree"},
    "images": images,
    "libraries": len(bpy.data.libraries),
}  # fmt: skip
sys.stdout.write(f"@{json.dumps(found)}\n")
