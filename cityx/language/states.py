"""States: words that say in what state things are, which no builder shows, are no wishes of a town.

"Abandoned cars" are cars, and "a boarded-up pub" is a pub: the state is left for what is not
understood, instead of emptying the town or cladding its houses with boards.
"""

from __future__ import annotations

from collections.abc import Sequence

from cityx.language.scan import Item
from cityx.language.syntax import is_plural
from cityx.system.tables import load

_EMPTYING = load("language/spelling", frozenset[str], "emptying")
_WHOLE = ("city", "road", "plaza", "park", "main_street", "center")  # what is empty as a whole
_STANDING = ("vehicle", "parked_vehicle", "type", "element", "building")
_OUT = ("out", "broken", "dead", "dark", "failing")  # of signals that do not work


def settle_states(items: Sequence[Item]) -> None:
    """Take the meaning from words for states of things, so that they are named as not understood.

    Parameters
    ----------
    items
        All items of a description, before anything is read.
    """
    for at, item in enumerate(items):
        behind = [one for one in items[at + 1 : at + 4] if one.text != "-"]
        after = behind[0] if behind else None
        if item.text == "boarded" and after is not None and after.text == "up":
            _unknown(item)
            _unknown(after)
        elif item.text in _EMPTYING and _is_of_a_thing(behind):
            _unknown(item)
        elif item.noun == "traffic_light" and after is not None and after.text in _OUT:
            _unknown(after)
        elif item.get("direction") == "along" and _is_of_one_street(items, at):
            _unknown(item)


def _is_of_a_thing(behind: Sequence[Item]) -> bool:
    """Return whether a thing follows, and not a town or its streets: "abandoned, rusty | cars"."""
    for one in behind:
        if one.noun:
            return one.noun not in _WHOLE and one.noun_class in _STANDING
        if not (one.has("color", "material", "size") or one.kind == "unknown"):
            return False
    return False


def _is_of_one_street(items: Sequence[Item], at: int) -> bool:
    """Return whether one street among others is told of: "on a | one-way street"."""
    words = items[at].words[-1]
    street = next((one for one in items[at + 1 : at + 2] if one.noun_class == "road"), None)
    named = street.words[-1] if street is not None else words
    one = at > 0 and items[at - 1].text in ("a", "one", "the")
    return one and not is_plural(named) and (street is not None or "street" in items[at].words)


def _unknown(item: Item) -> None:
    item.kind, item.senses, item.state = "unknown", (), ""
