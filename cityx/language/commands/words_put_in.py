"""Words put in: items of what an order leaves out, and what short forms are told by."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from cityx.language.scan import Item

LOOKS = ("color", "material")
ROOFS = "building.roof="
ARTICLES = ("a", "an", "one", "another", "some")


def here(item: Item, word: str, *senses: tuple[str, str], kind: str = "phrase") -> Item:
    """Return a word that goes without saying, at the place of an item."""
    at = item.span[0]
    return Item(kind, (at, at), (word,), senses)


def content(sentence: Sequence[Item]) -> list[Item]:
    """Return the words of a sentence that say something."""
    return [one for one in sentence if one.kind not in ("function", "mark")
            and one.get("rel") not in ("please", "and", "but")]  # fmt: skip


def asked(items: Iterable[Item]) -> None:
    """Take the sense from words that no rule can read right, so that they are asked about."""
    for one in items:
        one.kind, one.senses, one.quantity, one.state = "unknown", (), None, ""


def is_share(item: Item) -> bool:
    """Return whether an item is a part of things: "half of", "20 %"."""
    return item.quantity is not None and item.quantity.dimension in ("part", "share")
