"""Random numbers in kernels: each world and mover has a stream of its own, by counting."""

from __future__ import annotations

from typing import Any

import numpy as np

from cityx.geometry.compiled import borrowing
from cityx.sim.kernels.tables import DRAWS


@borrowing
def mixed(value: Any) -> Any:
    """Scramble 64 bits (splitmix64), as `cityx.ids.mix` does."""
    x = np.uint64(value) + np.uint64(0x9E3779B97F4A7C15)
    x = (x ^ (x >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    x = (x ^ (x >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    return x ^ (x >> np.uint64(31))


@borrowing
def drawn(here: Any, n: int) -> Any:
    """Draw the next number in [0, 1) of a mover."""
    count = here.whole[DRAWS, n]
    here.whole[DRAWS, n] = count + 1
    bits = mixed(here.key[0] ^ mixed(np.uint64(n) * np.uint64(1 << 32) + np.uint64(count)))
    return float(bits >> np.uint64(11)) / 9007199254740992.0
