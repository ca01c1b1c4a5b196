"""Syntax: the noun phrases of an instruction, their heads, and what a word belongs to."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from cityx.language.lexicon.numbers import EVERY_SO_MANY
from cityx.language.lexicon.phrases import PARTS_OF_SPEECH
from cityx.language.scan import ENDS, Item

_COUNTS = ("count", "part", "share", "people")  # quantities that begin a noun phrase
_APART = ("hour", "temperature", "duration", "speed")  # and those that stand in none
_ADJECTIVES = (
    "material", "color", "size", "height", "width", "strength", "rank", "ordinal", "surface",
    "direction", "side", "axis", "use", "attr", "degree", "strip", "shade",
)  # fmt: skip
_BEHIND_NOUNS = ("outside", "overhead", "underneath", "beyond", "below")
_ADVERBS = ("straight", "right", "directly", "just", "dead")
_BEGINS, _BREAKS, _HEAD, _ADJECTIVE = "begins", "breaks", "head", "adjective"
_IRREGULAR_PLURALS = ("people", "children", "men", "women", "folk", "traffic")


@dataclass(frozen=True)
class Phrase:
    """A noun phrase: items from `first` to before `end`, and the index of its head or -1."""

    first: int
    end: int
    head: int


class Syntax:
    """The noun phrases of an instruction.

    A phrase ends at marks, prepositions, conjunctions, verbs and the next article or number; its
    head is its last noun, known or not. A measure before the head is part of the phrase, one
    behind it ends it. Plural nouns are no modifiers: a word behind one is of the next phrase.
    """

    def __init__(self, items: Sequence[Item]) -> None:
        self.items = items
        self._phrase: list[Phrase | None] = [None] * len(items)
        self._index = {id(item): at for at, item in enumerate(items)}
        at = 0
        while at < len(items):
            phrase = _phrase(items, at)
            self._phrase[phrase.first : phrase.end] = [phrase] * (phrase.end - phrase.first)
            at = max(phrase.end, at + 1)

    def index(self, item: Item) -> int:
        """Return where an item stands."""
        return self._index[id(item)]

    def phrase(self, at: int) -> Phrase | None:
        """Return the phrase that an item is part of."""
        return self._phrase[at]

    def head_behind(self, at: int) -> int:
        """Return the head that an item in front of it belongs to, or -1; past "of"."""
        phrase = self._phrase[at]
        if phrase is None:
            return -1
        if phrase.head > at:
            return phrase.head
        of = phrase.end < len(self.items) and self.items[phrase.end].get("rel") == "of"
        if phrase.head >= 0 or not of:
            return self._shared(phrase) if phrase.head < 0 else -1
        return self.object_of(phrase.end)

    def _shared(self, phrase: Phrase) -> int:
        """Return the head that looks in a row share: "red, yellow and green | doors"."""
        joined, at = False, phrase.end
        while at + 1 < len(self.items):
            link, behind = self.items[at], self._phrase[at + 1]
            joined = joined or link.get("rel") in ("and", "or")
            if not (link.is_mark(",") or joined) or behind is None:
                return -1
            if not self.items[behind.first].has("color", "material"):
                return -1
            if behind.head >= 0 or behind.end <= at:
                return behind.head if joined else -1
            at = behind.end
        return -1

    def head_before(self, at: int, *, past_comma: bool = False) -> int:
        """Return the head of the nearest phrase before an item in its sentence, or -1."""
        own = self._phrase[at]
        if own is not None and -1 < own.head < at:
            return own.head
        for index in range((at if own is None else own.first) - 1, -1, -1):
            phrase = self._phrase[index]
            if phrase is not None and phrase.head >= 0:
                return phrase.head
            if self.items[index].is_mark(ENDS if past_comma else ENDS + ","):
                return -1
        return -1

    def owner(self, at: int, *, past_comma: bool = False) -> int:
        """Return the head that an item belongs to: of its own phrase, else of the one before."""
        behind = self.head_behind(at)
        return behind if behind >= 0 else self.head_before(at, past_comma=past_comma)

    def object_of(self, at: int) -> int:
        """Return the head of the phrase that a preposition stands before, or -1."""
        for index in range(at + 1, min(at + 3, len(self.items))):
            phrase = self._phrase[index]
            if phrase is not None:
                return phrase.head
            if self.items[index].is_mark(ENDS + ","):
                return -1
        return -1

    def joined(self, one: int, other: int) -> bool:
        """Return whether two heads are joined by "and", "or" or commas alone."""
        for at in range(min(one, other) + 1, max(one, other)):
            item = self.items[at]
            link = item.is_mark(",") or item.get("rel") in ("and", "or") or item.kind == "function"
            if not link and (self._phrase[at] is None or item.has(*_ADJECTIVES, "amount")):
                return False
        return True

    def modifies(self, at: int) -> int:
        """Return the head that a noun stands before as its modifier, or -1: "church | bells"."""
        phrase = self._phrase[at]
        return self._of_which(phrase) if phrase is not None and phrase.head > at else -1

    def _of_which(self, phrase: Phrase) -> int:
        """Return the head of a phrase; of unknown groups what they are of: "a scatter of farms"."""
        of = phrase.end < len(self.items) and self.items[phrase.end].get("rel") == "of"
        if not of or self.items[phrase.head].kind != "unknown":
            return phrase.head
        behind = self.object_of(phrase.end)
        known = behind >= 0 and self.items[behind].has("noun")
        return behind if known and is_plural(self.items[behind].words[-1]) else phrase.head


def is_unknown(item: Item) -> bool:
    """Return whether a head is a thing that the book does not know."""
    known = item.has("noun", "slot", "head", "source", "any_source")
    return item.kind == "unknown" or (item.kind == "phrase" and not known)


def is_plural(word: str) -> bool:
    """Return whether a noun is in the plural."""
    ends = word.endswith("s") and not word.endswith(("ss", "us", "is"))
    return ends or word in _IRREGULAR_PLURALS


def is_adjective(items: Sequence[Item], at: int) -> bool:
    """Return whether "round" says how something is: "two round towers", not "round the park"."""
    if items[at].text != "round" or at + 1 >= len(items):
        return False
    before, after = items[at - 1] if at else items[at], items[at + 1]
    article = after.text in PARTS_OF_SPEECH["determiners"] or after.get("rel") == "it"
    counted = before.quantity is not None and before.quantity.dimension in _COUNTS
    looks = before.has("size", "color", "material", "height", "width", "shade")
    begins = counted or looks or before.has("rel", "neg") or before.kind == "function"
    return not article and (begins or before.kind == "mark") and after.kind != "mark"


def _phrase(items: Sequence[Item], first: int) -> Phrase:
    """Return the phrase that begins at an item; an empty one where none does."""
    head, at, begun, measured = -1, first, False, False
    while at < len(items):
        item = items[at]
        if (item.is_mark("-") or is_adjective(items, at)) and at > first:
            at += 1
            continue
        part = _part(item, begun=at > first, head=None if head < 0 else items[head])
        if head >= 0 and items[head].noun and _is_no_noun(items, at):
            part = _BREAKS
        if part == _BREAKS or (part == _BEGINS and (begun or head >= 0)):
            break
        if item.quantity is not None and item.quantity.dimension not in _COUNTS:
            after = items[at + 1] if at + 1 < len(items) else None
            houses = after is not None and after.noun_class in ("type", "building")
            if head >= 0 and item.quantity.dimension == "floors" and houses:
                break  # "make these parts | two-storey houses"
            if head >= 0 or measured:
                return Phrase(first, at + (head >= 0), head)
            measured = True
        begun = begun or part != _BEGINS
        head = at if part == _HEAD else head
        at += 1
    return Phrase(first, at, head)


def _is_no_noun(items: Sequence[Item], at: int) -> bool:
    """Return whether an unknown word behind a thing is a verb or an adverb, and no head.

    "A tram line | divides the town", "a path | straight down the middle".
    """
    item, after = items[at], items[at + 1] if at + 1 < len(items) else None
    if item.kind != "unknown" or after is None:
        return False
    if item.text in _ADVERBS:
        return after.has("rel") or after.words[0] in PARTS_OF_SPEECH["prepositions"]
    does = item.text.endswith("s") and not item.text.endswith("ss")
    return does and after.kind == "function" and after.text in ("the", "its", "this", "each")


def _part(item: Item, *, begun: bool, head: Item | None) -> str:
    """Return what an item does in a phrase that has begun or not, with a head so far or none."""
    if item.kind in ("mark", "file"):
        return _BREAKS
    if item.quantity is not None:
        if item.quantity.dimension in _APART:
            return _BREAKS
        return _BEGINS if item.quantity.dimension in _COUNTS else _ADJECTIVE
    if item.kind == "function":
        if item.text in PARTS_OF_SPEECH["determiners"]:
            return _BEGINS
        return _ADJECTIVE if item.text in PARTS_OF_SPEECH["describing"] else _BREAKS
    if item.kind == "unknown":
        return _of_unknown(item.text, head)
    return _of_known(item, begun=begun, head=head)


def _placed(item: Item) -> bool:
    """Return whether a phrase of the book begins with a preposition: "at night"."""
    return not item.has("noun") and item.words[0] in PARTS_OF_SPEECH["prepositions"]


def _follows_no_noun(item: Item, head: Item) -> bool:
    """Return whether a known word behind a known head begins something else."""
    participle = item.words[0].endswith(("ing", "ed")) and not item.has("noun")
    return participle or (head.kind != "unknown" and is_plural(head.words[-1]))


def _is_past(item: Item) -> bool:
    return item.words[-1].endswith(("ing", "ed"))


def _of_unknown(word: str, head: Item | None) -> str:
    if word.endswith("ly"):
        return _ADJECTIVE
    if word.endswith(("ing", "ed")):
        return _ADJECTIVE if head is None else _BREAKS
    if head is not None and word in _BEHIND_NOUNS:
        return _BREAKS  # "a ring road | outside"
    after_plural = head is not None and head.kind != "unknown" and is_plural(head.words[-1])
    return _BREAKS if after_plural else _HEAD


def _of_known(item: Item, *, begun: bool, head: Item | None) -> str:
    if item.get("slot").startswith("building.roof=") and item.words[-1].endswith("ed"):
        return _ADJECTIVE  # "gabled | houses"
    if item.kind == "id" or item.has("noun", "slot", "head", "source", "any_source"):
        apart = _placed(item) or (head is not None and _follows_no_noun(item, head))
        return _BREAKS if apart else _HEAD
    if item.has("amount", "neg") or item.get("rel") in ("all", "every", *EVERY_SO_MANY):
        return _BEGINS
    if item.has(*_ADJECTIVES) or item.get("rel") in ("green", "more", "rest", "last"):
        return _ADJECTIVE
    if item.has("verb") and not item.has("rel", "keep"):
        stops = head is not None and not is_plural(head.words[-1]) and not _is_past(item)
        several = head is None and is_plural(item.text)
        return _HEAD if stops or several or (begun and head is None) else _BREAKS  # "tram stops"
    if item.has("mode"):
        return _BREAKS if head is not None else _ADJECTIVE
    return _BREAKS
