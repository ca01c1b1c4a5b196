"""Lying: which things, and which ground, a place is that other objects tell."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import shapely
from shapely.ops import substring

from cityx.checks.predicates.facts import Facts
from cityx.checks.predicates.relations import CLOSE, lies, lies_between
from cityx.checks.predicates.thing_predicates import Selection
from cityx.checks.predicates.vocabulary import KINDS
from cityx.geometry.arrays import BoolArray, IntArray
from cityx.geometry.turns import SIDES
from cityx.language import Reference, Selector

NEAR = 50.0  # metres from the edge of what things are near to: across a street and its yards
STREET = 15.0  # metres from what a street leads by to its middle
BY = 14.0  # metres from something within which room is looked for beside it
FACING = 70.0  # metres from water or a park to the houses that face it
LINED, ROADSIDE = 30.0, 8.0  # metres from a street to its houses, and to trees and lamps along it
FRONT = 25.0  # metres before a building in which something stands in front of it
CORNER = 25.0  # metres from where streets meet that are their corner
PART = 1 / 3  # of the length of a place that is its end
RIM = 0.15  # of the shorter side of the site that is its edge
LEAST_PART = 15.0  # metres of a street between two places
WAY = 12.0  # metres on both sides of the line between two places
HALF_VIEW = np.radians(45.0)  # of the angle in which something lies before a place, or behind it
SEGMENTS = 8  # of the arc of that angle

ENTRANCE = "entrance"
# Relations that say which part of a place.
PARTS_OF_PLACES = ("edge", "end", "corner", "middle", ENTRANCE)
MIDDLE = 1 / 4  # of the shorter side of a place, around its middle
LEAST_MIDDLE = 3.0  # metres

Choose = Callable[[Selector], Selection]


def holds(reference: Reference, chosen: Selection, facts: Facts, choose: Choose) -> BoolArray:
    """(r,) whether things lie as a reference says.

    Parameters
    ----------
    reference
        The relation and the objects.
    chosen
        The things.
    facts
        Of their city.
    choose
        Finds the objects of a selector; raises where there are none.
    """
    shapes, key = chosen.shapes, reference.key
    middles = shapely.centroid(shapes)
    if key == "corner" and not reference.spots and not reference.side:
        return _at_corners(chosen, facts)
    if key in PARTS_OF_PLACES:
        ground = ground_of(reference, facts, choose)
        houses = KINDS[chosen.layer.kind] in ("building", "road")
        return np.asarray(shapely.intersects(shapes if houses else middles, ground), bool)
    places = [choose(spot) for spot in reference.spots]
    if KINDS[chosen.layer.kind] == "road" and key == "between":
        parts = parts_between(reference, shapes, choose)
        return np.array([part is not None for part in parts], bool)
    if KINDS[chosen.layer.kind] == "road" and key in ("before", "behind", "opposite"):
        return np.asarray(shapely.intersects(shapes, ground_of(reference, facts, choose)), bool)
    if key == "between":
        first, second = (shapely.union_all(place.grounds) for place in places)
        return lies_between(shapes, first, second)
    kinds = KINDS[chosen.layer.kind], KINDS[places[0].layer.kind]
    if key in ("opposite", "along") and kinds == ("building", "land"):
        region = shapely.union_all(shapely.make_valid(places[0].grounds))
        return front_row(chosen, region, FACING, facts)
    if key in ("before", "behind", "opposite"):
        streets = facts.layer("road").shapes
        found = np.zeros(len(shapes), bool)
        for place in places[0].shapes.tolist():
            found |= lies(key, shapes, place, streets)
        return found & ~np.isin(chosen.ids, places[0].ids)
    region = shapely.union_all(shapely.make_valid(places[0].grounds))
    if reference.side:
        houses = kinds[0] == "building" and kinds[1] == "land"
        if kinds[0] not in ("building", "road") and _is_entered(places[0]):
            return np.asarray(shapely.intersects(middles, ground_of(reference, facts, choose)))
        flank = flank_of(region, reference.side, _across(facts) if houses else _reach(*kinds))
        on_it = shapely.intersects(middles, flank) & ~np.isin(chosen.ids, places[0].ids)
        return np.asarray(on_it & ~shapely.intersects(middles, region))
    if key == "along" and kinds == ("road", "land"):
        return runs_along(chosen, region)
    own = np.isin(chosen.ids, places[0].ids)
    if key in ("in", "on", "to") and KINDS[places[0].layer.kind] == "land":
        shapely.prepare(region)
        return np.asarray(shapely.intersects(middles, region), bool)
    away = shapely.distance(shapes, region)
    if key == "off":
        return np.asarray((np.abs(away - reference.amount) <= missed_by(reference.amount)) & ~own)
    if key == "beyond":
        return np.asarray((away >= reference.amount) & ~own)
    reach = reference.amount or reach_of(chosen)
    if key == "along" or (key in ("on", "in") and KINDS[places[0].layer.kind] == "road"):
        reach = LINED if KINDS[chosen.layer.kind] == "building" else ROADSIDE
    return np.asarray((away <= reach) & ~own)


def _across(facts: Facts) -> float:
    """Return the metres across the site, within which houses are on a bank."""
    xmin, ymin, xmax, ymax = facts.city.layout.extent
    return float(np.hypot(xmax - xmin, ymax - ymin))


def _reach(kind: str, place: str) -> float:
    """Return the metres from the side of a place within which things of a kind are on it."""
    if place == "road":
        return LINED if kind == "building" else ROADSIDE
    return NEAR


def _is_entered(place: Selection) -> bool:
    """Return whether things on a side of a place lie in it, as in a park, and not beside it."""
    return KINDS[place.layer.kind] == "land" and place.layer.kind not in _WET


FLAT = 0.35  # of the direction out of a place that points to a side, for that to be its side


def flank_of(region: Any, side: str, reach: float) -> Any:
    """Return the ground beside a place that lies to one side of it, to so many metres from it.

    Each stretch of its rim that looks to the side counts, so both banks of a river that winds are
    told apart.
    """
    towards = np.array(SIDES[side.replace("_", "")], float)
    towards /= np.hypot(*towards)
    strips = []
    for part in shapely.get_parts(region).tolist():
        ring = shapely.get_exterior_ring(shapely.orient_polygons(part)) if part.area else part
        at = shapely.get_coordinates(ring)
        step = np.diff(at, axis=0)
        length = np.hypot(*step.T)
        out = np.column_stack([step[:, 1], -step[:, 0]]) / np.maximum(length, 1e-9)[:, None]
        if not part.area:  # a line has two sides
            out *= np.where(out @ towards < 0, -1.0, 1.0)[:, None]
        good = (out @ towards >= FLAT) & (length > 0)
        first, last = at[:-1][good], at[1:][good]
        far = reach * out[good]
        quads = np.stack([first, last, last + far, first + far], axis=1)
        strips += [*shapely.make_valid(shapely.polygons(quads))]
    whole = shapely.union_all(np.array(strips, object)) if strips else shapely.Polygon()
    return shapely.difference(shapely.buffer(whole, GAP, join_style="mitre"), region)


_WET = ("river", "canal", "stream", "lake", "pond", "sea", "water", "pool")
GAP = 0.5  # metres by which strips beside the stretches of a rim are joined


def _at_corners(chosen: Selection, facts: Facts) -> BoolArray:
    """(r,) what lies where streets meet, with no house between."""
    met = facts.layer("junction").shapes
    near = shapely.STRtree(met).query(chosen.shapes, predicate="dwithin", distance=CORNER)
    found = np.zeros(len(chosen.shapes), bool)
    if near.size:
        sight = shapely.shortest_line(chosen.shapes[near[0]], met[near[1]])
        found[near[0][_in_sight(chosen, near[0], sight, facts)]] = True
    return found


def front_row(chosen: Selection, region: Any, reach: float, facts: Facts) -> BoolArray:
    """(r,) which buildings are so near to a place, metres, with no other building between."""
    near = np.flatnonzero(shapely.distance(chosen.shapes, region) <= reach)
    sight = shapely.shortest_line(chosen.shapes[near], region)
    found = np.zeros(len(chosen.shapes), bool)
    found[near[_in_sight(chosen, near, sight, facts)]] = True
    return found


def runs_along(chosen: Selection, region: Any) -> BoolArray:
    """(r,) which streets run beside water or land for most of their way; none leads over it."""
    lines = chosen.shapes
    length = np.maximum(shapely.length(lines), 1e-9)
    beside = shapely.length(shapely.intersection(lines, shapely.buffer(region, QUAY)))
    over = shapely.length(shapely.intersection(lines, region))
    first, last = (shapely.distance(shapely.get_point(lines, end), region) for end in (0, -1))
    turned = np.abs(first - last) > STEEP * length  # it leads up to it
    return np.asarray((beside - over >= MOSTLY * length) & (over <= OVER * length) & ~turned, bool)


QUAY = 30.0  # metres from water or land to the middle of a street that runs along it
STEEP = 0.5  # metres per metre by which a street that leads up to water comes nearer to it
MOSTLY, OVER = 0.5, 0.05  # of the length of a street that runs beside, and that may lie over it


def _in_sight(chosen: Selection, rows: IntArray, sight: Any, facts: Facts) -> BoolArray:
    """(k,) whether no other building stands on the line from each thing to what it faces.

    Parameters
    ----------
    rows
        (k,) of the chosen things.
    sight
        (k,) lines.
    """
    others = facts.layer("building")
    look, house = shapely.STRtree(others.shapes).query(sight, predicate="intersects")
    own = others.ids[house] == chosen.ids[rows[look]]
    seen = np.ones(len(sight), bool)
    seen[look[~own]] = False
    return seen


def _along_line(key: str, lines: list[Any], ground: Any) -> Any:
    """Return the ground of streets at their ends, or about the middle of their length."""
    merged = shapely.line_merge(shapely.union_all(lines))
    parts = [part for part in shapely.get_parts(merged).tolist() if part.length > 0]
    if key == "middle":
        longest = max(parts, key=lambda part: part.length)
        spots = [longest.interpolate(0.5, normalized=True)]
    else:
        ends = [shapely.Point(part.coords[at]) for part in parts for at in (0, -1)]
        spots = [end for at, end in enumerate(ends)
                 if all(end.distance(other) > CLOSE_ENDS
                        for place, other in enumerate(ends) if place != at)]  # fmt: skip
    reach = END if key == "end" else BY
    return shapely.intersection(shapely.buffer(shapely.union_all(spots), reach),
                                shapely.buffer(ground, BY))  # fmt: skip


BEYOND = 80.0  # metres farther than "at least 100 m away" in which something still is put
# Of a distance that is told by which it may be missed, and metres that this is at least, at most.
OFF, LEAST_OFF, MOST_OFF = 0.2, 2.0, 20.0


def missed_by(far: float) -> float:
    """Return the metres by which a distance that is told, metres, may be missed."""
    return min(max(OFF * far, LEAST_OFF), MOST_OFF)


CLOSE_ENDS = 1.0  # metres between ends of pieces of a street that go on into each other
END = 14.0  # metres of a street that are its end


def parts_between(reference: Reference, lines: Any, choose: Choose) -> list[Any]:
    """Return the part of each street that leads from one place to another, None where none does."""
    first, second = (shapely.union_all(choose(spot).grounds) for spot in reference.spots)
    found: list[Any] = []
    for line in lines.tolist():
        ends = [shapely.line_locate_point(line, place.centroid) for place in (first, second)]
        near = max(line.distance(first), line.distance(second)) <= CLOSE
        good = near and abs(ends[1] - ends[0]) >= LEAST_PART
        found.append(substring(line, min(ends), max(ends)) if good else None)
    return found


def reach_of(chosen: Selection) -> float:
    """Return the metres within which things of a kind are near to something."""
    return STREET if KINDS[chosen.layer.kind] == "road" else NEAR


def ground_of(reference: Reference, facts: Facts, choose: Choose) -> Any:
    """Return the ground of a place, a polygon or several; what stands on it is not left out."""
    key = reference.key
    site = shapely.box(*facts.city.layout.extent)
    places = [choose(spot) for spot in reference.spots]
    grounds = [shapely.union_all(shapely.make_valid(place.grounds)) for place in places]
    if key == ENTRANCE:
        gates = entrances_of(grounds[0], facts)
        if len(grounds) > 1 and len(gates):  # the one nearest to something else
            gates = gates[[int(np.argmin(np.round(shapely.distance(gates, grounds[1]), 3)))]]
        return shapely.intersection(shapely.union_all(shapely.buffer(gates, GATE)), site)
    if key in PARTS_OF_PLACES:
        lines = [line for place in places if KINDS[place.layer.kind] == "road"
                 for line in place.shapes]  # fmt: skip
        if lines and not reference.side and key in ("end", "middle"):
            return shapely.intersection(_along_line(key, lines, grounds[0]), site)
        return shapely.intersection(_part(reference, grounds, site), site)
    if reference.side:
        inner = _is_entered(places[0])
        ground = _part(reference, grounds, site) if inner else flank_of(
            grounds[0], reference.side, BY
        )  # fmt: skip
        return shapely.intersection(ground, site)
    if key == "between":
        line = shapely.shortest_line(*grounds)
        way = shapely.buffer(line, WAY) if line.length else shapely.union_all(grounds)
        return shapely.intersection(way, site)
    if key in ("before", "behind", "opposite"):
        streets = facts.layer("road")
        found = [_view(key, place, streets) for place in places[0].shapes.tolist()]
        return shapely.intersection(shapely.union_all(found), site)
    if key in ("in", "on", "to") and KINDS[places[0].layer.kind] == "land":
        return grounds[0]
    if key == "off":
        far = reference.amount
        missed = missed_by(far)
        ring = shapely.difference(shapely.buffer(grounds[0], far + missed),
                                  shapely.buffer(grounds[0], max(far - missed, 1.0)))  # fmt: skip
        return shapely.intersection(ring, site)
    if key == "beyond":
        far = shapely.difference(site, shapely.buffer(grounds[0], reference.amount))
        near = shapely.intersection(far, shapely.buffer(grounds[0], reference.amount + BEYOND))
        return far if near.is_empty else near
    if key == "around":
        ring = shapely.buffer(grounds[0], BY)
        return shapely.intersection(shapely.difference(ring, grounds[0]), site)
    return shapely.intersection(shapely.buffer(grounds[0], reference.amount or BY), site)


def entrances_of(ground: Any, facts: Facts) -> Any:
    """Return (k,) points where one goes into a place: where ways lead over its rim.

    Of a place that no way leads into these are the spots of its rim that junctions lie at.
    """
    rim = shapely.boundary(ground)
    ways = [line for kind in ("road", "path") for line in facts.layer(kind).shapes.tolist()]
    met = shapely.get_parts(shapely.intersection(shapely.union_all(ways), rim)) if ways else []
    found = [shapely.centroid(one) for one in met if not one.is_empty]
    if not found:
        at = facts.layer("junction").shapes
        near = at[shapely.distance(at, rim) <= AT_JUNCTION]
        found = [shapely.Point(shapely.shortest_line(rim, one).coords[0]) for one in near.tolist()]
    apart: list[Any] = []
    for point in sorted(found, key=lambda one: (round(one.x, 2), round(one.y, 2))):
        if all(point.distance(other) > GATE for other in apart):
            apart.append(point)
    return np.array(apart, object)


GATE = 10.0  # metres around an entrance
AT_JUNCTION = 30.0  # metres from where streets meet to the rim of a place that is entered there


def _part(reference: Reference, grounds: list[Any], site: Any) -> Any:
    """Return an end, a corner or the edge of places, or of the site."""
    if reference.key == "corner" and len(grounds) == 2:
        met = [shapely.buffer(ground, CORNER / 2) for ground in grounds]
        both = shapely.intersection(*met)
        return shapely.buffer(both, CORNER / 2)
    whole = grounds[0] if grounds else site
    if reference.side:
        return shapely.intersection(_outermost(whole, reference.side), whole)
    xmin, ymin, xmax, ymax = whole.bounds
    rim = RIM * min(xmax - xmin, ymax - ymin)
    if reference.key == "middle":
        inner = shapely.point_on_surface(whole)
        at = whole.centroid if whole.intersects(whole.centroid) else inner
        reach = max(MIDDLE * min(xmax - xmin, ymax - ymin), LEAST_MIDDLE)
        return shapely.intersection(shapely.buffer(at, reach), whole)
    if reference.key == "corner":
        corners = shapely.points([(x, y) for x in (xmin, xmax) for y in (ymin, ymax)])
        return shapely.intersection(shapely.union_all(shapely.buffer(corners, 2 * rim)), whole)
    inner = shapely.buffer(whole, -rim)
    return whole if inner.is_empty else shapely.difference(whole, inner)


def _outermost(shape: Any, side: str) -> Any:
    """Return the box of the outermost part of a shape on a side, on two for "northwest"."""
    xmin, ymin, xmax, ymax = shape.bounds
    x, y = SIDES[side.replace("_", "")]
    deep, wide = PART * (ymax - ymin), PART * (xmax - xmin)
    west, east = (xmax - wide if x > 0 else xmin), (xmin + wide if x < 0 else xmax)
    south, north = (ymax - deep if y > 0 else ymin), (ymin + deep if y < 0 else ymax)
    return shapely.box(west, south, east, north)


def _view(relation: str, place: Any, streets: Any) -> Any:
    """Return the ground before a place, behind it, or across the street that it looks at."""
    lines = streets.shapes
    if not len(lines):
        return shapely.Polygon()
    middle = shapely.centroid(place)
    row = int(np.argmin(np.round(shapely.distance(lines, place), 3)))
    ahead = np.diff(shapely.get_coordinates(shapely.shortest_line(middle, lines[row])), axis=0)[0]
    if relation == "behind":
        ahead = -ahead
    turn = np.arctan2(ahead[1], ahead[0])
    reach = float(shapely.hausdorff_distance(middle, place)) + CLOSE
    angles = turn + np.linspace(-HALF_VIEW, HALF_VIEW, SEGMENTS)
    at = shapely.get_coordinates(middle)[0]
    arc = at + reach * np.column_stack([np.cos(angles), np.sin(angles)])
    wedge = shapely.Polygon(np.vstack([at, arc]))
    if relation == "behind":
        return shapely.intersection(wedge, shapely.buffer(place, FRONT))
    if relation == "before":
        return shapely.intersection(wedge, shapely.buffer(place, FRONT))
    parts = shapely.get_parts(shapely.difference(wedge, shapely.buffer(lines[row], 0.5)))
    across = [part for part in parts if not part.intersects(shapely.buffer(middle, 0.1))]
    near = shapely.buffer(shapely.union_all([place, lines[row]]), FRONT)
    return shapely.intersection(shapely.union_all(across), near)
