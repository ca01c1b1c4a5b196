"""Busyness: how much goes on in streets: "more traffic and fewer people", "crowded pavements"."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

from cityx.language.brief import Edit
from cityx.language.commands.selection import is_plural
from cityx.language.scan import Item
from cityx.language.scopes import READ

OBJECTS = ("building", "type", "element", "plant", "vehicle", "person", "road")
_PLACED = ("along", "near", "around", "on", "in", "from")  # "more traffic on x1"
_BUSY = {"more": "heavy", "many": "heavy", "few": "light", "RAISE": "heavy", "LOWER": "light"}


def amounts_of_life(items: Sequence[Item]) -> list[Edit]:
    """Read "more traffic and fewer people", which name no object that exists."""
    objects = [at for at, item in enumerate(items) if item.noun_class in OBJECTS]
    words = [item for item in items if item.kind != "function"]
    found = []
    start = 0
    for at in objects:
        how = _how_busy(items[start:at]) or _BUSY.get(items[0].get("verb"), "")
        if not how and len(objects) == 1:  # "make the traffic heavy"
            how = _how_busy(items[at + 1 :])
        start = at + 1
        crowd = items[at].noun == "pedestrian" and is_plural(items[at])
        cars = items[at].noun == "vehicle" and is_plural(items[at]) and not items[at].has("mode")
        if not how or not (crowd or cars or items[at].text == "traffic"):
            return []
        key = "pedestrians" if crowd else "traffic"
        found.append(Edit(f"set_{key}", change=((key, how),), span=_span(items)))
    placed = any(item.kind == "id" for item in items) or any(
        item.get("rel") in _PLACED and after.noun for item, after in pairwise(words)
    )
    if placed or any(item.quantity is not None for item in items):
        return []
    for item in items if found else ():
        item.state = READ
    return found


def _how_busy(words: Sequence[Item]) -> str:
    for word in words:
        amount = "more" if word.get("rel") == "more" else word.get("amount")
        how = _BUSY.get(amount) or word.get("strength")
        if how:
            return how
    return ""


def tells_of_life(items: Sequence[Item]) -> bool:
    """Return whether items say how busy streets are: "make the pavements crowded"."""
    things = [item for item in items if item.noun_class in OBJECTS]
    living = all(item.noun_class in ("vehicle", "person", "road") for item in things)
    busy = any(item.get("slot").startswith(("traffic=", "pedestrians=")) for item in items)
    verb = next((item.get("verb") for item in items if item.has("verb")), "")
    made = verb == "" or (verb == "MAKE" and busy)
    return living and made and not any(item.has("rank") or item.kind == "id" for item in items)


def _span(items: Sequence[Item]) -> tuple[int, int]:
    return min(item.span[0] for item in items), max(item.span[1] for item in items)
