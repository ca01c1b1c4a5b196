"""Standing: where elements stand, and the lots on which one stands to others as it is asked to."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.checks.predicates.ends import ends_of, reach_of
from cityx.checks.predicates.measuring import things_of
from cityx.checks.predicates.relations import lies, lies_across, lies_between
from cityx.checks.predicates.thing_predicates import CannotTell
from cityx.checks.predicates.whereabouts import is_on_side
from cityx.city import City, Layout
from cityx.city.layout import of_kinds
from cityx.sources.features.kinds import point_kind
from cityx.town.elements import ELEMENTS, NEAR, SIDES, UNTOLD, Distance, Element, chosen_by
from cityx.town.lots import OPEN_WATER, Lot, body_of, lot_of, plans_of

MIDDLE, EDGE = 0.2, 0.25  # of the site's shorter side, from its middle and from its border
OVERLAP = 2.0  # metres by which what stands at the end of a pier overlaps it
CLOSER = 6.0  # metres by which what stands at a street may be farther than the closest lot
TURN = 0.1  # radians by which places round another one may differ
ANYTHING = "anything"


@dataclass(frozen=True)
class Wish:
    """Where an element is to stand, and how large it is; see `layout/elements-v1`."""

    side: str = "any"
    near: str = ANYTHING
    relation: str = "near"
    second: str = ANYTHING
    distance: Distance = UNTOLD
    parts: int = -1
    height: float = 0.0
    count: int = 1


def found_of(city: City, element: Element) -> NDArray[Any]:
    """Return what there is of an element, the smallest first: rows of buildings or points, land."""
    layout = city.layout
    if element.is_thing:
        own = point_kind(element.points[0].tags)
        return np.flatnonzero(layout.points["kind"].to_numpy() == own)
    chosen = things_of(element.measure, city)
    if element.builder:  # the ids of the rows of each
        unit = chosen.layer.units(chosen.rows)
        rows = [chosen.ids[unit == number] for number in np.unique(unit).tolist()]
        held = np.empty(len(rows), object)
        held[:] = rows
        return held
    order = np.argsort(np.round(shapely.area(chosen.shapes), 2), kind="stable")
    if element.measure.startswith("building"):
        ids = layout.buildings["id"].to_numpy(np.uint64)
        return np.asarray(np.searchsorted(ids, chosen.ids)[order])
    return np.asarray(chosen.shapes[order])


def shapes_of(city: City, word: str) -> NDArray[Any]:
    """Return the shapes of a place or an element, a word of `WHERE`."""
    element = ELEMENTS.get(word)
    if element is not None and element.is_thing:
        return np.asarray(city.layout.points.geometry.to_numpy()[found_of(city, element)])
    try:
        return things_of(chosen_by(word), city).shapes
    except CannotTell:
        return np.zeros(0, object)


def related(
    city: City, element: Element, lots: list[Lot], wish: Wish, places: NDArray[Any]
) -> list[Lot]:
    """Return the lots on which an element stands as it is to, to some places."""
    if not lots:
        return lots
    if wish.side not in ("middle", "edge") and not len(places):
        return lots
    bodies = plans_of(lots, body_of(element))
    good = np.ones(len(lots), bool)
    if wish.side in ("middle", "edge"):
        xmin, ymin, xmax, ymax = city.layout.extent
        site, shorter = shapely.box(*city.layout.extent), min(xmax - xmin, ymax - ymin)
        whole, share = (site.centroid, MIDDLE) if wish.side == "middle" else (site.exterior, EDGE)
        good &= shapely.distance(bodies, whole) <= share * shorter
    if len(places):
        good &= _stands(city, bodies, wish, places)
    return [lot for lot, kept in zip(lots, good.tolist(), strict=True) if kept]


def _stands(city: City, bodies: NDArray[Any], wish: Wish, places: NDArray[Any]) -> NDArray[Any]:
    """(n,) whether bodies stand as they are to, to some places."""
    relation = wish.relation
    if relation in ("before", "behind", "opposite") and not wish.distance.is_told:
        streets = things_of("road", city).shapes
        found = [lies(relation, bodies, place, streets) for place in places.tolist()]
        return np.asarray(np.any(found, axis=0))
    if relation == "between":
        others = shapes_of(city, wish.second).tolist()
        found = [lies_between(bodies, one, other) for one in places.tolist() for other in others]
        return np.any(found, axis=0) if found else np.zeros(len(bodies), bool)
    if relation == "across":
        lines = shapes_of(city, wish.second)
        over = [lies_across(bodies, place, lines) for place in places.tolist()]
        return np.asarray(np.mean(over, axis=0) > 1 / 2)  # of most
    if relation == "in":
        held = shapely.STRtree(places).query(bodies, predicate="covered_by")[0]
        return np.isin(np.arange(len(bodies)), held)
    if relation == "around":
        places = np.array([largest(places)], object)
    low, high = wish.distance.bounds(relation, wish.near)
    if relation == "around":
        high = NEAR / 2
    if relation == "end":
        ends = shapely.multipoints(ends_of(places, city.layout))
        return np.asarray(shapely.distance(bodies, ends) <= reach_of(places))
    away = shapely.distance(bodies, shapely.union_all(places))
    if relation in SIDES:
        return np.asarray((away <= high) & is_on_side(bodies, places, relation))
    if relation == "at" and not wish.distance.is_told:
        high = min(high, float(away.min()) + CLOSER)
    return np.asarray((away >= low) & (away <= high))


def largest(places: NDArray[Any]) -> Any:
    """Return the place that takes most ground."""
    return places[int(np.argmax(np.round(shapely.area(shapely.convex_hull(places)), 2)))]


def apart(city: City, element: Element, lots: Sequence[Lot], place: Any, angle: float) -> list[Lot]:
    """Return the lots that lie, as seen from a place, an angle from what stands there already."""
    middle = shapely.get_coordinates(shapely.centroid(place))[0]

    def turn(shapes: NDArray[Any]) -> NDArray[Any]:
        way = shapely.get_coordinates(shapely.centroid(shapes)) - middle
        return np.asarray(np.exp(1j * np.arctan2(way[:, 1], way[:, 0])))

    standing = shapes_of(city, element.name)
    near = standing[shapely.distance(standing, place) <= NEAR]
    if not len(near):
        return list(lots)
    own = turn(plans_of(lots, body_of(element)))
    gap = np.abs(np.angle(own[:, None] / turn(near)[None])).min(axis=1)
    wide = gap[gap >= 0.9 * angle]
    wanted = wide.min() if len(wide) else gap.max()
    return [lots[k] for k in np.flatnonzero(np.abs(gap - wanted) <= TURN).tolist()]


def lots_at_ends(city: City, element: Element, places: NDArray[Any]) -> list[Lot]:
    """Return the free lots that go on from the ends of piers into the water.

    They take on the whole width of what stands there, and overlap the pier.
    """
    layout = city.layout
    areas = layout.areas
    table = areas.geometry.to_numpy()
    water = shapely.union_all(table[areas["kind"].isin(OPEN_WATER).to_numpy()])
    room = shapely.intersection(water, shapely.box(*layout.extent))
    piers = shapely.STRtree(table[of_kinds(areas, ("pier",))])
    lots = []
    for place in places.tolist():
        middle = shapely.get_coordinates(place.centroid)[0]
        for end in ends_of(np.array([place], object), layout):
            if not shapely.contains_xy(room, *end):
                continue
            away = (end - middle) / np.hypot(*(end - middle))
            along = np.array([away[1], -away[0]])
            for scale in element.scales:
                lot = Lot(np.round(end - OVERLAP * away, 2), along, scale)
                plan = lot.placed(lot_of(element))
                if shapely.contains(room, plan) and len(piers.query(plan, "intersects")) == 1:
                    lots.append(lot)
                    break
    return lots


def with_longer_pier(layout: Layout, plan: Any) -> Layout:
    """Return a layout whose pier goes on over the plan of a lot at its end."""
    areas = layout.areas
    own = of_kinds(areas, ("pier",)) & shapely.intersects(areas.geometry.to_numpy(), plan)
    longer = areas.geometry.to_numpy().copy()
    longer[own] = shapely.union(longer[own], plan)
    return replace(layout, areas=areas.set_geometry(longer))
