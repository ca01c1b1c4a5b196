"""Recolouring objects."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from cityx.assets.styles.materials import material_named, srgb_to_linear
from cityx.city.city import City
from cityx.city.scene import Instances, Prototype
from cityx.edit.buildings.designing import Wish, redesigned
from cityx.edit.targets import targets_of, with_changed_rows
from cityx.errors import ActionFailed
from cityx.protocol import Color, ObjectName, Port, Range, action


@action(
    "edit/recolor-v1",
    limits=[
        "Of a building the walls are painted, its windows and its roof keep their colours.",
        "Paint is no brighter and no purer than paint outdoors is.",
        "Of other things the parts are coloured that have a paint; some have none.",
    ],
    takes=(Port("object", "complex_geometry"),),
    gives=(Port("object", "complex_geometry"),),
    labels=("color", "colour", "paint", "tint"),
    serves=("edit=set_color",),
    binds={"objects": "objects", "color": "rgb"},
)
def recolor(
    city: City,
    *,
    objects: Annotated[tuple[str, ...], ObjectName()],
    color: Annotated[int, Color(), Range(0, 0xFFFFFF)],
) -> City:
    """Give objects another colour.

    Parameters
    ----------
    city
        The city.
    objects
        Buildings, and things that stand or move about.
    color
        0xRRGGBB, sRGB.
    """
    found = targets_of(city, objects)
    if len(found.buildings):
        city = redesigned(city, found.buildings, Wish(color=int(color)))
    tint = np.asarray(srgb_to_linear(int(color)), float)
    if len(found.pieces):
        bases = [_base(prototype) for prototype in city.scene.prototypes]
        city = with_changed_rows(city, found.pieces, lambda rows: _tinted(city, rows, tint, bases))
    if len(found.movers) and city.tracks is not None:
        mine = np.isin(city.tracks.object_id, found.movers)
        tints = np.where(mine[:, None], tint, city.tracks.tint).astype(np.float32)
        city = replace(city, tracks=replace(city.tracks, tint=tints))
    return city


def _base(prototype: Prototype) -> NDArray[np.float64] | None:
    """Return the colour of the largest painted surface of a prototype, None without paint."""
    mesh = prototype.mesh
    share = np.bincount(mesh.material, minlength=len(mesh.materials))
    painted = [(share[at], name) for at, name in enumerate(mesh.materials)
               if material_named(name).takes_tint]  # fmt: skip
    if not painted:
        return None
    return np.asarray(material_named(max(painted)[1]).color, float)


def _tinted(
    city: City,
    rows: Instances,
    tint: NDArray[np.float64],
    bases: list[NDArray[np.float64] | None],
) -> Instances:
    tints = rows.tint.copy()
    for at in np.unique(rows.prototype).tolist():
        base = bases[at]
        if base is None:
            name = city.scene.prototypes[at].name.replace("_", " ")
            raise ActionFailed(f"A {name} has no paint, so it has no other colour.")
        own = np.clip(tint / np.maximum(base, 1e-3), 0.0, 1.0)
        tints[rows.prototype == at] = own
    return replace(rows, tint=tints)
