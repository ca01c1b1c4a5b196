"""What one measurement may look at, and the things that a predicate chooses of it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.checks.predicates import junctions
from cityx.checks.predicates.building_predicates import Buildings
from cityx.checks.predicates.line_predicates import Crossings, StandingLines
from cityx.checks.predicates.parser import parse
from cityx.checks.predicates.pieces import Pieces
from cityx.checks.predicates.places import Lands
from cityx.checks.predicates.street_predicates import Bridges, Roads
from cityx.checks.predicates.syntax import (
    Argument,
    Call,
    Comparison,
    Condition,
    Expression,
    Name,
    Negative,
    Number,
    Predicate,
    Within,
)
from cityx.checks.predicates.thing_predicates import Absent, CannotTell, Layer, Selection, union
from cityx.checks.predicates.vocabulary import (
    ATTRIBUTES,
    FORMS,
    IDENTITY,
    KINDS,
    NARROWING,
    NEAR,
    NUMBER,
    PLACE,
    PREDICATE,
    THINGS,
    Group,
    kind_named,
    known_words,
    near_named,
    split_arguments,
)
from cityx.checks.predicates.whereabouts import is_near
from cityx.checks.predicates.words import LANDS, ROUGHLY, WHOLE
from cityx.city import City
from cityx.city.ground import ROADWAY
from cityx.errors import CityxError, nearest
from cityx.geometry.arrays import BoolArray, FloatArray
from cityx.ground.walking.walkable import walkable_of
from cityx.ground.walking.walks import walk_graph, ways_to
from cityx.options import HowToRead
from cityx.traffic.flows import AT_THE_STREET

LAYERS: Mapping[str, type[Layer]] = {
    "building": Buildings, "road": Roads, "bridge": Bridges, "land": Lands, "piece": Pieces,
    "lamp": Pieces, "light": Pieces, "vehicle": Pieces, "pedestrian": Pieces, **junctions.LAYERS,
    "line": StandingLines, "crossing": Crossings,
}  # fmt: skip
TABLES = ("building", "road", "path", "railway", "bridge")  # kinds that ids are looked for in
SURFACES: Mapping[str, tuple[str, ...]] = {
    "carriageway": ROADWAY,
    "sidewalk": (
        "sidewalk", "furnishing", "frontage", "edging", "ramp", "landing", "guide_strip",
        "kerb_dropped",
    ),
}  # fmt: skip
Options = Mapping[str, Expression]  # settings of a form by name
AT = 12.0  # metres from something to who or what is at it
LED = 1.0  # metres of way by which who goes to something comes nearer to it, at least
AT_THE_KERB = 40.0  # metres from a house, over its yard and walk, to vehicles that stand at it
NEARLY = 1e-6  # by which a number may miss an equal one; floats


@dataclass(frozen=True)
class Reply:
    """What an agent answered and did, for predicates that ask for it.

    Attributes
    ----------
    kind
        "done", "clarify" or "partial".
    mentions
        Typed findings of its report: "conflict:building".
    actions
        Actions of the journal that ran.
    mutations
        How many of them changed the city.
    """

    kind: str
    mentions: frozenset[str] = frozenset()
    actions: tuple[str, ...] = ()
    mutations: int = 0


@dataclass(frozen=True)
class Facts:
    """A city and what it is compared with.

    Attributes
    ----------
    city, before
        The city, and the state it was made of.
    inputs
        Files by the names that predicates call them.
    reply
        What the agent answered.
    together
        Predicates measured together; ``others`` is what none of them names.
    focus
        Ground that things must lie on to be chosen, None for all of it.
    how
        What the user says of the inputs that they do not say themselves.
    read
        What inputs gave that have been read, each once.
    """

    city: City
    before: City | None = None
    inputs: Mapping[str, Path] = field(default_factory=dict)
    reply: Reply | None = None
    together: tuple[Predicate, ...] = ()
    focus: shapely.Geometry | None = None
    how: HowToRead = field(default_factory=HowToRead)
    read: dict[Path, City] = field(default_factory=dict, compare=False)
    _layers: dict[str, Layer] = field(default_factory=dict, compare=False)

    @cached_property
    def earlier(self) -> Facts:
        """The same of the state before.

        Raises
        ------
        CannotTell
            If there is none.
        """
        if self.before is None:
            raise CannotTell("there is no earlier state to compare with")
        return replace(self, city=self.before, before=None, _layers={})

    def layer(self, kind: str) -> Layer:
        """Return the things of a kind."""
        if kind not in self._layers:
            self._layers[kind] = LAYERS[KINDS[kind]](self.city, kind)
        return self._layers[kind]

    def region(self, kind: str) -> shapely.Geometry:
        """Return the ground that a kind of surface or thing covers."""
        if kind == "center":
            return shapely.box(*self.city.layout.extent).centroid
        if kind == "border":
            return shapely.box(*self.city.layout.extent).exterior
        if kind in SURFACES:
            return shapely.union_all(self.surface(kind))
        return union(self.layer(kind).grounds)

    def surface(self, kind: str) -> NDArray[Any]:
        """Return the triangles of a surface of the ground."""
        ground = self.city.ground
        if ground is None:
            raise CannotTell("the ground is not laid yet")
        triangles = ground.triangles_of(*SURFACES[kind])
        return np.asarray(shapely.polygons(ground.vertices[triangles]), object)

    def select(self, group: Group) -> Selection:
        """Return the things that an argument chooses."""
        chosen = self._whenever(self._head(group.head), group)
        for condition in group.conditions:
            chosen = chosen.where(self._holds(condition, chosen))
        if self.focus is not None:
            chosen = chosen.where(shapely.intersects(chosen.shapes, self.focus))
        return replace(chosen, text=str(group))

    def select_apart(self, group: Group) -> tuple[Selection, BoolArray]:
        """Return what a share is of, and which of its rows have what is asked of them.

        Attributes such as class narrow the choice where others are asked for besides.
        """
        asked = [item for item in group.conditions if _attribute(item) not in NARROWING]
        narrow = [item for item in group.conditions if _attribute(item) in NARROWING]
        if not asked:
            asked, narrow = narrow, []
        chosen = self.select(Group(group.head, tuple(narrow)))
        for condition in asked:
            chosen = chosen.where(chosen.layer.applies(_attribute(condition))[chosen.rows])
        has = np.ones(len(chosen.rows), bool)
        for condition in asked:
            has &= self._holds(condition, chosen)
        return chosen, has

    def _head(self, head: Argument) -> Selection:
        if isinstance(head, Call):
            return self._top(head)
        assert isinstance(head, Name)
        kind = kind_named(head.word)
        if kind:
            if KINDS[kind] not in LAYERS:
                raise CannotTell(f"a {kind} is no thing that can be chosen from others")
            layer = self.layer(kind)
            return Selection(layer, np.arange(len(layer.ids)), head.word)
        return self.named(head.word)

    def named(self, word: str) -> Selection:
        """Return the thing of an id, a name or the last word of a source.

        Raises
        ------
        Absent
            If no thing is called so.
        """
        kinds = (*TABLES, *WHOLE, *(k for k in LANDS if k not in WHOLE), "tree", "vehicle")
        for kind in kinds:
            layer = self.layer(kind)
            rows = np.flatnonzero(layer.called(word)) if len(layer.ids) else np.zeros(0, np.int64)
            if len(rows):
                return Selection(layer, rows, word)
        raise Absent(f"nothing in the city is called {word}")

    def _top(self, call: Call) -> Selection:
        """Choose the things with the greatest values, of the state before where there is one."""
        (group, attribute, amount), _ = split_arguments(call)
        facts = self if self.before is None else self.earlier
        chosen = facts.select(group)
        assert isinstance(attribute.head, Name)
        value = np.round(chosen.layer.number(attribute.head.word)[chosen.rows], 6)
        count = int(constant(amount.head))
        best = np.lexsort((chosen.ids, -value))[:count]
        ids = chosen.ids[best]
        layer = self.layer(chosen.layer.kind)
        rows = np.flatnonzero(np.isin(layer.ids, ids))
        return Selection(layer, rows, str(call), missing=count - len(rows))

    def _holds(self, condition: Condition, chosen: Selection) -> BoolArray:
        """(r,) whether a condition holds of the things chosen."""
        attribute, layer, rows = _attribute(condition), chosen.layer, chosen.rows
        kind = ATTRIBUTES[KINDS[layer.kind]].get(attribute, NUMBER)
        if isinstance(condition, Within):
            value = layer.number(attribute)[rows]
            low, high = constant(condition.low), constant(condition.high)
            return np.asarray((value >= low - NEARLY) & (value <= high + NEARLY))
        if kind == NUMBER:
            return compared(layer.number(attribute)[rows], condition.sign,
                            constant(condition.right))  # fmt: skip
        assert isinstance(condition.right, Name)
        word = condition.right.word
        if kind == IDENTITY:
            found = layer.called(word)[rows]
        elif kind == PLACE:
            if attribute in ("to", "from"):
                return self._leads(chosen, word, attribute) ^ (condition.sign == "!=")
            reach = AT_THE_KERB if KINDS[layer.kind] == "vehicle" else AT
            found = self._placed(chosen, word, reach if attribute == "at" else 0.0)
        elif kind == NEAR:
            found = self._near(chosen, word)
        else:
            known = known_words(KINDS[layer.kind], attribute)
            if known and word not in known:
                hint = nearest(word, known)
                raise CannotTell(f'"{word}" is no {attribute} of a {layer.kind}.{hint}')
            found = layer.has(attribute, word)[rows]
        return np.asarray(found if condition.sign != "!=" else ~found, bool)

    def _placed(self, chosen: Selection, word: str, near: float) -> BoolArray:
        """(r,) whether things stand on, lie in or lead over something, or not farther from it."""
        region = self._place(word)
        shapely.prepare(region)
        return np.asarray(shapely.dwithin(chosen.shapes, region, near))

    def _whenever(self, chosen: Selection, group: Group) -> Selection:
        """Return vehicles of any time, where they set out, if it is asked where they go."""
        layer, tracks = chosen.layer, self.city.tracks
        asked = {_attribute(item) for item in group.conditions}
        if tracks is None or KINDS[layer.kind] != "vehicle" or asked.isdisjoint(("to", "from")):
            return chosen
        if not isinstance(group.head, Name) or not kind_named(group.head.word):
            return chosen
        key = f"{layer.kind} at any time"
        if key not in self._layers:
            held = tracks.take(np.diff(tracks.sample_start) > 0)
            since = held.time - held.time[held.sample_start[:-1]][held.mover]
            shifted = replace(held, time=since + self.city.moment)
            city = replace(self.city, tracks=shifted)
            self._layers[key] = LAYERS["vehicle"](city, layer.kind)
        layer = self._layers[key]
        return Selection(layer, np.arange(len(layer.ids)), chosen.text)

    def _near(self, chosen: Selection, word: str) -> BoolArray:
        """(r,) whether things lie so near to one of some others: "50 m of river"."""
        metres, place = near_named(word)
        if "," in place or KINDS.get(kind_named(place), "") in LAYERS:
            (group, *_), _ = split_arguments(_choice(place))
            places = self.select(group).shapes
        else:  # the middle of the site, a surface, or a thing by its name
            places = np.array([self._place(place)], object)
        return is_near(chosen.shapes, places, metres)

    def _leads(self, chosen: Selection, word: str, way: str) -> BoolArray:
        """(r,) whether things that move come nearer to something on their way, or leave it.

        Vehicles come to where their tracks end, and leave where these begin.
        """
        tracks = self.city.tracks
        found = np.zeros(len(chosen.rows), bool)
        if tracks is None or not tracks.count:
            return found
        own = tracks.take(np.isin(tracks.object_id, chosen.ids))
        if KINDS[chosen.layer.kind] == "vehicle":  # by streets, on which one passes other places
            own = own.take(np.diff(own.sample_start) > 0)
            off = shapely.distance(shapely.points(own.position[:, :2]), self._place(word))
            first, last = own.sample_start[:-1], own.sample_start[1:] - 1
            there = off[last if way == "to" else first]
            gone = np.maximum.reduceat(off, first) - there if own.count else there
            kept = (there <= AT_THE_STREET) & (gone >= LED)
            return np.asarray(np.isin(chosen.ids, own.object_id[kept]))
        graph = walk_graph(walkable_of(self.city))
        far = ways_to(graph, self._place(word))
        ends = (own.sample_start[:-1], own.sample_start[1:] - 1)
        begin, end = (far[graph.tree.query(own.position[at, :2])[1]] for at in ends)
        with np.errstate(invalid="ignore"):  # nobody gets nearer where no way leads
            gone = begin - end if way == "to" else end - begin
        return np.asarray(np.isin(chosen.ids, own.object_id[gone >= LED]))

    def _place(self, word: str) -> Any:
        """Return the ground of a kind, of a thing by its name, or of a choice in quotes."""
        kind = kind_named(word)
        if kind:
            return self.region(kind)
        if "," in word:
            (group, *_), _ = split_arguments(_choice(word))
            return shapely.union_all(self.select(group).grounds)
        return shapely.union_all(self.named(word).grounds)


def _choice(word: str) -> Call:
    """Return a choice of things that stands in quotes: "building, tag=school".

    Raises
    ------
    CannotTell
        If it is none.
    """
    try:
        read = parse(f"n({word}) >= 1")
    except CityxError as error:
        raise CannotTell(f'"{word}" chooses nothing: {error}') from error
    assert isinstance(read, Comparison)
    assert isinstance(read.left, Call)
    return read.left


def _attribute(condition: Condition) -> str:
    side = condition.of if isinstance(condition, Within) else condition.left
    assert isinstance(side, Name)
    return "floors" if side.word == "levels" else side.word


def constant(item: Argument | Expression) -> float:
    """Return the value of an expression of numbers alone.

    Raises
    ------
    CannotTell
        If it holds anything else.
    """
    if isinstance(item, Number):
        return item.value
    if isinstance(item, Negative):
        return -constant(item.of)
    raise CannotTell(f"{item} is no plain number")


def compared(value: FloatArray, sign: str, wanted: float) -> BoolArray:
    """Compare numbers with one; NaN compares with nothing."""
    slack = NEARLY * max(1.0, abs(wanted))
    if sign == "~":
        return np.asarray(np.abs(value - wanted) <= ROUGHLY * abs(wanted) + slack)
    if sign in ("=", "=="):
        return np.asarray(np.abs(value - wanted) <= slack)
    if sign == "!=":
        return np.asarray(np.abs(value - wanted) > slack)
    if sign == "<":
        return np.asarray(value < wanted)
    if sign == ">":
        return np.asarray(value > wanted)
    return np.asarray(value <= wanted + slack if sign == "<=" else value >= wanted - slack)


def names_of(predicate: Argument) -> list[Group]:
    """Return the things that a predicate names."""
    if isinstance(predicate, Comparison):
        return names_of(predicate.left) + names_of(predicate.right)
    if isinstance(predicate, Within):
        return names_of(predicate.of)
    if not isinstance(predicate, Call) or predicate.form == "same":
        return []
    takes = FORMS[predicate.form].takes
    groups, _ = split_arguments(predicate)
    found = []
    for wanted, group in zip(takes, groups, strict=True):
        if wanted == THINGS:
            found.append(group)
        elif wanted == PREDICATE:
            found += names_of(group.head)
    return found


def said(chosen: Selection) -> str:
    """Return how many things were chosen, as evidence does."""
    remark = chosen.layer.remark
    return f"{chosen.count} {chosen.text}" + (f" ({remark})" if remark else "")
