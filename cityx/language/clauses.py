"""Clauses of a description that ask for no thing: orders to leave out, questions, purposes."""

from __future__ import annotations

from collections.abc import Sequence

from cityx.language.here import Findings, Here
from cityx.language.scan import ENDS, Item
from cityx.language.scopes import NEGATED, READ, named_list
from cityx.system.tables import load

_LEAVING_OUT = (
    "ignore", "disregard", "omit", "skip", "exclude", "discard", "drop", "delete", "remove",
    "erase", "strip", "ditch", "scrap", "eliminate", "leave out", "take out", "get rid of",
    "strip out", "clear out", "clear", "lose",
)  # fmt: skip
_ALSO_THINGS = load("language/spelling", frozenset[str], "also_things")
_SHOWING = ("show", "tell", "list", "find", "highlight", "mark", "see", "know", "point", "check")
_PLACING = (
    "behind", "beyond", "around", "between", "beside", "below", "above", "opposite", "in front of",
    "next to", "before", "near", "outside",
)  # fmt: skip
_ANY = ("all", "any", "every", "anything", "everything")
_ASKING = ("which", "where", "how", "what", "whether", "who", "why")
_MODAL = ("can", "could", "may", "might", "must", "should", "would", "will", "cannot")
# Orders that change what is there; a description leaves them open as a whole.
_CHANGES = (
    "PAINT", "RAISE", "LOWER", "MOVE", "ROTATE", "SCALE", "DOUBLE", "HALVE", "SWAP", "WIDEN",
    "NARROW", "COPY", "REPLACE", "CLOSE", "OPEN", "TRIPLE",
)  # fmt: skip


def settle_removals(items: Sequence[Item]) -> None:
    """Deny what an order at the beginning of a clause leaves out: "drop all trees"."""
    for at in range(len(items)):
        length = 0 if items[at].state else _leaves_out(items, at)
        if not length or not begins_clause(items, at):
            continue
        first = _examples(items, at + length)
        listed = named_list(items, first)
        if not listed or _is_bounded(items, at):
            continue
        for item in items[at + length : first]:
            item.state = item.state or READ  # "lose anything modern such as | lamps"
        for item in items[at : at + length]:
            item.kind, item.senses, item.state = "phrase", (("neg", "neg"),), READ
        for item in listed:
            item.state = item.state or NEGATED


def _examples(items: Sequence[Item], at: int) -> int:
    """Return where the things begin that an order names: "anything modern such as | lamps"."""
    if at < len(items) and items[at].text in ("anything", "everything"):
        for n in range(at + 1, min(at + 5, len(items))):
            if items[n].text in ("like", "including", "such as"):
                return n + 1
            if items[n].text == "such" and n + 1 < len(items) and items[n + 1].text == "as":
                return n + 2
    return at


def _is_bounded(items: Sequence[Item], at: int) -> bool:
    """Return whether an order is about things beyond a bound: "delete all towers | over 50 m"."""
    bounds = (one.quantity for one in _to_the_end(items, at, ENDS + ",:"))
    return any(one is not None and one.exact is None for one in bounds)


def _leaves_out(items: Sequence[Item], at: int) -> int:
    """Return how many items at a place are a word for leaving out, 0 for none."""
    behind = items[at + 1 : at + 2]
    if (
        items[at].get("verb") == "REMOVE"
        and behind
        and behind[0].words[:1]
        and behind[0].words[0] in _ANY
    ):
        return 1
    for length in (1, 2):
        if " ".join(one.text for one in items[at : at + length]) not in _LEAVING_OUT:
            continue
        after = items[at + length : at + length + 1]
        told = bool(after) and after[0].text in ("the", "all", "any", "every", "away", "out", "off")
        return length if told or items[at].text not in _ALSO_THINGS else 0
    return 0


def begins_clause(items: Sequence[Item], at: int) -> bool:
    """Return whether an item is the first of a sentence or of a part of one."""
    if at == 0:
        return True
    before = items[at - 1]
    polite = before.get("rel") in ("and", "but", "please") or before.text in ("then", "also")
    return (before.kind == "mark" and not before.is_mark("-'’()")) or polite


def leave_clauses(found: Findings, items: Sequence[Item]) -> None:
    """Leave open what a clause shows, asks or is for: "show me which pavements are narrow"."""
    for at, item in enumerate(items):
        if item.state:
            continue
        if found.mapped and item.text in ("only", "just") and begins_clause(items, at):
            _only_streets(found, items, at)
        elif item.text in _SHOWING and any(one.text in _ASKING for one in items[at + 1 : at + 4]):
            _leave_all(found, _to_the_end(items, at, ENDS), "a question about the city")
        elif item.text == "so" and at + 1 < len(items) and items[at + 1].text == "that":
            _leave_all(found, _to_the_end(items, at, ENDS + ","), "a purpose")
        elif _begins_with_a_place(items, at):
            _leave_all(found, _to_the_end(items, at, ENDS), "what stands by another thing")
        elif item.has("verb") and is_an_order(items, at):
            _leave_all(found, _to_the_end(items, at, ENDS + ",:"), "a change of what is there")


def _begins_with_a_place(items: Sequence[Item], at: int) -> bool:
    """Return whether a clause tells what stands by what was told: "behind them, white houses"."""
    after = items[at + 1 : at + 4]
    if len(after) < 2 or items[at].text not in _PLACING or not begins_clause(items, at):
        return False
    return after[0].get("rel") == "it" and not after[1].is_mark(ENDS)


def _only_streets(found: Findings, items: Sequence[Item], at: int) -> None:
    """Deny buildings where a map's streets are all that is to be there: "only the streets"."""
    behind = [one for one in items[at + 1 : at + 4] if one.kind != "function"]
    after = behind[1] if len(behind) > 1 else None
    alone = after is None or after.kind == "mark" or after.get("rel") in ("please", "of", "from")
    if behind and behind[0].noun == "road" and alone:
        items[at].state = behind[0].state = READ
        found.deny("building", behind[0])


def is_an_order(items: Sequence[Item], at: int) -> bool:
    """Return whether a sentence or a part of one begins with an order to change a thing."""
    item = items[at]
    plain = item.get("verb") in _CHANGES and not item.has("slot", "keep", "material", "color")
    behind = items[at + 1 : at + 4]
    told = bool(behind) and behind[0].text in ("the", "all", "every", "each", "sea", "it", "them")
    plain = plain or (item.get("verb") == "REMOVE" and _is_bounded(items, at))
    told = told or (bool(behind) and item.get("verb") == "REPLACE" and bool(behind[0].noun))
    # "line the water with a wall", "plant limes along the street"; "plant" is a factory, too.
    row = item.text in ("line", "plant") and bool(behind) and behind[0].kind != "mark"
    return ((plain and told) or row) and begins_clause(items, at)


def _to_the_end(items: Sequence[Item], at: int, ends: str) -> Sequence[Item]:
    last = at
    while last < len(items) and not items[last].is_mark(ends):
        joins = items[last].get("rel") == "and" and last > at
        if joins and any(one.has("verb") and not one.has("noun") for one in items[last + 1 :][:1]):
            break  # "paint the roofs red and | add a canal"
        last += 1
    return items[at:last]


def _leave_all(found: Findings, items: Sequence[Item], about: str) -> None:
    """Note some items in a row as one."""
    for item in items:
        item.state = item.state or READ
    found.leave_span((items[0].span[0], items[-1].span[1]), about)


def may_do(here: Here) -> bool:
    """Return whether people or vehicles are told to be able to do something: "a bus can turn"."""
    return here.after is not None and here.after.text in _MODAL
