"""Naming: what a city calls its streets, buildings, places and drawn curves."""

from __future__ import annotations

import re

from cityx.city import City
from cityx.city.layout import CURVE
from cityx.language.lexicon.lexicon import find
from cityx.language.lexicon.words import fold, words_of

SHORTEST = 4  # letters of a name; shorter ones are words of other meaning, or ids already
_PARTS = re.compile(r"[^\W_]+(?:['’][^\W_]+)*")
_TABLES = ("buildings", "roads", "areas")


def names_of(city: City, text: str) -> tuple[str, ...]:
    """Return the names of things of a city that share a word with a text, longest first.

    Names that say something else, such as "main street", are none unless they are written just so,
    as "High Street". There are thousands in a city.
    """
    said = {word.text for word in words_of(text)}
    found: set[str] = set()
    for table in _TABLES:
        found |= {str(name) for name in getattr(city.layout, table)["name"].unique()}
    lines = city.layout.lines
    found |= set(map(str, lines["source"][lines["kind"].to_numpy() == CURVE]))
    near = [name for name in found if not said.isdisjoint(map(fold, _PARTS.findall(name)))]
    named = (name for name in near if _is_name(name) or _is_written(name, text))
    return tuple(sorted(named, key=lambda name: (-len(name), name)))


def _is_name(name: str) -> bool:
    """Return whether a name is read as such: no id, and no phrase such as "main street"."""
    if len(name) < SHORTEST:
        return False
    words = words_of(name)
    if len(words) == 1 and words[0].kind == "id":
        return False
    phrase = find(words, 0) if words else None
    return phrase is None or phrase[1] < len(words)


def _is_written(name: str, text: str) -> bool:
    """Return whether a text has a name of several words with its capitals."""
    return " " in name and not name.islower() and name in text
