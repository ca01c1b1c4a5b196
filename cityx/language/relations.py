"""Relations: where one thing stands to another becomes slots of the thing."""

from __future__ import annotations

from dataclasses import replace

from cityx.language.counted_there import others_of
from cityx.language.here import BUILDINGS, Here
from cityx.language.lexicon.phrases import SPECIES
from cityx.language.lexicon.words import forms_of
from cityx.language.scan import ENDS, Item, begin_of
from cityx.language.scopes import READ
from cityx.language.syntax import Syntax, is_plural
from cityx.town.elements import ELEMENTS, HOMES, PLACES, Element, chosen_by
from cityx.town.quarter_kinds import KINDS

# First words of a relation -> how a thing stands to the other; any other is near it.
_HOW = {
    "behind": "behind", "opposite": "opposite", "across": "opposite", "over": "opposite",
    "facing": "opposite", "in": "before",
    "around": "around", "surrounding": "around", "encircling": "around", "round": "around",
}  # fmt: skip
_HAVING = ("with", "has", "having", "featuring", "containing")
# Along what something stands "on" it; the ends of what is long.
_FRONTS = (
    "pier", "harbour", "main_street", "avenue", "ring_road", "motorway", "river", "canal", "lake",
    "sea", "beach", "pond",
)  # fmt: skip
_GOES_ON = ("and", "or", "with", "but")
_NOWHERE = ("center", "city", "landscape")
ENDED = ("pier", "breakwater", "harbour", "main_street")
_SEAFRONTS = ("seafront", "waterfront", "seaside", "oceanfront", "shorefront")
_RIGHT_ON = ("on", "onto", "at")
_TIPS, _THE_END = ("end", "tip", "head"), ("the", "far", "very", "its", "outer", "seaward")
PLACED = ("element", "plant", "person", "vehicle", *BUILDINGS)  # classes of what is somewhere
INTO = ("park", "plaza")  # what something stands in
_WITHIN = ("in", "inside", "within")
_AMID = (*_WITHIN, "amid", "amidst")
_HOLDS_ISLANDS = ("lake", "river", "sea")
# Relations of the buildings of a quarter, by their words.
BESIDES = (
    "near", "along", "around", "round", "by", "beside", "next to", "facing", "lining", "flanking",
    "fronting", "surrounding", "alongside", "close to", "on", "overlooking", "encircling",
)  # fmt: skip
AT_FRONTS = ("river", "canal", "lake", "sea", "beach", "harbour", "plaza", "park", "main_street")
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
FAR = 5  # items from a relation to the place


def read_relation(here: Here, thing: Item | None, place: Item | None, *, how: str = "") -> bool:
    """Add the slots of a single thing that stands near, behind, in, ... a place or another thing.

    Returns
    -------
    read
        False where the words say more than can be built.
    """
    if not fits(thing, place):
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
    elif _is_right_there(here, thing, place):
        how = "at"
    elif here.item.text == "by" and here.before is thing:
        return read_beside(here, thing, place)
    elif here.item.text == "on" and place.noun in INTO:  # a church on a square faces it
        how = "in" if ELEMENTS[thing.noun].where == "square" else "near"
    else:
        return False
    key = f"{thing.noun}.near"
    if any(one.key == key and one.value != place.noun for one in here.found.slots):
        return False  # "on the corner | opposite the school"
    several = is_plural(thing.words[-1])
    if how == "at" and is_plural(place.words[-1]):
        return False  # "tables outside the restaurants"
    if several != (how == "around") and not (several and how in ("near", "at")):
        return False
    _add(here, thing, place, how)
    return True


def read_beside(here: Here, thing: Item, place: Item) -> bool:
    """Read "by": at a street or a water, near any other thing."""
    front = place.noun in _FRONTS
    if front and is_plural(place.words[-1]):
        return False
    _add(here, thing, place, "at" if front else "near")
    return True


def _is_right_there(here: Here, thing: Item, place: Item) -> bool:
    """Return whether a thing stands at a street, a quay or a building: "a pub | on the quay"."""
    if ELEMENTS[thing.noun].where == "water":
        return False
    if here.item.text == "outside":
        return place.noun in ELEMENTS and bool(ELEMENTS[place.noun].building)
    along = here.item.get("rel") == "along" and not is_plural(thing.words[-1])
    return (here.item.text in _RIGHT_ON or along) and place.noun in _FRONTS


def is_a_place(here: Here) -> bool:
    """Return whether a street is only where a thing stands: "a bakery on the | high street"."""
    first = here.syntax.index(here.phrase_of(here.item)[0])
    if not first or here.item.noun not in PLACES:
        return False
    link = replace(here, at=first - 1)
    if link.item.get("rel") == "of" and first > 1 and here.items[first - 2].text in _TIPS:
        return here.item.noun in ENDED and fits(thing_before(link), here.item)
    thing = owner_of_place(link, here.item)
    return fits(thing, here.item) and link.item.text in (*_RIGHT_ON, "along", "at")


def owner_of_place(here: Here, place: Item) -> Item | None:
    """Return the thing in the same clause that a place behind it is of.

    Of a thing with another one on a street it is the first: "a mall with a car park | on the road".
    """
    thing = thing_before(here)
    if thing is None or place.noun_class != "road":
        return thing
    first = here.syntax.index(here.phrase_of(thing)[0])
    head = here.syntax.head_before(first - 1) if first and _holds(here.items[first - 1]) else -1
    whole = here.items[head] if head >= 0 else None
    return whole if whole is not None and fits(whole, place) else thing


def thing_before(here: Here) -> Item | None:
    """Return the last thing before an item in the same clause.

    None where a number or "one" before it stands for another: "a stop here and one | at the inn".
    """
    if here.at and others_of(here.syntax, here.at - 1) >= 0:
        return None
    before = [item for item in here.clause()
              if item.span < here.item.span and item.noun_class in PLACED]  # fmt: skip
    if len(before) > 1 and here.before is not None and here.before.get("rel") == "and":
        first = here.syntax.index(here.phrase_of(before[-1])[0])
        if first and here.items[first - 1].get("rel") == "near":
            return before[-2]  # "a hotel opposite the inn and | next to the park"
    return before[-1] if before else None


def _holds(item: Item) -> bool:
    return item.text in _HAVING


def read_seafront(here: Here, thing: Item | None) -> bool:
    """Read "a museum on the seafront", where the words for a town by the sea are a place."""
    head = here.syntax.object_of(here.at)
    front = here.items[head] if head >= 0 else None
    built = thing is not None and thing.noun in ELEMENTS and bool(ELEMENTS[thing.noun].building)
    if front is None or front.words[-1] not in _SEAFRONTS or thing is None or not built:
        return False
    if front.get("slot") != "district=coastal" or is_plural(thing.words[-1]):
        return False
    here.found.add(f"{thing.noun}.near", "sea", here.item, thing)
    here.found.add(f"{thing.noun}.relation", "at", here.item, thing)
    return True


def is_it(here: Here, at: int) -> bool:
    """Return whether "it" stands somewhere and ends what is said: "next to it", no "it all"."""
    own = here.items[at : at + 2]
    if not own or own[0].text != "it":
        return False
    return len(own) == 1 or own[1].kind == "mark" or own[1].get("rel") in _GOES_ON


def held_by(here: Here, thing: Item) -> Item | None:
    """Return what has the houses that stand at it: "a | pond with offices round it"."""
    first = here.syntax.index(here.phrase_of(thing)[0])
    if not first or not _holds(here.items[first - 1]) or not is_of_a_quarter(here, thing):
        return None
    head = here.syntax.head_before(first - 1)
    place = here.items[head] if head >= 0 else None
    known = place is not None and (place.noun in PLACES or place.noun in ELEMENTS)
    return place if place is not None and known and not is_plural(place.words[-1]) else None


def antecedent(here: Here, thing: Item, *, ended: bool = False) -> Item | None:
    """Return what "it" is, where a thing stands at it: "a square, and a church next to | it".

    The last single place or thing before, unless that is one that another has; then "it" may be
    either. Of what has an end, it is the last.
    """
    first = here.syntax.index(here.phrase_of(thing)[0])
    for at in range(first - 1, -1, -1):
        item = here.items[at]
        if item.is_mark(ENDS):
            return None
        if not item.has("noun") or item.noun == thing.noun or here.syntax.modifies(at) >= 0:
            continue
        if item.noun in _NOWHERE or (ended and item.noun not in ENDED):
            continue
        if item.noun_class == "road" and not ended:
            continue  # "a chapel on the high street and a bakery opposite | it"
        begins = here.syntax.index(here.phrase_of(item)[0])
        holder = here.syntax.head_before(begins - 1) if begins else -1
        held = begins > 0 and _holds(here.items[begins - 1])
        held = held and holder >= 0 and fits(thing, here.items[holder])
        known = fits(thing, item) and item.state in ("", READ) and not is_plural(item.words[-1])
        return item if known and (ended or not held) else None
    return None


def read_end(here: Here, thing: Item | None) -> bool:
    """Read "a lighthouse at the | end of the pier" and "a pier with a lighthouse at the | end"."""
    if thing is None or is_plural(thing.words[-1]) or here.item.text not in _TIPS:
        return False
    if not (here.before is not None and here.before.text in _THE_END):
        return False
    after = here.after
    if after is None or after.kind == "mark" or after.get("rel") in ("and", "with"):
        place, last = antecedent(here, thing, ended=True), []
    elif after.get("rel") != "of":
        return False
    else:
        behind = here.items[here.at + 2 : here.at + 5]
        told = next((one for one in behind if one.noun or one.text == "it"), None)
        if told is None:
            return False
        place = antecedent(here, thing, ended=True) if told.text == "it" else told
        last = [after, told]
    if place is None or place.noun not in ENDED or not fits(thing, place):
        return False
    for item in (here.before, *last):
        item.state = item.state or READ
    here.found.add(f"{thing.noun}.near", place.noun, here.item)
    here.found.add(f"{thing.noun}.relation", "end", here.item)
    return True


def read_corner(here: Here, thing: Item | None) -> bool:
    """Read "a pub on the corner" and "a bakery at a street | corner"."""
    first = here.syntax.index(here.phrase_of(here.item)[0])
    link = here.items[first - 1] if first else None
    told = here.items[first : here.at]
    plain = all(one.kind == "function" or one.noun_class == "road" for one in told)
    of = here.after is not None and here.after.get("rel") == "of"
    if here.item.text != "corner" or of or link is None or link.text not in _RIGHT_ON or not plain:
        return False
    both = first > 1 and here.items[first - 2].text in ("both", "each")
    things = _listed_before(here, first - 2) if both else [] if thing is None else [thing]
    if not things or not all(map(_may_stand_at_a_corner, things)):
        return False
    for one in (link, *told, *here.items[first - 2 : first - 1][: int(both)]):
        one.state = one.state or READ
    for one in things:
        here.found.add(f"{one.noun}.near", "corner", here.item)
        here.found.add(f"{one.noun}.relation", "at", here.item)
    return True


def _may_stand_at_a_corner(thing: Item) -> bool:
    known = thing.noun in ELEMENTS and _is_on_a_lot(ELEMENTS[thing.noun])
    return known and not is_plural(thing.words[-1]) and thing.state in ("", READ)


def _listed_before(here: Here, at: int) -> list[Item]:
    """Return the two things before an item that "and" joins: "a kiosk and a school, | both"."""
    heads = [place for place in range(at) if here.items[place].noun in ELEMENTS
             and here.items[place].has("noun") and here.syntax.modifies(place) < 0]  # fmt: skip
    if len(heads) < 2 or any(one.is_mark(ENDS) for one in here.items[heads[-2] : at]):
        return []
    joined = any(one.get("rel") == "and" for one in here.items[heads[-2] : heads[-1]])
    return [here.items[place] for place in heads[-2:]] if joined else []


def _is_on_a_lot(element: Element) -> bool:
    """Return whether an element has a lot along a street."""
    return not element.builder and element.where not in ("water", "shore")


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
    beside = words in BESIDES or here.item.get("rel") in ("along", "around")
    if not beside or (words == "on" and place.noun not in AT_FRONTS):
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
    whole = before_between(here.syntax, whole)
    if whole > 0 and here.items[whole].noun == "center":  # "a school in the middle with | a pitch"
        whole = here.syntax.head_before(here.syntax.index(here.phrase_of(here.items[whole])[0]))
    place = here.items[whole] if whole >= 0 else None
    if not fits(thing, place) or place is None or is_plural(place.words[-1]):
        return
    if here.found.has(f"{thing.noun}.near") or place.state not in ("", READ):
        return
    inside = place.noun == "park" or ELEMENTS[thing.noun].where == "square"
    how = "in" if place.noun in INTO and inside else "near"
    here.found.add(f"{thing.noun}.near", place.noun, here.items[at], thing)
    if how != "near":
        here.found.add(f"{thing.noun}.relation", how, here.items[at], thing)


def before_between(syntax: Syntax, head: int) -> int:
    """Return the head that stands "between" two others, of which one is given; else that one.

    "A square between the church and the school with a statue" has the statue.
    """
    items = syntax.items
    begin = begin_of(items, head, ENDS + ",") if head >= 0 else 0
    link = next((at for at in range(head - 1, begin - 1, -1) if items[at].text == "between"), -1)
    joined = any(one.get("rel") == "and" for one in items[max(link, 0) : max(head, 0)])
    return syntax.head_before(link) if link > 0 and joined else head


def _add_quarter(here: Here, thing: Item, key: str, value: str) -> None:
    """Add where most buildings are of a kind; then that kind is not what most of all are."""
    slots = here.found.slots
    slots[:] = [one for one in slots if (one.key, one.value) != ("building.type", thing.noun)]
    here.found.add(f"{thing.noun}.{key}", value, here.item, thing)


_WATERS, _LINES = ("river", "canal"), ("river", "canal", "railway", "tram_line")


def read_crossing(here: Here, thing: Item | None, place: Item | None) -> bool:
    """Read a bridge over a river, and a river through the town, which is in its middle."""
    link = here.item.words[-1]
    if thing is None or link not in ("over", "across", "through"):
        return False
    if thing.noun == "bridge" and is_it(here, here.at + 1):
        waters = [one for one in here.items[: here.at] if one.noun in _WATERS and one.has("noun")]
        place = waters[-1] if waters else None
    if thing.noun == "bridge" and place is not None and place.noun in _WATERS:
        here.found.add("bridge.near", place.noun, here.item)
        here.found.add("bridge.relation", "over", here.item)
        return True
    head = here.syntax.object_of(here.at)
    whole = here.items[head] if head >= 0 else None
    town = is_it(here, here.at + 1) or (
        whole is not None and (whole.noun == "city" or "district=" in whole.get("slot"))
    )
    if not town or link == "over" or thing.noun not in _LINES or is_plural(thing.words[-1]):
        return False
    here.found.add(f"{thing.noun}.side", "middle", here.item)
    return True


def read_island(here: Here, thing: Item | None, place: Item | None) -> bool:
    """Add the water that an island lies in; that of a town on an island is the sea."""
    if place is None:
        return False
    if thing is not None and thing.noun == "island":
        water = place.noun if here.item.text in _AMID and place.noun in _HOLDS_ISLANDS else ""
    else:
        town = thing is None or thing.has("slot")
        water = "sea" if town and here.item.text == "on" and place.noun == "island" else ""
        behind = here.items[here.syntax.index(place) + 1 :][:4]
        if behind and behind[0].text in _AMID:  # "on an island in a lake"
            water = next((one.noun for one in behind if one.noun in _HOLDS_ISLANDS), water)
    if water:
        here.found.add("island.near", water, here.item)
    return bool(water)


def read_between(here: Here, thing: Item | None) -> bool:
    """Read "between the church and the school" of a single thing."""
    nouns = [item for item in here.items[here.at + 1 : here.at + 1 + FAR] if item.noun][:2]
    joined = any(item.get("rel") == "and" for item in here.items[here.at : here.at + FAR])
    if here.item.text != "between" or len(nouns) < 2 or not joined:
        return False
    if thing is not None and thing.noun == "plaza":
        return _read_square_between(here, thing, *nouns)
    if not fits(thing, nouns[0]):
        return False
    assert thing is not None
    if not fits(thing, nouns[1]) or is_plural(thing.words[-1]):
        return False
    _add(here, thing, nouns[0], "between")
    here.found.add(f"{thing.noun}.second", nouns[1].noun, here.item)
    return True


def _read_square_between(here: Here, square: Item, one: Item, other: Item) -> bool:
    """Read a square between two buildings, which stand across it from each other."""
    built = all(each.noun in ELEMENTS and ELEMENTS[each.noun].building for each in (one, other))
    several = any(is_plural(each.words[-1]) for each in (square, one, other))
    told = any(here.found.has(f"{each.noun}.near") for each in (one, other))
    if not built or several or told or not (fits(one, square) and fits(one, other)):
        return False
    here.found.add(f"{other.noun}.near", square.noun, here.item)
    _add(here, one, other, "across")
    here.found.add(f"{one.noun}.second", square.noun, here.item)
    return True


def is_kept_clear(thing: Item, place: Item) -> bool:
    """Return whether a distance of a thing may be told from all buildings of a kind."""
    element = ELEMENTS.get(thing.noun)
    return place.noun in HOMES and element is not None and not element.builder


def fits(thing: Item | None, place: Item | None) -> bool:
    """Return whether a thing can be placed by another."""
    return (
        thing is not None and place is not None and thing.noun != place.noun
        and thing.noun in ELEMENTS and not ELEMENTS[thing.noun].builder
        and (place.noun in ELEMENTS or place.noun in PLACES)
        and chosen_by(place.noun) != ELEMENTS[thing.noun].measure  # a harbour has its pier
    )  # fmt: skip


def _add(here: Here, thing: Item, place: Item, how: str) -> None:
    here.found.add(f"{thing.noun}.near", place.noun, here.item)
    if how != "near":
        here.found.add(f"{thing.noun}.relation", how, here.item)
