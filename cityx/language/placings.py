"""Placings: what a description places in words that no order has, said as one would order it.

"Streets lined with parked cars" are parked cars along the streets; "a hospital with an ambulance
at the entrance" has it at the entrance of the hospital, and "a square with four benches round it"
has them round the square. Whether an order is understood is told by who reads it.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from cityx.language.counted_there import are_more, others_of
from cityx.language.here import BUILDINGS
from cityx.language.lexicon.words import forms_of
from cityx.language.relations import LINED, before_between
from cityx.language.scan import ENDS, Item, begin_of, end_of
from cityx.language.syntax import Syntax, is_plural
from cityx.town.elements import ELEMENTS

_RINGED = ("plaza", "park", "lake", "pond", "building", "type")  # what is lined all round
_HAVING = ("with", "has", "have", "having")
_SPOTS = (
    "entrance", "entrances", "end", "ends", "corner", "corners", "middle", "center", "door", "gate",
    "edge", "foot", "side", "sides", "back", "front",
)  # fmt: skip
_OPEN = ("outside", "behind", "in front", "on both sides", "on either side", "on each side")
_OWN = ("its", "it")
# Where people are who cross a street.
_CROSSING, _CROSSED = ("crossing", "cross", "crosses"), "the zebra crossings"
_LINK = ("in", "on", "at", "near", "along", "around", "by", "of", "between", "from", "to")


@dataclass(frozen=True)
class Placing:
    """An order, the items that it stands for, and those of the place right before them."""

    said: str
    items: Sequence[Item]
    place: Sequence[Item] = ()
    verb: str = "put"


def placings(text: str, items: Sequence[Item]) -> Iterator[Placing]:
    """Yield what is told to stand, lie, wait or be parked somewhere, as orders."""
    syntax = Syntax(items)
    yield from _listed(text, syntax)
    for at, item in enumerate(items):
        if item.words and item.words[0] in LINED:
            yield from _lined(text, syntax, at)
        elif item.text in _HAVING:
            yield from _held(text, syntax, at)
        elif item.text in _CROSSING:
            yield from _crossing(text, syntax, at)
        elif item.noun == "parked_vehicle":
            yield from _parked(text, syntax, at)
        elif (head := others_of(syntax, at)) >= 0 and are_more(syntax, at, head):
            yield from _others(text, syntax, at, items[head])


def _others(text: str, syntax: Syntax, at: int, thing: Item) -> Iterator[Placing]:
    """Yield more of a kind at another place: "six benches on the square and | two in the park"."""
    items = syntax.items
    part = next(_parts(items, at), ())
    if len(part) < 3:
        return
    number = items[at].quantity
    one = number is None or number.exact == 1
    named = _said(text, [thing]).lower()
    if one and is_plural(thing.words[-1]):
        named = forms_of(named)[-1]
    said = f"{'a' if one else _said(text, [items[at]])} {named} {_said(text, part[1:])}"
    yield Placing(said, part)


def _said(text: str, items: Sequence[Item]) -> str:
    return text[items[0].span[0] : items[-1].span[1]] if items else ""


def _named(text: str, item: Item) -> str:
    said = _said(text, [item])
    return f"the {said[:1].lower()}{said[1:]}"


def _parts(items: Sequence[Item], first: int) -> Iterator[Sequence[Item]]:
    """Yield what commas and "and" part from an item on, but for what something else has."""
    end = end_of(items, first, ENDS + ":")
    other = next((at for at in range(first, end) if items[at].text in _HAVING), end)
    part: list[Item] = []
    for item in items[first:other]:
        if item.is_mark(",") or item.get("rel") in ("and", "but"):
            yield part
            part = []
        elif item.kind != "mark":
            part.append(item)
    if other == end:
        yield part


def _lined(text: str, syntax: Syntax, at: int) -> Iterator[Placing]:
    """Yield what lines a street or a square: "streets lined with | parked cars on both sides"."""
    head = syntax.head_before(at, past_comma=True)
    if head < 0:
        return
    place = syntax.items[head]
    ringed = place.noun in _RINGED or place.noun_class in _RINGED
    link = "around" if ringed else "along"
    first = at + 1
    while first < len(syntax.items) - 1 and syntax.items[first].text in ("with", "by"):
        first += 1
    for part in _parts(syntax.items, first):
        own = _without_sides(part)
        while own and (own[0].words[0] in LINED or own[0].text in ("with", "by")):
            own = own[1:]  # "and | lined with | planes"
        if not any(one.noun for one in own) or any(one.get("rel") in _LINK for one in own):
            continue  # "and trees along the river"
        before = syntax.items[head:first] if part[0] is syntax.items[first] else ()
        if own[-1].noun == "building" and len(own) > 1:  # "surrounded by | five-storey buildings"
            said = f"the buildings {link} {_named(text, place)} {_said(text, own[:-1])}"
            yield Placing(said, part, before, verb="make")
            continue
        yield Placing(f"{_said(text, own)} {link} {_named(text, place)}", part, before)


def _listed(text: str, syntax: Syntax) -> Iterator[Placing]:
    """Yield what is listed behind a place: "roadworks on the main street: | cones, | a barrier".

    What is there with a thing that holds nothing itself is where that thing is.
    """
    items = syntax.items
    for at, item in enumerate(items):
        comma = item.is_mark(",") and at + 1 < len(items) and items[at + 1].text == "with"
        if not (item.is_mark(":") or comma or item.text == "with") or at < 3:
            continue
        head = syntax.head_before(at)
        phrase = syntax.phrase(head) if head == at - 1 else None
        if phrase is None or not phrase.first or items[head].noun_class not in ("road", "element"):
            continue
        what = syntax.head_before(phrase.first - 1)
        link = items[phrase.first - 1]
        if what < 0 or what != phrase.first - 2 or not _holds_nothing(items[what]):
            continue
        place = _said(text, items[phrase.first : phrase.end])
        for part in _parts(items, at + 1 + comma):
            if any(one.text in _OWN for one in part):
                continue  # of the thing, not of its place
            told = _with_the_whole(text, part, place) if part else ""
            served = items[what].noun in ELEMENTS and any(
                one.noun_class == "person" for one in part
            )
            if served and not told:  # "a food truck on the square with | a queue of eight people"
                told = f"{_said(text, part)} at {_named(text, items[what])}"
            if told or (part and not any(one.get("rel") in _LINK for one in part)):
                yield Placing(told or f"{_said(text, part)} {_said(text, [link])} {place}", part)


def _holds_nothing(item: Item) -> bool:
    """Return whether an item is no building and no land that has things itself."""
    element = ELEMENTS.get(item.noun)
    if item.kind == "unknown" or item.noun_class in ("person", "vehicle"):
        return True
    return item.noun_class == "element" and (element is None or element.is_thing)


def _without_sides(part: Sequence[Item]) -> Sequence[Item]:
    """Return what lines a street without "on both sides", which is where it is anyway."""
    texts = [one.text for one in part]
    for end, at in ((2, -3), (1, -1)):
        if len(part) > end and " ".join(texts[at:]) in _OPEN[3:]:
            return part[:at]
    return part


def _held(text: str, syntax: Syntax, at: int) -> Iterator[Placing]:
    """Yield what is somewhere at what has it: "a hospital with | an ambulance at the entrance"."""
    items = syntax.items
    whole = _subject(syntax, at)
    if whole is None or (whole.noun_class in BUILDINGS and is_plural(whole.words[-1])):
        return  # "houses with gardens at the edge"
    for part in _parts(items, at + 1):
        said = _with_the_whole(text, part, _named(text, whole))
        if said:
            yield Placing(said, part)


def _subject(syntax: Syntax, at: int) -> Item | None:
    """Return what has something: the first head behind the last comma, "and" or "with" before."""
    items = syntax.items
    last = at - 1 if at and items[at - 1].is_mark(",") else at
    first = last
    begin = begin_of(items, at, ENDS + ":")
    while first > begin and not (
        items[first - 1].is_mark(",")
        or items[first - 1].get("rel") in ("and", "but")
        or items[first - 1].text in _HAVING
    ):
        first -= 1
    heads = (phrase.head for n in range(first, last)
             if (phrase := syntax.phrase(n)) is not None and phrase.head >= 0)  # fmt: skip
    head = before_between(syntax, next(heads, -1))
    return items[head] if head >= 0 and items[head].noun else None


def _with_the_whole(text: str, part: Sequence[Item], whole: str) -> str:
    """Return a part with what has it put in where it says "it" or leaves it out, "" for others."""
    if len(part) < 2:
        return ""
    last, link = part[-1], part[-2]
    said = _said(text, part)
    if last.text == "it":
        return f"{_said(text, part[:-1])} {whole}"
    if last.text in _SPOTS and link.text == "its":
        return f"{_said(text, part[:-2])} the {last.text} of {whole}"
    end = " ".join(one.text for one in part[-3:])
    if end.endswith(_OPEN):
        side = end.endswith(("outside", "behind"))
        return f"{said} {whole}" if side else f"{said} of {whole}"
    spot = last.text in _SPOTS or (last.noun == "center" and last.text != "city")
    return f"{said} of {whole}" if spot and any(one.get("rel") in _LINK for one in part) else ""


def _crossing(text: str, syntax: Syntax, at: int) -> Iterator[Placing]:
    """Yield who crosses: "100 pedestrians | crossing the main street"."""
    items = syntax.items
    phrase = syntax.phrase(at - 1) if at else None
    be = at > 1 and items[at - 1].get("rel") == "be"
    phrase = syntax.phrase(at - 2) if be else phrase
    if phrase is None or phrase.head < 0 or items[phrase.head].noun_class != "person":
        return
    end = at + 1
    object_ = at + 1 < len(items) and not items[at + 1].has("rel")
    behind = syntax.object_of(at) if object_ else -1
    if behind > at and items[behind].noun_class == "road":
        end = behind + 1
    if end < len(items) and not (items[end].kind == "mark" or items[end].get("rel") == "and"):
        return
    who = _said(text, items[phrase.first : phrase.head + 1])
    yield Placing(f"{who} on {_CROSSED}", items[phrase.first : end])


def _parked(text: str, syntax: Syntax, at: int) -> Iterator[Placing]:
    """Yield cars of which nothing tells where they are parked: they are along the streets."""
    items, phrase = syntax.items, syntax.phrase(at)
    if phrase is None or phrase.head != at or items[phrase.first].quantity is not None:
        return
    behind = items[phrase.end] if phrase.end < len(items) else None
    if behind is None or behind.kind == "mark" or behind.get("rel") in ("and", "with"):
        own = items[phrase.first : phrase.end]
        yield Placing(f"{_said(text, own)} along the streets", own)
