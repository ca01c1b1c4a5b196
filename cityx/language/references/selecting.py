"""Selecting: the objects of a city that a command means, by the measures of predicates."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import replace
from types import MappingProxyType
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.checks.predicates import words
from cityx.checks.predicates.facts import Facts
from cityx.checks.predicates.parser import parse
from cityx.checks.predicates.syntax import Call, Comparison
from cityx.checks.predicates.thing_predicates import Absent, CannotTell, Selection
from cityx.checks.predicates.vocabulary import KINDS, Group, kind_named, split_arguments
from cityx.city import City
from cityx.errors import nearest
from cityx.geometry.arrays import BoolArray, FloatArray
from cityx.geometry.turns import SIDES
from cityx.ids import hash_ids, id_text
from cityx.language import Edit, Question, Reference, Selector
from cityx.language.goals import condition_of
from cityx.language.measurable import things
from cityx.language.references.lying import (
    FACING,
    LINED,
    ROADSIDE,
    front_row,
    ground_of,
    holds,
    parts_between,
    reach_of,
    runs_along,
)
from cityx.language.references.ranking import DISTANCES, is_rank, rank_values, ranked

MIDDLE = 0.15  # of the shorter side of the site, within which something is in its middle
DIAGONAL = np.cos(np.radians(45.0))  # what lies more north than east or west is in the north
_LAST = re.compile(r"[/ ]")  # parts a source: "osm/way/12", "drawn/town.geojson/feature b01"
# Kind of quarter -> the use of its buildings, or how far it reaches from the middle of the site as
# a share of the shorter side.
QUARTER_USES: Mapping[str, str] = MappingProxyType(
    {"industrial": "industrial", "residential": "residential", "commercial": "commercial"}
)
CENTRAL: Mapping[str, float] = MappingProxyType({"downtown": 0.25, "old_town": 0.25})
BETWEEN = 15.0  # metres between the buildings of a quarter: half a street
SHOWN = 6  # candidates that a question lists
MOST_BY_FILE = 0.2  # of the things of a kind, that a file may have removed or replaced
MAIN_STREET = "main_street"
TAKES_AWAY = ("remove", "replace")
LOOKS = ("set_style", "set_material", "set_color", "set_roof")


class Open(Exception):
    """What a command means is not settled; the question says what has to be."""

    def __init__(self, text: str, candidates: tuple[str, ...] = ()) -> None:
        super().__init__(text)
        self.question = Question(text, candidates)


class Nothing(Open):
    """There is nothing of what a command means."""


def choose(selector: Selector, city: City) -> Selection:
    """Return the objects that a selector means, always the same of the same city.

    Parameters
    ----------
    selector
        As the brief reads it.
    city
        Where to look. Kinds, heights, materials and places are those that predicates measure.

    Returns
    -------
    chosen
        At least one thing; ranks are settled by the measure and ties by the id, shares and counts
        by a hash of the ids.

    Raises
    ------
    Open
        If nothing is meant, or one thing and there are several.
    """
    facts = Facts(city)
    try:
        chosen = _named(selector, facts) if selector.ids else _of_kind(selector, facts)
        if selector.rank not in DISTANCES:
            chosen = chosen.where(_placed(selector, chosen, facts))
        chosen = _told_by_others(selector, chosen, facts)
        chosen = _counted(selector, chosen, facts)
    except CannotTell as error:
        raise Open(f"It cannot be told which {said(selector)} is meant: {error}.") from error
    if not len(chosen.rows):
        raise Nothing(f"There is no {said(selector)} in the city.",
                      _alternatives(selector, facts))  # fmt: skip
    if selector.alone and selector.kind == MAIN_STREET:
        return _of_one_street(_foremost(chosen))
    if selector.alone and chosen.count > 1:
        chosen = _next_to(selector, chosen, facts)
    if selector.alone and chosen.count > 1:
        raise Open(f"Which {selector.kind or 'one'}? There are {chosen.count}.", listed(chosen))
    return chosen


def _told_by_others(selector: Selector, chosen: Selection, facts: Facts) -> Selection:
    """Take those that lie where other objects tell, and leave out those that are not meant."""

    def spot(one: Selector) -> Selection:
        return choose(one, facts.city)

    for reference in selector.where:
        chosen = chosen.where(holds(reference, chosen, facts, spot))
    for one in selector.but:
        chosen = chosen.where(~np.isin(chosen.ids, choose(one, facts.city).ids))
    return chosen


def place_of(reference: Reference, city: City) -> Any:
    """Return the ground of a place that other objects tell.

    Raises
    ------
    Open
        If there are no such objects, or no such ground.
    """
    ground = ground_of(reference, Facts(city), lambda one: choose(one, city))
    if ground.is_empty:
        words = " ".join(str(value) for pair in reference.items() for value in pair)
        raise Open(f"There is no ground {words.replace('_', ' ')}.")
    return ground


def part_of_streets(selector: Selector, chosen: Selection, city: City) -> Any:
    """Return the ground of parts of streets that lead between two places, None for the whole."""
    found = [one for one in selector.where if one.key == "between"]
    if not found or KINDS[chosen.layer.kind] != "road":
        return None
    parts = parts_between(found[0], chosen.shapes, lambda one: choose(one, city))
    return shapely.union_all([shapely.buffer(part, PART) for part in parts if part is not None])


CLEARLY, BY = 1.5, 3.0  # times as far, and metres more, that the second is than the nearest


def _next_to(selector: Selector, chosen: Selection, facts: Facts) -> Selection:
    """Return the one that clearly is nearest: "the house behind the church" is the next one."""
    spots = [one for one in selector.where if one.key in ("before", "behind", "opposite")]
    if not spots:
        return chosen
    place = shapely.union_all(choose(spots[0].spots[0], facts.city).grounds)
    away = np.asarray(shapely.distance(chosen.shapes, place), float)
    first, second = np.sort(away)[:2]
    clear = second >= CLEARLY * first + BY
    return chosen.where(away == first) if clear else chosen


PART = 1.0  # metres on both sides of the middle of a street that tell which part of it is meant


def _foremost(chosen: Selection) -> Selection:
    """Return the streets of the highest class among main streets: "the" main street is one."""
    for word in words.MAIN:
        if word in words.ROAD_CLASSES:
            found = chosen.where(chosen.layer.has("class", word)[chosen.rows])
            if len(found.rows):
                return found
    return chosen


def _of_one_street(chosen: Selection) -> Selection:
    """Return the longest of some streets, with all that is called like it."""
    unit = chosen.layer.units(chosen.rows)
    length = np.bincount(unit, shapely.length(chosen.shapes))
    longest = unit == int(np.argmax(np.round(length, 3)))
    roads = chosen.layer.city.layout.roads.set_index("id")
    names = roads["name"].loc[chosen.layer.members(chosen.rows)].to_numpy().astype(str)
    called = np.unique(names[longest & (names != "")])
    return chosen.where(longest | np.isin(names, called))


def chosen_by(edit: Edit, city: City) -> Selection | None:
    """Return the objects that an edit changes; None where it adds something or sets the air.

    A look that is given to nothing in particular is that of every building.

    Raises
    ------
    Open
        As of `choose`.
    """
    if edit.target is not None:
        chosen = choose(edit.target, city)
        if edit.wished and edit.verb in TAKES_AWAY:
            _bounded(chosen)
        return chosen
    return choose(Selector("building"), city) if edit.verb in LOOKS else None


def _bounded(chosen: Selection) -> None:
    """Ask before what a file wishes takes away a large part of what there is of a kind."""
    total = len(chosen.layer.ids)
    if len(chosen.rows) > MOST_BY_FILE * total:
        raise Open(
            f"A file wants {chosen.count} of {total} {chosen.layer.kind}s gone; say so yourself "
            "if that is meant."
        )


def said(selector: Selector) -> str:
    """Return a selector in words."""
    kind = " and ".join(selector.ids) or selector.kind.replace("_", " ") or "object"
    parts = [*(text.replace("!=", " not ").replace("=", " ") for text in selector.filters), kind]
    for relation in ("near", "inside", "along"):
        if getattr(selector, relation):
            parts.append(f"{relation.replace('inside', 'in')} {getattr(selector, relation)}")
    if selector.side:
        parts.append(f"{selector.side} of {selector.of or 'the middle'}")
    parts += [str(word) for one in selector.where for pair in one.items() for word in pair]
    parts += [word for one in selector.but for word in ("except", said(one))]
    return " ".join(parts)


def listed(chosen: Selection, most: int = SHOWN) -> tuple[str, ...]:
    """Describe things one can choose from: name, id, height and place."""
    found = [_described(chosen, place) for place in range(min(most, len(chosen.rows)))]
    more = len(chosen.rows) - most
    return (*found, f"and {more} more") if more > 0 else tuple(found)


def _described(chosen: Selection, place: int) -> str:
    name = chosen.where(np.arange(len(chosen.rows)) == place).examples(1)
    own = id_text(int(chosen.ids[place]))
    x, y = shapely.get_coordinates(shapely.centroid(chosen.shapes[place]))[0]
    try:
        height = f", {chosen.layer.number('height')[chosen.rows[place]]:.0f} m high"
    except CannotTell:
        height = ""
    called = own if name == own else f"{_LAST.split(name)[-1] if '/' in name else name} ({own})"
    return f"{called}{height}, at {x:.0f}, {y:.0f}"


def group_of(text: str) -> Group:
    """Return a choice of things, such as "building, type=tower", as predicates write it."""
    predicate = parse(f"n({text}) >= 0")
    assert isinstance(predicate, Comparison)
    assert isinstance(predicate.left, Call)
    return split_arguments(predicate.left)[0][0]


def _of_kind(selector: Selector, facts: Facts) -> Selection:
    """Return the things of a kind that hold to the filters; a place alone is of buildings."""
    kind = selector.kind or "building"
    conditions = [condition_of(text) for text in selector.filters]
    unknown = [t for t, told in zip(selector.filters, conditions, strict=True) if not told]
    if unknown:
        raise Open(f"Nothing measures {' and '.join(unknown)} of a {kind}; name what is meant.")
    text = things(kind)
    if not text:
        known = sorted(k for k in KINDS if things(k))
        raise Open(f"A {kind.replace('_', ' ')} cannot be chosen.{nearest(kind, known)}")
    found = facts.select(group_of(", ".join([text, *conditions])))
    if kind == MAIN_STREET and not len(found.rows):
        return _widest(facts)
    return found


def _widest(facts: Facts) -> Selection:
    """Return the streets of the highest class of a place without main roads, the longest of them.

    Where streets have names that is the longest of one name.
    """
    roads = facts.select(group_of("road"))
    for word in words.ROAD_CLASSES:
        if word in _THROUGH:
            continue
        own = roads.where(roads.layer.has("class", word)[roads.rows])
        if len(own.rows):
            unit = own.layer.units(own.rows)
            length = np.bincount(unit, shapely.length(own.shapes))
            return own.where(unit == int(np.argmax(np.round(length, 3))))
    return roads


_THROUGH = ("motorway", "trunk")  # which lead past a place rather than through it


def _named(selector: Selector, facts: Facts) -> Selection:
    """Return the things of some names; every name must lead to one thing, or to streets.

    A street that is interrupted, or two of one name, are meant together.
    """
    found: list[Selection] = []
    faults: list[tuple[str, tuple[str, ...]]] = []
    for word in selector.ids:
        try:
            one = facts.named(word)
        except Absent:
            faults.append((f'Nothing is called "{word}".{nearest(word, _names(facts))}', ()))
            continue
        found.append(one)
        if one.count > 1 and KINDS[one.layer.kind] != "road":
            faults.append((f'"{word}" names {one.count} things.', listed(one)))
    if faults:
        candidates = tuple(each for _, more in faults for each in more)
        raise Open(" ".join(text for text, _ in faults), candidates)
    kinds = {each.layer.kind for each in found}
    if len(kinds) > 1:
        raise Open(f"{' and '.join(selector.ids)} are of several kinds; change one kind at a time.")
    rows = np.unique(np.concatenate([each.rows for each in found]))
    return Selection(found[0].layer, rows, ", ".join(selector.ids))


def _names(facts: Facts) -> list[str]:
    layer = facts.layer("building")
    tails = [str(text).rpartition("/")[2] for text in layer.names["source"].tolist()]
    return [*dict.fromkeys([*map(str, layer.names["name"].tolist()), *tails])]


def _alternatives(selector: Selector, facts: Facts) -> tuple[str, ...]:
    """Return what there is of the kind anywhere, of any look."""
    if selector.ids or not (selector.filters or _has_place(selector)):
        return ()
    try:
        return listed(_of_kind(Selector(selector.kind), facts))
    except (Open, CannotTell):
        return ()


# -- where ---------------------------------------------------------------------------------------


def _has_place(selector: Selector) -> bool:
    return bool(
        selector.near or selector.inside or selector.along or selector.side or selector.where
    )


def _placed(selector: Selector, chosen: Selection, facts: Facts) -> BoolArray:
    """(r,) whether things are where the selector says."""
    kept = np.ones(len(chosen.rows), bool)
    if selector.near:
        kept &= distance_to(selector.near, chosen, facts) <= (selector.reach or reach_of(chosen))
        by_id = any(letter.isdigit() for letter in selector.near)
        if not by_id and things(selector.near) and kind_named(selector.near) != "center":
            kept &= ~np.isin(chosen.ids, _place(selector.near, facts).ids)
    if selector.inside:
        lined = _is_street(selector.inside, facts)  # "the houses on Mill Lane"
        kept &= (_along if lined else _within)(selector.inside, chosen, facts)
    if selector.along:
        kept &= _along(selector.along, chosen, facts)
    if selector.side:
        kept &= _beside(selector, chosen, facts)
    return kept


def region_of(word: str, facts: Facts) -> Any:
    """Return the ground of what a place is called after: a kind, an id or a name.

    Raises
    ------
    Open
        If the city has no such place.
    """
    if kind_named(word) == "center":
        return facts.region("center")
    return shapely.union_all(shapely.make_valid(_place(word, facts).grounds))


def place_selector(word: str) -> Selector:
    """Return what a place is called after: "park", "b03", "Mill Lane" or "tallest building"."""
    rank, _, kind = word.partition(" ")
    if things(kind) and is_rank(rank):
        return Selector(kind, rank=rank, k=1)
    return Selector(kind=word) if things(word) else Selector(ids=(word,))


def _is_street(word: str, facts: Facts) -> bool:
    """Return whether a word is the name of a street, of which nothing but its surface is inside."""
    if kind_named(word):
        return False
    try:
        return KINDS[facts.named(word).layer.kind] == "road"
    except (Absent, CannotTell):
        return False


def _place(word: str, facts: Facts) -> Selection:
    """Return the things that a place is called after."""
    own = place_selector(word)
    if own.rank or word == MAIN_STREET:
        return choose(own, facts.city)
    text = things(word)
    try:
        chosen = facts.select(group_of(text)) if text else facts.named(word)
    except Absent:
        chosen = None
    if chosen is None or not len(chosen.rows):
        raise Open(f"There is no {word.replace('_', ' ')} in the city.")
    return chosen


def distance_to(word: str, chosen: Selection, facts: Facts) -> FloatArray:
    """(r,) metres from each thing to a place; what touches it has none."""
    return np.asarray(shapely.distance(chosen.shapes, region_of(word, facts)), float)


def _within(word: str, chosen: Selection, facts: Facts) -> BoolArray:
    """Whether the middle of a thing lies in a place; in the city's middle means near it."""
    if kind_named(word) == "center":
        xmin, ymin, xmax, ymax = facts.city.layout.extent
        reach = MIDDLE * min(xmax - xmin, ymax - ymin)
        return distance_to(word, chosen, facts) <= reach
    if word in QUARTER_USES:
        region = _quarter(word, facts)
    elif word in CENTRAL:
        xmin, ymin, xmax, ymax = facts.city.layout.extent
        reach = CENTRAL[word] * min(xmax - xmin, ymax - ymin)
        return distance_to("center", chosen, facts) <= reach
    else:
        region = region_of(word, facts)
    shapely.prepare(region)
    return np.asarray(shapely.intersects(shapely.centroid(chosen.shapes), region), bool)


def _quarter(word: str, facts: Facts) -> Any:
    """Return the ground of a quarter: that of the buildings of its use, and between them."""
    group = ", ".join(["building", f"use={QUARTER_USES[word]}"])
    own = facts.select(group_of(group))
    if not len(own.rows):
        raise Open(f"There is no {word} quarter in the city: no building of such a use.")
    return shapely.buffer(shapely.union_all(shapely.buffer(own.grounds, BETWEEN)), -BETWEEN)


def _along(word: str, chosen: Selection, facts: Facts) -> BoolArray:
    """Whether things line a street: near enough, and no house stands between."""
    if KINDS[chosen.layer.kind] == "road" and not things(word).startswith("road"):
        return runs_along(chosen, region_of(word, facts))
    if KINDS[chosen.layer.kind] != "building":
        return np.asarray(distance_to(word, chosen, facts) <= ROADSIDE)
    street = things(word).startswith("road") or _is_street(word, facts)
    reach = LINED if street else FACING  # of water, a park
    return front_row(chosen, region_of(word, facts), reach, facts)


def _beside(selector: Selector, chosen: Selection, facts: Facts) -> BoolArray:
    """Whether things lie on a side of something, or of the site."""
    way = np.array(SIDES[selector.side.replace("_", "")])
    middle = shapely.centroid(chosen.shapes)
    at = shapely.get_coordinates(middle)
    if not selector.of:
        xmin, ymin, xmax, ymax = facts.city.layout.extent
        off = (at - [(xmin + xmax) / 2, (ymin + ymax) / 2]) * way
        return np.asarray((off > 0)[:, way != 0].all(axis=1), bool)
    lines = shapely.shortest_line(region_of(selector.of, facts), middle)
    ends = shapely.get_coordinates(lines).reshape(-1, 2, 2)
    off = ends[:, 1] - ends[:, 0]
    far = np.hypot(*off.T)
    ahead = (off @ way) / np.hypot(*way)
    return np.asarray((far > 0) & (ahead > DIAGONAL * far - 1e-9), bool)


# -- which and how many ----------------------------------------------------------------------------


def _counted(selector: Selector, chosen: Selection, facts: Facts) -> Selection:
    """Take the part, the first or the n-th of what is chosen."""
    if selector.share is not None:
        part = max(round(selector.share * len(chosen.rows)), 1)
        return _first(chosen, _by_hash(chosen, facts), part)
    if selector.rank:
        return _by_rank(selector, chosen, facts)
    if selector.nth and chosen.count > 1:
        raise Open(f"Number {selector.nth} of {chosen.count} in which order? Say it as in: the "
                   "second tallest.", listed(chosen))  # fmt: skip
    if selector.k:
        return _first(chosen, _by_hash(chosen, facts), _at_most(selector, chosen))
    return chosen


def _at_most(selector: Selector, chosen: Selection) -> int:
    if chosen.count < selector.k and len(chosen.rows):
        raise Open(f"{selector.k} {said(selector)} are asked for, the city has {chosen.count}.",
                   listed(chosen))  # fmt: skip
    return selector.k


def _by_rank(selector: Selector, chosen: Selection, facts: Facts) -> Selection:
    """Take the first or the n-th by a rank; a street is all that has its name."""
    away = None
    if selector.rank in DISTANCES:
        word = selector.near or selector.inside or selector.of or selector.along
        if not word:
            raise Open(f"The {selector.rank} {selector.kind} to what?")
        itself = np.isin(chosen.ids, _place(word, facts).ids) if kind_named(word) != "center" else (
            np.zeros(len(chosen.rows), bool)
        )  # fmt: skip
        if selector.near and not itself.all():
            chosen = chosen.where(~itself)  # "the building nearest the church" is another one
        away = distance_to(word, chosen, facts)
    value = rank_values(selector.rank, chosen, away)
    if value is None:
        raise Open(f"Nothing measures which {selector.kind} is the {selector.rank}.")
    thing, order = ranked(chosen, value)
    if selector.nth > len(order):
        raise Open(f"There are only {len(order)} {said(selector)}.", listed(chosen))
    first = selector.nth - 1 if selector.nth else 0
    number = _at_most(selector, chosen) if selector.k and not selector.nth else 1
    return chosen.where(np.isin(thing, order[first : first + number]))


def _first(chosen: Selection, order: NDArray[np.int64], number: int) -> Selection:
    return replace(chosen, rows=np.sort(chosen.rows[order[:number]]))


def _by_hash(chosen: Selection, facts: Facts) -> NDArray[np.int64]:
    key = hash_ids(facts.city.seed, "edit/chosen", chosen.ids)
    return np.asarray(np.argsort(key, kind="stable"))
