"""Some alone: what is said of a part of a city, of one place or one building is not put on all.

A slot is of all of a city. Where the words that say of which things, or in which place, were not
read, it would be a wish that nobody had: it is left open, or put on the kind that it is of.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import pairwise

from cityx.language.brief import Slot
from cityx.language.here import Findings, is_of_a_town
from cityx.language.lexicon.numbers import EVERY_SO_MANY
from cityx.language.lexicon.phrases import PARTS_OF_SPEECH
from cityx.language.scan import ENDS, Item, begin_of, end_of, within
from cityx.language.syntax import Syntax, is_plural
from cityx.town.quarter_kinds import COUNTED_KINDS, DWELLINGS

_PLACES = ("in", "on", "at", "around", "near", "along", "within")
_LINKS = (*PARTS_OF_SPEECH["prepositions"], "only")
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
_EACH = ("every", "each")
# How things are put together, which does not say which of them.
_ARRANGED = ("row", "rows", "pair", "pairs", "line", "lines", "cluster", "clusters", "groups")


FEW_TOWERS = 20  # that stand among other houses


def leave_some_alone(
    found: Findings, items: Sequence[Item], syntax: Syntax, unread: Sequence[Item]
) -> None:
    """Leave open what would be put on all of a city where words that say of which are not read.

    "Garages in | two of the blocks" are not most buildings, and the storeys of "the main building"
    not those of all; of "four student residences" they are those of these alone.

    Parameters
    ----------
    unread
        Items with content that no rule has read.
    """
    spans = [item.span for item in unread]
    spans += [note.span for note in found.notes if note.code == "left_open"]
    _leave_orders(found, items, unread)
    _leave_places(found, items, syntax)
    _leave_measures(found, items, syntax, spans)
    open_ = within(items, spans)
    counted = {slot.span[0] for slot in found.slots if slot.key.endswith(".count")}
    for slot, at in _asked(found, items):
        if not slot.key.startswith(_OF_ALL):
            continue
        if kind := _kind_of_some(items, syntax, at, open_):
            _put_on_some(found, slot, kind)
        elif slot.key.endswith((".floors", ".height")) and (kind := _single(items, syntax, at)):
            _put_on_some(found, slot, kind)
            _ask_for_one(found, items[syntax.owner(at)], kind)
        elif slot.span[0] not in counted and (about := _narrowed(found, items, syntax, at, open_)):
            _leave(found, slot, f"of some alone: {about}")
    most = {slot.value for slot in found.slots if slot.key == "building.type"}
    for slot, at in _asked(found, items):
        kind = _counted_kind(items, syntax, at) if slot.key.startswith("building.count") else ""
        if kind and kind not in (*most, *DWELLINGS):
            _put_on_some(found, slot, kind)  # "30 shops facing the water"
    _put_on_towers(found, items, syntax)


def _put_on_towers(found: Findings, items: Sequence[Item], syntax: Syntax) -> None:
    """Keep what is said of a few towers off the houses of the town that they stand in."""
    types = [slot for slot in found.slots if slot.key == "building.type"]
    counts = [slot for slot in found.slots if slot.key.startswith("building.count")]
    town = any(slot.key in ("district", "element", "terrain", "style") for slot in found.slots)
    few = all(float(slot.value) <= FEW_TOWERS for slot in counts)
    if not (counts and few and town and [slot.value for slot in types] == ["tower"]):
        return
    head = _begin(items, types[0])
    own = [slot for slot, at in _asked(found, items)
           if slot.key.startswith("building.") and head in (at, syntax.owner(at))]  # fmt: skip
    others = [slot for slot in found.slots if slot.key.startswith(_OF_ALL)
              and slot not in (*own, *counts, *types)]  # fmt: skip
    if others:
        return  # "none of them under 120 m"
    for slot in (*own, *(one for one in counts if one not in own)):
        _put_on_some(found, slot, "tower")


def _asked(found: Findings, items: Sequence[Item]) -> Iterator[tuple[Slot, int]]:
    """Yield the slots that are not of each thing, with their first items; they may go meanwhile."""
    for slot in list(found.slots):
        at = _begin(items, slot)
        if at >= 0 and not slot.every and slot.span[1]:
            yield slot, at


def _leave(found: Findings, slot: Slot, about: str) -> None:
    for slots in (found.slots, found.negated):
        slots[:] = [one for one in slots if one is not slot]
    found.leave_span(slot.span, about)


def _leave_orders(found: Findings, items: Sequence[Item], unread: Sequence[Item]) -> None:
    """Leave what an order is about whose verb was not read: "take away | all car parks"."""
    for at, (item, after) in enumerate(pairwise(items)):
        begins = at == 0 or items[at - 1].is_mark(ENDS + ",:") or items[at - 1].get("rel") == "and"
        if not begins or item not in unread or item.quantity is not None:
            continue
        if after.get("rel") not in ("all", "every") and after.text not in ("the", "any", "these"):
            continue
        first, last = item.span[0], items[end_of(items, at, ENDS + ",") - 1].span[1]
        for slot in (*found.slots, *found.negated):
            if first <= slot.span[0] < last:
                _leave(found, slot, f"what is ordered: {found.said(item)}")


def _leave_places(found: Findings, items: Sequence[Item], syntax: Syntax) -> None:
    """Leave what is told of life in one place: "the promenade is | packed"."""
    for slot in (*found.slots, *found.negated):
        if place := _place_told(found, items, syntax, slot):
            _leave(found, slot, f"in one place alone: {place}")


def _leave_measures(
    found: Findings, items: Sequence[Item], syntax: Syntax, spans: Sequence[tuple[int, int]]
) -> None:
    """Leave the measures of what was left open: "a mosque with a minaret of | 30 m"."""
    for slot, at in _asked(found, items):
        if slot.key.startswith(("building.height", "building.floors")) and (
            items[at].quantity is not None
            and not (_tells_of_buildings(items, at) or _are_of_no_other(items, at))
        ):
            _leave(found, slot, "of what is not said")
            continue
        measured = slot.key.removesuffix(".min").removesuffix(".max").endswith(_MEASURED)
        if not measured or items[at].quantity is None or syntax.head_behind(at) >= 0:
            continue
        head = syntax.head_before(at)
        if head >= 0 and _is_what_it_is_for(items, syntax, head, at):
            continue
        if head >= 0 and items[head].span in spans and items[head].span[0] < slot.span[0]:
            _leave(found, slot, f"of the {found.said(items[head])}")


def _place_told(found: Findings, items: Sequence[Item], syntax: Syntax, slot: Slot) -> str:
    """Return the place that is crowded, quiet or closed, where a clause names one.

    The place is its subject ("the promenade is packed") or follows a preposition ("heavy traffic
    on the ring road").
    """
    at = _begin(items, slot)
    life = slot.key in _OF_LIFE or (slot.key == "not" and slot.value in _MOVING)
    if at < 0 or not life:
        return ""
    first = begin_of(items, at, ENDS + ",:")
    for n in range(first, end_of(items, at, ENDS + ",:")):
        item, phrase = items[n], syntax.phrase(n)
        apart = slot.span[1] <= item.span[0] or item.span[1] <= slot.span[0]
        if phrase is None or phrase.head != n or not apart or not _is_a_place(item):
            continue
        if phrase.first <= at < n:
            continue  # "over a deserted | plaza"
        link = items[phrase.first - 1] if phrase.first > first else None
        if any(_is_head(syntax, k) for k in range(min(at, n) + 1, max(at, n))):
            continue  # something else stands between
        apart = any(one.get("rel") in ("and", "or") for one in items[n + 1 : at])
        if apart and link is not None and phrase.first - 1 > first:
            continue  # "traffic on the main roads and crowded | pavements"
        if slot.key == "traffic" and item.noun_class == "road" and is_plural(item.words[-1]):
            continue  # "heavy traffic on the main | roads": where most of it drives
        subject = n < at and not apart and (link is None or link.get("rel") in ("and", "but"))
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


def _narrowed(
    found: Findings, items: Sequence[Item], syntax: Syntax, at: int, open_: Sequence[bool]
) -> str:
    """Return the words by which something is said of some alone, and that were not read."""
    phrase = syntax.phrase(at)
    if phrase is None or phrase.head < 0:  # "a main building of | 7 floors"
        owner = syntax.owner(at)
        if owner >= 0 and _is_what_it_is_for(items, syntax, owner, at):
            return ""
        phrase = syntax.phrase(owner) if owner >= 0 else None
    if phrase is None:
        return ""
    for n in range(phrase.first, phrase.head):
        some = items[n].kind == "unknown" and not items[n].text.endswith("ly")
        if (open_[n] and some) or items[n].get("rel") in EVERY_SO_MANY:
            return found.said(items[n])
    behind = phrase.end
    while behind < len(items) and items[behind].kind == "function":
        behind += 1
    if behind == len(items) or items[behind].kind == "mark" or _is_land(items[behind]):
        return ""
    if items[behind].get("rel") in _PLACES:  # "garages in | two of the blocks"
        behind = syntax.object_of(behind)
        place = syntax.phrase(behind) if behind >= 0 else None
        if place is None or items[place.first].text in ("a", "an"):
            return ""
        if items[behind].text in _ARRANGED:
            return ""  # "wooden houses in | rows"
    link = items[behind].has("rel") or items[behind].text in _LINKS
    return found.said(items[behind]) if open_[behind] and not link else ""


def _is_land(item: Item) -> bool:
    """Return whether an item is the land that all of a town stands on: "terraces | on a slope"."""
    return item.get("slot").startswith("terrain=")


def _tells_of_buildings(items: Sequence[Item], at: int) -> bool:
    """Return whether a sentence speaks of buildings or a town, or of nothing but a measure."""
    sentence = items[begin_of(items, at, ENDS) : end_of(items, at, ENDS)]
    return not any(one.noun or one.kind == "unknown" for one in sentence) or any(
        is_of_a_town(one) or one.noun == "everything" or one.text in ("nothing", "roofs", "roof")
        for one in sentence
    )


def _is_what_it_is_for(items: Sequence[Item], syntax: Syntax, head: int, at: int) -> bool:
    """Return whether a colon stands behind what a town is for: "a town for a novel: | 2 floors"."""
    phrase = syntax.phrase(head)
    first = head if phrase is None else phrase.first
    before = items[begin_of(items, head, ENDS) : first]
    town = any(is_of_a_town(one) for one in before)
    purpose = bool(before) and before[-1].text == "for" and _is_alone(items, at)
    return town and purpose and any(one.is_mark(":") for one in items[head:at])


def _are_of_no_other(items: Sequence[Item], at: int) -> bool:
    """Return whether storeys stand alone behind what has none: "cobbled streets, | two floors"."""
    quantity = items[at].quantity
    if quantity is None or quantity.dimension != "floors":
        return False
    before = items[begin_of(items, at, ENDS + ":") : at]
    return _is_alone(items, at) and not any(
        one.kind == "unknown" or one.noun_class in ("type", "element", "vehicle") for one in before
    )


def _is_alone(items: Sequence[Item], at: int) -> bool:
    """Return whether an item stands between marks."""
    ends = at + 1 == len(items) or items[at + 1].kind == "mark"
    return ends and (at == 0 or items[at - 1].kind == "mark")


def _counted_kind(items: Sequence[Item], syntax: Syntax, at: int) -> str:
    """Return the kind of buildings that a number is of, "" for others."""
    phrase = syntax.phrase(at)
    head = items[phrase.head] if phrase is not None and phrase.head >= 0 else None
    return head.noun if head is not None and head.noun in COUNTED_KINDS else ""


def _begin(items: Sequence[Item], slot: Slot) -> int:
    """Return the first item of a slot, -1 for none."""
    return next((n for n, item in enumerate(items) if slot.span[0] <= item.span[0]), -1)
