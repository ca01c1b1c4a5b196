"""The vector index: an embedded one, on disk, exact by default.

``vectors.f16`` holds the vectors. ``scan.i8`` holds them in one byte a number with a scale and an
error bound each: a search scans those, and compares again, exactly, every vector that the bounds
leave in question. A scan of bytes takes a tenth of the time of one of half floats, which a CPU has
to widen one by one, and the result is the same.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cityx.assets.library.encoding import DIMENSION, Vectors, check_same, check_vectors
from cityx.errors import InputError, MissingDependency

BLOCK = 1024  # vectors widened at a time; they stay in the cache of a core
FORMAT = 1


@dataclass(frozen=True)
class BruteForceIndex:
    """Every vector is looked at; nothing is missed.

    Attributes
    ----------
    encoder
        Identity of the encoder that made the vectors.
    vectors
        (n, 768) float16, mapped from disk.
    scan
        (n, 768) int8, mapped from disk.
    scale, error
        (n,) float32: a vector is about scan times scale, and lies within `error` of that.
    """

    encoder: str
    vectors: NDArray[np.float16]
    scan: NDArray[np.int8]
    scale: NDArray[np.float32]
    error: NDArray[np.float32]

    def __len__(self) -> int:
        """Return the number of vectors."""
        return len(self.scan)

    def search(
        self, queries: Vectors, count: int, *, encoder: str, among: NDArray[np.bool_] | None = None
    ) -> tuple[NDArray[np.int64], Vectors]:
        """Find the vectors nearest to others.

        Parameters
        ----------
        queries
            (q, 768) unit vectors.
        count
            Most vectors to find for each.
        encoder
            Identity of the encoder that made the queries.
        among
            (n,) the vectors that count; None for all.

        Returns
        -------
        rows, cosines
            Best first, (q, count) each; ties go to the lower row.

        Raises
        ------
        UsageError
            If the queries are of another encoder.
        """
        check_same(encoder, self.encoder)
        asked = np.atleast_2d(np.asarray(queries, np.float32))
        check_vectors(asked, encoder)
        count = min(count, len(self) if among is None else int(np.count_nonzero(among)))
        rough = self._rough(asked)
        if among is not None:
            rough[:, ~among] = -np.inf
        rows = np.zeros((len(asked), count), np.int64)
        cosines = np.zeros((len(asked), count), np.float32)
        if not count:
            return rows, cosines
        for number, query in enumerate(asked):
            sure = rough[number] - self.error
            least = np.partition(sure, len(sure) - count)[len(sure) - count]
            open_rows = np.flatnonzero(rough[number] + self.error >= least)
            exact = self.vectors[open_rows].astype(np.float32) @ query
            # Sums of equal vectors may differ in the last bit by their place in memory.
            order = np.lexsort((open_rows, -np.round(exact, 6)))[:count]
            rows[number], cosines[number] = open_rows[order], exact[order]
        return rows, cosines

    def scores(self, query: Vectors, *, encoder: str) -> Vectors:
        """Return the cosine of one query with every vector, (n,), within the errors of the scan."""
        check_same(encoder, self.encoder)
        asked = np.asarray(query, np.float32).reshape(1, -1)
        check_vectors(asked, encoder)
        return np.asarray(self._rough(asked)[0], np.float32)

    def _rough(self, asked: Vectors) -> Vectors:
        out = np.empty((len(asked), len(self)), np.float32)
        wide = np.empty((BLOCK, DIMENSION), np.float32)
        for start in range(0, len(self), BLOCK):
            end = min(start + BLOCK, len(self))
            block = wide[: end - start]
            block[...] = self.scan[start:end]
            out[:, start:end] = asked @ block.T
        return np.asarray(out * self.scale, np.float32)


def write_index(folder: Path, vectors: Vectors, encoder: str) -> None:
    """Write the vectors of a library into a folder.

    Parameters
    ----------
    folder
        Folder to make; give a temporary one and rename it.
    vectors
        (n, 768) unit vectors, in the order of the records.
    encoder
        Identity of the encoder that made them.
    """
    check_vectors(vectors, encoder)
    folder.mkdir(parents=True)
    half = vectors.astype(np.float16)
    kept = half.astype(np.float32)
    scale = np.maximum(np.abs(kept).max(axis=1, initial=0.0), 1e-12) / 127.0
    scan = np.rint(kept / scale[:, None]).astype(np.int8)
    # Rounding of float32 sums is added, so that the bound is one.
    error = np.linalg.norm(kept - scan * scale[:, None], axis=1) + 1e-5
    half.tofile(folder / "vectors.f16")
    scan.tofile(folder / "scan.i8")
    np.save(folder / "bounds.npy", np.stack([scale, error]).astype(np.float32))
    record = {"format": FORMAT, "encoder": encoder, "count": len(half), "dimension": DIMENSION}
    (folder / "index.json").write_text(json.dumps(record, indent=1))


def open_index(folder: Path) -> BruteForceIndex:
    """Open an index; nothing is read until it is searched.

    Raises
    ------
    InputError
        If it is missing or cut.
    """
    try:
        record = json.loads((folder / "index.json").read_text())
        shape = (int(record["count"]), int(record["dimension"]))
        if record["format"] != FORMAT or shape[1] != DIMENSION:
            raise ValueError(f"it has format {record['format']} and {shape[1]} numbers a vector")
        vectors = _mapped(folder / "vectors.f16", np.float16, shape)
        scan = _mapped(folder / "scan.i8", np.int8, shape)
        scale, error = np.load(folder / "bounds.npy")
        if len(scale) != shape[0]:
            raise ValueError("its bounds are of another length")
    except (OSError, ValueError, KeyError) as problem:
        raise InputError(f"{folder} holds no index: {problem}.") from None
    return BruteForceIndex(str(record["encoder"]), vectors, scan, scale, error)


def _mapped(path: Path, dtype: Any, shape: tuple[int, int]) -> Any:
    size = shape[0] * shape[1] * np.dtype(dtype).itemsize
    if path.stat().st_size != size:
        raise ValueError(f"{path.name} has {path.stat().st_size} bytes, not {size}")
    return np.zeros(shape, dtype) if not size else np.memmap(path, dtype, "r", shape=shape)


class GraphIndex:
    """A graph of near neighbours (usearch) over the same vectors: faster, and seldom wrong.

    It is made in memory from an exact index; it pays from some 100,000 vectors on.
    """

    def __init__(self, exact: BruteForceIndex) -> None:
        try:
            from usearch.index import Index
        except ImportError as error:
            raise MissingDependency(
                f"The graph index needs usearch ({error}); install it with: "
                'pip install "cityx[ann]"'
            ) from error
        self._exact = exact
        self._index = Index(ndim=DIMENSION, metric="cos", dtype="f16")
        self._index.add(np.arange(len(exact), dtype=np.uint64), np.asarray(exact.vectors))

    @property
    def encoder(self) -> str:
        """Identity of the encoder that made the vectors."""
        return self._exact.encoder

    def __len__(self) -> int:
        """Return the number of vectors."""
        return len(self._exact)

    def search(
        self, queries: Vectors, count: int, *, encoder: str
    ) -> tuple[NDArray[np.int64], Vectors]:
        """Return rows and cosines of nearly the best `count`, best first.

        Raises
        ------
        UsageError
            If the queries are of another encoder.
        """
        check_same(encoder, self.encoder)
        asked = np.atleast_2d(np.asarray(queries, np.float32))
        check_vectors(asked, encoder)
        found = self._index.search(asked.astype(np.float16), min(count, len(self)))
        keys = np.asarray(found.keys, np.int64).reshape(len(asked), -1)
        distance = np.asarray(found.distances, np.float32).reshape(len(asked), -1)
        return keys, 1.0 - distance
