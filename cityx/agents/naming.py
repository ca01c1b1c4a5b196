"""Naming: what a city calls its streets, buildings and places, found in what people write."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import fields, is_dataclass, replace
from typing import Any

from cityx.agents.brief import Brief
from cityx.agents.brief.lexicon import find
from cityx.agents.brief.words import words_of
from cityx.city import City

SHORTEST = 4  # letters of a name; shorter ones are words of other meaning, or ids already
_ALIAS = re.compile(r"(?<!\w)(n_\d+)(?!\w)")
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


def with_ids(text: str, names: tuple[str, ...]) -> tuple[str, Mapping[str, str]]:
    """Put an id in the place of every name in a text; all else keeps its place.

    Returns
    -------
    text
        As long as the one given.
    meant
        Id to the name that it stands for.
    """
    meant: dict[str, str] = {}
    lower = text.casefold()
    if len(lower) != len(text):
        return text, meant
    for name in names:
        if name.casefold() not in lower:
            continue
        alias = f"n_{len(meant) + 1}"
        if len(alias) > len(name):
            break
        pattern = re.compile(rf"(?<!\w){re.escape(name)}(?!\w)", re.IGNORECASE)
        changed = pattern.sub(alias.ljust(len(name)), text)
        if changed != text:
            text, meant[alias] = changed, name
    return text, meant


def renamed(brief: Brief, text: str, meant: Mapping[str, str]) -> Brief:
    """Return a brief that was read with ids with the names, and the text as it was."""
    return replace(_with_names(brief, meant), text=text) if meant else brief


def _with_names(value: Any, meant: Mapping[str, str]) -> Any:
    if isinstance(value, str):
        if value in meant:
            return meant[value]
        return _ALIAS.sub(lambda match: meant.get(match[1], match[0]), value)
    if isinstance(value, tuple):
        return tuple(_with_names(item, meant) for item in value)
    if is_dataclass(value) and not isinstance(value, type):
        held = {column.name: getattr(value, column.name) for column in fields(value)}
        return replace(value, **{key: _with_names(item, meant) for key, item in held.items()})
    return value
