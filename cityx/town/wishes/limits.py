"""Least and greatest heights and numbers of storeys of all buildings."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from cityx.city import City, Layout
from cityx.city.asked_goals import asked
from cityx.errors import ActionFailed, UsageError
from cityx.protocol import Port, Range, action
from cityx.town.rebuilding import with_heights

TALLEST = 800.0  # metres
MOST = 200  # storeys
STOREYS = (2.2, 9.0)  # metres that a storey may be high


@action(
    "layout/building_limits-v1",
    limits=["Buildings beyond the limits are made higher or lower as a whole."],
    requires=("layout",),
    after=("layout/buildings_count-v1",),
    takes=(Port("layout", "scene_layout"),),
    gives=(Port("layout", "scene_layout"),),
    labels=("height", "storeys", "floors", "levels", "at least", "at most", "taller", "lower"),
)
def building_limits(
    city: City,
    *,
    least_floors: Annotated[int, Range(1, MOST)] = 1,
    most_floors: Annotated[int, Range(1, MOST)] = MOST,
    lowest: Annotated[float, Range(0.0, TALLEST)] = 0.0,
    highest: Annotated[float, Range(3.0, TALLEST)] = TALLEST,
) -> City:
    """Keep the height and the storeys of every building within limits.

    Parameters
    ----------
    city
        City with buildings.
    least_floors, most_floors
        Storeys above ground.
    lowest, highest
        Metres, roof included.
    """
    if least_floors > most_floors:
        raise UsageError(f"least_floors = {least_floors} is more than most_floors = {most_floors}.")
    if lowest > highest:
        raise UsageError(f"lowest = {lowest:g} m is more than highest = {highest:g} m.")
    layout = _within(city.layout, (least_floors, most_floors), (lowest, highest))
    city = replace(city, layout=layout)
    if not len(layout.buildings):
        raise ActionFailed("There is no building whose height could be limited.")
    floors = ("floors", " floors", (least_floors, most_floors), (1, MOST))
    height = ("height", " m", (lowest, highest), (0.0, TALLEST))
    for name, unit, (least, most), (none, any_number) in (floors, height):
        if least > none:
            of = f"stat(building, {name}, min)"
            city = asked(city, f"no building below {least:g}{unit}", of, least=least)
        if most < any_number:
            of = f"stat(building, {name}, max)"
            city = asked(city, f"no building above {most:g}{unit}", of, most=most)
    return city


def _within(layout: Layout, floors: tuple[int, int], height: tuple[float, float]) -> Layout:
    table = layout.buildings
    levels, old = table["levels"].to_numpy().astype(float), table["height"].to_numpy()
    new = np.clip(old * np.clip(levels, *floors) / np.maximum(levels, 1), *height)
    rows = np.flatnonzero(np.abs(new - old) > 1e-9)
    if not len(rows):
        return layout
    layout = with_heights(layout, rows, new[rows])
    layout = _with_levels(layout, floors)
    _check(layout, rows)
    return layout


def _with_levels(layout: Layout, floors: tuple[int, int]) -> Layout:
    """Keep the storeys of buildings and of their parts within limits."""
    buildings, parts = layout.buildings.copy(), layout.parts.copy()
    buildings["levels"] = np.clip(buildings["levels"].to_numpy(), *floors).astype(np.int16)
    parts["levels"] = np.minimum(parts["levels"].to_numpy(), floors[1]).astype(np.int16)
    return replace(layout, buildings=buildings, parts=parts)


def _check(layout: Layout, rows: NDArray[np.int64]) -> None:
    """Refuse storeys that nobody could build."""
    table = layout.buildings.iloc[rows]
    storey = table["height"].to_numpy() / table["levels"].to_numpy()
    wrong = (storey < STOREYS[0]) | (storey > STOREYS[1])
    if wrong.any():
        worst = int(np.argmax(np.abs(np.log(storey / 3.2))))
        raise ActionFailed(
            f"{wrong.sum()} buildings would get storeys of {storey[worst]:.1f} m; between "
            f"{STOREYS[0]:g} and {STOREYS[1]:g} m are possible. Ask for a height and a number of "
            "floors that suit each other."
        )
