"""Leftovers: what a command says more than is understood, parted from what can be carried out.

"Swap the church for a mosque with two minarets": the mosque is built, the minarets are named. So
only with what tells more of something new, or of what becomes of things. What may say which things
are meant, how many, where or under which condition holds its whole command: that is asked about.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import pairwise

from cityx.language.brief import Edit
from cityx.language.commands.roles import TERM
from cityx.language.commands.wishes import Clause, is_limit
from cityx.language.scan import Item

MOST = 10  # shorter readings of one command that are tried
NEW = ("add", "add_building", "add_path", "add_bridge", "plant")  # verbs of what is new
_WITH = ("with", "featuring", "including")
_ARTICLES = ("a", "an", "some", "another", "one")
_PLACES = ("near", "along", "around", "in", "on", "by", "from", "to")
_BUILT = ("element", "type", "plant", "building", "road")
# Words by which a piece says which of the things before it are meant.
_WHICH = (
    "that", "which", "who", "whose", "where", "those", "these", "ones", "one", "mainly", "mostly",
    "especially", "starting", "beginning", "namely", "at", "between", "within", "opposite", "next",
    "beside", "behind", "facing", "each", "every", "all", "both", "rest", "other", "others",
    "overlooking", "landing", "leading", "ending", "downstream", "upstream", "halfway", "midway",
    "far", "away", "close", "for",
)  # fmt: skip
_BECOMES = ("swap", "replace", "exchange", "turn", "convert", "change", "transform", "substitute")


class Shorter:
    """A command without some of its words.

    Attributes
    ----------
    head
        Its words without them.
    left
        Each run of words that it lacks.
    """

    def __init__(self, words: Sequence[Item], gone: Sequence[tuple[int, int]]) -> None:
        out = {at for first, last in gone for at in range(first, last)}
        self.words = words
        self.gone = list(gone)
        self.head = [item for at, item in enumerate(words) if at not in out]
        self.left = [list(words[first:last]) for first, last in gone]

    def is_safe(self, edits: Sequence[Edit]) -> bool:
        """Return whether the words that are left out cannot change what the others mean.

        Parameters
        ----------
        edits
            What is read of the others.
        """
        if not edits or not all(map(self._may_lack, edits)):
            return False
        new = all(edit.verb in NEW or self._becomes(edit) for edit in edits)
        if not new and any(last - first == 1 for first, last in self.gone):
            return False  # an adjective of what is there says which is meant
        for first, last in self.gone:
            piece = [one for one in self.words[first:last] if one.kind != "mark"]
            if any(is_limit(one) or one.get(TERM) == "EXCEPT" for one in piece):
                return False
            if last - first > 1 and not self._tells_more(first, piece, new=new):
                return False
            placed = any(one.get("rel") in _PLACES for one in piece)
            if placed and any(edit.verb in NEW and not _has_place(edit) for edit in edits):
                return False  # "a café with a terrace by the river": which is by the river?
        return True

    def _may_lack(self, edit: Edit) -> bool:
        if edit.verb == "replace":
            return self._becomes(edit)
        if edit.verb in NEW:
            return True
        told = ("remove", "unspecified", "undo", "redo", "list", "move", "copy")
        return edit.target is not None and edit.verb not in told

    def _becomes(self, edit: Edit) -> bool:
        """Return whether things are to become others, of which what ends the command tells more."""
        verb = next((one for one in self.words if one.has("verb")), self.words[0])
        return edit.verb == "replace" and verb.words[0] in _BECOMES

    def _tells_more(self, first: int, piece: Sequence[Item], *, new: bool) -> bool:
        """Return whether a piece tells more of what is new, or of what becomes of things."""
        if not piece or _is_manner(piece):
            return True
        said = piece[0]
        if any(one.kind == "id" or one.text in _MENDS for one in piece):
            return False
        given = said.words[0] in _WITH
        if given or _names_new(piece):
            apart = self.words[first].is_mark(",") or new or not _ends_in_target(self.words[:first])
            return apart and not any(one.text in _BACK for one in piece)
        if any(one.get("rel") in _PLACES or one.has(TERM, "side", "rank") for one in piece):
            return False
        if said.text == "of":
            return new and len(piece) > 1 and piece[1].quantity is not None
        return not any(word in _WHICH for one in piece for word in one.words)


# Words by which a piece takes back what stands before it.
_MENDS = ("or", "rather", "actually", "sorry", "mean", "instead", "better", "no", "scratch", "wait")
_BACK = ("it", "them", "those", "these", "its", "their", "there", "each", "both")


_MANNERS = ("manner", "style", "fashion", "spirit", "vein")


def _is_manner(piece: Sequence[Item]) -> bool:
    """Return whether a piece says in whose manner something is made: ", in the style of Gaudi"."""
    words = [word for one in piece[:4] for word in one.words]
    return len(words) > 2 and words[0] == "in" and any(one in _MANNERS for one in words[1:3])


def _names_new(piece: Sequence[Item]) -> bool:
    """Return whether a piece names a thing of its own: ", a pond in the middle"."""
    said = [one for one in piece if one.get("rel") not in ("and", "plus")]
    if not said:
        return False
    counted = said[0].quantity is not None and said[0].quantity.dimension == "count"
    return said[0].words[0] in _ARTICLES or counted


def _ends_in_target(words: Sequence[Item]) -> bool:
    """Return whether words end in things that change, of which what follows says which."""
    last = next((one for one in reversed(words) if one.kind not in ("function", "mark")), None)
    return last is None or bool(last.noun) or last.kind == "id"


def shorter(words: Sequence[Item], *, by_adjectives: bool = False) -> Iterator[Shorter]:
    """Yield a command without one, then without more, of the pieces that may be left out.

    Parameters
    ----------
    words
        The command.
    by_adjectives
        Whether only unknown adjectives may be left out: "a | weekly | market".
    """
    pieces = [] if by_adjectives else list(_pieces(words))
    own = list(_adjectives(words))
    runs: list[list[tuple[int, int]]] = [own] if own else []
    runs += [[piece] for piece in reversed(pieces)]
    runs += [[*own, piece] for piece in reversed(pieces)] if own else []
    for count in range(2, len(pieces) + 1):
        runs.append(pieces[-count:])
        runs += [[*own, *pieces[-count:]]] if own else []
    for run in runs[:MOST]:
        made = Shorter(words, sorted(run))
        if any(one.kind not in ("function", "mark") for one in made.head[1:]):
            yield made


def _pieces(words: Sequence[Item]) -> Iterator[tuple[int, int]]:
    """Yield the pieces behind what a command begins with: ", 9 floors", "with two minarets"."""
    end = len(words)
    while end and words[end - 1].is_mark(".;!?\n:"):
        end -= 1
    first = next((at for at, one in enumerate(words) if one.has("verb")), 0) + 2
    starts = [at for at in range(first, end) if _starts(words, at)]
    yield from pairwise([*starts, end] if starts else [])


def _starts(words: Sequence[Item], at: int) -> bool:
    item, before = words[at], words[at - 1]
    if item.is_mark(",(") or item.text in ("+", "plus"):
        return True
    if before.is_mark(",("):
        return False
    after = words[at + 1] if at + 1 < len(words) else item
    if item.get("rel") == "of" or item.text == "of":
        return after.quantity is not None and after.quantity.dimension == "count"
    if item.get("rel") == "and":
        return after.words[0] in _ARTICLES or after.quantity is not None
    return item.words[0] in _WITH


def _adjectives(words: Sequence[Item]) -> Iterator[tuple[int, int]]:
    """Yield unknown words before something new: "a | weekly | market"."""
    for at, item in enumerate(words[:-1]):
        if item.kind != "unknown" or item.state or not at:
            continue
        begin = at - 1
        while begin and (words[begin].kind == "unknown" or words[begin].has("size", "color")):
            begin -= 1
        led = words[begin].words[0] in _ARTICLES or words[begin].quantity is not None
        end = at + 1
        while end < len(words) and words[end].kind == "unknown":
            end += 1
        if led and end < len(words) and words[end].noun_class in _BUILT:
            yield at, at + 1


def as_addition(piece: Sequence[Item]) -> list[Item]:
    """Return "with a lamp on both sides" as an order: "add a lamp on both sides"; [] for others."""
    said = [one for one in piece if not one.is_mark(",()")]
    while said and (said[0].words[0] in _WITH or said[0].get("rel") == "and"):
        said = said[1:]
    new = next((one for one in said if one.kind != "function"), None)
    if new is None or not any(one.noun_class in ("element", "plant") for one in said):
        return []
    at = said[0].span[0]
    return [Item("phrase", (at, at), ("add",), (("verb", "ADD"),)), *map(replace, said)]


def is_new(edits: Sequence[Edit]) -> bool:
    """Return whether all that changes is new."""
    return bool(edits) and all(edit.verb in NEW for edit in edits)


def is_placed(clause: Clause) -> bool:
    """Return whether all that a clause adds has a place of its own."""
    return bool(clause.edits) and all(
        edit.verb in NEW and _has_place(edit) for edit in clause.edits
    )


_KEYS = ("in", "on", "along", "around", "near", "over", "side", "at", "last", "path")


def _has_place(edit: Edit) -> bool:
    return bool(edit.refs) or any(key in _KEYS for key, _ in edit.change)
