"""Implied commands: phrases of a description that only a change of the finished city brings about.

"Six benches beside the fountain" has no slot; the command "put six benches beside the fountain"
has an action and a measure. A phrase that leaves something open is tried as it stands where it
begins with a verb, and else as something to be put where it says. It becomes a command only where
the grammar of edits takes every word of it; what it names as a place is still asked of the town.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

from cityx.checks.predicates.vocabulary import family_of
from cityx.language.brief import Brief, Command, Edit, Slot, Span, Value
from cityx.language.commands.sentences import ENVIRONMENT
from cityx.language.commands.wishes import commands_of, is_command
from cityx.language.describe import unread
from cityx.language.here import AIR, Findings
from cityx.language.homonyms import name_behind
from cityx.language.lexicon.phrases import NOUNS, SLOTS
from cityx.language.measurable import things
from cityx.language.placings import placings
from cityx.language.scan import ENDS, Item, begin_of
from cityx.language.scopes import NEGATED, READ
from cityx.language.statements import statements
from cityx.language.street_words import OF_STREETS
from cityx.language.syntax import is_plural
from cityx.town.elements import ELEMENTS, OTHER_THINGS

PLACES = (
    "in",
    "on",
    "at",
    "near",
    "along",
    "around",
    "of",
    "side",
    "between",
    "path",
    "to",
    "from",
)  # keys of a change
PUTS = ("add", "add_agent", "plant")  # edits by which something comes to stand somewhere
# Ends of keys of slots that say where something stands.
PLACED = (
    "near", "relation", "second", "side", "spacing", "streets", "parks", "by", "part", "enclosed",
)  # fmt: skip
OF_WHAT_STANDS = ("replace", "move", "copy", "add_building")  # changes of what a map holds
NOT_IMPLIED = (
    "undo", "redo", "unspecified", "move", "replace", "add_building", *ENVIRONMENT.values(),
)  # fmt: skip
LONGEST = 160  # letters of a command
MOST = 20  # phrases of a text that are tried, so that time stays short
# Verbs that are nothing else; "open", "close" and "narrow" also tell how things are.
_VERBS = ("put", "add", "place", "plant", "paint", "line", "remove", "delete", "repaint", "cover")
_AND = frozenset(("and", "but", "then", "also"))
_JOINING = ("with", "and", "has", "have", "having", "plus")  # words before a phrase of its own

# What is no place in a city: a word for another, the whole, or a kind of town.
_NOWHERE = frozenset(("it", "city", "landscape", *SLOTS["district"])) - {*NOUNS["element"]}
_PROPER = re.compile(r"\b[A-Z][\w'’-]+(?: [A-Z][\w'’-]+)+")

Read = Callable[[str], Brief]


def proper_names(text: str) -> tuple[str, ...]:
    """Return what a text seems to call by a name of several words: "Old Compton Street"."""
    return tuple(dict.fromkeys(_PROPER.findall(text)))


@dataclass(frozen=True)
class _Phrase:
    """Items of a description that may be a command, and how it would be said."""

    items: Sequence[Item]
    command: str
    ordered: bool  # whether it begins with a verb of its own
    told: bool = False  # whether it is put as an order, of what the text states
    place: Sequence[Item] = ()  # items of the place that are read with it

    @property
    def span(self) -> Span:
        return self.items[0].span[0], self.items[-1].span[1]

    @property
    def whole(self) -> Span:
        """Its span with that of the place before it."""
        return (*self.place, *self.items)[0].span[0], self.span[1]

    def holds(self, span: Span) -> bool:
        """Return whether a place of the text lies in the phrase."""
        return self.span[0] <= span[0] and span[1] <= self.span[1] and span[1] > 0


def read_implied_commands(
    found: Findings, items: Sequence[Item], read: Read, *, surveyed: bool = False
) -> list[Command]:
    """Return the commands that phrases stand for; what was read of these is taken back.

    Parameters
    ----------
    found
        What has been read; slots and notes of a phrase that becomes a command go, but for those
        of the place that it names.
    items
        All items; those of a command count as read.
    read
        Reads a command as one for a city that exists.
    surveyed
        Whether the city is that of a map, whose things an order may be about.
    """
    commands: list[Command] = []
    tried: set[str] = set()
    spans = _open_spans(found, items)
    told = [_Phrase(own, said, ordered=True, told=True)
            for said, own in statements(found.text, items, found.notes)]  # fmt: skip
    told += [*_closures(found.text, items), *_namings(found.text, items)]
    moving = [*_driving(items)]
    placed = [_Phrase(one.items, f"{one.verb} {one.said}", one.verb != "put", told=True,
                      place=one.place) for one in placings(found.text, items)]  # fmt: skip
    for phrase in (*placed, *_phrases(found.text, items), *told, *moving):
        done = any(phrase.holds(one.span) or _inside(phrase.span, one.span) for one in commands)
        if done or _is_settled(phrase, found) or _is_bound(items, phrase):
            continue
        left = phrase in (*placed, *moving) or any(map(phrase.holds, spans))
        if len(tried) == MOST or phrase.command in tried or not (left or phrase.ordered):
            continue
        tried.add(phrase.command)
        brief = read(f"{phrase.command}.")
        changes = (
            surveyed
            and phrase.ordered
            and any(
                _is_of_what_stands(
                    edit, denied=any(phrase.holds(one.span) for one in found.negated)
                )
                for edit in brief.edits
            )
        )
        if not _is_taken(brief, phrase, changes=changes):
            continue
        if not (left or changes or any(map(_selects, brief.edits))):
            continue
        commands.append(Command(phrase.command, phrase.whole))
        _settle(found, phrase, brief.edits)
    _leave_rows_elsewhere(found, items)
    return commands


def _leave_rows_elsewhere(found: Findings, items: Sequence[Item]) -> None:
    """Leave what stands every so many metres where its place is left open: not everywhere else."""
    ends = [item.span[0] for item in items if item.is_mark(ENDS)]
    for slot in [one for one in found.slots if one.key.endswith("spacing")]:
        end = next((at for at in ends if at >= slot.span[1]), len(found.text))
        thing = {"nature": "tree"}.get(name := slot.key.partition(".")[0], name)
        places = (note.span[0] for note in found.notes if f"(where the {thing} is)" in note.text)
        if any(slot.span[1] <= at < end for at in places):
            found.slots.remove(slot)
            found.leave_span(slot.span, "in one place alone")


def _inside(span: Span, other: Span) -> bool:
    return other[0] <= span[0] and span[1] <= other[1]


def _phrases(text: str, items: Sequence[Item]) -> Iterator[_Phrase]:
    """Yield the clauses that begin with a verb, and of the others what marks and "and" part."""
    for clause in commands_of(items):
        live = [item for item in clause if item.kind != "mark"]
        while live and _AND.union(_JOINING).issuperset(live[-1].words):
            live.pop()
        live = live[_file_named(live) :]
        if live and _is_order(live):
            yield from _phrase(text, live, "")
            for order in _orders(live):  # where the whole of it is not taken
                yield from _phrase(text, order, "")
            continue
        yield from _journeys(text, live)
        yield from _together(text, live)
        part: list[Item] = []
        apart = True  # whether it is no part of what is named before it
        for item in clause:
            if item.is_mark(ENDS + ",:") or item.text in (*_JOINING, "but"):
                yield from _part(text, part if apart else [])
                apart = item.text != "with" or not _is_of_one(part)
                part = [item] if item.text == "but" else []
            elif item.kind != "mark":
                part.append(item)
        yield from _part(text, part if apart else [])


def _journeys(text: str, items: Sequence[Item]) -> Iterator[_Phrase]:
    """Yield who leaves a place and goes to another: "people leave the church and walk to"."""
    for at, item in enumerate(items):
        if item.text not in _LEAVING or not at or items[at - 1].noun_class != "person":
            continue
        first = at - 2 if at > 1 and items[at - 2].quantity is not None else at - 1
        joined = next((n for n in range(at + 1, len(items)) if items[n].get("rel") == "and"), 0)
        if joined and any(one.get("rel") == "to" for one in items[joined : joined + 3]):
            end = next((n for n in range(joined, len(items)) if items[n].noun), -1) + 1
            yield from _phrase(text, items[first:end], "put ")


_AGENTS = ("vehicle", "person")


def _is_agent(item: Item) -> bool:
    return item.noun_class in _AGENTS


def _is_furniture(item: Item) -> bool:
    """Return whether an item tells of several things of which a town has more elsewhere."""
    known = item.noun in OTHER_THINGS or item.noun_class == "plant"
    return known and item.has("noun") and is_plural(item.words[-1])


def _together(text: str, items: Sequence[Item]) -> Iterator[_Phrase]:
    """Yield what several do or stand at one place: "an ambulance and two fire engines | come".

    Lamps and benches along a street are so, too; a church and benches on a square are not.
    """
    for at, item in enumerate(items):
        listed = _is_agent if at and _is_agent(items[at - 1]) else _is_furniture
        if item.get("rel") != "and" or not at or not listed(items[at - 1]):
            continue
        other = next((n for n in range(at + 1, min(at + 4, len(items))) if items[n].noun), 0)
        if not other or not listed(items[other]):
            continue
        first = at - 1
        while first and (items[first - 1].kind in ("quantity", "function")
                         or (listed is _is_furniture and listed(items[first - 1]))):  # fmt: skip
            first -= 1
        if first and items[first - 1].get("rel") in _SPOTS:
            return
        ends = (n for n in range(other, len(items)) if items[n].text in ("with", "and"))
        end = next(ends, len(items))
        if end > other + 1:
            yield from _phrase(text, items[first:end], "put ")
        return


_OF_FILES = ("any_source", "source", "verb", "keep", "unchanged")


def _file_named(items: Sequence[Item]) -> int:
    """Return where an order begins behind the file it is about: "use the map, and | close"."""
    end = next((at for at, one in enumerate(items) if one.get("rel") in ("and", "but")), 0)
    file = items[:end]
    told = any(one.has("any_source", "source") for one in file)
    plain = all(one.kind == "function" or one.has(*_OF_FILES) for one in file)
    return end + 1 if told and plain else 0


_CLOSED = ("closed to", "shut to", "barred to", "closed off to", "off limits to")
_LEADING = ("with", "where", "and", "but", "while", "has", "have", "of")  # before a street


def _closures(text: str, items: Sequence[Item]) -> Iterator[_Phrase]:
    """Yield orders for a street that is told to be without cars: "the high street closed to"."""
    for at, item in enumerate(items):
        closed = item.text in _CLOSED and at + 1 < len(items)
        closed = closed and items[at + 1].noun_class == "vehicle"
        if not closed and item.get("slot") != "not=vehicle":
            continue
        behind = items[at + 1] if not closed and at + 1 < len(items) else None
        if behind is not None and behind.noun_class == "road" and not is_plural(behind.words[-1]):
            said = text[behind.span[0] : behind.span[1]]  # "a car-free | main street"
            yield _Phrase(items[at : at + 2], f"close the {said} to cars", ordered=True, told=True)
            continue
        end = at - 1 if at and items[at - 1].get("rel") == "be" else at
        first = end
        while first and items[first - 1].kind != "mark" and items[first - 1].text not in _LEADING:
            first -= 1
        street = next((one for one in items[first:end] if one.noun), None)
        if street is None or street.noun_class != "road" or is_plural(street.words[-1]):
            continue
        said = text[items[first].span[0] : items[end - 1].span[1]]
        own = items[first : at + 2 if closed else at + 1]
        yield _Phrase(own, f"close {said} to cars", ordered=True, told=True)


def _namings(text: str, items: Sequence[Item]) -> Iterator[_Phrase]:
    """Yield names of what a description tells of: "a park | called Miller's Green"."""
    for at, item in enumerate(items):
        noun = next((one for one in reversed(items[max(at - 3, 0) : at]) if one.noun), None)
        found = name_behind(text, items, at)
        one = noun is not None and noun.noun != "city" and not noun.words[-1].endswith("s")
        if found is not None and noun is not None and one:
            said = f"call the {noun.text} {found[0]}"
            yield _Phrase([item, *found[1]], said, ordered=True, told=True)


_ON_THE_MOVE = ("driving", "moving", "cruising")


def _driving(items: Sequence[Item]) -> Iterator[_Phrase]:
    """Yield vehicles that drive, of which parked ones are none: "20 moving cars"."""
    for at, item in enumerate(items):
        amount = item.quantity
        if amount is None or amount.dimension != "count":
            continue
        number = item.text if amount.exact is not None else f"{amount.low or amount.high:g}"
        own = items[at : at + 3]  # "20 moving cars", "five cars driving"
        noun = next((one for one in own if one.noun == "vehicle"), None)
        moves = [one for one in own if not set(one.words).isdisjoint(_ON_THE_MOVE)]
        if noun is not None and moves:
            end = max(own.index(noun), own.index(moves[0])) + 1
            yield _Phrase(own[:end], f"add {number} {noun.words[-1]}", ordered=True, told=True)


def _part(text: str, items: Sequence[Item]) -> Iterator[_Phrase]:
    """Yield what stands between marks: an order of its own, or something to be put somewhere."""
    begin = next((at for at, one in enumerate(items) if not _AND.issuperset(one.words)), len(items))
    if begin and _is_order(items[begin:]):
        yield from _phrase(text, items[begin:], "")  # "keep the map, | but remove the church"
        for order in _orders(items[begin:]):
            yield from _phrase(text, order, "")
        return
    yield from _phrase(text, items, "put ")
    yield from _phrase(text, _without_doing(items), "put ")


def _without_doing(items: Sequence[Item]) -> Sequence[Item]:
    """Return people with their place, without what they do there, [] where that is told.

    "Tourists taking photos before the cathedral" are tourists before the cathedral; what they do
    is named as not understood.
    """
    first = next((at for at, one in enumerate(items) if _tells_doing(one)), 0)
    before = items[:first]
    if not any(one.noun_class == "person" for one in before):
        return []
    placed = any(one.get("rel") in _SPOTS for one in before)
    end = next((at for at in range(first, len(items)) if items[at].get("rel") in _SPOTS), first)
    if not placed and end == first:
        return []
    return [*before, *(() if placed else items[end:])]


def _tells_doing(item: Item) -> bool:
    """Return whether an item is a participle that nobody can be told to do: "taking"."""
    unknown = item.kind == "unknown" or (item.has("verb") and not item.has("mode", "noun", "rel"))
    return unknown and item.text.endswith("ing")


_SPOTS = ("in", "on", "near", "along", "around", "by")


def _orders(items: Sequence[Item]) -> list[list[Item]]:
    """Return the orders of a clause, if several: "paint it red | , and plant limes along it"."""
    parts: list[list[Item]] = [[]]
    for at, item in enumerate(items):
        if at and item.has("verb") and items[at - 1].get("rel") == "and" and _is_order(items[at:]):
            parts.append([])
        parts[-1].append(item)
    for part in parts:
        while part and _AND.issuperset(part[-1].words):
            part.pop()
    return parts if len(parts) > 1 else []


def _is_of_one(part: Sequence[Item]) -> bool:
    """Return whether what follows "with" is of things: "houses with | gardens at the edge"."""
    last = next((item for item in reversed(part) if item.noun), None)
    return last is not None and last.noun_class in ("type", "building", "person", "vehicle")


def _without_hours(items: Sequence[Item]) -> Sequence[Item]:
    """Return a phrase without the hour, season or weather at its end: "joggers | at dawn"."""
    end = len(items)
    told = [at for at, item in enumerate(items) if item.get("slot").startswith(AIR)]
    if told and told[-1] == end - 1 and told[0] > 0:
        end = told[0]
        while end and (items[end - 1].kind == "function" or items[end - 1].get("rel") in _AT
                       or items[end - 1].text in ("early", "late")):  # fmt: skip
            end -= 1
    return items[:end] if end else items


_LEAVING = ("leave", "leaves", "leaving")
_AT = ("in", "on", "at")
_CONDITIONS = ("where", "if", "unless", "when", "whenever")


def _is_order(items: Sequence[Item]) -> bool:
    """Return whether a clause begins with a verb: "open the gates", and not "open fields"."""
    plain = bool(items) and items[0].text in _VERBS
    if len(items) < 2 or not (plain or (items[0].has("verb") and is_command(items, 0))):
        return False
    after = items[1]
    if items[0].words[-1] in ("all", "every", "each", "the"):
        return True  # "replace all | houses"
    return plain or after.kind in ("function", "quantity", "id") or after.has("rel", "amount")


def _phrase(text: str, items: Sequence[Item], verb: str) -> Iterator[_Phrase]:
    items = _without_hours(items)
    if len(items) > 1:
        command = verb + _said(text, items)
        if len(command) <= LONGEST:
            yield _Phrase(items, command, not verb)


def _said(text: str, items: Sequence[Item]) -> str:
    """Return items in the words of the text, without what stands between them and is no mark."""
    said = text[items[0].span[0] : items[0].span[1]]
    for before, item in pairwise(items):
        between = text[before.span[1] : item.span[0]]
        said += (between if not between.strip(" ,-'’\"") else " ") + text[slice(*item.span)]
    return said


def _is_settled(phrase: _Phrase, found: Findings) -> bool:
    """Return whether slots place what a phrase is about, or something of it is denied."""
    open_ = any(note.code == "left_open" and phrase.holds(note.span) for note in found.notes)
    moving = next((one for one in phrase.items if one.noun), None)
    moving = moving if moving is not None and moving.noun_class in _AGENTS else None
    ends = (
        slot.key.rpartition(".")[2] for slot in found.slots if phrase.holds(slot.span)
        and (moving is None or slot.key.partition(".")[0] == moving.noun)
    )  # fmt: skip
    spaced = any(note.about.startswith("spacing") and phrase.holds(note.span)
                 for note in found.notes)  # fmt: skip
    placed = not spaced and any(end in PLACED and not (open_ and end == "spacing") for end in ends)
    denied = not phrase.ordered and any(item.state == NEGATED for item in phrase.items)
    return denied or placed  # "benches every 50 m | along the high street" are not yet


def _is_bound(items: Sequence[Item], phrase: _Phrase) -> bool:
    """Return whether a phrase holds under a condition, or tells what somebody does."""
    first = phrase.items[0]
    doing = not phrase.ordered and first.has("mode", "verb") and not first.has("noun", "slot")
    doing &= first.words[-1] != "of"  # "a queue of cars"
    at = items.index(first)
    before = items[begin_of(items, at, ENDS) : at]
    conditions = [one for one in _CONDITIONS if not (phrase.told and one == "where")]
    return doing or any(one.text in conditions for one in before)


def _open_spans(found: Findings, items: Sequence[Item]) -> list[Span]:
    """Return where a description leaves something open."""
    every = any(slot.every for slot in found.slots)
    left = [item.span for item in unread(items, described=True, every=every)]
    return left + [note.span for note in found.notes if note.code == "left_open"]


def _is_of_what_stands(edit: Edit, *, denied: bool) -> bool:
    """Return whether an order is of what a map holds, and by how much it changes.

    "Add 3 m to every building" makes none of them 3 m high; what is denied is not built at all.
    """
    removes = edit.verb == "remove" and not denied
    return removes or edit.verb in OF_WHAT_STANDS or "by" in dict(edit.change)


def _is_taken(brief: Brief, phrase: _Phrase, *, changes: bool = False) -> bool:
    """Return whether a command was understood as a whole, and is measured."""
    if not is_understood(brief) or (
        len({edit.verb for edit in brief.edits}) > 1 and not phrase.told
    ):
        return False
    edit = brief.edits[0]
    if any(_is_laid_out(one) for one in brief.edits):
        return False
    if any(own.text in _OWN and side.has("side") for own, side in pairwise(phrase.items)):
        return False  # "a pond on | its south": a phrase alone does not tell whose
    if any(ref.key == "corner" and not ref.spots for one in brief.edits for ref in one.refs):
        return False  # corners of the site are for what is laid out with it
    agents = (dict(one.change).get("agent") for one in brief.edits)
    if any(agent is not None and not things(str(agent)) for agent in agents):
        return False  # "kids and dogs in the park": of dogs there are none
    if any(one.text in _LEAVING for one in phrase.items) and "from" not in dict(edit.change):
        return False  # "people leave the square by three streets"
    barred = set(NOT_IMPLIED) - (set(OF_WHAT_STANDS) if changes else set())
    if edit.verb in barred or not brief.goals:
        return False
    if any(_is_of_a_street(one) for one in brief.edits):
        return False
    if not _NOWHERE.isdisjoint(value for one in brief.edits for value in _needs(one)):
        return False
    placed = edit.verb in PUTS and (edit.refs or any(key in PLACES for key, _ in edit.change))
    return phrase.ordered or bool(placed)


_OWN = ("its", "their", "whose")


def _is_laid_out(edit: Edit) -> bool:
    """Return whether a change puts land on a bank, for which a town that is built has no room."""
    element = str(dict(edit.change).get("element", ""))
    banked = any(ref.key == "side" for ref in edit.refs)
    return banked and family_of(element) == "land"


def _is_of_a_street(edit: Edit) -> bool:
    """Return whether what is to be put somewhere is a part of streets: slots say how these are."""
    put = (str(value) for key, value in edit.change if key == "element")
    return edit.verb in PUTS and any(
        one in OF_STREETS or things(one).partition(",")[0] == "road" for one in put
    )


def is_understood(brief: Brief) -> bool:
    """Return whether rules have read a change as a whole."""
    return bool(brief.edits) and not (
        brief.questions or brief.unread or brief.conflicts or brief.left
    )


def _selects(edit: Edit) -> bool:
    """Return whether a change is of some things among others, or of one place alone."""
    if edit.verb in ("close", "open", "rename"):
        return True
    said = {key for key, _ in edit.target.items()} if edit.target is not None else set()
    placed = any(key in ("along", "around") for key, _ in edit.change)
    return bool(said - {"target"} or edit.refs) or placed


def _settle(found: Findings, phrase: _Phrase, edits: Sequence[Edit]) -> None:
    """Take back what was read of a phrase, but ask a town for what the command needs there."""
    for item in (*phrase.items, *phrase.place):
        item.state = item.state or READ
    parts = any(one.target is not None and one.target.share is not None for one in edits)
    kinds = {str(value) for edit in edits for value in _needs(edit)}
    for slots in (found.slots, found.negated, found.kept):
        slots[:] = [slot for slot in slots if not phrase.holds(slot.span)
                    or (parts and slot.key == "building.type")
                    or (not found.mapped and _places(slot, kinds))]  # fmt: skip
    found.notes[:] = [
        note
        for note in found.notes
        if note.code != "left_open" or not _inside(note.span, phrase.whole)
    ]
    found.added |= {things(str(value)).partition(",")[0] for edit in edits
                    for key, value in edit.change if key == "agent"}  # fmt: skip
    there = {slot.key.partition(".")[0] for slot in found.slots}
    there |= {str(slot.value) for slot in found.slots}
    for needed in dict.fromkeys(value for edit in edits for value in _needs(edit)):
        asked = needed in NOUNS["element"] or needed in ELEMENTS or needed == "main_street"
        if asked and things(str(needed)) and not found.mapped and needed not in there:
            said = found.text[slice(*phrase.span)]
            found.slots.append(Slot("element", needed, phrase.span, said))


def _places(slot: Slot, needed: Collection[str]) -> bool:
    """Return whether a slot tells of a place that a command needs where that place is."""
    kind, _, key = slot.key.rpartition(".")
    return (kind in needed and key in PLACED) or (slot.key == "element" and slot.value in needed)


def _needs(edit: Edit) -> Iterator[Value]:
    """Yield what must be there for a change: what it is about, and what it names as places."""
    spots = [spot for one in edit.refs for spot in one.spots]
    target = [] if edit.target is None else [edit.target, *edit.target.but]
    for selector in (*spots, *target):
        yield from (value for key, value in selector.items() if key in ("target", *PLACES))
        yield from (spot.kind for one in selector.where for spot in one.spots)
    yield from (value for key, value in edit.change if key in (*PLACES, "path"))
