"""Rows of a layer of a scene: some more, or some fewer, while all others stay as they are."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from cityx.city.rows import leave_rows, merge_rows
from cityx.city.scene import Instances, Prototype, Scene, no_instances


def with_rows(
    scene: Scene, layer: str, prototypes: Sequence[Prototype], rows: Instances
) -> Scene:  # fmt: skip
    """Return a scene with more rows in a layer, which is kept in the order of ids.

    Parameters
    ----------
    scene
        The scene.
    layer
        Name of the layer; made when there is none.
    prototypes
        What ``rows.prototype`` counts; only those in use are added to the scene.
    rows
        What is added; its ids are new to the layer.
    """
    used, place = np.unique(rows.prototype, return_inverse=True)
    shift = len(scene.prototypes)
    more = replace(rows, prototype=(shift + place).astype(np.int32))
    held = scene.instances.get(layer)
    joined = merge_rows(no_instances() if held is None else held, more)
    offered = [*scene.prototypes, *(prototypes[number] for number in used.tolist())]
    return scene.with_instances(layer, offered, joined)


def without_rows(scene: Scene, layer: str, ids: NDArray[np.uint64]) -> Scene:
    """Return a scene without some rows of a layer, and without what they own in any layer."""
    for name, rows in scene.instances.items():
        gone = np.isin(rows.owner, ids)
        if name == layer:
            gone |= np.isin(rows.object_id, ids)
        if gone.any():
            scene = scene.with_instances(name, scene.prototypes, leave_rows(rows, gone))
    return scene
