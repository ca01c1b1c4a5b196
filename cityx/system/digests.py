"""Digests of files, arrays and code, to recognise equal content."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable
from pathlib import Path
from typing import Any


def file_sha256(path: Path) -> str:
    """Return the SHA-256 of a file, 64 hex digits, without holding all of it in memory."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def edition_of(sources: Iterable[Path]) -> str:
    """Return a hash of code and of NumPy, 16 hex digits: what is kept is never of other code."""
    import numpy as np

    text = b"".join(path.read_bytes() for path in sources)
    return hashlib.sha256(text + np.__version__.encode()).hexdigest()[:16]


def arrays_digest(*arrays: Any) -> bytes:
    """Return a hash of NumPy arrays, 16 bytes; of shapely geometries their coordinates count."""
    import shapely

    digest = hashlib.blake2b(digest_size=16)
    for array in arrays:
        plain = shapely.get_coordinates(array) if array.dtype == object else array
        digest.update(repr((plain.dtype.str, plain.shape)).encode())
        digest.update(plain.tobytes())
    return digest.digest()
