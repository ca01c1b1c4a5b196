"""Words of an instruction: pieces of its text, folded, with their places in it."""

from __future__ import annotations

import re
import unicodedata
from dataclasses import dataclass
from functools import lru_cache

from cityx.system.tables import table

FILES = "txt|md|tiff?|png|jpe?g|osm|pbf|gz|bz2|geojson|json|hgt|webp|bmp"
_PIECE = re.compile(
    rf"""
    (?P<file>\w[\w-]*(?:\.osm)?\.(?:{FILES})\b)
  | (?P<clock>\b\d{{1,2}}:\d{{2}}\b)
  | (?P<object>\b(?=\w*\d)[0-9a-f]{{16}}\b)
  | (?P<number>\d+(?:[.,]\d+)*)
  | (?P<word>k?m[²2](?!\w)|(?<=\d)x(?=\d))
  | (?P<id>[^\W\d_]{{1,16}}_?\d{{1,6}}(?!\w)|[^\W\d_]+(?:_[^\W_]+)+)
  | (?P<short>\bw/o?(?=\s))
  | (?P<name>[^\W\d_]+(?:['’][^\W\d_]+)?)
  | (?P<mark>[^\s\w]|_|[²³])
  | (?P<other>\w)
    """,
    re.VERBOSE | re.IGNORECASE,
)
# British spellings and their American ones, as parts of words.
_BRITISH = tuple(table("language/spelling", str, "british").items())
_SHORT = {"w/": "with", "w/o": "without"}
_IRREGULAR = table("language/spelling", str, "irregular")


@dataclass(frozen=True, slots=True)
class Word:
    """A piece of a text.

    Attributes
    ----------
    text
        The piece, in lower case, without accents, in American spelling.
    kind
        "word", "number", "clock", "id", "file" or "mark".
    start, end
        Its place in the text, in characters.
    """

    text: str
    kind: str
    start: int
    end: int


def words_of(text: str) -> list[Word]:
    """Cut a text into words, numbers, ids, names of files and marks."""
    found = []
    for match in _PIECE.finditer(text):
        kind = match.lastgroup or "other"
        kind = {"name": "word", "short": "word", "other": "mark", "object": "id"}.get(kind, kind)
        folded = match.group() if kind == "mark" else fold(match.group())
        folded = _SHORT.get(folded, folded)
        found.append(Word(folded, kind, match.start(), match.end()))
    return found


@lru_cache(maxsize=4096)
def fold(word: str) -> str:
    """Return a word in lower case, without accents, in American spelling."""
    plain = unicodedata.normalize("NFKD", word.replace("’", "'").casefold())
    plain = "".join(letter for letter in plain if not unicodedata.combining(letter))
    plain = plain.removesuffix("'s")
    for british, american in _BRITISH:
        plain = plain.replace(british, american)
    return plain


@lru_cache(maxsize=4096)
def forms_of(word: str) -> tuple[str, ...]:
    """Return a word and what it may be an inflection of, the likeliest first."""
    forms = [word]
    if word in _IRREGULAR:
        forms.append(_IRREGULAR[word])
    elif word.endswith("men") and len(word) > 5:
        forms.append(f"{word[:-3]}man")  # "policemen"
    if len(word) > 3 and word.endswith("s") and not word.endswith(("ss", "us", "sis")):
        if word.endswith("ies"):
            forms.append(word[:-3] + "y")
        forms.append(word[:-1])
        if word.endswith(("ses", "xes", "ches", "shes", "oes", "zes")):
            forms.append(word[:-2])
    for ending in ("ing", "ed"):
        stem = word.removesuffix(ending)
        if stem != word and len(stem) > 2:
            forms += [stem, stem + "e"]
            if stem[-1] == stem[-2]:
                forms.append(stem[:-1])
            if stem.endswith("i"):
                forms.append(stem[:-1] + "y")
    return tuple(dict.fromkeys(forms))
