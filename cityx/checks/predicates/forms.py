"""The measures: one function for each form of the language."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.checks.predicates import words
from cityx.checks.predicates.buildings import Buildings
from cityx.checks.predicates.changes import changed_ids, changed_parts, listed, named_elsewhere
from cityx.checks.predicates.cleanliness import clean
from cityx.checks.predicates.environment import air_number, times_of, weathers_of
from cityx.checks.predicates.facts import SURFACES, Facts, Reply
from cityx.checks.predicates.streets import Roads, street_pattern
from cityx.checks.predicates.syntax import Call, Comparison, Expression, Name
from cityx.checks.predicates.things import Absent, CannotTell, FloatArray, Selection
from cityx.checks.predicates.vocabulary import (
    KINDS,
    OTHERS,
    Group,
    kind_named,
    split_arguments,
)
from cityx.geometry.identity import id_text

OPEN_SIDE = np.pi  # radians; a wider gap between two of them as seen from there is an open side
LINE_REACH = 25.0  # metres from a street within which trees stand along it
PER = 1000.0  # metres of street that a density counts per


@dataclass(frozen=True)
class Measured:
    """What was measured.

    Attributes
    ----------
    value
        A number, whether something holds, or the words that hold.
    evidence
        What was seen.
    """

    value: float | bool | tuple[str, ...]
    evidence: str


Options = Mapping[str, Expression]
Measure = Callable[[Facts, tuple[Group, ...], Options], Measured]


def _said(chosen: Selection) -> str:
    remark = chosen.layer.remark
    return f"{chosen.count} {chosen.text}" + (f" ({remark})" if remark else "")


def _count(facts: Facts, groups: tuple[Group, ...], _: Options) -> Measured:
    chosen = facts.select(groups[0])
    examples = f": {chosen.examples()}" if 0 < chosen.count <= 4 else ""
    return Measured(float(chosen.count), f"there are {_said(chosen)}{examples}")


def _share(facts: Facts, groups: tuple[Group, ...], options: Options) -> Measured:
    chosen, has = facts.select_apart(groups[0])
    by = options.get("by")
    weight = np.ones(len(has))
    if isinstance(by, Name) and by.word == "area":
        weight = shapely.area(chosen.shapes)
    elif isinstance(chosen.layer, Roads):
        weight = chosen.layer.weights[chosen.rows]
    total = float(weight.sum()) + chosen.missing * float(weight.mean() if len(weight) else 1.0)
    if total <= 0:
        raise Absent(f"there is no {chosen.text} of which a share could be taken")
    share = float(weight[has].sum() / total)
    return Measured(
        share, f"{100 * share:.1f} %: {int(has.sum())} of {len(has) + chosen.missing} {groups[0]}"
    )


def _cover(facts: Facts, groups: tuple[Group, ...], _: Options) -> Measured:
    site = shapely.box(*facts.city.layout.extent)
    head = groups[0].head
    kind = kind_named(head.word) if isinstance(head, Name) else ""
    if kind and not groups[0].conditions:
        region = facts.region(kind)
    else:
        region = shapely.union_all(shapely.make_valid(facts.select(groups[0]).shapes))
    if kind == "green":  # nothing grows under houses and streets
        region = region.difference(facts.region("building")).difference(facts.region("road"))
    covered = float(shapely.area(shapely.intersection(region, site)))
    share = covered / max(site.area, 1e-9)
    return Measured(share, f"{groups[0]} covers {covered:,.0f} m2, {100 * share:.1f} % of the site")


def _stat(facts: Facts, groups: tuple[Group, ...], _: Options) -> Measured:
    group, attribute, statistic = groups
    chosen = facts.select(group)
    assert isinstance(attribute.head, Name)
    assert isinstance(statistic.head, Name)
    values = chosen.layer.number(attribute.head.word)[chosen.rows]
    weight = chosen.layer.weights[chosen.rows]
    kept = np.isfinite(values)
    if not kept.any():
        raise Absent(f"there is no {group} with a {attribute}")
    value = _statistic(values[kept], weight[kept], statistic.head.word)
    return Measured(value, f"{attribute} of {_said(chosen)}: {statistic} {value:.4g}")


def _statistic(values: FloatArray, weight: FloatArray, name: str) -> float:
    if name == "min":
        return float(values.min())
    if name == "max":
        return float(values.max())
    if name == "mean":
        return float(np.average(values, weights=weight))
    order = np.argsort(values, kind="stable")
    reached = np.cumsum(weight[order]) - 0.5 * weight[order]
    share = int(name[1:]) / 100.0
    return float(np.interp(share * weight.sum(), reached, values[order]))


def _density(facts: Facts, groups: tuple[Group, ...], _: Options) -> Measured:
    """Count what moves per kilometre of street or walk."""
    head = groups[0].head
    kind = kind_named(head.word) if isinstance(head, Name) else ""
    if KINDS.get(kind) in ("vehicle", "pedestrian"):
        standing = len(facts.layer(kind).ids)
        raise CannotTell(
            f"the city has no {kind} that moves ({standing} stand in it), so there is no traffic"
        )
    chosen = facts.select(groups[0])
    along = groups[1].head
    if isinstance(along, Name) and kind_named(along.word) in ("sidewalk", "carriageway"):
        region, length = facts.region(kind_named(along.word)), facts.layer("road").weights.sum()
    else:
        way = facts.select(groups[1])
        region = shapely.union_all(shapely.buffer(way.shapes, LINE_REACH))
        length = float(shapely.length(way.shapes).sum())
    if length <= 0:
        raise Absent(f"there is no {groups[1]}")
    found = int(shapely.intersects(chosen.shapes, region).sum())
    return Measured(
        found / (length / PER), f"{found} {groups[0]} along {length / PER:.2f} km of {groups[1]}"
    )


def _spacing(facts: Facts, groups: tuple[Group, ...], _: Options) -> Measured:
    """Measure the usual distance between neighbours in a row along streets, side by side apart."""
    chosen, way = facts.select(groups[0]), facts.select(groups[1])
    if not len(way.rows) or not len(chosen.rows):
        raise Absent(f"there is no {groups[0] if len(way.rows) else groups[1]}")
    unit = way.layer.units(way.rows)
    gaps = [np.zeros(0)]
    for number in np.unique(unit).tolist():
        line = shapely.line_merge(shapely.union_all(way.shapes[unit == number]))
        near = chosen.shapes[shapely.distance(chosen.shapes, line) <= LINE_REACH]
        gaps += [_gaps_along(part, near) for part in shapely.get_parts(line).tolist()]
    every = np.concatenate(gaps)
    if not len(every):
        raise Absent(f"fewer than two {groups[0]} stand along {groups[1]}")
    value = float(np.median(every))
    return Measured(value, f"{len(every) + 1} {groups[0]} stand {value:.1f} m apart (median)")


def _gaps_along(line: Any, points: NDArray[Any]) -> FloatArray:
    """Return the gaps between points along a line, those of its two sides apart."""
    if len(points) < 2:
        return np.zeros(0)
    at = shapely.line_locate_point(line, points)
    foot = shapely.get_coordinates(shapely.line_interpolate_point(line, at))
    ahead = shapely.get_coordinates(shapely.line_interpolate_point(line, at + 0.5))
    way, off = ahead - foot, shapely.get_coordinates(points) - foot
    left = way[:, 0] * off[:, 1] - way[:, 1] * off[:, 0] > 0
    return np.concatenate([np.diff(np.sort(at[left == side])) for side in (True, False)])


def _shapes(facts: Facts, group: Group) -> NDArray[Any]:
    """Return the shapes of things, of a surface or of the middle of the site."""
    head = group.head
    kind = kind_named(head.word) if isinstance(head, Name) else ""
    if kind == "center":
        return np.array([facts.region(kind)], object)
    if kind in SURFACES:
        return facts.surface(kind)
    chosen = facts.select(group)
    if not len(chosen.rows):
        raise Absent(f"there is no {group}")
    return chosen.shapes


def _dist(facts: Facts, groups: tuple[Group, ...], _: Options) -> Measured:
    first, second = (_shapes(facts, group) for group in groups)
    if len(first) > len(second):
        first, second = second, first
    tree = shapely.STRtree(second)
    _, away = tree.query_nearest(first, return_distance=True, all_matches=False)
    value = float(away.min())
    return Measured(value, f"the nearest {groups[0]} and {groups[1]} are {value:.1f} m apart")


def _overlap(facts: Facts, groups: tuple[Group, ...], _: Options) -> Measured:
    first, second = (facts.select(group).shapes for group in groups)
    pairs = shapely.STRtree(second).query(first, predicate="intersects")
    shared = shapely.area(shapely.intersection(first[pairs[0]], second[pairs[1]]))
    value = round(float(shared.sum()), 2)
    return Measured(value, f"{groups[0]} and {groups[1]} share {value:,.1f} m2")


def _inside(facts: Facts, groups: tuple[Group, ...], _: Options) -> Measured:
    """Whether some of the first lie within one of the second."""
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
    return Measured(number > 0, f"{number} of {_said(first)} lie in one of {_said(second)}")


def _crosses(facts: Facts, groups: tuple[Group, ...], _: Options) -> Measured:
    """Whether each of the first leads from one side of one of the second to another."""
    first, second = facts.select(groups[0]), facts.select(groups[1])
    over = _leads_over(first.shapes, second.shapes)
    met = bool(len(over)) and bool(over.all())
    return Measured(met, f"{int(over.sum())} of {_said(first)} cross {_said(second)}")


def _leads_over(first: NDArray[Any], second: NDArray[Any]) -> NDArray[np.bool_]:
    """(n,) whether a shape is parted by another: it goes on beyond on two sides."""
    over = np.zeros(len(first), bool)
    a, b = shapely.STRtree(second).query(first, predicate="intersects")
    left = shapely.difference(first[a], second[b])
    parts = np.array([int((shapely.area(shapely.get_parts(each)) > 0).sum()) if each.area else
                      shapely.get_num_geometries(each) for each in left.tolist()], int)  # fmt: skip
    over[a[parts >= 2]] = True
    return over


def _around(facts: Facts, groups: tuple[Group, ...], _: Options) -> Measured:
    """Whether things stand round one place of a kind, near it and on all sides."""
    chosen, places = facts.select(groups[0]), facts.select(groups[1])
    if not len(chosen.rows):
        return Measured(False, f"there is no {groups[0]}")
    if not len(places.rows):
        return Measured(False, f"there is no {groups[1]}")
    found = [_stand_around(chosen.shapes, place) for place in places.shapes.tolist()]
    met, away, gap, place = min(found, key=lambda item: (not item[0], round(item[1], 3)))
    return Measured(
        met,
        f"{_said(chosen)} stand within {away:.0f} m of a {groups[1]} of {place.area:.0f} m2, the "
        f"widest gap between them is {np.degrees(gap):.0f} degrees",
    )


def _stand_around(shapes: NDArray[Any], place: Any) -> tuple[bool, float, float, Any]:
    middle = shapely.centroid(shapes)
    away = float(shapely.distance(middle, place).max())
    x, y = shapely.get_coordinates(place.centroid)[0]
    at = shapely.get_coordinates(middle)
    turn = np.sort(np.arctan2(at[:, 1] - y, at[:, 0] - x))
    gap = float(np.diff(np.append(turn, turn[0] + 2 * np.pi)).max())
    return away <= words.NEAR and (gap <= OPEN_SIDE or len(turn) < 3), away, gap, place


def _axis(facts: Facts, groups: tuple[Group, ...], _: Options) -> Measured:
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


def _spans(facts: Facts, groups: tuple[Group, ...], options: Options) -> Measured:
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


def _side(facts: Facts, groups: tuple[Group, ...], _: Options) -> Measured:
    shapes = _shapes(facts, groups[0])
    xmin, ymin, xmax, ymax = facts.city.layout.extent
    x, y = shapely.get_coordinates(shapely.union_all(shapes).centroid)[0]
    east, north = 2 * (x - xmin) / (xmax - xmin) - 1, 2 * (y - ymin) / (ymax - ymin) - 1
    word = ("east" if east > 0 else "west") if abs(east) > abs(north) else (
        "north" if north > 0 else "south"
    )  # fmt: skip
    far = max(abs(east), abs(north))
    return Measured(
        (word,) if far > 0.2 else (),
        f"the middle of {groups[0]} lies {100 * far:.0f} % of the way to the {word} side",
    )


def _color(facts: Facts, groups: tuple[Group, ...], _: Options) -> Measured:
    chosen = facts.select(groups[0])
    if not isinstance(chosen.layer, Buildings):
        raise CannotTell(f"colours are measured of buildings, {groups[0]} is none")
    found = np.unique(chosen.layer.color_words[chosen.rows]).tolist()
    mean = chosen.layer.colors[chosen.rows].mean(axis=0)
    shown = ", ".join(f"{value:.2f}" for value in mean)
    return Measured(
        tuple(found) if len(found) == 1 else (),
        f"the walls of {groups[0]} are {' and '.join(found)} (linear RGB {shown})",
    )


def _follows(_: Facts, groups: tuple[Group, ...], __: Options) -> Measured:
    raise CannotTell(f"the city has no {groups[0]} that moves, so none follows {groups[1]}")


def _changed(facts: Facts, groups: tuple[Group, ...], _: Options) -> Measured:
    ids = changed_ids(facts.earlier.city, facts.city)
    mine = _members(facts, groups[0])
    kept = mine[~np.isin(mine, ids)]
    return Measured(
        bool(len(mine)) and not len(kept),
        f"{len(mine) - len(kept)} of {len(mine)} objects of {groups[0]} changed",
    )


def _same(facts: Facts, groups: tuple[Group, ...], _: Options) -> Measured:
    ids = changed_ids(facts.earlier.city, facts.city)
    head = groups[0].head
    if isinstance(head, Name) and head.word == OTHERS:
        named, parts = named_elsewhere(facts)
        other = ids[~np.isin(ids, named)]
        more = [p for p in changed_parts(facts.earlier.city, facts.city) if p not in parts]
        seen = [listed(other)] if len(other) else []
        return Measured(
            not len(other) and not more,
            f"{len(other)} other objects changed" + "".join(f"; {each}" for each in seen + more),
        )
    mine = _members(facts, groups[0])
    moved = mine[np.isin(mine, ids)]
    seen_text = f": {listed(moved)}" if len(moved) else ""
    return Measured(
        not len(moved), f"{len(moved)} of {len(mine)} objects of {groups[0]} changed{seen_text}"
    )


def _members(facts: Facts, group: Group) -> NDArray[np.uint64]:
    """Return the ids of things in either state: what was removed has changed as well."""
    found, reason = [np.zeros(0, np.uint64)], ""
    for state in (facts.earlier, facts):
        try:
            chosen = state.select(group)
        except CannotTell as error:
            reason = str(error)
        else:
            found.append(chosen.layer.members(chosen.rows))
    if len(found) == 1:
        raise CannotTell(reason)
    return np.unique(np.concatenate(found))


def _ratio(facts: Facts, groups: tuple[Group, ...], _: Options) -> Measured:
    attribute = groups[1].head
    assert isinstance(attribute, Name)
    values = []
    for state in (facts.earlier, facts):
        chosen = state.select(groups[0])
        found = chosen.layer.number(attribute.word)[chosen.rows]
        if not len(found):
            raise Absent(f"there is no {groups[0]}")
        values.append(float(found.mean()))
    return Measured(
        values[1] / values[0] if values[0] else float("nan"),
        f"the {attribute} of {groups[0]} was {values[0]:.4g} and is {values[1]:.4g}",
    )


def _iou(facts: Facts, groups: tuple[Group, ...], _: Options) -> Measured:
    layer, path = _layer_and_file(facts, groups)
    from cityx.checks.predicates.rasters import overlap_of_layers

    value, evidence = overlap_of_layers(facts, layer, path)
    return Measured(value, evidence)


def _corr(facts: Facts, groups: tuple[Group, ...], _: Options) -> Measured:
    layer, path = _layer_and_file(facts, groups)
    if layer != "terrain":
        raise CannotTell(f"only the terrain is correlated with a file, not {layer}")
    from cityx.checks.predicates.rasters import height_correlation

    value, evidence = height_correlation(facts.city, path)
    return Measured(value, evidence)


def _layer_and_file(facts: Facts, groups: tuple[Group, ...]) -> tuple[str, Any]:
    layer, file = (group.head for group in groups)
    assert isinstance(layer, Name)
    assert isinstance(file, Name)
    if file.word not in facts.inputs:
        known = ", ".join(facts.inputs) or "none"
        raise CannotTell(f"no input is called {file}; given: {known}")
    return layer.word, facts.inputs[file.word]


def _each(facts: Facts, groups: tuple[Group, ...], _: Options) -> Measured:
    """Whether a predicate holds at each of some things, of what stands there."""
    from cityx.checks.predicates.measuring import finding_of

    chosen = facts.select(groups[0])
    inner = groups[1].head
    met = 0
    for row in range(len(chosen.rows)):
        here = _at(inner, id_text(int(chosen.ids[row])))
        met += bool(finding_of(here, facts).met)
    every = met == len(chosen.rows) and met > 0
    return Measured(every, f"{inner} holds at {met} of {_said(chosen)}")


def _at(predicate: Any, identity: str) -> Any:
    """Return a predicate about what is on one thing: its counts get ``on=ID``."""
    if isinstance(predicate, Comparison) and isinstance(predicate.left, Call):
        call = predicate.left
        first, rest = call.arguments[0], call.arguments[1:]
        place = Comparison(Name("in"), "=", Name(identity))
        return Comparison(Call(call.form, (first, place, *rest)), predicate.sign, predicate.right)
    raise CannotTell(f"{predicate} does not count what is at each; write n(...) there")


def _extreme(facts: Facts, groups: tuple[Group, ...], best: Callable[..., float]) -> Measured:
    from cityx.checks.predicates.measuring import value_of

    found = [value_of(group.head, facts) for group in groups]
    value = best(*(float(each.value) for each in found if not isinstance(each.value, tuple)))
    return Measured(value, f"{value:.4g}")


def _clean(facts: Facts, _: tuple[Group, ...], __: Options) -> Measured:
    bad = [finding for finding in clean(facts.city) if finding.met is False]
    return Measured(
        not bad, "; ".join(f.evidence for f in bad) or "every rule of a clean city holds"
    )


def _reply(facts: Facts) -> Reply:
    if facts.reply is None:
        raise CannotTell("no agent has answered")
    return facts.reply


def _replied(facts: Facts, groups: tuple[Group, ...], _: Options) -> Measured:
    kind = _reply(facts).kind
    return Measured(kind == str(groups[0].head), f"the answer is {kind}")


def _mentions(facts: Facts, groups: tuple[Group, ...], _: Options) -> Measured:
    mentions = _reply(facts).mentions
    return Measured(
        str(groups[0].head) in mentions, f"the report names {', '.join(sorted(mentions)) or 'none'}"
    )


def _used(facts: Facts, groups: tuple[Group, ...], _: Options) -> Measured:
    word, actions = str(groups[0].head), _reply(facts).actions
    times = sum(
        action == word or word in action.replace("-v", "/").split("/") for action in actions
    )
    return Measured(times > 0, f"{word} ran {times} times among {len(actions)} actions")


def _unused(facts: Facts, groups: tuple[Group, ...], options: Options) -> Measured:
    found = _used(facts, groups, options)
    return Measured(not found.value, found.evidence)


FORMS: Mapping[str, Measure] = {
    "n": _count, "share": _share, "cover": _cover, "stat": _stat, "density": _density,
    "spacing": _spacing, "dist": _dist, "overlap": _overlap, "inside": _inside,
    "crosses": _crosses, "around": _around, "axis": _axis, "spans": _spans, "side": _side,
    "color": _color, "follows": _follows, "changed": _changed, "same": _same, "ratio": _ratio,
    "iou": _iou, "corr": _corr, "each": _each, "clean": _clean, "reply": _replied,
    "mentions": _mentions, "used": _used, "unused": _unused,
    "min": lambda facts, groups, _: _extreme(facts, groups, min),
    "max": lambda facts, groups, _: _extreme(facts, groups, max),
}  # fmt: skip


def measured_call(call: Call, facts: Facts) -> Measured:
    """Measure a form."""
    groups, options = split_arguments(call)
    return FORMS[call.form](facts, groups, options)


def measured_quantity(name: str, facts: Facts) -> Measured:
    """Measure a quantity without arguments: ``env.fog``, ``size.x``, ``road.pattern``."""
    head, _, key = name.rpartition(".")
    if head == "size":
        xmin, ymin, xmax, ymax = facts.city.layout.extent
        size = {"x": xmax - xmin, "y": ymax - ymin, "area": (xmax - xmin) * (ymax - ymin)}
        return Measured(size[key], f"the site is {size['x']:.1f} m by {size['y']:.1f} m")
    if name == "road.pattern":
        return _pattern(facts)
    if name == "journal.mutations":
        return Measured(float(_reply(facts).mutations), f"{_reply(facts).mutations} changes")
    environment = facts.city.environment
    if key == "time":
        times = times_of(environment)
        height = air_number(environment, "sun_elev")
        return Measured(
            times, f"the sun stands at {height:.1f} degrees at {environment.hour:.2f} h: "
            f"{', '.join(times)}"
        )  # fmt: skip
    if key == "weather":
        found = weathers_of(environment)
        return Measured(
            found,
            f"cloud {environment.cloud_cover:.2f}, visibility {environment.visibility:,.0f} m, "
            f"rain {environment.rain:.1f} mm/h, snow {environment.snow:.2f}: "
            f"{', '.join(found) or 'none of the words'}",
        )
    value = air_number(environment, key)
    return Measured(value, f"{key} is {value:.4g}")


def _pattern(facts: Facts) -> Measured:
    found = street_pattern(facts.city)
    if not found.word:
        raise Absent("there is no street")
    return Measured(
        (found.word,),
        f"the streets are {found.word}: {100 * found.grid:.0f} % of their length lies in grids, "
        f"{100 * found.radial:.0f} % around hubs; orientation order {found.order:.2f}",
    )
