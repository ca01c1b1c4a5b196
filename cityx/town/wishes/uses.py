"""The share of a use among the buildings of a city."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from typing import Annotated, Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.checks.predicates.building_predicates import share_slack
from cityx.checks.predicates.measuring import rows_of
from cityx.city import City, Goal
from cityx.city.asked_goals import asked
from cityx.errors import ActionFailed, UsageError
from cityx.ids import uniform
from cityx.protocol import Choice, Port, Range, action
from cityx.town.rebuilding import is_made

OTHER = "yes"  # use of what no more has a use that all have
# Use -> the word of predicates for buildings that have it.
GROUP_OF = {
    "apartments": "flats", "office": "office", "retail": "retail", "hotel": "commercial",
    "industrial": "industrial", "house": "house", "school": "civic", "civic": "civic",
}  # fmt: skip
USES = ("apartments", "office", "retail", "hotel", "industrial", "house", "school", "civic")


@action(
    "layout/use_share-v1",
    limits=["Buildings change their use, not their size."],
    requires=("layout",),
    after=("layout/density_gradient-v1",),
    takes=(Port("layout", "scene_layout"),),
    gives=(Port("layout", "scene_layout"),),
)
def use_share(
    city: City,
    *,
    use: Annotated[str, Choice(*USES)] = "office",
    share: Annotated[float, Range(0.0, 1.0)] = 0.3,
    least: Annotated[float | None, Range(0.0, 1.0)] = None,
    most: Annotated[float | None, Range(0.0, 1.0)] = None,
) -> City:
    """Give a use its share of the ground under buildings, or of their number.

    Parameters
    ----------
    city
        City with buildings.
    use
        Word of building=*.
    share
        0 to 1; met to two points in a hundred, in small places to half a building.
    least, most
        Bounds of the share of the number of buildings, in place of the share of the ground.
    """
    if least is not None or most is not None:
        return _by_number(city, use, least or 0.0, 1.0 if most is None else most)
    table = city.layout.buildings
    area = shapely.area(table.geometry.to_numpy())
    uses = table["use"].to_numpy().astype(object)
    wanted, has = share * area.sum(), uses == use
    more = area[has].sum() < wanted
    # The middle of the site changes first where there is too little, its outskirts where too much.
    site = shapely.box(*city.layout.extent).centroid
    away = np.round(shapely.distance(table.geometry.to_numpy(), site), 2)
    common = _most_common(uses[~has], area[~has]) if (~has).any() else use
    for row in np.argsort(away if more else -away, kind="stable").tolist():
        left = (wanted - area[uses == use].sum()) * (1 if more else -1)
        # A building that would miss the share by more than it does now stays as it is.
        if (uses[row] == use) == more or area[row] >= 2 * left:
            continue
        uses[row] = use if more else common
    reached = area[uses == use].sum() / max(area.sum(), 1e-9)
    if abs(reached - share) > share_slack(area):
        raise ActionFailed(
            f"A share of {share:g} for {use} cannot be met: the buildings allow {reached:.3f}."
        )
    slack = share_slack(area)
    goal = Goal(
        f"{100 * share:g} % {use}",
        f"share(building, tag={use}, by=area) in [{share - slack:.4f}, {share + slack:.4f}]",
    )
    return replace(with_uses(city, uses), goals=(*city.goals, goal))


def _by_number(city: City, use: str, least: float, most: float) -> City:
    """Change uses until a share of the number of buildings lies within bounds."""
    if least > most:
        raise UsageError(f"least = {least:g} is more than most = {most:g}.")
    table = city.layout.buildings
    uses = table["use"].to_numpy().astype(object)
    has = np.zeros(len(uses), bool)
    has[rows_of(f"building, use={GROUP_OF[use]}", city)] = True
    lot = uniform(city.seed, f"layout/use/{use}", table["id"].to_numpy(np.uint64))
    # A tall building over shops is one of offices, so the low ones become shops first.
    levels = table["levels"].to_numpy(float) if use == "retail" else np.zeros(len(lot))
    order = np.lexsort((lot, levels))
    free = order[~is_made(table)[order]]
    lacking = math.ceil(least * len(uses) - 1e-9) - int(has.sum())
    surplus = int(has.sum()) - math.floor(most * len(uses) + 1e-9)
    area = shapely.area(table.geometry.to_numpy())
    common = _most_common(uses[~has], area[~has]) if (~has).any() else OTHER
    uses[free[~has[free]][: max(lacking, 0)]] = use
    uses[free[has[free]][: max(surplus, 0)]] = common
    city = with_uses(city, uses)
    ends = {"least": least if least > 0.0 else None, "most": most if most < 1.0 else None}
    if not any(end is not None for end in ends.values()):
        return city
    return asked(city, f"share of {use}", f"share(building, use={GROUP_OF[use]})", **ends)


def _most_common(uses: NDArray[Any], area: NDArray[np.float64]) -> str:
    words, row = np.unique(uses.astype(str), return_inverse=True)
    return str(words[int(np.argmax(np.bincount(row.ravel(), area)))])


def with_uses(city: City, uses: NDArray[Any]) -> City:
    """Give buildings other uses.

    Parameters
    ----------
    uses
        (n,) words of building=*, of every building of the layout.
    """
    buildings, parts = city.layout.buildings.copy(), city.layout.parts.copy()
    changed = buildings["use"].to_numpy().astype(object) != uses
    of = np.searchsorted(buildings["id"].to_numpy(), parts["building"].to_numpy())
    own = parts["use"].to_numpy().astype(object)
    parts["use"] = np.where(changed[of], uses[of], own)
    buildings["use"] = uses
    tags = buildings["tags"].to_numpy().astype(object)
    tags[changed] = [
        _said(text, use) for text, use in zip(tags[changed], uses[changed], strict=True)
    ]
    buildings["tags"] = tags
    for table, before, columns in (
        (buildings, city.layout.buildings, ("use", "tags")),
        (parts, city.layout.parts, ("use",)),
    ):
        for column in columns:
            table[column] = table[column].astype(before[column].dtype)
    return replace(city, layout=replace(city.layout, buildings=buildings, parts=parts))


def _said(text: str, use: str) -> str:
    """Return a building's tags with another use."""
    return json.dumps({**json.loads(text or "{}"), "building": use}, sort_keys=True)
