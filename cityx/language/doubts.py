"""Doubts: what was read of words that say it of something else is taken back and named.

A word is known, but what it is said of is not: a mud-brick house is none of brick, and the neon
sign of a motel, where nobody knows what a motel is, is no light of the whole town.
"""

from __future__ import annotations

from collections.abc import Sequence

from cityx.language.brief import Note, Slot
from cityx.language.here import BUILDINGS, Findings
from cityx.language.scan import Item
from cityx.language.syntax import Syntax, is_plural, is_unknown
from cityx.town.elements import ELEMENTS

_OF_A_THING = ("lights", "building.feature", "building.roof", "building.material", "roof.color",
               "building.color")  # fmt: skip
_SAYS_HOW = ("style", "density", "building.roof", "building.height")
_STATES = ("shut", "closed", "open", "opened", "shuttered", "boarded", "empty", "busy")
_OWNED = ("its", "his", "her")
_STANDING = ("stop", "stops", "stopped", "stand", "stands", "halt", "halts")
_EACH = ("every", "each")
_OF_VEHICLES = ("parking", "lane", "lanes", "stop", "stops", "charging", "wash", "washing")
_OF_PLACED = ("near", "relation", "second", "metres", "size", "side")
_PLACED = "(where something is)"


def take_back(found: Findings, items: Sequence[Item], syntax: Syntax) -> None:
    """Leave open what was read of words that are said of what is not understood."""
    _leave_unasked(found)
    starts = {item.span[0]: at for at, item in enumerate(items)}
    for slots in (found.slots, found.negated):
        for slot in list(slots):
            at = starts.get(slot.span[0], -1)
            about = _doubt(found, items, syntax, at, slot) if at >= 0 else ""
            if about:
                slots.remove(slot)
                found.leave_span(slot.span, about)


def _leave_unasked(found: Findings) -> None:
    """Leave open where a thing stands, and how large it is, that nothing asks for."""
    asked = {str(slot.value) for slot in found.slots if slot.key in ("element", "building.type")}
    asked |= {slot.key.partition(".count")[0] for slot in found.slots if ".count" in slot.key}
    for slot in list(found.slots):
        kind, _, key = slot.key.partition(".")
        if kind in ELEMENTS and key.partition(".")[0] in _OF_PLACED and kind not in asked:
            found.slots.remove(slot)
            found.leave_span(slot.span, f"where the {kind} is")


def _doubt(found: Findings, items: Sequence[Item], syntax: Syntax, at: int, slot: Slot) -> str:
    """Return why a slot is not what its words say, "" where it is."""
    if at > 1 and items[at - 1].is_mark("-") and items[at - 2].kind == "unknown":
        return "a kind of its own"  # "mud-| brick"
    if at and _is_somebodys(found, items[at - 1], items[at]):
        return "a kind of its own"  # "a sheriff's | office"
    if slot.key == "not":
        return _denied_kind(items, syntax, at)
    if found.mapped and slot.key == "size":
        return "what the map says"  # "a small town", of which there is a map
    if slot.key in _OF_A_THING and (owner := _owner(items, syntax, at)) is not None:
        return f"of the {found.said(owner)}"
    word = slot.key == "lights" or slot.value == "none"
    if word and slot.key in ("windows.lit", "lights") and at and _is_a_part(items[at - 1]):
        return "how many of them"  # "most | windows dark", "5 % | lit"
    if slot.key == "building.roof" and _is_on_it(items, at):
        return "of what was told before"  # "put a green roof | on it"
    if slot.key == "agent" and at + 1 < len(items) and items[at + 1].text in _OF_VEHICLES:
        return "a kind of its own"  # "truck | parking"
    if slot.key == "lights" and slot.value == "neon" and _is_single(items, syntax, at):
        return "a single one"  # "a motel with | a neon sign"
    if slot.key == "lights" and slot.value == "neon" and at and items[at - 1].text in _OWNED:
        return "a single one"  # "a bar with | its neon on"
    if slot.key in ("traffic", "agent") and _is_lain_on(items, syntax, at):
        return "where something is"  # "snow on roofs and | cars"
    if slot.key == "wind" and _is_a_course(items, at):
        return "the course of something"  # "the road | winds up the hill"
    if slot.key == "traffic" and at + 1 < len(items) and items[at + 1].has("keep"):
        return "a rule of theirs"  # "traffic | keeps left"
    if slot.key == "traffic" and at + 1 < len(items) and items[at + 1].text in _STANDING:
        return "a state of them"  # "the cars | stop where they are"
    if slot.key == "district" and at and _is_used_for(items[at - 1], items[at]):
        return "a kind of its own"  # "loading | docks"
    if slot.key == "building.type" and _is_shut(items, syntax, at):
        return "a state of them"  # "shops | shut except one bar"
    if slot.key == "building.type" and _tells_of_which(items, syntax, at):
        return "of some of them alone"  # "neon signs on everything with | shops"
    if slot.key == "element" and _is_in_each_place(found.notes, items, at, slot):
        return "a place where something is"
    return ""


def _is_somebodys(found: Findings, before: Item, item: Item) -> bool:
    """Return whether a building or thing is that of somebody nobody knows."""
    owned = before.kind == "unknown" and found.said(before).endswith(("'s", "’s"))
    return owned and item.noun_class in ("type", "element")


def _is_shut(items: Sequence[Item], syntax: Syntax, at: int) -> bool:
    """Return whether buildings that nobody asked for are told to be open or closed."""
    phrase = syntax.phrase(at)
    first = at if phrase is None else phrase.first
    begins = first == 0 or items[first - 1].kind == "mark" or items[first - 1].get("rel") == "and"
    after = items[at + 1] if at + 1 < len(items) else None
    return begins and after is not None and after.text in _STATES


def _tells_of_which(items: Sequence[Item], syntax: Syntax, at: int) -> bool:
    """Return whether buildings are those that hold a kind: "everything with | shops"."""
    phrase = syntax.phrase(at)
    first = at if phrase is None else phrase.first
    told = items[max(0, first - 2) : first]
    return (
        len(told) == 2
        and told[1].text == "with"
        and (told[0].noun == "everything" or told[0].text == "those")
    )


def _is_single(items: Sequence[Item], syntax: Syntax, at: int) -> bool:
    phrase = syntax.phrase(at)
    return phrase is not None and items[phrase.first].text in ("a", "an", "one", "single")


def _is_lain_on(items: Sequence[Item], syntax: Syntax, at: int) -> bool:
    """Return whether vehicles are only what something lies on or stands behind."""
    if items[at].noun_class != "vehicle" or not items[at].has("noun"):
        return False
    phrase = syntax.phrase(at)
    first = at if phrase is None else phrase.first
    while first > 1 and items[first - 1].get("rel") == "and":
        listed = syntax.phrase(first - 2)
        if listed is None or listed.first >= first:
            break
        first = listed.first
    link = items[first - 1] if first else None
    return link is not None and (link.get("rel") == "on" or link.text in ("behind", "under"))


def _is_on_it(items: Sequence[Item], at: int) -> bool:
    """Return whether a pronoun says what something is put on."""
    behind = items[at + 1 : at + 3]
    return len(behind) == 2 and behind[0].get("rel") == "on" and behind[1].get("rel") == "it"


def _is_a_course(items: Sequence[Item], at: int) -> bool:
    """Return whether "winds" is what a street or a river does."""
    before = items[at - 1] if at else items[at]
    return items[at].text in ("wind", "winds") and (
        before.noun_class in ("road", "element") or before.text in ("that", "which", "to")
    )


def _is_used_for(before: Item, item: Item) -> bool:
    """Return whether a participle that nobody knows says what things are for."""
    doing = before.kind == "unknown" and before.text.endswith("ing")
    return doing and is_plural(item.words[-1])


def _is_a_part(item: Item) -> bool:
    """Return whether a word says of how many something holds."""
    share = item.quantity is not None and item.quantity.dimension in ("share", "part")
    return share or item.text in ("most", "some", "many", "several", "few", "a few")


def _denied_kind(items: Sequence[Item], syntax: Syntax, at: int) -> str:
    """Return why a denial is of things of one kind alone: "no | modern | street lamps"."""
    phrase = syntax.phrase(at)
    if phrase is None or phrase.head < 0:
        return ""
    looks = any(one.get("slot").startswith(_SAYS_HOW) for one in items[phrase.first : phrase.head])
    thing = items[phrase.head]
    of_a_thing = looks and thing.noun_class not in (*BUILDINGS, "place")
    return "denied of one kind alone" if of_a_thing else ""


def _owner(items: Sequence[Item], syntax: Syntax, at: int) -> Item | None:
    """Return the unknown thing that has what is told: "a motel with | a neon sign"."""
    phrase = syntax.phrase(at)
    first = at if phrase is None else phrase.first
    if not first or items[first - 1].text not in ("with", "has", "having"):
        return None
    before = syntax.phrase(first - 2) if first > 1 else None
    if before is None or before.head != first - 2:
        return None
    owner = items[before.head]
    article = items[before.first].text in ("a", "an", "one", "the")
    return owner if article and is_unknown(owner) and not owner.state else None


def _is_in_each_place(notes: Sequence[Note], items: Sequence[Item], at: int, slot: Slot) -> bool:
    """Return whether a thing is only a place of others: "masts at every | crossing with lights"."""
    each = at > 0 and items[at - 1].text in _EACH
    return each and any(
        _PLACED in note.text and note.span[0] <= slot.span[0] and slot.span[1] <= note.span[1]
        for note in notes
    )
