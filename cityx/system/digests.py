"""Digests of files, arrays and code, to recognise equal content."""

from __future__ import annotations

import hashlib
import os
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


def files_below(folder: str | os.PathLike[str], *suffixes: str) -> list[str]:
    """Return the paths of all files below a folder that end so, sorted."""
    found: list[str] = []
    for below, _, names in os.walk(folder):
        found += [os.path.join(below, name) for name in names if name.endswith(suffixes)]  # noqa: PTH118  (pathlib takes thrice as long)
    return sorted(found)


def stamp_of(paths: Iterable[str | os.PathLike[str]]) -> str:
    """Return a hash of the names, times and sizes of files, 16 hex digits, which reads none."""
    digest = hashlib.blake2b(digest_size=8)
    for path in paths:
        try:
            found = os.stat(path)  # noqa: PTH116  (thousands of them)
            told = f"{found.st_mtime_ns} {found.st_size}"
        except OSError:
            told = "unreadable"  # such as the lock of an editor, a link to nothing
        digest.update(f"{path} {told}\n".encode())
    return digest.hexdigest()


def arrays_digest(*arrays: Any) -> bytes:
    """Return a hash of NumPy arrays, 16 bytes; of shapely geometries their coordinates count."""
    import shapely

    digest = hashlib.blake2b(digest_size=16)
    for array in arrays:
        plain = shapely.get_coordinates(array) if array.dtype == object else array
        digest.update(repr((plain.dtype.str, plain.shape)).encode())
        digest.update(plain.tobytes())
    return digest.digest()
