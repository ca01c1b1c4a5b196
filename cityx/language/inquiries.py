"""Inquiries: clauses that ask to be told how many of something there are, or which they are.

"Tell me how many houses are within 50 m of the river" asks for a list, whose length is told with
it: the command "list the houses within 50 m of the river". Such a clause asks nothing of the city.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise

from cityx.language.brief import Brief, Command, Edit, Note, Span
from cityx.language.scan import ENDS, Item

_LEAD = re.compile(
    r"(?:(?:and|then|also|please|finally|but|or at least|i want to know|i need to know|"
    r"i would like to know|i'd like to know|let (?:me|us) know|(?:can|could) you) )*"
    r"(?:(?:tell|report|list|print|say|show|give|count|state|output|return|log|write down|what is)"
    r"(?: back)?(?: to)?(?: me| us)?(?: back)? (?:which )?)?"
)
# "The number of" asks; "a number of" and "a total of" tell how many are wanted.
_HOW_MANY = re.compile(
    r"(?:exactly )?(?:how many(?: of(?: the)?)?|the (?:(?:total|exact|final|full) )?"
    r"(?:numbers?|counts?|totals?|list|names|ids)(?: of(?: all)?)?|(?:numbers|counts|totals|names|"
    r"ids) of(?: all)?) (?:the |all |all the )?"
)
_COUNT = re.compile(r"(?:count|what is) ")
_WANTED = re.compile(r"(?:\d|an? |one |some |few |several |more )")  # before what is to be built
_ALSO = re.compile(rf"(?:and )?{_HOW_MANY.pattern}")
_OF_SOME = re.compile(r"\b(?:of|in|for|from) an? ")  # "of a village": the town itself is told
# Of a city that stands: whether there is something, and how tall, long or wide things are.
_WHETHER = re.compile(r"(?:is|are) there (?:still )?(?:an? |any |some )?")
_HOW_LARGE = re.compile(
    r"(?:how|what is the|what are the) (?:tall|high|long|wide|big|large|deep|heights?|lengths?|"
    r"widths?|sizes?|areas?)(?: of)? (?:is |are )?(?:the )?"
)
_WHERE = re.compile(r"where (?:is|are) (?:the )?")
_ANY = re.compile(r"\b(of|near|to|from|by|beside|than) an? ")  # "within 20 m of a house"
_OF_EACH = re.compile(r"(?:each|them|these|those|each kind|each type|it all)$")
# What says no more than that they are there, or that the city has been made.
_THERE = re.compile(
    r" ?\b(?:there (?:are|were|is|was|will be)|(?:are|were|is) there|there|in the end|in total|"
    r"in all|altogether|overall|(?:did |have |do )?you (?:have )?(?:place|placed|put|make|made|"
    r"build|built|use|used|add|added|generate|generated|create|created|keep|kept|find|found|"
    r"get|got)|(?:are|were) (?:placed|built|made|added|left|used|present)|it has|we get|exist|"
    r"stand|afterwards|please)$"
)
_BE = re.compile(r"^(?:are|is|were|was|stand|stands|lie|lies|sit)\b ?")
_HAVE = re.compile(r"^(?:have|has|had)\b")
_AND = re.compile(r",? and (?:the )?|, (?:the )?")
_PLACE = ("near", "in", "on", "at", "along", "around", "within", "by", "beside", "of", "with",
          "inside", "north", "south", "east", "west", "under", "over", "above", "below", "that",
          "whose", "taller", "higher", "lower", "between", "from", "outside",
          "without")  # fmt: skip
OF_THE_CITY = "a question about the city"


@dataclass(frozen=True)
class Inquiry:
    """A clause that asks for things.

    Attributes
    ----------
    items
        The items of the clause.
    commands
        What lists them, as commands; none of an inquiry about all that was named before.
    """

    items: Sequence[Item]
    commands: tuple[str, ...]

    @property
    def span(self) -> Span:
        """Where the clause stands."""
        return self.items[0].span[0], self.items[-1].span[1]


def inquiries(text: str, items: Sequence[Item], *, plain: bool) -> Iterator[Inquiry]:
    """Yield the clauses of a text that ask for the number or the list of something.

    Parameters
    ----------
    text, items
        The text and its items.
    plain
        Whether "list the trees" is one too, that asks for no number.
    """
    kinds: list[str] = []
    for clause in _clauses(items, plain):
        found = _inquiry(text, clause, kinds, here=not plain)
        if found is not None:
            yield found


def _clauses(items: Sequence[Item], plain: bool) -> Iterator[Sequence[Item]]:
    """Yield what may be an inquiry: sentences, and what follows "and" or a comma in one."""
    begin = 0
    for at, item in enumerate((*items, None)):
        if item is not None and not item.is_mark(ENDS):
            continue
        sentence = items[begin:at]
        begin = at + 1
        starts = [
            n
            for n, one in enumerate(sentence)
            if not n or sentence[n - 1].is_mark(",:(-") or one.get("rel") in ("and", "but")
        ]
        first = next((n for n in starts if _asks(sentence[n:], plain)), None)
        if first is None and not plain and item is not None and item.is_mark("?"):
            first = next((n for n in starts if _asks_here(sentence[n:])), None)
        if first is None:
            continue
        end = _end(sentence, first)
        more = [n for n in starts if first < n < end and _ALSO.match(_said(sentence[n:]))]
        for low, high in pairwise((first, *more, end)):
            yield sentence[low : _without_joints(sentence, low, high)]


def _without_joints(sentence: Sequence[Item], low: int, high: int) -> int:
    """Return where a clause ends without the comma and the "and" behind it."""
    while high > low + 1 and (
        sentence[high - 1].kind == "mark" or sentence[high - 1].text in ("and", "but", "then")
    ):
        high -= 1
    return high


_ORDERING = ("i", "we", "please", "so", "build", "make", "put")


def _end(sentence: Sequence[Item], first: int) -> int:
    """Return where an inquiry ends: at a colon, and at an order or a wish that follows."""
    for n in range(first + 1, len(sentence)):
        joined = sentence[n - 1].is_mark(",") or sentence[n - 1].get("rel") in ("and", "but")
        joined = joined or sentence[n - 1].text == "then"
        wish = sentence[n].has("verb") or sentence[n].text in _ORDERING
        if sentence[n].is_mark(":;") or (joined and wish):
            return n
    return len(sentence)


def _said(clause: Sequence[Item]) -> str:
    """Return how a clause begins."""
    return " ".join(word for item in clause[:8] for word in item.words)


def _asks(clause: Sequence[Item], plain: bool) -> bool:
    said = _said(clause)
    lead = _LEAD.match(said)
    assert lead is not None
    how = _HOW_MANY.match(said, lead.end())
    led = lead.group().strip()
    if how is None:
        counts = _COUNT.match(led + " ") and said.startswith(("the ", "all "), lead.end())
        return bool(counts) or (plain and led.endswith(("list", "list me", "list us")))
    label = any(item.is_mark(":") for item in clause) and not led  # "how many houses: 40"
    return not label and (bool(led) or how.group().startswith(("how many", "exactly")))


def _asks_here(clause: Sequence[Item]) -> bool:
    """Return whether a question asks what there is in a city that stands, or how large it is."""
    said = f"{_said(clause)} "
    return bool(_WHETHER.match(said) or _HOW_LARGE.match(said) or _WHERE.match(said))


def _inquiry(
    text: str, clause: Sequence[Item], before: list[str], *, here: bool
) -> Inquiry | None:  # fmt: skip
    """Take a clause apart into what is asked for and what sets it apart.

    Parameters
    ----------
    before
        Kinds that the text asked for last, of which "and how many on Hay Road" tells another place.
    here
        Whether it is of a city that stands.
    """
    said = text[clause[0].span[0] : clause[-1].span[1]].strip(" .,;!?")
    said = re.sub(r"\s+", " ", said)
    lowered = said.casefold()
    lead = _LEAD.match(lowered)
    assert lead is not None
    how = _HOW_MANY.match(lowered, lead.end())
    whether = _WHETHER.match(lowered) if here else None
    if here and how is None:
        how = whether or _HOW_LARGE.match(lowered) or _WHERE.match(lowered)
    rest = said[how.end() if how else lead.end() :].strip(" ,;:")
    if here:
        rest = _ANY.sub(r"\1 any ", rest)
    rest = re.sub(r"^(?:of )(?:the )?", "", rest)
    while found := _THERE.search(rest.casefold()):
        rest = rest[: found.start()].strip(" ,")
    if not rest or _OF_SOME.search(rest.casefold()) or _WANTED.match(rest.casefold()):
        return None
    if _OF_EACH.match(rest.casefold()):
        return Inquiry(clause, ())
    words = rest.split(" ")
    cut = next((n for n, word in enumerate(words) if n and _ends_subject(word)), len(words))
    subject, which = " ".join(words[:cut]), " ".join(words[cut:])
    which = _HAVE.sub("with", _BE.sub("", which))
    if words[0].casefold() in _PLACE and before:
        kinds, which = before, rest
    else:
        kinds = [kind for kind in _AND.split(subject) if kind]
        before[:] = kinds
    tail = f" {which}" if which else ""
    each = "any" if whether is not None else "the"
    return Inquiry(
        clause, tuple(f"List {each} {kind.removeprefix('the ')}{tail}" for kind in kinds)
    )


def _ends_subject(word: str) -> bool:
    plain = word.casefold().strip(",")
    return plain in _PLACE or bool(_BE.match(plain) or _HAVE.match(plain))


@dataclass
class Answers:
    """What a text asks to be told.

    Attributes
    ----------
    edits
        Lists of what stands in a city that exists.
    commands
        Lists of what will stand in a city that is described.
    notes
        What stays open.
    """

    edits: list[Edit] = field(default_factory=list)
    commands: list[Command] = field(default_factory=list)
    notes: list[Note] = field(default_factory=list)


def read_inquiries(
    text: str, items: list[Item], read: Callable[[str], Brief], *, base: bool
) -> tuple[Answers, list[Item]]:
    """Return what a text asks to be told, and the items that ask for something else.

    Parameters
    ----------
    text, items
        The text and its items.
    read
        Reads a command as one for a city that exists.
    base
        Whether the text itself is about one; the grammar of edits knows plain lists.
    """
    answers = Answers()
    gone: set[int] = set()
    for one in inquiries(text, items, plain=not base):
        asked = one.commands or ([] if base else _named_before(items, one.items[0]))
        briefs = [read(f"{command}.") for command in asked]
        if briefs and all(map(_is_a_list, briefs)):
            answers.commands += [Command(command, one.span) for command in asked]
            answers.edits += [replace(edit, span=one.span) for it in briefs for edit in it.edits]
        elif base:
            continue  # what was done, or a question for the grammar of edits
        else:
            words = text[slice(*one.span)]
            said = f'"{words}" ({OF_THE_CITY}) has no measure and is left open.'
            answers.notes.append(Note("left_open", said, one.span))
        at = next(n for n, item in enumerate(items) if item is one.items[0])
        gone.update(range(at, at + len(one.items)))
        while at and (items[at - 1].is_mark(",") or items[at - 1].get("rel") in ("and", "but")):
            at -= 1
            gone.add(at)
    if not base:
        answers.edits.clear()
    return answers, [item for n, item in enumerate(items) if n not in gone]


def _named_before(items: Sequence[Item], first: Item) -> list[str]:
    """Return lists of the kinds that the sentences before name: "the count of each"."""
    kinds: dict[str, None] = {}
    for item in items:
        if item is first:
            break
        if item.noun_class in ("element", "plant", "vehicle", "person", "type") and item.noun:
            kinds[f"List the {' '.join(item.words)}"] = None
    return list(kinds)


def _is_a_list(brief: Brief) -> bool:
    """Return whether a command was read as lists alone, and all of it."""
    listed = bool(brief.edits) and all(edit.verb == "list" for edit in brief.edits)
    open_ = brief.unread or brief.questions or brief.left or brief.conflicts or brief.negated
    roofs = "roof" in brief.text and any(
        filter_.startswith("color") for edit in brief.edits if edit.target is not None
        for filter_ in edit.target.filters
    )  # fmt: skip
    return listed and not open_ and not roofs  # colours that tell things apart are of walls
