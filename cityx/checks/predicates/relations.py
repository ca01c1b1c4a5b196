"""How things lie to each other and to the site: distances, crossings, sides."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.checks.predicates import words
from cityx.checks.predicates.facts import SURFACES, Facts, Options, said
from cityx.checks.predicates.finding import Measured
from cityx.checks.predicates.syntax import Name
from cityx.checks.predicates.thing_predicates import Absent
from cityx.checks.predicates.vocabulary import Group, kind_named
from cityx.checks.predicates.whereabouts import nearness
from cityx.geometry.arrays import BoolArray, FloatArray

ASIDE = 0.2  # of the way to a side, beyond which something lies on it
IN_CORNER = 1 / 3  # of the way to two sides at once, from which something lies in a corner
LEAST_TREND = 5  # things of which a trend can be told
OPEN_SIDE = np.pi  # radians; a wider gap between two of them as seen from there is an open side


def _shapes(facts: Facts, group: Group) -> NDArray[Any]:
    """Return the shapes of things, of a surface or of the middle or border of the site."""
    head = group.head
    kind = kind_named(head.word) if isinstance(head, Name) else ""
    if kind in ("center", "border"):
        return np.array([facts.region(kind)], object)
    if kind in SURFACES:
        return facts.surface(kind)
    chosen = facts.select(group)
    if not len(chosen.rows):
        raise Absent(f"there is no {group}")
    return chosen.shapes


def dist(facts: Facts, groups: tuple[Group, ...], _: Options) -> Measured:
    """Measure the smallest distance between two kinds of things."""
    first, second = (_shapes(facts, group) for group in groups)
    if len(first) > len(second):
        first, second = second, first
    tree = shapely.STRtree(second)
    _, away = tree.query_nearest(first, return_distance=True, all_matches=False)
    value = float(away.min())
    return Measured(value, f"the nearest {groups[0]} and {groups[1]} are {value:.1f} m apart")


def overlap(facts: Facts, groups: tuple[Group, ...], _: Options) -> Measured:
    """Measure the ground that two kinds of things share."""
    first, second = (facts.select(group).shapes for group in groups)
    pairs = shapely.STRtree(second).query(first, predicate="intersects")
    shared = shapely.area(shapely.intersection(first[pairs[0]], second[pairs[1]]))
    value = round(float(shared.sum()), 2)
    return Measured(value, f"{groups[0]} and {groups[1]} share {value:,.1f} m2")


def inside(facts: Facts, groups: tuple[Group, ...], _: Options) -> Measured:
    """Return whether some of the first lie within one of the second."""
    first, second = facts.select(groups[0]), facts.select(groups[1])
    # A lake cut out of a park lies in it as well: holes count as the park.
    whole = (
        shapely.polygons(shapely.get_exterior_ring(second.shapes))
        if len(second.rows)
        and (shapely.get_type_id(second.shapes) == shapely.GeometryType.POLYGON).all()
        else second.shapes
    )
    held = shapely.STRtree(whole).query(first.shapes, predicate="covered_by")[0]
    number = len(np.unique(held))
    return Measured(number > 0, f"{number} of {said(first)} lie in one of {said(second)}")


def crosses(facts: Facts, groups: tuple[Group, ...], _: Options) -> Measured:
    """Return whether each of the first crosses one of the second from side to side."""
    first, second = facts.select(groups[0]), facts.select(groups[1])
    over = _leads_over(first.shapes, second.shapes)
    met = bool(len(over)) and bool(over.all())
    return Measured(met, f"{int(over.sum())} of {said(first)} cross {said(second)}")


def _leads_over(first: NDArray[Any], second: NDArray[Any]) -> NDArray[np.bool_]:
    """(n,) whether a shape is parted by another: it goes on beyond on two sides."""
    over = np.zeros(len(first), bool)
    a, b = shapely.STRtree(second).query(first, predicate="intersects")
    left = shapely.difference(first[a], second[b])
    parts = np.array([int((shapely.area(shapely.get_parts(each)) > 0).sum()) if each.area else
                      shapely.get_num_geometries(each) for each in left.tolist()], int)  # fmt: skip
    over[a[parts >= 2]] = True
    return over


DIRECTIONS = 72  # round a place, in which what encloses it is looked for
RIM = 22.0  # metres from the farthest corner of a place to what encloses it and its yard


def around(facts: Facts, groups: tuple[Group, ...], _: Options) -> Measured:
    """Return whether things stand round one place of a kind, near it and on all sides."""
    chosen, places = facts.select(groups[0]), facts.select(groups[1])
    if not len(chosen.rows):
        return Measured(False, f"there is no {groups[0]}")
    if not len(places.rows):
        return Measured(False, f"there is no {groups[1]}")
    found = [_stand_around(chosen.shapes, place) for place in places.shapes.tolist()]
    met, away, gap, place = min(found, key=lambda item: (not item[0], round(item[1], 3)))
    return Measured(
        met,
        f"{said(chosen)} stand within {away:.0f} m of a {groups[1]} of {place.area:.0f} m2, the "
        f"widest gap between them is {np.degrees(gap):.0f} degrees",
    )


def enclosed(facts: Facts, groups: tuple[Group, ...], _: Options) -> Measured:
    """Return in which share of all directions things stand at the rim of places, the best."""
    chosen, places = facts.select(groups[0]), facts.select(groups[1])
    shares = [_share_enclosed(chosen.shapes, place) for place in places.shapes.tolist()]
    best = max(shares, default=0.0)
    return Measured(best, f"{groups[0]} stands in {best:.0%} of the directions round a {groups[1]}")


def _share_enclosed(shapes: NDArray[Any], place: Any) -> float:
    """Return in which share of the directions from the middle of a place something is met."""
    middle = shapely.get_coordinates(place.centroid)[0]
    reach = float(shapely.hausdorff_distance(place.centroid, place)) + RIM
    way = np.linspace(0.0, 2 * np.pi, DIRECTIONS, endpoint=False)
    ends = middle + reach * np.column_stack([np.cos(way), np.sin(way)])
    rays = shapely.linestrings(np.stack([np.broadcast_to(middle, ends.shape), ends], axis=1))
    met = shapely.STRtree(shapes).query(rays, predicate="intersects")[0]
    return len(np.unique(met)) / DIRECTIONS


def _stand_around(shapes: NDArray[Any], place: Any) -> tuple[bool, float, float, Any]:
    middle = shapely.centroid(shapes)
    away = float(shapely.distance(middle, place).max())
    x, y = shapely.get_coordinates(place.centroid)[0]
    at = shapely.get_coordinates(middle)
    turn = np.sort(np.arctan2(at[:, 1] - y, at[:, 0] - x))
    gap = float(np.diff(np.append(turn, turn[0] + 2 * np.pi)).max())
    return away <= words.NEAR and (gap <= OPEN_SIDE or len(turn) < 3), away, gap, place


# Where something lies to a place that has a front: the side of the nearest street.
IN_VIEW = np.cos(np.radians(50.0))  # of the widest angle to the front, or the back, of a place
CLOSE = 90.0  # metres from a place to what is in front of it, behind it or opposite
DETOUR = 1.15  # times as far as straight on, over what lies between two places, at most


def lies(relation: str, shapes: NDArray[Any], place: Any, streets: NDArray[Any]) -> BoolArray:
    """(n,) whether shapes lie "before", "behind" or "opposite" a place.

    Opposite is before it, across a street.

    Parameters
    ----------
    streets
        (s,) lines; the nearest is where the place has its front.
    """
    close = shapely.distance(shapes, place) <= CLOSE
    if not len(streets):
        return np.zeros(len(shapes), bool)
    middle = shapely.centroid(place)
    nearest = streets[int(np.argmin(np.round(shapely.distance(streets, place), 3)))]
    x, y = np.diff(shapely.get_coordinates(shapely.shortest_line(middle, nearest)), axis=0)[0]
    way = shapely.get_coordinates(shapely.centroid(shapes)) - shapely.get_coordinates(middle)
    ahead = (way @ [x, y]) / np.maximum(np.hypot(*way.T) * np.hypot(x, y), 1e-9)
    if relation == "behind":
        return np.asarray(close & (ahead <= -IN_VIEW))
    found = close & (ahead >= IN_VIEW)
    if relation == "opposite":
        ways = shapely.shortest_line(shapes, place)
        across = np.zeros(len(shapes), bool)
        across[shapely.STRtree(streets).query(ways, predicate="crosses")[0]] = True
        found &= across
    return np.asarray(found)


def lies_between(shapes: NDArray[Any], first: Any, second: Any) -> BoolArray:
    """(n,) whether shapes lie between two places: on the way from one to the other."""
    spots = shapely.centroid(shapes)
    way = shapely.distance(spots, first) + shapely.distance(spots, second)
    apart = float(shapely.distance(shapely.centroid(first), shapely.centroid(second)))
    return np.asarray(way <= DETOUR * apart)


def _relation(relation: str) -> Callable[[Facts, tuple[Group, ...], Options], Measured]:
    def measured(facts: Facts, groups: tuple[Group, ...], _: Options) -> Measured:
        first, second = (facts.select(group) for group in groups)
        streets = facts.layer("road").shapes
        found = np.zeros(len(first.rows), bool)
        for place in second.shapes.tolist():
            found |= lies(relation, first.shapes, place, streets)
        return Measured(
            bool(found.any()), f"{int(found.sum())} of {said(first)} lie {relation} {groups[1]}"
        )

    return measured


before, behind, opposite = map(_relation, ("before", "behind", "opposite"))


def between(facts: Facts, groups: tuple[Group, ...], _: Options) -> Measured:
    """Return whether some of the first lie between one of the second and one of the third."""
    chosen, first, second = (facts.select(group) for group in groups)
    found = np.zeros(len(chosen.rows), bool)
    for one in first.shapes.tolist():
        for other in second.shapes.tolist():
            found |= lies_between(chosen.shapes, one, other)
    where = f"between {groups[1]} and {groups[2]}"
    return Measured(bool(found.any()), f"{int(found.sum())} of {said(chosen)} lie {where}")


def lies_across(shapes: NDArray[Any], place: Any, lines: NDArray[Any]) -> BoolArray:
    """(n,) whether the straight way from shapes to a place leads over one of some waters, ways."""
    ways = shapely.shortest_line(shapely.centroid(shapes), place)
    found = np.zeros(len(shapes), bool)
    found[shapely.STRtree(lines).query(ways, predicate="crosses")[0]] = True
    return found


def across(facts: Facts, groups: tuple[Group, ...], _: Options) -> Measured:
    """Return whether some of the first lie across one of the third from most of the second."""
    chosen, others, lines = (facts.select(group) for group in groups)
    found = np.zeros(len(chosen.rows))
    for place in others.shapes.tolist():
        found += lies_across(chosen.shapes, place, lines.shapes)
    over = found > len(others.rows) / 2
    return Measured(
        bool(over.any()),
        f"{int(over.sum())} of {said(chosen)} lie across {groups[2]} from {groups[1]}",
    )


def axis(facts: Facts, groups: tuple[Group, ...], _: Options) -> Measured:
    """Return which way streets run."""
    shapes = _shapes(facts, groups[0])
    points, line = shapely.get_coordinates(shapes, return_index=True)
    way = np.diff(points, axis=0)[np.diff(line) == 0]
    doubled = np.exp(2j * np.arctan2(way[:, 1], way[:, 0])) * np.hypot(*way.T)
    mean = doubled.sum()
    angle = np.degrees(np.angle(mean) / 2) % 180.0  # counter-clockwise from east
    names = ("east_west", "northeast_southwest", "north_south", "northwest_southeast")
    word = names[round(angle / 45.0) % 4]
    straight = abs(mean) / max(np.abs(doubled).sum(), 1e-9)
    return Measured(
        (word,), f"{groups[0]} runs {word}, {(90 - angle) % 180:.0f} degrees from north, "
        f"{100 * straight:.0f} % of it that way"
    )  # fmt: skip


def spans(facts: Facts, groups: tuple[Group, ...], options: Options) -> Measured:
    """Measure how much of the site the longest street spans."""
    chosen = facts.select(groups[0])
    if not len(chosen.rows):
        raise Absent(f"there is no {groups[0]}")
    direction = options.get("dir")
    side = 1 if isinstance(direction, Name) and direction.word == "y" else 0
    extent = facts.city.layout.extent
    bounds = shapely.bounds(chosen.shapes)
    unit = chosen.layer.units(chosen.rows)
    reach = [
        np.ptp(np.clip(bounds[unit == n][:, [side, side + 2]], extent[side], extent[side + 2]))
        for n in np.unique(unit).tolist()
    ]
    share = float(max(reach) / (extent[side + 2] - extent[side]))
    return Measured(share, f"the longest {groups[0]} spans {100 * share:.0f} % of the site")


def side(facts: Facts, groups: tuple[Group, ...], _: Options) -> Measured:
    """Return on which side of the site things lie, and in which corner where they lie in one."""
    shapes = _shapes(facts, groups[0])
    xmin, ymin, xmax, ymax = facts.city.layout.extent
    x, y = shapely.get_coordinates(shapely.union_all(shapes).centroid)[0]
    east, north = 2 * (x - xmin) / (xmax - xmin) - 1, 2 * (y - ymin) / (ymax - ymin) - 1
    word = ("east" if east > 0 else "west") if abs(east) > abs(north) else (
        "north" if north > 0 else "south"
    )  # fmt: skip
    near, far = sorted((abs(east), abs(north)))
    corner = ("north" if north > 0 else "south") + ("east" if east > 0 else "west")
    found = () if far <= ASIDE else (word,) if near < IN_CORNER else (word, corner)
    other = corner.replace(word, "")
    also = f" and {100 * near:.0f} % to the {other} side" if near >= IN_CORNER else " side"
    return Measured(
        found, f"the middle of {groups[0]} lies {100 * far:.0f} % of the way to the {word}{also}"
    )


def trend(facts: Facts, groups: tuple[Group, ...], _: Options) -> Measured:
    """Correlate the ranks of a number of things with how near they are to a side or the middle."""
    chosen = facts.select(groups[0])
    attribute, towards = groups[1].head, groups[2].head
    assert isinstance(attribute, Name)
    assert isinstance(towards, Name)
    value = chosen.layer.number(attribute.word)[chosen.rows]
    near = nearness(shapely.centroid(chosen.shapes), towards.word, facts.city.layout.extent)
    kept = np.isfinite(value)
    if kept.sum() < LEAST_TREND:
        raise Absent(f"fewer than {LEAST_TREND} {groups[0]} have a {attribute}")
    both = np.stack([_ranks(value[kept]), _ranks(near[kept])])
    flat = both.std(axis=1).min() == 0
    found = 0.0 if flat else float(np.corrcoef(both)[0, 1])
    return Measured(
        found,
        f"the {attribute} of {said(chosen)} rises towards the {towards} with a rank correlation "
        f"of {found:.2f}",
    )


def _ranks(values: FloatArray) -> FloatArray:
    """Return ranks, (n,); equal values share the mean of theirs."""
    _, of, count = np.unique(np.round(values, 6), return_inverse=True, return_counts=True)
    last = np.cumsum(count)
    return np.asarray((last - (count - 1) / 2)[of.ravel()])
