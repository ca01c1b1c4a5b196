"""Statements: what is told of some things alone becomes a command for the finished city.

"The buildings on the main street are brick" is of no slot, since it is not said of all buildings;
"make the buildings on the main street brick" is a change that has an action and a measure. What
the grammar of edits does not take stays open.
"""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Iterator, Sequence

from cityx.language.brief import Note
from cityx.language.restrictions import ABOUT, is_telling
from cityx.language.scan import Item

_HAVING = ("have", "has", "get", "carry", "carries", "receive", "receives")
_BEFORE = ("should", "must", "shall", "will", "would", "ought to", "need to", "have to", "has to")
_JOINING = ("and", "but", "where", "so", "while", "whereas", "with")
_LOOKS = ("in", "of", "made of", "built of", "painted", "clad in", "made from", "built from")
_SOME = ("some", "most", "many", "few", "several", "other", "others", "rest", "the rest", "half")


def statements(
    text: str, items: Sequence[Item], notes: Sequence[Note]
) -> Iterator[tuple[str, Sequence[Item]]]:
    """Yield commands that say what notes leave open, each with the items that it stands for.

    Parameters
    ----------
    text, items
        A description, and all its items.
    notes
        What was left open of it.
    """
    for note in notes:
        if note.code != "left_open":
            continue
        first, end = (bisect_left(items, at, key=_begin_of) for at in note.span)
        told = items[first:end]
        if note.about == ABOUT:
            yield from _of_some(text, told)


def _begin_of(item: Item) -> int:
    return item.span[0]


def _of_some(text: str, items: Sequence[Item]) -> Iterator[tuple[str, Sequence[Item]]]:
    """Yield what a clause says: "the towers by the river | are | glass"."""
    while items and (items[0].text in _JOINING or items[0].kind == "mark"):
        items = items[1:]
    verb = next((at for at, item in enumerate(items) if at and is_telling(item)), 0)
    if any(item.text in _SOME for item in items[:verb]):
        return
    if not verb:  # "all towers over 100 m in white"
        at = next((n for n, item in enumerate(items) if n and item.text in _LOOKS), 0)
        if at and at + 1 < len(items):
            yield f"make {_said(text, items[:at])} {_said(text, items[at + 1 :])}", items
        return
    end = verb
    while end > 1 and (items[end - 1].text in _BEFORE or items[end - 1].text in ("all", "both")):
        end -= 1
    subject, said = _said(text, items[:end]), _said(text, items[verb + 1 :])
    if subject and said:
        give = items[verb].text in _HAVING
        yield f"{'give' if give else 'make'} {subject} {said}", items


def _said(text: str, items: Sequence[Item]) -> str:
    """Return the words of a text for some items, as they stand within a sentence."""
    said = text[items[0].span[0] : items[-1].span[1]] if items else ""
    return said if not items or items[0].kind in ("unknown", "id") else said[:1].lower() + said[1:]
