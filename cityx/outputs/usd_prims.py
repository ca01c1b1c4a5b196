"""Prims, attributes and relationships of a USD layer.

They are written to the layer itself (Sdf): a stage would compose the scene anew after each.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pxr import Gf, Sdf, Tf, Vt

Types = Sdf.ValueTypeNames


def add_prim(parent: Any, name: str, kind: str = "", *, specifier: Any = Sdf.SpecifierDef) -> Any:
    """Add a prim of a schema ("Mesh", "Xform", ... or "" for the one it refers to).

    What USD allows in no name becomes ``_``, and a name that is taken gets a number.
    """
    valid = unique = Tf.MakeValidIdentifier(name)
    number = 1
    while unique in parent.nameChildren:
        number += 1
        unique = f"{valid}_{number}"
    return Sdf.PrimSpec(parent, unique, specifier, kind)


def add_attribute(
    prim: Any, name: str, kind: Any, value: Any = None, *, uniform: bool = False, over: str = ""
) -> Any:
    """Add an attribute.

    Parameters
    ----------
    kind
        Member of `Types`.
    value
        What it holds, or None for nothing.
    uniform
        Whether its schema calls it uniform: one value for all times.
    over
        Interpolation of a primvar: "uniform" is one value per face, "faceVarying" per corner.
    """
    variability = Sdf.VariabilityUniform if uniform else Sdf.VariabilityVarying
    attribute = Sdf.AttributeSpec(prim, name, kind, variability, name.startswith("cityx:"))
    if value is not None:
        attribute.default = value
    if over:
        attribute.SetInfo("interpolation", over)
    return attribute


def point_at(prim: Any, relationship: str, paths: Sequence[Any]) -> None:
    """Add a relationship to the given paths."""
    Sdf.RelationshipSpec(prim, relationship, False).targetPathList.explicitItems = list(paths)


def connect(prim: Any, name: str, kind: Any, source: Any, output: str) -> None:
    """Add an input or output that takes its value from an output of another shader."""
    path = source.path.AppendProperty(f"outputs:{output}")
    add_attribute(prim, name, kind).connectionPathList.explicitItems = [path]


def refer(prim: Any, path: Any) -> None:
    """Make a prim a reference to a path of the same layer."""
    prim.referenceList.prependedItems = [Sdf.Reference("", path)]


def apply_schemas(prim: Any, *schemas: str) -> None:
    """Apply schemas such as "MaterialBindingAPI" to a prim."""
    prim.SetInfo("apiSchemas", Sdf.TokenListOp.Create(prependedItems=list(schemas)))


def move_to(prim: Any, place: NDArray[np.float64]) -> None:
    """Translate a prim in the frame of its parent, metres."""
    add_attribute(prim, "xformOp:translate", Types.Double3, Gf.Vec3d(*place.tolist()))
    order = Vt.TokenArray(["xformOp:translate"])
    add_attribute(prim, "xformOpOrder", Types.TokenArray, order, uniform=True)


def label(prim: Any, words: str) -> None:
    """Give a prim its semantic class; the schema "SemanticsLabelsAPI:class" must be applied."""
    add_attribute(prim, "semantics:labels:class", Types.TokenArray, Vt.TokenArray([words]))


def vectors(values: NDArray[Any]) -> Any:
    """(n, 3) as an array of float vectors."""
    return Vt.Vec3fArray.FromNumpy(np.ascontiguousarray(values, np.float32))


def integers(values: NDArray[Any]) -> Any:
    """(n,) as an array of 32-bit integers."""
    return Vt.IntArray.FromNumpy(np.ascontiguousarray(values, np.int32))


def long_integers(ids: NDArray[np.uint64]) -> Any:
    """(n,) ids as an array of 64-bit integers: the same bits, the first of which is a sign here."""
    return Vt.Int64Array.FromNumpy(np.ascontiguousarray(ids).view(np.int64))
