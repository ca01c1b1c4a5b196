"""Distances: how far one thing is from another becomes slots of the thing."""

from __future__ import annotations

from cityx.language.here import Here
from cityx.language.relations import FAR, fits, is_kept_clear
from cityx.language.scan import ENDS, Item
from cityx.language.syntax import is_plural

_OF_THEM = ("rank", "rel")  # senses of "the nearest house" and "any house"


def read_distance(here: Here, thing: Item | None) -> bool:
    """Read "100 m from the station", "within 80 m of the quay", "at least 300 m from any house".

    Returns
    -------
    read
        False where the words say more than can be built.
    """
    at, place = here.at, None
    for item in here.items[here.at + 1 : here.at + 1 + FAR]:
        at += 1
        if item.is_mark(ENDS + ",") or item.quantity is not None:
            break
        if item.noun:
            place = item
            break
    if thing is None or place is None or not (fits(thing, place) or is_kept_clear(thing, place)):
        return False
    exact, low, high = here.quantity.exact, here.quantity.low, here.quantity.high
    several = is_plural(thing.words[-1])
    if (several and exact is not None) or (high is not None and is_plural(place.words[-1])):
        return False
    away = [here.after] if here.after is not None and here.after.text == "away" else []
    between = [one for one in here.items[here.at + 1 : at] if one.has(*_OF_THEM)]
    here.found.add(f"{thing.noun}.near", place.noun, here.item, *away, *between)
    for end, value in (("", exact), (".min", low), (".max", high)):
        if value is not None and (not end or exact is None):
            here.found.add(f"{thing.noun}.metres{end}", value, here.item)
    return True
