"""Mattes: the cryptomatte channels of a shot, from rays spread as the samples of its picture.

Things and materials are named as in the tables of a dataset: an object by the sixteen digits of its
id, a material by its name. The sky has no name; what it covers is missing from the shares. Grass,
rain and flakes are no objects: a lawn is covered by its ground.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cityx.city.camera import axes
from cityx.dataset.shots import Shot
from cityx.dataset.sight import NEAR
from cityx.dataset.stage import Stage, stage_of
from cityx.geometry.arrays import IntArray
from cityx.ids import id_text
from cityx.outputs.cryptomatte import LAYERS, filter_offsets, manifest, matte, ranked

if TYPE_CHECKING:
    from cityx.city.store import View

MATTES = ("crypto_object", "crypto_material")
BATCH = 1 << 20  # rays cast at once


class Mattes:
    """Makes the mattes of shots of one city; a class because what stands still is kept.

    Parameters
    ----------
    view
        The city.
    names
        Of `MATTES`, those that are wanted.
    side
        Rays along each side of a pixel.
    """

    def __init__(self, view: View, names: Sequence[str], side: int) -> None:
        self.view, self.names, self.offsets = view, tuple(names), filter_offsets(side)
        self._stage: Stage | None = None

    def of(
        self, shot: Shot
    ) -> tuple[Mapping[str, NDArray[np.float32]], Mapping[str, Mapping[str, str]]]:
        """Return the mattes of a shot, (h, w, 12), and their manifests, by channel."""
        if not self.names:
            return MappingProxyType({}), MappingProxyType({})
        light = shot.environment or self.view.environment
        stage = self._stage
        if stage is None or stage.moment != shot.moment or stage.view.environment != light:
            stage = stage_of(replace(self.view, environment=light), shot.moment, still=stage)
            self._stage = stage
        return mattes(stage, shot, self.names, self.offsets)


def mattes(
    stage: Stage, shot: Shot, names: Sequence[str], offsets: NDArray[np.float64]
) -> tuple[Mapping[str, NDArray[np.float32]], Mapping[str, Mapping[str, str]]]:
    """Make mattes of a shot.

    Parameters
    ----------
    stage
        The city at its moment.
    shot
        The shot.
    names
        Of `MATTES`.
    offsets
        (n, 2) from the middle of a pixel, right and down, of rays of equal weight.

    Returns
    -------
    layers, manifests
        By channel.
    """
    camera = shot.camera
    found: dict[str, list[tuple[IntArray, NDArray[np.float32]]]] = {name: [] for name in names}
    rows = max(1, BATCH // (camera.width * len(offsets)))
    for top in range(0, camera.height, rows):
        seen = _seen(stage, shot, top, min(rows, camera.height - top), offsets)
        for name in names:
            found[name].append(ranked(seen[name]))
    layers, manifests = {}, {}
    for name, parts in found.items():
        number = np.concatenate([number for number, _ in parts])
        share = np.concatenate([share for _, share in parts])
        used, short = np.unique(number, return_inverse=True)
        words = [_word(stage, name, thing) for thing in used.tolist() if thing]
        # Number 0 is nothing, whether or not some pixel has a free rank.
        short = short.reshape(number.shape) + (0 if used[0] == 0 else 1)
        made = matte(short, share, words)
        layers[name] = made.reshape(camera.height, camera.width, 4 * LAYERS)
        manifests[name] = MappingProxyType(manifest(words))
    return MappingProxyType(layers), MappingProxyType(manifests)


def _word(stage: Stage, name: str, thing: int) -> str:
    """Return the name of a thing, which is counted from 1."""
    if name == "crypto_material":
        return stage.materials[thing]
    return id_text(int(stage.object_id[thing - 1]))


def _seen(
    stage: Stage, shot: Shot, top: int, rows: int, offsets: NDArray[np.float64]
) -> dict[str, IntArray]:
    """(p, n) what rays of some rows of pixels meet: objects by row + 1, materials; 0 is sky."""
    camera = shot.camera
    focal = camera.width / 2 / np.tan(camera.hfov / 2)
    x = np.arange(camera.width)[:, None] + 0.5 - camera.width / 2 + offsets[:, 0]  # (w, n)
    y = top + np.arange(rows)[:, None] + 0.5 - camera.height / 2 + offsets[:, 1]  # (rows, n)
    right, down, ahead = axes(camera)
    directions = (
        ahead + x[None, :, :, None] / focal * right + y[:, None, :, None] / focal * down
    ).reshape(-1, 3)
    hits = stage.cast(np.array(camera.position) + NEAR * directions, directions)
    shape = (rows * camera.width, len(offsets))
    # One row stands for all rows of an object.
    objects = stage.rows(hits)
    first = np.where(objects >= 0, stage.whole[objects] + 1, 0)
    return {
        "crypto_object": first.reshape(shape),
        "crypto_material": stage.materials_at(hits).astype(np.int64).reshape(shape),
    }
