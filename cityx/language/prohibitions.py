"""Prohibitions: "nothing north of the church may move" protects what it speaks of."""

from __future__ import annotations

from collections.abc import Sequence

from cityx.language.scan import ENDS, Item
from cityx.language.scopes import READ

_OUGHT = ("may", "should", "must", "can", "shall", "will", "is", "are", "has", "have", "needs",
          "need", "gets", "get", "goes", "go", "gone")  # fmt: skip
_ALTERS = ("MOVE", "REMOVE", "REPLACE", "MAKE", "SWAP")
_ALTERED = ("touched", "disturbed", "affected", "shifted", "harmed", "damaged", "lost", "lose",
            "disappear", "vanish", "missing", "down", "astray", "suffer", "different",
            "budge", "hurt", "changed", "change", "altered", "modified",
            "displaced")  # fmt: skip
_NOTHING = ("nothing", "none", "nobody")


def without_prohibitions(items: Sequence[Item]) -> list[Item]:
    """Read "nothing north of the church may move" as "don't touch anything north of it".

    It is no wish that nothing were there.
    """
    found: list[Item] = []
    begin = 0
    for end, item in enumerate(items):
        if not (item.is_mark(ENDS + ",:") or end + 1 == len(items)):
            continue
        clause = items[begin : end + (not item.is_mark(ENDS + ",:"))]
        found += _protected(clause) or clause
        found += [item] if item.is_mark(ENDS + ",:") else []
        begin = end + 1
    return found


def _protected(clause: Sequence[Item]) -> list[Item]:
    """Return "don't touch ..." for a clause by which nothing of something may change."""
    first = next((at for at, one in enumerate(clause) if _denies(one)), -1)
    joins = [at for at, one in enumerate(clause[: max(first, 0)])
             if one.get("rel") in ("and", "but")]  # fmt: skip
    begin = joins[-1] if joins and any(one.has("verb") for one in clause[: joins[-1]]) else 0
    if first < 0 or not all(map(_leads, clause[begin:first])):
        return []  # "paint it red | and make sure no tree is lost"
    denied = clause[first]
    ought = next((at for at, one in enumerate(clause) if at > first
                  and not one.noun and one.words[0] in _OUGHT), 0)  # fmt: skip
    if not ought:
        return []
    done = [one for one in clause[ought + 1 :] if one.get("rel") not in ("be", "to", "or", "and")]
    told = [one for one in done if one.kind != "function" or one.words[-1] in _ALTERED]
    if not (_alters(clause[ought]) or told) or not all(map(_alters, told)):
        return []
    keep = Item("phrase", denied.span, ("don't", "touch"), (("keep", "keep"),))
    named = []
    if denied.words[0] in _NOTHING and not denied.words[1:]:
        named = [Item("phrase", denied.span, ("anything",), (("noun", "place:everything"),))]
    elif denied.has("head"):  # "not a single tree"
        named = [Item("phrase", denied.span, denied.words[-1:], (("noun", denied.get("head")),))]
    for one in clause[ought:]:
        one.state, one.senses = READ, ()
    return [*clause[:first], keep, *named, *clause[first + 1 :]]


def _denies(item: Item) -> bool:
    whole = item.get("slot").startswith("not=") and item.has("head")
    return not item.state and (whole or item.has("neg"))


def _leads(item: Item) -> bool:
    """Return whether an item is of "make sure that", "ensure", "and"."""
    return item.kind == "function" or item.get("rel") in ("and", "but", "it", "to") or (
        item.get("verb") == "MAKE" and item.text == "make"
    )  # fmt: skip


def _alters(item: Item) -> bool:
    """Return whether an item says that something is changed, "moved", or goes."""
    return item.get("verb") in _ALTERS or item.words[-1] in _ALTERED
