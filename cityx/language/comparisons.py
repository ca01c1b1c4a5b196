"""Comparisons: "twice as many houses as shops", "nothing taller than the church".

Words that compare numbers or heights of two kinds of things are no wish for most of a town to be of
either. A factor between two kinds of buildings gives their shares; others are left open.
"""

from __future__ import annotations

from collections.abc import Sequence

from cityx.language.here import BUILDINGS, Findings
from cityx.language.scan import ENDS, Item
from cityx.language.scopes import NEGATED, READ
from cityx.town.elements import ELEMENTS

_MORE = ("more", "fewer", "less", "as many", "as few")
_THAN = ("than", "as")
_TIMES = {"twice": 2.0, "thrice": 3.0}
_NEAR = 4  # items between the words of a comparison and what it is with


def read_comparisons(found: Findings, items: Sequence[Item]) -> None:
    """Read what compares two kinds of things, before either is read by itself."""
    for at, item in enumerate(items):
        if item.state not in ("", NEGATED):
            continue
        if item.has("compared"):
            _nothing_taller(found, items, at)
        elif item.text == "only" and item.has("exact"):
            _only_one(found, items, at)
        elif item.noun_class and at:
            _in_number(found, items, at)


def _in_number(found: Findings, items: Sequence[Item], at: int) -> None:
    """Read "twice as many | houses as shops"."""
    first = at
    while first and at - first < _NEAR and _compares(items[first - 1]):
        first -= 1
    told = " ".join(word for one in items[first:at] for word in one.words)
    behind = items[at + 1 : at + 3]
    if len(behind) < 2 or behind[0].text not in _THAN or not behind[1].noun_class:
        return
    if not told.endswith(("many", *_MORE)):
        return
    other = behind[1]
    own = items[first : at + 3]
    factor = _factor(items[first:at])
    buildings = items[at].noun_class in BUILDINGS and other.noun_class in BUILDINGS
    if factor and buildings and "building" not in (items[at].noun, other.noun):
        for one, share in ((items[at], factor / (1 + factor)), (other, 1 / (1 + factor))):
            found.add(f"{one.noun}.share", round(share, 4), *own)
    else:
        for one in own:
            one.state = READ
        found.leave_span((own[0].span[0], own[-1].span[1]), "numbers compared with each other")


def _compares(item: Item) -> bool:
    counted = item.quantity is not None and item.quantity.dimension == "count"
    return counted or item.get("rel") in (*_TIMES, "times", "more", "to") or (
        item.text in (*_MORE, "many", "as", "times as", "times")
    )  # fmt: skip


def _factor(items: Sequence[Item]) -> float:
    """Return how many times as many there are, 0 where it is not told."""
    for item in items:
        if item.get("rel") in _TIMES:
            return _TIMES[item.get("rel")]
        if item.quantity is not None and item.quantity.exact:
            return item.quantity.exact
    return 1.0 if items and items[0].text in ("as", "as many") else 0.0


def _nothing_taller(found: Findings, items: Sequence[Item], at: int) -> None:
    """Read "nothing | taller than the church" as that the church is the tallest."""
    behind = [one for one in items[at + 1 : at + 4] if one.kind != "function"]
    thing = behind[0] if behind else None
    built = thing is not None and thing.noun in ELEMENTS and bool(ELEMENTS[thing.noun].building)
    first = at
    while first and not items[first].has("neg") and not items[first - 1].is_mark(ENDS + ",:"):
        first -= 1
    own = items[first:at]
    none = bool(own) and own[0].has("neg") and all(
        one.noun in ("building", "house", "") and not one.has("slot") for one in own
    )  # fmt: skip
    if items[at].get("compared") == "height over" and built and none and thing is not None:
        last = next(n for n, one in enumerate(items) if one is thing)
        for one in items[first:last]:
            one.state = READ
        found.add(f"{thing.noun}.height", "tallest", *items[first:last])


def _only_one(found: Findings, items: Sequence[Item], at: int) -> None:
    """Leave "the town hall is the | only building over 20 m": no other is so high."""
    noun, bound = [*items[at + 1 : at + 3], None, None][:2]
    if noun is None or bound is None or noun.noun_class not in BUILDINGS:
        return
    if bound.quantity is None or bound.quantity.dimension not in ("length", "floors"):
        return
    for one in (items[at], noun, bound):
        one.state = READ
    found.leave_span((items[at].span[0], bound.span[1]), "denied of the others")
