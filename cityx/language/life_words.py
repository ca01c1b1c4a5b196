"""Life: what part of the vehicles or people is of a kind, how fast they go, what people have on."""

from __future__ import annotations

from collections.abc import Sequence

from cityx.language.here import KINDS_OF_PEOPLE, ROLES, Here
from cityx.language.scan import ENDS, Item
from cityx.language.scopes import NEGATED, READ

# Kinds of vehicles of which traffic can have a share.
MIXED = ("van", "truck", "bus", "motorcycle", "bicycle")
SERVICES = ("taxi", "police", "ambulance", "fire_engine", "snow_plough")
WITH_BEACONS = ("police", "ambulance", "fire_engine", "snow_plough")
_OF = {
    **dict.fromkeys(MIXED, "vehicle"),
    **dict.fromkeys(KINDS_OF_PEOPLE, "pedestrian"),
}  # kind -> what it is a share of
_MOSTLY = ("mostly", "mainly", "largely", "predominantly", "chiefly", "primarily", "most")
MOST = 0.5  # of the vehicles or people at least, of those that are mostly of a kind
_NEAR = 3  # items between a word for most and the kind
_ON_FOOT, _DRIVING = ("walk", "run"), ("drive", "ride")  # modes of people, and of vehicles
_RUNNER = "runner"
_WEARING = ("wear", "wears", "wearing", "dressed", "clad")
_HAVING = (
    "using", "in", "with", "pushing", "being", "are", "is", "should be", "be", "of", "a", "the",
    "them", "these", "those",
)  # fmt: skip


def read_mix(here: Here) -> None:
    """Read a share of the vehicles or people with the kind that it is of."""
    item = here.item
    if item.text in _MOSTLY:
        kind = _kind(here.items[here.at + 1 : here.at + 1 + _NEAR])
        if kind is not None:
            here.found.add(f"{kind.noun}.share.min", MOST, item, kind)
        return
    quantity = item.quantity
    if quantity is not None and quantity.dimension == "count":
        _read_outnumbering(here)
        if here.item.quantity is None:
            return
        _read_one_to(here)
        _read_one_in(here)
    if quantity is None or quantity.dimension not in ("share", "part"):
        return
    behind = _clause_behind(here)
    if not any(one.noun in _OF for one in behind):
        _read_part_of_all(here, behind)
        first = next((one for one in behind if one.noun), None)
        runs = next((one for one in behind if one.get("mode") == "run"), None)
        if runs is not None and first is not None and first.noun == "pedestrian":
            here.found.add_bounded(f"{_RUNNER}.share", quantity, item, runs)
            first.state = first.state or READ
        elif not item.state and first is not None and first.noun in _OF.values():
            here.found.leave(item, f"a part of the {here.found.said(first)}")
        return
    kind = _kind(behind)
    whole = None if kind is None else next(
        (one for one in behind if one.noun == _OF[kind.noun]), None
    )  # fmt: skip
    if kind is None or (whole is None and behind[0] is not kind and behind[0].get("rel") != "of"
                        and not _is_of_people(here, behind, kind)):  # fmt: skip
        return
    if any(one.has("noun") and one not in (kind, whole) for one in behind[: behind.index(kind)]):
        return  # "half of the houses have trucks before them"
    here.found.add_bounded(f"{kind.noun}.share", quantity, item, kind)
    for one in behind[: behind.index(kind)]:
        one.state = one.state or (READ if one is whole or one.text in _HAVING else "")


def _read_one_to(here: Here) -> None:
    """Read "one lorry to every ten cars" as the share that lorries have of both."""
    behind = here.items[here.at + 1 : here.at + 6]
    kind = behind[0] if behind else None
    link = behind[1].text if len(behind) > 3 else ""
    if kind is None or link not in ("to", "for", "per"):
        return
    whole = _OF.get(kind.noun, "")
    other = (
        next((one for one in behind[2:] if one.noun == whole), None)
        if whole
        else next((one for one in behind[2:] if _OF.get(one.noun) == kind.noun), None)
    )  # "two cars for every | bicycle"
    if other is None:
        return
    between = behind[1 : behind.index(other)]
    each = any(one.get("rel") == "every" or one.text in ("every", "each") for one in between)
    counts = [one.quantity for one in between if one.quantity is not None]
    own, of = here.quantity.exact, counts[0].exact if counts else 1.0
    if not own or not of or not (each or link == "per"):
        return
    rare, of_all = (kind, own) if whole else (other, of)
    share = round(of_all / (own + of), 4)
    about = here.items[max(0, here.at - 1) : here.at]
    approx = [one for one in about if one.has("approx")]
    here.found.add(f"{rare.noun}.share", share, here.item, kind, other, *approx)
    for one in between:
        one.state = READ


_MORE_THAN = ("outnumber", "outnumbers", "outnumbering")


def _read_outnumbering(here: Here) -> None:
    """Read "cyclists outnumber cars | three to one" as the share that they have of both."""
    before, quantity = here.before_in_clause(), here.quantity
    verb = next((at for at, one in enumerate(before) if one.text in _MORE_THAN), 0)
    if not verb or not quantity.low or not quantity.high or "to" not in here.item.words:
        return
    more = [one for one in before[:verb] if one.noun in _OF]
    fewer = [one for one in before[verb:] if more and one.noun in (*_OF, _OF[more[-1].noun])]
    if not fewer:
        return
    share = round(quantity.high / (quantity.high + quantity.low), 4)
    here.found.add(f"{more[-1].noun}.share", share, here.item, more[-1])
    for one in (before[verb], fewer[0]):
        one.state = READ
    here.item.quantity = None


def _read_one_in(here: Here) -> None:
    """Read "one person in eight is a child"."""
    behind = here.items[here.at + 1 : here.at + 9]
    if len(behind) < 4 or behind[0].noun not in _OF.values() or behind[1].get("rel") != "in":
        return
    of, own = behind[2].quantity, here.quantity.exact
    kind = _kind(behind[3:])
    if of is None or of.dimension != "count" or not of.exact or own is None or own >= of.exact:
        return
    if kind is None or _OF[kind.noun] != behind[0].noun:
        here.found.leave(here.item, f"a part of the {here.found.said(behind[0])}")
    else:
        here.found.add(f"{kind.noun}.share", own / of.exact, here.item, kind)
    for one in behind[: 3 if kind is None else behind.index(kind)]:
        one.state = one.state or READ


def _is_of_people(here: Here, behind: Sequence[Item], kind: Item) -> bool:
    """Return whether a part is of people who were told: "300 people, a tenth | with prams"."""
    told = any(one.noun == "pedestrian" for one in here.items[: here.at])
    between = behind[: behind.index(kind)]
    return _OF[kind.noun] == "pedestrian" and told and all(one.text in _HAVING for one in between)


def _read_part_of_all(here: Here, behind: list[Item]) -> None:
    """Read "buses make up | 20 % of the traffic"."""
    whole = next((one for one in behind if one.noun in ("vehicle", "pedestrian")), None)
    before = [] if whole is None else [
        one for one in here.before_in_clause() if _OF.get(one.noun) == whole.noun
    ]  # fmt: skip
    linked = (bool(behind) and behind[0].get("rel") == "of") or here.item.text.endswith("of")
    if whole is None or not before or not linked or here.quantity is None:
        return
    kind = before[-1]
    here.found.add_bounded(f"{kind.noun}.share", here.quantity, here.item, kind, whole)
    for one in here.before_in_clause():
        if one.span > kind.span and one.text in _MAKE_UP:
            one.state = one.state or READ


_MAKE_UP = ("make", "make up", "up", "making up", "account for", "being", "are")


def _kind(items: Sequence[Item]) -> Item | None:
    for item in items:
        if item.is_mark(ENDS):
            return None
        if item.noun in _OF and item.state in ("", READ):
            return item
    return None


def _clause_behind(here: Here) -> list[Item]:
    """Return the items behind, to the next mark or word that begins another phrase."""
    found: list[Item] = []
    for item in here.items[here.at + 1 :]:
        if item.is_mark(ENDS + ",") or item.quantity is not None or item.state == NEGATED:
            break
        found.append(item)
    return found


def read_clothes(here: Here) -> None:
    """Read what people have on: "workers in | hi-vis", "children wearing | high-vis vests"."""
    worn = here.item.get("wears")
    if not worn:
        return
    who = next((one for one in reversed(here.before_in_clause()) if one.noun), None)
    if who is None or who.noun_class != "person" or who.state == NEGATED:
        here.found.leave(here.item, "clothes of what is not said")
        return
    counted = who.noun in (*KINDS_OF_PEOPLE, *ROLES, "man", "woman")
    here.found.add(f"{who.noun if counted else 'pedestrian'}.wears", worn, here.item)
    for one in here.before_in_clause():
        one.state = one.state or (READ if one.text in _WEARING else "")
    if not counted:
        here.found.add("pedestrians", "medium", who)


def _before_in_sentence(here: Here) -> list[Item]:
    """Return the items before this one in its sentence."""
    first = here.at
    while first and not here.items[first - 1].is_mark(ENDS):
        first -= 1
    return list(here.items[first : here.at])


def _last_and(items: Sequence[Item]) -> int:
    """Return where the part behind the last "and" of some items begins."""
    joined = [at for at, one in enumerate(items) if one.get("rel") == "and"]
    return joined[-1] if joined else 0


def read_march(here: Here) -> None:
    """Read "protesters | march to the church", which is no month."""
    before = here.before
    if here.item.text == "march" and before is not None and before.noun_class == "person":
        here.item.senses = (("mode", "walk"),)


def read_beacons(here: Here) -> None:
    """Read the blue lights of the vehicles that have some: "a police car with | blue lights on"."""
    if not here.item.has("beacons"):
        return
    before = _before_in_sentence(here)
    movers = [one for one in before if one.noun_class == "vehicle"]
    who = movers[-1] if movers else None
    if who is None or who.noun not in WITH_BEACONS or who.state == NEGATED:
        here.found.leave(here.item, "lights of what is not said")
        return
    for one in movers:  # "an ambulance and two fire engines with | blue lights"
        if one.noun in WITH_BEACONS and one.state != NEGATED:
            here.found.add(f"{one.noun}.beacons", here.item.get("beacons"), here.item)


_GOING = (
    "going", "go", "goes", "coming", "come", "comes", "run", "runs", "running", "off", "drive",
    "drives", "driving", "heading", "heads", "rushing", "rushes", "travelling", "travels",
)  # fmt: skip
_LEAVES = ("leave", "leaves", "leaving", "exit", "exiting")
EVERYBODY = ("everybody", "everyone")


def read_everybody(items: Sequence[Item]) -> None:
    """Read "everybody" before what people do on their way as people: "everybody | walks to"."""
    for at, item in enumerate(items[:-2]):
        goes = items[at + 1].has("mode") or items[at + 1].text in (*_GOING, *_LEAVES)
        out = items[at + 2].words[0] in ("out", "off", "away")  # "heading out of town"
        if item.text in EVERYBODY and goes and not out:
            item.kind, item.senses = "phrase", (("noun", "person:pedestrian"),)


_REACH = 4  # items between where people go and what it is


def leave_ways(here: Here) -> None:
    """Leave open where people or vehicles go to or come from; what it is stays asked for.

    "Children walk | to the school", "500 people | leave the square".
    """
    item, before = here.item, here.before
    if before is None or not (item.get("rel") == "to" or item.text in ("from", "out of", *_LEAVES)):
        return
    begun = _before_in_sentence(here)
    who = next((one for one in reversed(begun) if one.noun_class in ("person", "vehicle")), None)
    if who is None or who.state == NEGATED or who.noun in ("parked_vehicle", "boat"):
        return
    told = [one for one in begun if one.span > who.span]
    if any(one.noun for one in told[_last_and(told) :]):
        return
    goes = before.text in _GOING or item.text in _LEAVES or any(one.has("mode") for one in told)
    if not goes and before is not who and not before.has("wears"):
        return
    behind = here.items[here.at + 1 : here.at + 1 + _REACH]
    end = next((at for at, one in enumerate(behind) if one.noun), -1)
    if end < 0 or any(one.kind == "mark" or one.kind == "unknown" for one in behind[:end]):
        return
    if behind[end].noun_class not in ("element", "type", "road", "building"):
        return
    item.state = READ
    span = (item.span[0], behind[end].span[1])
    here.found.leave_span(span, f"where the {here.found.said(who)} go")


def goes_at(here: Here, noun: Item | None) -> str:
    """Return the kind of people or vehicles that a speed is of, "" for those of all roads.

    "500 pedestrians leave the square, walking | 1.3 m/s".
    """
    for one in reversed(here.before_in_clause()):
        if one.get("mode") in _DRIVING and noun is not None and noun.noun_class == "road":
            driven = (who.noun for who in here.before_in_clause() if who.span < one.span)
            return next((who for who in driven if who in (*MIXED, *SERVICES)), "vehicle")
        if one.get("mode") in _ON_FOOT:
            return (
                "pedestrian"
                if noun is None or noun.noun not in (*KINDS_OF_PEOPLE, *ROLES)
                else noun.noun
            )
        if (one.noun and one.noun_class != "road") or one.quantity is not None:
            break
    if noun is None:
        return ""
    if noun.noun in (*KINDS_OF_PEOPLE, *ROLES, *MIXED, *SERVICES):
        return noun.noun
    return "pedestrian" if noun.noun_class == "person" else ""
