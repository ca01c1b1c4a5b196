"""Relations: where one thing stands to another becomes slots of the thing."""

from __future__ import annotations

from cityx.language.here import BUILDINGS, Here
from cityx.language.lexicon.phrases import SPECIES
from cityx.language.lexicon.words import forms_of
from cityx.language.scan import ENDS, Item
from cityx.language.scopes import READ
from cityx.language.syntax import is_plural
from cityx.town.elements import ELEMENTS, NEAR, PLACES
from cityx.town.quarter_kinds import KINDS

# First words of a relation -> how a thing stands to the other; any other is near it.
_HOW = {
    "behind": "behind", "opposite": "opposite", "facing": "opposite", "in": "before",
    "around": "around", "surrounding": "around", "encircling": "around", "round": "around",
}  # fmt: skip
_HAVING = ("with", "has", "having", "featuring", "containing")
INTO = ("park", "plaza")  # what something stands in
_WITHIN = ("in", "inside", "within")
_AMID = (*_WITHIN, "amid", "amidst")
_HOLDS_ISLANDS = ("lake", "river", "sea")
# Relations of the buildings of a quarter, by their words.
_BESIDE = (
    "near", "along", "around", "round", "by", "beside", "next to", "facing", "lining", "flanking",
    "fronting", "surrounding", "alongside", "close to", "on", "overlooking", "encircling",
)  # fmt: skip
_WATERSIDE = ("river", "canal", "lake", "sea", "beach", "harbour", "plaza", "park", "main_street")
OUTSKIRTS = (
    "outskirts", "outskirt", "edge", "edges", "periphery", "fringe", "fringes", "perimeter", "rim",
)  # fmt: skip
_OF_HOUSES = ("roof", "window", "facade")
_PLACING = ("in", "on", "near", "along", "around", "by")
_ROWS = ("beside", "lining", "flanking", "alongside", "fringing", "surrounding", "encircling")
_SPECIES = {name: kind for kind, names in SPECIES.items() for name in (kind, *names)}
_THE_OTHERS = ("rest", "all", "every")
LINED = ("lined", "flanked", "surrounded", "framed", "fringed", "bordered", "enclosed", "edged")
_PARTS = {"middle": "center", "edge": "edge"}
_FAR = 5  # items from a relation to the place


def read_relation(here: Here, thing: Item | None, place: Item | None, *, how: str = "") -> bool:
    """Add the slots of a single thing that stands near, behind, in, ... a place or another thing.

    Returns
    -------
    read
        False where the words say more than can be built.
    """
    if not _fits(thing, place):
        return False
    assert thing is not None
    assert place is not None
    relation, first = here.item.get("rel"), (here.item.words or ("",))[0]
    if how:
        how = how if place.noun in INTO else ""
        if not how:
            return False
    elif relation == "near":
        how = _HOW.get(first, "near")
    elif relation == "around":
        how = relation
    elif relation == "along" and is_plural(thing.words[-1]):
        how = "near"
    elif relation == "on" and thing.noun == "helipad" and place.noun_class in BUILDINGS:
        how = "on"
    elif here.item.text in _WITHIN and place.noun in INTO:
        how = "in"
    elif here.item.text == "on" and place.noun in INTO:  # a church on a square faces it
        how = "in" if ELEMENTS[thing.noun].where == "square" else "near"
    else:
        return False
    several = is_plural(thing.words[-1])
    if several != (how == "around") and not (several and how == "near"):
        return False
    _add(here, thing, place, how)
    return True


def is_of_a_quarter(here: Here, thing: Item | None) -> bool:
    """Return whether buildings of a kind are named that a part of the town may consist of."""
    if thing is None or thing.noun_class != "type" or thing.noun not in KINDS:
        return False
    phrase = here.phrase_of(thing)
    counted = any(one.quantity is not None and one.quantity.dimension == "count" for one in phrase)
    denied = thing.state not in ("", READ) or any(one.has("neg") for one in phrase)
    return is_plural(thing.words[-1]) and thing.has("noun") and not counted and not denied


def has_own_looks(here: Here, owner: Item) -> bool:
    """Return whether looks of a head are its own: one thing, one kind of several, a quarter."""
    return here.of_one_thing(owner) or are_of_some(here, owner)


def are_of_some(here: Here, owner: Item) -> bool:
    """Return whether buildings are one kind of several, or those of a part of the town."""
    return here.of_some(owner) or stands_in_a_part(here, owner)


def stands_in_a_part(here: Here, thing: Item) -> bool:
    """Return whether buildings of a kind are those of a part: "brick | offices in the middle"."""
    if not is_of_a_quarter(here, thing):
        return False
    at = here.syntax.index(thing) + 1
    while at < len(here.items) and not here.items[at].is_mark(ENDS + ","):
        item = here.items[at]
        if item.get("rel") in _PLACING or item.words[0] in ("in", "at", "on", "along", "around"):
            return _is_a_part(here, at)
        own = item.noun in _OF_HOUSES or item.get("slot").startswith("building.roof")
        if (item.has("noun") and not own) or item.get("rel") == "and":
            return False
        at += 1
    return False


def _is_a_part(here: Here, at: int) -> bool:
    """Return whether a preposition stands before a part of the town or a place in it."""
    if here.items[at].noun == "center" or here.items[at].words[-1] in _PARTS:
        return True
    head = here.syntax.object_of(at)
    words = here.items[at + 1 : max(head + 1, at + 3)]
    if any(one.has("side") or one.noun == "center" or one.text in OUTSKIRTS for one in words):
        return True
    place = here.items[head] if head >= 0 else None
    known = place is not None and (place.noun in ELEMENTS or place.noun in PLACES)
    return known and here.items[at].get("rel") != "in" and any(one.text == "the" for one in words)


def read_quarter(here: Here, thing: Item | None, place: Item | None) -> bool:
    """Read along what buildings of a kind stand: "shops around the square".

    Returns
    -------
    read
        False where the words say more than can be built.
    """
    if place is None or not is_of_a_quarter(here, thing) or thing is None:
        return False
    if place.noun not in PLACES and place.noun not in ELEMENTS:
        return False
    words = here.item.text
    beside = words in _BESIDE or here.item.get("rel") in ("along", "around")
    if not beside or (words == "on" and place.noun not in _WATERSIDE):
        return False
    _add_quarter(here, thing, "by", place.noun)
    if place.noun_class == "road":
        place.state = place.state or READ
    return True


def read_row(here: Here, thing: Item | None, place: Item | None) -> bool:
    """Read along what trees stand: "poplars along the river", "trees around the pond"."""
    if thing is None or place is None or thing.noun_class != "plant":
        return False
    known = place.noun in PLACES or place.noun in ELEMENTS
    beside = here.item.get("rel") in ("along", "around") or here.item.text in _ROWS
    if not known or not beside or place.noun_class == "road" or thing.state not in ("", READ):
        return False
    kind = next((one for one in map(_SPECIES.get, forms_of(thing.text)) if one), "tree")
    here.found.add(f"{kind}.by", place.noun, here.item, thing)
    first = here.syntax.index(here.phrase_of(thing)[0])
    for one in here.items[max(0, first - 2) : first]:
        if one.text in ("row", "rows", "line", "lines", "row of", "rows of"):
            one.state = one.state or READ
    _leave_spacing(here)
    return True


def _leave_spacing(here: Here) -> None:
    """Leave open how far apart the trees of a row stand, which is no spacing along streets."""
    own = [one.span for one in here.items if one.span > here.item.span and one.quantity is not None]
    for slot in [one for one in here.found.slots if one.key.startswith("nature.spacing")]:
        if slot.span in own:
            here.found.slots.remove(slot)
            here.found.leave_span(slot.span, "spacing of the row")


def read_part(here: Here, thing: Item | None, side: str) -> bool:
    """Read in which part of the town buildings of a kind stand: "offices in the north"."""
    if thing is None or not is_of_a_quarter(here, thing):
        return False
    _add_quarter(here, thing, "part", _PARTS.get(side, side))
    return True


def read_lined(here: Here) -> bool:
    """Read "a square surrounded by shops" and "a street lined with houses and offices"."""
    lined = bool(here.item.words) and here.item.words[0] in LINED
    if not (lined or here.item.text == "with"):
        return False
    head = here.syntax.head_before(here.at, past_comma=True)
    place = here.items[head] if head >= 0 else None
    if not lined and (place is None or place.noun_class != "road"):
        return False  # "one main street | with shops"
    if place is None or (place.noun not in PLACES and place.noun not in ELEMENTS):
        return False
    at, read = here.at, False
    while at + 1 < len(here.items) and not here.items[at].is_mark(ENDS):
        at += 1
        phrase = here.syntax.phrase(at)
        thing = here.items[phrase.head] if phrase is not None and phrase.head == at else None
        if thing is None:
            continue
        if not is_of_a_quarter(here, thing):
            break
        _add_quarter(here, thing, "by", place.noun)
        read = True
    if read:
        for item in here.items[here.at + 1 : here.at + 2]:
            item.state = item.state or (READ if item.text in ("by", "with") else "")
    return read


def read_tallest(here: Here) -> bool:
    """Read "hotels taller than everything else" and "the town hall is the tallest building"."""
    item, behind = here.item, here.items[here.at + 1 : here.at + 5]
    if item.get("compared") == "height over":
        stops = (k for k, one in enumerate(behind)
                 if one.kind == "mark" or one.get("rel") in ("and", "with"))  # fmt: skip
        ends = next(stops, len(behind))
        others = [one for one in behind[:ends] if one.noun or one.get("rel") in _THE_OTHERS]
        all_of_them = any(one.noun == "everything" or one.get("rel") in _THE_OTHERS[:1]
                          for one in others)  # fmt: skip
        plain = all(one.noun in ("", "everything", "building", "house", "city") for one in others)
        read = others if others and all_of_them and plain else []
    elif item.get("rank") == "tallest" and any(
        one.get("rel") == "be" for one in here.before_in_clause()[-4:]
    ):
        whole = [one for one in behind[:1] if one.noun == "building"]
        read = [item, *whole] if whole or not behind or behind[0].kind == "mark" else []
    else:
        return False
    named = [one for one in here.before_in_clause() if one.has("noun")]
    thing = named[-1] if named else None
    built = thing is not None and thing.noun in ELEMENTS and bool(ELEMENTS[thing.noun].building)
    if not read or thing is None or not built or thing.state not in ("", READ):
        return False
    for one in read:
        one.state = one.state or READ
    here.found.add(f"{thing.noun}.height", "tallest", item)
    return True


def read_held(here: Here) -> None:
    """Add that a thing is at what has it: "a square with a fountain and a statue"."""
    thing = here.item
    if is_plural(thing.words[-1]):
        return
    at = here.syntax.index(here.phrase_of(thing)[0]) - 1
    while at > 1 and here.items[at].get("rel") == "and" and here.items[at - 1].has("noun"):
        if here.items[at - 1].noun not in ELEMENTS:
            return
        at = here.syntax.index(here.phrase_of(here.items[at - 1])[0]) - 1
    whole = here.syntax.head_before(at) if at > 0 and here.items[at].text in _HAVING else -1
    place = here.items[whole] if whole >= 0 else None
    if not _fits(thing, place) or place is None or is_plural(place.words[-1]):
        return
    if here.found.has(f"{thing.noun}.near") or place.state not in ("", READ):
        return
    inside = place.noun == "park" or ELEMENTS[thing.noun].where == "square"
    how = "in" if place.noun in INTO and inside else "near"
    here.found.add(f"{thing.noun}.near", place.noun, here.items[at], thing)
    if how != "near":
        here.found.add(f"{thing.noun}.relation", how, here.items[at], thing)


def _add_quarter(here: Here, thing: Item, key: str, value: str) -> None:
    """Add where most buildings are of a kind; then that kind is not what most of all are."""
    slots = here.found.slots
    slots[:] = [one for one in slots if (one.key, one.value) != ("building.type", thing.noun)]
    here.found.add(f"{thing.noun}.{key}", value, here.item, thing)


def read_island(here: Here, thing: Item | None, place: Item | None) -> bool:
    """Add the water that an island lies in; that of a town on an island is the sea."""
    if place is None:
        return False
    if thing is not None and thing.noun == "island":
        water = place.noun if here.item.text in _AMID and place.noun in _HOLDS_ISLANDS else ""
    else:
        town = thing is None or thing.has("slot")
        water = "sea" if town and here.item.text == "on" and place.noun == "island" else ""
    if water:
        here.found.add("island.near", water, here.item)
    return bool(water)


def read_between(here: Here, thing: Item | None) -> bool:
    """Read "between the church and the school" of a single thing."""
    nouns = [item for item in here.items[here.at + 1 : here.at + 1 + _FAR] if item.noun][:2]
    joined = any(item.get("rel") == "and" for item in here.items[here.at : here.at + _FAR])
    if here.item.text != "between" or len(nouns) < 2 or not joined or not _fits(thing, nouns[0]):
        return False
    assert thing is not None
    if not _fits(thing, nouns[1]) or is_plural(thing.words[-1]):
        return False
    _add(here, thing, nouns[0], "between")
    here.found.add(f"{thing.noun}.second", nouns[1].noun, here.item)
    return True


def read_distance(here: Here, thing: Item | None) -> bool:
    """Read "100 m from the station" of a single thing."""
    place = None
    for item in here.items[here.at + 1 : here.at + 1 + _FAR]:
        if item.is_mark(ENDS + ",") or item.quantity is not None:
            break
        if item.noun:
            place = item
            break
    if not _fits(thing, place) or thing is None or place is None or is_plural(thing.words[-1]):
        return False
    exact, high = here.quantity.exact, here.quantity.high
    if exact is None and (here.quantity.low is not None or (high or 0.0) < NEAR):
        return False
    away = [here.after] if here.after is not None and here.after.text == "away" else []
    here.found.add(f"{thing.noun}.near", place.noun, here.item, *away)
    if exact is not None:
        here.found.add(f"{thing.noun}.metres", exact, here.item)
    return True


def _fits(thing: Item | None, place: Item | None) -> bool:
    """Return whether a thing can be placed by another."""
    return (
        thing is not None and place is not None and thing.noun != place.noun
        and thing.noun in ELEMENTS and not ELEMENTS[thing.noun].builder
        and (place.noun in ELEMENTS or place.noun in PLACES)
    )  # fmt: skip


def _add(here: Here, thing: Item, place: Item, how: str) -> None:
    here.found.add(f"{thing.noun}.near", place.noun, here.item)
    if how != "near":
        here.found.add(f"{thing.noun}.relation", how, here.item)
