"""Run in a process of its own: draw curves in Blender and save them: ``drawn_curves.py FILE``."""

import sys

import bpy  # noqa: TID251


def drawn(name, form, points, *, closed=False, at=(0.0, 0.0, 0.0), **properties):
    curve = bpy.data.curves.new(name, "CURVE")
    spline = curve.splines.new(form)
    if form == "BEZIER":
        spline.bezier_points.add(len(points) - 1)
        for held, point in zip(spline.bezier_points, points, strict=True):
            held.co = (*point, 0.0)
            held.handle_left_type = held.handle_right_type = "VECTOR"
    else:
        spline.points.add(len(points) - 1)
        for held, point in zip(spline.points, points, strict=True):
            held.co = (*point, 0.0, 1.0)
    spline.use_cyclic_u = closed
    item = bpy.data.objects.new(name, curve)
    item.location = at
    for key, value in properties.items():
        item[key] = value
    bpy.context.scene.collection.objects.link(item)
    return item


bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
loop = drawn("Loop", "POLY", [(-20, -20), (20, -20), (20, 20), (-20, 20)], closed=True)
loop.data.bevel_depth = 1.0  # drawn as a tube
line = drawn("Line", "BEZIER", [(0, 0), (30, 0)], at=(5.0, 7.0, 2.0))
lane = drawn("Lane", "POLY", [(-60, -40), (60, -40)], kind="residential")
two = drawn("Two", "POLY", [(0, 0), (10, 0)])
two.data.splines.new("POLY").points.add(1)
two.data.splines[1].points[1].co = (0.0, 9.0, 0.0, 1.0)
box = bpy.data.objects.new("Box", bpy.data.meshes.new("Box"))
bpy.context.scene.collection.objects.link(box)
bpy.ops.wm.save_as_mainfile(filepath=sys.argv[1])
