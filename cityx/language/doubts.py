"""Doubts: what was read of words that say it of something else is taken back and named.

A word is known, but what it is said of is not: a mud-brick house is none of brick, and the neon
sign of a motel, where nobody knows what a motel is, is no light of the whole town.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from cityx.language.brief import Note, Slot
from cityx.language.here import BUILDINGS, Findings
from cityx.language.lexicon.phrases import PARTS_OF_SPEECH
from cityx.language.scan import ENDS, Item
from cityx.language.syntax import Syntax, is_plural, is_unknown
from cityx.town.quarter_kinds import COUNTED_KINDS

_OF_A_THING = ("lights", "building.feature", "building.roof", "building.material", "roof.color",
               "building.color")  # fmt: skip
_SAYS_HOW = ("style", "density", "building.roof", "building.height")
_PLACES = ("in", "on", "at", "around", "near", "along", "within")
_LINKS = (*PARTS_OF_SPEECH["prepositions"], "only")
_STANDING = ("stop", "stops", "stopped", "stand", "stands", "halt", "halts")
_EACH = ("every", "each")
_MEASURED = (".height", ".floors", ".width", ".area", ".length")
# What holds of all of a city: of buildings, of traffic, of what must not be there.
_OF_ALL = ("building.count", "building.height", "building.floors", "building.color",
           "building.material", "building.roof", "building.type", "roof.color", "traffic",
           "pedestrians")  # fmt: skip
# What is told of life in a city, of all of it where no place is named.
_OF_LIFE = ("traffic", "pedestrians", "density")
_MOVING = ("vehicle", "pedestrian")
_INSIDE = ("inside", "outside", "through", "within", "from", "across", "to")
_STREETS = ("center", "main_street", "side_street", "avenue", "ring_road", "motorway")
_OF_VEHICLES = ("parking", "lane", "lanes", "stop", "stops", "charging", "wash", "washing")
_PLACED = "(where something is)"


def take_back(found: Findings, items: Sequence[Item], syntax: Syntax) -> None:
    """Leave open what was read of words that are said of what is not understood."""
    starts = {item.span[0]: at for at, item in enumerate(items)}
    for slots in (found.slots, found.negated):
        for slot in list(slots):
            at = starts.get(slot.span[0], -1)
            about = _doubt(found, items, syntax, at, slot) if at >= 0 else ""
            if about:
                slots.remove(slot)
                found.leave_span(slot.span, about)


def take_back_parts(
    found: Findings, items: Sequence[Item], syntax: Syntax, unread: Sequence[Item]
) -> None:
    """Leave open what would be put on all of a city where words that say of which are not read.

    "Garages in | two of the blocks" are not most buildings, and the storeys of "the main building"
    not those of all; of "four student residences" they are those of these alone.
    """
    spans = [item.span for item in unread]
    spans += [note.span for note in found.notes if note.code == "left_open"]
    open_ = [any(first < item.span[1] and item.span[0] < end for first, end in spans)
             for item in items]  # fmt: skip
    counted = {slot.span[0] for slot in found.slots if slot.key.endswith(".count")}
    for slots in (found.slots, found.negated):
        for slot in list(slots):
            place = _place_told(found, items, syntax, slot)
            if place:
                slots.remove(slot)
                found.leave_span(slot.span, f"in one place alone: {place}")
    for slot in list(found.slots):
        at = _begin(items, slot)
        if at < 0 or slot.every or not slot.span[1]:
            continue
        if slot.key.removesuffix(".min").removesuffix(".max").endswith(_MEASURED):
            head = syntax.head_before(at) if items[at].quantity is not None else -1
            of_it = head >= 0 and slot.span[0] <= items[head].span[0]
            alone = head >= 0 and items[head].span in spans
            if alone and not of_it and syntax.head_behind(at) < 0:
                found.slots.remove(slot)
                found.leave_span(slot.span, f"of the {found.said(items[head])}")
                continue
        if not slot.key.startswith(_OF_ALL):
            continue
        if kind := _kind_of_some(items, syntax, at, open_):
            _put_on_some(found, slot, kind)
        elif slot.key.endswith((".floors", ".height")) and (kind := _single(items, syntax, at)):
            _put_on_some(found, slot, kind)
            _ask_for_one(found, items[syntax.owner(at)], kind)
        elif slot.span[0] not in counted and (about := _narrowed(found, items, syntax, at, open_)):
            found.slots.remove(slot)
            found.leave_span(slot.span, f"of some alone: {about}")
    for slot in list(found.slots):
        kind = _counted_kind(items, syntax, slot)
        if kind and not any(
            one.key == "building.type" and one.value == kind for one in found.slots
        ):
            _put_on_some(found, slot, kind)  # "30 shops facing the water"


def _single(items: Sequence[Item], syntax: Syntax, at: int) -> str:
    """Return the kind of the one building that is so high: "office block, | 10 floors"."""
    head = syntax.owner(at)
    thing = items[head] if head >= 0 else None
    if thing is None or thing.noun not in COUNTED_KINDS or is_plural(thing.words[-1]):
        return ""
    phrase = syntax.phrase(head)
    told = [] if phrase is None else items[phrase.first : phrase.head]
    modifies = phrase is not None and phrase.first <= at < phrase.head  # "six-storey | house"
    some = any(one.get("rel") in ("all", "every") or one.text in _EACH for one in told)
    return "" if some or modifies or thing.words[-1] == "housing" else thing.noun


def _ask_for_one(found: Findings, item: Item, kind: str) -> None:
    """Ask for one building of a kind in place of most."""
    most = ("building.type", kind, item.span)
    for slot in [one for one in found.slots if (one.key, one.value, one.span) == most]:
        found.slots[found.slots.index(slot)] = replace(slot, key=f"{kind}.count.min", value=1)


def _counted_kind(items: Sequence[Item], syntax: Syntax, slot: Slot) -> str:
    """Return the kind of buildings that a number of all buildings was read of, "" for others."""
    at = _begin(items, slot)
    phrase = syntax.phrase(at) if at >= 0 and slot.key.startswith("building.count") else None
    head = items[phrase.head] if phrase is not None and phrase.head >= 0 else None
    return head.noun if head is not None and head.noun in COUNTED_KINDS else ""


def _begin(items: Sequence[Item], slot: Slot) -> int:
    """Return the first item of a slot, -1 for none."""
    return next((n for n, item in enumerate(items) if slot.span[0] <= item.span[0]), -1)


def _place_told(found: Findings, items: Sequence[Item], syntax: Syntax, slot: Slot) -> str:
    """Return the place that is crowded, quiet or closed, where a clause names one.

    The place is its subject ("the promenade is packed") or follows a preposition ("heavy traffic
    on the ring road").
    """
    at = _begin(items, slot)
    life = slot.key in _OF_LIFE or (slot.key == "not" and slot.value in _MOVING)
    if at < 0 or not life:
        return ""
    first, end = at, at
    while first > 0 and not items[first - 1].is_mark(ENDS + ",:"):
        first -= 1
    while end < len(items) and not items[end].is_mark(ENDS + ",:"):
        end += 1
    for n in range(first, end):
        item, phrase = items[n], syntax.phrase(n)
        apart = slot.span[1] <= item.span[0] or item.span[1] <= slot.span[0]
        if phrase is None or phrase.head != n or not apart or not _is_a_place(item):
            continue
        if phrase.first <= at < n:
            continue  # "over a deserted | plaza"
        link = items[phrase.first - 1] if phrase.first > first else None
        if any(_is_head(syntax, k) for k in range(min(at, n) + 1, max(at, n))):
            continue  # something else stands between
        subject = n < at and (link is None or link.get("rel") in ("and", "but"))
        if subject or (link is not None and (link.get("rel") in _PLACES or link.text in _INSIDE)):
            return found.said(item)
    return ""


def _is_head(syntax: Syntax, at: int) -> bool:
    phrase = syntax.phrase(at)
    return phrase is not None and phrase.head == at


def _is_a_place(item: Item) -> bool:
    if item.noun == "center" and len(item.words) > 1:
        return False  # "in the city centre" is where all of it is
    return item.noun in _STREETS or (item.noun_class == "element" and item.has("noun"))


def _kind_of_some(items: Sequence[Item], syntax: Syntax, at: int, open_: Sequence[bool]) -> str:
    """Return the kind of counted buildings that are some of theirs: "four student | houses"."""
    own = syntax.phrase(at)
    owner = at if own is not None and own.head == at else syntax.owner(at)
    phrase = syntax.phrase(owner) if owner >= 0 else None
    if phrase is None or items[owner].noun not in COUNTED_KINDS or owner != phrase.head:
        return ""
    number = items[phrase.first].quantity
    nouns = (n for n in range(phrase.first + 1, owner) if items[n].has("noun"))
    few = number is not None and number.dimension == "count"
    return items[owner].noun if few and any(open_[n] for n in nouns) else ""


def _put_on_some(found: Findings, slot: Slot, kind: str) -> None:
    """Let what was read of all buildings be of those of a kind."""
    key = slot.key.removeprefix("building.")
    if slot.key == "building.type":
        found.slots.remove(slot)
    elif slot.key != key:
        found.slots[found.slots.index(slot)] = replace(slot, key=f"{kind}.{key}")


def _narrowed(
    found: Findings, items: Sequence[Item], syntax: Syntax, at: int, open_: Sequence[bool]
) -> str:
    """Return the words by which something is said of some alone, and that were not read."""
    phrase = syntax.phrase(at)
    if phrase is None or phrase.head < 0:  # "a main building of | 7 floors"
        owner = syntax.owner(at)
        phrase = syntax.phrase(owner) if owner >= 0 else None
    if phrase is None:
        return ""
    for n in range(phrase.first, phrase.head):
        if open_[n] and items[n].kind == "unknown" and not items[n].text.endswith("ly"):
            return found.said(items[n])
    behind = phrase.end
    while behind < len(items) and items[behind].kind == "function":
        behind += 1
    if behind == len(items) or items[behind].kind == "mark":
        return ""
    if items[behind].get("rel") in _PLACES:  # "garages in | two of the blocks"
        behind = syntax.object_of(behind)
        place = syntax.phrase(behind) if behind >= 0 else None
        if place is None or items[place.first].text in ("a", "an"):
            return ""
    link = items[behind].has("rel") or items[behind].text in _LINKS
    return found.said(items[behind]) if open_[behind] and not link else ""


def _doubt(found: Findings, items: Sequence[Item], syntax: Syntax, at: int, slot: Slot) -> str:
    """Return why a slot is not what its words say, "" where it is."""
    if at > 1 and items[at - 1].is_mark("-") and items[at - 2].kind == "unknown":
        return "a kind of its own"  # "mud-| brick"
    if slot.key == "not":
        return _denied_kind(items, syntax, at)
    if found.mapped and slot.key == "size":
        return "what the map says"  # "a small town", of which there is a map
    if slot.key in _OF_A_THING and (owner := _owner(items, syntax, at)) is not None:
        return f"of the {found.said(owner)}"
    if slot.key in ("windows.lit", "lights") and at and _is_a_part(items[at - 1]):
        return "how many of them"  # "most | windows dark", "5 % | lit"
    if slot.key == "building.roof" and _is_on_it(items, at):
        return "of what was told before"  # "put a green roof | on it"
    if slot.key == "agent" and at + 1 < len(items) and items[at + 1].text in _OF_VEHICLES:
        return "a kind of its own"  # "truck | parking"
    if slot.key == "lights" and slot.value == "neon" and _is_single(items, syntax, at):
        return "a single one"  # "a motel with | a neon sign"
    if slot.key in ("traffic", "agent") and _is_lain_on(items, syntax, at):
        return "where something is"  # "snow on roofs and | cars"
    if slot.key == "wind" and _is_a_course(items, at):
        return "the course of something"  # "the road | winds up the hill"
    if slot.key == "traffic" and at + 1 < len(items) and items[at + 1].text in _STANDING:
        return "a state of them"  # "the cars | stop where they are"
    if slot.key == "district" and at and _is_used_for(items[at - 1], items[at]):
        return "a kind of its own"  # "loading | docks"
    if slot.key == "element" and _is_in_each_place(found.notes, items, at, slot):
        return "a place where something is"
    return ""


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
