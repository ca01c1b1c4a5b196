"""Renaming: "rename Market Road to King Street", "call the park Miller's Green"."""

from __future__ import annotations

from collections.abc import Sequence

from cityx.language.homonyms import NAME
from cityx.language.scan import Item

_VERBS = ("rename", "name", "call", "rechristen")
_CHANGING = ["change", "the", "name", "of"]
_TO = ("to", "as", "into")
LONGEST = 80  # letters of a name
_QUOTES = "\"'“”‘’ "


def renaming(text: str, words: Sequence[Item]) -> tuple[list[Item], str] | None:
    """Return what a command names anew and how, None where it names nothing.

    Parameters
    ----------
    text
        The request, whose letters a name keeps.
    words
        The command.
    """
    said = [one for one in words if one.kind != "mark" and one.get("rel") not in ("and", "please")]
    changing = [word for one in said[:4] for word in one.words][:4] == _CHANGING
    if changing:
        said = said[3:]
    elif len(said) < 3 or said[0].text not in _VERBS:
        return None
    if said[0].text in _VERBS[1:3]:
        first = next((at for at, one in enumerate(said) if at > 1 and _is_named(text, one)), 0)
        target, name = said[1:first], said[first:]
    else:
        links = [at for at, one in enumerate(said) if at and one.text in _TO]
        written = [at for at in links if any(_is_named(text, one) for one in said[at + 1 : at + 2])]
        link = (written or links or [0])[0]  # "the road to the church | to Abbey Way"
        target, name = said[1:link], said[link + 1 :]
    if not target or not name or not any(
        one.noun or one.kind == "id" or one.get("rel") == "it" for one in target
    ):  # fmt: skip
        return None
    if _goes_on(text, name):
        return None
    told = text[name[0].span[0] : name[-1].span[1]].strip(_QUOTES)
    return (target, told) if 0 < len(told) <= LONGEST else None


def _goes_on(text: str, name: Sequence[Item]) -> bool:
    """Return whether words follow a name that are none of it: "King Street | for the fair".

    "St. Mary's Way" is no name that ends at its point, either.
    """
    begin, end = name[0].span[0], name[-1].span[1]
    if end - begin < len("St. ") and text[end : end + 2] == ". ":
        return True
    written = NAME.match(text, begin)
    quoted = text[begin - 1 : begin] in _QUOTES[:-1] and begin > 0
    rest = "" if quoted or written is None else text[written.end() : end]
    return any(word[:1].islower() for word in rest.split())


def _is_named(text: str, item: Item) -> bool:
    """Return whether a word is written as a name: in capitals, or behind a quotation mark."""
    at = item.span[0]
    return text[at : at + 1].isupper() or (at > 0 and text[at - 1] in _QUOTES[:-1])
