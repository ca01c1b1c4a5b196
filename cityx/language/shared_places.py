"""Shared places: what is said of all things of a list is said of each.

"A school, a library and a pharmacy, all within 300 m of the park" and "in the north, a church and
an inn" place each of them. A list of which one thing cannot be placed so is left as it was.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from cityx.language.distances import read_distance
from cityx.language.here import SIDES_OF_A_VIEW, Findings, Here, is_of_a_town
from cityx.language.lexicon.phrases import PARTS_OF_SPEECH
from cityx.language.place_words import leave_place
from cityx.language.relations import (
    OUTSKIRTS,
    fits,
    is_of_a_quarter,
    read_beside,
    read_part,
    read_quarter,
    read_relation,
)
from cityx.language.scan import ENDS, Item
from cityx.language.scopes import READ
from cityx.language.side_words import may_be_at
from cityx.language.syntax import Syntax
from cityx.town.elements import ELEMENTS

_OF_ALL = ("all", "both", "each", "all of", "both of", "each of", "every one of")
_WHICH = ("them", "these", "those", "which", "it")
_STANDING = (
    "standing", "located", "lying", "placed", "situated", "set", "found", "sited", "built", "stand",
    "lie",
)  # fmt: skip
_ENDS_OF_SIDES = ("corner", "end", "edge", "part", "side", "half", "rim", "quarter")
_SQUARES = ("plaza", "park")  # which are no elements
_PUTTING = ("there", "put", "place", "add", "build", "i", "we", "want")
_TO = ("in", "on", "to", "near")
_MIDDLES = ("center of", "middle of", "center of the", "middle of the")
_FAR = 14  # items from a list to the end of what is said of it


@dataclass(frozen=True)
class _Place:
    """Where things are: a side, or how they stand to another thing.

    Attributes
    ----------
    side
        A side of the site, "middle" or "edge"; "" for a relation or a distance.
    at
        Item that says it: the side, the relation or the distance.
    first, end
        Its items.
    of
        What things stand to, None for a side.
    """

    side: str
    at: int
    first: int
    end: int
    of: Item | None = None


def read_shared_places(found: Findings, items: Sequence[Item], syntax: Syntax) -> None:
    """Put each thing of a list where all of them are told to be."""
    for at, item in enumerate(items):
        if item.state:
            continue
        if item.text in _OF_ALL:
            _read_behind(found, items, syntax, at)
        elif at == 0 or items[at - 1].is_mark(ENDS + ":,") or items[at - 1].get("rel") == "and":
            _read_in_front(found, items, syntax, at)


def _read_behind(found: Findings, items: Sequence[Item], syntax: Syntax, at: int) -> None:
    """Read "a school and a church, | all in the north"."""
    first = at
    while first and (items[first - 1].get("rel") == "be" or items[first - 1].text == "they"):
        first -= 1  # "they should | all be ..."
    if not first or not items[first - 1].is_mark(",;-–—(."):
        return
    told, number, place = at + 1, 2 if items[at].text.startswith("both") else 0, None
    while told < min(at + _FAR, len(items)):
        item = items[told]
        if item.quantity is not None and item.quantity.dimension == "count" and not number:
            number = int(item.quantity.exact or 0)
        elif not (item.text in (*_WHICH, *_STANDING) or item.get("rel") == "be"):
            place = _place(items, syntax, told)
            break
        told += 1
    end = first - 1
    while end and items[end - 1].is_mark(",-–—"):
        end -= 1
    things = _listed_before(items, syntax, end)
    if place is None or len(things) < 2 or (number and number != len(things)):
        return
    more = _place(items, syntax, place.end) if place.of is not None else None
    end = place.end if more is None or more.of is not None else more.end
    if not _goes_on(items, end) and _put(found, items, syntax, things, place):
        for item in items[at + 1 : told]:
            item.kind, item.senses, item.quantity = "function", (), None  # "all | three"
        _mark(items[first : place.end], place)


def _read_in_front(found: Findings, items: Sequence[Item], syntax: Syntax, at: int) -> None:
    """Read "| in the north, a school and a church"."""
    place = _place(items, syntax, at)
    if place is None or place.end >= len(items):
        return
    begin, first = place.end, at == 0 or items[at - 1].is_mark(ENDS + ":")
    apart = items[begin].is_mark(",:-–—")
    if apart and not first:
        return  # "a school, | in the north, a church"
    if first and (apart or items[begin].text == "there"):
        begin += apart
        while begin < len(items) and (
            items[begin].text in _PUTTING or items[begin].get("rel") == "be"
        ):
            begin += 1
    elif items[begin].text not in ("a", "an"):
        return  # "and behind the school | a pitch"
    things, end = _listed_behind(items, syntax, begin)
    ends = end == len(items) or _ends(items[end])
    if things and ends and _put(found, items, syntax, things, place):
        _mark(items[place.first : place.end], place)


def _mark(told: Sequence[Item], place: _Place) -> None:
    """Count words for a place as read, but for the thing there, which is asked for itself."""
    for item in told:
        if place.of is None or (item is not place.of and item.kind != "unknown"):
            item.state = item.state or READ


def _ends(item: Item) -> bool:
    return item.kind == "mark" or item.get("rel") in ("with", "and", "but") or item.text == "while"


def _goes_on(items: Sequence[Item], end: int) -> bool:
    """Return whether words behind a place may say more of it: "in the north of | the park"."""
    if end >= len(items):
        return False
    return not (items[end].kind == "mark" or items[end].get("rel") in ("and", "with", "but"))


def _place(items: Sequence[Item], syntax: Syntax, at: int) -> _Place | None:
    """Return the place that begins at an item, None where it says none that is known."""
    item, behind = items[at], items[at + 1] if at + 1 < len(items) else None
    quantity = item.quantity
    if behind is None:
        return None
    if quantity is not None:
        between = behind.get("rel") == "of" or behind.text in ("from", "away", "away from", "off")
        if quantity.dimension != "length" or quantity.attribute or not between:
            return None
        head = syntax.object_of(at + (2 if behind.text == "away" else 1))
        if head < 0 or not items[head].noun:
            return None
        return _Place("", at, at, head + 1, items[head])
    if item.get("rel") in _TO or item.text in ("at", "from"):
        phrase = syntax.phrase(at + 1)
        if phrase is not None and phrase.first == at + 1:
            told = items[phrase.first : phrase.end]
            side = next((n for n in range(phrase.first, phrase.end) if items[n].has("side")), -1)
            if side >= 0 and items[side].words[-1] in SIDES_OF_A_VIEW:
                return None  # "| to the right, a museum" is beside what was named
            rest = [
                one
                for one in told
                if one.kind != "function"
                and one.text not in _ENDS_OF_SIDES
                and not one.has("shade")
            ]
            end = phrase.end
            if side == end - 1 and end < len(items) and items[end].text in _ENDS_OF_SIDES:
                end += 1  # "on the east | side"
            of = items[end] if end < len(items) else None
            if of is not None and of.get("rel") == "of":
                town = syntax.object_of(end)
                if town < 0 or items[town].noun not in ("city", "landscape"):
                    rest = []
                end = town + 1
            if side >= 0 and len(rest) == 1:
                return _Place(items[side].get("side"), side, at, end)
            if len(rest) == 1 and rest[0].noun == "center":
                return _Place("middle", syntax.index(rest[0]), at, end)
            if len(told) <= 2 and told[-1].text in OUTSKIRTS and not side >= 0:
                return _Place("edge", syntax.index(told[-1]), at, end)
    if item.get("rel") in ("in", "near") and item.text.endswith(_MIDDLES):
        town = syntax.object_of(at)
        if town >= 0 and items[town].noun == "city":
            return _Place("middle", at, at, town + 1)
    placing = item.get("rel") in ("near", "along", "around", "in", "on", "by")
    if placing and (head := syntax.object_of(at)) >= 0 and items[head].noun:
        return _Place("", at, at, head + 1, items[head])
    return None


def _listed_before(items: Sequence[Item], syntax: Syntax, end: int) -> list[int]:
    """Return the heads of a list that ends at an item, [] where it is none."""
    heads: list[int] = []
    while end:
        phrase = syntax.phrase(end - 1)
        if phrase is None or phrase.head < 0:
            return []
        if any(item.kind != "mark" for item in items[end : phrase.end]):
            return []
        heads.append(phrase.head)
        begin = end = phrase.first
        while end and (items[end - 1].is_mark(",") or items[end - 1].get("rel") == "and"):
            end -= 1
        if end == begin:
            break
    if end and (_is_placing(items[end - 1]) or _is_of_one(items, syntax, end)):
        return []
    return heads[::-1]


def _is_placing(item: Item) -> bool:
    return item.get("rel") in ("near", "along", "around", "in", "on", "by", "of") or (
        item.text in PARTS_OF_SPEECH["prepositions"] and item.text not in ("with", "for")
    )


def _is_of_one(items: Sequence[Item], syntax: Syntax, end: int) -> bool:
    """Return whether a list is of what one thing has: "a park with | a kiosk, a school"."""
    if items[end - 1].get("rel") != "with":
        return False
    head = syntax.head_before(end - 1, past_comma=True)
    return head >= 0 and items[head].noun_class in ("element", "type", "road")


def _listed_behind(items: Sequence[Item], syntax: Syntax, at: int) -> tuple[list[int], int]:
    """Return the heads of a list that begins at an item, and where it ends."""
    heads: list[int] = []
    while at < len(items):
        phrase = syntax.phrase(at)
        if phrase is None or phrase.first != at or phrase.head < 0:
            return [], at
        heads.append(phrase.head)
        at = begin = phrase.end
        while at < len(items) and (items[at].is_mark(",") or items[at].get("rel") == "and"):
            at += 1
        if at == begin or at == len(items) or syntax.phrase(at) is None:
            return heads, begin
    return heads, at


def _put(
    found: Findings, items: Sequence[Item], syntax: Syntax, heads: Sequence[int], place: _Place
) -> bool:
    """Add where each of some things is, and leave it open of what cannot be put there.

    Returns
    -------
    put
        Whether one of them is; a word that nobody knows is named by itself.
    """
    listed = [items[head] for head in heads]
    if any((is_of_a_town(one) and not one.has("noun")) or one.noun == "city" for one in listed):
        return False
    here = Here(found, items, place.at, syntax)
    left = []
    known = 0
    for head, thing in zip(heads, listed, strict=True):
        own = replace(here, at=head)
        if _may_stand(own, thing) and _put_one(here, thing, place):
            known += 1
        elif thing.kind != "unknown" and not thing.state:
            left.append(thing)
    if known:
        for thing in left:
            span = items[place.first].span[0], items[place.end - 1].span[1]
            leave_place(here, thing, span)
    return known > 0


def _may_stand(here: Here, thing: Item) -> bool:
    """Return whether a thing, or the houses of a quarter, may be put somewhere."""
    if not thing.has("noun") or thing.state:
        return False
    if is_of_a_quarter(here, thing):
        return True
    known = thing.noun in ELEMENTS and not ELEMENTS[thing.noun].builder
    return (known or thing.noun in _SQUARES) and not here.is_another_kind(thing)


def _put_one(here: Here, thing: Item, place: _Place) -> bool:
    several = is_of_a_quarter(here, thing)
    if place.of is not None:
        if several:
            return here.item.quantity is None and read_quarter(here, thing, place.of)
        if not fits(thing, place.of):
            return False
        if here.item.quantity is not None:
            return read_distance(here, thing)
        if here.item.text == "by":
            return read_beside(here, thing, place.of)
        return read_relation(here, thing, place.of)
    if several:
        return read_part(here, thing, place.side)
    if not may_be_at(thing, place.side):
        return False
    here.found.add(f"{thing.noun}.side", place.side, here.item)
    return True
