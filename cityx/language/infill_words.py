"""Infill: "fill the empty blocks with flats", "invent the buildings" of a map without them."""

from __future__ import annotations

from collections.abc import Sequence

from cityx.language.brief import Note
from cityx.language.clauses import begins_clause
from cityx.language.here import Findings
from cityx.language.scan import ENDS, Item, end_of
from cityx.language.scopes import READ
from cityx.town.quarter_kinds import ZONE_OF_KIND

_FILLING = ("fill", "fill in", "fill up", "populate", "infill", "complete", "build on", "build up")
_INVENTING = ("invent", "make up", "generate", "imagine", "guess", "improvise")
_LAND = ("block", "plot", "parcel", "lot", "gap", "void", "site", "space", "area", "land")
_MADE = ("invented", "invent", "made up", "made-up", "fictional", "fictitious", "imaginary",
         "generated", "imagined", "guessed")  # fmt: skip
_TELLING = ("tell", "say", "mark", "note", "state", "list", "flag", "report", "label", "write",
            "honest", "highlight", "admit", "document")  # fmt: skip
# Zone that is built for the kind of buildings with which a map is filled.
_ZONES = {**ZONE_OF_KIND, "office": "core", "tower": "core", "shop": "retail strip"}
_ANY = ("housing", "homes", "dwellings")  # houses or flats
# What would be of the buildings of the map as well.
_OF_ALL = ("building.type", "building.count", "building.color", "building.material",
           "building.roof", "building.height", "roof.color")  # fmt: skip
_SAID = "The report tells which buildings are invented, and how many."


def read_infill(found: Findings, items: Sequence[Item]) -> None:
    """Read that empty blocks of a map are to be built on, with what, and that it is to be told."""
    if not found.mapped:
        return
    for at, item in enumerate(items):
        end = end_of(items, at, ENDS + ":,")
        if (item.state == "" and begins_clause(items, at)) or _follows_so(items, at):
            _fill(found, items, at, end)
    if any(slot.key == "blocks" for slot in found.slots):
        _told(found, items)


def _follows_so(items: Sequence[Item], at: int) -> bool:
    return at > 0 and items[at].state == "" and items[at - 1].text in ("so", "please", "just")


def _fill(found: Findings, items: Sequence[Item], at: int, end: int) -> None:
    """Read one order to fill blocks, or to invent buildings."""
    two = " ".join(one.text for one in items[at : at + 2])
    filling = items[at].text in _FILLING or two in _FILLING
    inventing = items[at].text in _INVENTING or two in _INVENTING
    if not (filling or inventing):
        return
    told = _without_emptiness(items[at:end])
    land = [one for one in told if _is_land(one)]
    built = [one for one in told if one.noun == "building" or one.noun_class == "type"]
    if any(one.has("neg") and one.text != "missing" for one in told):
        return
    if not (land if filling else built or land) or _with_other_things(told, built):
        return
    kinds = [one for one in built if one.noun in _ZONES and one.words[-1] not in _ANY]
    ends = ("in", "on", "along", "near", "around", "at", "and", "but")
    stop = next((n for n, one in enumerate(told) if n and one.get("rel") in ends), len(told))
    own = [one for one in told[: max(stop, 2)]
           if one.kind in ("unknown", "function") or one in (*land, *built) or one is told[0]
           or one.get("rel") in ("with", "all") or one.has("neg")]  # fmt: skip
    own = [one for one in own if one.quantity is None]
    found.add("blocks", "filled", items[at], *own)
    for one in own:
        one.state = one.state or READ
    if len(kinds) == 1:
        found.add("blocks.zone", _ZONES[kinds[0].noun], kinds[0])
    _storeys(found, items, at)


def _without_emptiness(items: Sequence[Item]) -> list[Item]:
    """Return the items of an order without "without buildings", that say which blocks are meant."""
    kept: list[Item] = []
    for at, item in enumerate(items):
        before = items[at - 1] if at else item
        after = items[at + 1] if at + 1 < len(items) else item
        empty = item.has("neg") and item.text in ("without", "no") and after.noun == "building"
        if empty or (at and before.has("neg") and item.noun == "building" and before not in kept):
            item.state = READ
            continue
        kept.append(item)
    return kept


def _with_other_things(told: Sequence[Item], built: Sequence[Item]) -> bool:
    """Return whether land is filled with something else: "fill the gaps with | gardens"."""
    behind = next((n for n, one in enumerate(told) if one.text == "with"), len(told))
    named = [one for one in told[behind:] if one.has("noun")]
    return bool(named) and named[0] not in built


def _storeys(found: Findings, items: Sequence[Item], at: int) -> None:
    """Read the storeys of what is built, unless they are of some alone: "2 floors on side streets".

    They stand behind the buildings, before anything else is told of.
    """
    for n in range(at + 1, end_of(items, at, ENDS)):
        item = items[n]
        after = items[n + 1] if n + 1 < len(items) else None
        if item.quantity is not None and item.quantity.dimension == "floors":
            if after is None or after.kind == "mark" or after.get("rel") in ("and", "with"):
                ends = (("min", item.quantity.low), ("max", item.quantity.high))
                for end, value in ends:
                    if value is not None:
                        found.add(f"blocks.floors.{end}", value, item)
                item.state = item.state or READ
            return
        if item.has("noun") and not item.state:
            return


def settle_infill(found: Findings) -> None:
    """Leave what else most buildings would be, of blocks that are filled: "towers on avenues"."""
    if not any(slot.key == "blocks" for slot in found.slots):
        return
    for slot in [one for one in found.negated if one.value == "building"]:
        found.negated.remove(slot)
        found.leave_span(slot.span, "those that the map has")  # "drop all buildings and fill..."
    for slot in [one for one in found.slots if one.key.startswith(_OF_ALL)]:
        found.slots.remove(slot)
        found.leave_span(slot.span, "of some of them alone")


def _is_land(item: Item) -> bool:
    word = item.words[-1] if item.words else ""
    return word in _LAND or word.removesuffix("s") in _LAND


def _told(found: Findings, items: Sequence[Item]) -> None:
    """Take a wish to be told what is invented as met: the report does so."""
    for at, item in enumerate(items):
        if item.state or item.text not in _TELLING:
            continue
        end = end_of(items, at, ENDS)
        said = found.text[item.span[0] : items[end - 1].span[1]].casefold()
        if any(word in said for word in _MADE):
            for one in items[at:end]:
                one.state = one.state or READ
            found.notes.append(Note("told", _SAID, (item.span[0], items[end - 1].span[1])))
