"""Counts: a number of buildings, things, streets, people or vehicles, and what it counts."""

from __future__ import annotations

from itertools import pairwise

from cityx.language.counted_there import others_of
from cityx.language.here import (
    BUILDINGS,
    COUNTED,
    FEW,
    KINDS_OF_PEOPLE,
    LANDMARKS,
    ROADS,
    ROLES,
    Here,
    is_of_a_town,
)
from cityx.language.scan import ENDS, Item, Quantity
from cityx.language.scopes import READ
from cityx.language.syntax import is_plural
from cityx.language.things import is_species
from cityx.town.elements import ELEMENTS
from cityx.town.quarter_kinds import COUNTED_KINDS

# Words behind a number of which something else is counted.
_GROUPS = (
    "kinds", "kind", "types", "sorts", "sizes", "ranks", "rows", "row", "groups", "group", "lines",
    "clusters", "pairs", "sets",
)  # fmt: skip
# Quantities that are of a thing, and words about a whole city.
_ONE_ALONE = ("sea", "water", "green", "traffic")  # what nobody counts
_ANIMALS = ("dog",)
_ROOM, _DONE_WITH = "room for so many", "what something is done with"
_HOMES = (
    "house", "apartment", "terrace", "villa", "cottage", "bungalow", "tower", "office",
    "skyscraper", "high_rise",
)  # fmt: skip
_SHOPS = ("shop", "shops", "store", "stores")
_IN_GROUPS = ("groups", "pairs", "rows", "clusters", "teams", "columns", "stacks", "batches")
_ABOUT_ALL = ("district", "size", "density", "style", "building.height", "source")
YEARS = (1000.0, 2100.0)


def is_whole(item: Item) -> bool:
    """Return whether a head is the city, or words about all of it."""
    about_all = item.get("slot").partition("=")[0] in _ABOUT_ALL
    if item.get("slot").startswith("not="):
        return False  # a pedestrian zone
    return about_all or item.noun in ("city", "landscape", "everything") or item.has("source")


def value_of(quantity: Quantity) -> float:
    """Return a quantity as one number: its greatest."""
    return quantity.high or quantity.low or 0.0


def key_of(noun: Item) -> str:
    """Return the first part of the keys of a noun."""
    if noun.noun_class == "road":
        return ROADS.get(noun.noun, noun.noun)
    if noun.noun in (*KINDS_OF_PEOPLE, *ROLES):
        return noun.noun
    return COUNTED.get(noun.noun_class, noun.noun)


def read_counts(here: Here) -> None:
    """Read how many there are of something."""
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
    if noun is None and (others := others_of(here.syntax, here.at)) >= 0:
        here.found.leave(here.item, f"how many {here.found.said(here.items[others])}")
        return  # "six benches on the square and | two in the park"
    if noun is None and here.quantity.exact != 1:
        if not _counts_what_was_named(here):
            return  # "a factory with | two chimneys"
        noun = here.noun_before() or here.buildings_before(past_end=of_them)
    place = noun is not None and noun.noun_class in ("type", "element", "road")
    if noun is not None and of_them and place and not is_plural(noun.words[-1]):
        here.found.leave(here.item, "how many of them")
        return  # "protesters at the church, | 200 of them"
    pronoun = noun is not None and here.item.text == "one" and noun.noun_class in ("place", "road")
    if pronoun and noun is not None and _is_one_main_street(here, noun):
        here.found.add("roads.main.count", 1, here.item)
        return  # "one four-lane arterial" is the only one
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
    few = value_of(here.quantity) <= FEW
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


def _is_one_main_street(here: Here, noun: Item) -> bool:
    """Return whether one main street is told of with what it is like, which no other one has."""
    looks = here.phrase_of(noun)[1:-1]
    told = any(one.quantity is not None or one.has("width", "size", "surface") for one in looks)
    single = noun.noun in ("main_street", "avenue") and not is_plural(noun.words[-1])
    return told and single and here.after is not noun


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
    town = head >= 0 and is_whole(here.items[head])
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
    if noun is None and before is not None and before.get("rel") == "rest":
        return "of the others"  # "three storeys, all others | two"
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
    if after is not None and after.text in ("sides", "side"):
        return f"how many {after.text}"  # "houses on | three sides of the square"
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
    if noun.noun_class in ("element", "type") and here.is_another_kind(noun):
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
        return f"{key_of(noun)}.count"
    return {
        "avenue": "roads.avenues", "ring_road": "roads.rings", "road": "roads.count",
        "main_street": "roads.main.count", "motorway": "roads.motorways",
    }.get(noun.noun, "")  # fmt: skip


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
