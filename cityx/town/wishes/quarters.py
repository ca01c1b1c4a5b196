"""Quarters: what most buildings are in a part of a city, or along a river, a square, a street."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated, Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.checks.predicates.whereabouts import is_in_part, is_near, is_on_side
from cityx.checks.predicates.words import BESIDE, LEAST_BUILDING, SITE_PARTS
from cityx.city import City, Goal, Layout
from cityx.errors import ActionFailed, UsageError
from cityx.geometry.arrays import BoolArray, IntArray
from cityx.ids import UInt64Array, stable_id, uniform
from cityx.protocol import Choice, Port, Range, action
from cityx.sources.features.tagged import Owner, Tagged, joined
from cityx.town.blocks import Blocks
from cityx.town.cutting import off_streets
from cityx.town.elements import ELEMENTS, SIDES
from cityx.town.quarter_kinds import ANY_FLOORS, KINDS, Kind, share_beside, share_in_part
from cityx.town.rebuilding import (
    cleared,
    is_made,
    street_blocks,
    with_tagged,
    without_buildings,
)
from cityx.town.window import buildings_on
from cityx.town.wishes.counting import asked_for
from cityx.town.wishes.elements import WHERE
from cityx.town.wishes.limits import within_limits
from cityx.town.wishes.standing import ANYTHING, shapes_of
from cityx.town.wishes.street_design import with_main_street
from cityx.town.wishes.uses import with_uses

MARGIN = 2.0  # metres from what stands to new plots
LEAST_LAND = 500.0  # square metres of what is left of a block, that is built on anew
NARROW = 3.0  # metres of half of what is too narrow for plots
OPEN = ("park", "pedestrian", "wood", "forest", "meadow", "farmland", "water", "sea", "river",
        "wetland", "sand", "cemetery", "pitch")  # fmt: skip
MIDDLE = 0.5  # density within the zone


@action(
    "layout/quarter-v1",
    limits=["Buildings that stand there get another use, or are taken down and others built."],
    requires=("layout",),
    after=("layout/use_share-v1",),
    takes=(Port("layout", "scene_layout"),),
    gives=(Port("layout", "scene_layout"),),
    labels=("quarter", "part of the town"),
)
def quarter(
    city: City,
    *,
    kind: Annotated[str, Choice(*KINDS)] = "house",
    part: Annotated[str, Choice("any", *SITE_PARTS)] = "any",
    near: Annotated[str, Choice(*WHERE)] = ANYTHING,
    within: Annotated[float, Range(10.0, 1000.0)] = BESIDE,
    side: Annotated[str, Choice("any", *SIDES)] = "any",
    share: Annotated[float, Range(0.0, 1.0)] = 1.0,
    begin: Annotated[float, Range(0.0, 1.0)] = 0.0,
) -> City:
    """Let most buildings in a part of a city, or beside something in it, be of one kind.

    Parameters
    ----------
    city
        City with buildings.
    kind
        What they become.
    part
        Of the site: its middle, its edge, a side or a half; a side is less than its half.
    near
        What they stand beside.
    within
        Metres from that within which they are beside it.
    side
        Of that, on which they stand.
    share
        Of the buildings there, that become of the kind.
    begin
        Where their share begins, in an order that is drawn; others have what lies before.
    """
    if part == "any" and near == ANYTHING:
        raise UsageError('Say where the quarter is, by "part" or by "near".')
    made = KINDS[kind]
    places = np.zeros(0, object)
    if near != ANYTHING:
        city = with_main_street(city) if near == "main_street" else city
        places = shapes_of(city, near)
        if not len(places):
            raise ActionFailed(f"There is no {near.replace('_', ' ')} for a {kind} to be beside.")

    def lies_there(shapes: NDArray[Any]) -> BoolArray:
        there = np.ones(len(shapes), bool)
        if part != "any":
            there &= is_in_part(shapes, part, city.layout.extent)
        if len(places):
            there &= is_near(shapes, places, within)
        if len(places) and side != "any":
            there &= is_on_side(shapes, places, side)
        return there

    stand = city.layout.buildings.geometry.to_numpy()
    rows = np.flatnonzero(lies_there(stand) & ~asked_for(city.layout))
    if not len(rows):
        raise ActionFailed(f"No building stands where each shall be a {kind}.")
    if made.zone:
        city = replace(city, layout=rebuilt_as(city, made, kind, stand[rows], (begin, share)))
    else:
        ids = city.layout.buildings["id"].to_numpy(np.uint64)[rows]
        rows = rows[_drawn(city.seed, ids, begin, share)]
        city = _of_another_use(city, made.use, rows)
    if made.floors != ANY_FLOORS:
        there = lies_there(city.layout.buildings.geometry.to_numpy())
        own = (city.layout.buildings["use"] == made.use).to_numpy(bool)
        rows = np.flatnonzero(there & own & ~asked_for(city.layout))
        city = replace(city, layout=within_limits(city, rows, made.floors))
    return replace(city, goals=(*city.goals, *_goals(kind, part, near, within, share, side)))


def _goals(
    kind: str, part: str, near: str, within: float, share: float, side: str
) -> tuple[Goal, ...]:  # fmt: skip
    word = kind.replace("_", " ")
    found = []
    if part != "any":
        found.append(Goal(f"{word} in the {part}", share_in_part(kind, part, share)))
    if near != ANYTHING:
        there = near.replace("_", " ")
        where = f"beside {there}" if side == "any" else f"{side} of {there}"
        told = near if side == "any" else f"{side} of {near}"
        found.append(Goal(f"{word} {where}", share_beside(kind, told, within, share)))
    return tuple(found)


def _of_another_use(city: City, use: str, rows: NDArray[np.int64]) -> City:
    """Give buildings another use, sheds apart."""
    table = city.layout.buildings
    rows = rows[shapely.area(table.geometry.to_numpy()[rows]) >= LEAST_BUILDING]
    uses = table["use"].to_numpy().astype(object)
    uses[rows] = use
    return with_uses(city, uses)


def _drawn(seed: int, ids: UInt64Array, begin: float, share: float) -> IntArray:
    """Return the rows of a share of things, in an order that is drawn by their ids."""
    order = np.argsort(uniform(seed, "layout/quarter", ids), kind="stable")
    first, last = round(begin * len(ids)), round((begin + share) * len(ids))
    return np.sort(order[first:last])


def rebuilt_as(
    city: City, made: Kind, kind: str, stand: NDArray[Any],
    drawn: tuple[float, float] = (0.0, 1.0),
) -> Layout:  # fmt: skip
    """Take down what stands on some street blocks, and build houses of a zone on them.

    Parameters
    ----------
    stand
        (k,) footprints that tell which blocks.
    drawn
        Where the share of these blocks begins that are built on, and how large it is.

    Raises
    ------
    ActionFailed
        If no block there has room.
    """
    layout = city.layout
    land = _free_land(layout, street_blocks(layout))
    land = land[np.unique(shapely.STRtree(land).query(stand, predicate="intersects")[1])]
    middles = np.round(shapely.get_coordinates(shapely.centroid(land))).astype(np.int64)
    places = np.array([stable_id("quarter", x, y) for x, y in middles.tolist()], np.uint64)
    land = land[_drawn(city.seed, places, *drawn)]
    if not len(land):
        raise ActionFailed(f"No block that has room for a {kind} lies there.")
    for place in land.tolist():
        layout = cleared(layout, place)
    middles = np.round(shapely.get_coordinates(shapely.centroid(land)) * 1000).astype(np.int64)
    ids = [stable_id("quarter", kind, x, y) for x, y in middles.tolist()]
    count = len(land)
    laid = Blocks(
        land, np.array(ids, np.uint64), np.full(count, made.zone, object),
        np.full(count, "", object), np.full(count, MIDDLE), np.full(count, np.nan),
    )  # fmt: skip
    built = joined(*buildings_on([(laid, land)], layout.extent, (0, 0), city.seed))
    layout = with_tagged(city, layout, _called(built, made.use))
    return without_buildings(layout, np.flatnonzero(off_streets(layout)))


def _free_land(layout: Layout, blocks: NDArray[Any]) -> NDArray[Any]:
    """Return what blocks have that is neither park nor asked for by itself, (m,) polygons."""
    areas = layout.areas
    of = areas["source"].str.split("/").str[1]
    own = is_made(areas) & of.isin(ELEMENTS).to_numpy(bool)
    open_land = areas.geometry.to_numpy()[areas["kind"].isin(OPEN).to_numpy() | own]
    kept = asked_for(layout)
    stand = layout.buildings.geometry.to_numpy()[kept]
    things = layout.points.geometry.to_numpy()[is_made(layout.points)]
    lines = layout.lines.geometry.to_numpy()[is_made(layout.lines)]
    taken = shapely.union_all(np.concatenate([
        shapely.buffer(open_land, MARGIN), shapely.buffer(stand, 2 * MARGIN),
        shapely.buffer(things, 2 * MARGIN), shapely.buffer(lines, 2 * MARGIN),
    ]))  # fmt: skip
    left = shapely.difference(blocks, taken)
    pieces = shapely.get_parts(shapely.buffer(shapely.buffer(left, -NARROW), NARROW, quad_segs=2))
    pieces = pieces[(shapely.get_type_id(pieces) == 3) & (shapely.area(pieces) >= LEAST_LAND)]
    pieces = shapely.orient_polygons(shapely.simplify(pieces, 0.02))
    box = np.round(shapely.bounds(pieces), 3)
    return np.asarray(pieces[np.lexsort(box.T)])


def _called(stand: Tagged, use: str) -> Tagged:
    """Call the larger buildings by the word of their kind."""
    if not use:
        return stand
    small = ("garage", "shed", "roof", "carport")
    owners = [
        Owner(one.key, {**one.tags, "building": use}, one.more)
        if one.tags.get("building", small[0]) not in small else one
        for one in stand.owners
    ]  # fmt: skip
    return replace(stand, owners=owners)
