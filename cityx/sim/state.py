"""The state of a batch of worlds: arrays that are copied, kept and hashed as a whole."""

from __future__ import annotations

from dataclasses import dataclass, fields
from hashlib import blake2b
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cityx.geometry.arrays import FloatArray, IntArray
from cityx.sim.kernels.tables import REAL, WHOLE, Batch
from cityx.system.packed import read_arrays, write_arrays

DT = 0.1  # seconds of a step
LONGEST = 96  # pieces of a route


@dataclass(frozen=True)
class State:
    """E worlds of N movers; kernels write to its arrays.

    Attributes
    ----------
    real
        (E, r, N) float64, rows `cityx.sim.kernels.tables.REAL`: metres, radians, m/s, seconds.
    whole
        (E, w, N) int64, rows `cityx.sim.kernels.tables.WHOLE`.
    path
        (E, N, p) int32, pieces of the way of each mover.
    clock
        (E,) float64, seconds of the signals.
    key, seed
        (E,) uint64, of the random streams.
    episode
        (E,) int64, how many have begun.
    """

    real: FloatArray
    whole: IntArray
    path: NDArray[np.int32]
    clock: FloatArray
    key: NDArray[np.uint64]
    seed: NDArray[np.uint64]
    episode: IntArray

    @property
    def batch(self) -> Batch:
        """The arrays as kernels take them."""
        return Batch(self.real, self.whole, self.path, self.clock, self.key, self.seed,
                     self.episode)  # fmt: skip

    def row(self, name: str) -> FloatArray:
        """(E, N) one row of `real` by its name, to be read."""
        return np.asarray(self.real[:, REAL.index(name)])

    def copy(self) -> State:
        """Return a state of its own that is equal."""
        return State(**{each.name: getattr(self, each.name).copy() for each in fields(self)})

    def assign(self, other: State) -> None:
        """Take on another state of the same shape."""
        for each in fields(self):
            getattr(self, each.name)[...] = getattr(other, each.name)

    def digests(self) -> list[str]:
        """Return a hash of each world, 32 hexadecimal digits, over every bit of it."""
        found = []
        for e in range(len(self.clock)):
            hasher = blake2b(digest_size=16)
            for array in (self.real[e], self.whole[e], self.path[e], self.clock[e : e + 1],
                          self.key[e : e + 1]):  # fmt: skip
                hasher.update(np.ascontiguousarray(array).data)
            found.append(hasher.hexdigest())
        return found

    def write(self, path: Path) -> None:
        """Write it to a file (.npz)."""
        write_arrays(path, {each.name: getattr(self, each.name) for each in fields(self)})


def new_state(worlds: int, movers: int, longest: int = LONGEST) -> State:
    """Return a state in which no episode has begun, with room for so long ways."""
    return State(
        np.zeros((worlds, len(REAL), movers)), np.zeros((worlds, len(WHOLE), movers), np.int64),
        np.full((worlds, movers, longest), -1, np.int32), np.zeros(worlds),
        np.zeros(worlds, np.uint64), np.zeros(worlds, np.uint64), np.zeros(worlds, np.int64),
    )  # fmt: skip


def read_state(path: Path) -> State:
    """Read a state back."""
    return State(**read_arrays(path))
