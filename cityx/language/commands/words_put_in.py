"""Words put in: items of what an order leaves out, and what short forms are told by."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence

from cityx.language.scan import ENDS, Item

LOOKS = ("color", "material")
ROOFS = "building.roof="
LAND = ("land", "area", "space", "ground", "site", "spot", "plot", "gap", "lot")  # not built on
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


def sentences_of(items: Sequence[Item]) -> Iterator[list[Item]]:
    """Yield the sentences of a request, and what stands before a colon, each with its mark."""
    begin = 0
    for end, item in enumerate(items, start=1):
        if item.is_mark(ENDS + ":") or end == len(items):
            yield list(items[begin:end])
            begin = end


def by_sentence(items: Sequence[Item], mend: Callable[[list[Item]], list[Item]]) -> list[Item]:
    """Return the items of a request with each of its sentences mended."""
    return [item for sentence in sentences_of(items) for item in mend(sentence)]


def removes(items: Iterable[Item]) -> bool:
    """Return whether something is told to go: "demolish", "pull down", "take out"."""
    return any(one.get("verb") == "REMOVE" or one.text in _GONE for one in items)


_GONE = ("knock", "pull", "tear", "take")


def is_share(item: Item) -> bool:
    """Return whether an item is a part of things: "half of", "20 %"."""
    return item.quantity is not None and item.quantity.dimension in ("part", "share")
