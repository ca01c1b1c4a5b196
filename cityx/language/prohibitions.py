"""Prohibitions: "nothing north of the church may move" protects what it speaks of."""

from __future__ import annotations

from collections.abc import Sequence

from cityx.language.scan import ENDS, Item
from cityx.language.scopes import READ

_OUGHT = ("may", "should", "must", "can", "shall", "will", "is", "are", "has", "have", "needs",
          "need", "gets", "get")  # fmt: skip
_ALTERS = ("MOVE", "REMOVE", "REPLACE", "MAKE", "SWAP")
_ALTERED = ("touched", "disturbed", "affected", "shifted", "harmed", "damaged", "lost", "lose",
            "disappear", "vanish", "go", "suffer", "different", "shift", "budge", "hurt",
            "changed", "change", "altered", "modified", "displaced")  # fmt: skip
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
    first = next((at for at, one in enumerate(clause) if one.get("rel") not in ("and", "but")), 0)
    if not clause[first:] or not clause[first].has("neg") or clause[first].state:
        return []
    ought = next((at for at, one in enumerate(clause) if at > first
                  and not one.noun and one.words[0] in _OUGHT), 0)  # fmt: skip
    done = [one for one in clause[ought + 1 :] if one.get("rel") not in ("be", "to", "or", "and")]
    alters = [one for one in done if one.get("verb") in _ALTERS or one.words[-1] in _ALTERED]
    if not ought or not done or len(alters) < len([one for one in done if one.kind != "function"]):
        return []
    keep = Item("phrase", clause[first].span, ("don't", "touch"), (("keep", "keep"),))
    whole = clause[first].words[0] in _NOTHING and not clause[first].words[1:]
    named = [Item("phrase", keep.span, ("anything",), (("noun", "place:everything"),))]
    for one in clause[ought:]:
        one.state, one.senses = READ, ()
    return [*clause[:first], keep, *(named if whole else []), *clause[first + 1 :]]
