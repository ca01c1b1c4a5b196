"""Goals: every slot and edit as predicates over the finished city; what has none is noted."""

from __future__ import annotations

import re
from calendar import monthrange
from collections.abc import Iterable, Iterator, Mapping, Sequence
from datetime import date as calendar

from cityx.checks.predicates.words import PAINTED, PARTS, SITE_PARTS
from cityx.language.brief import Edit, GoalText, Note, Selector, Slot, Value
from cityx.language.here import SEVERAL
from cityx.language.lexicon.phrases import SPECIES
from cityx.language.measurable import COLORS as NAMED_COLORS
from cityx.language.measurable import (
    MATERIALS,
    OF_A_KIND,
    SIDES_OF_SKY,
    condition,
    look_of_kind,
    things,
)
from cityx.system.tables import table
from cityx.town.building_groups import BuildingGroup, group_of
from cityx.town.elements import (
    ATTRIBUTES,
    BARRIERS,
    ELEMENTS,
    HOMES,
    OTHER_THINGS,
    PLACES,
    RELATIONS,
    SIZES,
    Distance,
    attributes_of,
    enclosed_by,
    has_none,
    looked_at,
    may_be_enclosed,
    measures,
    relation_of,
    row_of_trees,
    taller_than_others,
)
from cityx.town.part_kinds import (
    HOSTS,
    PART_KINDS,
    WALLS,
    as_high,
    beside_houses,
    built_as,
    counted,
    looks,
)
from cityx.town.quarter_kinds import (
    DWELLINGS,
    HOUSES,
    KINDS,
    is_a_place,
    reach_of,
    share_beside,
    share_in_part,
)

# Streets, and the number and the outlines of buildings.
KEPT_LAYOUT = ("same(road)", "gained(building) == 0", "ratio(building, area) in [0.999, 1.001]")
OTHERS = "same(others)"  # the goal that nothing else changes
WITHIN = 0.10  # of a number in the text; counts hold exactly
WITHIN_SIZE = 0.01  # of a size or a factor, which can be built exactly
MOST, PART = 0.6, 0.25  # share of buildings that makes a style, and one of several styles
EACH = 0.95  # share of buildings that is nearly each of them
# Of the way from the lowest to the highest land of a site.
RISES: Mapping[str, str] = {"high": ">= 0.6", "low": "<= 0.35"}
AMONG_GARAGES = 0.3  # share of buildings that are houses, where each has a garage
AROUND_SHARE = 0.05  # by which a share of buildings may differ

# Slot -> value -> predicates; "*" stands for every other value, {v} for the value.
WORDS = table("language/goals", dict[str, tuple[str, ...]], "words")
# Source -> predicates over its file, {v}.
SOURCES = table("language/goals", tuple[str, ...], "sources")
LAYOUTS = ("osm", "semantic_map", "satellite", "drawn")  # sources that give a layout
_MAPPED = tuple(("source", one) for one in LAYOUTS)
# Slot with a number -> what is measured; the comparison follows from exact, ".min" or ".max".
NUMBERS = table("language/goals", str, "numbers")
_LANES = table("language/goals", str, "lanes")
TALL_FLOORS, LOW_FLOORS = 8, 3  # storeys of kinds of buildings that are called so
EDGE = 0.25  # of the shorter side of a site, from its middle to what stands at its edge
MIDDLE = 120.0  # metres from the middle of a site to what stands there
YEAR = 2025  # of days that are told without a year
PARTS_OF = {"flower": "flower_box", "oriel": "bay_window"}  # words of parts as measured
PAINTED_SHARE = 0.5  # of the buildings at least, whose parts are painted; some have none
CLOCK = 0.05  # hours by which a clock may differ
QUARTER = 500.0  # metres of a site below which the widest roads may pass it by
_SHARED = (
    "style", "building.type", "building.material", "building.color", "building.roof",
    "building.use", "roof.color",
)  # fmt: skip
_OF_ALL_FLOORS = "stat(building, floors,"
_COUNTS = ("count", "avenues", "rings", "motorways", "columns", "rows")
TURN = 2.0  # degrees by which a grid may be turned otherwise
LOW_DOWNTOWN, STOREY = 12, 3.5  # storeys of a downtown without towers; metres of each
PLACED = (".near", ".relation", ".second")  # keys of where an element stands to another
_DISTANCE = ("", ".min", ".max")
_SIDES_OF_THINGS = ("height", "length", "width")
_FUNCTIONS = {"min": "min", "max": "max", "": "mean"}
_MEASURES = ("width", "height", "floors", "area", "length", "speed")
_WEATHERS = ("clear", "cloudy", "overcast", "rain", "storm", "fog", "haze", "snow")
# Mode of people -> what is measured of it; who waits stands.
_MODES = {
    **{one: f", mode={one}" for one in ("walk", "run", "stand", "sit", "talk")},
    "wait": ", mode=stand",
}
LIT = 0.04  # by which a share of the windows may differ that are lit: each is drawn
AMONG = 0.5  # of a share of the people by which it may differ: few are about at one moment
MIX = 0.1  # by which a share of the vehicles may differ, of some dozens at one moment
_FAR = 100_000.0  # no measure of a thing is greater
_PLAIN_NAME = frozenset("abcdefghijklmnopqrstuvwxyz0123456789_.")


def goals_of(
    slots: Sequence[Slot],
    negated: Sequence[Slot] = (),
    kept: Sequence[Slot] = (),
    edits: Sequence[Edit] = (),
    files: Mapping[str, str] | None = None,
) -> tuple[tuple[GoalText, ...], tuple[Note, ...]]:
    """Return the predicates of everything a brief asks for, each once.

    Parameters
    ----------
    slots, negated, kept, edits
        The brief.
    files
        Names of the input files by source.

    Returns
    -------
    goals
        One or more for all that predicates can measure.
    notes
        One for all that they cannot.
    """
    found: list[GoalText] = []
    notes: list[Note] = []
    slots = [slot for slot in slots if not slot.key.startswith("read.")]  # of files, not the city

    def take(text: str, predicates: Iterable[str], span: tuple[int, int]) -> None:
        goals = [GoalText(text, one, span=span) for one in predicates]
        found.extend(goals)
        if not goals:
            notes.append(Note("not_checkable", f"Nothing measures {text}.", span))

    denied = {f"iou({slot.value}" for slot in negated}  # buildings of a map that are not wanted
    # More than the map has.
    denied |= {"iou(building" for slot in slots if slot.key == "blocks" or _is_added(slot)}
    for slot in slots:
        said = _slot_predicates(slot, slots, files or {})
        kept_of = [one for one in said if one.partition(",")[0] not in denied]
        refused = "" if kept_of else _refused(slot.key)
        if refused:
            notes.append(Note("not_checkable", refused, slot.span))
        else:
            take(f"{slot.key} = {slot.value}", kept_of, slot.span)
    for slot in negated:
        take(f"not {slot.value}", _absent(str(slot.value)), slot.span)
    for slot in kept:
        if slot.value == "layout":
            take("keep layout", KEPT_LAYOUT, slot.span)
            continue
        chosen = things(str(slot.value))
        kept_goal = OTHERS if slot.value == "everything" else f"same({chosen})"
        take(f"keep {slot.value}", [kept_goal] if chosen else [], slot.span)
    for edit in edits:
        text = " ".join(f"{key}={value}" for key, value in edit.items())
        some = any(slot.value not in ("everything", "layout") for slot in kept)
        part = some and edit.target is not None and not edit.target.ids  # the rest of them
        if edit.verb not in ("undo", "redo", "unspecified", "list") and not part:
            take(text, edit_predicates(edit), edit.span)
    if any(edit.target is not None and edit.verb != "list" for edit in edits):
        found.append(GoalText("nothing else changes", OTHERS))
    return tuple({goal.predicate: goal for goal in reversed(found)}.values())[::-1], tuple(notes)


def _is_added(slot: Slot) -> bool:
    group = group_of(slot.key)
    return group is not None and group.added


def _refused(key: str) -> str:
    """Return the sentence that a thing has no such attribute, "" where it may have it."""
    kind, _, attribute = key.removesuffix(".min").removesuffix(".max").rpartition(".")
    known = (kind in ELEMENTS or kind in OTHER_THINGS) and attribute in ATTRIBUTES
    return has_none(kind, attribute) if known and attribute not in attributes_of(kind) else ""


def is_measured(slot: Slot, slots: Sequence[Slot]) -> bool:
    """Return whether a predicate measures a slot, which may need others said with it."""
    return next(iter(_slot_predicates(slot, slots, {})), None) is not None


def _heavy_traffic(slots: Sequence[Slot]) -> Iterator[str]:
    """Yield what makes traffic heavy: full main roads, or full streets in quarters without any."""
    keys = {slot.key for slot in slots}
    if "district" in keys and "source" not in keys:
        yield "density(vehicle, road) >= 8"
        return
    if "source" not in keys:
        sides = [float(slot.value) for slot in slots if slot.key in ("size.x", "size.y")]
        rank = "main" if sides and max(sides) < QUARTER else "primary"
        yield f"n(road, class={rank}) >= 1"
    yield from _said("traffic", "heavy", MOST)


def _are_low(slots: Sequence[Slot]) -> bool:
    """Return whether a text asks for buildings that are lower than those of a downtown."""
    ends = {"building.floors": LOW_DOWNTOWN, "building.height": LOW_DOWNTOWN * STOREY}
    return any(
        not isinstance(one.value, str) and float(one.value) <= most
        for key, most in ends.items() for one in slots if one.key in (key, f"{key}.max")
    )  # fmt: skip


def _slot_predicates(slot: Slot, slots: Sequence[Slot], files: Mapping[str, str]) -> Iterator[str]:
    if slot.key == "source":
        name = files.get(str(slot.value), "").lower()
        # Of several files that give a layout each gives way to others somewhere.
        alone = str(slot.value) not in LAYOUTS or sum(one in files for one in LAYOUTS) == 1
        if name and alone:
            called = name if set(name) <= _PLAIN_NAME and name[0].isalpha() else _in_quotes(name)
            yield from (one.format(v=called) for one in SOURCES.get(str(slot.value), ()))
    elif is_of_a_part(slot.key):
        yield from _of_a_part(slot, slots)
    elif (group := group_of(slot.key)) is not None:
        yield from _of_a_group(group, slot)
    elif isinstance(slot.value, str):
        if (slot.key, slot.value) == ("traffic", "heavy"):
            yield from _heavy_traffic(slots)
            return
        if (slot.key, slot.value) == ("district", "downtown") and _are_low(slots):
            return  # "a downtown of two to four storeys" has no towers
        if slot.key.endswith(".size"):
            yield from _sized(slot.key.removesuffix(".size"), slot.value, slots)
            return
        if slot.key.endswith(".enclosed"):
            kind = slot.key.removesuffix(".enclosed")
            if may_be_enclosed(kind) and slot.value in BARRIERS:
                yield enclosed_by(kind, slot.value)
            return
        if slot.key.endswith(PLACED) and slot.key not in WORDS:
            yield from _related(slot.key.rpartition(".")[0], slots)
            return
        if slot.key == "building.type" and any((one.key, one.value) in _MAPPED for one in slots):
            told = condition(slot.key, slot.value)  # what stands on a map is what its words name
            yield from (f"n(building, {told}) >= 1" for _ in range(bool(told)))
            return
        counted = [one for one in slots if _is_counted(slot, one, slots)]
        if slot.key == "building.type" and counted:  # so many stand among others
            for one in counted:
                yield from _measured(one.key, float(one.value), slots)
            return
        if slot.key == "building.type" and _has_counted_dwellings(slots):
            told = condition(slot.key, slot.value)  # some stand among those
            yield from (f"n(building, {told}) >= {SEVERAL}" for _ in range(bool(told)))
            return
        if slot.key.endswith((".part", ".by")):
            yield from _of_a_quarter(slot, slots)
            return
        most = EACH if slot.every or _is_of_all(slot) else MOST
        if slot.key == "building.type" and any(".garage.count" in one.key for one in slots):
            most = AMONG_GARAGES
        share = most if sum(one.key == slot.key for one in slots) == 1 else PART
        said = _said(slot.key, slot.value, share)
        if slot.key == "building.feature" and slot.every:  # more than a usual share of them
            said = (_LEAST_SHARE.sub(f">= {EACH}", one) for one in said)
        # What a quarter usually is gives way to numbers for some of its buildings.
        higher = slot.key == "district" and _are_some_higher(slots)
        yield from (one for one in said if not (higher and one.startswith(_OF_ALL_FLOORS)))
    elif ".metres" in slot.key:
        yield from _related(slot.key.partition(".metres")[0], slots)
    else:
        yield from _measured(slot.key, float(slot.value), slots)


def _is_of_all(slot: Slot) -> bool:
    """Return whether a look is told of all buildings: "white walls", but not "mostly white"."""
    return slot.key in _LOOKS_OF_ALL and not slot.mostly


_LEAST_SHARE = re.compile(r">= [0-9.]+$")
_LOOKS_OF_ALL = ("building.material", "building.color", "building.roof", "roof.color")


def is_of_a_part(key: str) -> bool:
    """Return whether a key is of a part of buildings: "mosque.minaret.height.min"."""
    host, part, *_ = (*key.split("."), "", "")
    return host in HOSTS and part in PART_KINDS and key.count(".") > 1


def _of_a_part(slot: Slot, slots: Sequence[Slot]) -> Iterator[str]:
    """Yield what measures a part of buildings: how many, how high, of which colour, material."""
    host, part, said, end, *_ = (*slot.key.split("."), "")
    if isinstance(slot.value, str):
        word = {"color": NAMED_COLORS, "material": MATERIALS}[said].get(slot.value, "")
        told = looks(host, part, said, word) if word else ""
        yield from (told for _ in range(bool(told)))
        return
    value = float(slot.value)
    if said == "count":
        low, high = (int(value) if end in ("", one) else None for one in ("min", "max"))
        yield from counted(host, part, low, high)
        return
    ends = {one.key.rpartition(".")[2]: float(one.value) for one in slots
            if one.key.startswith(f"{host}.{part}.{said}.")}  # fmt: skip
    lowest = ends.get("min", 0.0) if end else value * (1 - WITHIN)
    highest = ends.get("max", _FAR) if end else value * (1 + WITHIN)
    if said == "area" and PART_KINDS[part].plot:
        yield beside_houses(host, part, lowest, highest)
    elif PART_KINDS[part].body:
        yield as_high(host, part, lowest, highest)


def _of_a_group(group: BuildingGroup, slot: Slot) -> Iterator[str]:
    """Yield what measures the buildings of a group, and no others."""
    what = slot.key.removeprefix(f"{group.text}.")
    measure, _, end = what.partition(".")
    if isinstance(slot.value, str):
        told = condition(OF_A_KIND[what], slot.value) if what in OF_A_KIND else ""
        share = MOST if slot.mostly else EACH
        if told:
            yield f"share({group.chosen}, {told}) >= {share}"
    elif measure == "count":
        yield f"n({group.chosen}) {_compared('building.count', float(slot.value), end)}"
    elif measure == "height" and not end:
        yield f"stat({group.chosen}, height, mean) {_around(float(slot.value), WITHIN)}"
    elif measure in ("height", "floors"):
        for one in (end,) if end else ("min", "max"):
            left = f"stat({group.chosen}, {measure}, {one})"
            yield f"{left} {_compared(measure, float(slot.value), one)}"


def _are_some_higher(slots: Sequence[Slot]) -> bool:
    """Return whether storeys are asked that low quarters do not have, or kinds that have more."""
    return any(
        one.key.endswith((".floors", ".floors.min")) and float(one.value) > LOW_FLOORS
        for one in slots
    ) or any(
        KINDS[kind].floors[0] > LOW_FLOORS for kind in quarters_named([slot.key for slot in slots])
    )


def quarters_named(keys: Iterable[str]) -> frozenset[str]:
    """Return the kinds of buildings of which keys say that they stand in some place."""
    placed = {key.rpartition(".")[0] for key in keys if key.endswith((".part", ".by"))}
    groups = {group.kind for group in map(group_of, keys) if group is not None}
    return frozenset((placed | groups) & KINDS.keys())


def _is_counted(kind: Slot, count: Slot, slots: Sequence[Slot]) -> bool:
    """Return whether a slot counts the buildings of a kind, which are no share of all then."""
    base = count.key.removesuffix(".min").removesuffix(".max")
    alone = sum(one.key == "building.type" for one in slots) == 1
    return base == f"{kind.value}.count" or (
        base == "building.count" and alone and kind.value not in DWELLINGS
    )


def _has_counted_dwellings(slots: Sequence[Slot]) -> bool:
    """Return whether houses or flats are counted among the kinds of buildings."""
    counts = tuple(f"{kind}.count" for kind in DWELLINGS)
    return any(slot.key.startswith(counts) for slot in slots)


def _of_a_quarter(slot: Slot, slots: Sequence[Slot]) -> Iterator[str]:
    """Yield what most buildings are in a part of the town, or beside something in it."""
    kind, _, where = slot.key.rpartition(".")
    value = str(slot.value)
    same = {one.key for one in slots if one.key.endswith(f".{where}") and one.value == slot.value}
    share = 1.0 / max(len(same), 1)
    trees = kind == "tree" or kind in SPECIES
    if trees and where == "by" and (value in ELEMENTS or value in PLACES):
        yield row_of_trees(value, "" if kind == "tree" else kind)
    elif kind in KINDS and where == "part" and value in SITE_PARTS:
        yield share_in_part(kind, value, share)
    elif kind in KINDS and where == "by" and is_a_place(value):
        yield share_beside(kind, value, reach_of(value), share)


def _sized(kind: str, size: str, slots: Sequence[Slot]) -> Iterator[str]:
    """Yield that all of an element that are asked for are as large as is said."""
    if kind in ELEMENTS and ELEMENTS[kind].has_size and size in SIZES:
        from cityx.town.lots import size_of  # with shapely

        yield size_of(kind, size, _number_of(kind, slots))


def _number_of(kind: str, slots: Sequence[Slot]) -> int:
    """Return how many of a kind are asked for at least."""
    told = {slot.key: slot.value for slot in slots}
    return max(int(told.get(f"{kind}.count", told.get(f"{kind}.count.min", 1))), 1)


def _related(kind: str, slots: Sequence[Slot]) -> Iterator[str]:
    """Yield where an element stands to another, by the slots that say so together."""
    told = {slot.key: slot.value for slot in slots}
    near = str(told.get(f"{kind}.near", ""))
    second = str(told.get(f"{kind}.second", ""))
    relation = str(told.get(f"{kind}.relation", "near"))
    if relation == "over":
        yield f"crosses({things(kind)}, {things(near)})"
        return
    known = all(word in (*ELEMENTS, *PLACES, *HOMES) for word in (near, second or near))
    if kind in ELEMENTS and known and relation in RELATIONS:
        distance = Distance(*(float(told.get(f"{kind}.metres{end}", 0.0)) for end in _DISTANCE))
        own = ELEMENTS[kind].measure
        yield relation_of(own, near, relation, second, distance, count=_number_of(kind, slots))


_DATE = re.compile(r"(?:0[1-9]|1[0-2])-(?:0[1-9]|[12]\d|3[01])")


def _said(key: str, value: str, share: float) -> Iterator[str]:
    table = WORDS.get(key)
    if key == "time" and ":" in value:
        hours, minutes = map(int, value.split(":"))
        clock = hours + minutes / 60
        yield f"env.hour in [{clock - CLOCK:.4g}, {clock + CLOCK:.4g}]"
    elif key == "date" and _DATE.fullmatch(value):
        month, day = map(int, value.split("-"))
        number = calendar(YEAR, month, min(day, monthrange(YEAR, month)[1])).timetuple().tm_yday
        yield f"env.day in [{number - 1}, {number + 1}]"
    elif table is not None:
        yield from (one.format(v=value) for one in table.get(value, table.get("*", ())))
    elif key.endswith(".height") and value == "tallest":
        kind = key.removesuffix(".height")
        if kind in ELEMENTS and ELEMENTS[kind].building:
            yield taller_than_others(kind)
    elif key.endswith(".height") and value in ("tall", "low"):
        chosen = things(key.removesuffix(".height"))
        bound = f">= {TALL_FLOORS}" if value == "tall" else f"<= {LOW_FLOORS}"
        if chosen.startswith("building, "):
            yield f"stat({chosen}, floors, p50) {bound}"
    elif key.endswith(".walls") and value in WALLS:
        yield built_as(value)
    elif key.endswith(".beacons") and things(key.removesuffix(".beacons")):
        yield f"share({things(key.removesuffix('.beacons'))}, beacons=true) >= {EACH}"
    elif key.endswith(".wears") and things(key.removesuffix(".wears")):
        yield f"share({things(key.removesuffix('.wears'))}, wears={value}) >= {EACH}"
    elif key in _SHARED:
        told = condition(key, value)
        if told:
            yield f"share(building, {told}) >= {share}"
    elif key in ("element", "agent"):
        chosen = things(value)
        if chosen:
            yield "cover(green) >= 0.1" if value == "green" else f"n({chosen}) >= 1"
    elif (look := look_of_kind(key, value))[0]:
        yield f"share({look[0]}, {look[1]}) >= {share}"
    elif key.endswith(".side") and value in RISES:
        chosen = things(key.removesuffix(".side"))
        if chosen.startswith("building, "):
            yield f"stat({chosen}, rise, mean) {RISES[value]}"
    elif key.endswith(".side") and value == "middle" and things(key.removesuffix(".side")):
        yield f"dist({things(key.removesuffix('.side'))}, center) <= {MIDDLE:g}"
    elif key.endswith(".side") and value == "edge" and things(key.removesuffix(".side")):
        yield f"dist({things(key.removesuffix('.side'))}, center) >= {EDGE:g} * min(size.x, size.y)"
    elif key.endswith(".side") and value in SIDES_OF_SKY and things(key.removesuffix(".side")):
        yield f"side({things(key.removesuffix('.side'))}) == {value}"
    elif key.endswith(".width") and things(key.removesuffix(".width")):
        bound = ">= 30" if value == "wide" else "<= 10"
        yield f"stat({things(key.removesuffix('.width'))}, width, mean) {bound}"


def _measured(key: str, value: float, slots: Sequence[Slot]) -> Iterator[str]:
    end = key.rpartition(".")[2] if key.endswith((".min", ".max")) else ""
    base = key.removesuffix(f".{end}") if end else key
    if base in _LANES:
        yield _LANES[base].format(v=value, half=(value + 1) // 2)
        return
    if base in ("size.x", "size.y") and any(slot.key == "source" for slot in slots):
        end = end or "min"  # of a map, the buildings that the border of a window cuts stay whole
    if base == "blocks.floors":
        ends = {one.key.rpartition(".")[2]: one.value for one in slots if one.key.startswith(base)}
        low, high = ends.get("min", 1), ends.get("max", _FAR)
        within = f"floors in [{low:g}, {high:g}]"
        yield f"near(block, building, {within}, within=1) >= 0.3 * n(block)"
        return
    mixed = things(base.removesuffix(".share")).replace("bus", "vehicle, type=bus")
    if base == "windows.lit":
        yield f"env.windows in [{max(value - LIT, 0.0):.4g}, {min(value + LIT, 1.0):.4g}]"
        return
    if base.endswith(".share") and mixed.startswith("vehicle, "):
        low, high = (0.0 if end == "max" else value - MIX), (1.0 if end == "min" else value + MIX)
        yield f"share(traffic, {mixed.partition(', ')[2]}) in [{max(low, 0.0):.4g}, {high:.4g}]"
        return
    if base.endswith(".share") and mixed.startswith("pedestrian, "):
        low = 0.0 if end == "max" else value * (1.0 - AMONG)
        high = 1.0 if end == "min" else min(value * (1.0 + AMONG), 1.0)
        yield f"share(pedestrian, {mixed.partition(', ')[2]}) in [{low:.4g}, {high:.4g}]"
        return
    if base == "house.count":  # the villas and cottages beside them are houses, too
        also = tuple(f"{kind}.count{key.removeprefix(base)}" for kind in HOUSES)
        value += sum(float(slot.value) for slot in slots if slot.key in also)
    kind, _, measure = base.rpartition(".")
    if measure in _SIDES_OF_THINGS and (kind in ELEMENTS or kind in OTHER_THINGS):
        yield from _size_of_thing(kind, measure, value, end, slots)
        return
    left = _left(base, end, slots)
    if left:
        yield f"{left} {_compared(base, value, end)}"


def _size_of_thing(
    kind: str, measure: str, value: float, end: str, slots: Sequence[Slot]
) -> Iterator[str]:  # fmt: skip
    """Yield how high, long or wide an element or another thing is, where it can be that."""
    if measure not in attributes_of(kind):
        return
    element = ELEMENTS.get(kind)
    sides = measure != "height" and element is not None and not element.builder
    chosen = element.measure if sides and element is not None else looked_at(kind)
    if sides and not end:
        yield measures(chosen, measure, value, value, _number_of(kind, slots))
        return
    yield f"stat({chosen}, {measure}, {_FUNCTIONS[end]}) {_compared(measure, value, end)}"


def _left(base: str, end: str, slots: Sequence[Slot]) -> str:
    """Return what is measured for a key, "" where nothing does."""
    if base in NUMBERS:
        return NUMBERS[base].format(f=_FUNCTIONS[end])
    if base == "building.count":
        kinds = [str(slot.value) for slot in slots if slot.key == "building.type"]
        told = condition("building.type", kinds[0]) if len(kinds) == 1 else ""
        return f"n(building, {told})" if told else "n(building)"
    kind, _, measure = base.rpartition(".")
    if measure == "share":
        told = condition("building.material", kind) or condition("building.type", kind)
        return f"share(building, {told})" if told else ""
    chosen = things(kind)
    if not chosen:
        return ""
    if measure == "count":
        return f"n({chosen})"
    return f"stat({chosen}, {measure}, {_FUNCTIONS[end]})" if _has(chosen, measure) else ""


def _has(chosen: str, measure: str) -> bool:
    """Return whether things of a kind have a measure."""
    if measure not in _MEASURES:
        return False
    kind = chosen.partition(",")[0]
    if kind in ("vehicle", "bus", "pedestrian"):
        return measure == "speed"
    if kind == "building":
        return measure in ("height", "floors", "area")
    if kind in ("city_wall", "power_line"):
        return measure in ("height", "length")
    if kind in ("tree", "streetlight", "bench", "fountain", "statue"):
        return measure == "height"
    if kind in ("road", "bridge", "path", "railway", "block"):
        return measure in ("width", "length") or (measure == "speed" and kind == "road")
    if kind in ("dead_end", "junction", "crosswalk", "road_works", "scaffolding", "steps", "ramp"):
        return False
    return measure in ("area", "width")


def _compared(base: str, value: float, end: str) -> str:
    size = base.startswith("size.")
    if end == "min":
        return f">= {value * (1 - (WITHIN_SIZE if size else 0)):.8g}"
    if base == "roads.turn":
        return f"in [{value - TURN:g}, {value + TURN:g}]"
    if end == "max":
        return f"<= {value * (1 + (WITHIN_SIZE if size else 0)):.8g}"
    if base.rpartition(".")[2] in _COUNTS:
        return f"== {value:g}"
    return _around(value, WITHIN_SIZE if base in ("size.x", "size.y") else WITHIN)


def _around(value: float, slack: float) -> str:
    return f"in [{value * (1 - slack):.8g}, {value * (1 + slack):.8g}]"


def _absent(what: str) -> Iterator[str]:
    chosen = things(what)
    key, _, look = what.partition("=")
    if look:  # of buildings, or of those of a kind
        told = condition(key, look)
        which, told = ("building", told) if told else look_of_kind(key, look)
        yield from (f"share({which}, {told}) == 0" for _ in range(bool(told)))
    elif what in _WEATHERS:
        yield f"env.weather != {what}"
    elif what in WORDS["terrain"] and what != "flat":  # roofs are denied so, too
        yield f"terrain.form != {what}"
    elif condition("style", what):
        yield f"share(building, style={what}) == 0"
    elif condition("building.material", what):
        yield f"share(building, {condition('building.material', what)}) == 0"
    elif what == "water":
        yield "cover(water) == 0"
    elif chosen:
        yield f"n({chosen}) == 0"


# -- edits ---------------------------------------------------------------------------------------


def edit_predicates(edit: Edit) -> Iterator[str]:
    """Yield what measures a change, as far as its words alone say which objects it means."""
    if edit.target is not None:
        for chosen in _chosen(edit.target):
            yield from target_predicates(edit, chosen)
    elif edit.verb in ("add_agent", "add_traffic"):
        yield from _agent_predicates(edit)
    elif edit.verb == "plant":
        species = dict(edit.change).get("species")
        yield _gained(f"tree, species={species}" if species in SPECIES else "tree", edit)
        spacing = dict(edit.change).get("spacing")
        if spacing is not None:
            yield f"spacing(tree, road) {_around(float(spacing), WITHIN)}"
    elif edit.verb in _NEW_WAYS:
        yield f"gained({_NEW_WAYS[edit.verb]}) >= 1"
        surface = dict(edit.change).get("surface")
        if surface is not None:
            yield f"gained(path, surface={surface}) >= 1"
    elif edit.verb in ("add", "add_building"):
        change = dict(edit.change)
        word = str(change.get("element") or change.get("building.type") or "building")
        chosen = word if word in _LINES else things(word)
        if chosen:
            yield _gained(chosen, edit)
    else:
        for key, value in edit.change:
            if not isinstance(value, str):
                yield from _measured(key, float(value), ())
                continue
            yield from _said(_full(key), value, MOST)


_LINES = ("hedge",)  # of a new town a shrub, and a line where one is put along something
_NEW_WAYS = {"add_path": "path", "add_bridge": "bridge"}


def _gained(chosen: str, edit: Edit) -> str:
    """Return how many more things of a kind there must be: as many as asked for, else some."""
    change = dict(edit.change)
    count = change.get("count")
    if count is None or "each" in change:  # at each of several places
        return f"gained({chosen}) >= {count or 1}"
    return f"gained({chosen}) == {count}"


def _full(key: str) -> str:
    """Return the slot that an edit of the whole city sets."""
    return f"building.{key}" if key in ("material", "color", "roof") else key


def quoted(name: str) -> str:
    """Return a name as predicates write it: in quotes where it is more than a word."""
    plain = name.replace("_", "a").isalnum() and not name[:1].isdigit()
    return name if plain else _in_quotes(name)


def _in_quotes(name: str) -> str:
    escaped = name.replace("\\", "\\\\").replace('"', '\\"')
    return f'"{escaped}"'


def _chosen(target: Selector) -> Iterator[str]:
    """Return a target as choices of things; none where predicates cannot choose it."""
    if target.ids:
        yield from map(quoted, target.ids)
        return
    kind = things(target.kind)
    conditions = _conditions(target.filters)
    placed = bool(target.near or target.inside or target.along or target.side)
    placed |= bool(target.where or target.but)
    if not kind or placed or target.nth or not all(conditions):
        return
    chosen = ", ".join([kind, *conditions])
    if target.rank == "tallest":
        yield f"top({chosen}, height, {target.k or 1})"
    elif not target.rank and not target.k:
        yield chosen


def _conditions(filters: Sequence[str]) -> list[str]:
    """Return filters as conditions, those that bound one measure from both sides as one."""
    low, high = (
        {text.partition(sign)[0]: text.partition(sign)[2] for text in filters if sign in text}
        for sign in "><"
    )
    both = [name for name in low if name in high and name in _BOUNDED]
    return [
        *(f"{name} in [{low[name]}, {high[name]}]" for name in both),
        *(condition_of(text) for text in filters if re.split("[<>]", text)[0] not in both),
    ]


_BOUNDED = ("height", "floors", "area")  # measures of buildings of which filters have bounds


def condition_of(text: str) -> str:
    """Return a filter of a selector as a condition of predicates, "" where none says it."""
    for sign, span in ((">", "{0} in [{1}, {2:g}]"), ("<", "{0} in [0, {1}]")):
        name, found, value = text.partition(sign)
        if found:
            return span.format(name, value, _FAR) if name in _BOUNDED else ""
    name, _, value = text.partition("=")
    if name.endswith("!"):
        told = condition(name[:-1], value)
        return told.replace("=", "!=") if "=" in told and "," not in told else ""
    if name in ("floors", "species"):
        return f"{name}={value}"
    return condition(name, value)


def target_predicates(edit: Edit, chosen: str) -> Iterator[str]:
    """Yield what measures a change of some things, as predicates choose them."""
    target = edit.target
    assert target is not None
    change = dict(edit.change)
    measure = edit.verb.partition("_")[2]
    part, color = str(change.get("part", "")), str(change.get("color", ""))
    if "id=" not in chosen and (edit.verb == "rename" or (edit.verb == "replace"
                                                          and "species" in change)):  # fmt: skip
        return  # told by ids, as nothing is called so any more, or no tree is of the kind
    if part:
        told = PARTS_OF.get(part, part)
        if told in PARTS and edit.verb == "remove":
            yield f"n({chosen}, has={told}) == 0"
        elif told in PARTS and edit.verb == "add_parts":
            part_of_all = PAINTED_SHARE * (1.0 if target.share is None else target.share)
            sparse = told == "awning"  # over shopfronts alone
            yield (
                f"n({chosen}, has={told}) >= 1"
                if sparse
                else (f"share({chosen}, has={told}) >= {part_of_all:g}")
            )
        if color and edit.verb == "add_parts" and told in PAINTED:
            yield f"n({chosen}, {told}_color={NAMED_COLORS.get(color, color)}) >= 1"
        elif color and told in PAINTED and condition("building.color", color):
            yield f"share({chosen}, {told}_color={NAMED_COLORS[color]}) >= {PAINTED_SHARE}"
        return
    if edit.verb == "remove" and target.share is None:
        yield f"n(building, id={chosen}) == 0" if target.ids else f"n({chosen}) == 0"
    elif edit.verb.startswith("scale_") and "factor" in change and _has(chosen, measure):
        yield f"ratio({chosen}, {measure}) {_around(float(change['factor']), WITHIN_SIZE)}"
    elif edit.verb in ("set_material", "set_color", "set_style", "set_roof", "replace"):
        yield from _look_predicates(edit, chosen)
    elif any(text.startswith((f"{measure}<", f"{measure}>")) for text in target.filters):
        return  # what was above a bound is so no longer; see `goals_here`
    elif edit.verb in ("set_height", "set_floors", "set_width"):
        for key, value in edit.change:
            end = key.partition(".")[2]
            left = f"stat({chosen}, {measure}, {_FUNCTIONS[end]})"
            yield f"{left} {_compared(measure, float(value), end)}"
    elif edit.verb == "set_walks":
        for key, value in edit.change:
            least = float(value) - SAMPLED
            end = "min" if key.endswith(".min") else "p50"
            yield f"stat({chosen}, walk, {end}) >= {least:.4g}"
    elif edit.verb in _OF_STREETS and (told := _OF_STREETS[edit.verb].get(_word_of(change), "")):
        yield told.format(c=chosen)
    elif edit.verb == "set_speed":
        limit = float(change["speed_kmh"]) / KMH
        yield f"stat({chosen}, speed, mean) {_around(limit, WITHIN_SIZE)}"
    else:
        yield f"changed({chosen})"


SAMPLED = 0.2  # metres by which walks are measured across a street
KMH = 3.6  # kilometres per hour, of a metre per second
# What becomes of streets -> the word of the change -> what it is measured by.
_OF_STREETS: Mapping[str, Mapping[str, str]] = {
    "set_direction": {"along": "share({c}, oneway=true) == 1.0",
                      "both": "share({c}, oneway=true) == 0.0"},
    "set_parking": {"none": "share({c}, parking=none) == 1.0",
                    "both": "share({c}, parking=both) == 1.0"},
    "set_cycling": {"none": "share({c}, cycling=none) == 1.0",
                    "both": "share({c}, cycling=both) == 1.0"},
}  # fmt: skip


def _word_of(change: Mapping[str, Value]) -> str:
    return next((str(value) for value in change.values()), "")


def _look_predicates(edit: Edit, chosen: str) -> Iterator[str]:
    """Yield what share of the chosen buildings must look as asked."""
    share = edit.target.share if edit.target is not None else None
    told = [
        f"floors={value:g}" if not isinstance(value, str) else condition(_full(key), value)
        for key, value in edit.change
        if key != "building.height"
    ]
    terms = ", ".join(term for term in told if term)
    filters = edit.target.filters if edit.target is not None else ()
    filtered, about = bool(filters), [text.partition("=")[0].strip("!") for text in filters]
    if any(key in about for key, _ in edit.change):
        return  # what was red is blue then; see `cityx.language.references.goals_here`
    if not terms and dict(edit.change).get("element"):
        return  # those that go are known by their ids
    if not terms or (filtered and edit.verb in ("replace", "set_material")):
        kind = chosen.removeprefix("top(").partition(",")[0]
        yield f"changed({kind})"  # the filter or the rank no longer holds afterwards
    elif share is None and any("=" in text for text in filters):  # the flat roofs, not all roofs
        yield f"n({chosen}, {terms}) == n({chosen})"
    elif share is None:
        yield f"share({chosen}, {terms}) == 1.0"
    else:
        low, high = share - AROUND_SHARE, share + AROUND_SHARE
        yield f"share({chosen}, {terms}) in [{low:.4g}, {high:.4g}]"


def _spot(change: Mapping[str, Value], key: str, attribute: str = "") -> str:
    """Return where people or vehicles of a change are, or go, as a condition."""
    chosen = things(str(change.get(key, "")))
    if not chosen:
        return ""
    return f", {attribute or key}={chosen if ',' not in chosen else _in_quotes(chosen)}"


def _agent_predicates(edit: Edit) -> Iterator[str]:
    change = dict(edit.change)
    kind = things(str(change.get("agent", "vehicle")))
    if not kind:
        return
    place = things(str(change.get("path", "")))
    where = _spot(change, "path", "on") if kind.startswith(("vehicle", "bus")) else ""
    who = things(str(change.get("who", "")))
    kind = who if who and change.get("who") not in ("man", "woman") else kind
    mode = _MODES.get(str(change.get("mode", "")), "") if kind.startswith("pedestrian") else ""
    mode = "" if mode in kind else mode
    spot = str(change.get("at", ""))
    at = _spot(change, "at")
    if "to" in change or "from" in change:
        where = ""
        at += f"{_spot(change, 'to')}{_spot(change, 'from')}"
        mode = "" if "walk" in mode else mode  # who waits to cross stands
    at += f", wears={change['wears']}" if "wears" in change else ""
    if change.get("mode") == "queue":  # the first of it is at the place
        yield _gained(f"{kind}, moves=false", edit)
        yield from [f"gained({kind}{at}) >= 1"] if at else []
        return
    if "each" in change and at:
        yield f"gained({kind}{mode}{at}) == {change.get('count', 1)} * n({spot})"
        return
    yield _gained(f"{kind}{mode}{at}", edit)
    if where:
        yield f"n({kind}{where}) >= 1"
    if "speed" in change:
        told = f"{kind}{where}, speed, mean"
        if kind.startswith("pedestrian"):  # some wait to cross
            told = f"{kind}{at}, speed, p50"
        yield f"stat({told}) {_around(float(change['speed']), WITHIN)}"
    if kind.startswith("pedestrian") and place and "," not in place:
        yield f"follows(pedestrian, {place}, dev=0.5)"
