"""Scanning: an instruction becomes items, each a phrase, a quantity or a mark, none overlapping."""

from __future__ import annotations

import re
from collections.abc import Container, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise

from cityx.language.brief import Note, Span
from cityx.language.day import HALF, ends_phrase, follows_part, hour_of_day
from cityx.language.lexicon.lexicon import Sense, find, is_verbal, known, mended
from cityx.language.lexicon.numbers import read_number, read_part, read_ratio
from cityx.language.lexicon.phrases import FUNCTION_WORDS, HOMONYMS, PARTS_OF_SPEECH, TABLES
from cityx.language.lexicon.units import read_unit
from cityx.language.lexicon.words import Word, forms_of, words_of

LONGEST_TEXT = 6000  # characters; what comes later is listed as unread, so that time stays short
ENDS = ".;!?\n"
_PLACED_ON = ("both", "each", "either", "every", "the", "a", "one", "its")  # behind "lamps on"
_SWITCHES = ("turn", "turned", "switch", "switched", "put", "leave", "keep")
_LETTERS = frozenset("bcefghjklnpqruvwyz")  # that stand for no word, unit or part of one
LONGEST_NAME = 6  # words of the name of a thing
# Senses that no form with "ing" or "ed" has: mining is no minimum, mapping no map.
_NO_VERBS = (("rel", "change"), ("slot", "weather=clear"))  # "clearing" is no sky
_NOT_VERBAL = ("noun", "bound", "any_source", "source", "attr", "exact", "approx", "amount")
_BEFORE_HOURS = ("at", "it", "is", "around", "about", "by", "until", "till", "towards", "it's")
_FULL = ("full", "whole", "complete", "good", "solid", "entire")
_NUMBERED = re.compile(r"(?:^|\n)[ \t]*(\d{1,2})[.)][ \t]")  # of a line of a list
_OPEN = {"or more": "low", "or fewer": "high", "or less": "high"}
_AGAIN = ("another", "additional", "extra", "further")  # before a number
_MORE = {"more": 1, "additional": 1, "extra": 1, "further": 1, "fewer": -1, "less": -1}


@dataclass(frozen=True)
class Quantity:
    """A number with its unit and bounds.

    Attributes
    ----------
    dimension
        "length", "area", "speed", "floors", "lanes", "share", "angle", "temperature", "hour",
        "duration" (hours),
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
    relative
        1 in "20 m higher", -1 in "20 m lower", else 0.
    """

    dimension: str
    low: float | None
    high: float | None
    other: float | None = None
    attribute: str = ""
    approximate: bool = False
    unit: float = 1.0
    relative: int = 0

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
        for name, value in self.senses:
            if name == kind:
                return value
        return ""

    def has(self, *kinds: str) -> bool:
        """Return whether the item has a sense of one of the kinds."""
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
        return self.words[0] if len(self.words) == 1 else " ".join(self.words)

    def is_mark(self, marks: str) -> bool:
        """Return whether the item is one of some marks."""
        return self.kind == "mark" and self.words[0] in marks


def begin_of(items: Sequence[Item], at: int, ends: str) -> int:
    """Return where the part of a text begins that an item stands in: behind the last of marks."""
    return next((n + 1 for n in range(at - 1, -1, -1) if items[n].is_mark(ends)), 0)


def end_of(items: Sequence[Item], at: int, ends: str) -> int:
    """Return where the part of a text ends that an item stands in: at the next of marks."""
    return next((n for n in range(at, len(items)) if items[n].is_mark(ends)), len(items))


def within(items: Sequence[Item], spans: Iterable[Span]) -> list[bool]:
    """Return for each item whether one of some places of the text holds a part of it."""
    held = bytearray(max((item.span[1] for item in items), default=0))
    for first, end in spans:
        held[first:end] = b"\1" * (min(end, len(held)) - first)
    return [1 in held[slice(*item.span)] for item in items]


def scan(text: str, names: Iterable[str] = ()) -> tuple[list[Item], list[Note]]:
    """Cut a text into items: names first, then longest phrases, numbers with their units.

    Parameters
    ----------
    text
        The instruction.
    names
        What things of the city are called; a name of one word that the book knows is that word.
    """
    called = _by_words(names)
    words = _with_lines(_without_numbering(text[:LONGEST_TEXT]))
    words, notes = _mended(text, words, {word for key in called for word in key})
    items: list[Item] = []
    at = 0
    while at < len(words):
        item, length = _called(words, at, called) or _next(words, at)
        if length > 1 and item.words[-1] == "on" and _called(words, at + length, called):
            item, length = _next(words[: at + length - 1], at)  # "lamps | on Hay Road"
        items.append(item)
        at += length
    return items, notes


def _without_numbering(text: str) -> str:
    """Return a text with blanks for the numbers of a list: "1. ..., 2. ..."."""
    found = list(_NUMBERED.finditer(text))
    if len(found) < 2 or [int(one[1]) for one in found] != list(range(1, len(found) + 1)):
        return text
    for one in found:
        text = text[: one.start(1)] + " " * (one.end() - one.start(1)) + text[one.end() :]
    return text


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


_ARTICLES = ("the", "a", "an", "its", "their", "every", "each")
# Words for looks and sizes, which may stand between an article and its noun.
_LOOKS = frozenset(
    word for table in ("material", "color", "size") for words in TABLES[table].values()
    for phrase in " ".join(words.split()).split(", ") for word in phrase.split()
)  # fmt: skip
_DONE = ("ed", "ing", "lit", "kept", "known", "built", "made", "worn")
Names = Mapping[tuple[str, ...], str]  # the folded words of a name -> the name


def _by_words(names: Iterable[str]) -> Names:
    found: dict[tuple[str, ...], str] = {}
    for name in names:
        key = tuple(word.text for word in words_of(name))
        if len(key) > 1 or (key and not known(key[0])):
            found.setdefault(key, name)
    return found


def _called(words: Sequence[Word], at: int, names: Names) -> tuple[Item, int] | None:
    """Return the longest name that begins at a word, as an id."""
    for length in range(min(LONGEST_NAME, len(words) - at), 0, -1):
        key = tuple(word.text for word in words[at : at + length])
        if key in names:
            item = _item(words, at, length, "id")
            return replace(item, words=(names[key],)), length
    return None


def _mended(text: str, words: list[Word], names: Container[str]) -> tuple[list[Word], list[Note]]:
    """Mend misspelt words, with a note on each; words of names stay as they are."""
    notes = []
    for index, word in enumerate(words):
        named = word.text in names or _is_a_name(text, words, index)
        better = mended(word.text) if word.kind == "word" and not named else None
        if better is not None:
            words[index] = replace(word, text=better)
            said = f'"{word.text}" was read as "{better}".'
            notes.append(Note("spelling", said, (word.start, word.end)))
    return words, notes


def _is_a_name(text: str, words: Sequence[Word], at: int) -> bool:
    """Return whether a word is written like a name inside a sentence: "the port of | Porto"."""
    own = text[words[at].start : words[at].end]
    begins = at == 0 or words[at - 1].text in ENDS + ":-"
    return own[:1].isupper() and own[1:].islower() and not begins


def _next(words: Sequence[Word], at: int) -> tuple[Item, int]:
    word = words[at]
    if word.kind in ("id", "file"):
        return _item(words, at, 1, word.kind), 1
    phrase = find(words, at)
    if phrase is not None and phrase[1] == 1 and not _is_meant(words, at):
        phrase = None
    if phrase is not None and _is_verbal(words, at, phrase[1]):
        phrase = find(words[at : at + phrase[1] - 1], 0)  # "a railway | crossing the park"
    if phrase is None and _is_a_letter_of(words, at):
        return _item(words, at, 3, "unknown"), 3  # "e-scooters" are no scooters
    if _is_ordinal(words, at) and phrase is None:
        return _item(words, at, 2, "unknown"), 2
    number = _number(words, at)
    if number is not None and (phrase is None or phrase[1] < number[1]):
        return _item(words, at, number[1], "quantity", quantity=number[0]), number[1]
    if phrase is not None:
        taken = words[at : at + phrase[1]]
        senses = (*_inflected(taken, phrase[0]), *_head(taken, phrase[0]))
        kind = "phrase" if senses else "unknown"
        return _item(words, at, phrase[1], kind, senses=senses), phrase[1]
    if word.kind == "mark":
        return _item(words, at, 1, "mark"), 1
    verbal = word.text.endswith(("ing", "ed"))  # a siding is no side
    forms = (word.text,) if verbal else forms_of(word.text)
    letter = len(word.text) == 1 and not (word.text in _LETTERS and _is_shown(words, at))
    plain = any(form in FUNCTION_WORDS for form in forms) or letter
    plain = plain and not (word.text == "well" and _follows_an_article(words, at))
    plain = plain or _is_before_a_noun(words, at)
    return _item(words, at, 1, "function" if plain else "unknown"), 1


def _is_verbal(words: Sequence[Word], at: int, length: int) -> bool:
    """Return whether the last word of a phrase is a verb: "crossing | the park".

    What several do is one too: "pedestrians | crossing", which are no pedestrian crossing. The "on"
    of "lamps | on both sides" is of their place, not of a switch.
    """
    after = words[at + length].text if at + length < len(words) else ""
    switches = words[at].text in _SWITCHES  # "turn on | the lamps"
    if length > 1 and words[at + length - 1].text == "on" and after in _PLACED_ON and not switches:
        return True
    doing = length > 1 and words[at + length - 1].text.endswith("ing")
    own = find(words[at : at + 1], 0) if doing and words[at].text.endswith("s") else None
    many = own is not None and any(value.startswith("person:") for _, value in own[0])
    return doing and (many or after in ("the", "a", "an", "our", "its", "this"))


def _is_before_a_noun(words: Sequence[Word], at: int) -> bool:
    """Return whether a word is a preposition with a noun behind it: "outside | the town hall"."""
    behind = words[at + 1].text if at + 1 < len(words) else ""
    return words[at].text in PARTS_OF_SPEECH["prepositions"] and behind in _ARTICLES


def _is_shown(words: Sequence[Word], at: int) -> bool:
    """Return whether a letter is a thing of its own: "a yellow H", and no "T-junction"."""
    before = words[at - 1] if at else None
    joined = [one.kind == "mark" for one in words[at + 1 : at + 2] if one.text in "-'’"]
    return before is not None and before.kind == "word" and not joined


def _follows_an_article(words: Sequence[Word], at: int) -> bool:
    """Return whether an article or a number stands before: "one | well"."""
    before = words[at - 1].text if at else ""
    return before in ("a", "the") or (at > 0 and read_number(words, at - 1) is not None)


def _is_meant(words: Sequence[Word], at: int) -> bool:
    """Return whether a word is the noun that it may be: "a bank", and not "the northern bank".

    One of `HOMONYMS` is meant behind an article or a number, its plural behind a number.
    """
    own = words[at].text
    single = own in HOMONYMS
    if not single and own.removesuffix("s") not in HOMONYMS:
        return True
    first = at
    while first and words[first - 1].text in _LOOKS:
        first -= 1  # "a red | bank"
    before = words[first - 1].text if first else ""
    counted = before in ("no", "any") or (first > 0 and read_number(words, first - 1) is not None)
    told = counted or (single and before in ("a", "another"))
    behind = [one.text for one in words[at + 1 : at + 3]]
    done = bool(behind) and behind[0].endswith(_DONE)  # "a well kept street"
    if first < at and behind[:1] in (["of"], ["along"]):
        return False  # "a stone bank along the river"
    return told and not (done and behind[1:] not in (["by"], ["in"]))


def _is_a_letter_of(words: Sequence[Word], at: int) -> bool:
    """Return whether a letter and a hyphen make another word: "e-scooter"."""
    own = words[at : at + 3]
    joined = all(one.end == after.start for one, after in pairwise(own))
    return (
        len(own) == 3
        and len(own[0].text) == 1
        and own[0].text.isalpha()
        and (own[1].text == "-" and own[2].kind == "word" and joined)
    )


def _is_ordinal(words: Sequence[Word], at: int) -> bool:
    """Return whether a number is one in a row: "23rd Avenue"."""
    if not words[at].text.isdigit() or at + 1 >= len(words):
        return False
    after = words[at + 1]
    return after.text in ("st", "nd", "rd", "th") and after.start == words[at].end


def _head(words: Sequence[Word], senses: tuple[Sense, ...]) -> tuple[Sense, ...]:
    """Return the noun that the last word of a phrase is: a street, of "winding streets"."""
    if len(words) < 2 or any(kind == "noun" for kind, _ in senses):
        return ()
    last = find(words[-1:], 0)
    nouns = () if last is None else (value for kind, value in last[0] if kind == "noun")
    if any(value.startswith("district=") for _, value in senses):
        nouns = (value for value in nouns if not value.startswith("element:"))  # "business park"
    return tuple(("head", value) for value in nouns)[:1]


def _inflected(words: Sequence[Word], senses: tuple[Sense, ...]) -> tuple[Sense, ...]:
    """Return the senses of a single word, without nouns that it is no form of: "training"."""
    word = words[0].text
    if len(words) > 1 or not word.endswith(("ing", "ed")) or not is_verbal(word):
        return senses
    return tuple(
        (kind, value) for kind, value in senses
        if kind not in _NOT_VERBAL and (kind, value) not in _NO_VERBS
    )  # fmt: skip


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
    past = _past_the_hour(words, at)
    if past is not None:
        return past
    again = _once_more(words, at) or _above_ground(words, at)
    if again is not None:
        return again
    ratio = read_ratio(words, at)
    if ratio is not None:
        return Quantity("part", ratio[0], ratio[0]), ratio[1]
    part, found = read_part(words, at), read_number(words, at)
    if part is not None and (found is None or word.text != "half"):  # but "half a dozen"
        return _part(words, at, *part)
    if found is None:
        return None
    value, length = found
    more = _MORE.get(words[at + length].text, 0) if at + length < len(words) else 0
    unit = read_unit(words, at + length + abs(more))
    if unit is None and not more and _is_whole(words, at + length):
        length += 1  # "four | full storeys"
        unit = read_unit(words, at + length)
    if unit is None and value <= HALF and follows_part(words, at + length):
        told = at > 0 and words[at - 1].text in _BEFORE_HOURS
        if told or ends_phrase(words, at + length):  # "four in the afternoon"
            return _clock(words, at, value, length)
    if unit is None:
        return _open(words, at + length, value, length) or (
            Quantity("count", value, value), length
        )  # fmt: skip
    dimension, factor, extra = unit
    length += abs(more)
    if dimension in ("hour", "half_day"):
        return _clock(words, at, value, length)
    size, length = value * factor, length + extra
    if not more and _is_plus(words, at + length):
        return Quantity(dimension, size, None, unit=factor), length + 1
    return Quantity(dimension, size, size, unit=factor, relative=more), length


def _is_whole(words: Sequence[Word], at: int) -> bool:
    """Return whether a word says of a unit that it is whole: "four | full storeys"."""
    unit = read_unit(words, at + 1) if at + 1 < len(words) and words[at].text in _FULL else None
    return unit is not None


def _is_plus(words: Sequence[Word], at: int) -> bool:
    """Return whether a plus sign stands right behind a number or its unit: "200m | +"."""
    return 0 < at < len(words) and words[at].text == "+" and words[at].start == words[at - 1].end


def _open(words: Sequence[Word], at: int, value: float, length: int) -> tuple[Quantity, int] | None:
    """Read a bound between a number and its unit: "two | or more lanes", "6| + floors"."""
    plus = _is_plus(words, at)
    end = "low" if plus else _OPEN.get(" ".join(word.text for word in words[at : at + 2]))
    taken = 1 if plus else 2
    unit = read_unit(words, at + taken) if end is not None and at + taken < len(words) else None
    if unit is None or unit[0] not in ("length", "area", "floors", "lanes"):
        counted = at + taken < len(words) and words[at + taken].kind == "word"
        return (Quantity("count", value, None), length + taken) if plus and counted else None
    size = value * unit[1]
    low, high = (size, None) if end == "low" else (None, size)
    return Quantity(unit[0], low, high, unit=unit[1]), length + taken + unit[2]


def _once_more(words: Sequence[Word], at: int) -> tuple[Quantity, int] | None:
    """Read "another two metres" and "an extra storey", which are so much more."""
    if words[at].text not in _AGAIN:
        return None
    value, length = read_number(words, at + 1) or (1.0, 0)
    unit = read_unit(words, at + 1 + length) if at + 1 + length < len(words) else None
    if unit is None or unit[0] not in ("length", "floors", "lanes"):
        return None
    size = value * unit[1]
    return Quantity(unit[0], size, size, unit=unit[1], relative=1), 1 + length + unit[2]


def _above_ground(words: Sequence[Word], at: int) -> tuple[Quantity, int] | None:
    """Read "G+7", a ground floor and seven storeys above it."""
    said = [word.text for word in words[at : at + 2]]
    upper = read_number(words, at + 2) if said == ["g", "+"] else None
    if upper is None:
        return None
    unit = read_unit(words, at + 2 + upper[1]) if at + 2 + upper[1] < len(words) else None
    extra = unit[2] if unit is not None and unit[0] == "floors" else 0
    return Quantity("floors", upper[0] + 1, upper[0] + 1), 2 + upper[1] + extra


def _past_the_hour(words: Sequence[Word], at: int) -> tuple[Quantity, int] | None:
    """Read "half past six" and "quarter to seven"."""
    minutes = {"half": 30, "quarter": 15}.get(words[at].text)
    way = words[at + 1].text if at + 2 < len(words) else ""
    if minutes is None or way not in ("past", "to"):
        return None
    hour = read_number(words, at + 2)
    if hour is None or hour[0] > 24:
        return None
    sign = 1 if way == "past" else -1
    told = hour_of_day(words, at + 2, hour[1], hour[0], spoken=True)
    return _clock(words, at, told + sign * minutes / 60, hour[1] + 2)


def _part(words: Sequence[Word], at: int, share: float, length: int) -> tuple[Quantity, int] | None:
    """Read what follows "half": a unit makes a measure of it, anything else a share."""
    skip = length + (length < len(words) - at and words[at + length].text in ("a", "an", "of"))
    skip += skip < len(words) - at and words[at + skip].text in ("a", "an")
    unit = read_unit(words, at + skip) if at + skip < len(words) else None
    if unit is not None and unit[0] in ("length", "area", "duration"):
        return Quantity(unit[0], share * unit[1], share * unit[1]), skip + unit[2]
    after = words[at + length].text if at + length < len(words) else ""
    later = words[at + length + 1].text if at + length + 1 < len(words) else ""
    several = after.endswith("s") and after != "is" and known(after)  # "a quarter trucks"
    if several and later not in ("of", "with"):
        return Quantity("part", share, share), length
    if "quarter" in words[at + length - 1].text and later not in ("the", "all", "its"):
        return None  # "a quarter of narrow alleys"
    if after in ("are", "with", "using", "being"):  # "a fifth are children"
        return Quantity("part", share, share), length
    half = words[at].text == "half" and (after in ("the", "all", "a", "an") or known(after))
    if after == "of" or (after and half):
        return Quantity("part", share, share), length + (after == "of")
    return None


def _clock(words: Sequence[Word], at: int, hour: float, length: int) -> tuple[Quantity, int] | None:
    """Read what follows an hour, "pm" or "o'clock"."""
    unit = read_unit(words, at + length) if at + length < len(words) else None
    if unit is not None and unit[0] in ("half_day", "hour"):
        length += unit[2]
    if unit is not None and unit[0] == "half_day":
        hour = hour % 12 + unit[1]
    else:
        hour = hour_of_day(words, at, length, hour)
    return (Quantity("hour", hour % 24, hour % 24), length) if 0 <= hour <= 24 else None
