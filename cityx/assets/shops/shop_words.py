"""Shop words: what stands over a shop whose name no map tells, by language and kind of shop."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from typing import NamedTuple

from cityx.system.tables import DATA, read_table

Words = Mapping[str, tuple[str, ...]]
WORLD = "world"  # words understood nearly everywhere, for languages that are not in the table


class ShopWords(NamedTuple):
    """The table ``shop_words.toml``.

    Attributes
    ----------
    kinds
        Tags of shop=* and amenity=* -> kind of shop.
    usual
        What shops sell where nothing is known, and how often.
    words
        Language -> kind of shop -> words.
    """

    kinds: Mapping[str, str]
    usual: Mapping[str, float]
    words: Mapping[str, Words]


@cache
def shop_words() -> ShopWords:
    """Read the table."""
    read = read_table(DATA / "shop_words.toml")
    return ShopWords(
        {tag: kind for kind, tags in read["kinds"].items() for tag in tags.split()},
        read["usual"],
        {
            tongue: {kind: tuple(words) for kind, words in table.items()}
            for tongue, table in read["words"].items()
        },
    )


def words_of(tongue: str) -> Words:
    """Return the words of a language by kind of shop."""
    words = shop_words().words
    return words.get(tongue, words[WORLD])
