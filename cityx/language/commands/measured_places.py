"""Measured places: "100 m downstream of the existing bridge", "turn that strip into a meadow"."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import pairwise

from cityx.language.commands.roles import TERM
from cityx.language.commands.words_put_in import asked
from cityx.language.scan import ENDS, Item
from cityx.language.scopes import READ

_LOOKS = ("color", "material")
_ROOFS = ("building.roof=", "style=")


def traits_behind(items: list[Item]) -> list[Item]:
    """Put ", grey concrete, flat roof" behind the building that it is told of.

    "Add a slab of flats near the church, nine floors, flat roof": the place stands between.
    """
    found: list[Item] = []
    begin = 0
    for end, item in enumerate(items):
        if item.is_mark(ENDS) or end + 1 == len(items):
            found += _told_together(items[begin : end + 1])
            begin = end + 1
    return found


def _told_together(clause: list[Item]) -> list[Item]:
    verb = next((at for at, one in enumerate(clause) if one.has("verb")), len(clause))
    if verb == len(clause) or clause[verb].get("verb") not in ("ADD", "REPLACE"):
        return clause
    nouns = [at for at in range(verb + 1, len(clause))
             if clause[at].noun_class in ("type", "building")]  # fmt: skip
    marks = [at for at, one in enumerate(clause) if one.is_mark(",:")]
    noun = next((at for at in nouns if _is_new(clause, verb, at)), 0)
    if not noun or not marks:
        return clause
    stop = len(clause) - bool(clause[-1].is_mark(ENDS))
    told: list[Item] = []
    left: list[Item] = []
    for first, last in pairwise([*marks, stop]):
        piece = clause[first + 1 : last]
        own = [one for one in piece if one.words[-1] not in _WALLS or one.has(*_LOOKS)]
        if first > noun and own and all(map(_is_trait, own)) and any(map(_says, own)):
            for one in piece:
                one.state = one.state if one in own else READ
            told += [one for one in own if one.kind != "function"]
        else:
            left += clause[first:last]
    head = clause[: marks[0]]
    return [*head[: noun + 1], *told, *head[noun + 1 :], *left, *clause[stop:]]


_WALLS = ("walls", "front", "fronts", "facade", "facades", "render", "cladding", "outside")


def _is_new(clause: Sequence[Item], verb: int, noun: int) -> bool:
    """Return whether a building is one that is to be built: "swap the church for | a mosque"."""
    if clause[verb].get("verb") == "ADD":
        return True
    led = any(one.words[0] in ("a", "an") for one in clause[max(noun - 4, 0) : noun])
    return led and any(one.get("rel") in ("with", "by", "to") for one in clause[verb:noun])


def _is_trait(item: Item) -> bool:
    plain = item.kind == "function" or item.get("rel") in ("and", "with", "please")
    return plain or _says(item)


def _says(item: Item) -> bool:
    quantity = item.quantity
    if quantity is not None:
        high = quantity.dimension == "length" and quantity.attribute == "height"
        return not item.state and (high or quantity.dimension == "floors")
    looks = item.has(*_LOOKS) and not item.noun
    return not item.state and (looks or item.get("slot").startswith(_ROOFS))


_OFF = ("downstream", "upstream", "away", "off", "downriver", "upriver")
_OLD = ("existing", "old", "first", "other", "present", "current", "road", "main")
_STANDS = ("already", "there", "that's", "that", "which", "is", "s", "are", "exists", "stands",
           "today", "now", "here", "one")  # fmt: skip


def off_bridges(items: list[Item]) -> list[Item]:
    """Read "100 m downstream of the one that's already there" as so far off the bridges.

    Which way a river flows no city tells, so both ways hold.
    """
    found = list(items)
    for at, item in enumerate(items):
        quantity = item.quantity
        if quantity is None or quantity.dimension != "length" or quantity.attribute:
            continue
        bridge = next((one for one in reversed(items[:at]) if one.noun == "bridge"), None)
        end = _end_of(items, at)
        if bridge is None or not end:
            continue
        noun = Item("phrase", item.span, ("bridges",), (("noun", bridge.get("noun")),))
        place = found.index(item)
        for one in items[at:end]:
            one.state, one.senses = READ, ()
        off = replace(item, kind="phrase", senses=((TERM, "OFF"),), state="")
        if place and found[place - 1].is_mark(","):
            found[place - 1].state = READ
        found[place : place + end - at] = [off, noun]
        return found
    return found


_ADDS = ("ADD", "PLANT", "MAKE")


def far_from(items: list[Item]) -> list[Item]:
    """Read "a bench at least 100 m away from the park" as so far off it.

    "At most 100 m from the park" is within so many metres of it, whatever is done there.
    """
    found: list[Item] = []
    at = 0
    while at < len(items):
        item = items[at]
        if item.quantity is None or item.quantity.dimension != "length":
            found.append(item)
            at += 1
            continue
        link = next((k for k in range(at + 1, min(at + 4, len(items)))
                     if items[k].get("rel") == "from" or items[k].text in ("away from", "from")),
                    0)  # fmt: skip
        plain = all(one.kind == "function" or one.text == "away" for one in items[at + 1 : link])
        begin = max((k + 1 for k in range(at) if items[k].is_mark(ENDS)), default=0)
        adds = any(
            one.has("verb") and ("verb", name) in one.senses
            for one in items[begin:at]
            for name in _ADDS
        )
        noun = link and any(one.noun or one.kind == "id" for one in items[link + 1 : link + 5])
        it = link and any(one.get("rel") == "it" for one in items[link + 1 : link + 3])
        spaced = at and any(one.get("rel") == "every" or one.text in ("every", "each")
                            for one in items[at - 1 : at + 1])  # fmt: skip
        spaced = spaced or item.words[0] in ("every", "each")
        if link and plain and not item.state and not spaced:
            low, high = item.quantity.low, item.quantity.high
            if noun and not low and high is not None:  # "at most 100 m from"
                within = replace(item.quantity, attribute="")
                found += [
                    replace(item, kind="quantity", quantity=within, words=("within", *item.words)),
                    *items[at + 1 : link],
                ]
                for one in items[at + 1 : link]:
                    one.state = READ  # "less than 50 m | away | from"
                items[link].words, items[link].senses = ("of",), (("rel", "of"),)
                at = link
                continue
            apart = low is not None and high is not None and high > low
            if it or (noun and apart and not item.quantity.approximate):
                asked((item, items[link]))
        if spaced or item.kind == "unknown":
            adds = False
        if link and plain and adds and noun and not item.has("noun"):
            found.append(replace(item, kind="phrase", senses=((TERM, "OFF"),), state=""))
            at = link + 1
            continue
        found.append(item)
        at += 1
    return found


def _end_of(items: Sequence[Item], at: int) -> int:
    """Return where "downstream of the existing one" ends behind a length, 0 where it is none."""
    words = [(place, word) for place in range(at + 1, min(at + 4, len(items)))
             for word in items[place].words]  # fmt: skip
    if len(words) < 2 or words[0][1] not in _OFF or words[1][1] not in ("of", "from"):
        return 0
    place = words[1][0] + 1
    begun = place
    while place < len(items) and not items[place].is_mark(ENDS + ",("):
        one = items[place]
        known = one.text in (*_OLD, *_STANDS) or one.kind == "function" or one.noun == "bridge"
        if not known or (one.kind == "id"):
            break
        place += 1
    said = items[begun:place]
    named = any(one.text == "one" or one.noun == "bridge" for one in said)
    return place if named else 0


_STRIPS = ("strip", "band", "zone", "area", "corridor", "swathe", "margin", "ground")
_PLOTS = ("plots", "plot", "gaps", "sites", "lots")
_POINTING = ("that", "the", "this", "those", "these")
_TURNS = ("turn", "convert", "make", "transform", "change")


def strips(items: list[Item]) -> list[Item]:
    """Read "turn that strip into a meadow" as "add a meadow in" the strip that was told before.

    The strip is what lies within so many metres of what houses are removed by; of plots that were
    cleared it is what stood on them.
    """
    for at, item in enumerate(items):
        known = item.noun_class not in ("", "place")
        if item.text not in (*_STRIPS, *_PLOTS) or item.state or known or at < 2:
            continue
        pointing, verb = items[at - 1], items[at - 2]
        into = items[at + 1] if at + 1 < len(items) else item
        if pointing.text not in _POINTING or verb.text not in _TURNS or into.get("rel") != "to":
            continue
        gone = next((k for k in range(at - 1, -1, -1) if _removes(items[k])), None)
        told = items[gone:at] if gone is not None else []
        near = next((one for one in told if one.quantity is not None
                     and one.words[0] == "within"), None)  # fmt: skip
        end = next((k for k in range(at + 2, len(items)) if items[k].is_mark(ENDS + ",")
                    or items[k].text in _MORE or items[k].get("rel") in ("with", "and")),
                   len(items))  # fmt: skip
        stop = next((k for k in range(end, len(items)) if items[k].is_mark(ENDS)), len(items))
        if item.text in _STRIPS and near is not None:
            begin = items.index(near)
            of = [one for one in items[begin + 1 : begin + 4] if one.get("rel") == "of" or one.noun]
            if len(of) < 2 or not of[1].noun:
                continue
            place = [replace(one, state="", span=item.span) for one in (near, *of[:2])]
            more = list(_along(items[end:stop], of[1]))
        elif item.text in _PLOTS and told:
            place = [Item("phrase", item.span, ("in",), (("rel", "in"),)),
                     Item("phrase", item.span, ("their", "place"),
                          (("rel", "it"), ("cleared", "")))]  # fmt: skip
            more = items[end:stop]
        else:
            continue
        verb.senses, verb.words = (("verb", "ADD"),), ("add",)
        for one in (pointing, item, into):
            one.state, one.senses = READ, ()
        new = items[at + 2 : end]
        return [*items[: at - 2], verb, pointing, item, into, *new, *place, *more, *items[stop:]]
    return items


def fills(items: list[Item]) -> list[Item]:
    """Read "fill those plots with houses" behind a removal as "add houses in their place"."""
    for at, item in enumerate(items):
        known = item.noun_class not in ("", "place")
        if item.text not in _PLOTS or item.state or known or at < 2:
            continue
        gone = any(map(_removes, items[:at]))
        filled = items[at - 2].text in _FILLS and items[at - 1].text in _POINTING
        link = items[at + 1] if at + 1 < len(items) else item
        if not gone or not filled or link.get("rel") not in ("with", "by"):
            continue
        end = next((k for k in range(at + 2, len(items)) if items[k].is_mark(ENDS)), len(items))
        verb = items[at - 2]
        verb.senses, verb.words = (("verb", "ADD"),), ("add",)
        for one in (items[at - 1], item, link):
            one.state, one.senses = READ, ()
        place = [Item("phrase", item.span, ("in",), (("rel", "in"),)),
                 Item("phrase", item.span, ("their", "place"),
                      (("rel", "it"), ("cleared", "")))]  # fmt: skip
        return [*items[:end], *place, *items[end:]]
    return items


_FILLS = ("fill", "replace", "use", "plant", "cover", "occupy", "build")


def _removes(item: Item) -> bool:
    return item.get("verb") == "REMOVE" or item.text in ("knock", "pull", "tear", "take", "clear")


_MORE = ("with", "+", "plus", "and")
_BANKS = ("banks", "bank", "shore", "shores", "edges", "sides", "water", "waterside", "riverbank")


def _along(items: Sequence[Item], water: Item) -> Iterator[Item]:
    """Yield what else comes to a strip, each as an order and along the water where no place is."""
    pieces: list[list[Item]] = []
    for item in items:
        if item.is_mark(",") or item.text in _MORE or item.get("rel") in ("with", "and"):
            pieces.append([])
        elif pieces:
            pieces[-1].append(item)
    for piece in (piece for piece in pieces if piece):
        at = piece[0].span
        link = next((k for k, one in enumerate(piece) if one.get("rel") in ("along", "on")), None)
        yield Item("mark", at, (",",))
        if any(one.has("verb") and not one.noun for one in piece[:1]):
            yield from piece
            continue
        yield Item("phrase", at, ("add",), (("verb", "ADD"),))
        banks = link is not None and any(one.words[-1] in _BANKS for one in piece[link:])
        yield from piece[:link] if banks else piece
        for one in piece[link:] if banks else ():
            one.state, one.senses = READ, ()
            yield one
        if link is None or banks:
            yield Item("phrase", at, ("along",), (("rel", "along"),))
            yield Item("function", at, ("the",))
            yield replace(water, state="", span=at)


_LANDS = ("landing", "ending", "coming", "touching")


def landings(items: list[Item]) -> list[Item]:
    """Read "a footbridge, landing somewhere near the park" as one near the park."""
    for at, item in enumerate(items[:-2]):
        bridge = any(one.noun == "bridge" for one in items[max(at - 20, 0) : at])
        after = [one for one in items[at + 1 : at + 4]
                 if one.text not in ("somewhere", "down", "ashore")]  # fmt: skip
        if item.text in _LANDS and bridge and after and after[0].get("rel") in ("near", "by", "in"):
            item.state = READ
            for one in items[at - 1 : at + 3]:
                if one.is_mark(",") or one.text in ("somewhere", "down", "ashore"):
                    one.state, one.senses = READ, ()
    return items
