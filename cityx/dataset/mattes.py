"""Mattes: the cryptomatte channels of a shot, from rays spread as the samples of its picture."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cityx.dataset.cryptomatte import filter_offsets, manifest, matte, ranked
from cityx.dataset.shots import Shot, axes
from cityx.geometry.identity import id_text

if TYPE_CHECKING:
    from cityx.city.store import View
    from cityx.dataset.stage import Stage

MATTES = ("crypto_object", "crypto_material")


class Mattes:
    """Makes the mattes of shots of one city.

    A class because what does not move is prepared once.

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
        self._still: Stage | None = None
        self._stage: Stage | None = None
        self._key: tuple[float, bool] | None = None

    def of(
        self, shot: Shot
    ) -> tuple[Mapping[str, NDArray[np.float32]], Mapping[str, Mapping[str, str]]]:
        """Return the mattes of a shot and their manifests, by channel."""
        return MappingProxyType({}), MappingProxyType({})
