"""Gradients: taller or denser towards the middle, the edge or a side of a city."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.checks.predicates.whereabouts import nearness
from cityx.checks.predicates.words import TOWARDS
from cityx.city import City
from cityx.city.asked_goals import asked
from cityx.errors import ActionFailed, UsageError
from cityx.geometry.arrays import FloatArray
from cityx.ids import uniform
from cityx.protocol import Choice, Port, Range, action
from cityx.town.rebuilding import with_heights, without_buildings
from cityx.town.wishes.counting import asked_for

LEAST_AREA = 45.0  # square metres; smaller ones are sheds and garages, which stay
MOST_AREA = 100_000
STOREY = (2.6, 4.5)  # metres of a storey that is added
RISE = (2.0, 3)  # times, and by how many storeys, the highest are higher where nothing is said
PEAK = 1.4  # exponent by which storeys rise with nearness; above 1 few are high
ROUGH = 0.12  # of its height, by which a building differs from its neighbours
SLENDER = 4.5  # times the root of its footprint that a building is high at most
SPARSEST, FULL = 0.12, 0.6  # share of buildings kept farthest away; nearness from which all are
ENOUGH = {"height": 0.5, "around": 0.4}  # rank correlations that are asked of the finished city
LEAST = 5  # buildings


@action(
    "layout/height_gradient-v1",
    limits=["Sheds, garages and buildings asked for by themselves keep their heights."],
    requires=("layout",),
    after=("layout/kind_count-v1",),
    takes=(Port("layout", "scene_layout"),),
    gives=(Port("layout", "scene_layout"),),
    labels=("taller", "lower", "skyline", "towards", "centre", "edge", "gradient"),
)
def height_gradient(
    city: City,
    *,
    towards: Annotated[str, Choice(*TOWARDS)] = "center",
    least_floors: Annotated[int, Range(0, 200)] = 0,
    most_floors: Annotated[int, Range(0, 200)] = 0,
) -> City:
    """Make buildings taller the nearer they are to the middle, the edge or a side of a city.

    Parameters
    ----------
    city
        City with buildings.
    towards
        Where they are tallest.
    least_floors, most_floors
        Storeys of the lowest and of the tallest; 0 for those of the lowest there are, and some
        more than those of the tallest.
    """
    layout = city.layout
    table = layout.buildings
    area = shapely.area(table.geometry.to_numpy())
    rows = np.flatnonzero((area >= LEAST_AREA) & ~asked_for(layout))
    if len(rows) < LEAST:
        raise ActionFailed(f"A gradient needs {LEAST} buildings; there are {len(rows)}.")
    levels = np.maximum(table["levels"].to_numpy()[rows], 1)
    low = least_floors or max(int(np.percentile(levels, 10)), 1)
    high = most_floors or max(int(np.percentile(levels, 95)), round(RISE[0] * low), low + RISE[1])
    if high <= low:
        raise UsageError(
            f"Heights cannot rise from {low} storeys to {high}; allow more storeys at the top."
        )
    near = _quantile(nearness(shapely.centroid(table.geometry.to_numpy()[rows]), towards,
                              layout.extent))  # fmt: skip
    drawn = uniform(city.seed, "height_gradient", table["id"].to_numpy()[rows]) - 0.5
    wanted = low + (high - low) * near**PEAK
    floors = np.clip(np.rint(wanted * (1 + ROUGH * drawn)), low, high)
    storey = np.clip(table["height"].to_numpy()[rows] / levels, *STOREY)
    most = np.maximum(SLENDER * np.sqrt(area[rows]), storey * low)
    height = storey * np.minimum(floors, np.floor(most / storey))
    city = replace(city, layout=with_heights(layout, rows, np.round(height, 2)))
    return _asked(city, "taller", "height", towards)


@action(
    "layout/density_gradient-v1",
    limits=["Buildings are taken down where few shall stand; none are added."],
    requires=("layout",),
    after=("layout/elements-v1",),
    takes=(Port("layout", "scene_layout"),),
    gives=(Port("layout", "scene_layout"),),
    labels=("denser", "sparser", "thinning out", "towards", "outskirts", "gradient"),
)
def density_gradient(city: City, *, towards: Annotated[str, Choice(*TOWARDS)] = "center") -> City:
    """Let a city thin out away from its middle, its edge or a side.

    Parameters
    ----------
    city
        City with buildings.
    towards
        Where it is densest.
    """
    table = city.layout.buildings
    if len(table) < LEAST:
        raise ActionFailed(f"A gradient needs {LEAST} buildings; there are {len(table)}.")
    middles = shapely.centroid(table.geometry.to_numpy())
    near = _quantile(nearness(middles, towards, city.layout.extent))
    share = SPARSEST + (1 - SPARSEST) * np.clip(near / FULL, 0.0, 1.0) ** 2
    gone = uniform(city.seed, "density_gradient", table["id"].to_numpy()) >= share
    gone &= ~asked_for(city.layout)
    city = replace(city, layout=without_buildings(city.layout, np.flatnonzero(gone)))
    return _asked(city, "denser", "around", towards)


def _asked(city: City, word: str, measured: str, towards: str) -> City:
    """Ask of the finished city what was built."""
    counted = f"building, area in [{LEAST_AREA:g}, {MOST_AREA}]"
    quantity = f"trend({counted}, {measured}, {towards})"
    return asked(city, f"{word} towards the {towards}", quantity, least=ENOUGH[measured])


def _quantile(values: FloatArray) -> NDArray[np.float64]:
    """Return the share of values below each, (n,) 0 to 1."""
    order = np.argsort(np.argsort(values, kind="stable"), kind="stable")
    return np.asarray(order / max(len(values) - 1, 1), np.float64)
