"""Elements of a town: an exact or a least number of churches, schools, playgrounds, fountains..."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import count
from typing import Annotated, Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.checks.predicates import measure
from cityx.checks.predicates.words import COMPASS
from cityx.city import City, Goal, Layout
from cityx.city.asked_goals import asked
from cityx.errors import ActionFailed, UsageError
from cityx.protocol import Choice, Port, Range, action
from cityx.sources.features.kinds import land_kind
from cityx.sources.features.resolve import Features
from cityx.sources.features.shells import make_shells
from cityx.sources.features.tagged import Owner, Report, Tagged, Tags, nothing, tag
from cityx.town.elements import (
    ELEMENTS,
    GROUNDS,
    HOMES,
    PARTS,
    PLACES,
    RELATIONS,
    SIDES,
    SIZES,
    WITH_SECOND,
    Distance,
    Element,
    measures,
    relation_of,
)
from cityx.town.lots import (
    Lot,
    bearing_of,
    cheapest,
    ground_of,
    in_metres,
    lot_of,
    lots_along_streets,
    lots_on_shore,
    lots_on_squares,
    plan_of,
    size_of,
)
from cityx.town.rebuilding import cleared, is_made, with_features, without_buildings
from cityx.town.wishes.line_elements import with_line, without_line
from cityx.town.wishes.places import given_up
from cityx.town.wishes.standing import (
    ANYTHING,
    EDGE,
    MIDDLE,
    Wish,
    apart,
    found_of,
    largest,
    lots_at_ends,
    related,
    shapes_of,
    with_longer_pier,
)
from cityx.town.wishes.street_design import with_main_street

MOST = 10_000  # of one kind; there may be any number
ROOF = 7.4  # metres from the middle of a flat roof to its edge at least, for what stands on it
_WHERE = {
    **{one: one for one in RELATIONS}, "end": "at the end of", "before": "in front of",
    **{side: f"{side} of" for side in SIDES}, "across": "on the other side from",
}  # fmt: skip
_HELD = frozenset(place for places in GROUNDS.values() for place in places)
AFLOAT = ("pier", "breakwater", "harbour")  # at whose ends is water
WHERE = (ANYTHING, *dict.fromkeys((*PLACES, *HOMES, *ELEMENTS)))


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
    side: Annotated[str, Choice("any", "middle", "edge", *COMPASS)] = "any",
    near: Annotated[str, Choice(*WHERE)] = ANYTHING,
    relation: Annotated[str, Choice(*RELATIONS)] = "near",
    second: Annotated[str, Choice(*WHERE)] = ANYTHING,
    metres: Annotated[float, Range(0.0, 5000.0)] = 0.0,
    nearest: Annotated[float, Range(0.0, 5000.0)] = 0.0,
    farthest: Annotated[float, Range(0.0, 5000.0)] = 0.0,
    parts: Annotated[int, Range(-1, 40)] = -1,
    height: Annotated[float, Range(0.0, 40.0)] = 0.0,
    size: Annotated[str, Choice("usual", *SIZES)] = "usual",
    length: Annotated[float, Range(0.0, 1000.0)] = 0.0,
    width: Annotated[float, Range(0.0, 1000.0)] = 0.0,
) -> City:
    """Give a city so many churches, schools, playgrounds, fountains, ... .

    Parameters
    ----------
    city
        City with streets.
    kind
        What is counted.
    least, most
        How many there shall be; of too many the smallest go.
    side
        Where new ones stand.
    near
        What one of them stands near to, or in another relation to.
    relation
        How it stands to that: "at" is close to it, "before" and "behind" are told by the street
        that it has its front to, "opposite" is across that street, "in" is within a square or a
        park, "on" on the flat roof of a building, "around" on all sides, "end" at the end of a
        street or pier, "across" beyond `second`.
    second
        The other end of "between", what is crossed of "across".
    metres
        From outline to outline; 0 for near.
    nearest, farthest
        Metres away at least and at most, 0 where not said.
    parts
        Gates of a city wall, level crossings of a railway, stops of each tram line; -1 for usual.
    height
        Metres of a city wall or a power line, 0 for usual.
    size
        Of the ground that new ones take; of things in the open.
    length, width
        Metres of the longer and the shorter side of a building or land, 0 for usual.
    """
    if least > most:
        raise UsageError(f"least = {least} is more than most = {most}.")
    if relation in WITH_SECOND and ANYTHING in (near, second):
        raise UsageError(f'"{relation}" needs both near and second.')
    element = ELEMENTS[kind]
    sized = not (element.is_thing or element.builder)
    element = replace(element, size="" if size == "usual" or not sized else size)
    element = in_metres(element, length=length, width=width)
    city = with_main_street(city) if "main_street" in (near, second) else city
    distance = Distance(metres, nearest, farthest)
    wish = Wish(side, near, relation, second, distance, parts, height, least)
    found = found_of(city, element)
    city = _without(city, element, found[: max(len(found) - most, 0)])
    for _ in range(least - len(found)):
        city = _with_one_more(city, element, wish)
    placed = _goals_of_place(city, element, wish) if least else ()
    placed += _goals_of_sides(element, length, width, least) if least else ()
    if min(len(found), most) >= least > 0 and any(
        not measure(g.predicate, city).met for g in placed
    ):
        # What was there stands elsewhere.
        standing = found_of(city, element)
        city = _without(city, element, standing[:1] if len(standing) == most else standing[:0])
        city = _with_one_more(city, element, wish)
    word = kind.replace("_", " ")
    end = None if most == MOST else most
    said = f"{least} {word}" if least == most else f"at least {least} {word}"
    city = asked(city, said, f"n({element.measure})", least=least, most=end)
    return replace(city, goals=(*city.goals, *placed))


def _goals_of_place(city: City, element: Element, wish: Wish) -> tuple[Goal, ...]:
    """Return what is asked of where an element stands, as goals."""
    word, own = element.name.replace("_", " "), element.measure
    xmin, ymin, xmax, ymax = city.layout.extent
    shorter = min(xmax - xmin, ymax - ymin)
    found = []
    if wish.side in COMPASS:
        found.append(Goal(f"{word} in the {wish.side}", f"side({own}) == {wish.side}"))
    elif wish.side == "middle":
        found.append(Goal(f"{word} in the middle", f"dist({own}, center) <= {MIDDLE * shorter:g}"))
    elif wish.side == "edge":
        found.append(Goal(f"{word} at the edge", f"dist({own}, border) <= {EDGE * shorter:g}"))
    if element.has_size and element.size:
        found.append(
            Goal(f"{element.size} {word}", size_of(element.name, element.size, wish.count))
        )
    if element.builder in PARTS and wish.parts >= 0:
        part = PARTS[element.builder]
        found.append(Goal(f"{wish.parts} {part.replace('_', ' ')}", f"n({part}) == {wish.parts}"))
    if element.builder and wish.height:
        low, high = 0.95 * wish.height, 1.05 * wish.height
        found.append(
            Goal(
                f"{word} {wish.height:g} m high",
                f"stat({own}, height, mean) in [{low:g}, {high:g}]",
            )
        )
    if wish.near == ANYTHING:
        return tuple(found)
    there = wish.near.replace("_", " ")
    text = f"{word} {_WHERE[wish.relation]} {there}"
    if wish.distance.is_told:
        text = f"{word} {wish.distance} from {there}"
    elif wish.relation in WITH_SECOND:
        joined = "and" if wish.relation == "between" else "over"
        text += f" {joined} {wish.second.replace('_', ' ')}"
    predicate = relation_of(
        own, wish.near, wish.relation, wish.second, wish.distance, count=wish.count
    )
    return (*found, Goal(text, predicate))


def _goals_of_sides(
    element: Element, length: float, width: float, least: int
) -> tuple[Goal, ...]:  # fmt: skip
    """Return what is asked of how long and how wide so many of an element are, as goals."""
    if element.is_thing or element.builder:
        return ()
    word = element.name.replace("_", " ")
    return tuple(
        Goal(f"{word} {metres:g} m {said}", measures(element.measure, name, metres, metres, least))
        for name, said, metres in (("length", "long", length), ("width", "wide", width))
        if metres
    )


def _without(city: City, element: Element, gone: NDArray[Any]) -> City:
    layout = city.layout
    if not len(gone):
        return city
    if element.is_thing:
        kept = np.setdiff1d(np.arange(len(layout.points)), gone)
        points = layout.points.iloc[kept].reset_index(drop=True)
        return replace(city, layout=replace(layout, points=points))
    if element.builder:
        for ids in gone.tolist():
            city = without_line(city, element, ids)
        return city
    if element.where == "water":
        return replace(city, layout=_without_areas(layout, gone))
    if element.measure.startswith("building"):
        return replace(city, layout=without_buildings(layout, gone))
    for place in gone.tolist():
        city = given_up(city, element.measure, place)
        table = city.layout.buildings
        own = table["source"].str.startswith(f"made/{element.name}/").to_numpy(bool)
        own = own & shapely.intersects(table.geometry.to_numpy(), place)
        city = replace(city, layout=without_buildings(city.layout, np.flatnonzero(own)))
    return city


def _without_areas(layout: Layout, gone: NDArray[Any]) -> Layout:
    """Take out of a layout what stands in the water, so that water is left."""
    inner = shapely.buffer(gone, -0.1)
    areas = layout.areas
    piers = areas["kind"].to_numpy() == "pier"
    hit = shapely.intersects(areas.geometry.to_numpy(), shapely.union_all(inner))
    return replace(layout, areas=areas[~(piers & hit)].reset_index(drop=True))


def _with_one_more(city: City, element: Element, wish: Wish) -> City:
    """Build one more of an element on the lot that suits best."""
    layout = city.layout
    if element.builder:
        key = _free_key(layout, element.name)
        return with_line(city, element, key, side=wish.side, parts=wish.parts, height=wish.height)
    word = element.name.replace("_", " ")
    if element.by and wish.near == ANYTHING and len(shapes_of(city, element.by)):
        wish = replace(wish, near=element.by)
    places = np.zeros(0, object)
    if wish.near != ANYTHING:
        places = shapes_of(city, wish.near)
        if not len(places):
            said = wish.near.replace("_", " ")
            how = _WHERE[wish.relation]
            raise ActionFailed(f"There is no {said} for a {word} to be {how}.")

    if wish.relation == "on" and wish.near not in _HELD:
        return _with_one_on_a_roof(city, element, wish, places)

    def fits(lots: list[Lot]) -> list[Lot]:
        return related(city, element, lots, wish, places)

    amid = wish.relation in ("in", "on") and wish.near in _HELD and element.is_thing
    amid = amid or (wish.relation == "in" and wish.near in ("plaza", "park"))
    grounds = GROUNDS.get(element.where, ())
    squares = (wish.near,) if amid else grounds
    wanted = bool(grounds) and wish.side == "any"
    lots = fits(lots_on_squares(city, element, squares)) if wanted or amid else []
    afloat = wish.relation == "end" and wish.near in AFLOAT
    if afloat:
        lots = lots_at_ends(city, element, places)
    elif element.where in ("shore", "water"):
        lots = fits(lots_on_shore(layout, element))
    if not lots and element.where == "water":
        raise _no_shore(element)
    if not lots and element.where == "afloat":
        raise ActionFailed(f"No water is free for a {word} to swim in; ask for a pond or a river.")
    if not lots and not amid and not afloat:
        lots = lots_along_streets(layout, element, fits)
    if not lots and wish.near != ANYTHING:
        there = wish.near.replace("_", " ")
        how = f"{wish.distance} from" if wish.distance.is_told else _WHERE[wish.relation]
        raise ActionFailed(f"There is no room for a {word} {how} a {there}.")
    if not lots:
        width, depth = (element.least * size for size in element.lot)
        raise ActionFailed(
            f"No block is free for a {word}, which takes {width:.0f} m "
            f"by {depth:.0f} m; ask for fewer things, or for a larger site."
        )
    if wish.relation == "around":
        lots = apart(city, element, lots, largest(places), 2 * np.pi / wish.count)
    side = wish.side if wish.side != "any" else element.where
    lot = cheapest(lots, layout, element, side)
    if afloat:
        layout = with_longer_pier(layout, lot.placed(lot_of(element)))
        element = replace(element, land={})
    elif element.where not in ("water", "afloat"):
        layout = cleared(layout, lot.placed(lot_of(element)))
    return replace(city, layout=drawn(city, layout, element, lot))


def _no_shore(element: Element) -> ActionFailed:
    width, depth = (element.least * size for size in element.lot)
    word = element.name.replace("_", " ")
    return ActionFailed(
        f"No shore has water free for a {word}, which takes {width:.0f} m by {depth:.0f} m; "
        "ask for fewer, or for a sea or a larger lake."
    )


def _with_one_on_a_roof(city: City, element: Element, wish: Wish, places: NDArray[Any]) -> City:
    """Put a thing on the largest flat roof of some buildings."""
    layout = city.layout
    word, there = (name.replace("_", " ") for name in (element.name, wish.near))
    if not element.is_thing:
        raise ActionFailed(f"A {word} does not stand on a roof.")
    parts = layout.parts
    flat = parts.geometry.to_numpy()[(parts["roof_shape"] == "flat").to_numpy()]
    own = np.unique(shapely.STRtree(flat).query(places, predicate="intersects")[1])
    circles = [shapely.maximum_inscribed_circle(flat[row], 0.5) for row in own.tolist()]
    taken = layout.points.geometry.to_numpy()[is_made(layout.points)]
    free = [
        (round(circle.length, 1), -k) for k, circle in enumerate(circles)
        if circle.length >= ROOF and not shapely.dwithin(taken, circle, 2 * ROOF).any()
    ]  # fmt: skip
    if not free:
        raise ActionFailed(f"No {there} has a flat roof with room for a {word}.")
    at = np.round(shapely.get_coordinates(circles[-max(free)[1]])[0], 2)
    lot = Lot(at - np.array([0.0, element.points[0].at[1]]), np.array([1.0, 0.0]))
    return replace(city, layout=drawn(city, layout, replace(element, land={}), lot))


def drawn(city: City, layout: Layout, element: Element, lot: Lot) -> Layout:
    """Add an element to a layout that has room for it."""
    key = _free_key(layout, element.name)
    outlines, parts = _volumes(element, lot, key)
    grounds = [(ground_of(item), item.tags) for item in element.areas]
    if element.land:
        taken = shapely.union_all([shape for shape, _ in grounds])
        grounds.append((shapely.difference(lot_of(element), taken), element.land))
    shore = element.where == "shore"  # there things face the water
    spots = [
        (shapely.Point(item.at), {**item.tags, **bearing_of(lot, 0.0 if shore else item.faces)})
        for item in element.points
    ]
    shells, box = make_shells(outlines, parts, layout.extent, Report())
    features = Features(
        box,
        shells,
        areas=_placed(grounds, lot, (*key, "land")),
        area_kinds=np.array([land_kind(tags) for _, tags in grounds], object),
        points=_placed(spots, lot, (*key, "thing")),
    )
    return with_features(city, layout, features)


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
    roofs = [(plan_of(part), {"building": part.kind, **part.tags()}) for part in element.beside]
    owners = [Owner((*key, "roof", k), own) for k, (_, own) in enumerate(roofs)]
    shapes = [whole, *(lot.placed(shape) for shape, _ in roofs)]
    outlines = tag(shapes, [Owner(key, tags), *owners])
    return outlines, _placed(volumes, lot, (*key, "part")) if len(volumes) > 1 else nothing()


def _free_key(layout: Layout, name: str) -> tuple[object, ...]:
    """Return the first key of an element of a name that nothing in a layout has."""
    tables = (layout.buildings, layout.areas, layout.points, layout.lines, layout.roads)
    sources = [source for table in tables for source in table["source"][is_made(table)]]
    own = f"made/{name}/"
    taken = {source.split("/")[2] for source in sources if source.startswith(own)}
    return "made", name, next(number for number in count() if str(number) not in taken)
