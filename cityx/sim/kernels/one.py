"""One world of a batch."""

from __future__ import annotations

from typing import Any

from cityx.geometry.compiled import compiled
from cityx.sim.kernels.tables import Here


@compiled
def world_at(batch: Any, e: int) -> Any:
    """Return the state of one world, as views."""
    return Here(
        batch.real[e], batch.whole[e], batch.path[e], batch.clock[e : e + 1],
        batch.key[e : e + 1], batch.seed[e : e + 1], batch.episode[e : e + 1],
    )  # fmt: skip
