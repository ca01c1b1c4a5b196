"""Standing words: at the top of a hill, at its foot, dead centre, in the middle of a green.

They are read with the single thing before them; what is said of nothing that can be placed is left
to the other rules.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

from cityx.language.brief import Slot, Span
from cityx.language.here import Findings
from cityx.language.scan import ENDS, Item
from cityx.language.scopes import READ
from cityx.language.syntax import is_plural
from cityx.town.elements import ELEMENTS
from cityx.town.part_kinds import HOSTS
from cityx.town.quarter_kinds import KINDS

_UP = r"(?:right |perched |standing |set |sitting |high |up )*"
_LAND = r"(?:hill|slope|mountain|mount|ridge)"
_ABOVE = r"(?: above(?: (?:it|them|the \w+))?)?"
_HIGH = re.compile(
    rf"\b{_UP}(?:on|at|atop|crowning|on top of|at the top of) (?:the |a )?"
    rf"(?:very )?(?:top of (?:the |a )?)?(?:hill ?top|{_LAND}|summit|peak|crest){_ABOVE}\b"
    rf"|\b{_UP}at (?:the |its )very top(?: of (?:the |it\b)?(?:town|village|city|site|{_LAND})?)?\b"
    rf"|\b{_UP}(?:at|on) (?:the |its )?(?:very )?highest (?:point|spot|place|ground)"
    r"(?: of (?:the )?(?:town|village|city|site|hill|island))?\b"
    r"|\bon (?:the )?high ground\b"
)
_TOP = re.compile(rf"\b{_UP}at (?:the |its )top\b(?! of the (?:map|page|picture|high|street))")
_OVER = re.compile(r"\boverlooking (?:it all|everything|the (?:town|village|city|houses|rest))\b")
_LOW = re.compile(
    rf"\b(?:down )?at (?:the |its )(?:foot|bottom|base) of (?:the |a ){_LAND}\b"
    r"|\b(?:down )?at the (?:very )?(?:bottom|lowest (?:point|spot))\b(?! of)"
    r"|\bon (?:the )?low(?:est)? ground\b"
)
_WATER = re.compile(
    r"\b(?:down |right )*(?:by|at|beside|along) the (?:water|waterside|water's edge)\b"
)
_MIDDLE = re.compile(
    r"\b(?:dead|slap bang in the|bang in the|right in the|smack in the|in the very|in the dead) ?-?"
    r"(?:cent(?:er|re)|middle)\b(?! of)"
)
_AMID = re.compile(
    r"\b(?:right )?in the (?:middle|cent(?:er|re)) of (?:a|the|its) (?:\w+ )??"
    r"(square|plaza|piazza|green|park)\b"
)
_ROOF = re.compile(r"\b(?:up )?on (?:top(?: of it)?|(?:its|the) (?:roof|rooftop))\b(?! of the)")
_ALL_SIDES = re.compile(
    r"\b(?:on|along|round|around|at) all (?:four|three|4|the)?(?: of its)? ?sides\b"
)
_TALLEST = re.compile(
    r"\b(?:as|being|is|must be|should be|to be) the (?:tallest|highest)"
    r" (?:building|thing|structure)"
    r"(?: (?:in sight|of all|around|in (?:the )?(?:town|village|city)))?\b"
)
_PLACES = {"square": "plaza", "plaza": "plaza", "piazza": "plaza", "green": "park", "park": "park"}
_WATERS = ("harbour", "sea", "beach", "lake", "river", "canal", "pond")
_CLIMBING = re.compile(
    r"\b(?:climb(?:s|ing)?|uphill|rise|rises|rising|steep (?:lane|path|street|alley)s?"
    r"|winding up)\b"
)
_LEVEL = ("hill", "slope", "plateau", "ridge", "terraces", "valley")  # land whose top is known


def read_standing(found: Findings, items: Sequence[Item]) -> None:
    """Read how high things stand, and in the middle of what."""
    text = found.text.lower()
    if len(text) != len(found.text) or not items:
        return  # letters of other scripts that change their number
    own = min(one.span[0] for one in items), max(one.span[1] for one in items)
    level = any(f"terrain={one}" in item.get("slot") for item in items for one in _LEVEL)
    for pattern, side in ((_HIGH, "high"), (_TOP, "high"), (_OVER, "high"), (_LOW, "low")):
        for match in pattern.finditer(text, *own):
            bare = pattern in (_TOP, _OVER)
            if bare and not (level or _climbs(text, match.start())):
                continue
            thing = _thing_before(items, match.start())
            if thing is not None and HOSTS.get(thing.noun):
                _add(found, items, thing, match.span(), side=side)
    for match in _MIDDLE.finditer(text, *own):
        thing = _thing_before(items, match.start())
        if thing is not None:
            _add(found, items, thing, match.span(), side="middle")
    for match in _AMID.finditer(text, *own):
        thing = _thing_before(items, match.start())
        if thing is not None and thing.noun != _PLACES[match[1]]:
            span = match.start(), match.start(1)
            _add(found, items, thing, span, near=_PLACES[match[1]], relation="in")
    _on_roofs(found, items, text, own)
    _by_water(found, items, text, own)
    for match in _TALLEST.finditer(text, *own):
        thing = _thing_before(items, match.start())
        if thing is not None and HOSTS.get(thing.noun) and not found.mapped:
            _add(found, items, thing, match.span(), height="tallest")
    for match in _ALL_SIDES.finditer(text, *own):
        _on_all_sides(found, items, match.span())


def _climbs(text: str, end: int) -> bool:
    """Return whether a sentence tells of a way up: "lanes climbing to a church | at the top"."""
    begin = max(text.rfind(mark, 0, end) for mark in ENDS) + 1
    of_a_thing = re.match(r"[a-z ]*\btop of\b", text[end:]) is not None
    return not of_a_thing and _CLIMBING.search(text, begin, end) is not None


def settle_standing(found: Findings) -> None:
    """Lay a hill where something stands on one; leave open what land has no top of its own."""
    high = [slot for slot in found.slots if slot.key.endswith(".side") and slot.value in (
        "high", "low")]  # fmt: skip
    if not high or found.mapped:
        for slot in high:
            found.slots.remove(slot)
            found.leave_span(slot.span, "how high it stands")
        return
    land = [slot for slot in found.slots if slot.key == "terrain"]
    one_hill = re.search(r"\bhill(?:top)?\b", found.text.lower()) is not None
    if any(slot.value in _LEVEL for slot in land):
        return
    for slot in land if one_hill else ():
        found.slots.remove(slot)
    if not land or one_hill:
        slot = high[0]
        found.slots.append(Slot("terrain", "hill", slot.span, slot.text))
        return
    for slot in high:
        found.slots.remove(slot)
        found.leave_span(slot.span, "how high it stands")


def settle_greens(items: Sequence[Item]) -> None:
    """Take "the green" that something is on, round or in the middle of for a park."""
    for at, item in enumerate(items):
        if item.text != "green":
            continue
        first = at
        while first and items[first - 1].text in ("a", "the", "village", "town", "central"):
            first -= 1
        link = items[first - 1] if first and first < at else None
        after = items[at + 1] if at + 1 < len(items) else None
        ends = after is None or after.kind == "mark" or after.has("rel") or after.text == "with"
        placing = link is not None and (link.get("rel") in (
            "in", "on", "around", "near", "along", "by") or link.text in _ROUND)  # fmt: skip
        if link is not None and link.get("rel") in ("of", "with", "from") and first > 1:
            measure = items[first - 2].quantity  # "within 300 m of | the green", "from"
            placing = measure is not None and measure.dimension == "length"
        if placing and ends and not (after and after.get("rel") == "of"):
            item.kind, item.senses = "phrase", (("noun", "element:park"),)


_ROUND = ("round", "around", "facing", "overlooking", "surrounding", "beside", "at")


def _thing_before(items: Sequence[Item], start: int) -> Item | None:
    """Return the single thing that stands right before a place in the text."""
    before = [item for item in items if item.span[1] <= start]
    for item in reversed(before):
        if item.is_mark(ENDS + ",:"):
            return None
        if item.has("noun") and item.noun in ELEMENTS and not ELEMENTS[item.noun].builder:
            one = not is_plural(item.words[-1])
            return item if one and item.state in ("", READ) else None
        if item.has("noun", "rel") and item.state != READ:  # else a part of the thing
            return None
    return None


def _add(found: Findings, items: Sequence[Item], thing: Item, span: Span, **told: str) -> None:
    """Add where a thing stands; the words for it count as read."""
    own = [item for item in items if span[0] <= item.span[0] and item.span[1] <= span[1]]
    if any(item.state not in ("", READ) for item in own) or not own:
        return
    for name, value in told.items():
        found.add(f"{thing.noun}.{name}", value, *own)


def _on_roofs(found: Findings, items: Sequence[Item], text: str, own: Span) -> None:
    """Read "a hotel with a helipad | on top"."""
    for match in _ROOF.finditer(text, *own):
        thing = _thing_before(items, match.start())
        if thing is None or thing.noun != "helipad":
            continue
        before = [one for one in items if one.span < thing.span and one.has("noun")]
        host = before[-1] if before else None
        if host is not None and HOSTS.get(host.noun):
            _add(found, items, thing, match.span(), near=host.noun, relation="on")


def _by_water(found: Findings, items: Sequence[Item], text: str, own: Span) -> None:
    """Read "an inn down by the water" of the water that the text tells of."""
    named = [one for one in _WATERS if any(item.noun == one for item in items)]
    if not named and any("district=coastal" in item.get("slot") for item in items):
        named = ["sea"]
    for match in _WATER.finditer(text, *own):
        thing = _thing_before(items, match.start())
        if thing is not None and named and HOSTS.get(thing.noun):
            _add(found, items, thing, match.span(), near=named[0], relation="at")


def _on_all_sides(found: Findings, items: Sequence[Item], span: Span) -> None:
    """Read "a green, shops | round all four sides": of the square or park named last."""
    own = [item for item in items if span[0] <= item.span[0] and item.span[1] <= span[1]]
    before = [item for item in items if item.span[1] <= span[0]]
    place = next((one.noun for one in reversed(before) if one.noun in ("plaza", "park")), "")
    kinds = [one.noun for one in before if one.noun in KINDS and is_plural(one.words[-1])]
    fronts = [one for one in before if one.get("slot") == "building.feature=shopfront"]
    if fronts and not kinds:
        kinds = ["shop"]
        fronts[-1].state = fronts[-1].state or READ
    if not own or any(one.state not in ("", READ) for one in own):
        return
    if place and kinds:
        found.add(f"{kinds[-1]}.by", place, *own)
    else:
        for one in own:
            one.state = READ
        found.leave_span((own[0].span[0], own[-1].span[1]), "where something is")
