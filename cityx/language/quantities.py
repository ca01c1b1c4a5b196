"""Quantities: numbers with units become slots of what they measure."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from itertools import pairwise

from cityx.language.brief import Note
from cityx.language.distances import read_distance
from cityx.language.here import (
    AIR,
    BUILDINGS,
    COUNTED,
    FEW,
    KINDS_OF_PEOPLE,
    LANDMARKS,
    PLOTS,
    ROADS,
    ROLES,
    Here,
    is_of_a_town,
)
from cityx.language.life_words import goes_at
from cityx.language.relations import are_of_some, has_own_looks, stands_in_a_part
from cityx.language.restrictions import ABOUT, OF_A_PART, is_set_apart
from cityx.language.scan import ENDS, Item, Quantity, begin_of
from cityx.language.scopes import READ
from cityx.language.syntax import is_plural, is_unknown
from cityx.language.things import is_species
from cityx.town.elements import ELEMENTS, PLACES
from cityx.town.quarter_kinds import COUNTED_KINDS

_HIGHER = ("higher", "taller", "lower", "more", "less", "fewer", "shorter")
_GREEN = ("green", "park", "garden", "forest", "lawn")
_WHOLE = ("city", "landscape", "everything")
_SITES = ("site", "map area", "total area", "extent", "layout size", "whole scene", "map")
_SIDES = {"width": ("size.x",), "length": ("size.y",)}
# Words behind a number of which something else is counted.
_GROUPS = (
    "kinds", "kind", "types", "sorts", "sizes", "ranks", "rows", "row", "groups", "group", "lines",
    "clusters", "pairs", "sets",
)  # fmt: skip
# Quantities that are of a thing, and words about a whole city.
_ONE_ALONE = ("sea", "water", "green", "traffic")  # what nobody counts
_OF_THINGS = ("length", "pair", "area", "floors", "lanes", "share", "part")
_FROM = ("away", "from", "off", "above", "below", "behind", "beyond", "over", "under")
_ANIMALS = ("dog",)
_LIVING = ("vehicle", "person", "plant")  # classes of what no length across is of
_ROOM, _DONE_WITH = "room for so many", "what something is done with"
_STREAMS = ("river", "canal", "sidewalk", "cycleway")  # "a river of 20 m" is so wide
WIDEST = 60.0  # metres of a street; "a street of 300 m" is so long
_STREETS = ("street", "road")
_NOT_MEASURED = ("crane", "flying", "light", "sky")
_HOMES = (
    "house", "apartment", "terrace", "villa", "cottage", "bungalow", "tower", "office",
    "skyscraper", "high_rise",
)  # fmt: skip
_LANES = ("lane", "lanes", "alley", "alleys")  # streets of one kind among others
_SHOPS = ("shop", "shops", "store", "stores")
_SIZED = ("plaza", "park", "lake")  # places that are as large as is said
_BUILT = ("built", "coverage", "covered")
_RATIOS = ("ratio", "far", "fsi")
_MEANS = ("mean", "average", "averaging", "on average")
_PARTS = ("facade", "roof", "window")
_IN_GROUPS = ("groups", "pairs", "rows", "clusters", "teams", "columns", "stacks", "batches")
_OTHERS = ("other", "others", "rest", "the rest", "rest of", "the rest of", "some", "most")
_MEASURES = ("height", "width", "length")
_ABOUT_ALL = ("district", "size", "density", "style", "building.height", "source")
YEARS = (1000.0, 2100.0)
LOWEST = 1.0  # metres; nothing that is asked of a building, a tree or a lamp is lower
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
        one.noun in _WHOLE or one.text in ("ground", "area", "site", "is", "are")
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
    if is_unknown(owner) or (owner.has("slot") and not owner.noun and not _is_whole(owner)):
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


def _is_whole(item: Item) -> bool:
    """Return whether a head is the city, or words about all of it."""
    about_all = item.get("slot").partition("=")[0] in _ABOUT_ALL
    if item.get("slot").startswith("not="):
        return False  # a pedestrian zone
    return about_all or item.noun in ("city", "landscape", "everything") or item.has("source")


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


def _value(quantity: Quantity) -> float:
    return quantity.high or quantity.low or 0.0


def _key(noun: Item) -> str:
    if noun.noun_class == "road":
        return ROADS.get(noun.noun, noun.noun)
    if noun.noun in (*KINDS_OF_PEOPLE, *ROLES):
        return noun.noun
    return COUNTED.get(noun.noun_class, noun.noun)


def _counts(here: Here) -> None:
    noun = here.noun_behind()
    whole = None if noun is None else here.part_of_one(noun)
    if whole is not None:
        here.found.leave(here.item, f"of the {here.found.said(whole)}")
        return
    if noun is not None and _lives_there(here, noun):
        home = here.items[here.at - 2 : here.at] if here.at > 1 else ()
        own = [one for one in home if one.text in ("home", "homes")]  # "home to | 3,000 people"
        here.found.add_bounded("population", here.quantity, here.item, noun, *own)
        return
    about = _no_count(here, noun)
    if about:
        here.found.leave(here.item, about)
        if noun is not None and about in (_ROOM, _DONE_WITH):
            noun.state = noun.state or READ
        return
    if _is_of_groups(here):
        here.found.leave(here.item, "size of the groups")
        return  # "in groups of | two to five"
    of_them = here.after is not None and here.after.get("rel") == "of"
    if of_them and noun is not None and _of_those(here) and noun.noun_class == "road":
        here.found.leave(here.item, f"some of the {noun.noun}")
        return  # "two of the busier streets"
    if noun is None and here.quantity.exact != 1:
        if not _counts_what_was_named(here):
            return  # "a factory with | two chimneys"
        noun = here.noun_before() or here.buildings_before(past_end=of_them)
    place = noun is not None and noun.noun_class in ("type", "element", "road")
    if noun is not None and of_them and place and not is_plural(noun.words[-1]):
        here.found.leave(here.item, "how many of them")
        return  # "protesters at the church, | 200 of them"
    pronoun = noun is not None and here.item.text == "one" and noun.noun_class in ("place", "road")
    if noun is None or pronoun:
        if here.quantity.exact == 1:
            here.item.state = READ
        return
    behind_it = here.syntax.head_behind(here.at) < 0
    if (
        behind_it
        and here.quantity.exact != 1
        and not is_plural(noun.words[-1])
        and (noun.noun_class in ("road", "place") and here.before is noun)
    ):
        here.found.leave(here.item, f"of the {here.found.said(noun)}")
        return  # "inner ring 6, outer ring | 2"
    if here.quantity.exact == 1 and _is_in_a_row(here):
        here.item.state = READ  # "one plane tree every 12 m"
        return
    if noun.noun == "everything" and behind_it:
        here.found.leave(here.item, "number of what is not said")
        return  # "12 floors; everything else | at most 4"
    few = _value(here.quantity) <= FEW
    if noun.noun == "shop" and noun.words[-1] not in _SHOPS and few:
        noun.state = noun.state or READ
        here.found.leave(here.item, f"how many {here.found.said(noun)}")
        return  # "two pubs"
    within = _within_a_town(here)
    single = noun.noun in LANDMARKS or (noun.noun in ELEMENTS and (few or within))
    single = single or (within and noun.noun_class == "type" and _are_some(noun, few=few))
    key = f"{noun.noun}.count" if single else _count_key(noun)
    told = any(slot.key.startswith(key) for slot in here.found.slots)
    if key and of_them and (told or noun.noun_class == "road"):
        here.found.leave(here.item, f"some of the {noun.noun}")
        return  # "ten churches, | five of them"
    if key:
        here.found.add_bounded(key, here.quantity, here.item, noun)
    if noun.noun_class == "plant" and is_species(noun):
        here.found.leave_span(noun.span, "which kind of so many")  # "exactly 14 | lime trees"
    if noun.noun_class == "type" and not single:
        here.found.add("building.type", noun.noun, noun)


def _is_in_a_row(here: Here) -> bool:
    """Return whether one thing stands each so many metres: "one tree | every 12 m"."""
    behind = here.items[here.at + 1 : here.at + 7]
    return any(
        one.quantity is not None and one.quantity.dimension == "length"
        and (one.quantity.attribute == "spacing" or before.text in ("every", "each"))
        for before, one in pairwise(behind)
    )  # fmt: skip


def _are_some(noun: Item, *, few: bool) -> bool:
    """Return whether so many of a kind are some among others, and not all that a town is."""
    return noun.noun not in _HOMES or (few and noun.noun != "tower")


def _is_of_groups(here: Here) -> bool:
    """Return whether a number says how large groups are: "in pairs of | two"."""
    before = here.items[max(here.at - 2, 0) : here.at]
    groups = len(before) == 2 and before[0].words[-1:] and before[0].words[-1] in _IN_GROUPS
    return bool(groups) and before[1].get("rel") == "of"


def _of_those(here: Here) -> bool:
    """Return whether a number is of things that are told of: "two of the streets"."""
    behind = here.items[here.at + 2 : here.at + 3]
    return bool(behind) and behind[0].text in ("the", "its", "these", "those", "them", "our")


def _lives_there(here: Here, noun: Item) -> bool:
    """Return whether people are those of a town: "a town for | 5000 people"."""
    behind = here.items[here.syntax.index(noun) + 1 :][:1]
    if noun.noun == "pedestrian" and behind and behind[0].text in ("live", "living", "reside"):
        behind[0].state = READ
        return True
    home = here.items[max(0, here.at - 2) : here.at]
    if noun.noun == "pedestrian" and [one.text for one in home] in (
        ["home", "to"],
        ["homes", "for"],
    ):
        return True
    link = here.before is not None and here.before.text in ("for", "of")
    head = here.syntax.head_before(here.at)
    town = head >= 0 and _is_whole(here.items[head])
    return noun.noun == "pedestrian" and link and town


def _counts_what_was_named(here: Here) -> bool:
    """Return whether a number is of a noun before it: "houses: 20", "ten of them"."""
    before, after = here.before, here.after
    alone = after is None or after.kind in ("mark", "function") or after.has("rel", "neg")
    told = before is None or before.kind == "mark" or before.has("rel", "attr", "noun", "compared")
    return here.syntax.head_behind(here.at) < 0 and alone and told


def _no_count(here: Here, noun: Item | None) -> str:
    """Return what a plain number is when it counts nothing, "" when it may."""
    before, after = here.before, here.after
    if here.quantity.attribute == "speed" or (before is not None and before.get("attr") == "speed"):
        return "speed"
    if _is_for_every(here, noun):
        return "for each of others"  # "two benches for every tree"
    if any(item.text == "per" for item in here.items[here.at + 1 : here.at + 4]):
        return "for each of others"
    if any(item.text in ("hour", "minute") for item in here.items[here.at + 1 : here.at + 4]):
        return "in a time"  # "600 vehicles an hour"
    if _is_of_a_compound(here):
        return "of a compound"  # "a nine-hole golf course"
    if before is not None and _is_doing(here, before):
        return _DONE_WITH  # "rubble blocking | six streets"
    if before is not None and before.get("rel") == "or" and noun is None:
        return "one of two numbers"  # "a kiosk or | three"
    if noun is None and _lacks_its_unit(here):
        return "a measure without its unit"  # "2 floors, | up to 5 at the square"
    if noun is None and before is not None and before.text == "for":
        return _ROOM  # "dorms for | 500"
    if noun is not None and noun.noun in _ANIMALS:
        return f"how many {here.found.said(noun)}"
    living = noun is not None and noun.noun_class in ("person", "vehicle")
    if living and before is not None and before.kind == "unknown" and before.text.endswith("ing"):
        return _ROOM  # "a hall holding | 500 people"
    if noun is None and _is_a_code(here):
        return "a code"
    if before is not None and before.text == "by" and noun is not None and noun.noun in ROADS:
        noun.state = noun.state or READ
        return "the way somebody goes"  # "they leave by | three streets"
    if before is not None and before.text in ("where", "between"):
        return "what meets or ends there"  # "where | two main roads meet"
    if noun is not None and noun.noun_class == "building" and here.is_some_kind(noun):
        return f"of the {here.found.said(noun)}"  # "six lecture buildings"
    if after is not None and after.text == "s" and after.span[0] == here.item.span[1]:
        return "years"
    if before is not None and before.text == "in" and noun is None and _is_a_year(here.quantity):
        return "year"
    if before is not None and before.text == "at" and noun is None:
        return "an hour or an age"
    if after is not None and after.is_mark(")") and (before is None or before.kind == "mark"):
        return "a number in a list"
    if noun is not None and noun.noun in _ONE_ALONE:
        noun.state = noun.state or READ
        return f"how many {here.found.said(noun)}"
    if after is not None and (after.words[:1] or ("",))[0] in _GROUPS:
        after.state = READ
        return after.words[0]
    if _in_a_row(here):
        return "one of several numbers"
    if noun is None:
        return ""
    if noun.noun_class == "element" and here.is_another_kind(noun):
        return f"of the {here.found.said(noun)}"  # "12 race gates"
    single = here.quantity.exact == 1 and noun.noun_class == "type"
    known = noun.noun in ELEMENTS or (noun.noun in COUNTED_KINDS and noun.noun != "house")
    if single and not known and any(is_of_a_town(item) for item in here.items if item is not noun):
        noun.state = READ
        return f"a single {noun.noun}"
    if before is not None and before.text == "for" and noun.noun_class in ("vehicle", "person"):
        noun.state = noun.state or READ
        return f"room for the {noun.noun}"
    if after is not None and after.has("rank"):
        return f"the {after.text} {noun.noun}"
    if noun.noun == "road" and _leads_away(here, noun):
        noun.state = noun.state or READ
        return "what leads somewhere"
    for measure in here.items[here.items.index(noun) + 1 :][:1]:
        own = measure.quantity is not None and measure.quantity.dimension != "count"
        if own and here.quantity.exact is None:
            measure.state = READ
            return f"{here.found.said(measure)}, counted"  # "fewer than 5 houses over 50 m"
    return ""


def _lacks_its_unit(here: Here) -> bool:
    """Return whether a bound stands behind a measure in the same sentence, and nothing counted."""
    of_them = here.after is not None and here.after.get("rel") == "of"
    if here.quantity.exact is not None or of_them:
        return False
    for item in reversed(here.items[: here.at]):
        if item.is_mark(ENDS):
            return False
        if item.quantity is not None:
            return item.quantity.dimension in ("floors", "length", "lanes", "area", "speed")
    return False


def _leads_away(here: Here, road: Item) -> bool:
    """Return whether streets lead or meet somewhere: "four roads leading away from it"."""
    behind = here.items[here.syntax.index(road) + 1 :][:1]
    return bool(behind) and behind[0].text in (
        "leading", "lead", "leads", "meeting", "meet", "leaving", "leave", "running", "run", "going"
    )  # fmt: skip


def _is_a_code(here: Here) -> bool:
    """Return whether a number is what a word before a colon is set to: "EPSG: | 25832"."""
    word = here.items[here.at - 2] if here.at > 1 else here.item
    return here.items[here.at - 1].is_mark(":=") and word.kind == "unknown"


def _is_doing(here: Here, before: Item) -> bool:
    """Return whether a participle before is what a thing before it does."""
    verb = (before.kind == "unknown" or before.has("verb")) and before.words[-1].endswith("ing")
    return verb and here.syntax.head_before(here.at - 1) >= 0


def _is_of_a_compound(here: Here) -> bool:
    """Return whether a hyphen joins a number to what it counts within another thing."""
    behind = here.items[here.at + 1 : here.at + 3]
    joined = len(behind) == 2 and behind[0].is_mark("-")
    return joined and (here.syntax.modifies(here.at + 2) >= 0 or behind[1].kind == "unknown")


def _in_a_row(here: Here) -> bool:
    """Return whether a number stands in a list of numbers: "towers of 40, | 60 and 90 metres"."""
    behind = here.items[here.at + 1 : here.at + 3]
    return (
        len(behind) == 2
        and (behind[0].is_mark(",") or behind[0].get("rel") == "and")
        and behind[1].quantity is not None
    )


def _is_a_year(quantity: Quantity) -> bool:
    return quantity.exact is not None and YEARS[0] <= quantity.exact <= YEARS[1]


def _within_a_town(here: Here) -> bool:
    """Return whether things are counted among others: "a town with a pond, | three factories"."""
    begin = 0
    for at, item in enumerate(here.items[: here.at]):
        begin = at if item.is_mark(ENDS) else begin
    before = here.items[begin : here.at]
    return any(item.text == "with" for item in before) and any(
        item.noun == "city" or "district=" in item.get("slot") for item in before
    )


def _count_key(noun: Item) -> str:
    if noun.noun_class in BUILDINGS or noun.noun == "everything":
        return "building.count"
    if noun.noun_class in ("element", "vehicle", "person", "plant"):
        return f"{_key(noun)}.count"
    return {
        "avenue": "roads.avenues", "ring_road": "roads.rings", "road": "roads.count",
        "main_street": "roads.main.count", "motorway": "roads.motorways",
    }.get(noun.noun, "")  # fmt: skip


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
    if higher or _is_difference(here):
        here.found.leave(here.item, "by how much two things differ")  # "| two storeys higher"
        return
    owner = here.owner() or _thing_past_comma(here) or here.buildings_before(past_end=False)
    if owner is not None and _is_of_the_list(here, owner):
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
        key = noun.noun if noun is not None and _of_all(here, noun) else "building"
        if is_set_apart(here):
            here.found.leave(here.item, ABOUT)
            return
        _add_of_each(here, f"{key}.floors", here.quantity)


def _is_alone_of_a_kind(here: Here, owner: Item) -> bool:
    """Return whether storeys are those of one kind: "a row of hotels | 8 to 12 storeys"."""
    first = here.syntax.index(here.phrase_of(owner)[0])
    link = here.items[first - 1] if first else None
    listed = link is not None and (link.get("rel") in ("and", "or") or link.is_mark(","))
    return here.of_a_kind(owner) and not listed


def _is_of_the_list(here: Here, owner: Item) -> bool:
    """Return whether a bound behind a comma is of all that was listed: "..., | 12 storeys max"."""
    begins = here.before is None or here.before.is_mark(",;")
    ends = here.after is None or here.after.kind == "mark" or here.after.text == "all"
    if here.quantity.exact is not None or not (begins and ends) or here.of_one_thing(owner):
        return False
    at = here.syntax.index(owner)
    sentence = here.items[at - 1 :: -1] if at else ()
    for item in sentence:
        if item.is_mark(ENDS):
            return False
        if item.noun_class == "type" and item.noun != owner.noun and item.state in ("", READ):
            return True
    return False


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
    _mark(noun)
    here.found.add_bounded(f"{key}.lanes", Quantity("lanes", low, high), here.item)


def _lengths(here: Here) -> None:
    what = here.quantity.attribute
    noun = here.noun()
    if noun is None and what == "width":
        noun = here.noun_past_comma()
    every = here.before is not None and here.before.text in ("every", "each")
    unknown = here.before is not None and here.before.kind == "unknown"
    if noun is None and unknown and not what:
        return  # "visibility | under 1 km"
    part = here.owner(past_comma=True) if noun is None else None
    if part is not None and part.get("slot").startswith("building.feature="):
        here.found.leave(here.item, f"of the {here.found.said(part)}")  # "a chimney, | 60 m"
        return
    if here.before is not None and here.before.text == "for" and here.quantity.exact is None:
        here.found.leave(here.item, "for what something else stands")  # "red for | under 20 m"
        return
    if noun is None and (thing := _thing_past_comma(here)) is not None:
        if thing.noun_class == "element" or thing.noun in ELEMENTS:
            noun = thing  # "a minaret, which is | 22 m high"
        else:
            here.found.leave(here.item, f"of the {here.found.said(thing)}")
            return
    if what == "width" and here.item.words[0] in _STREETS:
        here.found.add_bounded("roads.width", here.quantity, here.item)  # "a street width of 14 m"
    elif _is_difference(here):
        here.found.leave(here.item, "by how much two things differ")
    elif _is_depth(here):
        here.found.leave(here.item, "depth")
    elif _is_for_each(here):
        here.found.leave(here.item, "for each of others")
    elif _is_distance(here):
        if not read_distance(here, here.noun_before()):
            here.found.leave(here.item, "distance")
    elif _of_blocks(here):
        here.found.leave(here.item, "size of the blocks")
    elif what == "slope":
        _slope(here)
    elif what == "spacing" or (every and not what):
        _spacing(here)
    elif _is_extent(here, noun):
        _extent(here, "")
    elif (road := _road_past_comma(here, noun)) is not None:
        between = here.items[here.items.index(road) : here.at]
        measure = "width" if any(item.has("width") for item in between) else "length"
        here.found.add_bounded(f"{_key(road)}.{measure}", here.quantity, here.item)
    elif what == "height" and noun is not None and noun.noun in _PARTS:
        here.found.leave(here.item, f"height of the {here.found.said(noun)}")
    elif what == "height" or (not what and (noun is None or noun.noun_class in BUILDINGS)):
        noun = _owner_in_brackets(here, noun)
        own = noun is not None and (
            noun.noun_class in ("element", "plant") or noun.noun in ELEMENTS
        )
        least = None if own else _least(here)
        if least is not None:
            here.found.add_bounded(
                "building.height", replace(here.quantity, high=None), here.item, least
            )
            return
        if noun is not None and not own and are_of_some(here, noun) and not here.has_looks(noun):
            here.found.leave(here.item, f"height of the {noun.noun}")
            return
        scoped = noun is not None and (
            own or _of_all(here, noun) or are_of_some(here, noun) or _are_among(here, noun)
        )
        key = _key(noun) if own and noun is not None else "building"
        key = noun.noun if scoped and not own and noun is not None else key
        key = "building" if noun is not None and _is_of_the_list(here, noun) else key
        apart = noun is not None and stands_in_a_part(here, noun)
        if not own and not apart and is_set_apart(here):
            here.found.leave(here.item, ABOUT)
        elif own and noun is not None and noun.noun in ELEMENTS and not here.takes(noun, "height"):
            here.found.refuse(here.item, noun.noun, "height")
        elif (here.quantity.high or LOWEST) < LOWEST and not own:
            here.found.leave(here.item, "too low for a building")  # "10 cm on the roofs"
        else:
            quantity, *ranks = _highest(here)
            if ranks and key in ("building", "tower") and _is_of_them_all(here):
                here.found.add("height.highest", here.quantity.high or 0.0, here.item, *ranks)
            else:
                _add_of_each(here, f"{key}.height", quantity, *ranks)
    elif noun is not None and noun.noun == "everything" and here.quantity.exact is None:
        here.found.leave(here.item, "bound of what is not said")  # "anything above 600 m"
    elif noun is None or noun.noun in _WHOLE:
        _extent(here, what)
    else:
        _width(here, noun)


def _owner_in_brackets(here: Here, noun: Item | None) -> Item | None:
    """Return whose height is told; in brackets behind a place it is that of the buildings there.

    "Hotels facing the beach (none taller than | 25 m)" are no beach of that height.
    """
    if noun is None or noun.noun not in PLACES or noun.noun in ELEMENTS:
        return noun
    at = here.syntax.index(noun)
    bracket = any(one.is_mark("(") for one in here.items[at : here.at])
    head = here.syntax.head_before(at - 1) if bracket and at else -1
    whole = here.items[head] if head >= 0 else noun
    return whole if whole.noun_class in BUILDINGS else noun


# Kinds of buildings that limits can be of alone.
_LIMITED = ("house", "tower", "apartment", "office", "shop", "factory")


def _are_among(here: Here, noun: Item) -> bool:
    """Return whether towers are some of the buildings: "an old railway and | towers of 60 m"."""
    phrase = here.phrase_of(noun)
    first = here.syntax.index(phrase[0])
    counted = any(one.quantity is not None for one in phrase if one.span < noun.span)
    link = here.items[first - 1] if first else None
    joined = link is not None and (link.text == "with" or link.get("rel") == "and")
    least = here.quantity.low is not None  # "towers up to 300 m" make a skyline
    return noun.noun == "tower" and is_plural(noun.text) and joined and least and not counted


def _of_all(here: Here, noun: Item) -> bool:
    """Return whether a bound is of every building of a kind alone: "no office above 11 m"."""
    at = here.items.index(noun)
    before = here.items[at - 1] if at else noun
    every = before.has("neg") or before.get("rel") in ("all", "every")
    if noun.noun not in _LIMITED or not every or here.quantity.exact is not None:
        return False
    before.state = before.state or READ
    return True


def _is_distance(here: Here) -> bool:
    """Return whether a length lies between things: "within 200 m of", "150 m away from"."""
    after = here.after
    if after is None or here.quantity.attribute:
        return False
    if after.words[-1] not in _FROM:
        return after.get("rel") == "of"
    head = here.syntax.object_of(here.at + 1)
    return head < 0 or not here.items[head].get("slot").startswith(AIR)  # "under a clear sky"


def _is_for_every(here: Here, noun: Item | None) -> bool:
    """Return whether a number is that of things for each of others: "two benches for every tree".

    Or that of the others: "a bench to every | ten trees".
    """
    near = here.items[max(0, here.at - 2) : here.at]
    if len(near) == 2 and near[0].text in ("for", "to") and near[1].text in ("every", "each"):
        return True
    if noun is None or noun.span < here.item.span:
        return False
    at = here.syntax.index(noun)
    link = here.items[at + 1 : at + 3]
    return len(link) > 1 and link[0].text in ("for", "to") and link[1].text in ("every", "each")


def _is_difference(here: Here) -> bool:
    """Return whether a length is that between two things: "12 m | lower than the town"."""
    after = here.after
    behind = here.items[here.at + 2 : here.at + 3]
    than = bool(behind) and behind[0].text == "than"
    compared = after is not None and (after.words[-1] == "than" or (than and not after.noun))
    return bool(compared) or here.quantity.relative != 0


def _is_for_each(here: Here) -> bool:
    """Return whether a measure is that of one of others: "half a metre to the pixel"."""
    link = "" if here.after is None else here.after.text
    if link in ("per", "apiece"):
        return True
    head = here.syntax.object_of(here.at + 1) if link == "to" else -1
    return head >= 0 and is_unknown(here.items[head])


def _of_blocks(here: Here) -> bool:
    """Return whether a length is that of blocks: "blocks of about | 80 m", "113 m blocks"."""
    near = here.items[max(0, here.at - 4) : here.at + 3]
    many = any(item.text in ("each", "every") for item in near)
    word = ("block", "blocks") if many else ("blocks",)
    named = any(item.words and item.words[-1] in word for item in near)
    return named and here.quantity.attribute != "height"


def _spacing(here: Here) -> None:
    """Read how far apart trees stand; of other things nothing is spaced."""
    noun = here.noun_before()
    owner = here.owner()
    if noun is not None and noun.noun_class == "plant" and (whole := _lined_by(here, noun)):
        here.found.leave(here.item, f"spacing along the {whole}")
        return
    if noun is not None and noun.noun_class == "road" and _is_row_of_roads(here, noun):
        here.found.leave(here.item, f"spacing of the {here.found.said(noun)}")
        return  # "side streets every | 80 m"
    if noun is None and owner is not None:
        here.found.leave(here.item, f"spacing of the {here.found.said(owner)}")
        return
    if noun is None or noun.noun_class in ("plant", "road", "place") or _is_green(noun):
        here.found.add_bounded("nature.spacing", here.quantity, here.item)
    else:
        here.found.leave(here.item, f"spacing of the {noun.noun}")


def _lined_by(here: Here, plants: Item) -> str:
    """Return the place that is no street and has a row of trees: "a promenade with | palms"."""
    first = here.syntax.index(here.phrase_of(plants)[0])
    held = first > 0 and here.items[first - 1].text in ("with", "has", "having")
    head = here.syntax.head_before(first - 1) if held else -1
    whole = here.items[head] if head >= 0 else None
    return here.found.said(whole) if whole is not None and whole.noun_class == "element" else ""


def _is_row_of_roads(here: Here, road: Item) -> bool:
    """Return whether it is streets that come in a row, and nothing along them."""
    phrase = here.phrase_of(road)
    first = here.syntax.index(phrase[0])
    before = here.items[first - 1] if first else None
    along = before is not None and before.get("rel") in ("along", "on", "in", "near")
    plants = any(one.noun_class == "plant" for one in here.before_in_clause())
    return not along and not plants and is_plural(road.words[-1])


def _thing_past_comma(here: Here) -> Item | None:
    """Return the one thing, known or not, that a measure behind a comma is of: "a levee, | 3 m"."""
    first = here.at
    while first > 0 and not here.items[first - 1].is_mark(ENDS + ","):
        first -= 1
    if first == 0 or not here.items[first - 1].is_mark(","):
        return None
    if any(
        item.has("noun", "slot") or item.kind == "unknown" for item in here.items[first : here.at]
    ):
        return None
    head = here.syntax.head_before(first - 1)
    thing = here.items[head] if head >= 0 else None
    if thing is None or thing.noun_class in ("place", "road") or thing.has("slot"):
        return None
    if here.quantity.attribute == "across" and _is_no_owner(here, thing):
        return None
    known = thing.noun_class in ("element", *BUILDINGS) and not here.of_one_thing(thing)
    return None if known else thing


def _road_past_comma(here: Here, noun: Item | None) -> Item | None:
    """Return the street of "a long straight avenue, at least | 1.5 km"."""
    if noun is not None or here.quantity.attribute or here.before is None:
        return None
    comma = here.before.is_mark(",")
    last = here.last_noun() if comma else None
    return last if last is not None and last.noun_class == "road" else None


def _is_extent(here: Here, noun: Item | None) -> bool:
    """Return whether a length is the city's: "500 m across", "a town of | 600 m with a river"."""
    if here.quantity.attribute in ("side", "across"):
        return noun is None or noun.noun_class == "place"
    if here.quantity.attribute or here.noun_behind() is not None:
        return False
    place = here.items[here.at - 2] if here.at > 1 else None
    of = here.before is not None and here.before.get("rel") == "of"
    one = place is not None and place.noun_class == "place" and not place.words[-1].endswith("s")
    return of and one


def _is_depth(here: Here) -> bool:
    """Return whether a length is that of lying snow or water: "20 cm of snow"."""
    what = here.items[here.at + 2] if here.at + 2 < len(here.items) else None
    of = here.after is not None and here.after.get("rel") == "of"
    deep = what is not None and (
        what.get("slot").startswith("weather=") or what.noun in ("water", "sky")
    )
    return of and deep


def _add_of_each(here: Here, key: str, quantity: Quantity, *told: Item) -> None:
    """Take a measure of buildings; one of each, or an exact one, is a bound on both sides."""
    before = here.items[max(0, here.at - 2) : here.at]
    exactly = any(one.text in ("exactly", "precisely", "strictly") for one in before)
    each = quantity.relative == 0 and (exactly or here.of_every_building())
    if quantity.exact is None or not each:
        here.found.add_bounded(key, quantity, here.item, *told)
        return
    for end in ("min", "max"):
        here.found.add(f"{key}.{end}", quantity.exact, here.item, every=True)
    for one in here.clause():
        if one.get("rel") in ("all", "every"):
            one.state = one.state or READ


def _highest(here: Here) -> tuple[Quantity, *tuple[Item, ...]]:
    """Return a height, that of "the highest building" as a bound of all, with its "highest"."""
    owner = here.owner(past_comma=True)
    near = (*here.clause(), *(() if owner is None else here.phrase_of(owner)))
    ranks = [one for one in near if one.get("rank") == "tallest"]
    if not ranks or here.quantity.exact is None:
        return (here.quantity,)
    kind = owner is not None and owner.noun_class == "type" and here.noun_behind() is owner
    if kind and owner is not None and ranks[0] not in here.phrase_of(owner):
        return (here.quantity,)  # "the tallest one is the | 40 m town hall"
    return replace(here.quantity, low=None), ranks[0]


def _least(here: Here) -> Item | None:
    """Return the word for the lowest of all, of which a bound below holds for each.

    "The | shortest house is at least 20 m high".
    """
    if here.quantity.low is None:
        return None
    return next((one for one in here.before_in_clause() if one.get("rank") in _LOWEST_OF_ALL), None)


_LOWEST_OF_ALL = ("lowest", "shortest")


def _is_of_them_all(here: Here) -> bool:
    """Return whether a number is the height of the highest, and no bound of it."""
    quantity = here.quantity
    allowed = any(set(one.words) & {"may", "can", "could"} for one in here.before_in_clause())
    return quantity.exact is not None and not allowed  # "the highest may reach | 90 m"


def _extent(here: Here, what: str) -> None:
    if here.before is not None and here.before.text == "each":
        return  # "blocks, each 100 m wide" are no city of that width
    owner = here.owner(past_comma=True)
    comma = here.before is not None and here.before.is_mark(",")
    if comma and owner is not None and _is_no_owner(here, owner):
        owner = None
    if owner is not None and not _is_site(here, owner):
        here.found.leave(here.item, f"of the {here.found.said(owner)}")
        return
    for key in _SIDES.get(what, ("size.x", "size.y")):
        here.found.add(key, _value(here.quantity), here.item)


def _is_no_owner(here: Here, thing: Item) -> bool:
    """Return whether a length is the town's: "a town with no cars, | 1 km across"."""
    sentence = here.items[begin_of(here.items, here.at, ENDS) : here.at]
    first = next((one for one in sentence if one.has("noun", "head")), thing)
    return thing.noun_class in _LIVING and first.noun == "city"


def _is_site(here: Here, owner: Item) -> bool:
    """Return whether a head is the site: the first place of the text, nothing unknown about it."""
    at = here.syntax.index(owner)
    phrase = here.syntax.phrase(at)
    if not _is_whole(owner) or phrase is None:
        return False
    if here.quantity.attribute in ("across", "side"):
        return True
    known = not any(item.kind == "unknown" for item in here.items[phrase.first : at])
    places = any(
        one.noun == "city" or "district=" in one.get("slot") for one in here.items[: phrase.first]
    )
    on = phrase.first > 0 and here.items[phrase.first - 1].text in ("on", "onto", "into")
    if on and owner.text == "plot" and here.items[phrase.first].text in ("a", "an"):
        return True  # "100 houses on a plot | 50 m by 50 m"
    return owner.text in _SITES or (known and not places and not is_plural(owner.text))


def _width(here: Here, noun: Item) -> None:
    measure = "length" if here.quantity.attribute == "length" else "width"
    others = any(one.noun in ROADS and one.noun != noun.noun for one in here.items)
    if others and noun.noun == "road" and noun.words[-1] in _LANES:
        noun.state = noun.state or READ
        here.found.leave(here.item, f"{measure} of the {here.found.said(noun)}")
        return
    told = bool(here.quantity.attribute) or noun.noun in _STREAMS
    told = told or (noun.noun in ROADS and _value(here.quantity) <= WIDEST)
    if told and noun.noun in ELEMENTS:
        if here.takes(noun, measure):
            here.found.add_bounded(f"{noun.noun}.{measure}", here.quantity, here.item)
        else:
            here.found.refuse(here.item, noun.noun, measure)
        return
    if noun.noun_class not in ("road", "element", "plant") or not told:
        here.found.leave(here.item, f"{measure} of the {noun.noun}")
        return
    _mark(noun)
    here.found.add_bounded(f"{_key(noun)}.{measure}", here.quantity, here.item)


def _mark(noun: Item | None) -> None:
    """Count a street as read, since something is said of it."""
    if noun is None or noun.has("slot") or noun.noun in ("ring_road", "motorway"):
        return
    if noun.noun_class == "road":
        noun.state = noun.state or READ


def _pairs(here: Here) -> None:
    on = here.before is not None and here.before.get("rel") in ("on", "in")
    on = on or (here.before is not None and here.before.is_mark(":"))  # "a class: | 600 x 600 m"
    owner = None if on else here.owner()  # "houses with gardens on | 100 x 100 m"
    if _of_blocks(here):
        here.found.leave(here.item, "size of the blocks")
        return
    if here.before is not None and here.before.text in ("each", "every"):
        owner = here.element_before() or owner  # "two squares, each | 40 x 40 m"
        here.before.state = here.before.state or READ
    own = owner is not None and owner.noun_class == "element"
    if owner is not None and not own and not _is_site(here, owner):
        here.found.leave(here.item, f"size of the {here.found.said(owner)}")
        return
    if own and owner is not None and owner.noun in _SIZED:
        area = (here.quantity.low or 0.0) * (here.quantity.other or 0.0)
        here.found.add(f"{owner.noun}.area", round(area), here.item)
        return
    key = f"{owner.noun}.size" if own and owner is not None else "size"
    here.found.add(f"{key}.x", here.quantity.low or 0.0, here.item)
    here.found.add(f"{key}.y", here.quantity.other or 0.0, here.item)


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
    own = noun is not None and noun.noun_class == "element"
    on = here.before is not None and here.before.get("rel") in ("on", "in")  # "villas on | 5 ha"
    owner = None if on else here.owner()
    if owner is not None and not own and not _is_site(here, owner):
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
    green = None if of_buildings or parts else next(filter(_is_green, clause), None)
    sloping = any(
        one.get("attr") == "slope" or one.noun == "ramp" or one.text in ("ramp", "incline")
        for one in clause
    )
    if any(one.has("side") for one in here.phrase_of(here.item)) or _is_a_side(here):
        here.found.leave(here.item, "a part of the site")
    elif _is_turned_into(here):
        here.found.leave(here.item, "of which something else is made")
        for one in clause:
            if one.has("color", "material") and one.span > here.item.span:
                here.found.leave(one, OF_A_PART)
    elif here.quantity.attribute == "slope" or sloping:
        _slope(here)
    elif green is not None:
        here.found.add_bounded("green.share", here.quantity, here.item, green)
    else:
        _share_of_buildings(here)


def _slope(here: Here) -> None:
    """Read how steep streets are, or the land; of what else slopes lie under is left open."""
    clause = here.clause()
    before = here.before_in_clause()
    roads = any(one.noun_class == "road" or one.noun in ("sidewalk", "ramp") for one in clause)
    land = any(one.noun == "landscape" or "terrain=" in one.get("slot") for one in clause)
    others = any(one.noun_class in (*BUILDINGS, "plant") for one in clause)
    none = any(one.has("neg") and one.text in ("none", "nothing") for one in before)
    paths = any(one.noun == "path" for one in clause)
    if ((others or none) and not roads) or paths:
        here.found.leave(here.item, "slope of what stands there")  # "no house on slopes over 15 %"
    elif here.quantity.dimension == "length":
        here.found.leave(here.item, "how far it rises")  # "the road climbs 60 m"
    else:
        key = "terrain.slope" if land and not roads else "roads.slope"
        here.found.add_bounded(key, here.quantity, here.item)


def _is_a_side(here: Here) -> bool:
    """Return whether a half is that of a side: "the northern | half"."""
    return here.quantity.dimension == "part" and here.before is not None and here.before.has("side")


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


def _is_green(item: Item) -> bool:
    return item.get("rel") == "green" or item.noun in _GREEN


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
    "count": _counts, "floors": _floors, "lanes": _lanes,
    "length": _lengths, "pair": _pairs, "area": _areas, "share": _shares, "part": _shares,
    "speed": _speeds, "hour": _hours, "temperature": _bounds_of("temperature"),
    "people": _bounds_of("population"),
}  # fmt: skip
