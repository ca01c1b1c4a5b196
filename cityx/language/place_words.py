"""Place words: where one thing stands to another; what cannot be brought about is left open."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace

from cityx.language.brief import Note, Span
from cityx.language.here import (
    AIR,
    Here,
)
from cityx.language.relations import (
    OUTSKIRTS,
    antecedent,
    held_by,
    is_it,
    owner_of_place,
    read_between,
    read_corner,
    read_crossing,
    read_end,
    read_island,
    read_lined,
    read_part,
    read_quarter,
    read_relation,
    read_row,
    read_seafront,
    read_tallest,
    thing_before,
)
from cityx.language.scan import Item
from cityx.language.scopes import NEGATED, READ
from cityx.language.syntax import is_adjective, is_plural

NO_PLACE = ("city", "landscape", "center", "sky")
_OBJECTS = ("element", "type", "road", "plant")
_RINGED = ("plaza", "park")
RELATIONS = ("in", "on", "near", "along", "around", "by")
_ON = ("on", "along", "by", "near")
_ALONE = ("near", "along", "around")  # they say where a thing is without a noun behind them
_OTHER = (
    "above", "against", "at", "below", "beneath", "between", "beyond", "by", "inside", "opposite",
    "outside", "over", "past", "through", "toward", "towards", "under",
)  # fmt: skip
_SPOTS = ("end", "ends", "foot", "mouth", "entrance", "corner", "corners", "top", "rear", "tip")
REACH = 4  # items between a part of buildings and its look
_OF_TREES = {"nature.species.streets", "nature.species.parks"}


def is_a_town(item: Item) -> bool:
    """Return whether an item names a town or a quarter."""
    return item.noun == "city" or "district=" in item.get("slot")


def is_first_town(here: Here, place: Item) -> bool:
    """Return whether a head is what the text is about: the first town or quarter that it names."""
    towns = (one for one in here.items if is_a_town(one))
    return next(towns, None) is place


_BY_A_TOWN = ("on", "near", "by", "along", "at")
_LAND = ("river", "lake", "sea", "canal", "pond", "forest", "meadow", "vineyard", "orchard",
         "railway", "harbour", "beach")  # fmt: skip


def _is_by_a_town(here: Here, place: Item | None) -> bool:
    """Return whether a place is what the whole town lies by: "a village on a | river".

    It holds wherever in the town that is.
    """
    head = here.syntax.head_before(here.at)
    town = here.items[head] if head >= 0 else None
    stands = place is not None and place.noun in _LAND and place.state != NEGATED
    off = {"of", "around", "across", "over", "through"}.intersection(here.item.words)
    by = here.item.get("rel") in _BY_A_TOWN and not off
    return by and stands and town is not None and is_a_town(town) and is_first_town(here, town)


def is_traffic_near(here: Here) -> bool:
    """Return whether vehicles or traffic are told of near an item."""
    near = here.clause(REACH)
    return any(one.noun == "vehicle" or "traffic=" in one.get("slot") for one in near)


def noun_after(here: Here) -> Item | None:
    """Return the noun that a preposition stands before."""
    head = here.syntax.object_of(here.at)
    item = here.items[head] if head > here.at else None
    return item if item is not None and item.noun else None


def _quarter_after(here: Here) -> Item | None:
    """Return the village or hill that a preposition stands before: "above a village"."""
    head = here.syntax.object_of(here.at)
    item = here.items[head] if head > here.at else None
    if item is None:
        return None
    quarter = item.get("slot").startswith(("district=", "terrain="))
    return item if quarter or item.noun == "city" else None


def read_place(here: Here) -> None:
    """Read where one thing stands to another; what cannot be brought about is noted."""
    item, rel = here.item, here.item.get("rel")
    if is_adjective(here.items, here.at) or (here.after is not None and here.after.text == "which"):
        return  # "a town in | which all towers are brick"
    if read_tallest(here) or read_lined(here) or (item.text in OUTSKIRTS and _edge(here)):
        return
    if item.text in _SPOTS or item.text == "there":
        _spot(here)
        return
    if item.text in ("from", "to", "into"):
        _way(here)
        return
    other = item.words[-1] in _OTHER and item.kind in ("function", "phrase")
    if rel not in RELATIONS and not other:
        return
    after_another = here.before is not None and here.before.get("rel") in RELATIONS
    counted = here.after is not None and here.after.quantity is not None
    if rel == "by" and (after_another or counted):
        return  # "surrounded by", "4 by 5 blocks"
    place, thing = noun_after(here), thing_before(here)
    if place is not None:
        thing = owner_of_place(here, place)
    elif thing is not None and is_it(here, here.at + 1):
        place = held_by(here, thing) or antecedent(here, thing)
    related = read_between(here, thing) or read_quarter(here, thing, place)
    related = related or read_crossing(here, thing, place)
    related = related or read_row(here, thing, place)
    related = related or read_relation(here, thing, place)
    related = related or (place is None and rel in _ON and read_seafront(here, thing))
    if related or read_island(here, thing, place) or _is_by_a_town(here, place):
        item.state = READ
        return
    alone = here.after is None or here.after.kind == "mark" or here.after.get("rel") == "it"
    pronoun = here.after is not None and here.after.get("rel") == "it" and rel in ("on", "in")
    pronoun = pronoun and not (here.after is not None and here.after.noun)
    pronoun = pronoun or (other and here.after is not None and here.after.get("rel") == "it")
    if place is None and (thing is not None or alone) and (rel in _ALONE or pronoun):
        item.state = READ
        leave_place(here, thing, item.span)  # "a forest behind", "a kiosk beside it"
    if rel in ("near", "around") or other:
        place = place or _quarter_after(here)
    head = here.syntax.object_of(here.at)
    if head >= 0 and here.items[head].get("slot").startswith(AIR):
        return  # "under a clear sky"
    if place is None or place.state == NEGATED:
        return
    told = {slot.key for slot in here.found.slots}
    if thing is not None and thing.noun_class == "plant" and told & _OF_TREES:
        item.state = READ
        return
    quarter = (place.has("slot") or place.noun == "city") and rel not in ("in", "on")
    if place.noun_class not in _OBJECTS and not quarter:
        return
    item.state = READ
    roads = ("road", "main_street") if is_traffic_near(here) else ("road",)
    in_streets = place.noun in roads and rel in ("in", "on", "along", "near")
    in_streets = in_streets and "of" not in item.words
    moving = thing is not None and thing.noun_class in ("vehicle", "person")
    ringed = thing is not None and thing.noun == "tower" and rel == "around"
    if thing is not None and place.noun == "road" and _is_spaced(here, told):
        return
    if (in_streets and (moving or thing is None)) or (ringed and place.noun in _RINGED):
        return  # traffic is in the streets, and towers are built around squares and parks
    leave_place(here, thing, (item.span[0], place.span[1]))


def _edge(here: Here) -> bool:
    """Read "villas at the edge"; that of another thing is left open."""
    thing, of = thing_before(here), here.after is not None and here.after.get("rel") == "of"
    place = noun_after(replace(here, at=here.at + 1)) if of else None
    town = place is None or place.noun in ("city", "landscape")
    if town and (not of or place is not None) and read_part(here, thing, "edge"):
        return True
    if of and place is not None and thing is not None:
        here.item.state = READ
        leave_place(here, thing, (here.item.span[0], place.span[1]))
        return True
    return False


def _spot(here: Here) -> None:
    """Leave open "at the end of the pier" and "put a crossing there"."""
    thing, after = thing_before(here), here.after
    if read_end(here, thing) or read_corner(here, thing):
        return
    if here.item.text == "there":
        if thing is not None and (after is None or after.kind == "mark"):
            leave_place(here, thing, here.item.span)
        return
    if after is None or after.get("rel") != "of":
        return
    behind = here.items[here.at + 2 : here.at + 5]
    place = next((one for one in behind if one.noun or one.text in ("each", "it")), None)
    if place is not None:
        here.item.state = READ
        leave_place(here, thing, (here.item.span[0], place.span[1]))


def _way(here: Here) -> None:
    """Leave open where a street leads: "a path | from the bridge to the church"."""
    place, head = noun_after(here), here.syntax.head_before(here.at)
    road = here.items[head] if head >= 0 else None
    if road is None or road.noun_class != "road" or road.noun == "avenue":  # they fan out
        return
    if place is None or place.noun_class not in ("element", "type"):
        return
    behind = here.syntax.index(place) + 1
    goes_on = behind < len(here.items) and here.items[behind].text in ("to", "into")
    other = noun_after(replace(here, at=behind)) if goes_on else None
    last = place if other is None else other
    said = here.found.text[here.item.span[0] : last.span[1]]
    here.item.state = READ
    here.found.notes.append(
        Note("left_open", f'"{said}" (where the {here.found.said(road)} leads) is left open.',
             (here.item.span[0], last.span[1]))
    )  # fmt: skip


def _is_spaced(here: Here, told: Collection[str]) -> bool:
    """Return whether all streets have something every so many metres: "lamps every 25 m on all"."""
    behind = here.items[here.at + 1 : here.at + 4]
    street = next((one for one in behind if one.noun == "road"), None)
    every = any(one.get("rel") in ("all", "every") or one.text in ("each", "any") for one in behind)
    at = 0 if street is None else here.syntax.index(street)
    bare = at == here.at + 1 or here.items[at - 1].text in ("the", "all", "all the", "both")
    only = any(one.text in ("only", "alone") for one in here.items[at + 1 : at + 2])
    plural = street is not None and is_plural(street.words[-1]) and bare and not only
    if not ((every or plural) and any(key.endswith("spacing") for key in told)):
        return False
    for one in behind:
        one.state = READ if one.text in ("every", "each", "all") else one.state
    return True


def leave_place(here: Here, thing: Item | None, span: Span) -> None:
    """Note words that say where something is."""
    what = "something" if thing is None else f"the {thing.noun}"
    said = f'"{here.found.text[slice(*span)]}" (where {what} is) is left open.'
    phrase = () if thing is None else here.phrase_of(thing)
    of = (phrase[0].span[0], phrase[-1].span[1]) if phrase else None
    here.found.notes.append(Note("left_open", said, span, of))
