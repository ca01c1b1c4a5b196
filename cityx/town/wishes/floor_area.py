"""How much floor a town has: for so many people, by plot ratio, or by the mean of its storeys."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated

import numpy as np
import shapely

from cityx.checks.predicates.capacity import HOMES, NET, PER_PERSON
from cityx.checks.predicates.measuring import rows_of
from cityx.city import City, Goal, Layout
from cityx.city.bounds import bounds_of, is_stated
from cityx.errors import ActionFailed, UsageError
from cityx.geometry.arrays import FloatArray, IntArray
from cityx.ids import uniform
from cityx.protocol import Port, Range, action
from cityx.town.rebuilding import with_heights, without_buildings
from cityx.town.wishes.counting import asked_for

WITHIN, CLOSE = 0.1, 0.05  # of what is asked, by which it is missed at most; to which it is built
LEAST_AREA = 45.0  # square metres; sheds and garages keep their storey
MOST_FLOORS = 60  # where nothing bounds them
STEEPEST = 8.0  # times that storeys are multiplied by at most
HALVINGS = 40


@action(
    "layout/floor_area-v1",
    limits=["Storeys change, and where they may not, houses are taken down; none is added."],
    requires=("layout",),
    after=("layout/building_limits-v1",),
    takes=(Port("layout", "scene_layout"),),
    gives=(Port("layout", "scene_layout"),),
    labels=("residents", "population", "plot ratio", "floor area ratio", "mean height", "density"),
)
def floor_area(
    city: City,
    *,
    people: Annotated[float, Range(0.0, 1e7)] = 0.0,
    ratio: Annotated[float, Range(0.0, 30.0)] = 0.0,
    floors: Annotated[float, Range(0.0, 100.0)] = 0.0,
    height: Annotated[float, Range(0.0, 500.0)] = 0.0,
) -> City:
    """Give a town floors for so many people, so much of them on its ground, or a mean height.

    Parameters
    ----------
    city
        City with buildings.
    people
        Who live in its houses and flats, 40 square metres each; 0 for any.
    ratio
        Square metres of floors over those of the site, 0 for any.
    floors, height
        Mean storeys and metres of the buildings, 0 for any.
    """
    asked = {"people": people, "ratio": ratio, "floors": floors, "height": height}
    for name, wanted in asked.items():
        if wanted:
            city = _reached(city, name, wanted)
    if not any(asked.values()):
        raise UsageError("Say for how many people, which ratio or which mean height.")
    return city


def _reached(city: City, name: str, wanted: float) -> City:
    """Change storeys until a measure is as wanted; what still is too much goes."""
    weight, rows = _weights(city, name)
    city = replace(city, layout=_with_storeys(city, weight, rows, wanted))
    weight, rows = _weights(city, name)
    levels = city.layout.buildings["levels"].to_numpy(float)
    total = float((weight * levels).sum())
    if total > (1 + CLOSE) * wanted and name in ("people", "ratio"):
        city = _with_fewer(city, weight * levels, rows, wanted)
        weight, _ = _weights(city, name)
        total = float((weight * city.layout.buildings["levels"].to_numpy(float)).sum())
    if abs(total - wanted) > WITHIN * wanted:
        raise ActionFailed(
            f"{_SAID[name].format(wanted)} cannot be had; the buildings there are reach "
            f"{_SAID[name].format(total)}. Ask for another site, zone or number of storeys."
        )
    low, high = (1 - WITHIN) * wanted, (1 + WITHIN) * wanted
    goal = Goal(_SAID[name].format(wanted), f"{_MEASURES[name]} in [{low:.6g}, {high:.6g}]")
    return replace(city, goals=(*city.goals, goal))


_SAID = {
    "people": "{:,.0f} residents", "ratio": "a plot ratio of {:.2f}",
    "floors": "{:.1f} storeys on average", "height": "{:.1f} m of height on average",
}  # fmt: skip
_MEASURES = {
    "people": "population", "ratio": "plot.ratio", "floors": "stat(building, floors, mean)",
    "height": "stat(building, height, mean)",
}  # fmt: skip


def _weights(city: City, name: str) -> tuple[FloatArray, IntArray]:
    """Return what each storey of each building adds to a measure, and which may change."""
    table = city.layout.buildings
    area = shapely.area(table.geometry.to_numpy())
    if not len(table):
        raise ActionFailed("There is no building whose storeys could be told.")
    free = (area >= LEAST_AREA) & ~asked_for(city.layout) & ~is_stated(table)
    xmin, ymin, xmax, ymax = city.layout.extent
    if name == "people":
        homes = np.zeros(len(table), bool)
        for use in HOMES:
            homes[rows_of(f"building, use={use}", city)] = True
        return np.where(homes, NET * area / PER_PERSON, 0.0), np.flatnonzero(free & homes)
    if name == "ratio":
        return area / ((xmax - xmin) * (ymax - ymin)), np.flatnonzero(free)
    if name == "floors":
        return np.full(len(table), 1 / len(table)), np.flatnonzero(free)
    storey = table["height"].to_numpy(float) / np.maximum(table["levels"].to_numpy(float), 1)
    return storey / len(table), np.flatnonzero(free)


def _with_storeys(city: City, weight: FloatArray, rows: IntArray, wanted: float) -> Layout:
    """Multiply storeys, within their bounds, so that their weighed sum is nearest to a number."""
    table = city.layout.buildings
    old = np.maximum(table["levels"].to_numpy(float), 1)
    bounds = bounds_of(table, "levels").of(rows)
    least = np.maximum(bounds.least, 1)
    most = np.minimum(bounds.most, np.maximum(MOST_FLOORS, old[rows]))
    fixed = float((weight * old).sum() - (weight[rows] * old[rows]).sum())
    own = weight[rows]
    drawn = uniform(city.seed, "layout/floor_area", table["id"].to_numpy(np.uint64)[rows])

    def storeys(factor: float) -> FloatArray:
        # Rounded by a draw, so that the sum rises evenly with the factor.
        return np.asarray(np.clip(np.floor(old[rows] * factor + drawn), least, most))

    low, high = 0.0, STEEPEST
    for _ in range(HALVINGS):
        middle = (low + high) / 2
        over = fixed + float((own * storeys(middle)).sum()) > wanted
        low, high = (low, middle) if over else (middle, high)
    new = storeys(low)
    changed = new != old[rows]
    height = table["height"].to_numpy(float)[rows] * new / old[rows]
    if not changed.any():
        return city.layout
    return with_heights(city.layout, rows[changed], np.round(height[changed], 2))


def _with_fewer(city: City, parts: FloatArray, rows: IntArray, wanted: float) -> City:
    """Take buildings down, in an order that is drawn, until a sum is no more than wanted."""
    ids = city.layout.buildings["id"].to_numpy(np.uint64)[rows]
    order = rows[np.argsort(uniform(city.seed, "layout/fewer", ids), kind="stable")]
    left = float(parts.sum()) - np.cumsum(parts[order])
    count = int(np.searchsorted(-left, -(1 + CLOSE / 2) * wanted)) + 1
    return replace(city, layout=without_buildings(city.layout, np.sort(order[:count])))
