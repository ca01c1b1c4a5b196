"""Enclosures: a wall that goes round a town is its city wall, and no wall of a house."""

from __future__ import annotations

from cityx.language.here import Here
from cityx.language.scan import ENDS, Item
from cityx.language.scopes import READ
from cityx.language.syntax import is_plural

_WALLS = ("wall", "walls")
_ROUND = ("around", "round", "encircling", "surrounding", "enclosing", "ringing")
_KINDS = ("ring", "defensive", "perimeter", "curtain", "encircling", "enclosing", "boundary")
_ALL = ("lot", "place", "thing", "settlement", "outside", "edge", "perimeter", "town", "site")
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
