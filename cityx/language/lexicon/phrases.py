"""The phrase book: the words an instruction may use, by what they say.

The words are data, in `cityx/data/language`.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from functools import lru_cache
from types import MappingProxyType

from cityx.assets.outside_words import (
    brings_buildings,
    outside_pieces,
    outside_styles,
    outside_trees,
)
from cityx.system.extensions import remembered
from cityx.system.tables import load, table
from cityx.town.elements import ELEMENTS, Element

Book = Mapping[str, Mapping[str, str]]

# Key of a slot -> value -> triggers, then those that say several things at once.
SLOTS: Book = table("language/phrases", dict[str, str])
TOGETHER = table("language/together", str)
# Class -> canonical noun -> triggers. "type" are types of building.
NOUNS: Book = table("language/nouns", dict[str, str])
# Kind of words -> what they say -> triggers, of the words that need others beside them.
TABLES: Book = table("language/words", dict[str, str], "tables")
LISTS = table("language/words", str, "lists")  # the same where the kind says all
VERBS = TABLES["verb"]
FUNCTION_WORDS = load("language/spelling", frozenset[str], "function_words")
AMBIGUOUS = load("language/spelling", frozenset[str], "ambiguous")
HOMONYMS = load("language/spelling", frozenset[str], "homonyms")
# Which of them begin a noun phrase, and which may stand inside; the others end one.
PARTS_OF_SPEECH = table("language/spelling", frozenset[str], "parts_of_speech")
SPECIES = table("language/things", tuple[str, ...], "species")  # kind of tree -> nouns that name it
# Words for a part of a building -> the first word of the prototypes that are such parts.
PARTS = table("language/things", str, "parts")
_OF = r"\s+(?:of|on|from|off|at)\b"  # what joins a part to what it is of
SHOWN = 3  # words of an element in the table of elements


def part_named(text: str) -> str:
    """Return the part of a building that a word names, "" for none."""
    return next((part for word, part in PARTS.items() if re.fullmatch(word, text)), "")


@lru_cache(maxsize=1)
def _colors() -> tuple[str, ...]:
    """Return the words for colours, which may stand behind a part: "the doors red on b03"."""
    return tuple(
        word for words in TABLES["color"].values() for word in " ".join(words.split()).split(", ")
    )


def part_of(text: str) -> str:
    """Return the part of something else that a command is about, "" for none."""
    painted = "|".join(sorted(map(re.escape, _colors()), key=len, reverse=True))
    said = [
        (found.start(), part)
        for word, part in PARTS.items()
        if (found := re.search(rf"\b{word}(?:\s+(?:{painted}))?{_OF}", text, re.IGNORECASE))
        is not None
    ]
    return min(said)[1] if said else ""


def entries() -> Iterator[tuple[str, str, str]]:
    """Yield kind, value and triggers of everything in the phrase book."""
    for key, values in SLOTS.items():
        for value, triggers in values.items():
            yield "slot", f"{key}={value}", triggers
    for style in sorted(outside_styles() - set(SLOTS["style"])):
        yield "slot", f"style={style}", style.replace("_", " ")
    for several, triggers in TOGETHER.items():
        yield "slot", several, triggers
    outside = {word for words in outside_types().values() for word in words}
    for group, names in NOUNS.items():
        for noun, triggers in names.items():
            own = ", ".join(word for word in triggers.split(", ") if word not in outside)
            yield "noun", f"{group}:{noun}", own
    for noun, words in outside_types().items():
        yield "noun", f"type:{noun}", ", ".join(words)
    for noun, piece in outside_pieces().items():
        spoken = dict.fromkeys((noun.replace("_", " "), *piece.words))
        yield "noun", f"element:{noun}", ", ".join(spoken)
    trees = dict.fromkeys(word for tree in outside_trees().values() for word in tree.words)
    if trees:
        yield "noun", "plant:tree", ", ".join(trees)
    for kind, values in TABLES.items():
        for value, triggers in values.items():
            yield kind, value, triggers
    for kind, triggers in LISTS.items():
        yield kind, kind, triggers


def table_of_elements() -> str:
    """Return what towns can be asked to hold as a table of Markdown, with some of its words."""
    words = {noun: said.split(", ") for group in NOUNS.values() for noun, said in group.items()}
    rows = [
        f"| {', '.join(words[name][:SHOWN])} | {_lot(one)} | `{one.measure}` |"
        for name, one in ELEMENTS.items()
    ]
    return "\n".join(["| words | lot, m | measured as |", "| --- | --- | --- |", *rows])


def _lot(element: Element) -> str:
    return "line" if element.builder else "{:g}x{:g}".format(*element.lot)


@remembered
def outside_types() -> Mapping[str, tuple[str, ...]]:
    """Return the types of building that installed packages add, with the words for them.

    A word for a type of CityX goes to a package that brings just that ("silo" says a barn until
    there is one), but the types' own names do not, nor words that mean anything else.
    """
    if not brings_buildings():
        return {}
    # With libraries that a reader need not load.
    from cityx.assets.styles.package_generators import outside_buildings

    own = {noun.replace("_", " ") for noun in NOUNS["type"]}
    held = own | {
        trigger for group, names in NOUNS.items() if group != "type"
        for triggers in names.values() for trigger in triggers.split(", ")
    }  # fmt: skip
    found = {
        name: tuple(word for word in made.words if word not in held)
        for name, made in outside_buildings().items()
        if name not in NOUNS["type"]
    }
    return MappingProxyType({name: words for name, words in found.items() if words})
