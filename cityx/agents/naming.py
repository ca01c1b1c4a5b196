"""Naming: what a city calls its streets, buildings and places."""

from __future__ import annotations

from cityx.agents.brief.lexicon import find
from cityx.agents.brief.words import words_of
from cityx.city import City

SHORTEST = 4  # letters of a name; shorter ones are words of other meaning, or ids already
_TABLES = ("buildings", "roads", "areas")


def names_of(city: City) -> tuple[str, ...]:
    """Return the names that things of a city have and that say nothing else, longest first."""
    found: set[str] = set()
    for table in _TABLES:
        found |= {str(name) for name in getattr(city.layout, table)["name"].unique()}
    return tuple(sorted(filter(_is_name, found), key=lambda name: (-len(name), name)))


def _is_name(name: str) -> bool:
    """Tell whether a name is read as such: no id, and no phrase such as "main street"."""
    if len(name) < SHORTEST:
        return False
    words = words_of(name)
    if len(words) == 1 and words[0].kind == "id":
        return False
    phrase = find(words, 0) if words else None
    return phrase is None or phrase[1] < len(words)
