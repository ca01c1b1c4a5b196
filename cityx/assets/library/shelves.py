"""Shelves: where placement takes assets from, a library on disk or a small one grown at once."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Any, Protocol

import numpy as np

from cityx.assets.library.grow import grow_buildings
from cityx.assets.library.local_text import LocalText
from cityx.assets.library.models import Models, join_models
from cityx.assets.library.plots import BATCH
from cityx.assets.library.records import Catalogue, join_catalogues
from cityx.geometry.arrays import FloatArray
from cityx.protocol.input_files import InputFiles

STARTER = 2  # batches grown where no library is given
STARTER_SEED = 0


class Shelf(Protocol):
    """Assets with their records and their geometry."""

    @property
    def catalogue(self) -> Catalogue:
        """The records."""

    def models(self, rows: Any) -> Models:
        """Return the geometry of some of them."""


@dataclass(frozen=True)
class Grown:
    """Assets in memory.

    Attributes
    ----------
    catalogue, held
        Records and geometry, row by row.
    """

    catalogue: Catalogue
    held: Models

    def models(self, rows: Any) -> Models:
        """Return the geometry of some of them."""
        return self.held.take(rows)


def shelf_of(inputs: InputFiles, style: str) -> Shelf:
    """Return the first library among the files a user handed in, or a small one of a style."""
    from cityx.assets.library.store import is_library, open_library

    for path in inputs.paths:
        if is_library(path):
            return open_library(path)
    return starter(style)


@lru_cache(maxsize=4)
def starter(style: str) -> Grown:
    """Grow some buildings of a style family."""
    from cityx.assets.styles.palettes import STYLES

    first = STYLES.index(style)
    parts = [
        grow_buildings((first + round_ * len(STYLES)) * BATCH + np.arange(BATCH), STARTER_SEED)
        for round_ in range(STARTER)
    ]
    return Grown(join_catalogues([p[0] for p in parts]), join_models([p[1] for p in parts]))


def text_scores(shelf: Shelf, text: str) -> FloatArray:
    """Return the agreement of every asset with a description, (m,) cosines.

    The index of a library is asked where it was made with the local encoder; else the descriptions
    are encoded anew, since vectors of different encoders cannot be compared.
    """
    from cityx.assets.library.store import Library

    encoder = LocalText()
    asked = encoder.encode_text([text])
    if isinstance(shelf, Library) and shelf.encoder == encoder.identity:
        return shelf.index.scores(asked, encoder=encoder.identity).astype(float)
    held = encoder.encode_text(shelf.catalogue["description"].tolist())
    return np.asarray(held @ asked[0], float)
