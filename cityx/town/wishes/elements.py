"""Elements of a town: an exact or a least number of churches, schools, playgrounds, fountains..."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import count
from typing import Annotated, Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.checks.predicates.places import places_of
from cityx.city import City, Layout
from cityx.city.asked_goals import asked, with_goal
from cityx.errors import ActionFailed, UsageError
from cityx.protocol import Choice, Port, Range, action
from cityx.sources.features.kinds import land_kind, point_kind
from cityx.sources.features.resolve import Features
from cityx.sources.features.shells import make_shells
from cityx.sources.features.tagged import Owner, Report, Tagged, Tags, nothing, tag
from cityx.town.elements import ELEMENTS, Element
from cityx.town.lots import (
    Lot,
    cost_of,
    is_open,
    lot_of,
    lots_along_streets,
    lots_on_shore,
    lots_on_squares,
    plan_of,
)
from cityx.town.rebuilding import cleared, is_made, with_features, without_buildings
from cityx.town.wishes.places import given_up

MOST = 10_000  # of one kind; there may be any number
NEAR = {"plaza": 120.0, "park": 150.0, "water": 150.0}  # metres within which it is beside one


@action(
    "layout/elements-v1",
    limits=["Buildings on the lot are taken down.", "A lot lies within one block."],
    requires=("layout",),
    after=("layout/towers-v1",),
    takes=(Port("layout", "scene_layout"),),
    gives=(Port("layout", "scene_layout"),),
    labels=("landmark", "number", *ELEMENTS),
)
def elements(
    city: City,
    *,
    kind: Annotated[str, Choice(*ELEMENTS)],
    least: Annotated[int, Range(0, 200)] = 1,
    most: Annotated[int, Range(0, MOST)] = MOST,
    side: Annotated[str, Choice("any", "middle", "edge", "north", "east", "south", "west")] = "any",
    near: Annotated[str, Choice("anything", "plaza", "park", "water")] = "anything",
) -> City:
    """Give a city so many churches, schools, playgrounds, fountains, ... .

    Parameters
    ----------
    city
        City with streets.
    kind
        What is counted.
    least, most
        How many there shall be; what there is too much of is taken away, the smallest first.
    side
        Where new ones stand: a side of the site, its middle or its edge.
    near
        What new ones stand beside.
    """
    if least > most:
        raise UsageError(f"least = {least} is more than most = {most}.")
    element = ELEMENTS[kind]
    found = _found(city, element)
    city = _without(city, element, found[: max(len(found) - most, 0)])
    for _ in range(least - len(found)):
        city = _with_one_more(city, element, side, near)
    word = kind.replace("_", " ")
    end = None if most == MOST else most
    said = f"{least} {word}" if least == most else f"at least {least} {word}"
    city = asked(city, said, f"n({element.measure})", least=least, most=end)
    if side in ("north", "east", "south", "west") and least:
        city = with_goal(city, f"{word} in the {side}", f"side({element.measure}) == {side}")
    return city


def _found(city: City, element: Element) -> NDArray[Any]:
    """Return what there is of an element, the smallest first: rows of buildings or points, land."""
    layout = city.layout
    if element.building:
        rows = np.flatnonzero(layout.buildings["use"].to_numpy() == element.building["building"])
        areas = np.round(shapely.area(layout.buildings.geometry.to_numpy()[rows]), 2)
        return rows[np.argsort(areas, kind="stable")]
    if not element.areas:
        own = point_kind(element.points[0].tags)
        return np.flatnonzero(layout.points["kind"].to_numpy() == own)
    places = places_of(city, element.measure)
    return np.asarray(places[np.argsort(np.round(shapely.area(places), 2), kind="stable")])


def _without(city: City, element: Element, gone: NDArray[Any]) -> City:
    layout = city.layout
    if not len(gone):
        return city
    if element.building:
        return replace(city, layout=without_buildings(layout, gone))
    if not element.areas:
        kept = np.setdiff1d(np.arange(len(layout.points)), gone)
        points = layout.points.iloc[kept].reset_index(drop=True)
        return replace(city, layout=replace(layout, points=points))
    if element.where == "water":
        return replace(city, layout=_without_areas(layout, gone))
    for place in gone.tolist():
        city = given_up(city, element.measure, place)
    return city


def _without_areas(layout: Layout, gone: NDArray[Any]) -> Layout:
    """Take out of a layout what stands in the water, so that water is left."""
    inner = shapely.buffer(gone, -0.1)
    areas = layout.areas
    piers = areas["kind"].to_numpy() == "pier"
    hit = shapely.intersects(areas.geometry.to_numpy(), shapely.union_all(inner))
    return replace(layout, areas=areas[~(piers & hit)].reset_index(drop=True))


def _with_one_more(city: City, element: Element, side: str, near: str) -> City:
    """Build one more of an element on the lot that suits best."""
    layout = city.layout
    on_square = element.where == "square" and side == "any" and near == "anything"
    at_water = element.where in ("shore", "water")
    lots = lots_on_squares(city, element) if on_square else []
    lots = lots_on_shore(layout, element) if at_water else lots
    if not lots and element.where == "water":
        raise _no_shore(element)
    lots = lots or list(lots_along_streets(layout, element))
    if near != "anything":
        lots = _beside(lots, places_of(city, near), NEAR[near])
        if not lots:
            word = element.name.replace("_", " ")
            raise ActionFailed(f"There is no room for a {word} beside a {near}.")
    if not lots:
        width, depth = (element.least * size for size in element.lot)
        raise ActionFailed(
            f"No block is free for a {element.name.replace('_', ' ')}, which takes {width:.0f} m "
            f"by {depth:.0f} m; ask for fewer things, or for a larger site."
        )
    lot = min(lots, key=cost_of(layout, element, side if side != "any" else element.where))
    in_the_way = not is_open(layout, lot.placed(lot_of(element)))
    if element.where != "water" and (not on_square or in_the_way):
        layout = cleared(layout, lot.placed(lot_of(element)))
    return replace(city, layout=_drawn(city, layout, element, lot))


def _no_shore(element: Element) -> ActionFailed:
    width, depth = (element.least * size for size in element.lot)
    word = element.name.replace("_", " ")
    return ActionFailed(
        f"No shore has water free for a {word}, which takes {width:.0f} m by {depth:.0f} m; "
        "ask for fewer, or for a sea or a larger lake."
    )


def _beside(lots: Sequence[Lot], places: NDArray[Any], reach: float) -> list[Lot]:
    """Return the lots within so many metres of some places."""
    spots = shapely.points([lot.front for lot in lots]) if lots else np.zeros(0, object)
    near = np.unique(shapely.STRtree(places).query(spots, predicate="dwithin", distance=reach)[0])
    return [lots[k] for k in near.tolist()]


def _drawn(city: City, layout: Layout, element: Element, lot: Lot) -> Layout:
    """Add an element to a layout that has room for it."""
    key = _free_key(layout, element.name)
    outlines, parts = _volumes(element, lot, key)
    grounds = [(plan_of(item), item.tags) for item in element.areas]
    if element.land:
        taken = shapely.union_all([shape for shape, _ in grounds])
        grounds.append((shapely.difference(lot_of(element), taken), element.land))
    faces = _facing(lot) if element.where == "shore" else {}
    spots = [(shapely.Point(item.at), {**item.tags, **faces}) for item in element.points]
    shells, box = make_shells(outlines, parts, layout.extent, Report())
    features = Features(
        box,
        shells,
        areas=_placed(grounds, lot, (*key, "land")),
        area_kinds=np.array([land_kind(tags) for _, tags in grounds], object),
        points=_placed(spots, lot, (*key, "thing")),
    )
    return with_features(city, layout, features)


def _facing(lot: Lot) -> Tags:
    """Return the tag by which a thing on a lot at the water faces it, a compass bearing."""
    x, y = float(lot.along[1]), float(-lot.along[0])
    return {"direction": f"{np.degrees(np.arctan2(x, y)) % 360.0:.0f}"}


def _placed(items: Sequence[tuple[Any, Tags]], lot: Lot, key: tuple[object, ...]) -> Tagged:
    """Place drawings with their tags on a lot, each an owner of its own."""
    shapes = [lot.placed(shape) for shape, _ in items]
    return tag(shapes, [Owner((*key, k), tags) for k, (_, tags) in enumerate(items)])


def _volumes(element: Element, lot: Lot, key: tuple[object, ...]) -> tuple[Tagged, Tagged]:
    """Return the outlines of the buildings of an element, the main one first, and its parts."""
    if not element.building:
        return nothing(), nothing()
    use = element.building["building"]
    volumes = [
        (plan_of(part), {"building:part": part.kind or use, **part.tags()})
        for part in element.parts
    ]
    largest = max(element.parts, key=lambda part: plan_of(part).area)
    top = max(part.height for part in element.parts)
    whole = lot.placed(shapely.union_all([plan for plan, _ in volumes]))
    tags = {**largest.tags(), **element.building, "height": f"{top:g}"}
    roofs = [(plan_of(part), {"building": part.kind, **part.tags()}) for part in element.canopies]
    owners = [Owner((*key, "roof", k), own) for k, (_, own) in enumerate(roofs)]
    shapes = [whole, *(lot.placed(shape) for shape, _ in roofs)]
    outlines = tag(shapes, [Owner(key, tags), *owners])
    return outlines, _placed(volumes, lot, (*key, "part")) if len(volumes) > 1 else nothing()


def _free_key(layout: Layout, name: str) -> tuple[object, ...]:
    """Return the first key of an element of a name that nothing in a layout has."""
    tables = (layout.buildings, layout.areas, layout.points)
    sources = [source for table in tables for source in table["source"][is_made(table)]]
    own = f"made/{name}/"
    taken = {source.split("/")[2] for source in sources if source.startswith(own)}
    return "made", name, next(number for number in count() if str(number) not in taken)
