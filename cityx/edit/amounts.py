"""Amounts: what heights and storeys of buildings become that are set, raised, scaled or bounded."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def changed_amounts(
    now: NDArray[np.float64],
    to: float | None,
    *,
    factor: float,
    by: float,
    least: float | None,
    most: float | None,
) -> NDArray[np.float64]:
    """Return what amounts become, (n,).

    Parameters
    ----------
    now
        (n,) what they are.
    to
        What all of them are set to; None to start from what each is.
    factor, by
        What each is multiplied by, and what is added then.
    least, most
        Bounds, None for none.
    """
    wanted = np.full(len(now), float(to)) if to is not None else now * factor + by
    return wanted if least is None and most is None else np.clip(wanted, least, most)
