"""A number of buildings or of towers: exact, a least or a greatest one."""

from __future__ import annotations

import json
from dataclasses import replace
from typing import Annotated, Any

import numpy as np
import shapely

from cityx.checks.predicates.measuring import rows_of
from cityx.checks.predicates.words import BUILDING_TYPES, LEAST_BUILDING
from cityx.city import City, Layout
from cityx.city.asked_goals import asked
from cityx.errors import ActionFailed, UsageError
from cityx.geometry.arrays import BoolArray, IntArray
from cityx.geometry.rectangles import rectangles_of
from cityx.protocol import Choice, Port, Range, action
from cityx.sources.features.tagged import Owner
from cityx.town.rebuilding import (
    LOWER,
    is_made,
    with_buildings,
    with_heights,
    without_buildings,
)

LEAST_HALF = 45.0  # square metres of half a building
NARROWEST = 5.5  # metres wide that half a building is at least
FAR = 1e4  # metres; longer than any building
BESIDE_HOUSE = 12.0  # metres from a house to its shed
MOST = 100_000  # buildings; there may be any number


@action(
    "layout/buildings_count-v1",
    limits=["Where there are too many the smallest go; where there are too few large ones divide."],
    requires=("layout",),
    after=("layout/building_group-v1",),
    takes=(Port("layout", "scene_layout"),),
    gives=(Port("layout", "scene_layout"),),
    labels=("number", "count", "how many", "exactly", "at least", "at most"),
)
def buildings_count(
    city: City,
    *,
    count: Annotated[int | None, Range(0, MOST)] = None,
    least: Annotated[int, Range(0, MOST)] = 0,
    most: Annotated[int, Range(0, MOST)] = MOST,
    kind: Annotated[str, Choice("building", "tower")] = "building",
    with_sheds: bool = True,
) -> City:
    """Leave a city so many buildings.

    Parameters
    ----------
    city
        City with buildings.
    count
        Exact number. Those that were asked for by themselves, like towers, stay.
    least, most
        Bounds, where no exact number is said.
    kind
        What is counted; too many towers become lower, too few are built with `layout/towers-v1`.
    with_sheds
        Whether buildings below 45 square metres, sheds and garages, are counted; else those of a
        house go with it and the others stay.
    """
    least, most = (least, most) if count is None else (count, count)
    if least > most:
        raise UsageError(f"least = {least} is more than most = {most}.")
    if kind == "tower":
        return _towers(city, most)
    layout = city.layout
    made = asked_for(layout)
    counted = "building" if with_sheds else f"building, area >= {LEAST_BUILDING:g}"
    sheds = np.ones(len(layout.buildings), bool)
    sheds[rows_of(counted, city)] = False
    own = int((made & ~sheds).sum())
    if own > most:
        raise ActionFailed(f"{most} buildings are fewer than the {own} that were asked for before.")
    surplus = max(int((~sheds).sum()) - most, 0)
    if surplus:
        area = np.round(shapely.area(layout.buildings.geometry.to_numpy()), 2)
        gone = np.lexsort((area, made, sheds))[:surplus]
        layout = without_buildings(layout, np.r_[gone, _sheds_of(layout, gone, sheds, made)])
    elif int((~sheds).sum()) < least:
        free = np.flatnonzero(~asked_for(layout))
        layout = divided(city, layout, free, least + int(sheds.sum()) - len(layout.buildings))
    said = "exactly" if least == most else "at least" if most == MOST else "at most"
    number = most if said == "at most" else least
    words = f"{said} {number} building{'' if number == 1 else 's'}"
    bounds = {"least": least if least else None, "most": most if most < MOST else None}
    if count == 0:
        bounds["least"] = 0
    return asked(replace(city, layout=layout), words, f"n({counted})", **bounds)


def _sheds_of(layout: Layout, gone: IntArray, sheds: BoolArray, made: BoolArray) -> IntArray:
    """Return the sheds and garages that stand beside no house once some houses are gone.

    Those that stood alone before, like kiosks, are not among them, nor those that were asked for.
    """
    shapes = layout.buildings.geometry.to_numpy()
    stays = ~sheds
    stays[gone] = False
    rows = np.flatnonzero(sheds & ~made)
    beside_gone, beside_house = (
        np.unique(shapely.STRtree(own).query(shapes[rows], "dwithin", distance=BESIDE_HOUSE)[0])
        for own in (shapes[gone], shapes[stays])
    )
    return np.asarray(rows[np.setdiff1d(beside_gone, beside_house)])


def _towers(city: City, most: int) -> City:
    """Lower the towers that are too many, the least high first."""
    rows = rows_of("building, type=tower", city)
    height = city.layout.buildings["height"].to_numpy(float)[rows]
    made = is_made(city.layout.buildings)[rows]
    order = np.lexsort((np.round(height, 2), made))
    gone = rows[order[: max(len(rows) - most, 0)]]
    low = BUILDING_TYPES["tower"].height[0]
    layout = with_heights(city.layout, gone, np.full(len(gone), LOWER * low)) if len(gone) else (
        city.layout
    )  # fmt: skip
    words = f"at most {most} towers"
    return asked(replace(city, layout=layout), words, "n(building, type=tower)", most=most)


def asked_for(layout: Layout) -> Any:
    """(n,) whether a building was asked for by itself."""
    halves = layout.buildings["source"].str.startswith("made/half/").to_numpy(bool)
    return is_made(layout.buildings) & ~halves


def divided(city: City, layout: Layout, rows: IntArray, missing: int) -> Layout:
    """Halve the largest of some buildings across their longer side until there are so many more.

    Raises
    ------
    ActionFailed
        If they cannot be halved so often.
    """
    table = layout.buildings
    count = len(table) + missing
    # What each building has become.
    pieces = {row: [table.geometry.iloc[row]] for row in rows.tolist()}
    while missing:
        row, at, halves = _best_cut(pieces)
        if row < 0:
            raise ActionFailed(
                f"{count} buildings cannot be had: dividing those there are gives "
                f"{count - missing}. Ask for fewer, for a larger site or for smaller blocks."
            )
        pieces[row][at : at + 1] = halves
        missing -= 1
    cut = [k for k, shapes in pieces.items() if len(shapes) > 1]
    shapes, owners = [], []
    for row in cut:
        own = _tags_of(table, row)
        for k, shape in enumerate(pieces[row]):
            shapes.append(shape)
            owners.append(Owner(("made", "half", int(table["id"].iloc[row]), k), own))
    return with_buildings(city, without_buildings(layout, np.array(cut)), shapes, owners)


def _best_cut(pieces: dict[int, list[Any]]) -> tuple[int, int, list[Any]]:
    """Return the largest piece that can be halved: its building, its number, and the halves."""
    every = ((row, at, shape) for row, own in pieces.items() for at, shape in enumerate(own))
    order = sorted((-round(shape.area, 2), row, at) for row, at, shape in every)
    for _, row, at in order:
        halves = _halves(pieces[row][at])
        if halves:
            return row, at, halves
    return -1, -1, []


def _halves(shape: Any) -> list[Any]:
    """Cut a footprint across its longer side, [] where the halves would be too small."""
    if shape.area < 2 * LEAST_HALF:
        return []
    box = rectangles_of(np.array([shape], object))
    way = np.array([np.cos(box.angle[0]), np.sin(box.angle[0])])
    across = np.array([-way[1], way[0]])
    middle = box.centre[0]
    ring = [middle - FAR * across, middle + FAR * across]
    half = shapely.Polygon(np.round([*ring, ring[1] + FAR * way, ring[0] + FAR * way], 3))
    halves = [shapely.intersection(shape, half), shapely.difference(shape, half)]
    if any(part.geom_type != "Polygon" or part.area < LEAST_HALF for part in halves):
        return []
    sides = rectangles_of(np.array(halves, object))
    if min(sides.width.min(), sides.length.min()) < NARROWEST:
        return []
    return [shapely.orient_polygons(part) for part in halves]


def _tags_of(table: Any, row: int) -> dict[str, str]:
    """Return what is said of a building, with its height and storeys."""
    own = json.loads(table["tags"].iloc[row] or "{}")
    return {
        **own, "building": str(table["use"].iloc[row]),
        "building:levels": str(int(table["levels"].iloc[row])),
        "height": f"{table['height'].iloc[row]:.2f}",
    }  # fmt: skip
