"""Bounds: "no house may be higher than 9 m" as a change of those that are."""

from __future__ import annotations

from collections.abc import Sequence

from cityx.language.brief import Edit, Selector
from cityx.language.commands.selection import kind_of
from cityx.language.scan import Item, Quantity
from cityx.language.scopes import KEPT

_MEASURES = {"length": "height", "floors": "floors"}
_ALL = ("all", "every")


def bounds_of(clause: Sequence[Item]) -> Edit | None:
    """Return what brings buildings within a bound that is told of all of a kind, None for others.

    Sentences that say anything else of them are commands of another kind.
    """
    said = [item for item in clause if item.kind not in ("function", "mark") and item.state != KEPT]
    said = [item for item in said if not item.has("except", "keep")]
    said = [item for item in said if item.get("rel") not in ("and", "but")]
    denied = bool(said) and said[0].has("neg")
    whole = denied or (bool(said) and said[0].get("rel") in _ALL)
    inner = [item for item in said[1:] if not _is_be(item) and item.get("rel") != "please"]
    if not whole or len(inner) != 2 or not (denied or any(map(_is_be, said))):
        return None
    noun, bound = inner
    if noun.noun_class == "road" and bound.quantity is not None:
        return _of_street(noun, bound.quantity)
    if not any(map(_is_be, said)):
        return None
    quantity = bound.quantity
    if (
        quantity is None
        or quantity.exact is not None
        or noun.noun_class not in ("building", "type")
    ):
        return None
    name = quantity.attribute or _MEASURES.get(quantity.dimension, "")
    if name not in ("height", "floors"):
        return None
    return _within(kind_of(noun), name, quantity)


def _of_street(noun: Item, quantity: Quantity) -> Edit | None:
    """Return what makes streets or their walks as wide as all must be: "no pavement below 2 m"."""
    if quantity.attribute not in ("width", "") or quantity.dimension != "length":
        return None
    low = quantity.low
    if low is None or quantity.high is not None:
        return None  # what is too wide keeps its use
    value = int(low) if low == int(low) else low
    if noun.noun == "sidewalk":
        return Edit("set_walks", Selector("road"), (("walk.min", value),))
    kind = kind_of(noun)
    return Edit("set_width", Selector(kind, filters=(f"width<{low:g}",)), (("width.min", value),))


def _is_be(item: Item) -> bool:
    return item.get("rel") == "be" or item.text in ("have", "has")


def _within(kind: str, name: str, quantity: Quantity) -> Edit | None:
    low, high = quantity.low, quantity.high  # a "no" has turned them
    if (low is None) == (high is None):
        return None
    end, sign, value = ("max", ">", high) if low is None else ("min", "<", low)
    assert value is not None
    number = int(value) if value == int(value) else value
    target = Selector(kind, filters=(f"{name}{sign}{value:g}",))
    return Edit(f"set_{name}", target, ((f"{name}.{end}", number),))
