"""Lengths: metres that are a height, a width, a distance, a spacing or the size of a site."""

from __future__ import annotations

from dataclasses import replace

from cityx.language.counts import is_whole, key_of, value_of
from cityx.language.distances import read_distance
from cityx.language.here import (
    AIR,
    BUILDINGS,
    ROADS,
    Here,
)
from cityx.language.relations import are_of_some, stands_in_a_part
from cityx.language.restrictions import ABOUT, is_set_apart
from cityx.language.scan import ENDS, Item, Quantity, begin_of
from cityx.language.scopes import READ
from cityx.language.syntax import is_plural, is_unknown
from cityx.town.elements import ELEMENTS, PLACES

_GREEN = ("green", "park", "garden", "forest", "lawn")
WHOLE = ("city", "landscape", "everything")
_SITES = ("site", "map area", "total area", "extent", "layout size", "whole scene", "map")
_SIDES = {"width": ("size.x",), "length": ("size.y",)}
_FROM = ("away", "from", "off", "above", "below", "behind", "beyond", "over", "under")
_LIVING = ("vehicle", "person", "plant")  # classes of what no length across is of
_STREAMS = ("river", "canal", "sidewalk", "cycleway")  # "a river of 20 m" is so wide
WIDEST = 60.0  # metres of a street; "a street of 300 m" is so long
_STREETS = ("street", "road")
_LANES = ("lane", "lanes", "alley", "alleys")  # streets of one kind among others
_SIZED = ("plaza", "park", "lake")  # places that are as large as is said
_PARTS = ("facade", "roof", "window")
LOWEST = 1.0  # metres; nothing that is asked of a building, a tree or a lamp is lower


def is_of_the_list(here: Here, owner: Item) -> bool:
    """Return whether a bound behind a comma is of all that was listed: "..., | 12 storeys max"."""
    begins = here.before is None or here.before.is_mark(",;")
    ends = here.after is None or here.after.kind == "mark" or here.after.text == "all"
    if here.quantity.exact is not None or not (begins and ends) or here.of_one_thing(owner):
        return False
    at = here.syntax.index(owner)
    sentence = here.items[at - 1 :: -1] if at else ()
    for item in sentence:
        if item.is_mark(ENDS):
            return False
        if item.noun_class == "type" and item.noun != owner.noun and item.state in ("", READ):
            return True
    return False


def read_lengths(here: Here) -> None:
    """Read metres, of what they are said of."""
    what = here.quantity.attribute
    noun = here.noun()
    if noun is None and what == "width":
        noun = here.noun_past_comma()
    every = here.before is not None and here.before.text in ("every", "each")
    unknown = here.before is not None and here.before.kind == "unknown"
    if noun is None and unknown and not what:
        return  # "visibility | under 1 km"
    part = here.owner(past_comma=True) if noun is None else None
    if part is not None and part.get("slot").startswith("building.feature="):
        here.found.leave(here.item, f"of the {here.found.said(part)}")  # "a chimney, | 60 m"
        return
    if here.before is not None and here.before.text == "for" and here.quantity.exact is None:
        here.found.leave(here.item, "for what something else stands")  # "red for | under 20 m"
        return
    if noun is None and (thing := thing_past_comma(here)) is not None:
        if thing.noun_class == "element" or thing.noun in ELEMENTS:
            noun = thing  # "a minaret, which is | 22 m high"
        else:
            here.found.leave(here.item, f"of the {here.found.said(thing)}")
            return
    if what == "width" and here.item.words[0] in _STREETS:
        here.found.add_bounded("roads.width", here.quantity, here.item)  # "a street width of 14 m"
    elif is_difference(here):
        here.found.leave(here.item, "by how much two things differ")
    elif _is_depth(here):
        here.found.leave(here.item, "depth")
    elif _is_for_each(here):
        here.found.leave(here.item, "for each of others")
    elif _is_distance(here):
        if not read_distance(here, here.noun_before()):
            here.found.leave(here.item, "distance")
    elif _of_blocks(here):
        here.found.leave(here.item, "size of the blocks")
    elif what == "slope":
        read_slope(here)
    elif what == "spacing" or (every and not what):
        _spacing(here)
    elif _is_extent(here, noun):
        _extent(here, "")
    elif (road := _road_past_comma(here, noun)) is not None:
        between = here.items[here.items.index(road) : here.at]
        measure = "width" if any(item.has("width") for item in between) else "length"
        here.found.add_bounded(f"{key_of(road)}.{measure}", here.quantity, here.item)
    elif what == "height" and noun is not None and noun.noun in _PARTS:
        here.found.leave(here.item, f"height of the {here.found.said(noun)}")
    elif what == "height" or (not what and (noun is None or noun.noun_class in BUILDINGS)):
        noun = _owner_in_brackets(here, noun)
        own = noun is not None and (
            noun.noun_class in ("element", "plant") or noun.noun in ELEMENTS
        )
        least = None if own else _least(here)
        if least is not None:
            here.found.add_bounded(
                "building.height", replace(here.quantity, high=None), here.item, least
            )
            return
        if noun is not None and not own and are_of_some(here, noun) and not here.has_looks(noun):
            here.found.leave(here.item, f"height of the {noun.noun}")
            return
        scoped = noun is not None and (
            own or of_all(here, noun) or are_of_some(here, noun) or _are_among(here, noun)
        )
        key = key_of(noun) if own and noun is not None else "building"
        key = noun.noun if scoped and not own and noun is not None else key
        key = "building" if noun is not None and is_of_the_list(here, noun) else key
        apart = noun is not None and stands_in_a_part(here, noun)
        if not own and not apart and is_set_apart(here):
            here.found.leave(here.item, ABOUT)
        elif own and noun is not None and noun.noun in ELEMENTS and not here.takes(noun, "height"):
            here.found.refuse(here.item, noun.noun, "height")
        elif (here.quantity.high or LOWEST) < LOWEST and not own:
            here.found.leave(here.item, "too low for a building")  # "10 cm on the roofs"
        else:
            quantity, *ranks = _highest(here)
            if ranks and key in ("building", "tower") and _is_of_them_all(here):
                here.found.add("height.highest", here.quantity.high or 0.0, here.item, *ranks)
            else:
                add_of_each(here, f"{key}.height", quantity, *ranks)
    elif noun is not None and noun.noun == "everything" and here.quantity.exact is None:
        here.found.leave(here.item, "bound of what is not said")  # "anything above 600 m"
    elif noun is None or noun.noun in WHOLE:
        _extent(here, what)
    else:
        _width(here, noun)


def _owner_in_brackets(here: Here, noun: Item | None) -> Item | None:
    """Return whose height is told; in brackets behind a place it is that of the buildings there.

    "Hotels facing the beach (none taller than | 25 m)" are no beach of that height.
    """
    if noun is None or noun.noun not in PLACES or noun.noun in ELEMENTS:
        return noun
    at = here.syntax.index(noun)
    bracket = any(one.is_mark("(") for one in here.items[at : here.at])
    head = here.syntax.head_before(at - 1) if bracket and at else -1
    whole = here.items[head] if head >= 0 else noun
    return whole if whole.noun_class in BUILDINGS else noun


# Kinds of buildings that limits can be of alone.
_LIMITED = ("house", "tower", "apartment", "office", "shop", "factory")


def _are_among(here: Here, noun: Item) -> bool:
    """Return whether towers are some of the buildings: "an old railway and | towers of 60 m"."""
    phrase = here.phrase_of(noun)
    first = here.syntax.index(phrase[0])
    counted = any(one.quantity is not None for one in phrase if one.span < noun.span)
    link = here.items[first - 1] if first else None
    joined = link is not None and (link.text == "with" or link.get("rel") == "and")
    least = here.quantity.low is not None  # "towers up to 300 m" make a skyline
    return noun.noun == "tower" and is_plural(noun.text) and joined and least and not counted


def of_all(here: Here, noun: Item) -> bool:
    """Return whether a bound is of every building of a kind alone: "no office above 11 m"."""
    at = here.items.index(noun)
    before = here.items[at - 1] if at else noun
    every = before.has("neg") or before.get("rel") in ("all", "every")
    if noun.noun not in _LIMITED or not every or here.quantity.exact is not None:
        return False
    before.state = before.state or READ
    return True


def _is_distance(here: Here) -> bool:
    """Return whether a length lies between things: "within 200 m of", "150 m away from"."""
    after = here.after
    if after is None or here.quantity.attribute:
        return False
    if after.words[-1] not in _FROM:
        return after.get("rel") == "of"
    head = here.syntax.object_of(here.at + 1)
    return head < 0 or not here.items[head].get("slot").startswith(AIR)  # "under a clear sky"


def is_difference(here: Here) -> bool:
    """Return whether a length is that between two things: "12 m | lower than the town"."""
    after = here.after
    behind = here.items[here.at + 2 : here.at + 3]
    than = bool(behind) and behind[0].text == "than"
    compared = after is not None and (after.words[-1] == "than" or (than and not after.noun))
    return bool(compared) or here.quantity.relative != 0


def _is_for_each(here: Here) -> bool:
    """Return whether a measure is that of one of others: "half a metre to the pixel"."""
    link = "" if here.after is None else here.after.text
    if link in ("per", "apiece"):
        return True
    head = here.syntax.object_of(here.at + 1) if link == "to" else -1
    return head >= 0 and is_unknown(here.items[head])


def _of_blocks(here: Here) -> bool:
    """Return whether a length is that of blocks: "blocks of about | 80 m", "113 m blocks"."""
    near = here.items[max(0, here.at - 4) : here.at + 3]
    many = any(item.text in ("each", "every") for item in near)
    word = ("block", "blocks") if many else ("blocks",)
    named = any(item.words and item.words[-1] in word for item in near)
    return named and here.quantity.attribute != "height"


def _spacing(here: Here) -> None:
    """Read how far apart trees stand; of other things nothing is spaced."""
    noun = here.noun_before()
    owner = here.owner()
    if noun is not None and noun.noun_class == "plant" and (whole := _lined_by(here, noun)):
        here.found.leave(here.item, f"spacing along the {whole}")
        return
    if noun is not None and noun.noun_class == "road" and _is_row_of_roads(here, noun):
        here.found.leave(here.item, f"spacing of the {here.found.said(noun)}")
        return  # "side streets every | 80 m"
    if noun is None and owner is not None:
        here.found.leave(here.item, f"spacing of the {here.found.said(owner)}")
        return
    if noun is None or noun.noun_class in ("plant", "road", "place") or is_green(noun):
        here.found.add_bounded("nature.spacing", here.quantity, here.item)
    else:
        here.found.leave(here.item, f"spacing of the {noun.noun}")


def _lined_by(here: Here, plants: Item) -> str:
    """Return the place that is no street and has a row of trees: "a promenade with | palms"."""
    first = here.syntax.index(here.phrase_of(plants)[0])
    held = first > 0 and here.items[first - 1].text in ("with", "has", "having")
    head = here.syntax.head_before(first - 1) if held else -1
    whole = here.items[head] if head >= 0 else None
    return here.found.said(whole) if whole is not None and whole.noun_class == "element" else ""


def _is_row_of_roads(here: Here, road: Item) -> bool:
    """Return whether it is streets that come in a row, and nothing along them."""
    phrase = here.phrase_of(road)
    first = here.syntax.index(phrase[0])
    before = here.items[first - 1] if first else None
    along = before is not None and before.get("rel") in ("along", "on", "in", "near")
    plants = any(one.noun_class == "plant" for one in here.before_in_clause())
    return not along and not plants and is_plural(road.words[-1])


def thing_past_comma(here: Here) -> Item | None:
    """Return the one thing, known or not, that a measure behind a comma is of: "a levee, | 3 m"."""
    first = here.at
    while first > 0 and not here.items[first - 1].is_mark(ENDS + ","):
        first -= 1
    if first == 0 or not here.items[first - 1].is_mark(","):
        return None
    if any(
        item.has("noun", "slot") or item.kind == "unknown" for item in here.items[first : here.at]
    ):
        return None
    head = here.syntax.head_before(first - 1)
    thing = here.items[head] if head >= 0 else None
    if thing is None or thing.noun_class in ("place", "road") or thing.has("slot"):
        return None
    if here.quantity.attribute == "across" and _is_no_owner(here, thing):
        return None
    known = thing.noun_class in ("element", *BUILDINGS) and not here.of_one_thing(thing)
    return None if known else thing


def _road_past_comma(here: Here, noun: Item | None) -> Item | None:
    """Return the street of "a long straight avenue, at least | 1.5 km"."""
    if noun is not None or here.quantity.attribute or here.before is None:
        return None
    comma = here.before.is_mark(",")
    last = here.last_noun() if comma else None
    return last if last is not None and last.noun_class == "road" else None


def _is_extent(here: Here, noun: Item | None) -> bool:
    """Return whether a length is the city's: "500 m across", "a town of | 600 m with a river"."""
    if here.quantity.attribute in ("side", "across"):
        return noun is None or noun.noun_class == "place"
    if here.quantity.attribute or here.noun_behind() is not None:
        return False
    place = here.items[here.at - 2] if here.at > 1 else None
    of = here.before is not None and here.before.get("rel") == "of"
    one = place is not None and place.noun_class == "place" and not place.words[-1].endswith("s")
    return of and one


def _is_depth(here: Here) -> bool:
    """Return whether a length is that of lying snow or water: "20 cm of snow"."""
    what = here.items[here.at + 2] if here.at + 2 < len(here.items) else None
    of = here.after is not None and here.after.get("rel") == "of"
    deep = what is not None and (
        what.get("slot").startswith("weather=") or what.noun in ("water", "sky")
    )
    return of and deep


def add_of_each(here: Here, key: str, quantity: Quantity, *told: Item) -> None:
    """Take a measure of buildings; one of each, or an exact one, is a bound on both sides."""
    before = here.items[max(0, here.at - 2) : here.at]
    exactly = any(one.text in ("exactly", "precisely", "strictly") for one in before)
    each = quantity.relative == 0 and (exactly or here.of_every_building())
    if quantity.exact is None or not each:
        here.found.add_bounded(key, quantity, here.item, *told)
        return
    for end in ("min", "max"):
        here.found.add(f"{key}.{end}", quantity.exact, here.item, every=True)
    for one in here.clause():
        if one.get("rel") in ("all", "every"):
            one.state = one.state or READ


def _highest(here: Here) -> tuple[Quantity, *tuple[Item, ...]]:
    """Return a height, that of "the highest building" as a bound of all, with its "highest"."""
    owner = here.owner(past_comma=True)
    near = (*here.clause(), *(() if owner is None else here.phrase_of(owner)))
    ranks = [one for one in near if one.get("rank") == "tallest"]
    if not ranks or here.quantity.exact is None:
        return (here.quantity,)
    kind = owner is not None and owner.noun_class == "type" and here.noun_behind() is owner
    if kind and owner is not None and ranks[0] not in here.phrase_of(owner):
        return (here.quantity,)  # "the tallest one is the | 40 m town hall"
    return replace(here.quantity, low=None), ranks[0]


def _least(here: Here) -> Item | None:
    """Return the word for the lowest of all, of which a bound below holds for each.

    "The | shortest house is at least 20 m high".
    """
    if here.quantity.low is None:
        return None
    return next((one for one in here.before_in_clause() if one.get("rank") in _LOWEST_OF_ALL), None)


_LOWEST_OF_ALL = ("lowest", "shortest")


def _is_of_them_all(here: Here) -> bool:
    """Return whether a number is the height of the highest, and no bound of it."""
    quantity = here.quantity
    allowed = any(set(one.words) & {"may", "can", "could"} for one in here.before_in_clause())
    return quantity.exact is not None and not allowed  # "the highest may reach | 90 m"


def _extent(here: Here, what: str) -> None:
    if here.before is not None and here.before.text == "each":
        return  # "blocks, each 100 m wide" are no city of that width
    owner = here.owner(past_comma=True)
    comma = here.before is not None and here.before.is_mark(",")
    if comma and owner is not None and _is_no_owner(here, owner):
        owner = None
    if owner is not None and not is_site(here, owner):
        here.found.leave(here.item, f"of the {here.found.said(owner)}")
        return
    for key in _SIDES.get(what, ("size.x", "size.y")):
        here.found.add(key, value_of(here.quantity), here.item)


def _is_no_owner(here: Here, thing: Item) -> bool:
    """Return whether a length is the town's: "a town with no cars, | 1 km across"."""
    sentence = here.items[begin_of(here.items, here.at, ENDS) : here.at]
    first = next((one for one in sentence if one.has("noun", "head")), thing)
    return thing.noun_class in _LIVING and first.noun == "city"


def is_site(here: Here, owner: Item) -> bool:
    """Return whether a head is the site: the first place of the text, nothing unknown about it."""
    at = here.syntax.index(owner)
    phrase = here.syntax.phrase(at)
    if not is_whole(owner) or phrase is None:
        return False
    if here.quantity.attribute in ("across", "side"):
        return True
    known = not any(item.kind == "unknown" for item in here.items[phrase.first : at])
    places = any(
        one.noun == "city" or "district=" in one.get("slot") for one in here.items[: phrase.first]
    )
    on = phrase.first > 0 and here.items[phrase.first - 1].text in ("on", "onto", "into")
    if on and owner.text == "plot" and here.items[phrase.first].text in ("a", "an"):
        return True  # "100 houses on a plot | 50 m by 50 m"
    return owner.text in _SITES or (known and not places and not is_plural(owner.text))


def _width(here: Here, noun: Item) -> None:
    measure = "length" if here.quantity.attribute == "length" else "width"
    others = any(one.noun in ROADS and one.noun != noun.noun for one in here.items)
    if others and noun.noun == "road" and noun.words[-1] in _LANES:
        noun.state = noun.state or READ
        here.found.leave(here.item, f"{measure} of the {here.found.said(noun)}")
        return
    told = bool(here.quantity.attribute) or noun.noun in _STREAMS
    told = told or (noun.noun in ROADS and value_of(here.quantity) <= WIDEST)
    if told and noun.noun in ELEMENTS:
        if here.takes(noun, measure):
            here.found.add_bounded(f"{noun.noun}.{measure}", here.quantity, here.item)
        else:
            here.found.refuse(here.item, noun.noun, measure)
        return
    if noun.noun_class not in ("road", "element", "plant") or not told:
        here.found.leave(here.item, f"{measure} of the {noun.noun}")
        return
    mark(noun)
    here.found.add_bounded(f"{key_of(noun)}.{measure}", here.quantity, here.item)


def mark(noun: Item | None) -> None:
    """Count a street as read, since something is said of it."""
    if noun is None or noun.has("slot") or noun.noun in ("ring_road", "motorway"):
        return
    if noun.noun_class == "road":
        noun.state = noun.state or READ


def read_pairs(here: Here) -> None:
    """Read two lengths: those of the site or of blocks."""
    on = here.before is not None and here.before.get("rel") in ("on", "in")
    on = on or (here.before is not None and here.before.is_mark(":"))  # "a class: | 600 x 600 m"
    owner = None if on else here.owner()  # "houses with gardens on | 100 x 100 m"
    if _of_blocks(here):
        here.found.leave(here.item, "size of the blocks")
        return
    if here.before is not None and here.before.text in ("each", "every"):
        owner = here.element_before() or owner  # "two squares, each | 40 x 40 m"
        here.before.state = here.before.state or READ
    own = owner is not None and owner.noun_class == "element"
    if owner is not None and not own and not is_site(here, owner):
        here.found.leave(here.item, f"size of the {here.found.said(owner)}")
        return
    if own and owner is not None and owner.noun in _SIZED:
        area = (here.quantity.low or 0.0) * (here.quantity.other or 0.0)
        here.found.add(f"{owner.noun}.area", round(area), here.item)
        return
    key = f"{owner.noun}.size" if own and owner is not None else "size"
    here.found.add(f"{key}.x", here.quantity.low or 0.0, here.item)
    here.found.add(f"{key}.y", here.quantity.other or 0.0, here.item)


def read_slope(here: Here) -> None:
    """Read how steep the land or streets are."""
    """Read how steep streets are, or the land; of what else slopes lie under is left open."""
    clause = here.clause()
    before = here.before_in_clause()
    roads = any(one.noun_class == "road" or one.noun in ("sidewalk", "ramp") for one in clause)
    land = any(one.noun == "landscape" or "terrain=" in one.get("slot") for one in clause)
    others = any(one.noun_class in (*BUILDINGS, "plant") for one in clause)
    none = any(one.has("neg") and one.text in ("none", "nothing") for one in before)
    paths = any(one.noun == "path" for one in clause)
    if ((others or none) and not roads) or paths:
        here.found.leave(here.item, "slope of what stands there")  # "no house on slopes over 15 %"
    elif here.quantity.dimension == "length":
        here.found.leave(here.item, "how far it rises")  # "the road climbs 60 m"
    else:
        key = "terrain.slope" if land and not roads else "roads.slope"
        here.found.add_bounded(key, here.quantity, here.item)


def is_a_side(here: Here) -> bool:
    """Return whether a half is that of a side: "the northern | half"."""
    return here.quantity.dimension == "part" and here.before is not None and here.before.has("side")


def is_green(item: Item) -> bool:
    """Return whether an item speaks of green land."""
    return item.get("rel") == "green" or item.noun in _GREEN
