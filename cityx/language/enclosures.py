"""Enclosures: walls, fences and hedges that go round a town or a thing, and no wall of a house.

A wall round a town is its city wall. What goes round one element is of the kinds of `BARRIERS`.
"""

from __future__ import annotations

from collections.abc import Sequence

from cityx.language.here import Here
from cityx.language.lexicon.phrases import SPECIES
from cityx.language.lexicon.words import forms_of
from cityx.language.scan import ENDS, Item
from cityx.language.scopes import READ
from cityx.language.syntax import Syntax, is_plural
from cityx.town.elements import BARRIERS, may_be_enclosed

SPECIES_OF = {name: kind for kind, names in SPECIES.items() for name in (kind, *names)}
_WALLS = ("wall", "walls")
_ROUND = ("around", "round", "encircling", "surrounding", "enclosing", "ringing")
_KINDS = ("ring", "defensive", "perimeter", "curtain", "encircling", "enclosing", "boundary")
_ALL = ("lot", "place", "thing", "settlement", "outside", "edge", "perimeter", "town", "site")
_RINGED = (
    "surrounded", "enclosed", "fenced", "ringed", "encircled", "bordered", "framed", "walled",
    "hemmed",
)  # fmt: skip
_BY = ("by", "with", "in", "within", "behind")
_HAVING = ("with", "has", "having", "and")
_TO_OBJECT = 5  # items from "round" to the end of what it goes round


def read_enclosure(here: Here) -> None:
    """Read "a wall round it with two gates", "a wall around the whole town", "a ring wall"."""
    item = here.item
    if item.words[-1] not in _WALLS or item.noun != "facade":
        return
    phrase = here.phrase_of(item)
    kinds = [one for one in phrase if one.words[-1] in _KINDS]
    round_it = _goes_round(here)
    others = [one for one in phrase[:-1] if one.noun or one.kind == "unknown"]
    if phrase[-1] is not item or not (kinds or round_it) or set(others) - set(kinds):
        return  # "a garden | wall around it"
    here.found.add("element", "city_wall", item)
    item.senses = (("noun", "element:city_wall"),)  # of which more may be told
    for one in (*kinds, *round_it):
        one.state = one.state or READ


def _goes_round(here: Here) -> list[Item]:
    """Return the words by which a wall goes round the town, [] where it goes round a thing."""
    behind = here.items[here.at + 1 : here.at + 2 + _TO_OBJECT]
    while behind and (behind[0].kind == "function" or behind[0].text in ("all", "right")):
        behind = behind[1:]
    if not behind or behind[0].words[-1] not in _ROUND:
        return []
    told = [behind[0]]
    for one in behind[1:]:
        if one.is_mark(ENDS + ",") or one.get("rel") in ("and", "with"):
            break
        town = one.noun in ("city", "everything") or one.get("slot").startswith("district=")
        plain = one.kind == "function" or one.text in ("it", "all", "whole", "entire", *_ALL)
        if not (town or plain):
            return []
        told.append(one)
    return [] if any(one.text == "it" for one in told) and _has_an_owner(here) else told


def _has_an_owner(here: Here) -> bool:
    """Return whether "it" may be one thing before, and not the town: "a garden with | a wall"."""
    head = here.syntax.head_before(here.syntax.index(here.phrase_of(here.item)[0]), past_comma=True)
    owner = here.items[head] if head >= 0 else None
    one = owner is not None and owner.noun_class in ("type", "element")
    return one and owner is not None and not is_plural(owner.words[-1])


def settle_rings(items: Sequence[Item], syntax: Syntax) -> None:
    """Let walls that go round a thing be such: "a church with a stone | wall around it"."""
    for at, item in enumerate(items):
        wall = item.noun == "facade" and item.words[-1] in _WALLS
        if wall and (_ringed_before(items, syntax, at) or _round_behind(items, syntax, at)):
            item.senses = (("noun", "element:boundary_wall"),)


def read_ring(here: Here) -> None:
    """Read what goes round an element: "a playground surrounded by a | hedge"."""
    item = here.item
    barrier = item.noun if item.noun in BARRIERS else ""
    trees = item.noun_class == "plant"
    if not (barrier or trees) or not item.has("noun"):
        return
    read = _ringed_before(here.items, here.syntax, here.at)
    if not read and barrier:
        read = _round_behind(here.items, here.syntax, here.at) or ()
    if not read:
        return
    thing, *words = read
    for one in (*words, *here.phrase_of(item)[:1]):
        if one is not item and not one.has("material", "color", "height", "size"):
            one.state = one.state or READ
    if trees:
        here.found.add(f"{_species(item)}.by", thing.noun, item)
    else:
        here.found.add(f"{thing.noun}.enclosed", barrier, item)


def _species(item: Item) -> str:
    return next((SPECIES_OF[form] for form in forms_of(item.text) if form in SPECIES_OF), "tree")


def _ringed_before(items: Sequence[Item], syntax: Syntax, at: int) -> tuple[Item, ...]:
    """Return the element before "surrounded by" and these words, () where there is none."""
    phrase = syntax.phrase(at)
    first = at if phrase is None else phrase.first
    if phrase is not None and phrase.head != at:
        return ()
    link = first
    while link and items[link - 1].words and items[link - 1].words[-1] in _BY:
        link -= 1
    if link and items[link - 1].words and items[link - 1].words[0] in _RINGED:
        link -= 1
    words = items[link:first]
    if not words or words[0].words[0] not in _RINGED:
        return ()
    head = syntax.head_before(link, past_comma=True)
    thing = items[head] if head >= 0 else None
    return () if thing is None or not _may_be_ringed(thing) else (thing, *words)


def _round_behind(items: Sequence[Item], syntax: Syntax, at: int) -> tuple[Item, ...] | None:
    """Return the element that a barrier goes round: "a fence around the | playground"."""
    behind = items[at + 1 : at + 3]
    if not behind or behind[0].words[-1:] == () or behind[0].words[-1] not in _ROUND:
        return None
    if len(behind) == 2 and behind[1].text in ("it", "them"):
        first = at if (phrase := syntax.phrase(at)) is None else phrase.first
        held = first > 0 and items[first - 1].text in _HAVING
        thing = _last_ringable(items, syntax, first - 1) if held else None
        words = tuple(behind)
    else:
        head = syntax.object_of(at + 1)
        thing = items[head] if head > at else None
        words = tuple(behind[:1])
    return None if thing is None or not _may_be_ringed(thing) else (thing, *words)


def _last_ringable(items: Sequence[Item], syntax: Syntax, at: int) -> Item | None:
    """Return the last element before in a sentence: "a kiosk on the corner and a | fence"."""
    for place in range(at - 1, -1, -1):
        item = items[place]
        if item.is_mark(ENDS):
            return None
        if item.has("noun") and syntax.modifies(place) < 0 and _may_be_ringed(item):
            return item
    return None


def _may_be_ringed(thing: Item) -> bool:
    """Return whether a thing is an element on land of its own."""
    known = thing.has("noun") and thing.state in ("", READ)
    return known and may_be_enclosed(thing.noun)
