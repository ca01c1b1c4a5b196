"""What is said of a thing behind its name: "the ground is flat", "floors: 3", "trees off"."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace

from cityx.language.scan import ENDS, Item, begin_of
from cityx.language.scopes import READ
from cityx.language.site import LAND, PLACES

_LEVEL = ("flat", "level")
_WHOLLY = ("dead", "completely", "totally", "perfectly", "absolutely", "entirely", "all", "very")
_ROOFS = {"flat": "flat", "pitched": "gabled", "sloping": "gabled"}
_SWITCHED = ("turn", "switch", "turn off", "switch off", "disable", "hide", "toggle")
_LAMPS = ("light", "streetlight")
_MARKS = ENDS + ",:"
_STOREYS = ("floors", "storeys", "stories", "levels", "storys", "floor", "number of floors")
_OF_A_PLACE = ("where", "whose", "which")
_AND = ("and", "but", "while", "whereas", *_OF_A_PLACE)
# Words of a sentence by which what stands behind them is said of a part, or under a condition.
_APART = ("if", "unless", "when", "except", "once", "not", "only", "half", "some", "part", "rest")
_TOWNS = ("size", "shade", "height", "width", "side", "surface")
_OUTERMOST = ("far", "very", "extreme", "outermost")  # before a side
_HEARTS = ("heart of town", "heart of the city", "heart of the town", "heart of the village")
_BY_NOW = ("it's", "still", "already")
_SIZES = ("pair", "length", "area")
_FAR = 60  # items of a sentence that are looked back over, so that time stays short


def settle_predicates(items: Sequence[Item]) -> None:
    """Give words that end a clause the sense that they have of what stands before them."""
    for at, item in enumerate(items):
        level, roof = item.text in _LEVEL, _roof(item)
        if item.state or not (level or roof or item.text == "off") or not _ends(items, at):
            continue
        before = [one for one in items[_begin(items, at) : at] if one.kind != "mark"]
        if level and (_are_of_land(before) or _is_of_a_town(items, at)):
            item.kind, item.senses = "phrase", (("slot", "terrain=flat"),)
            if _are_of_land(before):
                _say_no_more(before)
        elif roof and before and _are_of_roofs(before):
            item.kind, item.senses = "phrase", (("slot", roof),)
            _say_no_more(before)
        elif item.text == "off" and _are_things(before):
            item.kind, item.senses = "phrase", (("after_neg", "off"),)
            for one in before:
                if one.text in _SWITCHED:
                    one.kind, one.senses = "function", ()
    _settle_switches(items)
    _settle_storeys(items)
    _settle_dark(items)
    _settle_spots(items)


def _settle_spots(items: Sequence[Item]) -> None:
    """Read "the | far north" as the north, and "a church in the | heart of town" as the middle."""
    for at, item in enumerate(items[:-1]):
        if item.text in _OUTERMOST and items[at + 1].has("side"):
            item.kind, item.senses, item.state = "phrase", (("shade", "shade"),), READ
    for at, item in enumerate(items):
        if item.text not in _HEARTS or at < 2 or items[at - 1].text != "the":
            continue
        before = items[at - 3] if at > 2 else None
        thing = (
            before is None
            or before.is_mark(ENDS + ":")
            or (before.noun_class in ("type", "element") and before.has("noun"))
            or before.get("rel") in ("all", "be")  # "both | in the heart of town"
        )
        if items[at - 2].text in ("in", "at") and thing:
            item.senses = (("noun", "place:center"),)


def _settle_dark(items: Sequence[Item]) -> None:
    """Read "it is | dark" and "still | dark" as night, where no other time is told."""
    dark = [at for at, item in enumerate(items) if item.text == "dark" and not item.state]
    if not dark or any(
        (one.quantity is not None and one.quantity.dimension == "hour")
        or one.get("slot").startswith(("time=", "lights=off"))
        for one in items
    ):
        return
    for at in dark:
        before = items[begin_of(items, at, _MARKS) : at]
        plain = all(
            one.kind == "function" or one.text in (*_WHOLLY, *_BY_NOW)
            or one.get("rel") in ("be", "it")
            for one in before
        )  # fmt: skip
        told = any(one.get("rel") == "be" or one.text in _BY_NOW for one in before)
        if plain and told and _ends(items, at):
            items[at].kind, items[at].senses = "phrase", (("slot", "time=night"),)


def _say_no_more(items: Iterable[Item]) -> None:
    """Let items stand for nothing of their own, since another says what they say."""
    for one in items:
        one.kind, one.senses = "function", ()


def _begin(items: Sequence[Item], at: int) -> int:
    """Return where the clause that an item ends begins, with the label of "roofs: | flat".

    What follows "and" or "where" is a clause of its own where nothing before says of which part
    or under which condition it holds.
    """
    first = begin_of(items, at, _MARKS)
    if first == at and at > 1 and items[at - 1].is_mark(":"):
        return begin_of(items, at - 1, _MARKS)
    join = next((n for n in range(at - 1, first, -1) if items[n].text in _AND), first)
    if join == first:
        return first
    told = items[max(begin_of(items, at, ENDS), at - _FAR) : join]
    said = any(one.get("rel") == "be" for one in items[join:at])
    if any(one.has("side") or one.noun == "center" or one.text in _APART for one in told) or (
        not said and any(one.has("neg") for one in told)
    ):
        return first
    owner = items[join - 1 - (items[join].text == "which")]
    of_a_town = owner.noun == "city" or "district=" in owner.get("slot")
    return join + 1 if items[join].text not in _OF_A_PLACE or of_a_town else first


def _is_of_a_town(items: Sequence[Item], at: int) -> bool:
    """Return whether a word stands alone among what is told of a town: "500 x 500 m, | flat"."""
    if at and not items[at - 1].is_mark(",:" + ENDS):
        return False
    first = begin_of(items, at, ENDS + ":")
    label: Sequence[Item] = ()
    if first and items[first - 1].is_mark(":"):
        label = items[begin_of(items, first - 1, ENDS) : first]
    told = items[first:at]
    if len(told) > _FAR:
        return False
    plain = all(
        one.kind in ("function", "mark") or one.noun in ("city", "landscape") or one.has(*_TOWNS)
        or one.get("slot").startswith(("district=", "size=", "density="))
        or (one.quantity is not None and one.quantity.dimension in _SIZES)
        for one in told
    )  # fmt: skip
    town = any(one.noun == "city" or one.get("slot").startswith("district=")
               or (one.quantity is not None and one.quantity.dimension == "pair")
               for one in (*label, *told))  # fmt: skip
    return plain and town


def _settle_storeys(items: Sequence[Item]) -> None:
    """Read "floors: 3 to 4" as so many floors."""
    ends = (*items[3:], None)
    for label, colon, number, end in zip(items, items[1:], items[2:], ends, strict=False):
        quantity = number.quantity
        if end is not None and not end.is_mark(",;" + ENDS):
            continue  # "levels: 2 car parks"
        counted = quantity is not None and quantity.dimension == "count"
        if label.text in _STOREYS and colon.is_mark(":=") and counted and quantity is not None:
            number.quantity = replace(quantity, dimension="floors")
            _say_no_more((label,))


def _settle_switches(items: Sequence[Item]) -> None:
    """Read "turn off the cars" as "no cars", and lamps that are turned off as such."""
    for at, item in enumerate(items):
        begins = at == 0 or items[at - 1].is_mark(_MARKS) or items[at - 1].get("rel") == "and"
        after = [one for one in items[at + 1 : at + 4] if one.kind != "function"]
        if not begins or item.get("verb") != "TURN_OFF" or not after or not after[0].has("noun"):
            continue
        if after[0].noun in _LAMPS:
            item.senses, after[0].senses = (("slot", "lights=off"),), ()
            after[0].kind = "function"
        else:
            item.senses = (("neg", "neg"),)


def _ends(items: Sequence[Item], at: int) -> bool:
    after = items[at + 1] if at + 1 < len(items) else None
    return after is None or after.is_mark(_MARKS) or after.get("rel") in ("and", "but", "with")


def _are_of_land(before: Sequence[Item]) -> bool:
    """Return whether items say "keep the site", "it is", "all" or the like."""
    told = [one for one in before if one.text not in ("the", "a", "this", "that", "whole")]
    land = [one for one in told
            if one.words[-1] in LAND or one.noun in PLACES or one.text == "it"]  # fmt: skip
    plain = all(
        one in land or one.text in _WHOLLY or one.has("keep") or one.get("rel") in ("be", "all")
        or one.get("verb") == "MAKE"
        for one in told
    )  # fmt: skip
    return plain and bool(land or any(one.text in _WHOLLY for one in told))


def _roof(item: Item) -> str:
    """Return the slot of a word for how roofs are, "" for others."""
    if item.text in _ROOFS:
        return f"building.roof={_ROOFS[item.text]}"
    said = item.get("slot")
    return said if said.startswith("building.roof=") and not item.noun else ""


def _are_of_roofs(before: Sequence[Item]) -> bool:
    """Return whether items speak of the roofs of all buildings: "all roofs", "make the roofs"."""
    told = [one for one in before if one.text != "the"]
    roofs = [one for one in told if one.noun == "roof"]
    return bool(roofs) and all(
        one in roofs or one.get("rel") in ("be", "all", "every") or one.get("verb") == "MAKE"
        or one.has("keep") or one.text == "should"
        for one in told
    )  # fmt: skip


def _are_things(before: Sequence[Item]) -> bool:
    """Return whether items end with a list of things, "trees and cars", that nothing is done to."""
    place = len(before)
    while place and (before[place - 1].noun or before[place - 1].get("rel") == "and"):
        place -= 1
    lead = next((one for one in reversed(before[:place]) if one.text not in ("the", "all")), None)
    done = lead is not None and lead.has("verb", "mode") and lead.text not in _SWITCHED
    return bool(before) and bool(before[-1].noun) and not done
