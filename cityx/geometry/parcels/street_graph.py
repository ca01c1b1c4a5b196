"""Streets as a graph: where lines meet, and how many of them at each place."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

GRID = 1000  # steps per metre; places that are the same to the millimetre are one


@dataclass(frozen=True)
class StreetGraph:
    """Places along streets, n of them.

    Attributes
    ----------
    places
        (n, 2) metres.
    degree
        (n,) ways that lead from each: 1 at a blind end, 2 along a street, more at a junction.
    """

    places: FloatArray
    degree: IntArray


def street_graph(lines: NDArray[Any]) -> StreetGraph:
    """Find how many ways lead from every point of some lines; they meet in points they share.

    Parameters
    ----------
    lines
        (m,) linestrings, metres.
    """
    points, line = shapely.get_coordinates(lines, return_index=True)
    whole = np.rint(points * GRID).astype(np.int64)
    known, row = np.unique(whole, axis=0, return_inverse=True)
    row = row.ravel()
    along = np.flatnonzero((line[1:] == line[:-1]) & (row[1:] != row[:-1]))
    ends = np.sort(np.column_stack([row[along], row[along + 1]]), axis=1)
    links = np.unique(ends, axis=0)
    return StreetGraph(known / GRID, np.bincount(links.ravel(), minlength=len(known)))
