"""Statements: what is told of some things alone becomes a command for the finished city.

"The buildings on the main street are brick" is of no slot, since it is not said of all buildings;
"make the buildings on the main street brick" is a change that has an action and a measure. What
the grammar of edits does not take stays open.
"""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Iterator, Sequence

from cityx.language.brief import Note
from cityx.language.here import BUILDINGS
from cityx.language.lexicon.numbers import EVERY_SO_MANY
from cityx.language.restrictions import ABOUT, IN_MANY_COLORS, OF_A_PART, is_telling
from cityx.language.scan import ENDS, Item, begin_of, end_of
from cityx.language.syntax import Syntax

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
    tried: set[int] = set()
    for note in notes:
        if note.code != "left_open":
            continue
        at = bisect_left(items, note.span[0], key=_begin_of)
        if note.about == IN_MANY_COLORS:
            yield from _in_many_colors(text, items, at)
            continue
        first = begin_of(items, at, ENDS)
        sentence = items[first : end_of(items, at, ENDS)]
        excepted = any(one.has("except") for one in sentence)
        apart = excepted or any(one.get("rel") in EVERY_SO_MANY for one in sentence)
        if (note.about == OF_A_PART or apart) and first not in tried:
            tried.add(first)
            yield from (_of_all_but if excepted else _of_parts)(text, sentence)
        if note.about == OF_A_PART or apart:
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


def _in_many_colors(
    text: str, items: Sequence[Item], at: int
) -> Iterator[tuple[str, Sequence[Item]]]:
    """Yield "paint the houses colourful" for "colourful houses"."""
    syntax = Syntax(items)
    head = syntax.head_behind(at) if syntax.head_behind(at) >= 0 else syntax.owner(at)
    thing = items[head] if head >= 0 else None
    if thing is not None and thing.noun_class in BUILDINGS:
        yield f"paint the {_said(text, [thing])} {_said(text, [items[at]])}", [items[at]]


def _of_all_but(text: str, items: Sequence[Item]) -> Iterator[tuple[str, Sequence[Item]]]:
    """Yield what a sentence says of all but some: "all are white | except those by the river"."""
    but = next(at for at, one in enumerate(items) if one.has("except"))
    verb = next((at for at, one in enumerate(items) if is_telling(one)), 0)
    comma = next((at for at, one in enumerate(items) if one.is_mark(",")), 0)
    if but == 0 < comma < verb:  # "apart from the church, all buildings are of wood"
        subject, look, others = items[comma + 1 : verb], items[verb + 1 :], items[1:comma]
    elif 0 < verb < but:
        subject, look, others = items[:verb], items[verb + 1 : but], items[but + 1 :]
    else:
        return
    while look and (look[0].text in (*_LOOKS, "all") or look[0].kind == "function"):
        look = look[1:]
    looks = [one for one in look if one.has("color", "material")]
    more = any(is_telling(one) or one.is_mark(ENDS + ",:") for one in others)
    if len(looks) == 1 and subject and others and not more:
        which = f"{_said(text, subject)} except {_said(text, others)}"
        material = looks[0].has("material")
        order, link = ("clad", " in") if material else ("paint", "")
        yield f"{order} {which}{link} {_said(text, looks)}", items


def _of_parts(text: str, items: Sequence[Item]) -> Iterator[tuple[str, Sequence[Item]]]:
    """Yield what a sentence says of parts of some buildings: "half | are white, the rest grey"."""
    first = next((at for at, one in enumerate(items) if _is_a_part(one)), len(items))
    own = items[first:]
    noun = next((at for at, one in enumerate(own) if one.noun_class in BUILDINGS), 0)
    if not noun or noun > _NEAR:
        return
    subject = _said(text, own[: noun + 1])
    pieces = list(_pieces(own[noun + 1 :]))
    told = [_look(piece) for piece in pieces]
    if not told or not all(told):
        return
    give = any(item.text in (*_HAVING, "with") for item in pieces[0])
    verb = "give" if give else "paint" if told[0][0].has("color") else "make"
    said = f"{verb} {subject} {_said(text, told[0])}"
    left = 1.0 - (own[0].quantity.exact or 0.0 if own[0].quantity is not None else 0.0)
    for piece, look in zip(pieces[1:], told[1:], strict=True):
        share = next((one.quantity.exact for one in piece if one.quantity is not None
                      and _is_a_part(one)), None)  # fmt: skip
        if share is not None and abs(share - left) > 1e-6:
            return  # parts that take turns: which of them would be which is not told
        said += f" and the rest {_said(text, look)}"
        break
    yield said, own


_NEAR = 4  # items from a share to what it is of
_REST = ("rest", "others", "other", "remainder", "them", "these", "those", "remaining")


def _is_a_part(item: Item) -> bool:
    if item.get("rel") in EVERY_SO_MANY:
        return True
    return item.quantity is not None and item.quantity.dimension in ("part", "share")


def _pieces(items: Sequence[Item]) -> Iterator[Sequence[Item]]:
    """Yield what is said of each part: behind commas, "and" and "but" before the next part."""
    begin = 0
    for at, item in enumerate(items):
        joins = item.is_mark(",") or item.get("rel") in ("and", "but") or item.text == "while"
        if joins and any(
            _is_a_part(one) or one.words[-1] in _REST for one in items[at + 1 : at + 4]
        ):
            if at > begin:
                yield items[begin:at]
            begin = at + 1
    yield items[begin:]


def _look(piece: Sequence[Item]) -> Sequence[Item]:
    """Return what a part is or has, without its verb and what names it."""
    for at, item in enumerate(piece):
        names = item.words and item.words[-1] in _REST
        skipped = item.kind in ("function", "mark") or names or _is_a_part(item)
        skipped = skipped or item.get("rel") in ("be", "of", "and", "but", "rest", "it")
        if not skipped and item.text not in (*_HAVING, *_BEFORE, "with", "all"):
            return piece[at:]
    return ()


def _said(text: str, items: Sequence[Item]) -> str:
    """Return the words of a text for some items, as they stand within a sentence."""
    said = text[items[0].span[0] : items[-1].span[1]] if items else ""
    return said if not items or items[0].kind in ("unknown", "id") else said[:1].lower() + said[1:]
