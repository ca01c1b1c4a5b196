"""Pointing: which things are meant: "the taller tower", "the houses in the way", "where x meets y".

Words of the grammar stand in the place of those that people point with; where nothing tells what is
pointed at, the words are asked about.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from cityx.language.commands.roles import TERM
from cityx.language.commands.words_put_in import asked, here
from cityx.language.lexicon.phrases import TABLES
from cityx.language.scan import ENDS, Item, Quantity
from cityx.language.scopes import READ

_RANKS = {word.strip(): rank for rank, words in TABLES["rank"].items() for word in words.split(",")}


def of_two(items: list[Item]) -> list[Item]:
    """Read "the taller tower" and "the taller of the two towers" as "the tallest tower"."""
    for at, item in enumerate(items):
        rank = _rank_of(item.text)
        led = (at == 0 or items[at - 1].words[-1] in ("the", "both")
               or items[at - 1].is_mark(ENDS + ",;"))  # fmt: skip
        behind = [one for one in items[at + 1 : at + 6] if one.kind != "function"]
        if not rank or not led or item.state or not behind or "than" in item.words:
            continue
        of = behind[0].get("rel") == "of"
        counted = [one for one in behind[1:2] if of and one.quantity is not None]
        noun = behind[0] if not of else next((one for one in behind[1:] if one.noun), None)
        if noun is None or not (noun.noun or noun.text == "one"):
            continue
        if noun.words[-1].endswith("s") and not counted:
            continue  # "the busier streets" are nobody knows how many
        item.kind, item.senses, item.words = "phrase", (("rank", rank),), (item.text,)
        for one in counted:  # of two there is one
            one.quantity = Quantity("count", 1.0, 1.0)
    return items


def _rank_of(word: str) -> str:
    """Return the rank that a comparative stands for, "" for other words."""
    if not word.endswith("er") or " " in word:
        return ""
    return _RANKS.get(f"{word[:-2]}est", "")


_WAY = ("way", "path")
_MANNERS = ("way", "manner", "fashion")


def in_the_way(items: list[Item]) -> list[Item]:
    """Ask about "the buildings in the way" and "in the same way as", which no rule can measure."""
    for at, item in enumerate(items):
        if item.words[-1] == "same" and any(one.text in _MANNERS for one in items[at + 1 : at + 2]):
            asked(items[at : at + 2])
        after = items[at + 1 : at + 3]
        said = [word for one in after for word in one.words]
        led = item.get("rel") == "in" and said[:1] in (["the"], ["its"], ["their"], ["our"])
        if led and said[1:2] and said[1] in _WAY:
            asked([item, *after])
    return items


_MEET = ("meets", "meet", "crosses", "cross", "joins", "join", "hits", "intersects", "intersect",
         "runs into", "meeting")  # fmt: skip
_ROADS = ("road",)


def where_streets_meet(items: list[Item]) -> list[Item]:
    """Read "where Hay Road meets the main street" as "at the corner of Hay Road and ...".

    "Where Hay Road and the main street cross" is the same.
    """
    for at, item in enumerate(items):
        if item.text != "where":
            continue
        streets = [(k, one) for k, one in enumerate(items[at + 1 : at + 8], start=at + 1)
                   if _is_street(one)][:2]  # fmt: skip
        if len(streets) < 2:
            continue
        (first, one), (last, other) = streets
        verb = next((k for k in range(first + 1, last + 2)
                     if k < len(items) and items[k].text in _MEET), 0)  # fmt: skip
        between = [k for k in range(at + 1, last) if k not in (first, verb)]
        plain = all(items[k].kind == "function" or items[k].get("rel") == "and" for k in between)
        if not verb or not plain:
            continue
        end = max(last, verb) + 1
        items[verb].state, items[verb].senses = READ, ()
        corner = here(item, "corner", (TERM, "CORNER"))
        return [*items[:at], here(item, "at", ("rel", "in")), corner,
                here(one, "of", ("rel", "of")), one, here(other, "and", (TERM, "PAIR")), other,
                *items[end:]]  # fmt: skip
    return items


_MEETINGS = ("corner", "junction", "intersection", "crossing", "crossroads", "meeting point")


def corners_of_two(items: list[Item]) -> list[Item]:
    """Read "at the junction of Hay Road and Mill Lane" as at the corner of both streets."""
    for at, item in enumerate(items):
        if item.text not in _MEETINGS or not items[at + 1 : at + 2]:
            continue
        if items[at + 1].get("rel") not in ("of", "between"):
            continue
        own = [one for one in items[at + 2 : at + 8] if one.kind != "function"]
        if len(own) < 3 or own[1].get("rel") != "and" or not (_is_street(own[0]) and
                                                              _is_street(own[2])):  # fmt: skip
            continue
        item.kind, item.senses, item.state = "phrase", ((TERM, "CORNER"),), ""
        items[at + 1].senses = (("rel", "of"),)
        own[1].senses = ((TERM, "PAIR"),)
    return items


def _is_street(item: Item) -> bool:
    return item.kind == "id" or item.noun_class in _ROADS


_FACING = ("facing", "looking at", "looking towards", "looking over", "turned towards")
_PLACED = ("in", "on", "along", "near", "around")


def facing_of(items: list[Item]) -> list[Item]:
    """Read "a statue in the park facing the church" as one that is turned to the church.

    Where no other place is told, what is faced is the place. What faces south, and trees, which
    have no front, are asked about.
    """
    for at, item in enumerate(items):
        if item.words[-1] not in _FACING and item.text not in _FACING:
            continue
        order = next((k for k in range(at, -1, -1) if items[k].get("verb") in ("ADD", "PLANT")), at)
        own = items[order + 1 : at]
        placed = any(one.get("rel") in _PLACED and not one.state for one in own)
        placed |= order > 0 and items[order - 1].is_mark(":")
        ended = any(one.kind == "mark" for one in own)
        behind = [one for one in items[at + 1 : at + 9] if one.get("rel") in _PLACED]
        if order == at or ended:
            continue
        green = placed and any(one.noun_class == "plant" for one in own)
        if green or any(one.has("side") for one in items[at + 1 : at + 2]):
            asked(items[at : at + 1 + (not green)])
            continue
        ends = (k + 1 for k in range(at + 1, min(at + 4, len(items)))
                if items[k].noun or items[k].kind == "id")  # fmt: skip
        spot = items[at + 1 : next(ends, at + 1)]
        if placed or behind:
            item.kind, item.senses = "phrase", ((TERM, "FACING"),)
        elif spot and (spot[-1].noun in (*_WATERS, *_AREAS)):  # by it, and turned to it
            item.kind, item.senses = "phrase", ((TERM, "FACING"),)
            by = [here(item, "by", ("rel", "near")), *(replace(one) for one in spot)]
            return [*items[:at], *by, *items[at:]]
    return items


def sides_of_things(items: list[Item]) -> list[Item]:
    """Ask about "paint the north side of the church", which is not all of it.

    Which side "on one side of Hay Road" is nobody tells either.
    """
    for at, item in enumerate(items):
        verb = next((one for one in reversed(items[:at]) if one.kind != "function"), item)
        side, of = (*items[at + 1 : at + 3], item, item)[:2]
        whole = next((one for one in items[at + 3 :] if one.kind != "function"), item)
        if item.has("side") and side.text in _FACES and of.get("rel") == "of" and (
            verb.get("verb") in _CHANGED and whole.noun != "city"
        ):  # fmt: skip
            asked([item, side])
        if item.text == "one" and side.text == "side" and of.get("rel") == "of" and (
            _is_street(whole)
        ):  # fmt: skip
            asked([item, side])
    return items


_FACES = ("side", "wall", "face", "facade", "front")
_CHANGED = ("PAINT", "MAKE", "RAISE", "LOWER", "CLAD", "REMOVE")
_PIECES = ("half", "part", "portion", "section", "third", "bit")
_LED = ("in", "on", "at")


def pieces_of(items: list[Item]) -> list[Item]:
    """Read "in its east half", "in the east of the park" as at the eastern end of it."""
    found: list[Item] = []
    for at, item in enumerate(items):
        found.append(item)
        side = items[at - 1] if at else item
        led = any(one.get("rel") in _LED for one in items[max(at - 3, 0) : at - 1])
        if not side.has("side") or not led or item.state:
            continue
        share = item.quantity is not None and item.quantity.dimension == "part"
        of = item.get("rel") == "of" or (share and item.words[-1] == "of")
        piece = not of and item.text in _PIECES
        of |= piece and any(one.get("rel") == "of" for one in items[at + 1 : at + 2])
        spot = items[at + 1 + (piece and of) :]
        if not (piece or of) or (of and not _is_area(spot)):
            continue
        found[-1] = here(item, "end", (TERM, "END"))
        if of and not piece:
            found.append(here(item, "of", ("rel", "of")))
    return found


_AREAS = ("park", "square", "garden", "cemetery", "forest", "meadow", "campus", "allotments")


def _is_area(spot: Sequence[Item]) -> bool:
    """Return whether a piece is of ground in which things are put, and not of the city."""
    noun = next((one for one in spot if one.kind != "function"), None)
    return noun is not None and (
        noun.noun in _AREAS or noun.kind == "id" or noun.get("rel") == "it"
    )


_FLANKS = ("side", "bank", "shore", "banks", "shores", "waterfront")
_BANKS = _FLANKS[1:]
_WATERS = ("river", "canal", "stream", "lake", "pond", "sea")
_AT = ("in", "on", "along", "near", "to", "at", "by")


def flanks_of(items: list[Item]) -> list[Item]:
    """Read "on the north bank of the river" as ground beside it, and no river of the north.

    "The river's north bank" and "the north bank", which is that of the river, are the same.
    """
    found: list[Item] = []
    at = 0
    while at < len(items):
        item = items[at]
        led = [one for one in items[max(at - 3, 0) : at] if one.kind not in ("function", "mark")]
        after = items[at + 1 : at + 4]
        whole = next((one for one in items[at + 3 : at + 5] if one.kind != "function"), item)
        owned = bool(led and after) and led[-1].noun in _WATERS and after[0].text in _BANKS
        if not (item.has("side") and led and after and (owned or led[-1].get("rel") in _AT)):
            found.append(item)
            at += 1
            continue
        noun, of = after[0], here(after[0], "of", ("rel", "of"))
        flank = replace(noun, kind="phrase", senses=((TERM, "FLANK"),), state="")
        if noun.words[0] in _BANKS and noun.noun:  # "bank of the river"
            water = replace(noun, words=noun.words[-1:])
            found += [item, flank, of, water]
        elif noun.text in _FLANKS and len(after) > 1 and after[1].get("rel") == "of" and (
            whole.noun != "city"  # whose sides are parts of it
        ):  # fmt: skip
            found += [item, flank]
        elif noun.text in _BANKS:
            river = here(noun, "river", ("noun", "element:river"))
            found += [item, flank, of, river]
        else:
            found.append(item)
            at += 1
            continue
        at += 2
    return _with_owners(found)


def _with_owners(items: list[Item]) -> list[Item]:
    """Read "on the river's north bank" as on the north bank of the river."""
    for at, item in enumerate(items):
        before = [k for k in range(max(at - 3, 0), at) if items[k].noun in _WATERS]
        own = items[at + 1].get(TERM) == "FLANK" if at + 1 < len(items) else False
        if item.has("side") and own and before and all(
            items[k].kind in ("function", "mark") for k in range(before[-1] + 1, at)
        ):  # fmt: skip
            water, end = items[before[-1]], at + 4  # of the side, the flank, "of" and the river
            rest = items[at : at + 3]
            return [*items[: before[-1]], *rest, water, *items[end:]]
    return items
