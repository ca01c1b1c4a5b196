"""Quantities: numbers with units become slots of what they measure."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace

from cityx.language.here import BUILDINGS, COUNTED, LANDMARKS, ROADS, Here
from cityx.language.scan import ENDS, Item, Quantity
from cityx.language.scopes import READ
from cityx.town.elements import ELEMENTS

_GREEN = ("green", "park", "garden", "forest", "lawn")
_WHOLE = ("city", "landscape", "everything")
_SIDES = {"width": ("size.x",), "length": ("size.y",)}
# Words behind a number of which something else is counted.
_GROUPS = ("rows", "row", "groups", "group", "lines", "clusters", "pairs", "sets")
YEARS = (1000.0, 2100.0)
FEW = 4.0  # barns, factories... that stand among other houses, however it is said
_BEHIND_LANES = 3  # items between "two lanes" and "in each direction"


def read_quantity(here: Here) -> None:
    """Add the slots that a quantity says."""
    rule = _RULES.get(here.quantity.dimension) if here.item.quantity is not None else None
    if rule is not None:
        rule(here)


def _value(quantity: Quantity) -> float:
    return quantity.high or quantity.low or 0.0


def _key(noun: Item) -> str:
    if noun.noun_class == "road":
        return ROADS.get(noun.noun, noun.noun)
    return COUNTED.get(noun.noun_class, noun.noun)


def _counts(here: Here) -> None:
    noun = here.noun_behind()
    about = _no_count(here, noun)
    if about:
        here.found.leave(here.item, about)
        return
    if noun is None and here.after is not None and here.after.kind == "unknown":
        return  # "a factory with | two chimneys"
    if noun is None and here.quantity.exact != 1:
        of_them = here.after is not None and here.after.get("rel") == "of"
        noun = here.noun_before() or here.buildings_before(past_end=of_them)
    pronoun = noun is not None and here.item.text == "one" and noun.noun_class in ("place", "road")
    if noun is None or pronoun:
        if here.quantity.exact == 1:
            here.item.state = READ
        return
    few = _value(here.quantity) <= FEW
    single = noun.noun in LANDMARKS or (noun.noun in ELEMENTS and (few or _within_a_town(here)))
    key = f"{noun.noun}.count" if single else _count_key(noun)
    if key:
        here.found.add_bounded(key, here.quantity, here.item, noun)
    if noun.noun_class == "type" and not single:
        here.found.add("building.type", noun.noun, noun)


def _no_count(here: Here, noun: Item | None) -> str:
    """Return what a plain number is when it counts nothing, "" when it may."""
    before, after = here.before, here.after
    if here.quantity.attribute == "speed" or (before is not None and before.get("attr") == "speed"):
        return "speed"
    if any(item.text == "per" for item in here.items[here.at + 1 : here.at + 4]):
        return "for each of others"
    if after is not None and after.text == "s" and after.span[0] == here.item.span[1]:
        return "years"
    if before is not None and before.text == "in" and noun is None and _is_a_year(here.quantity):
        return "year"
    if after is not None and (after.words[:1] or ("",))[0] in _GROUPS:
        after.state = READ
        return after.words[0]
    if _in_a_row(here):
        return "one of several numbers"
    if noun is None:
        return ""
    if here.quantity.exact == 1 and noun.noun_class == "type" and noun.noun not in ELEMENTS:
        others = [item for item in here.items if item.noun_class in BUILDINGS and item is not noun]
        if others:
            noun.state = READ
            return f"a single {noun.noun}"
    if before is not None and before.text == "for" and noun.noun_class in ("vehicle", "person"):
        return f"room for the {noun.noun}"
    if after is not None and after.has("rank"):
        return f"the {after.text} {noun.noun}"
    for measure in here.items[here.items.index(noun) + 1 :][:1]:
        own = measure.quantity is not None and measure.quantity.dimension != "count"
        if own and here.quantity.exact is None:
            measure.state = READ
            return f"{here.found.said(measure)}, counted"  # "fewer than 5 houses over 50 m"
    return ""


def _in_a_row(here: Here) -> bool:
    """Return whether a number stands in a list of numbers: "towers of 40, | 60 and 90 metres"."""
    behind = here.items[here.at + 1 : here.at + 3]
    return (
        len(behind) == 2
        and (behind[0].is_mark(",") or behind[0].get("rel") == "and")
        and behind[1].quantity is not None
    )


def _is_a_year(quantity: Quantity) -> bool:
    return quantity.exact is not None and YEARS[0] <= quantity.exact <= YEARS[1]


def _within_a_town(here: Here) -> bool:
    """Return whether things are counted among others: "a town with a pond, | three factories"."""
    begin = 0
    for at, item in enumerate(here.items[: here.at]):
        begin = at if item.is_mark(ENDS) else begin
    before = here.items[begin : here.at]
    return any(item.text == "with" for item in before) and any(
        item.noun == "city" or "district=" in item.get("slot") for item in before
    )


def _count_key(noun: Item) -> str:
    if noun.noun_class in BUILDINGS or noun.noun == "everything":
        return "building.count"
    if noun.noun_class in ("element", "vehicle", "person", "plant"):
        return f"{_key(noun)}.count"
    return {
        "avenue": "roads.avenues", "ring_road": "roads.rings", "road": "roads.count",
        "main_street": "roads.main.count", "motorway": "roads.motorways",
    }.get(noun.noun, "")  # fmt: skip


def _lanes(here: Here) -> None:
    """Read lanes; "in each direction" doubles them."""
    both = 1.0
    for other in here.items[here.at + 1 : here.at + 1 + _BEHIND_LANES]:
        if other.is_mark(ENDS) or other.quantity is not None:
            break
        if other.get("rel") == "direction" or other.get("attr") == "side":
            both = 2.0
            other.state = READ
            break
    low, high = (
        None if end is None else end * both for end in (here.quantity.low, here.quantity.high)
    )
    noun = here.noun()
    key = ROADS.get(noun.noun, "roads") if noun is not None else "roads"
    here.found.add_bounded(f"{key}.lanes", Quantity("lanes", low, high), here.item)


def _lengths(here: Here) -> None:
    what = here.quantity.attribute
    noun = here.noun()
    if noun is None and what == "width":
        noun = here.noun_past_comma()
    every = here.before is not None and here.before.text in ("every", "each")
    unknown = here.before is not None and here.before.kind == "unknown"
    if noun is None and unknown and not what:
        return  # "visibility | under 1 km"
    if _is_depth(here):
        here.found.leave(here.item, "depth")
    elif _is_distance(here):
        here.found.leave(here.item, "distance")
    elif _of_blocks(here):
        here.found.leave(here.item, "size of the blocks")
    elif what == "slope":
        here.found.add_bounded("roads.slope", here.quantity, here.item)
    elif what == "spacing" or (every and not what):
        _spacing(here)
    elif _is_extent(here, noun):
        _extent(here, "")
    elif (road := _road_past_comma(here, noun)) is not None:
        here.found.add_bounded(f"{_key(road)}.length", here.quantity, here.item)
    elif what == "height" or (not what and (noun is None or noun.noun_class in BUILDINGS)):
        own = noun is not None and (
            noun.noun_class in ("element", "plant") or noun.noun in ELEMENTS
        )
        key = _key(noun) if own and noun is not None else "building"
        here.found.add_bounded(f"{key}.height", _highest(here, noun), here.item)
    elif noun is None or noun.noun in _WHOLE:
        _extent(here, what)
    else:
        _width(here, noun)


def _is_distance(here: Here) -> bool:
    """Return whether a length lies between things: "within 200 m of", "150 m away from"."""
    after = here.after
    if after is None or here.quantity.attribute:
        return False
    return after.text in ("away", "from") or (
        after.get("rel") == "of" and "within" in here.item.words
    )


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
    if noun is None or noun.noun_class in ("plant", "road", "place") or _is_green(noun):
        here.found.add("nature.spacing", _value(here.quantity), here.item)
    else:
        here.found.leave(here.item, f"spacing of the {noun.noun}")


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


def _highest(here: Here, noun: Item | None) -> Quantity:
    """Return the height of "the highest building", which bounds that of all."""
    ranks = [one for one in here.clause() if one.get("rank") == "tallest"]
    if noun is None or not ranks or here.quantity.exact is None:
        return here.quantity
    ranks[0].state = READ
    return replace(here.quantity, low=None)


def _extent(here: Here, what: str) -> None:
    if here.before is not None and here.before.text == "each":
        return  # "blocks, each 100 m wide" are no city of that width
    for key in _SIDES.get(what, ("size.x", "size.y")):
        here.found.add(key, _value(here.quantity), here.item)


def _width(here: Here, noun: Item) -> None:
    measure = "length" if here.quantity.attribute == "length" else "width"
    own = noun.noun_class in ("road", "element", "plant")
    key = f"{_key(noun)}.{measure}" if own else "building.height"
    here.found.add_bounded(key, here.quantity, here.item)


def _pairs(here: Here) -> None:
    noun = here.noun()
    if _of_blocks(here):
        here.found.leave(here.item, "size of the blocks")
        return
    own = noun is not None and noun.noun_class == "element"
    key = f"{noun.noun}.size" if own and noun is not None else "size"
    here.found.add(f"{key}.x", here.quantity.low or 0.0, here.item)
    here.found.add(f"{key}.y", here.quantity.other or 0.0, here.item)


def _areas(here: Here) -> None:
    noun = here.noun_behind()
    if noun is None and here.before is not None and here.before.get("rel") == "of":
        noun = here.noun_before(3)
    if noun is None and here.before is not None and here.before.text == "each":
        noun = here.element_before()
    if noun is None and here.after is not None and here.after.text == "each":
        here.found.leave(here.item, "area of each")
        return
    own = noun is not None and noun.noun_class == "element"
    key = f"{noun.noun}.area" if own and noun is not None else "size.area"
    value = here.quantity.exact
    if value is None:
        here.found.add_bounded(key, here.quantity, here.item)
    elif value >= 1.0:
        here.found.add(key, round(value), here.item)


def _shares(here: Here) -> None:
    """Read a percentage: of green ground, of a slope, or of the buildings."""
    clause = here.clause()
    green = next((one for one in clause if _is_green(one)), None)
    if here.quantity.attribute == "slope" or any(one.get("attr") == "slope" for one in clause):
        here.found.add_bounded("roads.slope", here.quantity, here.item)
    elif green is not None:
        here.found.add_bounded("green.share", here.quantity, here.item, green)
    else:
        look = next((one for one in clause if one.has("material")), None)
        kind = next((one for one in clause if one.noun_class == "type"), None)
        named = look or kind
        if named is not None:
            value = named.get("material") or named.noun
            here.found.add_bounded(f"{value}.share", here.quantity, here.item, named)


def _is_green(item: Item) -> bool:
    return item.get("rel") == "green" or item.noun in _GREEN


def _speeds(here: Here) -> None:
    noun = here.noun()
    of = {"road": "roads", "person": "pedestrian"}.get(noun.noun_class if noun else "", "vehicle")
    of = "roads" if "limit" in here.item.words else of
    here.found.add_bounded(f"{of}.speed", here.quantity, here.item)


def _hours(here: Here) -> None:
    minutes = round((here.quantity.low or 0.0) * 60)
    here.found.add("time", f"{minutes // 60 % 24:02d}:{minutes % 60:02d}", here.item)


def _bounds_of(key: str) -> Callable[[Here], None]:
    """Return a rule for a dimension that measures one thing only."""

    def rule(here: Here) -> None:
        here.found.add_bounded(key, here.quantity, here.item)

    return rule


_RULES: Mapping[str, Callable[[Here], None]] = {
    "count": _counts, "floors": _bounds_of("building.floors"), "lanes": _lanes,
    "length": _lengths, "pair": _pairs, "area": _areas, "share": _shares, "part": _shares,
    "speed": _speeds, "hour": _hours, "temperature": _bounds_of("temperature"),
    "people": _bounds_of("population"),
}  # fmt: skip
