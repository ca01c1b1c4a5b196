"""Pieces of shader node trees: sums, steps, noise and groups in a line each."""

from __future__ import annotations

from typing import Any

import bpy
import numpy as np

Socket = Any
Tree = Any


def assign(tree: Tree, target: Socket, value: Socket) -> None:
    """Give an input a value or a link; three numbers for a colour get an alpha of 1."""
    if isinstance(value, bpy.types.NodeSocket):
        tree.links.new(value, target)
    elif isinstance(value, tuple):
        target.default_value = (*value[:3], 1.0) if target.type == "RGBA" else value
    elif target.default_value != value:  # each change makes Blender go through the tree
        target.default_value = value


def math(tree: Tree, operation: str, *values: Socket, clamp: bool = False) -> Socket:
    """Combine numbers."""
    node = tree.nodes.new("ShaderNodeMath")
    node.operation = operation
    node.use_clamp = clamp
    for target, value in zip(node.inputs, values, strict=False):
        assign(tree, target, value)
    return node.outputs[0]


def vector(tree: Tree, operation: str, *values: Socket, scale: Socket = None) -> Socket:
    """Combine vectors; the first output, a vector unless the operation measures."""
    node = tree.nodes.new("ShaderNodeVectorMath")
    node.operation = operation
    targets = [socket for socket in node.inputs if socket.type == "VECTOR"]
    for target, value in zip(targets, values, strict=False):
        assign(tree, target, value)
    if scale is not None:
        assign(tree, node.inputs["Scale"], scale)
    return next(socket for socket in node.outputs if socket.enabled)


def joined(tree: Tree, x: Socket = 0.0, y: Socket = 0.0, z: Socket = 0.0) -> Socket:
    """Make a vector of three numbers."""
    node = tree.nodes.new("ShaderNodeCombineXYZ")
    for target, value in zip(node.inputs, (x, y, z), strict=True):
        assign(tree, target, value)
    return node.outputs[0]


def parts(tree: Tree, value: Socket) -> tuple[Socket, Socket, Socket]:
    """Split a vector into its three numbers."""
    node = tree.nodes.new("ShaderNodeSeparateXYZ")
    tree.links.new(value, node.inputs[0])
    return node.outputs[0], node.outputs[1], node.outputs[2]


def mix(
    tree: Tree, share: Socket, a: Socket, b: Socket, *, kind: str = "RGBA", blend: str = "MIX"
) -> Socket:
    """Mix two colours (or, by `kind`, numbers "FLOAT" or vectors "VECTOR")."""
    node = tree.nodes.new("ShaderNodeMix")
    node.data_type = kind
    if kind == "RGBA":
        node.blend_type = blend
    wanted = {"FLOAT": "VALUE"}.get(kind, kind)
    first, second = (s for s in node.inputs if s.type == wanted and s.name in "AB")
    assign(tree, node.inputs[0], share)
    assign(tree, first, a)
    assign(tree, second, b)
    return next(s for s in node.outputs if s.type == wanted)


def product(tree: Tree, a: Socket, b: Socket) -> Socket:
    """Multiply two colours; a number becomes grey."""
    return mix(tree, 1.0, a, (b, b, b) if isinstance(b, float) else b, blend="MULTIPLY")


def smoothstep(tree: Tree, value: Socket, low: Socket, high: Socket) -> Socket:
    """Rise from 0 at `low` to 1 at `high`."""
    node = tree.nodes.new("ShaderNodeMapRange")
    node.interpolation_type = "SMOOTHSTEP"
    assign(tree, node.inputs["From Min"], low)
    assign(tree, node.inputs["From Max"], high)
    assign(tree, node.inputs["Value"], value)
    return node.outputs["Result"]


def noise(
    tree: Tree, size: float, detail: float = 2.0, *, at: Socket = None, roughness: float = 0.5
) -> Socket:
    """Noise with features of `size` metres, 0 to 1, over the scene or at a vector."""
    node = tree.nodes.new("ShaderNodeTexNoise")
    node.inputs["Scale"].default_value = 1 / size
    node.inputs["Detail"].default_value = detail
    node.inputs["Roughness"].default_value = roughness
    if at is None:
        at = tree.nodes.new("ShaderNodeNewGeometry").outputs["Position"]
    tree.links.new(at, node.inputs["Vector"])
    return node.outputs["Fac"]


def white(tree: Tree, seed: Socket) -> tuple[Socket, Socket]:
    """Return a number and a colour that a number draws."""
    node = tree.nodes.new("ShaderNodeTexWhiteNoise")
    node.noise_dimensions = "1D"
    assign(tree, node.inputs["W"], seed)
    return node.outputs["Value"], node.outputs["Color"]


def attribute(tree: Tree, name: str, *, instance: bool = False) -> Any:
    """Read an attribute of the geometry or of the instance; the node."""
    node = tree.nodes.new("ShaderNodeAttribute")
    node.attribute_name = name
    node.attribute_type = "INSTANCER" if instance else "GEOMETRY"
    node.location = (-1100, -600)
    return node


def uv(tree: Tree) -> Socket:
    """Metres along and up a wall, or east and north on the ground."""
    node = tree.nodes.new("ShaderNodeUVMap")
    node.uv_map = "UVMap"
    return node.outputs["UV"]


def group(name: str, inputs: dict[str, Any], outputs: dict[str, str]) -> tuple[Tree, Any, Any]:
    """Make a shader group; inputs by default value (number, colour, or vector of 3), outputs typed.

    Returns
    -------
    tree, source, sink
        The group and the nodes of its inputs and outputs.
    """
    tree = bpy.data.node_groups.new(name, "ShaderNodeTree")
    for key, value in inputs.items():
        kind = "Float" if isinstance(value, float) else ("Color" if len(value) == 4 else "Vector")
        socket = tree.interface.new_socket(key, in_out="INPUT", socket_type=f"NodeSocket{kind}")
        socket.default_value = value
    for key, kind in outputs.items():
        tree.interface.new_socket(key, in_out="OUTPUT", socket_type=f"NodeSocket{kind}")
    return tree, tree.nodes.new("NodeGroupInput"), tree.nodes.new("NodeGroupOutput")


def knob(tree: Tree, name: str, value: float = 0.0) -> Socket:
    """Make a named value node: what a person or a change of weather turns."""
    node = tree.nodes.new("ShaderNodeValue")
    node.name = node.label = name
    node.outputs[0].default_value = value
    return node.outputs[0]


def spread(tree: Tree) -> None:
    """Lay the nodes out in order of making, so that a person can read the tree."""
    for index, node in enumerate(tree.nodes):
        column, row = divmod(index, 6)
        node.location = np.array([column * 220.0, -row * 190.0])
