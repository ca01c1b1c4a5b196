"""Encoders: words and pictures as unit vectors of 768 numbers."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from cityx.errors import UsageError

DIMENSION = 768  # of CLIP ViT-L/14, and of every encoder here
UNIT = 1e-3  # a vector this near to length 1 is a unit vector

Vectors = NDArray[np.float32]


class Encoder(Protocol):
    """Turns texts, and perhaps pictures, into vectors that can be compared."""

    @property
    def identity(self) -> str:
        """Name with everything that changes the vectors: two of one identity agree."""

    @property
    def sees(self) -> bool:
        """Whether it encodes pictures."""

    def encode_text(self, texts: Sequence[str]) -> Vectors:
        """Return (n, 768) unit vectors of texts."""

    def encode_images(self, paths: Sequence[Path]) -> Vectors:
        """Return (n, 768) unit vectors of pictures."""


def unit(vectors: NDArray[Any]) -> Vectors:
    """Scale (n, d) vectors to length 1; one of length 0 becomes the first axis."""
    held = np.array(vectors, np.float64)
    length = np.linalg.norm(held, axis=1, keepdims=True)
    none = length[:, 0] == 0
    held[none, 0], length[none] = 1.0, 1.0
    return np.asarray(held / length, np.float32)


def check_vectors(vectors: Vectors, encoder: str) -> None:
    """Refuse vectors that are not unit vectors of 768 numbers.

    Raises
    ------
    UsageError
        If the encoder does not keep its promise.
    """
    if vectors.ndim != 2 or vectors.shape[1] != DIMENSION:
        raise UsageError(
            f'Encoder "{encoder}" returned vectors of {vectors.shape[-1]} numbers, not {DIMENSION}.'
        )
    length = np.linalg.norm(vectors.astype(np.float64), axis=1)
    if not (np.abs(length - 1.0) <= UNIT).all():
        worst = length[np.argmax(np.abs(length - 1.0))]
        raise UsageError(f'Encoder "{encoder}" returned a vector of length {worst:.4g}, not 1.')


def check_same(encoder: str, index: str) -> None:
    """Refuse to compare vectors of different encoders.

    Raises
    ------
    UsageError
        If the identities differ.
    """
    if encoder != index:
        raise UsageError(
            f'The index was made with "{index}"; vectors of "{encoder}" cannot be compared with '
            "it. Use the same encoder, or make the index anew with: cityx assets embed."
        )
