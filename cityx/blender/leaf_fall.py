"""Leaf fall as a modifier: what becomes of the crown of a deciduous tree under snow."""

from __future__ import annotations

from collections.abc import Iterable

import bpy

from cityx.blender.nodes import Socket, Tree

BARE = "Bare"  # name of the modifier that takes the leaves off a deciduous tree
GROUP = "CityX Leaf Fall"
# Where leaves were there are twigs: some of the leaves, drawn long and thin, in bark.
SHARE = 0.4  # of the leaves whose place is shown by a twig
LENGTH, BREADTH = 3.0, 0.05  # of a twig, beside those of a leaf


def undress(item: bpy.types.Object, leaf: bpy.types.Material, bark: bpy.types.Material) -> None:
    """Give a tree the modifier; `cityx.blender.light` switches it."""
    modifier = item.modifiers.new(BARE, "NODES")
    modifier.node_group = bpy.data.node_groups.get(GROUP) or _group(leaf, bark)
    modifier.show_render = modifier.show_viewport = False


def show_twigs(items: Iterable[bpy.types.Object], *, shown: bool) -> None:
    """Show the twigs of bare trees, or the limbs alone, which are what truth knows."""
    for item in items:
        modifier = item.modifiers.get(BARE)
        if modifier is not None and modifier["Socket_2"] != shown:
            modifier["Socket_2"] = shown
            item.update_tag()


def _group(leaf: bpy.types.Material, bark: bpy.types.Material) -> bpy.types.NodeTree:
    group = bpy.data.node_groups.new(GROUP, "GeometryNodeTree")
    group.interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
    group.interface.new_socket("Geometry", in_out="INPUT", socket_type="NodeSocketGeometry")
    twigs = group.interface.new_socket("Twigs", in_out="INPUT", socket_type="NodeSocketBool")
    twigs.default_value = True
    source, sink = group.nodes.new("NodeGroupInput"), group.nodes.new("NodeGroupOutput")
    chosen = group.nodes.new("GeometryNodeMaterialSelection")
    chosen.inputs["Material"].default_value = leaf
    share = group.nodes.new("ShaderNodeMath")
    share.operation = "MULTIPLY"
    share.inputs[1].default_value = SHARE
    group.links.new(source.outputs["Twigs"], share.inputs[0])
    fallen = _both(group, chosen.outputs[0], _drawn(group, share.outputs[0]))
    fall = group.nodes.new("GeometryNodeDeleteGeometry")
    fall.domain = "FACE"
    group.links.new(source.outputs["Geometry"], fall.inputs["Geometry"])
    group.links.new(fallen, fall.inputs["Selection"])
    long = group.nodes.new("GeometryNodeScaleElements")
    long.inputs["Scale"].default_value = LENGTH
    thin = group.nodes.new("GeometryNodeScaleElements")
    thin.scale_mode = "SINGLE_AXIS"
    thin.inputs["Scale"].default_value = BREADTH
    group.links.new(_across(group), thin.inputs["Axis"])
    wooden = group.nodes.new("GeometryNodeSetMaterial")
    wooden.inputs["Material"].default_value = bark
    shape = fall.outputs[0]
    for node in (long, thin, wooden):
        group.links.new(shape, node.inputs["Geometry"])
        group.links.new(chosen.outputs[0], node.inputs["Selection"])
        shape = node.outputs[0]
    group.links.new(shape, sink.inputs[0])
    return group


def _drawn(tree: Tree, share: Socket) -> Socket:
    """Return whether a leaf, a part of the mesh that hangs together, is beyond a share."""
    leaf = tree.nodes.new("GeometryNodeInputMeshIsland")
    draw = tree.nodes.new("FunctionNodeRandomValue")
    draw.data_type = "FLOAT"
    tree.links.new(leaf.outputs["Island Index"], draw.inputs["ID"])
    number = next(socket for socket in draw.outputs if socket.enabled)
    compare = tree.nodes.new("FunctionNodeCompare")
    compare.operation = "GREATER_EQUAL"
    tree.links.new(number, compare.inputs["A"])
    tree.links.new(share, compare.inputs["B"])
    return compare.outputs[0]


def _both(tree: Tree, a: Socket, b: Socket) -> Socket:
    node = tree.nodes.new("FunctionNodeBooleanMath")
    tree.links.new(a, node.inputs[0])
    tree.links.new(b, node.inputs[1])
    return node.outputs[0]


def _across(tree: Tree) -> Socket:
    """Return a direction in the plane of a leaf: a drawn one, square to its normal."""
    normal = tree.nodes.new("GeometryNodeInputNormal")
    leaf = tree.nodes.new("GeometryNodeInputMeshIsland")
    draw = tree.nodes.new("FunctionNodeRandomValue")
    draw.data_type = "FLOAT_VECTOR"
    low, high = (socket for socket in draw.inputs if socket.type == "VECTOR")
    low.default_value, high.default_value = (-1.0, -1.0, -0.2), (1.0, 1.0, 0.2)
    tree.links.new(leaf.outputs["Island Index"], draw.inputs["ID"])
    cross = tree.nodes.new("ShaderNodeVectorMath")
    cross.operation = "CROSS_PRODUCT"
    tree.links.new(normal.outputs[0], cross.inputs[0])
    tree.links.new(next(s for s in draw.outputs if s.enabled), cross.inputs[1])
    return cross.outputs[0]
