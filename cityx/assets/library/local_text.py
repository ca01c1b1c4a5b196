"""The local text encoder: words and pieces of words hashed to vectors. It is not CLIP.

It needs no weights and no network and gives the same bits everywhere. It knows letters and a small
thesaurus of city words, no pictures and no grammar: "no balcony" is near to "balcony".

References
----------
Weinberger and others, "Feature hashing for large scale multitask learning", ICML 2009.
"""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Mapping, Sequence
from functools import lru_cache
from pathlib import Path
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from cityx.assets.library.encoding import DIMENSION, Vectors, unit
from cityx.errors import UsageError
from cityx.ids import hash_ids, stable_id
from cityx.system.tables import load, table

VERSION = 1  # rises when a text gets another vector
# What a token counts: its concept says most, its letters help against misspelling.
CONCEPT_WEIGHT = 1.0
WORD_WEIGHT = 0.7
NUMBER_WEIGHT = 0.8
PIECE_WEIGHT = 0.18
PIECES = (3, 4)  # letters
SPREAD = 6  # coordinates a feature is written to; more make chance collisions matter less
MAX_WORDS = 200  # of a text; later ones do not count
# Concept -> words. A word may stand in several lines. Stems are looked up too, so plurals need no
# word of their own.
CONCEPTS = table("assets/thesaurus", str, "concepts")


class LocalText:
    """The encoder; it holds no state."""

    @property
    def identity(self) -> str:
        """Name and version; the name says what it is not."""
        return f"local-text/{VERSION}, not CLIP"

    @property
    def sees(self) -> bool:
        """It encodes no pictures."""
        return False

    def encode_text(self, texts: Sequence[str]) -> Vectors:
        """Return (n, 768) unit vectors of texts."""
        sums = np.zeros((len(texts), DIMENSION))
        for row, text in enumerate(texts):
            for token in words_of(text):
                sums[row] += _vector_of(token)
        return unit(sums)

    def encode_images(self, paths: Sequence[Path]) -> Vectors:
        """Refuse: letters say nothing about pictures.

        Raises
        ------
        UsageError
            Always.
        """
        raise UsageError(
            f"The encoder {self.identity}, encodes no pictures ({len(paths)} given); use clip."
        )


def words_of(text: str) -> list[str]:
    """Split a text into plain lower-case words and numbers, without words that say nothing."""
    plain = unicodedata.normalize("NFKD", text).encode("ascii", "ignore").decode().lower()
    found = re.findall(r"[a-z]+|\d+(?:\.\d+)?", plain)
    return [NUMBER_WORDS.get(w, w) for w in found if w not in STOP_WORDS][:MAX_WORDS]


def _stem(word: str) -> str:
    """Take endings off that do not change what is meant: houses, tiled, glazing."""
    for ending, rest in (("ies", "y"), ("sses", "ss"), ("ings", ""), ("ing", ""), ("ed", ""),
                         ("es", ""), ("s", "")):  # fmt: skip
        if word.endswith(ending) and len(word) - len(ending) >= 3 and not word.endswith("ss"):
            return word[: len(word) - len(ending)] + rest
    return word


@lru_cache(maxsize=16384)
def _vector_of(token: str) -> NDArray[np.float64]:
    """Return the (768,) sum of all features of one word or number."""
    if token[0].isdigit():
        return np.asarray(NUMBER_WEIGHT * _number(float(token)))
    stem = _stem(token)
    total = WORD_WEIGHT * _feature("word", stem)
    for concept in CONCEPTS_OF.get(token, CONCEPTS_OF.get(stem, ())):
        total = total + CONCEPT_WEIGHT * _feature("concept", concept)
    framed = f"<{stem}>"
    for size in PIECES:
        for start in range(max(len(framed) - size + 1, 0)):
            total = total + PIECE_WEIGHT * _feature("piece", framed[start : start + size])
    return total


def _number(value: float) -> NDArray[np.float64]:
    """Return a vector that is near for numbers of like size: bins of their logarithm, blended."""
    place = 4.0 * np.log2(1.0 + min(value, 1e9))
    low = int(np.floor(place))
    share = place - low
    near = (1 - share) * _feature("number", str(low))
    return np.asarray(near + share * _feature("number", str(low + 1)))


@lru_cache(maxsize=65536)
def _feature(kind: str, word: str) -> NDArray[np.float64]:
    """Return the (768,) vector of one feature: signs at a few hashed coordinates."""
    key = np.uint64(stable_id("local-text", VERSION, kind, word))
    bits = hash_ids(0, "local-text", np.full(SPREAD, key), np.arange(SPREAD))
    out = np.zeros(DIMENSION)
    at = (bits % np.uint64(DIMENSION)).astype(np.int64)
    np.add.at(out, at, np.where(bits >> np.uint64(63) == 1, 1.0, -1.0) / np.sqrt(SPREAD))
    return out


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
