"""A curve taken out of a city again."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated

import numpy as np

from cityx.city.city import City
from cityx.city.layout import CURVE
from cityx.errors import ActionFailed, nearest
from cityx.protocol import Text, action


@action(
    "edit/erase_curve-v1",
    limits=["Who goes along the curve, and what is built on it, stays."],
    labels=("erase", "delete", "path", "curve"),
)
def erase_curve(city: City, *, name: Annotated[str, Text(60)]) -> City:
    """Take a curve out of the city.

    Parameters
    ----------
    city
        The city.
    name
        Name of the curve.
    """
    lines = city.layout.lines
    curves = lines["kind"].to_numpy() == CURVE
    gone = curves & (lines["source"].to_numpy() == name)
    if not gone.any():
        raise ActionFailed(
            f'The city has no curve "{name}".{nearest(name, lines["source"][curves].tolist())}'
        )
    kept = lines.iloc[np.flatnonzero(~gone)].reset_index(drop=True)
    return replace(city, layout=replace(city.layout, lines=kept))
