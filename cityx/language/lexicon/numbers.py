"""Numbers of an instruction: digits, number words, dozens, halves."""

from __future__ import annotations

import re
from collections.abc import Sequence
from functools import lru_cache

from cityx.language.lexicon.words import Word

_NAMES = (
    "zero one two three four five six seven eight nine ten eleven twelve thirteen fourteen fifteen "
    "sixteen seventeen eighteen nineteen twenty thirty forty fifty sixty seventy eighty ninety"
)
_SCALES = {"hundred": 100.0, "thousand": 1e3, "million": 1e6, "billion": 1e9, "k": 1e3}
_WORDS = frozenset([*_NAMES.split(), *_SCALES]) - {"k"}
_LUMPS = {"dozen": 12.0, "couple": 2.0, "pair": 2.0, "score": 20.0}
_PARTS = {"half": 0.5, "third": 1 / 3, "quarter": 0.25, "fifth": 0.2, "tenth": 0.1}
_OF_FLOORS = ("storey", "story", "storeys", "stories", "storied", "storeyed", "floor")
NUMBER_WORDS = frozenset([*_WORDS, *_LUMPS, *_PARTS, "halves"])
_THOUSANDS = re.compile(r"\d{1,3}(,\d{3})+(\.\d+)?")
LONGEST = 15  # digits of a number; more is no measure of a city

_OUT_OF = (
    ("out", "of", "every"),
    ("out", "of"),
    ("in", "every"),
    ("of", "every"),
    ("in", "each"),
    ("in",),
)
MOST_PARTS = 20  # of "one in five"

Found = tuple[float, int]  # value and how many words it takes
# Words for one of so many in a row -> the share.
EVERY_SO_MANY = {"every other": 1 / 2, "every third": 1 / 3, "every fourth": 1 / 4}


def read_number(words: Sequence[Word], at: int) -> Found | None:
    """Read the number that begins at a word, with an "ish" behind it.

    Returns
    -------
    found
        Its value and the number of words it takes; None where no number begins.
    """
    found = _read(words, at)
    if found is None:
        return None
    value, length = found
    hyphen = _word(words, at + length) == "-"
    ish = _word(words, at + length + hyphen) == "ish"
    return value, length + (1 + hyphen if ish else 0)


def _read(words: Sequence[Word], at: int) -> Found | None:
    if at >= len(words):
        return None
    text = words[at].text
    if words[at].kind == "number":
        value = _digits(text)
        return None if value is None else _scaled(words, at, value, 1)
    if words[at].kind != "word":
        return None
    if text == "half" and _word(words, at + 1) in ("a", "an") and _word(words, at + 2) in _LUMPS:
        return _LUMPS[_word(words, at + 2)] / 2, 3
    if text in ("a", "an"):
        return _after_article(words, at)
    hyphen = _word(words, at + 1) == "-"
    if text == "single" and _word(words, at + 1 + hyphen) in _OF_FLOORS:
        return 1.0, 1
    if text in _LUMPS and text != "score":
        return _of_lumps(words, at, 1)
    return _spelled(words, at) if text in _WORDS else None


def read_part(words: Sequence[Word], at: int) -> Found | None:
    """Read "half", "a third" or "two thirds", as a share."""
    count, skip = 1.0, 0
    if _word(words, at) in ("a", "an"):
        skip = 1
    elif (found := _spelled(words, at)) and _word(words, at) in _WORDS:
        count, skip = found
        skip += _word(words, at + skip) == "-"
    word = _word(words, at + skip)
    part = _PARTS.get(word.removesuffix("s") if word != "halves" else "half")
    share = None if part is None else count * part
    return None if share is None or share >= 1 else (share, skip + 1)


def _after_article(words: Sequence[Word], at: int) -> Found | None:
    after = _word(words, at + 1)
    if after in _LUMPS:
        return _of_lumps(words, at + 1, 2)
    if after in _SCALES and after != "k":
        found = _spelled(words, at + 1)
        return None if found is None else (found[0], found[1] + 1)
    return None


def _of_lumps(words: Sequence[Word], at: int, length: int) -> Found:
    """Read "dozen" and "a couple of dozen", of which `length` words are before "of"."""
    value = _LUMPS[words[at].text]
    more = _word(words, at + 2)
    if _word(words, at + 1) == "of" and more in ("dozen", "score", "hundred", "thousand"):
        return value * (_LUMPS.get(more) or _SCALES[more]), length + 2
    return value, length


def _spelled(words: Sequence[Word], at: int) -> Found | None:
    """Read number words; "and" joins only after hundred, thousand or million."""
    taken: list[str] = []
    end = at
    while end < len(words) and len(taken) < LONGEST:
        text = words[end].text
        if text in _WORDS:
            linked = end > at and _word(words, end - 1) == "-"
            if taken and not linked and _begins_a_compound(words, end):
                break  # "fifty | two-storey houses"
            taken.append(text)
        elif not (
            text == "-" and _word(words, end + 1) in _WORDS and taken and taken[-1].endswith("ty")
        ):
            joins = text == "and" and taken and taken[-1] in _SCALES
            if not joins or _word(words, end + 1) not in _WORDS:
                break
        end += 1
    for count in range(len(taken), 0, -1):
        value = _value(" ".join(taken[:count]))
        if value is not None:
            return _scaled(words, at, value, _length(words, at, count))
    return None


def _begins_a_compound(words: Sequence[Word], at: int) -> bool:
    """Return whether a hyphen joins a number word to a word that is none: "two-storey"."""
    return _word(words, at + 1) == "-" and _word(words, at + 2) not in (*_WORDS, *_PARTS, "")


def read_ratio(words: Sequence[Word], at: int) -> Found | None:
    """Read "seven out of ten" or "one in every five", as a share."""
    part = read_number(words, at)
    if part is None:
        return None
    value, end = part
    link = next((one for one in _OUT_OF if _texts(words, at + end, len(one)) == one), None)
    whole = None if link is None else read_number(words, at + end + len(link))
    if link is None or whole is None or not 0 < value < whole[0]:
        return None
    if link == ("in",) and (value > 1 or whole[0] > MOST_PARTS):
        return None  # "two in 2020"
    return value / whole[0], end + len(link) + whole[1]


def _texts(words: Sequence[Word], at: int, count: int) -> tuple[str, ...]:
    return tuple(word.text for word in words[at : at + count])


def _length(words: Sequence[Word], at: int, count: int) -> int:
    """Return how many words hold a count of number words."""
    end = at
    while count:
        count -= words[end].text in _WORDS
        end += 1
    return end - at


def _scaled(words: Sequence[Word], at: int, value: float, length: int) -> Found:
    """Take in what follows a number: "million", "dozen", "and a half"."""
    after = _word(words, at + length)
    close = at + length < len(words) and words[at + length].start == words[at + length - 1].end
    if after in _SCALES and (after != "k" or close) and _SCALES[after] > value:
        value, length = value * _SCALES[after], length + 1
    elif after in ("dozen", "score"):
        value, length = value * _LUMPS[after], length + 1
    tail = [_word(words, at + length + step) for step in range(3)]
    if tail[0] == "and" and tail[1] == "a" and tail[2] in ("half", "quarter"):
        value, length = value + _PARTS[tail[2]], length + 3
    return value, length


def _word(words: Sequence[Word], at: int) -> str:
    return words[at].text if at < len(words) else ""


def _digits(text: str) -> float | None:
    if len(text) > LONGEST:
        return None
    if _THOUSANDS.fullmatch(text):
        return float(text.replace(",", ""))
    plain = text.replace(",", ".")
    return None if plain.count(".") > 1 else float(plain)


@lru_cache(maxsize=512)
def _value(text: str) -> float | None:
    from text_to_num import text2num  # type: ignore[import-untyped]

    try:
        return float(text2num(text, "en"))
    except ValueError:
        return None
