"""Totals: things of one kind that are counted in parts: "20 detached houses and 30 semis"."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import combinations

from cityx.language.brief import Slot
from cityx.language.here import BUILDINGS, Findings
from cityx.language.lexicon.words import forms_of
from cityx.language.scan import Item
from cityx.language.scopes import READ
from cityx.language.syntax import Phrase, Syntax

_ONE = ("a", "an", "one")
_COUNTED = (*BUILDINGS, "element")


def sum_up(found: Findings, items: Sequence[Item], syntax: Syntax) -> None:
    """Let the parts of a list in which one kind of things is counted be counted together.

    What the parts tell apart ("semis") is not what is built; their sum is how many there are.
    """
    for parts in _lists(items, syntax):
        noun = items[parts[0].head].noun
        keys = (f"{noun}.count", "building.count") if _is_building(items, parts) else (
            f"{noun}.count",)  # fmt: skip
        own = [
            slot for slot in found.slots
            if slot.key in keys and any(_stands_in(slot, items, part) for part in parts)
        ]  # fmt: skip
        if not own and not any(slot.value == noun for slot in found.slots):
            continue  # nothing was read of them
        found.slots[:] = [slot for slot in found.slots if slot not in own]
        total = sum(_number(items[part.first]) for part in parts)
        told = [items[part.first] for part in parts] + [items[part.head] for part in parts]
        found.add(f"{noun}.count", total, *told)


def _lists(items: Sequence[Item], syntax: Syntax) -> Iterator[list[Phrase]]:
    """Yield the phrases of a list that have one noun, each with a number, in different words."""
    phrases = [syntax.phrase(at) for at in range(len(items))]
    heads = [one for at, one in enumerate(phrases) if one is not None and one.head == at]
    counted = [one for one in heads if items[one.head].noun_class in _COUNTED
               and items[one.head].state == READ and _number(items[one.first])]  # fmt: skip
    while counted:
        first, *rest = counted
        same = [first]
        for one in rest:
            noun = items[one.head].noun == items[first.head].noun
            if noun and _is_listed(items, syntax, same[-1], one):
                same.append(one)
        counted = [one for one in rest if one not in same]
        if len(same) > 1 and not any(_are_alike(items, *pair) for pair in combinations(same, 2)):
            yield same


def _is_listed(items: Sequence[Item], syntax: Syntax, one: Phrase, other: Phrase) -> bool:
    """Return whether a phrase follows another in a list, of other things too."""
    return all(
        item.is_mark(",") or item.get("rel") in ("and", "or") or syntax.phrase(at) is not None
        for at, item in enumerate(items[one.end : other.first], one.end)
    )


def _are_alike(items: Sequence[Item], one: Phrase, other: Phrase) -> bool:
    """Return whether two phrases have the same words behind their numbers: "houses", "house"."""
    words = [[word for item in items[part.first + 1 : part.head + 1] for word in item.words]
             for part in (one, other)]  # fmt: skip
    forms = [set(forms_of(part[-1])) for part in words]
    return words[0][:-1] == words[1][:-1] and not forms[0].isdisjoint(forms[1])


def _number(item: Item) -> float:
    """Return the number that an article or a number is, 0 for none."""
    if item.quantity is not None and item.quantity.dimension == "count":
        return item.quantity.exact or 0.0
    return float(item.text in _ONE)


def _is_building(items: Sequence[Item], parts: Sequence[Phrase]) -> bool:
    return items[parts[0].head].noun_class in BUILDINGS


def _stands_in(slot: Slot, items: Sequence[Item], part: Phrase) -> bool:
    """Return whether the words of a slot begin in a phrase."""
    return items[part.first].span[0] <= slot.span[0] < items[part.head].span[1]
