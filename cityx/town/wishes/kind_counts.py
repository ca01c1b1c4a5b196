"""So many buildings of a kind: 40 houses, five offices, a few shops."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated

import numpy as np
import shapely

from cityx.checks.predicates.measuring import rows_of
from cityx.city import City, Layout
from cityx.city.asked_goals import asked
from cityx.errors import ActionFailed, UsageError
from cityx.geometry.arrays import IntArray
from cityx.ids import uniform
from cityx.protocol import Choice, Port, Range, action
from cityx.town.quarter_kinds import ANY_AREA, COUNTED_KINDS, KINDS, Kind
from cityx.town.wishes.counting import asked_for
from cityx.town.wishes.limits import within_limits
from cityx.town.wishes.uses import with_uses

MOST = 100_000  # buildings; there may be any number


@action(
    "layout/kind_count-v1",
    limits=["Buildings that stand change their use and their storeys, not their outline."],
    requires=("layout",),
    after=("layout/buildings_count-v1",),
    takes=(Port("layout", "scene_layout"),),
    gives=(Port("layout", "scene_layout"),),
    labels=("number", "count", "how many", "a few", "several"),
)
def kind_count(
    city: City,
    *,
    kind: Annotated[str, Choice(*COUNTED_KINDS)] = "house",
    count: Annotated[int | None, Range(0, MOST)] = None,
    least: Annotated[int, Range(0, MOST)] = 0,
    most: Annotated[int, Range(0, MOST)] = MOST,
) -> City:
    """Let so many buildings of a city be of a kind.

    Parameters
    ----------
    city
        City with buildings.
    kind
        What is counted.
    count
        Exact number. Those that were asked for before are neither taken nor changed.
    least, most
        Bounds, where no exact number is said.
    """
    least, most = (least, most) if count is None else (count, count)
    if least > most:
        raise UsageError(f"least = {least} is more than most = {most}.")
    own = KINDS[kind]
    has = rows_of(own.chosen, city)
    free = np.flatnonzero(~asked_for(city.layout))
    turned = _turned(city, np.intersect1d(has, free), max(len(has) - most, 0))
    taken = _taken(city, own, kind, np.setdiff1d(free, has), max(least - len(has), 0))
    uses = city.layout.buildings["use"].to_numpy().astype(object)
    uses[turned], uses[taken] = own.instead, own.use or kind
    city = with_uses(city, uses)
    city = replace(city, layout=within_limits(city, taken, own.floors))
    kept = np.setdiff1d(np.r_[has, taken], turned)
    if least:
        city = replace(city, layout=named(city.layout, kind, kept))
    said = f"{least}" if least == most else f"{least} to {most}" if most < MOST else (
        f"at least {least}"
    )  # fmt: skip
    ends = {"least": least if least else None, "most": most if most < MOST else None}
    if most == 0:
        ends["least"] = 0
    if ends["least"] is None and ends["most"] is None:
        return city
    return asked(city, f"{said} {kind}", f"n({own.chosen})", **ends)


def _turned(city: City, rows: IntArray, number: int) -> IntArray:
    """Return the rows of those of a kind that are too many, drawn."""
    if number > len(rows):
        raise ActionFailed(
            f"{number} are too many, but only {len(rows)} of them were not asked for before."
        )
    ids = city.layout.buildings["id"].to_numpy(np.uint64)[rows]
    lot = uniform(city.seed, "layout/kind_count", ids)
    return np.sort(rows[np.argsort(lot, kind="stable")][:number])


def _taken(city: City, own: Kind, kind: str, free: IntArray, number: int) -> IntArray:
    """Return the rows of those that become of a kind: those that suit it, nearest or farthest."""
    shapes = city.layout.buildings.geometry.to_numpy()[free]
    area = shapely.area(shapes)
    suits = (area >= own.area[0]) & (area <= own.area[1])
    if number > suits.sum():
        raise ActionFailed(
            f"{number} more are to be {kind.replace('_', ' ')}, but of the buildings that were not "
            f"asked for before only {suits.sum()} have a footprint of {own.area[0]:g} "
            f"{'to ' + format(own.area[1], 'g') if own.area[1] < ANY_AREA[1] else 'or more'} m2."
        )
    site = shapely.box(*city.layout.extent).centroid
    away = np.round(shapely.distance(shapes, site), 2)
    levels = city.layout.buildings["levels"].to_numpy(float)[free]
    beyond = np.maximum(levels - own.floors[1], 0) + np.maximum(own.floors[0] - levels, 0)
    order = np.lexsort((-away if own.outer else away, beyond, area < own.roomy, ~suits))
    return np.sort(free[order[:number]])


def named(layout: Layout, kind: str, rows: IntArray) -> Layout:
    """Say of buildings that they were asked for by themselves, so that later wishes keep them."""
    buildings = layout.buildings
    source = buildings["source"].to_numpy().astype(object)
    rows = rows[~asked_for(layout)[rows]]
    ids = buildings["id"].to_numpy(np.uint64)[rows]
    source[rows] = [f"made/{kind}/{number}" for number in ids.tolist()]
    named = buildings.assign(source=source)
    named["source"] = named["source"].astype(buildings["source"].dtype)
    return replace(layout, buildings=named)
