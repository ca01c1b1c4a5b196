"""Measures: a quantity, what bounds it and what it is a measure of become one item."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from cityx.language.scan import ENDS, Item, Quantity

_TO = {"to", "-", "–", "—", "till", "until", "through"}
_BY = {"by", "x", "×", "*", "times"}
_HAS_ATTRIBUTE = {"length", "share", "floors", "angle", "speed", "area", "pair"}
_FLIPPED = {"over": "max", "under": "min", "": ""}
_PLAIN = {"over": "min", "under": "max"}
_LONGEST_PREFIX = 5
_UP = ("up", "upward", "upwards", "on")
_EXTREMES = ("maximum", "minimum", "max", "min")  # may stand before the noun: "maximum road width"


def join_measures(items: Sequence[Item]) -> list[Item]:
    """Join bounds, ranges, pairs and attributes with their quantities."""
    found: list[Item] = []
    at = 0
    while at < len(items):
        item, length = _measure(items, at, found)
        found.append(item)
        at += length
    return found


def _measure(items: Sequence[Item], at: int, before: Sequence[Item]) -> tuple[Item, int]:
    prefix = _prefix(items, at)
    if prefix is None:
        return items[at], 1
    end, bound, attribute, approximate = prefix
    quantity, end, ranged = _ranged(items, end, bound == "between")
    if bound == "between" and not ranged and not _open_range(items, end):
        return items[at], 1  # "between two houses"
    after, end = _attribute_after(items, end, quantity)
    attribute = attribute or after
    relative, end = _relative_after(items, end, quantity)
    late, end = _bound_after(items, end)
    if bound == "between" and not ranged and end < len(items) and items[end].text in _UP:
        late, end = "min", end + 1  # "from 2 floors up"
    bound = bound or _extreme(before)
    if bound in _PLAIN:
        denial = _denial(before)
        if denial is not None:
            denial.state = "read"
            bound = _FLIPPED[bound]
        elif not ranged:
            quantity = _beyond(quantity, bound)
        bound = _PLAIN.get(bound, bound)
    quantity = replace(
        quantity if ranged else _bounded(quantity, late or bound),
        attribute=attribute or relative.partition(" ")[0],
        relative={"over": 1, "under": -1}.get(relative.partition(" ")[2], quantity.relative),
        approximate=approximate,
    )
    taken = items[at:end]
    words = tuple(word for item in taken for word in item.words)
    span = (taken[0].span[0], taken[-1].span[1])
    return Item("quantity", span, words, quantity=quantity), end - at


def _beyond(quantity: Quantity, bound: str) -> Quantity:
    """Return the whole number past one that is not reached: "less than 40" are 39 at most."""
    value = quantity.exact
    if quantity.dimension not in ("count", "floors", "lanes") or value is None:
        return quantity
    past = value + 1.0 if bound == "over" else value - 1.0
    return replace(quantity, low=past, high=past) if past >= 0 else quantity


def _open_range(items: Sequence[Item], at: int) -> bool:
    """Return whether "up" follows: "from 2 floors up"."""
    return any(item.text in _UP for item in items[at : at + 2])


def _prefix(items: Sequence[Item], at: int) -> tuple[int, str, str, bool] | None:
    """Read the bounds before a quantity: its index, bound, attribute and whether it is "about"."""
    bound = attribute = ""
    approximate = False
    for end in range(at, min(at + _LONGEST_PREFIX, len(items))):
        item = items[end]
        if item.quantity is not None:
            return end, bound, attribute, approximate
        if item.has("compared") and item.words[-1] in ("than", "over"):
            attribute, _, bound = item.get("compared").partition(" ")
        elif item.has("bound"):
            bound = item.get("bound")
        elif item.has("approx"):
            approximate = True
        elif item.has("attr") and not item.has("noun", "height", "width", "strength", "verb"):
            attribute = item.get("attr")
        elif end > at and item.is_mark(".") and items[end - 1].text in _EXTREMES[2:]:
            continue  # "max. 5 floors"
        elif (end == at or not _joins(item)) and not item.has("exact"):
            return None
    return None


def _joins(item: Item) -> bool:
    return item.get("rel") in ("of", "be", "to") or item.text in ("the", "a", "an", "be", ":", "=")


def _ranged(items: Sequence[Item], at: int, between: bool) -> tuple[Quantity, int, bool]:
    """Read "80 to 150 m" or "600 x 400 m" from its first number."""
    first = items[at].quantity
    assert first is not None
    second_at = at + 2
    falling = between and at + 1 < len(items) and items[at + 1].text in ("down", "up")
    if falling and second_at < len(items) and items[second_at].text in _TO:
        second_at += 1  # "from 12 floors down to 2"
    if second_at < len(items) and items[second_at].has("approx", "bound"):
        second_at += 1
    up_to = between and at + 1 < len(items) and items[at + 1].get("bound") == "max"
    second = items[second_at].quantity if second_at < len(items) else None
    link = items[at + 1].text if at + 1 < len(items) else ""
    if second is None or second.low is None or first.low is None:
        return first, at + 1, False
    falling = falling and second_at > at + 2
    if link in _TO or up_to or falling or (between and items[at + 1].get("rel") == "and"):
        alike = _alike(first, second)
        if alike is not None:
            low, high = sorted(alike)
            first = replace(second if first.dimension == "count" else first, low=low, high=high)
            return first, second_at + 1, True
    if link == "or" and second_at == at + 2:
        alike = _alike(first, second)
        if alike is not None and alike[0] < alike[1]:  # "two or three floors"
            return replace(second, low=alike[0], high=alike[1]), second_at + 1, True
    if link in _BY:
        pair = _alike(first, second)
        if pair is not None and "length" in (first.dimension, second.dimension):
            sides = Quantity("pair", pair[0], pair[0], other=pair[1])
            end = second_at + 1
            return sides, end, True
    return first, at + 1, False


def _alike(first: Quantity, second: Quantity) -> tuple[float, float] | None:
    """Return two values in one unit; a bare number takes the other's."""
    assert first.low is not None
    assert second.low is not None
    if first.dimension == second.dimension:
        return first.low, second.low
    if first.dimension == "count":
        return first.low * second.unit, second.low
    if second.dimension == "count":
        return first.low, second.low * first.unit
    return None


def _attribute_after(items: Sequence[Item], at: int, quantity: Quantity) -> tuple[str, int]:
    if quantity.dimension not in _HAS_ATTRIBUTE or at >= len(items):
        return "", at
    at_word = at + 1 if items[at].is_mark("-") and at + 1 < len(items) else at
    item = items[at_word]
    if item.has("attr") and not item.has("slot"):
        return item.get("attr"), at_word + 1
    return "", at


def _relative_after(items: Sequence[Item], at: int, quantity: Quantity) -> tuple[str, int]:
    """Read "higher" in "20 m higher", which is a change and no bound.

    In "three taller houses" it tells of the houses, and not of how many there are.
    """
    item = items[at] if at < len(items) else None
    if quantity.dimension == "count" and any(one.noun for one in items[at + 1 : at + 2]):
        return "", at
    if item is None or not item.has("compared") or item.words[-1] in ("than", "over"):
        return "", at
    return item.get("compared"), at + 1


def _extreme(before: Sequence[Item]) -> str:
    """Return the bound of "maximum road gradient | 8 percent"."""
    for item in reversed(before[-_LONGEST_PREFIX:]):
        if item.get("bound") and item.text in _EXTREMES and not item.state:
            item.state = "read"
            return item.get("bound")
        if not (
            item.has("noun", "attr") or item.kind == "function" or item.get("rel") in ("of", "be")
        ):
            return ""
    return ""


def _bound_after(items: Sequence[Item], at: int) -> tuple[str, int]:
    """Read "or more" and "at most" behind a quantity, unless they belong to the next."""
    for step in (at, at + 1):
        if step >= len(items):
            break
        item = items[step]
        follows = step + 1 < len(items) and items[step + 1].quantity is not None
        if item.get("bound") in ("min", "max") and not follows:
            return item.get("bound"), step + 1
        if item.has("approx") and item.text == "or so":
            return "", step + 1
        if item.text == "odd" and step > at:
            return "", step + 1  # "thirty-odd houses"
        if not item.is_mark("-("):
            break
    return "", at


def _bounded(quantity: Quantity, bound: str) -> Quantity:
    if bound == "min":
        return replace(quantity, high=None)
    if bound == "max":
        return replace(quantity, low=None)
    return quantity


def _denial(before: Sequence[Item]) -> Item | None:
    """Return the "no" that turns the bound behind it: "no house may be taller than"."""
    for item in reversed(before):
        if item.has("neg") and not item.state:
            return item
        if item.is_mark(ENDS + ",") or item.get("rel") in ("and", "but", "with", "or"):
            return None
    return None
