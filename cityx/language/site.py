"""The site in words: how high its land rises and where, how its waters lie."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace

from cityx.language.here import Here
from cityx.language.lexicon.words import forms_of
from cityx.language.named_sides import place_of
from cityx.language.scan import ENDS, Item, Quantity
from cityx.language.scopes import READ

UP = ("rise", "climb", "ascend", "up", "uphill", "upward", "higher", "highest", "high")
DOWN = (
    "fall", "drop", "descend", "down", "downhill", "downward", "lower", "lowest", "dip",
)  # fmt: skip
OPPOSITE: Mapping[str, str] = {
    "north": "south", "south": "north", "east": "west", "west": "east",
}  # fmt: skip
LAND = ("ground", "land", "terrain", "site", "hillside", "landscape")
PLACES = ("city", "landscape")
RELIEF = ("relief", "elevation", "height difference", "elevation difference", "elevation change")
STEPS = ("terraces", "steps", "levels")
MEET = ("meet", "meets", "meeting", "join", "joins", "merge", "merges", "converge", "unite")
RUNS = ("ridge", "valley")  # forms of land along an axis
FLOWING = ("river", "canal")
WIDE = (*FLOWING, "beach")
SIDED = (*FLOWING, "lake", "pond", "beach", "sea", "island")
_REACH = 6  # items between a verb and what it says of the land


def read_site(here: Here) -> None:
    """Read what an item says of the land and the waters of a site, before other rules do."""
    item = here.item
    if item.text == "flat":
        _flat(here)
    elif item.quantity is not None:
        _first(here, _land_measure, _steps, _each_width)
    elif item.has("side"):
        _first(here, _high_side, _water_side)
    elif item.has("axis"):
        _land_axis(here)
    elif item.has("strength") or item.text in ("steep", "gently", "steeply"):
        _steepness(here)
    elif item.noun == "center" or (item.get("rel") == "in" and "middle" in item.words):
        _water_middle(here)
    elif item.text in MEET:
        _meeting(here)
    elif item.text == "straight" and here.after is not None and here.after.noun == "canal":
        here.found.add("canal.straight", "yes", item)


def _flat(here: Here) -> None:
    """Read "a completely flat test area", in which "flat" is no home."""
    head = here.syntax.modifies(here.at)
    thing = here.items[head] if head >= 0 else None
    if thing is not None and (thing.noun in PLACES or "district=" in thing.get("slot")):
        here.found.add("terrain", "flat", here.item)


def _first(here: Here, *rules: Callable[[Here], bool]) -> None:
    """Apply the first rule that reads something."""
    for rule in rules:
        if rule(here):
            return


def _land(item: Item | None) -> str:
    """Return the form of land that an item names, "" for none."""
    if item is None or item.state == "negated":
        return ""
    for pair in item.get("slot").split():
        key, _, value = pair.partition("=")
        if key == "terrain" and value != "flat":
            return value
    return ""


def _is_one_of(item: Item, words: tuple[str, ...]) -> bool:
    """Return whether an item is one of some words, in any form, or begins with it."""
    return item.text in words or any(form in words for form in forms_of((item.words or ("",))[0]))


def _land_measure(here: Here) -> bool:
    """Read metres of relief and the grade of a slope: "hills of 40 m", "rises 30 m"."""
    quantity = here.quantity
    if quantity.dimension == "share":
        return _grade(here)
    if quantity.dimension != "length" or quantity.attribute in ("width", "spacing"):
        return False
    if any(one.text == "at" for one in here.items[max(here.at - 1, 0) : here.at]):
        here.found.leave(here.item, "how far it is above the sea")
        return True
    around = _land_beside(here)
    if around is not None:
        here.found.add_bounded("terrain.relief", quantity, here.item)
        return True
    verb = _verb_before(here)
    if verb is None:
        return False
    here.found.add_bounded("terrain.relief", quantity, here.item)
    if not any(_land(one) for one in here.items):
        here.found.add("terrain", "slope", verb or here.item)
    return True


def _land_beside(here: Here) -> Item | None:
    """Return the form of land that a length stands beside: "hills of | 40 m", "a | 40 m hill"."""
    for item in reversed(here.items[max(0, here.at - 4) : here.at]):
        if _land(item) or item.text in RELIEF:
            return item
        if not (item.kind == "function" or item.get("rel") in ("of", "be") or item.has("bound")):
            break
    for item in here.items[here.at + 1 : here.at + 4]:
        if _land(item) or item.text in RELIEF:
            return item
        passes = item.kind == "function" or item.get("rel") == "of" or item.has("height")
        if not passes:
            break
    return None


def _verb_before(here: Here) -> Item | None:
    """Return the verb that says that land rises or falls by a length."""
    bound = here.item.words[:2] == ("up", "to")
    own = here.quantity.attribute == "slope" or (not bound and _is_one_of(here.item, UP + DOWN))
    before = list(reversed(here.items[max(0, here.at - 3) : here.at]))
    verb = next((one for one in before[:2] if _is_one_of(one, UP[:3] + DOWN[:3])), None)
    if verb is None and not (own and here.item.words[0] not in ("high", "higher", "lower")):
        return None
    subject = _subject(here)
    if subject is not None and subject.noun not in PLACES and subject.text not in LAND:
        return None
    return verb if verb is not None else here.item


def _subject(here: Here) -> Item | None:
    """Return the last noun before an item in its clause."""
    for item in reversed(here.items[: here.at]):
        if item.is_mark(ENDS):
            return None
        if item.noun and item.noun not in ("center", "sky"):
            return item
        if _land(item):
            return None
    return None


def _grade(here: Here) -> bool:
    """Read how steep the land is: "a slope of 8 percent" where no street is spoken of."""
    clause = here.clause()
    if here.quantity.exact is None or any(one.noun_class == "road" for one in clause):
        return False
    said = here.quantity.attribute == "slope" or any(one.get("attr") == "slope" for one in clause)
    names_land = any(one.text in LAND or _land(one) for one in here.items)
    article = here.before is not None and here.before.text in ("a", "the", "at", "on")
    if not said or not (names_land or (article and here.item.words[0] == "slope")):
        return False
    here.found.add("terrain.slope", here.quantity.exact, here.item)
    for one in clause:
        if one.get("attr") == "slope" and one.kind == "phrase":
            one.state = one.state or READ
    if not any(_land(one) for one in here.items):
        here.found.add("terrain", "slope", here.item)
    return True


def _high_side(here: Here) -> bool:
    """Read where the land is high: "rises to the north", "slopes down to the south".

    What faces south falls to the south: "a south-facing slope", "on a slope facing south".
    """
    side = here.item.get("side")
    if side not in OPPOSITE:
        return False
    behind = [one for one in here.items[here.at + 1 : here.at + 5] if one.kind != "mark"]
    if len(behind) > 1 and behind[0].text == "facing" and (
        behind[1].get("attr") == "slope" or _land(behind[1]) == "slope"
    ):  # fmt: skip
        here.found.add("terrain.side", OPPOSITE[side], here.item, behind[1])
        here.found.add("terrain", "slope", behind[1])
        for one in behind[:2]:
            one.state = one.state or READ
        return True
    down, verb = False, None
    for item in reversed(here.items[max(0, here.at - _REACH) : here.at]):
        if item.is_mark(ENDS) or item.has("verb") or (item.noun and item.noun not in PLACES):
            break
        words = (item.text, *item.words)
        if _is_one_of(item, DOWN) or any(word in (*DOWN, "facing") for word in words):
            down, verb = True, verb or item
        elif _is_one_of(item, UP) or item.get("attr") == "slope" or _land(item) == "slope":
            verb = verb or item
    if verb is None or (_subject_is_a_thing(here, verb)):
        return False
    here.found.add("terrain.side", OPPOSITE[side] if down else side, here.item, verb)
    for item in here.items[max(0, here.at - _REACH) : here.at]:
        if _is_one_of(item, UP + DOWN) or item.get("attr") == "slope":
            item.state = item.state or READ
    if not any(_land(one) for one in here.items) and not here.found.has("terrain"):
        here.found.add("terrain", "slope", verb)
    return True


def _subject_is_a_thing(here: Here, verb: Item) -> bool:
    """Return whether a verb speaks of buildings or streets and not of the land."""
    at = next(k for k, one in enumerate(here.items) if one is verb)
    subject = _subject(replace(here, at=at))
    if subject is None:
        return verb.text in ("high", "higher", "lower", "up", "down") and not any(
            _land(one) or one.quantity is not None for one in here.items[: here.at]
        )
    return subject.noun not in PLACES and subject.text not in LAND


def _land_axis(here: Here) -> bool:
    """Read along which axis a ridge or a valley runs."""
    form = next((_land(one) for one in reversed(here.clause()) if _land(one) in RUNS), "")
    street = any(one.noun_class == "road" for one in here.clause())
    water = any(one.noun in FLOWING for one in here.clause())
    axis = here.item.get("axis")
    if axis not in ("north_south", "east_west") or street or not (form or water):
        return False
    if form:
        here.found.add("terrain.axis", axis, here.item)
    if water:
        here.found.add("river.axis", axis, here.item)
    for one in here.clause():
        if one.get("mode") == "run":
            one.state = one.state or READ
    return True


def _steepness(here: Here) -> bool:
    """Read "gentle hills" and "steep hills"."""
    gentle = here.item.get("strength") == "light" or here.item.text == "gently"
    steep = here.item.text in ("steep", "steeply")
    near = here.items[here.at + 1 : here.at + 2]
    if not near or not _land(near[0]) or not (gentle or steep):
        return False
    here.found.add("terrain.grade", "gentle" if gentle else "steep", here.item)
    return True


def _steps(here: Here) -> bool:
    """Read how many terraces there are."""
    behind = here.after
    if here.quantity.dimension != "count" or behind is None or behind.text not in STEPS:
        return False
    if not any(_land(one) in ("terraces", "slope", "hill", "hilly") for one in here.items):
        return False
    here.found.add_bounded("terrain.steps", here.quantity, here.item, behind)
    return True


def _each_width(here: Here) -> bool:
    """Read "two rivers, each | 20 m wide" and "a river, | 40 m wide"."""
    quantity: Quantity = here.quantity
    if quantity.dimension != "length" or quantity.attribute != "width":
        return False
    before = here.before
    if before is None or not (before.text in ("each", "both") or before.is_mark(",")):
        return False
    noun = here.element_before()
    if noun is None or noun.noun not in WIDE:
        return False
    here.found.add_bounded(f"{noun.noun}.width", quantity, here.item)
    before.state = before.state or ("" if before.is_mark(",") else READ)
    return True


def _water_before(here: Here) -> Item | None:
    """Return the water in the same clause before an item."""
    for item in reversed(here.before_in_clause()):
        if item.is_mark(":"):
            return None
        if item.noun:
            if item.noun in SIDED and item.state in ("", READ):
                return item
            if item.noun not in ("city", "center"):
                return None
    return None


def _water_side(here: Here) -> bool:
    """Read a side of the site that water lies along: "along the east edge"."""
    water, side = _water_before(here), here.item.get("side")
    if any(one.kind == "unknown" for one in here.phrase_of(here.item) if one.span < here.item.span):
        return False  # "gatehouses | north and south"
    if here.before is not None and here.before.text == "its" and water is not None and any(
        one.noun == "city" or "district=" in one.get("slot")
        for one in here.items[here.items.index(water) : here.at]
    ):  # fmt: skip
        return False  # "a lake with a village on its | north side"
    if water is None or side not in OPPOSITE or place_of(here.items, here.at) is not None:
        return False  # "a pond | south of the inn"
    edges = [one for one in here.items[here.at + 1 : here.at + 2] if one.text in ("edge", "border")]
    here.found.add(f"{water.noun}.side", side, here.item, *edges)
    for one in here.items[max(0, here.at - 3) : here.at]:
        if one.get("rel") in ("along", "in"):
            one.state = one.state or READ
    return True


def _water_middle(here: Here) -> bool:
    """Read "a river through the middle of the town"."""
    water = _water_before(here)
    if here.phrase_of(here.item)[0].text in ("a", "an"):  # "a river town with | an old core"
        return False
    if water is None or water.noun not in (*FLOWING, "lake"):
        return False
    here.found.add(f"{water.noun}.side", "middle", here.item)
    return True


def _meeting(here: Here) -> bool:
    """Read how many rivers flow together."""
    water = next((one for one in reversed(here.clause()) if one.noun == "river"), None)
    if water is None or not water.span < here.item.span:
        return False
    at = next(k for k, one in enumerate(here.items) if one is water)
    count = here.items[at - 1].quantity if at else None
    known = count is not None and count.dimension == "count" and count.exact is not None
    more = [here.items[at - 1]] if known else []
    rivers = count.exact if known and count is not None and count.exact is not None else 2.0
    here.found.add("river.meet", rivers, here.item, water, *more)
    for one in here.items[here.at + 1 : here.at + 4]:
        if one.noun == "center" or one.get("rel") == "in":
            one.state = one.state or READ
    return True
