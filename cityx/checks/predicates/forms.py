"""The measures: one function for each form of the language.

What the words leave open is settled so:

- ``n`` counts the buildings that stand (those of the layout while none is built), streets from end
  to end, places whose pieces touch as one, and every vehicle that one sees, parked ones as well.
- ``share`` is of the things that class, id, name and place choose; its other conditions are what
  they have. Streets weigh by length, in ``stat`` too; ``by=area`` weighs buildings by footprint.
- ``inside`` wants one of the first in some of the second, ``crosses`` each of the first over some.
- ``near_share`` and ``part_share`` are of all things of the kind that lie there, ``near`` counts.
- ``density`` of what moves is its mean over the time that its tracks last.
- ``gained`` is how many more there are than before the change, with what stood there left out:
  ``gained(vehicle) == 20`` holds after twenty were added, however many there had been.
- ``same(others)`` lets go of what the predicates measured together name one by one, and of kinds of
  which they name none one by one; the ground, which is arranged anew, is no object. With
  ``beyond=15`` it lets go of what lies within 15 m of what is named besides.
- What is not there is not met; what the city has no record of, such as traffic, cannot be told.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from math import degrees, log
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.checks.predicates import words
from cityx.checks.predicates.building_predicates import Buildings
from cityx.checks.predicates.capacity import plot_ratio, residents
from cityx.checks.predicates.change_predicates import (
    changed_ids,
    changed_parts,
    far_ids,
    gave_way,
    listed,
    named_elsewhere,
)
from cityx.checks.predicates.ends import at_end
from cityx.checks.predicates.facts import SURFACES, Facts, Options, Reply, constant, said
from cityx.checks.predicates.finding import Measured, clean
from cityx.checks.predicates.landforms import land_of
from cityx.checks.predicates.nearby import near, near_share, part_share
from cityx.checks.predicates.pieces import Pieces
from cityx.checks.predicates.places import places_of, rivers_meeting
from cityx.checks.predicates.rasters import height_correlation, open_area, overlap_of_layers
from cityx.checks.predicates.relations import (
    across,
    around,
    axis,
    before,
    behind,
    between,
    crosses,
    dist,
    enclosed,
    inside,
    opposite,
    overlap,
    side,
    spans,
    trend,
)
from cityx.checks.predicates.street_pattern import pieces_of
from cityx.checks.predicates.street_predicates import Roads, driving_side, street_pattern
from cityx.checks.predicates.syntax import Call, Name
from cityx.checks.predicates.thing_predicates import Absent, CannotTell, union
from cityx.checks.predicates.vocabulary import KINDS, OTHERS, Group, kind_named, split_arguments
from cityx.city import Environment
from cityx.city.rooms import ROOM_KINDS, lit_rooms, room_uses
from cityx.geometry.arrays import FloatArray

# Sun, weather and air in the words and numbers of predicates.


def times_of(environment: Environment) -> tuple[str, ...]:
    """Return every word of the day that holds for the sun and the clock."""
    height = degrees(environment.sun_elevation)
    azimuth = degrees(environment.sun_azimuth) % 360.0
    half = words.UP if azimuth < 180.0 else words.DOWN
    return tuple(
        word
        for word, moment in words.TIMES.items()
        if moment.sun[0] <= height <= moment.sun[1]
        and moment.half in ("", half)
        and moment.hours[0] <= environment.hour <= moment.hours[1]
    )


def weathers_of(environment: Environment) -> tuple[str, ...]:
    """Return every kind of weather that holds for the numbers of the air."""
    values = {
        "cloud": environment.cloud_cover, "snow": environment.snow,
        "visibility": environment.visibility, "rain": environment.rain,
        "snowfall": environment.snowfall, "wind": environment.wind,
    }  # fmt: skip
    return tuple(
        word
        for word, air in words.WEATHERS.items()
        if all(getattr(air, name)[0] <= value <= getattr(air, name)[1]
               for name, value in values.items())
    )  # fmt: skip


def season_of(environment: Environment, latitude: float) -> str:
    """Return the season of the calendar: winter from December to February, or half a year later."""
    month = int(environment.date[5:7]) if environment.date else 6
    quarter = (month % 12 // 3 + (2 if latitude < 0 else 0)) % 4
    return ("winter", "spring", "summer", "autumn")[quarter]


def fog_of(environment: Environment) -> float:
    """Return how thick the fog is: 0 at 10 km of visibility, 1 at 100 m, by its logarithm."""
    span = log(words.CLEAREST / words.THICKEST)
    thick = log(words.CLEAREST / max(environment.visibility, 1.0)) / span
    return min(max(thick, 0.0), 1.0)


def air_number(environment: Environment, key: str) -> float:
    """Return a number of the environment by its key in predicates, without "env."."""
    return {
        "sun_elev": degrees(environment.sun_elevation),
        "sun_azimuth": degrees(environment.sun_azimuth) % 360.0,
        "fog": fog_of(environment),
        "wetness": environment.wetness,
        "snow_cover": environment.snow,
        "cloud": environment.cloud_cover,
        "visibility": environment.visibility,
        "wind": environment.wind,
        "rain": environment.rain,
        "hour": environment.hour,
        "moon": environment.moon,
        "day": float(environment.day),
    }[key]


def sides_of(azimuth: float) -> tuple[str, ...]:
    """Return the words of the compass that hold for radians clockwise from north."""
    turn = degrees(azimuth) % 360.0
    near = [round(turn / 45.0) % 8]
    main = [2 * (round(turn / 90.0) % 4)]
    return tuple(dict.fromkeys(words.COMPASS[number] for number in near + main))


def windows_lit(facts: Facts) -> Measured:
    """Return the share of the windows of the scene behind which a room is lit."""
    city = facts.city
    objects = {
        int(number): {"use": str(use)}
        for number, use in zip(
            city.layout.buildings["id"].tolist(), city.layout.buildings["use"].tolist(), strict=True
        )
    }
    kinds = np.array([p.kind in ROOM_KINDS for p in city.scene.prototypes] or [False])
    lit, total = 0, 0
    for rows in city.scene.instances.values():
        own = kinds[rows.prototype]
        uses = room_uses(city.scene.prototypes, rows, objects)
        lit += int((lit_rooms(rows, uses, city.environment, city.seed) & own).sum())
        total += int(own.sum())
    if not total:
        raise CannotTell("there are no windows yet")
    return Measured(lit / total, f"{lit} of {total} windows are lit")


FOLLOWED = 0.5  # metres between the places at which somebody's way is looked at
LINE_REACH = 25.0  # metres from a street within which trees stand along it
WALKSIDE = ("streetlight", "bench")  # what stands along a street when it stands on its walks
PER = 1000.0  # metres of street that a density counts per
MOMENTS = 7  # of the tracks, over which a density is the mean


Measure = Callable[[Facts, tuple[Group, ...], Options], Measured]


def _count(facts: Facts, groups: tuple[Group, ...], _: Options) -> Measured:
    chosen = facts.select(groups[0])
    examples = f": {chosen.examples()}" if 0 < chosen.count <= 4 else ""
    return Measured(float(chosen.count), f"there are {said(chosen)}{examples}")


def _share(facts: Facts, groups: tuple[Group, ...], options: Options) -> Measured:
    head = groups[0].head
    if isinstance(head, Name) and head.word == "traffic":
        return _share_of_traffic(facts, groups[0])
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


def _share_of_traffic(facts: Facts, group: Group) -> Measured:
    """Take the share of what drives over the time of its tracks: few are there at one moment."""
    tracks = facts.city.tracks
    last = 0.0 if tracks is None else tracks.take(~tracks.on_foot).duration
    held, total = 0, 0
    for moment in np.linspace(0.0, last, MOMENTS).tolist():
        then = replace(facts, city=replace(facts.city, moment=moment), _layers={})
        _, has = then.select_apart(group)
        held, total = held + int(has.sum()), total + len(has)
    if not total:
        raise Absent("nothing drives, of which a share could be taken")
    return Measured(held / total, f"{100 * held / total:.1f} %: {held} of {total} {group}, "
                    f"counted at {MOMENTS} moments")  # fmt: skip


def _cover(facts: Facts, groups: tuple[Group, ...], _: Options) -> Measured:
    site = shapely.box(*facts.city.layout.extent)
    head = groups[0].head
    kind = kind_named(head.word) if isinstance(head, Name) else ""
    if kind in SURFACES:
        covered = float(shapely.area(facts.surface(kind)).sum())
    elif kind == "green":  # nothing grows under houses and streets
        built = [facts.layer(name).grounds for name in ("building", "road")]
        covered = open_area(facts.select(groups[0]).grounds, np.concatenate(built), facts.city)
    else:
        region = union(facts.select(groups[0]).grounds)
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
    return Measured(value, f"{attribute} of {said(chosen)}: {statistic} {value:.4g}")


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
    counted = _moving(facts, groups[0])
    along = groups[1].head
    if isinstance(along, Name) and kind_named(along.word) in ("sidewalk", "carriageway"):
        region, length = facts.region(kind_named(along.word)), facts.layer("road").weights.sum()
    else:
        way = facts.select(groups[1])
        region = shapely.union_all(shapely.buffer(way.shapes, LINE_REACH))
        length = float(shapely.length(way.shapes).sum())
    if length <= 0:
        raise Absent(f"there is no {groups[1]}")
    found = np.mean([shapely.intersects(shapes, region).sum() for shapes in counted])
    mean = " on average" if len(counted) > 1 else ""
    return Measured(
        float(found) / (length / PER),
        f"{found:.3g} {groups[0]}{mean} along {length / PER:.2f} km of {groups[1]}",
    )


def _moving(facts: Facts, group: Group) -> list[NDArray[Any]]:
    """Return where the things of a group are; those that move by themselves at several moments.

    Raises
    ------
    CannotTell
        If they are of a kind that moves by itself, and none does.
    """
    chosen = facts.select(group)
    kind, tracks = chosen.layer.kind, facts.city.tracks
    if not isinstance(chosen.layer, Pieces) or KINDS.get(kind) not in ("vehicle", "pedestrian"):
        return [chosen.shapes]
    if tracks is None or not chosen.layer.moves.any():
        raise CannotTell(
            f"the city has no {kind} that moves ({len(chosen.layer.ids)} stand in it), "
            "so there is no traffic"
        )
    foot = KINDS[kind] == "pedestrian"
    last = tracks.take(tracks.on_foot == foot).duration
    found = []
    for moment in np.linspace(0.0, last, MOMENTS).tolist():
        then = replace(facts, city=replace(facts.city, moment=moment), _layers={}).select(group)
        assert isinstance(then.layer, Pieces)
        found.append(then.shapes[then.layer.moves[then.rows]])
    return found


def _spacing(facts: Facts, groups: tuple[Group, ...], _: Options) -> Measured:
    """Measure the usual distance between neighbours in a row along streets, side by side apart."""
    chosen, way = facts.select(groups[0]), facts.select(groups[1])
    if not len(way.rows) or not len(chosen.rows):
        raise Absent(f"there is no {groups[0] if len(way.rows) else groups[1]}")
    unit = way.layer.units(way.rows)
    reach = np.full(len(way.rows), LINE_REACH)
    if isinstance(way.layer, Roads) and chosen.layer.kind in WALKSIDE:
        reach = way.layer.beside[way.rows]
    gaps = [np.zeros(0)]
    for number in np.unique(unit).tolist():
        line = shapely.line_merge(shapely.union_all(way.shapes[unit == number]))
        far = reach[unit == number].max()
        near = chosen.shapes[shapely.distance(chosen.shapes, line) <= far]
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


def _follows(facts: Facts, groups: tuple[Group, ...], options: Options) -> Measured:
    """Return whether all of some movers keep to a way, from their first sample to their last."""
    tracks = facts.city.tracks
    chosen = facts.select(groups[0])
    rows = np.zeros(0, np.int64)
    if tracks is not None:
        rows = np.flatnonzero(np.isin(tracks.object_id, chosen.ids))
    if tracks is None or not len(rows):
        raise CannotTell(f"the city has no {groups[0]} that moves, so none follows {groups[1]}")
    along = facts.select(groups[1])
    shapes = along.shapes
    if isinstance(along.layer, Roads):
        reach = along.layer.beside[along.rows]
        shapes = np.where(reach > 0, shapely.buffer(shapes, reach), shapes)
    way = shapely.union_all(shapes)
    own = tracks.take(rows)
    lines = shapely.linestrings(own.position[:, :2], indices=own.mover)
    # Between two samples a mover goes straight: as far off as it gets is seen at short steps.
    spots = shapely.points(shapely.get_coordinates(shapely.segmentize(lines, FOLLOWED)))
    farthest = float(shapely.distance(spots, way).max())
    allowed = constant(options["dev"]) if "dev" in options else LINE_REACH
    return Measured(
        farthest <= allowed,
        f"{len(rows)} {groups[0]} keep within {farthest:.2f} m of {groups[1]}, "
        f"{allowed:g} m are allowed",
    )


def _changed(facts: Facts, groups: tuple[Group, ...], _: Options) -> Measured:
    ids = changed_ids(facts.earlier.city, facts.city)
    mine = _members(facts, groups[0])
    kept = mine[~np.isin(mine, ids)]
    return Measured(
        bool(len(mine)) and not len(kept),
        f"{len(mine) - len(kept)} of {len(mine)} objects of {groups[0]} changed",
    )


def _same(facts: Facts, groups: tuple[Group, ...], options: Options) -> Measured:
    ids = changed_ids(facts.earlier.city, facts.city)
    head = groups[0].head
    if isinstance(head, Name) and head.word == OTHERS:
        named, parts = named_elsewhere(facts)
        other = ids[~np.isin(ids, named)]
        if "beyond" in options:
            other = far_ids(facts, other, constant(options["beyond"]))
        way = gave_way(facts, other)
        other = other[~np.isin(other, way)]
        more = [p for p in changed_parts(facts.earlier.city, facts.city) if p not in parts]
        seen = [listed(other)] if len(other) else []
        seen += [f"{len(way)} gave way to what was named"] if len(way) else []
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


def _gained(facts: Facts, groups: tuple[Group, ...], _: Options) -> Measured:
    """Count the things that there are now beyond those that there were, fewer where it is negative.

    Things that give way to others of their kind are made up for: what is told is how many more.
    """
    counts = [state.select(groups[0]).count for state in (facts.earlier, facts)]
    return Measured(
        float(counts[1] - counts[0]),
        f"of {groups[0]} there were {counts[0]} and there are {counts[1]}",
    )


def _iou(facts: Facts, groups: tuple[Group, ...], _: Options) -> Measured:
    layer, path = _layer_and_file(facts, groups)
    value, evidence = overlap_of_layers(facts, layer, path)
    return Measured(value, evidence)


def _corr(facts: Facts, groups: tuple[Group, ...], _: Options) -> Measured:
    layer, path = _layer_and_file(facts, groups)
    if layer != "terrain":
        raise CannotTell(f"only the terrain is correlated with a file, not {layer}")
    value, evidence = height_correlation(facts.city, path, facts.how)
    return Measured(value, evidence)


def _layer_and_file(facts: Facts, groups: tuple[Group, ...]) -> tuple[str, Any]:
    layer, file = (group.head for group in groups)
    assert isinstance(layer, Name)
    assert isinstance(file, Name)
    if file.word not in facts.inputs:
        known = ", ".join(facts.inputs) or "none"
        raise CannotTell(f"no input is called {file}; given: {known}")
    return layer.word, facts.inputs[file.word]


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
    "spacing": _spacing, "dist": dist, "overlap": overlap, "inside": inside,
    "crosses": crosses, "around": around, "enclosed": enclosed, "before": before, "behind": behind,
    "across": across, "opposite": opposite, "at_end": at_end, "between": between, "axis": axis,
    "spans": spans, "side": side,
    "trend": trend, "near": near, "near_share": near_share, "part_share": part_share,
    "color": _color, "follows": _follows, "changed": _changed, "same": _same, "ratio": _ratio,
    "gained": _gained,
    "iou": _iou, "corr": _corr, "clean": _clean, "reply": _replied,
    "mentions": _mentions, "used": _used, "unused": _unused,
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
    if name in ("population", "plot.ratio"):
        return residents(facts) if name == "population" else plot_ratio(facts)
    if name == "road.pattern":
        return _pattern(facts)
    if name == "road.side":
        return driving_side(facts.city)
    if head == "terrain":
        return _of_land(key, facts)
    if name == "river.meeting":
        meeting = rivers_meeting(facts.city)
        return Measured(float(meeting), f"{meeting} rivers flow together")
    if name == "canal.straight":
        shapes = places_of(facts.city, "canal")
        if not len(shapes):
            raise Absent("there is no canal")
        least = float(
            (shapely.area(shapes) / shapely.area(shapely.oriented_envelope(shapes))).min()
        )
        return Measured(least, f"a canal takes {100 * least:.1f} % of the rectangle around it")
    if name == "road.turn":
        return _turn(facts)
    if head == "block":
        return _rows_of_blocks(facts, key)
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
    if key == "season":
        season = season_of(environment, facts.city.frame.latitude)
        return Measured((season,), f"it is {season}, {environment.date or 'midsummer'}")
    if key == "windows":
        return windows_lit(facts)
    if key in ("sun_side", "wind_from"):
        sun = key == "sun_side"
        azimuth = environment.sun_azimuth if sun else environment.wind_from
        sides = sides_of(azimuth)
        what = "the sun stands in" if sun else "the wind comes from"
        return Measured(sides, f"{what} the {sides[0]}, {degrees(azimuth) % 360:.0f} degrees")
    value = air_number(environment, key)
    return Measured(value, f"{key} is {value:.4g}")


def _of_land(key: str, facts: Facts) -> Measured:
    land = land_of(facts.city)
    said = f"the land has {land.relief:.1f} m of relief and leans by {100 * land.slope:.1f} %"
    if key in ("form", "high", "axis"):
        found = {"form": land.forms, "high": land.high, "axis": land.axis}[key]
        return Measured(found, f"{said}: {', '.join(found) or 'none of the words'}")
    value = {"relief": land.relief, "slope": land.slope, "steep": land.steep}.get(key)
    return Measured(float(land.steps) if value is None else value, said)


def _pattern(facts: Facts) -> Measured:
    found = street_pattern(facts.city)
    if not found.word:
        raise Absent("there is no street")
    return Measured(
        (found.word,),
        f"the streets are {found.word}: {100 * found.grid:.0f} % of their length lies in grids, "
        f"{100 * found.radial:.0f} % around hubs; orientation order {found.order:.2f}",
    )


def _rows_of_blocks(facts: Facts, key: str) -> Measured:
    """Count the blocks beside each other along one axis of the streets."""
    middles = shapely.get_coordinates(shapely.centroid(facts.layer("block").shapes))
    _, bearing, length = pieces_of(Roads(facts.city, "road").shapes)
    turn = float(np.angle((length * np.exp(4j * bearing)).sum()) / 4)
    way = np.array([np.cos(turn), np.sin(turn)])
    way = way if key == "columns" else np.array([-way[1], way[0]])
    at = np.sort(middles @ way)
    number = int((np.diff(at) > words.APART).sum()) + 1 if len(at) else 0
    return Measured(float(number), f"{len(at)} blocks lie in {number} {key}")


def _turn(facts: Facts) -> Measured:
    """Measure by what angle the grid of the streets is turned counter-clockwise, -45 to 45."""
    layer = Roads(facts.city, "road")
    _, bearing, length = pieces_of(layer.shapes)
    total = (length * np.exp(4j * bearing)).sum()
    if not length.sum():
        raise Absent("there is no street")
    share = float(np.abs(total) / length.sum())
    if share < words.TURNED:
        raise Absent(f"the streets are no grid: {100 * share:.0f} % of them run along two axes")
    turn = float(np.degrees(np.angle(total) / 4))
    turn += 90.0 if turn < -44.5 else 0.0  # a turn by 45 degrees is one to either side
    return Measured(
        turn, f"the streets are turned by {turn:.1f} degrees, {100 * share:.0f} % of them together"
    )
