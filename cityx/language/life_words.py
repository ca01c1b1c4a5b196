"""Life: what part of the vehicles is of a kind, as "a third of the traffic should be trucks"."""

from __future__ import annotations

from collections.abc import Sequence

from cityx.language.here import Here
from cityx.language.scan import ENDS, Item
from cityx.language.scopes import NEGATED, READ

# Kinds of vehicles of which traffic can have a share.
MIXED = ("van", "truck", "bus", "motorcycle", "bicycle")
_MOSTLY = ("mostly", "mainly", "largely", "predominantly", "chiefly", "primarily", "most")
MOST = 0.5  # of the vehicles at least, of those that are mostly of a kind
_NEAR = 3  # items between a word for most and the kind


def read_mix(here: Here) -> None:
    """Read a share of the vehicles with the kind that it is of."""
    item = here.item
    if item.text in _MOSTLY:
        kind = _kind(here.items[here.at + 1 : here.at + 1 + _NEAR])
        if kind is not None:
            here.found.add(f"{kind.noun}.share.min", MOST, item, kind)
        return
    quantity = item.quantity
    if quantity is None or quantity.dimension not in ("share", "part"):
        return
    behind = _clause_behind(here)
    if not any(one.noun in MIXED for one in behind):
        _read_part_of_all(here, behind)
        return
    kind, whole = _kind(behind), next((one for one in behind if one.noun == "vehicle"), None)
    if kind is None or (whole is None and behind[0] is not kind and behind[0].get("rel") != "of"):
        return
    if any(one.has("noun") and one not in (kind, whole) for one in behind[: behind.index(kind)]):
        return  # "half of the houses have trucks before them"
    here.found.add_bounded(f"{kind.noun}.share", quantity, item, kind)
    if whole is not None:
        whole.state = whole.state or READ


def _read_part_of_all(here: Here, behind: list[Item]) -> None:
    """Read "buses make up | 20 % of the traffic"."""
    whole = next((one for one in behind if one.noun == "vehicle"), None)
    before = [one for one in here.before_in_clause() if one.noun in MIXED]
    linked = (bool(behind) and behind[0].get("rel") == "of") or here.item.text.endswith("of")
    if whole is None or not before or not linked or here.quantity is None:
        return
    kind = before[-1]
    here.found.add_bounded(f"{kind.noun}.share", here.quantity, here.item, kind)
    whole.state = whole.state or READ
    for one in here.before_in_clause():
        if one.span > kind.span and one.text in _MAKE_UP:
            one.state = one.state or READ


_MAKE_UP = ("make", "make up", "up", "making up", "account for", "being", "are")


def _kind(items: Sequence[Item]) -> Item | None:
    for item in items:
        if item.is_mark(ENDS):
            return None
        if item.noun in MIXED and item.state in ("", READ):
            return item
    return None


def _clause_behind(here: Here) -> list[Item]:
    """Return the items behind, to the next mark or word that begins another phrase."""
    found: list[Item] = []
    for item in here.items[here.at + 1 :]:
        if item.is_mark(ENDS + ",") or item.quantity is not None or item.state == NEGATED:
            break
        found.append(item)
    return found
