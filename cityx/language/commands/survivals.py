"""Survivals: what is to stay, said of the things themselves: "the church must survive".

Put as "keep the church and the park", which protects them. "The rest stay as they are" asks for
nothing: what nobody names does not change anyway.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from cityx.language.commands.words_put_in import by_sentence
from cityx.language.scan import ENDS, Item
from cityx.language.scopes import READ

_OUGHT = ("has", "have", "must", "should", "needs", "need", "is", "are", "shall", "will", "ought")
_LINKS = ("to", "be", "also", "all", "both", "just", "simply", "still")
_STAY = (
    "survive", "survives", "survived", "stay", "stays", "remain", "remains", "stand", "standing",
)  # fmt: skip
# What may be said of how it stays.
_HOW = (
    "untouched", "unchanged", "unharmed", "intact", "exactly", "just", "as", "is", "it", "they",
    "are", "where", "put", "alone", "standing", "there", "please", "though", "of", "course",
)  # fmt: skip
_REST = ("rest", "others", "remainder", "everything", "all")
_TURNS = ("and", "but", "while", "whereas", "though")
_CONCEDES = ("if", "though", "when")
LONGEST = 12  # items at the end of a sentence that say that things stay


def with_survivals(items: Sequence[Item]) -> list[Item]:
    """Return the items of a request with what is to stay as what is kept."""
    return by_sentence(
        list(_without_concessions(items)),
        lambda sentence: _conditional(sentence) or _stays(sentence) or sentence,
    )


def _without_concessions(items: Sequence[Item]) -> Iterator[Item]:
    """Yield items; an "even if it counts" behind what is kept is read, as it changes nothing."""
    begun, kept = False, False
    for at, item in enumerate(items):
        kept = (kept and not item.is_mark(ENDS)) or item.has("keep")
        joined = item.get("rel") == "and" and at + 1 < len(items) and items[at + 1].has("verb")
        if item.is_mark(ENDS + ",:") or joined:
            begun = False
        before = items[at - 1] if at else None
        if kept and before is not None and before.text == "even" and item.text in _CONCEDES:
            begun = True
            before.state = READ
        if begun:
            item.state, item.senses = READ, ()
        after = items[at + 1] if at + 1 < len(items) else None
        if item.text in _FULLY and after is not None and after.has("unchanged"):
            item.state, item.senses = READ, ()  # "stays | exactly | as is"
        yield item


_FULLY = ("exactly", "just", "precisely", "entirely", "completely", "well", "quite")


def _conditional(sentence: Sequence[Item]) -> list[Item]:
    """Read "if the church happens to be in that strip it stays" as "keep the church"."""
    said = [item for item in sentence if item.kind != "mark"]
    if len(said) < 4 or said[0].text != "if":
        return []
    last = [at for at, item in enumerate(said) if item.get("rel") == "it"]
    if not last or not _is_staying(said[last[-1] + 1 :]):
        return []
    named = [at for at, item in enumerate(said[: last[-1]]) if item.noun]
    if not named or any(item.has("neg") for item in said):
        return []
    keep = Item("phrase", said[0].span, ("keep",), (("keep", "keep"),))
    for at, item in enumerate(said):
        if at != named[0]:
            item.state, item.senses = READ, ()
    marks = [item for item in sentence if item.is_mark(ENDS)]
    return [keep, said[named[0]], *marks]


def _stays(sentence: list[Item]) -> list[Item]:
    """Return a sentence whose end says that things stay with that as what is kept, [] for others.

    What stays begins the sentence, or stands behind a comma or a "but" before that.
    """
    end = len(sentence) - bool(sentence[-1].is_mark(ENDS + ":"))
    first = max(1, end - LONGEST)
    at = next((k for k in range(end - 1, first - 1, -1) if _is_staying(sentence[k:end])
               and not _is_staying(sentence[k - 1 : end])), 0)  # fmt: skip
    if not at:
        return []
    for begin in _begins(sentence, at):
        named = [one for one in sentence[begin:at] if one.kind not in ("function", "mark")]
        rest = [one for one in sentence[begin:at] if one.words[-1] in _REST]
        plain = all(one.noun or one.get("rel") in ("and", "all", "be") for one in named)
        if rest and all(one in rest or one.get("rel") in ("all", "of", "it") for one in named):
            for one in sentence[max(begin - 1, 0) : end]:
                one.state, one.senses = READ, ()
            return sentence
        if named and plain and any(one.noun for one in named):
            for one in sentence[at:end]:
                one.state, one.senses = READ, ()
            return [*sentence[:begin], *_kept_each(sentence[begin:at]), *sentence[at:]]
    return []


def _kept_each(named: Sequence[Item]) -> Iterator[Item]:
    """Yield "keep the park; keep the church" for "the park and the church"."""
    begun = False
    for item in named:
        if item.is_mark(",") or item.get("rel") == "and":
            begun = False
            continue
        if not begun:
            yield Item("mark", item.span, (";",))
            yield Item("phrase", item.span, ("keep",), (("keep", "keep"),))
            begun = True
        yield item


def _begins(sentence: Sequence[Item], at: int) -> Iterator[int]:
    """Yield where what stays may begin, the whole of the sentence first."""
    yield 0
    for place in range(1, at):
        if sentence[place - 1].is_mark(",") or sentence[place - 1].text in _TURNS:
            yield place


def _is_staying(words: Sequence[Item]) -> bool:
    """Return whether words say that something stays: "have to survive", "stays exactly as is"."""
    said = [word for one in words if one.kind != "mark" for word in one.words]
    while said and said[0] in (*_OUGHT, *_LINKS):
        said = said[1:]
    if not said or said[0] not in _STAY:
        return False
    return all(word in _HOW for word in said[1:])
