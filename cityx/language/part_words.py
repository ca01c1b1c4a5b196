"""Part words: parts of buildings with what is said of them: "a mosque with two white minarets".

They are read before all else, so that a number, height or colour of a part is not put on its
building or on all of them. What is said of some hosts alone, or of what has no such part, is left
to the other rules, which name it.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from cityx.language.here import Findings
from cityx.language.lexicon.words import forms_of
from cityx.language.measurable import COLORS, MATERIALS
from cityx.language.scan import ENDS, Item, begin_of, end_of
from cityx.language.scopes import NEGATED, READ
from cityx.language.syntax import is_plural
from cityx.town.elements import ELEMENTS
from cityx.town.part_kinds import HOSTS, PART_KINDS
from cityx.town.quarter_kinds import DWELLINGS, HOUSES

LONGEST = 3  # items of the name of a part
TALL = 30.0  # metres of a tall tower, spire, minaret or chimney, at least
_HAVING = (
    "with", "has", "have", "having", "featuring", "boasting", "sporting", "bearing", "crowned by",
    "topped by", "crowned with", "topped with", "flanked by", "gets", "get", "needs", "carries",
)  # fmt: skip
_TOPPED, _BY = ("crowned", "topped", "capped", "surmounted", "flanked", "fitted"), ("by", "with")
_ON = ("on", "on top of", "atop", "of", "crowning", "over", "above", "to")
_WITHOUT = ("without", "no", "lacking", "minus")
_WHOSE = ("its", "their", "whose")
_SOME = ("some", "half", "most", "many", "few", "several", "one of", "any", "either", "third")
_PAIRS = ("twin", "pair", "pair of", "a pair of")
_OF = ("of", "in", "made of", "made from", "out of")
_TALL = ("tall", "high", "soaring", "towering", "lofty", "tallest")
_SHAPED = ("domed", "spired", "towered", "turreted", "steepled")
_ADJECTIVES = (
    "slender", "slim", "pointed", "ornate", "big", "great", "grand", "large", "small", "little",
    "squat", "round", "square", "onion", "old", "single", "central", "narrow", "thin", "wide",
    "stout", "striped", "gothic", "baroque",
)  # fmt: skip
_AWAY = (
    "from", "off", "away", "apart", "behind", "beyond", "past", "before", "down", "inland", "out",
    "outside", "up", "along", "into", "to", "upstream", "downstream",
)  # fmt: skip
_MEASURED = ("count", "length", "area")
_BEING = tuple((word,) for word in (
    "is", "are", "be", "that", "which", "must", "at", "should", "being", "was", "were",
))  # fmt: skip
_SKIPPED = ("a", "an", "the", "one", "each", "own", "its", "their", "also", "at", "least", "both")
_WORDS = {tuple(word.split()): name for name, kind in PART_KINDS.items() for word in kind.words}
# Of what most buildings are, parts are features of all: "houses with balconies".
_COMMON = (*HOUSES, "house")


@dataclass(frozen=True)
class _Found:
    """A part that is named: items from `first` to before `end`, and which part it is."""

    first: int
    end: int
    part: str


def read_parts(found: Findings, items: Sequence[Item]) -> None:
    """Read the parts of buildings that are named, with what is said of them."""
    for one in _named(items):
        host = _host(items, one)
        if host is None:
            host = _owner(found.text, items, one)
            if host is not None and items[host].noun in ELEMENTS:
                found.add("element", items[host].noun, items[host])
        if host is not None:
            _take(found, items, one, host)
        else:
            _leave_unknown(found, items, one)
    _shaped(found, items)


def _named(items: Sequence[Item]) -> Iterator[_Found]:
    at = 0
    while at < len(items):
        one = _part_at(items, at)
        if one is not None:
            yield one
        at = at + 1 if one is None else one.end


def _part_at(items: Sequence[Item], at: int) -> _Found | None:
    """Return the part whose name begins at an item, of the longest name."""
    for count in range(min(LONGEST, len(items) - at), 0, -1):
        own = items[at : at + count]
        if any(one.quantity is not None or one.is_mark(ENDS + ",:") for one in own):
            continue
        words = tuple(word for one in own for word in one.text.replace("-", " ").split())
        if len(words) > 1 and words[0] in ("church", *_TALL):
            words = words[1:]
        for form in forms_of(words[-1]) if words else ():
            if (name := _WORDS.get((*words[:-1], form))) is not None:
                return _Found(at, at + count, name)
    return None


def _may_have(noun: str, part: str) -> bool:
    """Return whether buildings of a kind may have a part that is theirs alone."""
    if noun not in HOSTS:
        return False
    if PART_KINDS[part].plot:
        return noun in (*_COMMON, "terrace")
    volume = bool(PART_KINDS[part].body)
    if volume or part == "clock":
        return noun not in (*DWELLINGS, "office", "shop") and noun != part
    return noun not in _COMMON


def _is_host(item: Item, part: str) -> bool:
    return item.has("noun") and item.noun_class == "type" and _may_have(item.noun, part)


def _start(items: Sequence[Item], first: int) -> int:
    """Return where the phrase of a part begins: its articles, numbers, colours, adjectives."""
    at = first
    while at > 0:
        one = items[at - 1]
        if one.text == "of" and at > 1 and _is_an_area(items[at - 2]):
            at -= 2
            continue
        measure = one.quantity is not None and one.quantity.dimension in _MEASURED
        described = one.has("color", "material", "height", "size", "shade", "width", "strength")
        plain = one.text in (*_SKIPPED, *_PAIRS, *_ADJECTIVES, *_TALL) or one.is_mark("-")
        described = described and one.get("rel") in ("", "green")
        described = described or one.get("slot").startswith("building.roof=")  # "a slate | spire"
        pair = one.text == "of" and at > 1 and items[at - 2].text == "pair"
        garage = one.text == "car" and items[first].text.startswith("garage")
        listed = one.is_mark(",") and at < first and at > 1 and _only_describes(items[at - 2])
        if not (measure or plain or described or pair or garage or listed):
            break
        adjective = one.has("material") or one.text in _ADJECTIVES  # "a square | minaret"
        if one.has("noun") and not (adjective or garage):
            break
        at -= 1
    return at


def _only_describes(item: Item) -> bool:
    """Return whether a word before a comma says how a part is: "a tall, | pointed spire"."""
    looks = item.has("color", "height", "size", "shade", "width") and not item.has("noun")
    return looks or item.text in (*_ADJECTIVES, *_TALL)


def _has(link: Item) -> bool:
    """Return whether a word says that something has a part: "with", "must have"."""
    return link.text in _HAVING or link.words[-1:] in (("has",), ("have",), ("having",))


def _is_an_area(item: Item) -> bool:
    return item.quantity is not None and item.quantity.dimension == "area"


def _host(items: Sequence[Item], one: _Found) -> int | None:
    """Return the item of the building that a part is of, None where none is told."""
    start = _start(items, one.first)
    link = items[start - 1] if start else None
    behind = items[one.end] if one.end < len(items) else None
    listed = start == 0 or link is None or link.is_mark(",:+") or link.get("rel") == "and"
    if PART_KINDS[one.part].plot and listed and items[one.first].text not in ("garden", "gardens"):
        return _before(items, start, one.part)
    if behind is not None and (behind.text in _ON or behind.get("rel") in ("on", "of")):
        end = end_of(items, one.end, ENDS + ",")
        head = next((k for k in range(one.end + 1, min(one.end + 5, end)) if items[k].noun), None)
        if head is not None and any(_breaks(item) for item in items[one.end + 1 : head]):
            head = None  # "a garden of | 200 m2 and houses"
        if head is not None and _is_host(items[head], one.part):
            items[one.end].state = items[one.end].state or READ
            return head
    if link is not None and (_has(link) or (link.text in _BY and start > 1 and (
            items[start - 2].text in _TOPPED))):  # fmt: skip
        return _before(items, start - 1, one.part)
    if link is not None and (link.text in _WITHOUT or link.get("neg")):
        return _before(items, start - 1, one.part)
    if link is not None and (link.get("rel") == "and" or link.is_mark(",")):
        other = _part_ending(items, start - 1)
        if other is not None:
            return _host(items, other)
    if any(k.text in _WHOSE for k in items[start : one.first]) or (
        link is not None and link.text in _WHOSE
    ):
        return _before(items, start, one.part, far=True)
    return None


def _breaks(item: Item) -> bool:
    """Return whether a word stands between "of" and a noun behind it that is of something else."""
    measure = item.quantity is not None and item.quantity.dimension != "count"
    return measure or item.get("rel") == "and" or _has(item) or item.is_mark(",")


def _owner(text: str, items: Sequence[Item], one: _Found) -> int | None:
    """Return the item of "the mosque's | dome", None for others."""
    at = _start(items, one.first) - 1
    if at > 0 and items[at].text in ("'s", "'"):
        at -= 1
    if at < 0 or not _is_host(items[at], one.part):
        return None
    end = items[at].span[1]
    owned = text[:end].endswith(("'s", "’s")) or text[end : end + 1] in ("'", "’")
    return at if owned else None


def _leave_unknown(found: Findings, items: Sequence[Item], one: _Found) -> None:
    """Leave open a part of buildings that nobody knows: "two smelters with 45 m | chimneys"."""
    start = _start(items, one.first)
    if start < 2 or not _has(items[start - 1]) or not PART_KINDS[one.part].body:
        return
    head = items[start - 2]
    if head.kind != "unknown" or head.state:
        return
    for item in items[start : one.end]:
        if item.kind != "function" and not item.state:
            found.leave(item, f"part of the {found.said(head)}")


def _part_ending(items: Sequence[Item], end: int) -> _Found | None:
    """Return the part whose name, or what is told of it, ends before a link."""
    for back in range(end - 1, max(end - 6, -1), -1):
        if items[back].is_mark(ENDS):
            return None
        one = _part_at(items, back)
        if one is not None and one.end <= end:
            return one
    return None


def _before(items: Sequence[Item], at: int, part: str, *, far: bool = False) -> int | None:
    """Return the last building before a link in its sentence that may have a part."""
    first = 0 if far else begin_of(items, at, ENDS)
    for k in range(at - 1, first - 1, -1):
        one = items[k]
        if k == at - 1 and one.has("noun") and one.noun_class == "element" and _listed(items, k):
            return None  # "a church and a fountain | with a dome"
        if one.has("noun") and one.noun_class in ("type", "building"):
            told = _told(items, k)
            some = any(own.text in _SOME or own.get("rel") in _SOME for own in told)
            share = any(
                own.quantity is not None and own.quantity.dimension in ("share", "part")
                for own in told
            )
            return None if some or share or not _is_host(one, part) else k
    return None


def _listed(items: Sequence[Item], at: int) -> bool:
    """Return whether a noun is the last of a list: "a church and a fountain"."""
    first = _start(items, at)
    return first > 0 and (items[first - 1].get("rel") == "and" or items[first - 1].is_mark(","))


def _told(items: Sequence[Item], at: int) -> Sequence[Item]:
    """Return what stands before a noun in its phrase, a few items at most."""
    first = at
    while first > max(at - 4, 0) and not items[first - 1].is_mark(ENDS + ",:"):
        first -= 1
        if items[first].has("noun") or items[first].text in ("with", "and", "in", "on"):
            return items[first + 1 : at]
    return items[first:at]


def _take(found: Findings, items: Sequence[Item], one: _Found, host: int) -> None:
    """Add the slots of a part: how many, how high, of which colour and material."""
    kind, noun = PART_KINDS[one.part], items[host].noun
    key = f"{noun}.{one.part}"
    start = _start(items, one.first)
    phrase = list(items[start : one.end])
    if any(item.state not in ("", READ, NEGATED) for item in phrase):
        return
    link = items[start - 1] if start else None
    denied = items[one.end - 1].state == NEGATED or (
        link is not None and (link.text in _WITHOUT or link.has("neg"))
    )
    named = items[one.first : one.end]
    if denied:
        _settle([*named, *phrase])
        for item in named:
            item.state = READ
        found.add(f"{key}.count", 0, *named)
        return
    told = [*phrase, *_behind(items, one.end)]
    counted = False
    for item in told:
        amount = item.quantity
        if amount is not None and amount.dimension == "count" and item in phrase and not kind.plot:
            found.add_bounded(f"{key}.count", amount, item, *named)
            counted = True
        elif item.text in _PAIRS:
            found.add(f"{key}.count", 2, item, *named)
            counted = True
        elif amount is not None and amount.dimension == "area" and kind.plot:
            found.add_bounded(f"{key}.area", amount, item)
        elif amount is not None and amount.dimension == "length" and kind.body:
            found.add_bounded(f"{key}.height", amount, item)
        elif item.text in _TALL and item in phrase and kind.body and one.part != "dome":
            if not any(own.quantity and own.quantity.dimension == "length" for own in told):
                found.add(f"{key}.height.min", TALL, item)
        elif item.get("color") in COLORS and item.get("color"):
            found.add(f"{key}.color", item.get("color"), item)
        elif item.get("material") in MATERIALS and kind.body:
            found.add(f"{key}.material", item.get("material"), item)
        elif item.text in ("single",):
            found.add(f"{key}.count", 1, item, *named)
            counted = True
        elif item in phrase[: one.first - start] and item.kind != "function" and (
            item.text not in (*_SKIPPED, *_OF) and not item.is_mark("-,") and not item.state
        ):  # fmt: skip
            found.leave(item, f"look of the {one.part.replace('_', ' ')}")
    words = items[one.first].words
    if len(words) > 1 and words[0] in _TALL and kind.body and one.part != "dome":
        found.add(f"{key}.height.min", TALL, items[one.first])
    if not counted:
        many = is_plural(items[one.end - 1].words[-1]) and bool(kind.body)
        each = is_plural(items[host].words[-1])
        found.add(f"{key}.count.min", 2 if many and not each else 1, *named)
    _settle(told)
    if link is not None and (
        _has(link) or link.text in (*_BY, *_WHOSE) or link.get("rel") == "and"
    ):
        link.state = link.state or READ
        if link.text in _BY and items[start - 2].text in _TOPPED:
            items[start - 2].state = items[start - 2].state or READ
    for word in (*items[max(host - 2, 0) : host], *items[host:start]):
        if word.text in ("each", "every", "all") or word.get("rel") == "every":
            word.state = word.state or READ


def _settle(told: Sequence[Item]) -> None:
    for item in told:
        if item.kind in ("function", "mark") or item.text in (*_SKIPPED, *_OF) or item.has("rel"):
            item.state = item.state or READ


def _behind(items: Sequence[Item], end: int) -> list[Item]:
    """Return what is said of a part behind it: "of 30 m", "35 m high", "of copper"."""
    told: list[Item] = []
    at = end
    if at < len(items) and items[at].text in (*_OF, "about", "around", ","):
        at += 1
    elif at < len(items) and items[at].words[-1:] in _BEING:
        while at < len(items) and items[at].words[-1:] in _BEING:
            at += 1
    while at < len(items):
        one = items[at]
        length = one.quantity is not None and one.quantity.dimension in ("length", "area")
        length = length and not _lies_away(items, at + 1)
        look = (one.has("color") or one.has("material")) and one.get("rel") in ("", "green")
        look = look and not (one.has("color") and is_plural(one.words[-1]))  # "of | roses"
        thing = at + 1 < len(items) and items[at + 1].has("noun") and not items[at].has("noun")
        joined = bool(told) and one.get("rel") == "and" and at + 1 < len(items)
        if joined and (items[at + 1].quantity is not None or items[at + 1].has("color")):
            at += 1
            continue
        if not (length or (look and not thing)):
            break
        told.append(one)
        at += 1
        if at < len(items) and items[at].text in ("tall", "high", "in height"):
            told.append(items[at])
            at += 1
            break
    return [*items[end : at if told else end]]


def _lies_away(items: Sequence[Item], at: int) -> bool:
    """Return whether a length before is a distance: "40 m | from the river", "50 m | north of"."""
    after = items[at] if at < len(items) else None
    return after is not None and (
        after.text in _AWAY or after.get("rel") in ("from", "near", "behind") or after.has("side")
    )


def _shaped(found: Findings, items: Sequence[Item]) -> None:
    """Read "a domed mosque" and "a twin-towered cathedral"."""
    for at, item in enumerate(items):
        word = item.text if item.text in _SHAPED else ""
        if not word or item.state:
            continue
        behind = items[at + 1 : at + 4]
        host = next((one for one in behind if one.has("noun")), None)
        part = next((name for form in forms_of(word) if (name := _WORDS.get((form,)))), "")
        if word == "turreted":
            part = "tower"
        if host is None or not part or not _is_host(host, part):
            continue
        twin = at > 0 and (items[at - 1].text in _PAIRS or (
            items[at - 1].is_mark("-") and at > 1 and items[at - 2].text in _PAIRS))  # fmt: skip
        more = [one for one in items[max(at - 2, 0) : at] if one.text in _PAIRS]
        key = f"{host.noun}.{part}.count"
        if twin:
            found.add(key, 2, item, *more)
        else:
            found.add(f"{key}.min", 1, item)


def read_walls(found: Findings, items: Sequence[Item]) -> None:
    """Read whether houses stand alone or in pairs: "semis", "all detached".

    Those of some kinds each, or of a map, are left open.
    """
    named: dict[int, str] = {}
    houses = [one for one in items if one.noun in (*HOUSES, "house") and one.state != NEGATED]
    for at, item in enumerate(items):
        words = {form for word in item.words for form in forms_of(word)}
        bare = item.kind == "unknown" and item.text == "detached" and not item.state
        if not (item in houses or (bare and houses and _of_houses(items, at, houses))):
            continue
        if "semi" in words:
            named[at] = "semi"
        elif "detached" in words:
            named[at] = "detached"
    alone = len(set(named.values())) == 1 and not found.mapped
    alone = alone and len({item.noun for item in houses}) == 1
    alone = alone and not any(item.noun == "terrace" for item in items)
    for at, walls in named.items():
        state = items[at].state
        if alone:
            found.add("house.walls", walls, items[at])
        else:
            found.leave(items[at], "walls that they share with others")
        if items[at].kind != "unknown":
            items[at].state = state


def _of_houses(items: Sequence[Item], at: int, houses: Sequence[Item]) -> bool:
    """Return whether "detached" is said of houses: "detached brick villas", "all | detached"."""
    for item in items[at + 1 :]:
        if item.noun:
            return item in houses
        if item.kind in ("mark", "unknown") or item.has("rel", "neg"):
            break
    if at + 1 < len(items) and items[at + 1].kind == "unknown":
        return False  # "a detached | belfry"
    begun = items[begin_of(items, at, ENDS) : at]
    last = next((item for item in reversed(begun) if item.noun), None)
    return last is not None and last in houses


def settle_walls(found: Findings) -> None:
    """Leave open which walls houses share that are not asked for, or are those of one place."""
    kinds = (*HOUSES, "house")
    asked = any(slot.key == "building.type" and slot.value in kinds for slot in found.slots)
    asked |= any(slot.key.startswith(f"{kind}.count") for slot in found.slots for kind in kinds)
    places = [f"{kind}.{where}" for kind in kinds for where in ("part", "by")]
    placed = any(slot.key in places for slot in found.slots)
    for slot in [one for one in found.slots if one.key == "house.walls"]:
        if placed or not asked:
            found.slots.remove(slot)
            found.leave_span(slot.span, "walls that they share with others")
