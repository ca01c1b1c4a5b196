"""Scanning: an instruction becomes items, each a phrase, a quantity or a mark, none overlapping."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

from cityx.agents.brief.brief import Note, Span
from cityx.agents.brief.lexicon import Sense, find, known, mended
from cityx.agents.brief.numbers import read_number, read_part
from cityx.agents.brief.speech import FUNCTION_WORDS
from cityx.agents.brief.units import read_unit
from cityx.agents.brief.words import Word, forms_of, words_of

LONGEST_TEXT = 6000  # characters; what comes later is listed as unread, so that time stays short
ENDS = ".;!?\n"


@dataclass(frozen=True)
class Quantity:
    """A number with its unit and bounds.

    Attributes
    ----------
    dimension
        "length", "area", "speed", "floors", "lanes", "share", "angle", "temperature", "hour",
        "count" for a plain number, "pair" for "600 x 400 m".
    low, high
        Bounds in SI units; both the same for an exact value, None where open.
    other
        The second length of a pair.
    attribute
        "height", "width", "slope"... where the words say so.
    approximate
        Whether the text says "about".
    unit
        Size of the unit in SI units, for a number that shares it.
    """

    dimension: str
    low: float | None
    high: float | None
    other: float | None = None
    attribute: str = ""
    approximate: bool = False
    unit: float = 1.0

    @property
    def exact(self) -> float | None:
        """The value, if it is one."""
        return self.low if self.low == self.high else None


@dataclass(eq=False)
class Item:
    """A piece of the text with what it may mean.

    Attributes
    ----------
    senses
        Kinds and values of a phrase; empty for function words and unknown words.
    words
        Its words, folded.
    span
        Its place in the text.
    kind
        "phrase", "quantity", "id", "file", "mark", "function" or "unknown".
    quantity
        Of a quantity.
    """

    kind: str
    span: Span
    words: tuple[str, ...] = ()
    senses: tuple[Sense, ...] = ()
    quantity: Quantity | None = None
    state: str = field(default="")  # "negated", "kept", "dropped" or "read" once it is settled

    def get(self, kind: str) -> str:
        """Return the value of the first sense of a kind, or ""."""
        return next((value for name, value in self.senses if name == kind), "")

    def has(self, *kinds: str) -> bool:
        """Tell whether the item has a sense of one of the kinds."""
        return any(name in kinds for name, _ in self.senses)

    @property
    def noun(self) -> str:
        """The canonical noun, that of the last word too ("winding streets"), or ""."""
        return (self.get("noun") or self.get("head")).partition(":")[2]

    @property
    def noun_class(self) -> str:
        """The class of the noun: "type", "element", "person"..., or ""."""
        return (self.get("noun") or self.get("head")).partition(":")[0]

    @property
    def text(self) -> str:
        """The words, joined."""
        return " ".join(self.words)

    def is_mark(self, marks: str) -> bool:
        """Tell whether the item is one of some marks."""
        return self.kind == "mark" and self.words[0] in marks


def scan(text: str) -> tuple[list[Item], list[Note]]:
    """Cut a text into items: longest phrases first, numbers with their units."""
    words, notes = _mended(_with_lines(text[:LONGEST_TEXT]))
    items: list[Item] = []
    at = 0
    while at < len(words):
        item, length = _next(words, at)
        items.append(item)
        at += length
    return items, notes


def _with_lines(text: str) -> list[Word]:
    """Return the words of a text, a full stop at every empty line and bullet."""
    words = words_of(text)
    found: list[Word] = []
    for word in words:
        gap = text[found[-1].end : word.start] if found else ""
        if "\n" in gap and not (found[-1].kind == "mark" and found[-1].text in ENDS + ","):
            place = found[-1].end
            found.append(Word("\n", "mark", place, place + 1))
        found.append(word)
    return found


def _mended(words: list[Word]) -> tuple[list[Word], list[Note]]:
    """Mend misspelt words, with a note on each."""
    notes = []
    for index, word in enumerate(words):
        better = mended(word.text) if word.kind == "word" else None
        if better is not None:
            words[index] = replace(word, text=better)
            said = f'"{word.text}" was read as "{better}".'
            notes.append(Note("spelling", said, (word.start, word.end)))
    return words, notes


def _next(words: Sequence[Word], at: int) -> tuple[Item, int]:
    word = words[at]
    if word.kind in ("id", "file"):
        return _item(words, at, 1, word.kind), 1
    phrase = find(words, at)
    number = _number(words, at)
    if number is not None and (phrase is None or phrase[1] < number[1]):
        return _item(words, at, number[1], "quantity", quantity=number[0]), number[1]
    if phrase is not None:
        senses = (*phrase[0], *_head(words[at : at + phrase[1]], phrase[0]))
        return _item(words, at, phrase[1], "phrase", senses=senses), phrase[1]
    if word.kind == "mark":
        return _item(words, at, 1, "mark"), 1
    plain = any(form in FUNCTION_WORDS for form in forms_of(word.text)) or len(word.text) == 1
    return _item(words, at, 1, "function" if plain else "unknown"), 1


def _head(words: Sequence[Word], senses: tuple[Sense, ...]) -> tuple[Sense, ...]:
    """Return the noun that the last word of a phrase is: a street, of "winding streets"."""
    if len(words) < 2 or any(kind == "noun" for kind, _ in senses):
        return ()
    last = find(words[-1:], 0)
    nouns = () if last is None else (value for kind, value in last[0] if kind == "noun")
    return tuple(("head", value) for value in nouns)[:1]


def _item(
    words: Sequence[Word],
    at: int,
    length: int,
    kind: str,
    *,
    senses: tuple[Sense, ...] = (),
    quantity: Quantity | None = None,
) -> Item:
    taken = words[at : at + length]
    span = (taken[0].start, taken[-1].end)
    return Item(kind, span, tuple(word.text for word in taken), senses, quantity)


def _number(words: Sequence[Word], at: int) -> tuple[Quantity, int] | None:
    """Read a clock, a number with its unit, "half a hectare" or "half of"."""
    word = words[at]
    if word.kind == "clock":
        hours, minutes = map(int, word.text.split(":"))
        return _clock(words, at, hours + minutes / 60, 1)
    part = read_part(words, at)
    if part is not None:
        return _part(words, at, *part)
    found = read_number(words, at)
    if found is None:
        return None
    value, length = found
    unit = read_unit(words, at + length)
    if unit is None:
        return Quantity("count", value, value), length
    dimension, factor, extra = unit
    if dimension in ("hour", "half_day"):
        return _clock(words, at, value, length)
    size = value * factor
    return Quantity(dimension, size, size, unit=factor), length + extra


def _part(words: Sequence[Word], at: int, share: float, length: int) -> tuple[Quantity, int] | None:
    """Read what follows "half": a unit makes a measure of it, anything else a share."""
    skip = length + (length < len(words) - at and words[at + length].text in ("a", "an", "of"))
    skip += skip < len(words) - at and words[at + skip].text in ("a", "an")
    unit = read_unit(words, at + skip) if at + skip < len(words) else None
    if unit is not None and unit[0] in ("length", "area"):
        return Quantity(unit[0], share * unit[1], share * unit[1]), skip + unit[2]
    after = words[at + length].text if at + length < len(words) else ""
    if after in ("of", "the", "all", "a", "an") or (after and known(after)):
        return Quantity("part", share, share), length + (after == "of")
    return None


def _clock(words: Sequence[Word], at: int, hour: float, length: int) -> tuple[Quantity, int] | None:
    """Read what follows an hour, "pm" or "o'clock"."""
    unit = read_unit(words, at + length) if at + length < len(words) else None
    if unit is not None and unit[0] in ("half_day", "hour"):
        length += unit[2]
    if unit is not None and unit[0] == "half_day":
        hour = hour % 12 + unit[1]
    return (Quantity("hour", hour % 24, hour % 24), length) if 0 <= hour <= 24 else None
