"""Counted there: a number of things in one place is not how many there are in all of a city.

"Four lamps around the fountain" are four of the lamps of a town. Where the place is read, a
command puts them there; where it is left open, there are at least so many.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from cityx.language.brief import Slot, Span
from cityx.language.here import Findings
from cityx.language.lexicon.phrases import NOUNS, PARTS_OF_SPEECH
from cityx.language.scan import Item
from cityx.language.syntax import Syntax
from cityx.town.elements import OTHER_THINGS

_COUNT, _MOST = ".count", ".count.max"
_USUAL = ("tree", "traffic_light")
_MOVING = frozenset((*NOUNS["vehicle"], *NOUNS["person"]))
_NUMBERED = ("one", "another", "ones")
_PLACING = ("in", "on", "near", "along", "around", "by")


def settle_counted_there(found: Findings) -> None:
    """Let numbers of things whose place is left open bound those of the city from below."""
    open_ = [note.of for note in found.notes if note.code == "left_open" and note.of is not None]
    for at, slot in enumerate(list(found.slots)):
        if _are_elsewhere(slot) and slot.key.endswith(_COUNT) and _is_inside(slot.span, open_):
            found.slots[at] = replace(slot, key=f"{slot.key}.min")
    for slot in [one for one in found.slots if one.key.endswith(_MOST)]:
        if _is_inside(slot.span, open_):
            found.slots.remove(slot)
            found.leave_span(slot.span, "in one place alone")


def _are_elsewhere(slot: Slot) -> bool:
    """Return whether a town has such things elsewhere, too: lamps, people, but no schools."""
    kind = slot.key.partition(".")[0]
    return kind in _USUAL or kind in OTHER_THINGS or kind in _MOVING


def _is_inside(span: Span, phrases: Sequence[Span]) -> bool:
    return any(first <= span[0] and span[1] <= last for first, last in phrases)


def others_of(syntax: Syntax, at: int) -> int:
    """Return the head that a number or "one" before a place stands for, or -1.

    "Six benches on the square and | two in the park" are benches, as no park is in a park.
    """
    items = syntax.items
    item, after = items[at], items[at + 1] if at + 1 < len(items) else None
    number = item.quantity is not None and item.quantity.dimension == "count"
    if not (number or item.text in _NUMBERED) or after is None or not _places(after):
        return -1
    before = items[at - 1] if at else None
    if before is None or not (before.is_mark(",") or before.get("rel") in ("and", "but")):
        return -1
    return _named_before(syntax, at)


def are_more(syntax: Syntax, at: int, head: int) -> bool:
    """Return whether a number stands for more of a kind: not "two inns, | one in the north"."""
    own = range(head + 1, at + 1)
    return not any(syntax.items[n - 1].is_mark(",") and others_of(syntax, n) == head for n in own)


def _places(item: Item) -> bool:
    preposition = item.text in PARTS_OF_SPEECH["prepositions"] and item.text not in ("of", "with")
    return item.get("rel") in _PLACING or preposition


def _named_before(syntax: Syntax, at: int) -> int:
    """Return the last head before an item in its sentence that stands behind no preposition."""
    items = syntax.items
    while at > 0:
        at -= 1
        phrase = syntax.phrase(at)
        if items[at].is_mark(".;!?\n:"):
            return -1
        if phrase is None or phrase.head != at or not items[at].has("noun"):
            continue
        link = items[phrase.first - 1] if phrase.first else None
        if link is None or not (_places(link) or link.get("rel") == "of"):
            return at
    return -1
