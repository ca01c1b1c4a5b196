"""Earlier: what a command takes from what stands before it: a bound, ground that was cleared."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from cityx.language.brief import Edit, Reference
from cityx.language.commands.rewording import CLEARED, LEAST
from cityx.language.commands.selection import IT, is_plural
from cityx.language.commands.that_place import PLACES
from cityx.language.scan import Item
from cityx.language.scopes import READ

_LOWERED = ("raise_floors", "raise_height", "scale_height", "scale_floors")
NEW = ("add", "add_building")  # verbs of what is put somewhere
GAP = "cleared"  # relation of something new to ground that a removal of the same request clears


def in_bounds(edits: Sequence[Edit], clause: Sequence[Item]) -> list[Edit]:
    """Return changes that lower something with the bound of "but nothing goes below two floors".

    What is lower than that before stays as it is.
    """
    least = least_said(clause)
    if least is None:
        return list(edits)
    key, _, value = least.get(LEAST).partition("=")
    number = float(value)
    bound = (key, int(number) if number == int(number) else number)
    about = key.partition(".")[0]
    found = []
    for edit in edits:
        if edit.verb in _LOWERED and about in edit.verb and edit.target and _lowers(edit):
            target = replace(edit.target, filters=(*edit.target.filters, f"{about}>{number:g}"))
            edit = replace(edit, target=target, change=(*edit.change, bound))
        found.append(edit)
    return found


def _lowers(edit: Edit) -> bool:
    by = dict(edit.change)
    return float(by.get("by", 0)) < 0 or float(by.get("factor", 1)) < 1


def least_said(clause: Sequence[Item]) -> Item | None:
    """Return what says that nothing goes below a bound."""
    return next((item for item in clause if item.has(LEAST)), None)


def in_their_place(
    edits: Sequence[Edit], clause: Sequence[Item], before: Sequence[Edit]
) -> list[Edit]:
    """Return what is put in the place of what the request removes with that place."""
    gone = any(edit.verb == "remove" and edit.target is not None for edit in before)
    said = next((item for item in clause if item.has(CLEARED)), None)
    if not gone or said is None:
        return list(edits)
    rank = said.get(CLEARED)
    found = []
    for edit in edits:
        placed = edit.refs or any(key in PLACES and value != IT for key, value in edit.change)
        placed = placed and said.text == "instead"  # "put a lamp near the park instead"
        if edit.verb in NEW and not placed:
            change = tuple(pair for pair in edit.change if pair[1] != IT)
            many = any(one.noun_class in ("type", "building") and is_plural(one) for one in clause)
            change += (("each", "yes"),) if many and edit.verb == "add_building" else ()
            edit = replace(edit, change=change, refs=(Reference(GAP, (), side=rank),))
        found.append(edit)
    return found


_PARTS = ("half", "side", "part", "end")
_LINKS = ("of", "be", "and", "but", "all", "in")


def spared_side(clause: Sequence[Item]) -> str:
    """Return the side of "the north half stays as it is", which is left alone; "" for others."""
    said = [item for item in clause if item.kind not in ("function", "mark") and not item.state]
    kept = bool(said) and (said[-1].has("unchanged") or said[0].has("keep"))
    side = next((item.get("side") for item in said if item.has("side")), "")
    plain = all(
        item.has("side", "unchanged", "keep") or item.get("rel") in _LINKS
        or item.noun in ("city", "everything") or item.text in _PARTS or _is_half(item)
        for item in said
    )  # fmt: skip
    if not (kept and side and plain):
        return ""
    for item in clause:
        item.state = READ
    return side


def _is_half(item: Item) -> bool:
    return item.quantity is not None and item.quantity.dimension == "part"
