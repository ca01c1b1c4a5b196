"""Quantities: numbers with units become slots of what they measure."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from itertools import pairwise

from cityx.language.brief import Note
from cityx.language.counts import is_whole, read_counts
from cityx.language.here import (
    BUILDINGS,
    PLOTS,
    ROADS,
    Here,
    is_of_a_town,
)
from cityx.language.lengths import (
    WHOLE,
    add_of_each,
    is_a_side,
    is_difference,
    is_green,
    is_of_the_list,
    is_site,
    mark,
    of_all,
    read_lengths,
    read_pairs,
    read_slope,
    thing_past_comma,
)
from cityx.language.life_words import goes_at
from cityx.language.relations import has_own_looks
from cityx.language.restrictions import ABOUT, OF_A_PART, is_set_apart
from cityx.language.scan import ENDS, Item, Quantity
from cityx.language.scopes import READ
from cityx.language.syntax import is_plural, is_unknown

_HIGHER = ("higher", "taller", "lower", "more", "less", "fewer", "shorter")
_OF_THINGS = ("length", "pair", "area", "floors", "lanes", "share", "part")
_NOT_MEASURED = ("crane", "flying", "light", "sky")
_BUILT = ("built", "coverage", "covered")
_RATIOS = ("ratio", "far", "fsi")
_MEANS = ("mean", "average", "averaging", "on average")
_OTHERS = ("other", "others", "rest", "the rest", "rest of", "the rest of", "some", "most")
_MEASURES = ("height", "width", "length")
NOON = 720  # minutes
_BEHIND_LANES = 3  # items between "two lanes" and "in each direction"


def read_quantity(here: Here) -> None:
    """Add the slots that a quantity says."""
    rule = _RULES.get(here.quantity.dimension) if here.item.quantity is not None else None
    if rule is None or _mean_or_ratio(here):
        return
    if here.quantity.dimension in ("share", "part") and _built_share(here):
        return
    about = _of_something_else(here)
    if about:
        here.found.leave(here.item, about)
    else:
        rule(here)


def _mean_or_ratio(here: Here) -> bool:
    """Read "a plot ratio of | 1.5", "a mean height of | four floors" and "| 18 m on average"."""
    dimension = here.quantity.dimension
    near = [*here.items[max(0, here.at - 4) : here.at], *here.items[here.at + 1 : here.at + 3]]
    if dimension == "count":
        read = [one for one in near[:4] if one.text in _RATIOS or one.text in ("floor", "area")]
        named = any(one.text in ("far", "fsi") for one in read) or _is_plot_ratio(near)
        if named:
            plots = [one for one in near if one.text in ("plot", "space", "floor space")]
            here.found.add_bounded("plot.ratio", here.quantity, here.item, *read, *plots)
        return named
    told = next((one for one in near if one.text in _MEANS), None)
    if told is None or dimension not in ("floors", "length"):
        return False
    if dimension == "length" and here.quantity.attribute not in ("height", ""):
        return False
    noun = here.noun()
    heights = [one for one in near if one.get("attr") == "height" or one.text == "heights"]
    high = dimension == "floors" or here.quantity.attribute == "height" or bool(heights)
    if not high or (noun is not None and noun.noun_class not in ("building", "place")):
        return False
    key = "floors.mean" if dimension == "floors" else "height.mean"
    here.found.add_bounded(key, here.quantity, here.item, told, *heights)
    return True


def _built_share(here: Here) -> bool:
    """Read "45 % built" and "40 % of the land built on"."""
    behind = here.items[here.at + 1 : here.at + 6]
    built = next((one for one in behind if one.words and one.words[0] in _BUILT), None)
    if built is None:
        return False
    between = behind[: behind.index(built)]
    plain = all(
        one.noun in WHOLE or one.text in ("ground", "area", "site", "is", "are")
        or one.kind == "function" or one.get("rel") in ("of", "be")
        for one in between
    )  # fmt: skip
    after = here.items[here.at + 1 + len(between) + 1 :][:1]
    if not plain or (after and after[0].noun):  # "40 % built houses"
        return False
    on = [one for one in after if one.text in ("on", "up", "over")]
    here.found.add_bounded("building.share", here.quantity, here.item, built, *on)
    return True


def _is_plot_ratio(near: list[Item]) -> bool:
    """Return whether words say a plot ratio: "plot ratio", "floor area ratio"."""
    words = {word for one in near for word in one.words}
    return "ratio" in words and bool(words & {"plot", "floor", "far", "site"})


def _of_something_else(here: Here) -> str:
    """Return what a measure is of when the book has no measure for that, "" otherwise."""
    dimension = here.quantity.dimension
    if dimension not in _OF_THINGS or _is_of_anything(here):
        return ""
    bounded = here.quantity.exact is None or bool(here.quantity.attribute)
    told = here.item.words[0].startswith(_MEASURES)  # "heights up to 20 m"
    if dimension == "floors" and any(
        one.get("rel") in ("around", "near") and after.get("rel") == "it"
        for one, after in pairwise(here.before_in_clause())
    ):
        return "of what is by another thing"  # "everything around them | at most five floors"
    owner = here.owner(past_comma=not told and (dimension in ("floors", "lanes") or bounded))
    begins = here.before is not None and here.before.is_mark(":")
    begins = begins and (
        dimension in ("length", "pair", "area") or (dimension == "floors" and _is_for(here, owner))
    )
    if owner is None or (begins and here.noun_behind() is None and not owner.noun):
        return ""  # "for a class: | 600 m x 600 m"
    said = here.found.said(owner)
    if here.is_another_kind(owner) or owner.noun in _NOT_MEASURED:
        return f"of the {said}"
    if is_unknown(owner) or (owner.has("slot") and not owner.noun and not is_whole(owner)):
        return f"of the {said}"
    if dimension not in ("share", "part") and _of_a_part(here):
        return OF_A_PART
    return ""


def _is_for(here: Here, owner: Item | None) -> bool:
    """Return whether something is what a town is for: "a town for a | novel: two floors"."""
    first = 0 if owner is None else here.syntax.index(here.phrase_of(owner)[0])
    before = here.items[:first]
    return bool(before) and before[-1].text == "for" and any(is_of_a_town(one) for one in before)


def _is_of_anything(here: Here) -> bool:
    """Return whether a bound is of every building: "nothing | above six floors"."""
    before = here.before
    storeys = here.quantity.dimension == "floors" and here.quantity.exact is None
    if not storeys or before is None or here.at < 1:
        return False
    link = here.items[here.at - 2] if here.at > 1 else None
    of = link is not None and (link.has("rel") or link.kind == "function")
    chosen = before.text == "anything" and of  # "tanks on | anything over six floors"
    return before.text in ("nothing", "none", "anything") and not chosen


def _of_a_part(here: Here) -> bool:
    """Return whether a measure is of some of its things: "a third of them | 15 m"."""
    head = here.syntax.head_before(here.at)
    named = here.items[head].span if head >= 0 else (0, 0)
    if any(one.text in ("rest", "the rest", "the others") for one in here.before_in_clause()):
        return True
    return any(
        (one.text in _OTHERS and one.span > named)
        or (one.quantity is not None and one.quantity.dimension in ("part", "share"))
        for one in here.before_in_clause()
    )  # fmt: skip


def _is_of_a_place(here: Here) -> bool:
    """Return whether "of" joins a number to a place: "down the middle of | at least one lane"."""
    place = here.items[here.at - 2] if here.at > 1 else here.item
    of = here.before is not None and here.before.get("rel") == "of"
    return of and (place.noun_class == "place" or place.has("side", "attr"))


def _floors(here: Here) -> None:
    """Read storeys of buildings; those of a single one among others are left open."""
    if _is_of_anything(here):
        assert here.before is not None
        if is_set_apart(here):
            here.found.leave(here.item, ABOUT)
            return
        here.found.add_bounded("building.floors", here.quantity, here.item, here.before)
        return
    if here.before is not None and here.before.text == "anything":
        here.found.leave(here.item, ABOUT)  # "tanks on anything | over six floors"
        return
    higher = here.item.words[-1] in _HIGHER and "or" not in here.item.words
    if higher or is_difference(here):
        here.found.leave(here.item, "by how much two things differ")  # "| two storeys higher"
        return
    owner = here.owner() or thing_past_comma(here) or here.buildings_before(past_end=False)
    if owner is not None and is_of_the_list(here, owner):
        here.found.add_bounded("building.floors", here.quantity, here.item)
        return
    own = owner is not None and (has_own_looks(here, owner) or _is_alone_of_a_kind(here, owner))
    if owner is not None and own:
        if here.has_looks(owner):
            here.found.add_bounded(f"{owner.noun}.floors", here.quantity, here.item)
        else:
            here.found.leave(here.item, f"floors of the {here.found.said(owner)}")
    else:
        noun = here.noun()
        key = noun.noun if noun is not None and of_all(here, noun) else "building"
        if is_set_apart(here):
            here.found.leave(here.item, ABOUT)
            return
        add_of_each(here, f"{key}.floors", here.quantity)


def _is_alone_of_a_kind(here: Here, owner: Item) -> bool:
    """Return whether storeys are those of one kind: "a row of hotels | 8 to 12 storeys"."""
    first = here.syntax.index(here.phrase_of(owner)[0])
    link = here.items[first - 1] if first else None
    listed = link is not None and (link.get("rel") in ("and", "or") or link.is_mark(","))
    return here.of_a_kind(owner) and not listed


def _lanes(here: Here) -> None:
    """Read lanes; "in each direction" doubles them."""
    both = 1.0
    for other in here.items[here.at + 1 : here.at + 1 + _BEHIND_LANES]:
        if other.is_mark(ENDS) or other.quantity is not None:
            break
        if other.get("rel") == "direction" or other.get("attr") == "side":
            both = 2.0
            other.state = READ
            break
    low, high = (
        None if end is None else end * both for end in (here.quantity.low, here.quantity.high)
    )
    noun = here.noun()
    after = None if here.after is None else here.after.quantity
    if after is not None and after.dimension == "length":
        here.found.leave(here.item, "lanes with a measure")
        return
    if noun is None and here.quantity.low == 1 and (here.quantity.exact or _is_of_a_place(here)):
        here.found.leave(here.item, "one of the lanes")
        return
    if noun is not None and noun.noun_class not in ("road", "building", "place"):
        here.found.leave(here.item, f"lanes of the {noun.noun}")
        return
    if noun is None and (last := here.last_noun()) is not None and last.noun in ROADS:
        noun = last  # "an avenue with a tram, | two lanes each way"
    elif noun is None:
        roads = [one for one in here.items[: here.at] if one.noun in ROADS and one.noun != "road"]
        noun = roads[-1] if roads else None
    key = ROADS.get(noun.noun, "roads") if noun is not None else "roads"
    if noun is not None and noun.noun == "road" and here.is_a_single(noun):
        key = ROADS["main_street"]  # "a four-lane road" is the widest there is
    mark(noun)
    here.found.add_bounded(f"{key}.lanes", Quantity("lanes", low, high), here.item)


def _areas(here: Here) -> None:
    noun = here.noun_behind()
    if noun is None and here.before is not None and here.before.get("rel") == "of":
        noun = here.noun_before()
    if noun is None and here.before is not None and here.before.text == "each":
        noun = here.element_before()
    plots = [one for one in here.items[max(0, here.at - 2) : here.at + 2] if one.words]
    own = any(one.text in ("own", "each", "every") for one in here.items[max(0, here.at - 4) :][:4])
    if any(one.words[-1] in PLOTS and (own or is_plural(one.words[-1])) for one in plots):
        here.found.leave(here.item, "area of each plot")
        return
    near = [one.text for one in here.clause()]
    if noun is None and not {"each", "every", "apiece", "per"}.isdisjoint(near):
        here.found.leave(here.item, "area of each")
        return
    if any(one.text in ("ones", "those") for one in here.items[max(0, here.at - 4) : here.at]):
        here.found.leave(here.item, "area of some of them")
        return
    own = noun is not None and noun.noun_class == "element"
    on = here.before is not None and here.before.get("rel") in ("on", "in")  # "villas on | 5 ha"
    owner = None if on else here.owner()
    if owner is not None and not own and not is_site(here, owner):
        here.found.leave(here.item, f"area of the {here.found.said(owner)}")
        return
    key = f"{noun.noun}.area" if own and noun is not None else "size.area"
    value = here.quantity.exact
    if value is None:
        here.found.add_bounded(key, here.quantity, here.item)
    elif value >= 1.0:
        here.found.add(key, round(value), here.item)


def _shares(here: Here) -> None:
    """Read a percentage: of green ground, of a slope, or of the buildings."""
    clause = here.clause()
    head = here.noun_behind()
    of_buildings = head is not None and (head.noun_class in BUILDINGS or head.noun == "roof")
    parts = any(one.noun in ("roof", "facade", "window") for one in clause)
    green = None if of_buildings or parts else next(filter(is_green, clause), None)
    sloping = any(
        one.get("attr") == "slope" or one.noun == "ramp" or one.text in ("ramp", "incline")
        for one in clause
    )
    if any(one.has("side") for one in here.phrase_of(here.item)) or is_a_side(here):
        here.found.leave(here.item, "a part of the site")
    elif _is_turned_into(here):
        here.found.leave(here.item, "of which something else is made")
        for one in clause:
            if one.has("color", "material") and one.span > here.item.span:
                here.found.leave(one, OF_A_PART)
    elif here.quantity.attribute == "slope" or sloping:
        read_slope(here)
    elif green is not None:
        here.found.add_bounded("green.share", here.quantity, here.item, green)
    else:
        _share_of_buildings(here)


def _is_turned_into(here: Here) -> bool:
    """Return whether a part is made to something else: "turn | a quarter of the green into"."""
    clause = here.clause()
    made = any(one.get("verb") in ("MAKE", "REPLACE") for one in here.before_in_clause())
    behind = [one for one in clause if one.span > here.item.span]
    return made and any(one.text in ("into", "to", "with") for one in behind)


def _share_of_buildings(here: Here) -> None:
    """Read "half of the houses of brick"; what else is said of a part is left open."""
    clause = here.clause()
    behind = _to_the_others([one for one in clause if one.span > here.item.span])
    look = next((one for one in behind if one.has("material")), None)
    told = [one for one in behind if one.has("color") or one.get("slot").startswith("building.")]
    for one in told:
        here.found.leave(one, OF_A_PART)
    kinds = [one for one in (*behind, *clause) if one.noun_class == "type" and one.text != "flat"]
    named = look or (kinds[0] if kinds and not told else None)
    if named is not None and named.noun_class == "type" and _something_is_said(here, named):
        here.found.leave(here.item, "of whom something is said")  # "half the shops are closed"
        return
    if named is not None:
        value = named.get("material") or named.noun
        here.found.add_bounded(f"{value}.share", here.quantity, here.item, named)


def _something_is_said(here: Here, kind: Item) -> bool:
    """Return whether a state is told of a kind: "half the shops | are closed"."""
    behind = here.items[here.syntax.index(kind) + 1 :][:2]
    be = bool(behind) and behind[0].get("rel") == "be"
    state = behind[1] if len(behind) > 1 else None
    return be and state is not None and (state.kind == "unknown" or state.has("neg", "verb"))


def _to_the_others(items: list[Item]) -> list[Item]:
    """Return the items before those that tell of the others: "half are white | and the rest"."""
    rest = (at for at, one in enumerate(items) if one.text in ("rest", *_OTHERS))
    return items[: next(rest, len(items))]


_OF_ITS_OWN = ("main_street", "avenue", "ring_road", "side_street", "motorway")


def _speeds(here: Here) -> None:
    noun = here.noun()
    everywhere = here.after is not None and here.after.text in ("everywhere", "throughout", "zone")
    if noun is None and everywhere and here.after is not None:
        here.found.add_bounded("roads.speed", here.quantity, here.item, here.after)
        return
    if noun is None and not any(_moves(item) for item in here.clause()):
        here.found.leave(here.item, "speed of what is not said")  # "a wind of | 12 m/s"
        return
    of = goes_at(here, noun)
    if here.found.has(f"{of}.share"):
        here.found.leave(here.item, f"speed of a part of them, {of}")
        return
    of = of or ("roads" if noun is not None and noun.noun_class == "road" else "vehicle")
    of = "roads" if "limit" in here.item.words else of
    own = [one for one in here.before_in_clause() if one.noun_class == "road"][-1:]
    if of == "roads" and own and own[0].noun in _OF_ITS_OWN:
        here.found.leave(here.item, f"speed on the {own[0].text} alone")
        return
    quantity = here.quantity
    if quantity.exact is not None and any(one.has("keep") for one in here.before_in_clause()[-3:]):
        quantity = replace(quantity, low=None)  # "traffic keeps to | 20 mph"
    here.found.add_bounded(f"{of}.speed", quantity, here.item)


def _moves(item: Item) -> bool:
    """Return whether an item speaks of what moves, or of a limit of its speed."""
    moving = item.noun_class in ("vehicle", "person", "road")
    traffic = "traffic=" in item.get("slot") or item.get("attr") == "speed"
    return moving or traffic or "limit" in item.words or item.has("mode", "verb")


def _is_a_limit(here: Here) -> bool:
    """Return whether an hour says until, from or between when something holds."""
    before = here.before
    return before is not None and (
        before.text in ("until", "till", "before", "after", "from", "since")
        or any(one.text in ("between", "from") for one in here.before_in_clause()[-3:])
    )


def _hours(here: Here) -> None:
    if _is_a_limit(here) or here.quantity.exact is None:
        here.found.leave(here.item, "when something begins or ends")
        return
    minutes = round((here.quantity.low or 0.0) * 60)
    told = any(one.get("slot").startswith("time=") for one in here.items)
    if here.item.words[0] in ("half", "quarter") and minutes > NOON and not told:
        said = f'"{here.found.said(here.item)}" was read as {minutes // 60}:{minutes % 60:02d}.'
        here.found.notes.append(Note("hour", said, here.item.span))
    here.found.add("time", f"{minutes // 60 % 24:02d}:{minutes % 60:02d}", here.item)


def _bounds_of(key: str) -> Callable[[Here], None]:
    """Return a rule for a dimension that measures one thing only."""

    def rule(here: Here) -> None:
        here.found.add_bounded(key, here.quantity, here.item)

    return rule


_RULES: Mapping[str, Callable[[Here], None]] = {
    "count": read_counts, "floors": _floors, "lanes": _lanes,
    "length": read_lengths, "pair": read_pairs, "area": _areas, "share": _shares, "part": _shares,
    "speed": _speeds, "hour": _hours, "temperature": _bounds_of("temperature"),
    "people": _bounds_of("population"),
}  # fmt: skip
