"""A small thesaurus of city words: words of one line mean nearly the same."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from cityx.system.tables import load, table

# Concept -> words. A word may stand in several lines. Stems are looked up too, so plurals need no
# word of their own.
CONCEPTS = table("assets/thesaurus", str, "concepts")


def _by_word(table: Mapping[str, str]) -> dict[str, tuple[str, ...]]:
    found: dict[str, list[str]] = {}
    for concept, words in table.items():
        for word in dict.fromkeys([*concept.split(), *words.split()]):
            if " " not in concept or word in words.split():
                found.setdefault(word, []).append(concept)
    return {word: tuple(concepts) for word, concepts in found.items()}


CONCEPTS_OF: Mapping[str, tuple[str, ...]] = MappingProxyType(_by_word(CONCEPTS))

STOP_WORDS = load("assets/thesaurus", frozenset[str], "stop_words")

NUMBER_WORDS = table("assets/thesaurus", str, "numbers")
