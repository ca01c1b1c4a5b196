"""The lexicon: phrases of the book, found in a text by their longest match."""

from __future__ import annotations

import unicodedata
from collections.abc import Sequence
from functools import cache, lru_cache
from typing import Any

from cityx.language.lexicon.numbers import NUMBER_WORDS
from cityx.language.lexicon.phrases import FUNCTION_WORDS, entries
from cityx.language.lexicon.units import UNITS
from cityx.language.lexicon.words import Word, forms_of, words_of
from cityx.system.extensions import remembered

Sense = tuple[str, str]  # what kind of words these are, and what they say
_SENSES = ""  # where a node of the tree keeps what the phrase that ends there says
_LONGEST_PHRASE = 9
Node = dict[str, "Node | tuple[Sense, ...]"]

# Spelling: at least this like a known word, at most this much longer or shorter, and long enough
# that the likeness means something. Looser settings take "pedestrains" for rain.
LIKENESS = 88.0
LENGTH_APART = 2
SHORTEST = 5
FEW_STRANGE = 3  # words of a text in another language, at least


@remembered
def tree() -> Node:
    """Return the phrases as a tree of words; a phrase of two kinds has both senses."""
    root: Node = {}
    for kind, value, triggers in entries():
        for trigger in triggers.split(", "):
            node = root
            for word in words_of(trigger.strip()):
                if word.text != "-":
                    node = node.setdefault(word.text, {})  # type: ignore[assignment]
            known = node.get(_SENSES, ())
            if (kind, value) not in known:
                node[_SENSES] = (*known, (kind, value))
    return root


@remembered
def vocabulary() -> frozenset[str]:
    """Return every single word that some phrase, unit or rule knows."""
    return _meaning() | FUNCTION_WORDS


@remembered
def _meaning() -> frozenset[str]:
    """Return the words of phrases, numbers and units."""
    words = {*NUMBER_WORDS}
    words.update(word for unit in UNITS for word in unit)
    pending = [tree()]
    while pending:
        node = pending.pop()
        for word, below in node.items():
            if word != _SENSES:
                words.add(word)
                pending.append(below)  # type: ignore[arg-type]
    return frozenset(words)


def find(words: Sequence[Word], at: int) -> tuple[tuple[Sense, ...], int] | None:
    """Find the longest phrase that begins at a word.

    Returns
    -------
    found
        The senses of the phrase and the number of words it takes.
    """
    best: tuple[tuple[Sense, ...], int] | None = None
    pending: list[tuple[Node, int, int]] = [(tree(), at, 0)]
    while pending:
        node, end, depth = pending.pop()
        senses = node.get(_SENSES)
        # The exact word was pushed last, so that of two equally long matches it wins.
        if senses and (best is None or end - at > best[1]):
            best = senses, end - at  # type: ignore[assignment]
        if end >= len(words) or depth >= _LONGEST_PHRASE:
            continue
        if depth and words[end].text == "-" and end + 1 < len(words):
            end += 1
        for form in reversed(forms_of(words[end].text)):
            below = node.get(form)
            if below is not None and form:
                pending.append((below, end + 1, depth + 1))  # type: ignore[arg-type]
    return best


def is_verbal(word: str) -> bool:
    """Return whether a word stands in the book only as what it is an inflection of."""
    below = tree().get(word)
    return not (isinstance(below, dict) and _SENSES in below)


def known(word: str) -> bool:
    """Return whether a word, or what it is an inflection of, stands in the book."""
    return any(form in vocabulary() for form in forms_of(word))


@lru_cache(maxsize=4096)
def mended(word: str) -> str | None:
    """Return the word of the book that a misspelt one means, or None."""
    if len(word) < SHORTEST or known(word):
        return None
    from rapidfuzz import fuzz, process

    alike = _by_letter().get(word[0], ())
    near = [one for one in alike if abs(len(one) - len(word)) <= LENGTH_APART]
    found = process.extractOne(word, near, scorer=fuzz.ratio, score_cutoff=LIKENESS)
    return None if found is None or _is_english(word) else found[0]


def _is_english(word: str) -> bool:
    """Return whether a word, or what it is an inflection of, is one of English: "stoops"."""
    return any(form in _dictionary() for form in forms_of(word))


def is_foreign(text: str) -> bool:
    """Return whether most of the words of a text are none of English."""
    words = [word.text for word in words_of(text) if word.kind == "word"]
    strange = [word for word in words if not (known(word) or word in _dictionary())]
    letters = [letter for letter in text if letter.isalpha()]
    other = sum(unicodedata.name(letter, "").partition(" ")[0] != "LATIN" for letter in letters)
    few = len(strange) >= FEW_STRANGE and 2 * len(strange) >= len(words)
    return few or 2 * other > len(letters)


@cache
def _dictionary() -> Any:
    """Return the words of English; a second passes at the first."""
    from spellchecker import SpellChecker

    return SpellChecker(language="en", distance=1)


@remembered
def _by_letter() -> dict[str, tuple[str, ...]]:
    found: dict[str, list[str]] = {}
    for word in sorted(_meaning()):  # what was misspelt meant something
        if len(word) >= SHORTEST - 1 and word.isalpha():
            found.setdefault(word[0], []).extend([word, *_plural(word)])
    return {letter: tuple(dict.fromkeys(words)) for letter, words in found.items()}


def _plural(word: str) -> tuple[str, ...]:
    return () if word.endswith("s") else (word + "s",)
