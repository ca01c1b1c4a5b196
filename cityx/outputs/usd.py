"""A city as a USD layer, ``city.usdc``, with its textures in ``city_textures`` beside it.

A layer and files, not one USDZ: it is read in place and can be edited, layered and re-textured;
`usdzip` packs it.

Prims: ``/City``, under it ``Materials``, ``Prototypes`` (abstract), one scope per layer of meshes
with one mesh per object, and one point instancer per layer of instances; those of what moves have
time samples.
"""

from __future__ import annotations

import os
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import Any

from cityx.errors import EngineError, MissingExtra
from cityx.system.atomic import replaced


@dataclass(frozen=True)
class UsdStats:
    """What a layer holds.

    Attributes
    ----------
    size
        Bytes, without textures.
    meshes, prototypes, materials, textures
        Counts; prototypes and materials count once per tint.
    instances
        Rows placed.
    triangles_unique, triangles_instanced
        Stored, and as seen with every instance counted.
    """

    size: int
    meshes: int
    prototypes: int
    materials: int
    textures: int
    instances: int
    triangles_unique: int
    triangles_instanced: int


def require_usd() -> None:
    """Make sure that the USD library is there.

    Raises
    ------
    MissingExtra
        If it is not installed.
    """
    try:
        import_module("pxr.Usd")
    except ImportError as error:
        raise MissingExtra(
            f'The format usd needs usd-core ({error}); install it with: pip install "cityx[usd]"'
        ) from error


def write_usd(view: Any, path: str | os.PathLike[str], *, texture_size: int = 512) -> UsdStats:
    """Write a city as USD: z up, metres, textures in a folder beside the file.

    Parameters
    ----------
    view
        A `cityx.city.store.View`, or a City.
    path
        File to make, ``city.usdc`` (binary) or ``city.usda`` (text); replaced when the new one and
        its textures, in ``city_textures``, are complete.
    texture_size
        Edge of the textures in pixels, 0 for none.

    Raises
    ------
    MissingExtra
        If the USD library is not installed.
    EngineError
        If the file cannot be written.
    """
    require_usd()
    from cityx.outputs.usd_animation import moving_layers
    from cityx.outputs.usd_layer import UsdWriter

    if not hasattr(view, "objects"):
        from cityx.city.store import view_of

        view = view_of(view)
    path = Path(path)
    writer = UsdWriter(view, path.with_name(f"{path.stem}_textures"), texture_size)
    for name, batch in sorted(writer.scene.meshes.items()):
        writer.mesh_layer(name, batch)
    for name, rows in sorted(writer.scene.instances.items()):
        writer.instance_layer(name, rows)
    moving_layers(writer)
    writer.author_extents()
    with replaced(path) as temporary:
        if not writer.layer.Export(str(temporary)):
            raise EngineError(f"USD could not write {path}; is the disk full?")
        size = temporary.stat().st_size
    return UsdStats(
        size=size,
        meshes=writer.meshes,
        prototypes=writer.prototypes,
        materials=len(writer.materials),
        textures=writer.materials.textures,
        instances=writer.instances,
        triangles_unique=writer.triangles_unique,
        triangles_instanced=writer.triangles_instanced,
    )
