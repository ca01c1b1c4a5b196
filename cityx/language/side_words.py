"""Side words: sides and the middle of a site with what is there, and axes of streets."""

from __future__ import annotations

from dataclasses import replace

from cityx.language.here import (
    LANDMARKS,
    SIDES_OF_A_VIEW,
    Here,
)
from cityx.language.measurable import CORNERS
from cityx.language.named_sides import is_of_another, leave_side_of, read_across, read_side_of
from cityx.language.place_words import NO_PLACE, leave_place, noun_after
from cityx.language.relations import (
    antecedent,
    before_between,
    read_part,
    read_relation,
    thing_before,
)
from cityx.language.scan import ENDS, Item
from cityx.language.scopes import READ
from cityx.language.syntax import is_plural
from cityx.town.elements import ELEMENTS

_MIDDLE = frozenset(("center", "middle", "edge"))
_BOTH = ("each", "either", "both")
_TWO_ENDS = ("end", "ends", "bank", "banks", "shore", "shores", "side", "sides")
_FACING = ("facing", "faces", "looking", "towards")
_BECOMING = ("get", "gets", "getting", "become", "becomes", "becoming", "grow", "turn", "change")


def read_axis_or_side(here: Here) -> None:
    """Read an axis of a street, and a side of the city with the element that is to be there."""
    if here.item.has("axis"):
        _axis(here)
    elif read_across(here):
        here.item.state = READ
    elif here.item.has("side") and here.item.text not in SIDES_OF_A_VIEW:
        _side(here)


def _axis(here: Here) -> None:
    street = here.noun() or here.last_noun()
    if street is not None and _changes_along(here):
        here.found.leave(here.item, "along which something changes")
        return
    if street is not None and street.noun_class == "element":
        here.found.leave(here.item, f"direction of the {street.noun}")
        return
    if street is not None and street.noun in ("road", "side_street") and _others_run(here):
        here.found.leave(here.item, f"axis of the {here.found.said(street)}")
        return  # "avenues north to south, streets | east to west"
    own = "motorway" if street is not None and street.noun == "motorway" else "main"
    here.found.add(f"roads.{own}.axis", here.item.get("axis"), here.item)


def _others_run(here: Here) -> bool:
    """Return whether main streets have an axis of their own."""
    main = any(one.noun in ("avenue", "main_street") for one in here.items)
    return main and sum(one.has("axis") for one in here.items) > 1


def _changes_along(here: Here) -> bool:
    """Return whether something changes along an axis: "streets get steeper from west to east"."""
    before = here.before
    more = before is not None and (before.has("compared") or before.words[-1].endswith("er"))
    becomes = any(one.text in _BECOMING for one in here.before_in_clause()[-4:])
    return here.item.words[0] == "from" and (more or becomes)


def _side(here: Here) -> None:
    """Place the noun that a side describes, the one before "in the north", or the next."""
    if here.before is not None and here.before.text in _FACING:
        here.found.leave(here.item, "direction in which something faces")
        return
    link = here.at + 1
    if link < len(here.items) and (
        here.items[link].text == "side" or _is_an_edge(here.items[link])
    ):
        link += 1  # "the south | side of the square"
    if is_of_another(here.items, here.at):
        if not read_side_of(here):
            leave_side_of(here)
        return
    of = link < len(here.items) and here.items[link].get("rel") == "of"
    other = noun_after(replace(here, at=link)) if of else None
    if other is not None and other.noun not in NO_PLACE and other.noun_class != "building":
        here.found.leave(here.item, f"side of the {other.noun}")
        return
    phrase = here.syntax.phrase(here.at)
    first = here.at if phrase is None else phrase.first
    head = -1 if phrase is None else phrase.head
    placed = first > 0 and here.items[first - 1].get("rel") in ("in", "on", "to", "near")
    placed = placed or (first > 0 and here.items[first - 1].text in ("at", "from"))
    if (head > here.at and not _is_an_edge(here.items[head])) or -1 < head < here.at:
        thing = here.items[head]
    elif (before := here.syntax.head_before(first)) >= 0:
        thing = here.items[before]
    elif (behind := _next_head(here)) is not None and placed:
        thing = behind
    else:
        return
    if thing.kind == "unknown" or not thing.has("noun"):
        return  # "the north | bank" is on no side of the city
    beside = first > 0 and here.items[first - 1].get("rel") == "near" and head > here.at
    if beside and here.items[first].text == "the":
        here.found.leave(here.item, f"side of the {here.found.said(thing)}")
        return  # "a market next to the | north gate"
    if read_part(here, thing, here.item.get("side")):
        if placed:
            here.items[first - 1].state = here.items[first - 1].state or READ
        if head > here.at and _is_an_edge(here.items[head]):
            here.items[head].state = READ
    elif not (_is_placed(thing) and may_be_at(thing, here.item.get("side"))):
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


def may_be_at(thing: Item, side: str) -> bool:
    """Return whether a thing may be put on a side; into a corner what has a lot, and a harbour."""
    element = ELEMENTS.get(thing.noun)
    lot = element is not None and not element.builder
    return side not in CORNERS or lot or thing.noun == "harbour"


def _next_head(here: Here) -> Item | None:
    """Return the head of the next phrase, past one comma: "in the north, | a park"."""
    for at in range(here.at + 1, min(here.at + 4, len(here.items))):
        phrase = here.syntax.phrase(at)
        if phrase is not None and phrase.head > here.at:
            return here.items[phrase.head]
        if here.items[at].is_mark(ENDS):
            return None
    return None


def read_middle(here: Here) -> None:
    """Read "in the middle" with the thing that is to be there."""
    of_all = here.item.get("rel") in ("in", "near") and not _MIDDLE.isdisjoint(here.item.words)
    place = noun_after(here) if of_all else None
    if here.item.text == "central":
        _central(here)
        return
    if here.item.noun == "center" and here.phrase_of(here.item)[0].text in ("a", "an"):
        return  # "a church and | an old core"
    if here.item.noun != "center" and not (of_all and (place is None or place.noun == "city")):
        return
    where = "edge" if "edge" in here.item.words else "middle"
    thing = thing_before(here)
    if of_all and here.after is not None and here.after.get("rel") == "it":
        _in_it(here, thing)
        return
    if thing is None or _is_in_a_thing(here, thing, where) or read_part(here, thing, where):
        return
    one = thing.noun in ELEMENTS and not is_plural(thing.text)
    if one or (thing.noun in ("plaza", "park") and where == "middle"):
        here.found.add(f"{thing.noun}.side", where, here.item)
        if (other := _joined_alone(here, thing)) is not None:
            here.found.add(f"{other.noun}.side", where, here.item)
    else:
        here.found.leave(here.item, f"place of the {thing.noun}")


def _central(here: Here) -> None:
    """Read "a central lawn" of a single thing."""
    head = here.syntax.head_behind(here.at)
    thing = here.items[head] if head >= 0 else None
    if thing is None or not thing.has("noun") or is_plural(thing.words[-1]):
        return
    if thing.noun in ELEMENTS or thing.noun in ("plaza", "park"):
        here.found.add(f"{thing.noun}.side", "middle", here.item)
    else:
        here.found.leave(here.item, f"place of the {thing.noun}")


def _in_it(here: Here, thing: Item | None) -> None:
    """Read "a statue in the middle of | it" of the last place that was named."""
    place = None if thing is None else antecedent(here, thing)
    middle = "edge" not in here.item.words
    if not (middle and read_relation(here, thing, place, how="in")):
        leave_place(here, thing, here.item.span)
    here.item.state = READ


def _joined_alone(here: Here, thing: Item) -> Item | None:
    """Return the other of two things that a sentence begins with: "a clinic and | a library"."""
    first = here.syntax.index(here.phrase_of(thing)[0])
    if first < 2 or here.items[first - 1].get("rel") != "and":
        return None
    other = here.items[first - 2]
    begins = here.syntax.index(here.phrase_of(other)[0])
    alone = begins == 0 or here.items[begins - 1].is_mark(ENDS)
    known = other.noun in ELEMENTS and other.has("noun") and not is_plural(other.words[-1])
    return other if alone and known else None


def _is_in_a_thing(here: Here, thing: Item, where: str) -> bool:
    """Read "a square with a fountain in the middle", whose middle is meant."""
    first = here.syntax.index(here.phrase_of(thing)[0])
    if not first or here.items[first - 1].get("rel") != "with":
        return False
    head = before_between(here.syntax, here.syntax.head_before(first - 1, past_comma=True))
    whole = here.items[head] if head >= 0 else None
    if whole is None or whole.noun_class not in ("element", "road", "type"):
        return False
    plain = not is_plural(whole.words[-1]) and where == "middle" and here.item.text != "edge"
    if plain and read_relation(replace(here, at=here.at), thing, whole, how="in"):
        here.item.state = READ
    else:
        leave_place(here, thing, here.item.span)
    return True


def read_at_each(here: Here) -> None:
    """Read that there are two of a thing: "a roundabout at | each end", "on | either bank".

    Where they are is left open.
    """
    link, end = here.before, here.after
    if here.item.text not in _BOTH or link is None or end is None or end.text not in _TWO_ENDS:
        return
    head = here.syntax.head_before(here.at)
    thing = here.items[head] if head >= 0 else None
    if link.get("rel") not in ("on", "in") or thing is None or is_plural(thing.words[-1]):
        return
    known = thing.noun in ELEMENTS or thing.noun_class == "element"
    first = here.phrase_of(thing)[0]
    row = any(item.quantity is not None for item in here.items[head + 1 : here.at])
    one = first.text in ("a", "an", "one") and not row  # "a lamp every 25 m on both | sides"
    if not (known and one and thing.has("noun") and thing.state == ""):
        return
    for item in (first, link, here.item, end):
        item.state = READ
    here.found.add(f"{thing.noun}.count", 2, thing)
    leave_place(here, thing, (link.span[0], end.span[1]))
