"""Ranges: rows of tables in which each thing has a run of rows, given by start offsets."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray


def ranges(
    start: NDArray[np.int64], things: NDArray[np.int64]
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return the rows of some things, one after the other, and their new start offsets.

    Parameters
    ----------
    start
        (n + 1,) first row of each thing, and one past the last of all.
    things
        (k,) numbers of the things, in any order.

    Returns
    -------
    rows, start
        (r,) rows of the table, and (k + 1,) offsets into them.
    """
    length = np.diff(start)[things]
    new_start = np.concatenate([[0], np.cumsum(length)]).astype(np.int64)
    rows = np.arange(new_start[-1]) + np.repeat(start[:-1][things] - new_start[:-1], length)
    return rows, new_start


def numbered(count: NDArray[Any], kind: Any = np.int64) -> NDArray[Any]:
    """Return the number of each row within its own thing, from zero on.

    Parameters
    ----------
    count
        (n,) how many rows each thing has, one thing's after the other's.
    kind
        Of the whole numbers.

    Returns
    -------
    number
        (count.sum(),) of each row within its own thing.
    """
    end = np.cumsum(count, dtype=kind)
    first = np.repeat(end - count.astype(kind, copy=False), count)
    return np.asarray(np.arange(len(first), dtype=kind) - first)


def counted(count: NDArray[Any], kind: Any = np.int64) -> tuple[NDArray[Any], NDArray[Any]]:
    """Return each thing as often as it counts, and the number of each row within its thing."""
    return np.repeat(np.arange(len(count), dtype=kind), count), numbered(count, kind)


def numbered_in_runs(keys: NDArray[Any]) -> NDArray[np.int64]:
    """Return the number of each row among those before it with the same key, from zero on.

    Rows of one key follow one another; keys need not rise.
    """
    first = np.flatnonzero(np.r_[True, keys[1:] != keys[:-1]][: len(keys)])
    return numbered(np.diff(np.r_[first, len(keys)]))


def row_codes(keys: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return a number for each row of a table of whole numbers, (n, k), the same for equal rows.

    Rows are numbered as they first appear, by hashing; `numpy.unique` sorts them, which takes ten
    times as long.
    """
    import pandas as pd

    code = np.zeros(len(keys), np.int64)
    for column in keys.T:
        number, found = pd.factorize(column)
        code = pd.factorize(code * max(len(found), 1) + number)[0]
    return np.asarray(code, np.int64)


def equal_rows(values: NDArray[Any], others: NDArray[Any]) -> NDArray[np.bool_]:
    """(n,) whether rows of two tables of one shape, (n, ...), are equal in every column.

    Column by column; `numpy.all` along short rows takes several times as long.
    """
    found = np.ones(len(values), bool)
    if not len(values):
        return found
    same = (values == others).reshape(len(values), -1)
    for column in same.T:
        found &= column
    return found
