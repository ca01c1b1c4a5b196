"""Homonyms: words for things that stand in a name or tell of something else.

"The Swan Inn", "a duck house", "a statue of a horse", "built in two stages": none of these is a
swan, a duck, a horse or a stage.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

from cityx.language.scan import ENDS, Item, begin_of
from cityx.language.syntax import is_plural
from cityx.town.elements import ELEMENTS

# Where animals stand, and other things whose words tell of buildings: "a drone shop".
_LAND = ("meadow", "afloat")
_OTHERS = ("pigeon", "seagull", "stage", "drone", "tent", "delivery_robot", "tractor", "kayak")
_NAMES = ("called", "named")
_CALL, _WHO = ("call", "calls"), ("people", "they", "locals", "everyone", "everybody", "we")
_LIKENESSES = ("statue", "sculpture", "figure", "mural", "picture", "painting", "monument")
_PHASES = ("early", "late", "later", "first", "second", "third", "last", "next", "final", "every",
           "each", "this", "some", "any")  # fmt: skip


# A name as it is written behind "called": "Miller's Green", "St Mary of the Hill".
NAME = re.compile(
    r"(?:the )?[\"“'‘]?([A-Z][\w'’.&-]*(?: (?:(?:of|the|de|la|on|and) )*[A-Z][\w'’.&-]*)*)"
)


def name_behind(text: str, items: Sequence[Item], at: int) -> tuple[str, list[Item]] | None:
    """Return the name that stands behind "called" or "people call" and its items, or None."""
    calls = at and items[at].text in _CALL and items[at - 1].text in _WHO
    if not (items[at].text in _NAMES or calls) or at + 1 == len(items):
        return None
    found = NAME.match(text, items[at + 1].span[0])
    if found is None:
        return None
    return found[1], [one for one in items[at + 1 :] if one.span[0] < found.end()]


def settle_homonyms(text: str, items: Sequence[Item]) -> None:
    """Take the sense from words that name no thing where they stand, so that they are named."""
    for at in range(len(items)):
        found = name_behind(text, items, at)
        for item in found[1] if found is not None else ():
            if item.kind not in ("id", "mark"):
                item.kind, item.senses, item.quantity = "unknown", (), None
        if found is not None and items[at].text in _CALL:
            for item in items[at - 1 : at + 1]:  # "that | people call"
                item.kind, item.senses = "function", ()
    for at, item in enumerate(items):
        if item.has("keep") and _is_a_tower(items, at):
            item.kind, item.senses = "unknown", ()
        elif item.text in ("block", "blocks") and _are_houses(items, at):
            item.senses = (("noun", "type:apartment"),)
        elif item.get("slot") == "terrain=ridge" and any(
            one.noun == "roof" or "roof=" in one.get("slot") for one in items
        ):
            item.kind, item.senses = "unknown", ()  # "the ridges of the gabled roofs"
        elif item.noun == "parking_lot" and item.words[0] == "cars":
            item.kind, item.senses = "unknown", ()  # "where | cars park"
        if not _may_tell_else(item):
            continue
        before, after = items[max(at - 3, 0) : at], items[at + 1 : at + 3]
        if (
            _tells_of(item, after)
            or _is_in_a_name(text, item, after)
            or any(one.text in _NAMES for one in before)
            or (any(one.get("rel") == "of" for one in before)
                and any(one.text in _LIKENESSES for one in before))
            or (item.noun == "stage" and _is_a_phase(before, after))
        ):  # fmt: skip
            item.kind, item.senses = "unknown", ()


def settle_ones(items: Sequence[Item]) -> None:
    """Take "ones" for what is named last in the plural: "red houses here, yellow | ones there"."""
    for at, item in enumerate(items):
        if item.text != "ones" or not at or not items[at - 1].has(*_LOOKS):
            continue
        before = items[begin_of(items, at, ENDS) : at]
        named = [one for one in before if one.noun_class in _SEVERAL and one.has("noun")
                 and is_plural(one.words[-1])]  # fmt: skip
        if named:
            item.kind, item.senses = "phrase", named[-1].senses


_LOOKS = ("color", "material", "size", "height", "width")
_SEVERAL = ("type", "building", "plant", "vehicle")
_AT_WATER = ("sea", "harbour", "pier", "container", "harbour_crane")


def settle_cranes(items: Sequence[Item]) -> None:
    """Take a crane for one of a building site where a text names nothing of a port."""
    port = any(
        "district=harbour" in one.get("slot")
        or (one.noun in _AT_WATER and one.text.rstrip("s") != "crane")
        for one in items
    )
    for item in items:
        if not port and item.text in ("crane", "cranes") and item.noun == "harbour_crane":
            item.senses = (("noun", "element:crane"),)


def _is_a_tower(items: Sequence[Item], at: int) -> bool:
    """Return whether a keep is the tower of a castle: "with a round | keep"."""
    before = [one for one in items[max(at - 2, 0) : at] if one.kind != "mark"]
    return items[at].text in ("keep", "keeps") and any(one.text in ("a", "an") for one in before)


def _are_houses(items: Sequence[Item], at: int) -> bool:
    """Return whether blocks are houses, since storeys are told of them: "nine-storey | blocks"."""
    before = items[at - 1].quantity if at else None
    return before is not None and before.dimension == "floors"


def _may_tell_else(item: Item) -> bool:
    element = ELEMENTS.get(item.noun)
    return element is not None and (element.where in _LAND or item.noun in _OTHERS)


def _tells_of(item: Item, after: Sequence[Item]) -> bool:
    """Return whether a word says of which kind a noun right behind it is: "a duck | house"."""
    if not after or after[0].kind == "mark" or item.words[-1].endswith("s"):
        return False
    doing = len(after) > 1 and after[0].text.endswith("ing") and bool(after[1].noun)
    return bool(after[0].noun) or doing


def _is_in_a_name(text: str, item: Item, after: Sequence[Item]) -> bool:
    """Return whether a word and the one behind it are written as a name: "Horse Hill"."""
    both = [item, *after[:1]]
    return len(both) == 2 and all(text[one.span[0] : one.span[0] + 1].isupper() for one in both)


def _is_a_phase(before: Sequence[Item], after: Sequence[Item]) -> bool:
    """Return whether a stage is one of a course: "in two stages", "the last stage of the route"."""
    counted = [one for one in before if one.kind != "function"][-2:]
    steps = len(counted) == 2 and counted[0].text == "in" and counted[1].quantity is not None
    of = bool(after) and after[0].get("rel") == "of"
    return steps or of or any(one.text in _PHASES for one in before[-1:])
