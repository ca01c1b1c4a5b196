"""Roof edges: caps along ridges and hips, gutters along eaves."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cityx.assets.trims.dormers import gutter, ridge_tiles
from cityx.building.assembly import TRIM_MATERIAL
from cityx.building.facade.placing import Placing
from cityx.building.roofs.eaves import THICKNESS
from cityx.building.roofs.roof_lines import RoofLines, eaves_of, ridges_of
from cityx.ids import hash_ids

if TYPE_CHECKING:
    from cityx.city.mesh import MeshBatch
    from cityx.city.scene import Prototype

CAPPED = ("roof_tiles", "slate", "roof_metal", "copper", "bitumen")  # roof materials with caps
DARKER = 0.82  # how much darker caps are than the roof, for the shadow of their joints
OVERLAP = 0.1  # metres a cap runs on at both ends
LIFT = 0.02  # metres of a cap above its line


def roof_edges(placing: Placing, batch: MeshBatch) -> None:
    """Put caps on ridges and hips and gutters under eaves of shells."""
    names = np.array(batch.materials)
    of_face = np.isin(names, CAPPED)[batch.material] if len(names) else np.zeros(0, bool)
    ridges = ridges_of(batch, of_face)
    word = names[batch.material[ridges.face]] if len(ridges.face) else np.zeros(0, "U1")
    for name in np.unique(word).tolist():
        rows = np.flatnonzero(word == name)
        made = ridge_tiles(name, detail=placing.detail)
        tint = DARKER * batch.tint[ridges.face[rows]]
        _run(placing, batch, made, _taken(ridges, rows), OVERLAP, LIFT, tint)
    trim = np.isin(names, [TRIM_MATERIAL])[batch.material] if len(names) else of_face
    eaves = eaves_of(batch, trim, THICKNESS)
    made = gutter(detail=placing.detail)
    _run(placing, batch, made, eaves, 0.0, 0.0, np.ones((len(eaves.face), 3), np.float32))


def _taken(lines: RoofLines, rows: NDArray[np.int64]) -> RoofLines:
    return RoofLines(lines.start[rows], lines.end[rows], lines.face[rows], lines.owner[rows])


def _run(
    placing: Placing, batch: MeshBatch, made: Prototype, lines: RoofLines, overlap: float,
    lift: float, tint: NDArray[np.float32],
) -> None:  # fmt: skip
    """Stretch a metre of something along lines; what slopes is turned about its own y axis."""
    vector = lines.end - lines.start
    length = np.linalg.norm(vector, axis=1)
    run = np.hypot(vector[:, 0], vector[:, 1])
    rotation = np.zeros((len(length), 3))
    rotation[:, 1] = -np.arctan2(vector[:, 2], run)
    rotation[:, 2] = np.arctan2(vector[:, 1], vector[:, 0])
    middle = (lines.start + lines.end) / 2
    building = batch.object_id[lines.owner]
    place = np.rint(middle * 1000).astype(np.int64).view(np.uint64)
    with np.errstate(over="ignore"):
        key = place[:, 0] * np.uint64(73856093) + place[:, 1] * np.uint64(19349663) + place[:, 2]
    scale = np.ones((len(length), 3))
    scale[:, 0] = length + overlap
    placing.put(
        made, hash_ids(0, "roof/edge", building, key), building,
        middle + np.array([0.0, 0.0, lift]), rotation, scale=scale, tint=tint,
    )  # fmt: skip
