"""What is said of a thing behind its name: "the ground is flat", "trees and cars off"."""

from __future__ import annotations

from collections.abc import Sequence

from cityx.language.scan import ENDS, Item, begin_of
from cityx.language.site import LAND, PLACES

_LEVEL = ("flat", "level")
_WHOLLY = ("dead", "completely", "totally", "perfectly", "absolutely", "entirely", "all", "very")
_ROOFS = {"flat": "flat", "pitched": "gabled", "sloping": "gabled"}
_SWITCHED = ("turn", "switch", "turn off", "switch off", "disable", "hide", "toggle")
_LAMPS = ("light", "streetlight")
_MARKS = ENDS + ",:"


def settle_predicates(items: Sequence[Item]) -> None:
    """Give words that end a clause the sense that they have of what stands before them."""
    for at, item in enumerate(items):
        if item.state or not _ends(items, at):
            continue
        before = items[begin_of(items, at, _MARKS) : at]
        if item.text in _LEVEL and _are_of_land(before):
            item.kind, item.senses = "phrase", (("slot", "terrain=flat"),)
            for one in before:
                if one.has("keep", "verb") or one.kind != "function":
                    one.kind, one.senses = "function", ()
        elif (roof := _roof(item)) and before and _are_of_roofs(before):
            item.kind, item.senses = "phrase", (("slot", roof),)
            for one in before:
                one.kind, one.senses = "function", ()
        elif item.text == "off" and _are_things(before):
            item.kind, item.senses = "phrase", (("after_neg", "off"),)
            for one in before:
                if one.text in _SWITCHED:
                    one.kind, one.senses = "function", ()
    _settle_switches(items)


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
    return after is None or after.is_mark(_MARKS) or after.get("rel") in ("and", "but")


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
