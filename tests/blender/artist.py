"""Run in a process of its own: open a city in Blender and change it as an artist would.

``artist.py FILE.blend ACTS.json``: a list of acts, each a name below and its arguments.
"""

import json
import sys

import bpy  # noqa: TID251
import numpy as np


def ids_of(mesh):
    """(n,) ids of the points of a layer, as text."""
    words = np.zeros((2, len(mesh.attributes["id_low"].data)), np.int32)
    for half, row in zip(("low", "high"), words, strict=True):
        mesh.attributes[f"id_{half}"].data.foreach_get("value", row)
    low, high = words.view(np.uint32).astype(np.uint64)
    return [f"{key:016x}" for key in (high << np.uint64(32) | low).tolist()]


def building(key):
    return next(o for o in bpy.data.objects if o.get("cityx_id") == key and "." not in o.name)


def points(layer, keys):
    mesh = bpy.data.objects[layer].data
    return mesh, [row for row, key in enumerate(ids_of(mesh)) if key in keys]


def move_building(key, move, turn=0.0, factor=1.0):
    item = building(key)
    item.location = [a + b for a, b in zip(item.location, move, strict=True)]
    item.rotation_euler.z += turn
    item.scale = [factor] * 3


def move_by_parent(key, move):
    item, empty = building(key), bpy.data.objects.new("Handle", None)
    bpy.context.scene.collection.objects.link(empty)
    item.parent = empty
    empty.location = move


def delete_building(key):
    bpy.data.objects.remove(building(key))


def duplicate_building(key, move):
    item = building(key).copy()
    bpy.context.scene.collection.objects.link(item)
    item.location = [a + b for a, b in zip(item.location, move, strict=True)]


def give_material(key, slot, color):
    material = bpy.data.materials.new("My own")
    material.use_nodes = True
    shader = material.node_tree.nodes["Principled BSDF"]
    shader.inputs["Base Color"].default_value = (*color, 1.0)
    building(key).data.materials[slot] = material


def color_object(key, color):
    building(key).color = (*color, 1.0)


def tint_faces(key, color):
    attribute = building(key).data.attributes["tint"]
    for face in attribute.data:
        face.color = (*color, 1.0)


def reshape_building(key):
    building(key).data.vertices[0].co.z += 2.0


def move_points(layer, keys, move):
    mesh, rows = points(layer, keys)
    for row in rows:
        mesh.vertices[row].co.x += move[0]
        mesh.vertices[row].co.y += move[1]


def set_points(layer, keys, name, value):
    mesh, rows = points(layer, keys)
    for row in rows:
        mesh.attributes[name].data[row].vector = value


def edit_points(layer, keys, delete):
    """Delete or duplicate points as edit mode does."""
    import bmesh

    mesh, rows = points(layer, keys)
    form = bmesh.new()
    form.from_mesh(mesh)
    form.verts.ensure_lookup_table()
    chosen = [form.verts[row] for row in rows]
    if delete:
        bmesh.ops.delete(form, geom=chosen, context="VERTS")
    else:
        made = bmesh.ops.duplicate(form, geom=chosen)
        for vertex in made["geom"]:
            vertex.co.x += 2.0
    form.to_mesh(mesh)
    form.free()


def move_layer(layer, move):
    next(o for o in bpy.data.objects if o.get("cityx_layer") == layer).location = move


def delete_layer(layer):
    bpy.data.objects.remove(bpy.data.objects[layer])


def forget_ids(layer):
    mesh = bpy.data.objects[layer].data
    mesh.attributes.remove(mesh.attributes["id_low"])


def save_plain(path):
    bpy.ops.wm.save_as_mainfile(filepath=path, compress=False, copy=True)


def add_own(name):
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [], [(0, 1, 2)])
    bpy.context.scene.collection.objects.link(bpy.data.objects.new(name, mesh))


def draw(name, points):
    """Draw a curve through points, or move the one of that name there."""
    held = bpy.data.objects.get(name)
    curve = bpy.data.curves.new(name, "CURVE")
    curve.dimensions = "3D"
    spline = curve.splines.new("POLY")
    spline.points.add(len(points) - 1)
    for point, place in zip(spline.points, points, strict=True):
        point.co = (*place, 0.0, 1.0)
    if held is not None:
        held.data = curve
        return
    bpy.context.scene.collection.objects.link(bpy.data.objects.new(name, curve))


def move_own(name, move):
    bpy.data.objects[name].location = move


def delete_own(name):
    bpy.data.objects.remove(bpy.data.objects[name])


def main():
    bpy.ops.wm.open_mainfile(filepath=sys.argv[1])
    for name, *arguments in json.loads(sys.argv[2]):
        globals()[name](*arguments)
    bpy.ops.wm.save_mainfile()


main()
