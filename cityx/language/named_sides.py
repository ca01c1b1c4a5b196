"""Named sides: which thing a side is of, "the north side of the river", where it is of no site.

A side without a thing is of the one whose side was told before in the same sentence: "shops on the
north side of the street and houses on the south side". "South of it" and "its south" are so, too.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from cityx.language.here import SIDES_OF_A_VIEW, Here
from cityx.language.place_words import NO_PLACE
from cityx.language.relations import fits, is_of_a_quarter, thing_before
from cityx.language.scan import ENDS, Item, begin_of
from cityx.language.scopes import READ
from cityx.language.syntax import is_plural
from cityx.town.elements import ELEMENTS, PLACES, SIDES

_SIDE, _BANKS = ("side", "sides"), ("bank", "banks", "shore", "shores")
_WATERS = ("river", "canal", "lake")
_WAYS = ("river", "canal", "railway", "tram_line", "motorway", "main_street", "avenue", "lake")
_THROUGH = ("river", "canal")  # what runs through the middle of a town, with land on both sides
_OWNERS, _THOSE = ("its", "their", "whose"), ("it", "them", "those", "rest")
_FARTHER = ("other", "far", "opposite")
_FROM = ("from", "as seen from", "to")


def is_of_another(items: Sequence[Item], at: int) -> bool:
    """Return whether a side is of a thing, known or not, and not of the site."""
    if at and items[at - 1].text in _OWNERS:
        return True
    behind = items[_link(items, at) :][:2]
    those = len(behind) == 2 and behind[0].get("rel") == "of" and behind[1].get("rel") in _THOSE
    return those or items[at].words[-1] in SIDES_OF_A_VIEW or place_of(items, at) is not None


def _link(items: Sequence[Item], at: int) -> int:
    """Return where "of" may stand behind a side: "north | of", "north side | of"."""
    piece = at + 1 < len(items) and items[at + 1].text in (*_SIDE, *_BANKS)
    return at + 1 + piece


def place_of(items: Sequence[Item], at: int) -> Item | None:
    """Return the thing that a side is of, None where that is the site or is not known."""
    item, link = items[at], _link(items, at)
    if not item.has("side") or item.words[-1] in SIDES_OF_A_VIEW:
        return None
    behind = items[at + 1] if at + 1 < len(items) else None
    if behind is not None and behind.noun in _WATERS and behind.words[0] in _BANKS:
        return behind  # "the north | bank of the river"
    if link < len(items) and items[link].get("rel") == "of":
        told = [one for one in items[link + 1 : link + 4] if one.kind != "function"]
        if told and told[0].get("rel") in _THOSE:
            return _told_before(items, at)
        return told[0] if told and _is_a_thing(told[0]) else None
    if behind is not None and behind.text in _BANKS:
        waters = [one for one in items if one.noun in _WATERS and one.has("noun")]
        return waters[0] if len({one.noun for one in waters}) == 1 else None
    return _told_before(items, at)


def _told_before(items: Sequence[Item], at: int) -> Item | None:
    """Return the thing whose side is told last before in a sentence."""
    for before in range(at - 1, begin_of(items, at, ENDS) - 1, -1):
        if items[before].has("side") and (place := place_of(items, before)) is not None:
            return place
    return None


def _is_a_thing(item: Item) -> bool:
    """Return whether a side is that of a thing, known or not, and of no town, land or quarter."""
    whole = item.noun in NO_PLACE or item.noun_class == "building" or item.has("slot")
    return not whole and (item.has("noun") or item.kind == "unknown")


def _is_somewhere(item: Item) -> bool:
    known = item.noun in ELEMENTS or item.noun in PLACES
    return known and item.has("noun") and item.noun not in NO_PLACE and not is_plural(item.text)


def read_side_of(here: Here) -> bool:
    """Read what stands on a side of a thing: "warehouses north of the river".

    Returns
    -------
    read
        False where what stands there, or the side, cannot be built.
    """
    place, side = place_of(here.items, here.at), here.item.get("side")
    thing, first = _thing_behind(here) or _thing(here)
    if place is None or thing is None or thing.state not in ("", READ):
        return False
    if side not in SIDES or not _is_somewhere(place):
        return False
    if is_of_a_quarter(here, thing):
        most = ("building.type", thing.noun)
        slots = here.found.slots
        slots[:] = [one for one in slots if (one.key, one.value) != most]
        here.found.add(f"{thing.noun}.by", f"{side} of {place.noun}", here.item, thing)
    elif thing.noun in ("park", "plaza") and place.noun in _THROUGH and not is_plural(thing.text):
        here.found.add(f"{thing.noun}.side", side, here.item)
        if not any(here.found.has(f"{place.noun}.{key}") for key in ("side", "near")):
            here.found.add(f"{place.noun}.side", "middle", here.item)
    elif fits(thing, place):
        here.found.add(f"{thing.noun}.near", place.noun, here.item)
        here.found.add(f"{thing.noun}.relation", side, here.item)
    else:
        return False
    for one in here.items[max(first - 1, 0) : _link(here.items, here.at) + 1]:
        one.state = one.state or (READ if one.has("rel") or one.kind == "function" else "")
    for one in here.items[here.at + 1 : here.at + 2]:
        one.state = one.state or (READ if one.text in (*_SIDE, *_BANKS) else "")
    if place.noun_class == "road":
        place.state = place.state or READ
        if place.noun == "main_street":
            here.found.add("element", place.noun, place)
    return True


def leave_side_of(here: Here) -> None:
    """Leave a side open with what is told of it alone: "south of the river all is industrial"."""
    here.found.leave(here.item, "side of another thing")
    if _thing(here)[0] is not None:
        return
    for item in here.items[here.at + 1 :]:
        if item.is_mark(ENDS + ",") or item.get("rel") in ("and", "but"):
            return
        told = item.has("slot") or item.noun_class in ("type", "building")
        if told and item.state == "" and item is not place_of(here.items, here.at):
            here.found.leave(item, "in one place alone")


def _thing_behind(here: Here) -> tuple[Item, int] | None:
    """Return what stands where a clause begins: "on the south side there are | shops"."""
    items, phrase = here.items, here.syntax.phrase(here.at)
    first = here.at if phrase is None else min(phrase.first, here.at)
    link = first - 1 if first and items[first - 1].get("rel") in ("on", "in", "to") else first
    if link and not (items[link - 1].kind == "mark" or items[link - 1].get("rel") == "and"):
        return None
    at = _link(items, here.at)
    if at < len(items) and items[at].get("rel") == "of":
        at += 1
        while at < len(items) and not (items[at].noun or items[at].get("rel") in _THOSE):
            at += 1
        at += 1
    while at < len(items) and (items[at].kind == "function" or items[at].get("rel") == "be"):
        at += 1
    behind = here.syntax.phrase(at) if at < len(items) else None
    head = -1 if behind is None or items[at].kind == "mark" else behind.head
    return (items[head], first) if head >= at and items[head].has("noun") else None


def _thing(here: Here) -> tuple[Item | None, int]:
    """Return what stands somewhere, and where the words for its place begin."""
    phrase = here.syntax.phrase(here.at)
    if phrase is not None and phrase.first <= phrase.head < here.at:
        return here.items[phrase.head], here.at  # "warehouses | north of the river"
    first = here.at if phrase is None else phrase.first
    return thing_before(replace(here, at=first)), first


def read_across(here: Here) -> bool:
    """Read "across the river from the church", "on the | other side of the river from it"."""
    items, at = here.items, here.at
    if here.item.text in _FARTHER:
        link = at + 1
        own = link < len(items) and items[link].noun in _WATERS and items[link].words[0] in _BANKS
        if not own and not (link < len(items) and items[link].text in (*_SIDE, *_BANKS)):
            return False
        link += 0 if own else 1
        if not own and not (link < len(items) and items[link].get("rel") == "of"):
            return False
        link -= own
    elif here.item.text in ("across", "over", "beyond"):
        link = at
    else:
        return False
    over = here.syntax.object_of(link)
    way = items[over] if over >= 0 else None
    behind = items[over + 1 : over + 2]
    if way is None or way.noun not in _WAYS or not behind or behind[0].text not in _FROM:
        return False
    head = here.syntax.object_of(over + 1)
    place = items[head] if head >= 0 else None
    thing, first = _thing(here)
    if place is None or not fits(thing, place) or thing is None or is_plural(thing.words[-1]):
        return False
    here.found.add(f"{thing.noun}.near", place.noun, here.item)
    here.found.add(f"{thing.noun}.relation", "across", here.item)
    here.found.add(f"{thing.noun}.second", way.noun, here.item)
    for one in items[max(first - 1, 0) : head]:
        if one.has("rel") or one.kind == "function" or one.text in (*_SIDE, *_BANKS, *_FARTHER):
            one.state = one.state or READ
    return True
