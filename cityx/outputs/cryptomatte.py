"""Cryptomatte: which things a pixel shows and how much of each, readable by compositors.

Blender's own matte names instances after their prototype, so that all windows of a city are one
thing. This one is made by rays of the truth, several to a pixel and spread as the samples of the
picture are, and names what they meet by the ids of the City.

References
----------
J. Friedman and A. C. Jones, "Fully automatic ID mattes with support for motion blur and
transparency", SIGGRAPH 2015 posters; the specification of Cryptomatte, version 1.2.0.
A. Appleby, MurmurHash3 (public domain), the variant x86_32.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

RANKS = 6  # things a pixel names at most, two to a layer
LAYERS = 3
# Pixels across the Blackman-Harris filter that pictures and mattes draw their samples from; with
# the usual three what is small from above would blur.
FILTER_WIDTH = 2.0
TERMS = (0.35875, -0.48829, 0.14128, -0.01168)  # of that filter, cosines of 0, 1, 2, 3 turns
GOLDEN = (5**0.5 - 1) / 2
_FINE = 4096  # steps in which the filter is integrated
_MASK = 0xFFFFFFFF
HASH, CONVERSION = "MurmurHash3_32", "uint32_to_float32"


def murmur3(data: bytes) -> int:
    """Return the 32 bits of MurmurHash3 x86_32 with seed 0."""
    state = 0
    for start in range(0, len(data), 4):
        block = data[start : start + 4]
        k = int.from_bytes(block, "little") * 0xCC9E2D51 & _MASK
        k = ((k << 15 | k >> 17) & _MASK) * 0x1B873593 & _MASK
        state ^= k
        if len(block) == 4:
            state = ((state << 13 | state >> 19) & _MASK) * 5 + 0xE6546B64 & _MASK
    state ^= len(data)
    state = (state ^ state >> 16) * 0x85EBCA6B & _MASK
    state = (state ^ state >> 13) * 0xC2B2AE35 & _MASK
    return state ^ state >> 16


@lru_cache(maxsize=1 << 18)
def name_bits(name: str) -> int:
    """Return the 32 bits by which a name is stored: its hash, as a float that is a number.

    The lowest bit of an exponent of all zeros or all ones (denormal, infinite, not a number) is
    turned, as the specification wants.
    """
    bits = murmur3(name.encode())
    exponent = bits >> 23 & 0xFF
    return bits ^ 1 << 23 if exponent in (0, 0xFF) else bits


def manifest(names: Iterable[str]) -> dict[str, str]:
    """Return the manifest of names: each with its bits as eight hexadecimal digits."""
    return {name: f"{name_bits(name):08x}" for name in sorted(names)}


def header(layer: str, names: Mapping[str, str]) -> dict[str, str]:
    """Return what the header of an EXR file says about one matte.

    Parameters
    ----------
    layer
        Name of the matte; its channels are ``layer00.R`` and so on, to ``layer02.A``.
    names
        From `manifest`.
    """
    key = f"cryptomatte/{murmur3(layer.encode()):08x}"[: len("cryptomatte/") + 7]
    return {
        f"{key}/name": layer,
        f"{key}/hash": HASH,
        f"{key}/conversion": CONVERSION,
        f"{key}/manifest": json.dumps(dict(names), separators=(",", ":")),
    }


def filter_offsets(side: int) -> NDArray[np.float64]:
    """(side * side, 2) offsets from the middle of a pixel, in pixels, of equal weight.

    Along each axis they are the middles of as many equal shares of the filter as there are rays, so
    that an edge is placed to one ray even where it runs along a row; the golden ratio pairs them.
    """
    x = (np.arange(_FINE + 1) / _FINE - 0.5) * FILTER_WIDTH
    turn = 2 * np.pi * (x / FILTER_WIDTH + 0.5)
    value = sum(term * np.cos(number * turn) for number, term in enumerate(TERMS))
    share = np.concatenate([[0.0], np.cumsum((value[1:] + value[:-1]) / 2)])
    number = np.arange(side * side)
    spots = np.interp((number + 0.5) / len(number), share / share[-1], x)
    paired = np.argsort(np.argsort(number * GOLDEN % 1.0))
    return np.column_stack([spots, spots[paired]])


def ranked(seen: NDArray[np.int64]) -> tuple[NDArray[np.int64], NDArray[np.float32]]:
    """Rank what the rays of pixels meet by how many meet it.

    Parameters
    ----------
    seen
        (p, n) numbers of things, 0 where a ray meets nothing.

    Returns
    -------
    number
        (p, RANKS) things, the largest share first, the lower number first of equal ones; 0 where
        there are fewer.
    share
        (p, RANKS) of the rays, 0 to 1.
    """
    pixels, rays = seen.shape
    number = np.zeros((pixels, RANKS), seen.dtype)
    share = np.zeros((pixels, RANKS), np.float32)
    alone = (seen == seen[:, :1]).all(axis=1)
    number[alone, 0] = seen[alone, 0]
    share[alone, 0] = seen[alone, 0] != 0
    mixed = np.flatnonzero(~alone)
    if not len(mixed):
        return number, share
    held = np.sort(seen[mixed], axis=1)
    first = np.ones(held.shape, bool)
    first[:, 1:] = held[:, 1:] != held[:, :-1]
    start = np.flatnonzero(first)
    count = np.diff(np.append(start, held.size))
    row, thing = start // rays, held.ravel()[start]
    row, thing, count = row[thing != 0], thing[thing != 0], count[thing != 0]
    order = np.lexsort((thing, -count, row))
    row, thing, count = row[order], thing[order], count[order]
    begin = np.searchsorted(row, row)
    rank = np.arange(len(row)) - begin
    kept = rank < RANKS
    number[mixed[row[kept]], rank[kept]] = thing[kept]
    share[mixed[row[kept]], rank[kept]] = count[kept] / rays
    return number, share


def matte(
    number: NDArray[np.int64], share: NDArray[np.float32], names: Sequence[str]
) -> NDArray[np.float32]:
    """Return (..., 2 * RANKS) pairs of id and coverage, as layers of four hold them.

    Parameters
    ----------
    number, share
        (..., RANKS) from `ranked`.
    names
        Of things 1, 2, ...
    """
    bits = np.array([0, *map(name_bits, names)], np.uint32)
    found = np.empty((*number.shape, 2), np.float32)
    found[..., 0] = bits.view(np.float32)[number]
    found[..., 1] = share
    return found.reshape(*number.shape[:-1], 2 * number.shape[-1])


def coverage_of(layers: NDArray[np.float32], name: str) -> NDArray[np.float32]:
    """(h, w) share of a thing of a name in each pixel of a matte of (h, w, 2 * RANKS)."""
    ids = np.ascontiguousarray(layers[..., 0::2]).view(np.uint32)
    found: NDArray[np.float32] = np.where(ids == name_bits(name), layers[..., 1::2], 0.0).sum(-1)
    return found.astype(np.float32)
