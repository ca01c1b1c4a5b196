"""Places: where an instruction says that things stand; what nothing brings about is left open."""

from __future__ import annotations

from cityx.language.brief import Note, Span
from cityx.language.here import BUILDINGS, LANDMARKS, Here
from cityx.language.scan import ENDS, Item
from cityx.language.scopes import NEGATED, READ
from cityx.language.syntax import is_plural
from cityx.town.elements import ELEMENTS

_NO_PLACE = ("city", "landscape", "center", "sky")
_TURNED = ("right", "left", "top", "bottom")  # sides of a picture, not of a city
_PLACED = ("element", "plant", "person", "vehicle", *BUILDINGS)
_OBJECTS = ("element", "type", "road", "plant")
_RINGED = ("plaza", "park")
_RELATIONS = ("in", "on", "near", "along", "around", "by")
_ALONE = ("near", "along", "around")  # they say where a thing is without a noun behind them
_OTHER = (
    "above", "against", "at", "below", "beneath", "between", "beyond", "by", "inside", "opposite",
    "outside", "over", "past", "through", "under",
)  # fmt: skip
_MIDDLE = frozenset(("center", "middle", "edge"))


def read_axis_or_side(here: Here) -> None:
    """Read an axis of a street, and a side of the city with the element that is to be there."""
    if here.item.has("axis"):
        _axis(here)
    elif here.item.has("side") and here.item.text not in _TURNED:
        _side(here)


def _axis(here: Here) -> None:
    street = here.noun()
    if street is not None and street.noun_class == "element":
        here.found.leave(here.item, f"direction of the {street.noun}")
        return
    own = "motorway" if street is not None and street.noun == "motorway" else "main"
    here.found.add(f"roads.{own}.axis", here.item.get("axis"), here.item)


def _side(here: Here) -> None:
    """Place the noun that a side describes, the one before "in the north", or the next."""
    other = noun_after(here) if here.after is not None and here.after.get("rel") == "of" else None
    if other is not None and other.noun not in _NO_PLACE:
        here.found.leave(here.item, f"side of the {other.noun}")
        return
    phrase = here.syntax.phrase(here.at)
    first = here.at if phrase is None else phrase.first
    head = -1 if phrase is None else phrase.head
    placed = first > 0 and here.items[first - 1].get("rel") in ("in", "on", "to", "near")
    placed = placed or (first > 0 and here.items[first - 1].text in ("at", "from"))
    if head > here.at and not _is_an_edge(here.items[head]):
        thing = here.items[head]
    elif (before := here.syntax.head_before(first)) >= 0:
        thing = here.items[before]
    elif (behind := _next_head(here)) is not None and placed:
        thing = behind
    else:
        return
    if thing.kind == "unknown" or not thing.has("noun"):
        return  # "the north | bank" is on no side of the city
    if not _is_placed(thing):
        here.found.leave(here.item, f"side of the {here.found.said(thing)}")
    elif thing.state in ("", READ):
        here.found.add(f"{thing.noun}.side", here.item.get("side"), here.item)
        if head > here.at and _is_an_edge(here.items[head]):
            here.items[head].state = READ


def _is_an_edge(item: Item) -> bool:
    return item.text in ("edge", "end", "part", "half", "corner", "rim")


def _is_placed(item: Item) -> bool:
    """Return whether a thing may stand on a side: an element or a landmark."""
    return item.has("noun") and (item.noun_class == "element" or item.noun in LANDMARKS)


def _next_head(here: Here) -> Item | None:
    """Return the head of the next phrase, past one comma: "in the north, | a park"."""
    for at in range(here.at + 1, min(here.at + 4, len(here.items))):
        phrase = here.syntax.phrase(at)
        if phrase is not None and phrase.head > here.at:
            return here.items[phrase.head]
        if here.items[at].is_mark(ENDS):
            return None
    return None


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


def thing_before(here: Here) -> Item | None:
    """Return the thing in the same clause that a place behind it is of."""
    for item in reversed(here.clause()):
        if item.span < here.item.span and item.noun_class in _PLACED:
            return item
    return None


def read_middle(here: Here) -> None:
    """Read "in the middle" with the thing that is to be there."""
    of_all = here.item.get("rel") in ("in", "near") and not _MIDDLE.isdisjoint(here.item.words)
    place = noun_after(here) if of_all else None
    if here.item.noun != "center" and not (of_all and (place is None or place.noun == "city")):
        return
    where = "edge" if "edge" in here.item.words else "middle"
    thing = thing_before(here)
    if thing is None:
        return
    one = thing.noun in ELEMENTS and not is_plural(thing.text)
    if one or (thing.noun in ("plaza", "park") and where == "middle"):
        here.found.add(f"{thing.noun}.side", where, here.item)
    else:
        here.found.leave(here.item, f"place of the {thing.noun}")


def read_place(here: Here) -> None:
    """Note where one thing stands to another: nothing brings that about."""
    item, rel = here.item, here.item.get("rel")
    other = item.words[-1] in _OTHER and item.kind in ("function", "phrase")
    if rel not in _RELATIONS and not other:
        return
    after_another = here.before is not None and here.before.get("rel") in _RELATIONS
    counted = here.after is not None and here.after.quantity is not None
    if rel == "by" and (after_another or counted):
        return  # "surrounded by", "4 by 5 blocks"
    place, thing = noun_after(here), thing_before(here)
    alone = here.after is None or here.after.kind == "mark" or here.after.get("rel") == "it"
    if place is None and (thing is not None or alone) and rel in _ALONE:
        item.state = READ
        leave_place(here, thing, item.span)  # "a forest behind", "a kiosk beside it"
    if rel in ("near", "around") or other:
        place = place or _quarter_after(here)
    if place is None or place.state == NEGATED:
        return
    quarter = (place.has("slot") or place.noun == "city") and rel not in ("in", "on")
    if place.noun_class not in _OBJECTS and not quarter:
        return
    item.state = READ
    in_streets = place.noun_class == "road" and rel in ("in", "on", "along", "near")
    in_streets = in_streets and "of" not in item.words
    moving = thing is not None and thing.noun_class in ("vehicle", "person")
    ringed = thing is not None and thing.noun == "tower" and rel == "around"
    if (in_streets and (moving or thing is None)) or (ringed and place.noun in _RINGED):
        return  # traffic is in the streets, and towers are built around squares and parks
    leave_place(here, thing, (item.span[0], place.span[1]))


def leave_place(here: Here, thing: Item | None, span: Span) -> None:
    """Note words that say where something is."""
    what = "something" if thing is None else f"the {thing.noun}"
    said = f'"{here.found.text[slice(*span)]}" (where {what} is) is left open.'
    here.found.notes.append(Note("left_open", said, span))
