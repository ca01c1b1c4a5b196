"""Random numbers and ids that depend on identity alone, never on order of evaluation.

A stream is keyed by (seed, purpose, object id), so build order, tiles, processes and machines
change nothing, and editing one object leaves the numbers of all others as they were.

References
----------
Steele, Lea and Flood, "Fast splittable pseudorandom number generators", OOPSLA 2014 (splitmix64).
"""

from __future__ import annotations

from functools import lru_cache
from hashlib import blake2b

import numpy as np
from numpy.typing import ArrayLike, NDArray

UInt64Array = NDArray[np.uint64]

_GOLDEN = np.uint64(0x9E3779B97F4A7C15)
_MIX_1 = np.uint64(0xBF58476D1CE4E5B9)
_MIX_2 = np.uint64(0x94D049BB133111EB)
_SHIFTS = tuple(np.uint64(bits) for bits in (30, 27, 31))
# 53 bits fill the mantissa of a float64, so the quotient is uniform and exact.
_MANTISSA = 53
_ALL = 0xFFFFFFFFFFFFFFFF


def stable_id(*parts: object) -> int:
    """Return the 64-bit id of an identity such as ``("osm", "way", 123)``.

    The same parts give the same id on every machine. Zero is never returned: it means "no object".
    """
    text = "\x1f".join(map(str, parts)).encode()
    return int.from_bytes(blake2b(text, digest_size=8).digest(), "little") or 1


def id_text(object_id: int) -> str:
    """Return the id as it is written in names, reports and exports: 16 hexadecimal digits."""
    return f"{int(object_id):016x}"


def mix(values: ArrayLike) -> UInt64Array:
    """Scramble 64-bit integers (splitmix64 finaliser), elementwise."""
    x = np.array(values, dtype=np.uint64)
    # In place: arrays wrap around in silence, while the scalars that 0-d results become would warn.
    x += _GOLDEN
    x ^= x >> _SHIFTS[0]
    x *= _MIX_1
    x ^= x >> _SHIFTS[1]
    x *= _MIX_2
    x ^= x >> _SHIFTS[2]
    return x


def hash_ids(seed: int, purpose: str, ids: ArrayLike, k: ArrayLike = 0) -> UInt64Array:
    """Hash ids to 64 random bits each, for one purpose and draw number `k` (both broadcast)."""
    key = np.uint64(_purpose_key(seed, purpose))
    ids = np.asarray(ids, dtype=np.uint64)
    return mix(mix(ids ^ key) ^ mix(np.asarray(k, dtype=np.uint64)))


@lru_cache(maxsize=4096)
def _purpose_key(seed: int, purpose: str) -> int:
    return int(mix(np.uint64(stable_id(seed & _ALL, purpose))))


def _mix_one(value: int) -> int:
    """Scramble one 64-bit integer as `mix` does."""
    x = (value + int(_GOLDEN)) & _ALL
    x = ((x ^ (x >> 30)) * int(_MIX_1)) & _ALL
    x = ((x ^ (x >> 27)) * int(_MIX_2)) & _ALL
    return x ^ (x >> 31)


def hash_bits(seed: int, purpose: str, object_id: int, k: int = 0) -> int:
    """Hash one id as `hash_ids` does, ten times as fast for a single one."""
    key = _purpose_key(seed, purpose)
    return _mix_one(_mix_one((int(object_id) & _ALL) ^ key) ^ _mix_one(int(k) & _ALL))


def draw(seed: int, purpose: str, object_id: int, k: int = 0) -> float:
    """Draw the number that `uniform` draws for one id."""
    return (hash_bits(seed, purpose, object_id, k) >> (64 - _MANTISSA)) / (1 << _MANTISSA)


def uniform(seed: int, purpose: str, ids: ArrayLike, k: ArrayLike = 0) -> NDArray[np.float64]:
    """Draw one number in [0, 1) per id, for one purpose and draw number `k`."""
    bits = hash_ids(seed, purpose, ids, k) >> np.uint64(64 - _MANTISSA)
    return bits.astype(np.float64) / float(1 << _MANTISSA)


def choose(
    seed: int, purpose: str, ids: ArrayLike, weights: ArrayLike, k: ArrayLike = 0
) -> NDArray[np.int64]:
    """Draw one index per id with the given relative weights, (m,) float, not all zero."""
    edges = np.cumsum(np.asarray(weights, dtype=float))
    drawn = np.searchsorted(edges, uniform(seed, purpose, ids, k) * edges[-1], side="right")
    return np.asarray(drawn, dtype=np.int64)


def rng_for(seed: int, purpose: str, object_id: int) -> np.random.Generator:
    """Return a generator of its own for one object and purpose."""
    key = int(hash_ids(seed, purpose, np.uint64(object_id)))
    return np.random.Generator(np.random.Philox(key=key))
