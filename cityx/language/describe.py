"""Describing: the items of an instruction become slots."""

from __future__ import annotations

from collections.abc import Sequence

from cityx.language.brief import Note, Span
from cityx.language.here import BUILDINGS, COUNTED, LANDMARKS, ROADS, Findings, Here
from cityx.language.lexicon.phrases import SPECIES
from cityx.language.lexicon.words import forms_of
from cityx.language.quantities import read_quantity
from cityx.language.scan import ENDS, Item
from cityx.language.scopes import KEPT, NEGATED, READ
from cityx.town.elements import ELEMENTS

_WIDE = ("river", "canal", "beach", "bridge", "promenade")  # elements with a width
_FALLS = ("rain", "snow", "fog")  # weather with an intensity of its own
_AIR = ("season=", "time=", "weather=", "wetness=")
_OF_BUILDINGS = ("style", "building.roof")
_NO_PLACE = ("city", "landscape", "center", "sky")
_TURNED = ("right", "left", "top", "bottom")  # sides of a picture, not of a city
# What stands behind a word about how much of it there is.
_THINGS = {"nature.trees": "tree", "pedestrians": "pedestrian", "lights": "light"}
_CONTENT = {
    "slot", "noun", "material", "color", "amount", "strength", "size", "height", "width", "side",
    "axis", "use", "compared", "attr", "source", "mode", "rank", "verb", "vague", "surface",
    "later",
}  # fmt: skip
# Kinds of words that carry a meaning only beside others.
_FUNCTION = {
    "attr", "mode", "verb", "rel", "bound", "approx", "exact", "neg", "after_neg", "neither",
    "nothing_but", "except", "keep", "unchanged", "any_source",
}  # fmt: skip
_PLACED = ("element", "plant", "person", "vehicle", *BUILDINGS)
_RINGED = ("plaza", "park")
_BESIDE = ("on", "by", "at", "in", "near", "facing", "along", "beside")
_ENDED = ("stopped", "ended", "ceased", "passed")
_KINDS_OF_TREES = frozenset(
    name for kind, names in SPECIES.items()
    for name in (kind, *names)
)  # fmt: skip
# Words for a measure that say something without a number: "a long avenue", not "the length".
_DESCRIBING = ("long", "deep", "broad", "steep", "sloping", "fast", "square")


def describe(text: str, items: Sequence[Item]) -> Findings:
    """Read what the items say of a city; each item that says something counts as read."""
    found = Findings(text)
    for at, item in enumerate(items):
        if item.state in (NEGATED, KEPT):
            _settled(Here(found, items, at))
    rules = (
        _strengths, read_quantity, _amounts, _shapes, _middles, _sides, _phrases, _nouns, _looks,
        _places,
    )  # fmt: skip
    for rule in rules:
        for at, item in enumerate(items):
            if not item.state:
                rule(Here(found, items, at))
    return found


def unread(items: Sequence[Item], *, described: bool, every: bool = False) -> list[Item]:
    """Return the items with content that were not read.

    Parameters
    ----------
    described
        Whether they describe a city; where things stand to each other is content there, and in
        commands part of what is selected.
    every
        Whether something was read of each thing.
    """
    return [
        item for at, item in enumerate(items)
        if not item.state
        and (_has_content(item) or (described and _limits(items, at, every=every)))
    ]  # fmt: skip


def _limits(items: Sequence[Item], at: int, *, every: bool) -> bool:
    """Return whether a word says of how many or where something holds: only, each, between."""
    item = items[at]
    if item.text in ("only", "between"):
        return True
    behind = [one for one in items[at + 1 : at + 4] if one.noun]
    return not every and item.text in ("each", "every", "both") and bool(behind) and (
        behind[0].noun_class in ("element", "road", "type", "building", "place")
    )  # fmt: skip


def _has_content(item: Item) -> bool:
    if item.kind in ("unknown", "id", "file"):
        return True
    if item.quantity is not None:
        return item.quantity.exact != 1
    if item.text == "some":
        return False
    kinds = {kind for kind, _ in item.senses}
    describes = item.text in _DESCRIBING and "attr" in kinds
    return describes or (bool(kinds & _CONTENT) and not kinds <= _FUNCTION)


def _settled(here: Here) -> None:
    """Put what is denied or protected into its own list."""
    item = here.item
    denied = item.state == NEGATED
    value = _settled_value(here)
    if denied and item.get("slot") in ("weather=cloudy", "weather=overcast"):
        here.found.add("weather", "clear", item)
    elif value and denied and _there_alone(here):
        here.found.leave(item, "denied in one place alone")
    elif value and denied and _of_a_kind(here):
        here.found.leave(item, "denied of one kind alone")
    elif value and denied:
        here.found.deny(value, item)
    elif value and any(one.has("except") for one in here.clause() if one.span < item.span):
        here.found.leave(item, "excepted")
    elif value:
        here.found.keep(value, item)
    elif denied and (item.has("height", "width", "size", "attr") or item.get("rel") == "near"):
        here.found.leave(item, "denied")


def _there_alone(here: Here) -> bool:
    """Return whether something is denied in one place alone: "no trees on the main road"."""
    rel = here.after.get("rel") if here.after is not None else ""
    place = here.items[here.at + 2 : here.at + 4]
    nouns = [one for one in place if one.noun and one.noun not in ("road", "city", "landscape")]
    element = any(one.noun_class == "element" for one in nouns)
    quarter = any("district=" in one.get("slot") for one in here.items[here.at + 2 : here.at + 5])
    if rel == "in":
        return quarter or (here.item.noun in ROADS and element)
    return rel in ("on", "along", "near", "around") and bool(nouns)


def _of_a_kind(here: Here) -> bool:
    """Return whether things of one kind alone are denied: "no narrow streets", "no parked cars"."""
    before = here.before
    if here.item.words[0] == "parked" or (
        before is not None and (before.kind == "unknown" or before.text in ("through", "parked"))
    ):
        return True
    looks = ("width", "size", "height", "material", "color", "compared")
    return before is not None and before.has(*looks) and not here.item.has("slot")


def _settled_value(here: Here) -> str:
    """Return the name of what is denied or protected; of a slot and a noun, the noun is it."""
    item = here.item
    if item.kind == "id":
        return item.text
    if item.has("noun"):
        if item.noun in _NO_PLACE:
            return "" if item.state == NEGATED else "everything"
        return COUNTED["plant"] if item.noun_class == "plant" else item.noun
    if item.has("slot"):
        key, _, value = item.get("slot").partition(" ")[0].partition("=")
        return _THINGS.get(key, value)
    alone = here.after is None or not here.after.noun
    return (item.get("material") or item.get("color")) if alone else ""


def _strengths(here: Here) -> None:
    """Read "heavy" beside rain, snow, fog or traffic."""
    strength = here.item.get("strength")
    if not strength:
        return
    for other in (*here.items[here.at + 1 : here.at + 3], here.before):
        if other is None or other.is_mark(ENDS + ",") or other.state == NEGATED:
            continue
        weather = other.get("slot").removeprefix("weather=")
        if weather in _FALLS:
            here.found.add("weather", weather, other)
            here.found.add(f"{weather}.intensity", strength, here.item)
        elif weather in ("storm", "haze"):
            here.found.leave(here.item, f"strength of {weather}")
        elif other.text == "traffic" or (other.noun == "vehicle" and here.item.text == "busy"):
            here.found.add("traffic", strength, here.item, other)
        if other.has("noun", "slot"):
            return


def _amounts(here: Here) -> None:
    """Read "lots of" and "few" with the noun they go with."""
    amount = here.item.get("amount")
    if not amount or here.item.has("slot"):
        return
    noun = here.before if here.item.text == "everywhere" else here.noun_behind()
    if noun is None:
        return
    busy = "heavy" if amount == "many" else "light"
    if noun.noun_class == "plant" or (noun.noun == "green" and amount == "many"):
        here.found.add("nature.trees", amount, here.item, noun)
    elif noun.noun == "vehicle":
        here.found.add("traffic", busy, here.item, noun)
    elif noun.noun_class == "person" and noun.noun != "dog":
        here.found.add("pedestrians", busy, here.item, noun)


def _shapes(here: Here) -> None:
    """Read "wide", "tall" and "small" with the noun they go with."""
    item = here.item
    if item.has("slot") or not item.has("width", "height", "size"):
        return
    noun = here.noun_behind()
    if item.has("width", "height"):
        noun = noun or _subject(here)
        _shape(here, noun)
    elif (noun is None and _district_behind(here)) or (noun is not None and noun.noun == "city"):
        here.found.add("size", item.get("size"), item)
    elif noun is not None:
        here.found.leave(item, f"size of the {noun.noun}")


def _shape(here: Here, noun: Item | None) -> None:
    width, height = here.item.get("width"), here.item.get("height")
    if noun is None:
        return
    if height and (noun.noun_class in BUILDINGS or noun.noun == "everything"):
        here.found.add("building.height", height, here.item)
    elif width and noun.noun in ROADS:
        here.found.add(f"{ROADS[noun.noun]}.width", width, here.item)
    elif width and noun.noun in _WIDE:
        here.found.add(f"{noun.noun}.width", width, here.item)
    else:
        here.found.leave(here.item, f"{'width' if width else 'height'} of the {noun.noun}")


def _subject(here: Here) -> Item | None:
    """Return the noun of "the streets are wide"."""
    before = here.before
    linked = before is not None and (
        before.get("rel") == "be" or before.kind == "function" or before.is_mark(":")
    )
    return here.noun_before(4) if linked else None


def _district_behind(here: Here) -> bool:
    for item in here.items[here.at + 1 : here.at + 4]:
        if "district=" in item.get("slot"):
            return True
        if not item.has("slot", "material", "color") and item.kind != "function":
            return False
    return False


def _sides(here: Here) -> None:
    """Read an axis, and a side with the element it places: one before it, or the next."""
    item = here.item
    if item.has("axis"):
        street = here.noun()
        if street is not None and street.noun_class == "element":
            here.found.leave(item, f"direction of the {street.noun}")
            return
        own = "motorway" if street is not None and street.noun == "motorway" else "main"
        here.found.add(f"roads.{own}.axis", item.get("axis"), item)
    if not item.has("side") or item.text in _TURNED:
        return
    other = _noun_after(here) if here.after is not None and here.after.get("rel") == "of" else None
    if other is not None and other.noun not in _NO_PLACE:
        here.found.leave(item, f"side of the {other.noun}")
        return
    things = [
        one for one in here.clause()
        if (one.noun_class == "element" or one.noun in LANDMARKS) and one.state in ("", READ)
    ]  # fmt: skip
    before = [one for one in things if one.span < item.span]
    behind = [one for one in things if one.span > item.span]
    placed = {slot.key for slot in here.found.slots}
    free = [one for one in before if f"{one.noun}.side" not in placed]
    if free or behind or before:
        thing = free[-1] if free else (behind or before[::-1])[0]
        here.found.add(f"{thing.noun}.side", item.get("side"), item)


def _noun_after(here: Here, far: int = 4) -> Item | None:
    """Return the next noun, past words that say nothing."""
    for item in here.items[here.at + 1 : here.at + 1 + far]:
        if item.noun:
            return item
        if item.is_mark(ENDS + ",") or item.quantity is not None:
            return None
    return None


def _thing_before(here: Here) -> Item | None:
    """Return the thing in the same clause that a place behind it is of."""
    for item in reversed(here.clause()):
        if item.span < here.item.span and item.noun_class in _PLACED:
            return item
    return None


def _middles(here: Here) -> None:
    """Read "in the middle" with the thing that is to be there."""
    words = {"center", "middle", "edge"}
    of_all = here.item.get("rel") in ("in", "near") and not words.isdisjoint(here.item.words)
    place = _noun_after(here) if of_all else None
    if here.item.noun != "center" and not (of_all and (place is None or place.noun == "city")):
        return
    where = "edge" if "edge" in here.item.words else "middle"
    thing = _thing_before(here)
    if thing is None:
        return
    one = thing.noun in ELEMENTS and not thing.words[-1].endswith("s")
    if one or (thing.noun in ("plaza", "park") and where == "middle"):
        here.found.add(f"{thing.noun}.side", where, here.item)
    else:
        here.found.leave(here.item, f"place of the {thing.noun}")


def _places(here: Here) -> None:
    """Note where one thing stands to another: nothing brings that about."""
    item = here.item
    if item.get("rel") not in ("in", "on", "near", "along", "around"):
        return
    place, thing = _noun_after(here), _thing_before(here)
    if place is None and thing is not None and item.get("rel") in ("near", "along", "around"):
        item.state = READ
        _leave_place(here, thing, item.span)  # "a forest behind", "a kiosk beside it"
    if place is None or thing is None or place.noun_class not in ("element", "type", "road"):
        return
    item.state = READ
    in_streets = thing.noun_class in ("vehicle", "person") and place.noun_class == "road"
    ringed = thing.noun == "tower" and item.get("rel") == "around" and place.noun in _RINGED
    if in_streets or ringed:
        return  # traffic is in the streets, and towers are built around squares and parks
    _leave_place(here, thing, (item.span[0], place.span[1]))


def _leave_place(here: Here, thing: Item, span: Span) -> None:
    said = f'"{here.found.text[slice(*span)]}" (where the {thing.noun} is) is left open.'
    here.found.notes.append(Note("left_open", said, span))


def _phrases(here: Here) -> None:
    """Read a phrase that says its slots by itself."""
    if _is_over(here) or _is_a_state(here):
        return
    thing = _thing_before(here) if here.item.words[0] in _BESIDE else None
    if thing is not None and here.item.get("slot").startswith(("district=", "terrain=")):
        _leave_place(here, thing, here.item.span)  # "a lighthouse on the coast"
    for pair in here.item.get("slot").split():
        key, _, value = pair.partition("=")
        if key == "not":
            here.item.state = READ
            here.found.deny(value, here.item)
        else:
            every = key in _OF_BUILDINGS and here.of_every_building()
            here.found.add(key, value, here.item, every=every)
    if here.item.has("use"):
        every = here.of_every_building()
        here.found.add("building.use", here.item.get("use"), here.item, every=every)


def _is_over(here: Here) -> bool:
    """Read weather that has ended: of rain the ground is wet, of the rest nothing is known."""
    weather = here.item.get("slot").removeprefix("weather=")
    near = here.items[max(0, here.at - 2) : here.at + 3]
    ended = any(item.text in _ENDED for item in near) or any(
        item.text == "after" for item in here.items[max(0, here.at - 2) : here.at]
    )
    if not ended or weather not in ("rain", "storm", "snow", "fog"):
        return False
    if weather in ("rain", "storm"):
        here.found.add("wetness", "high", here.item)
    else:
        here.found.leave(here.item, f"{weather} that is over")
    return True


def _is_a_state(here: Here) -> bool:
    """Read what denies things in a place but says how a thing is before one: "abandoned cars"."""
    thing = here.after
    if thing is None or thing.noun_class not in (*BUILDINGS, "vehicle", "person"):
        return False
    if not here.item.get("slot").startswith("not="):
        return False
    here.found.leave(here.item, f"state of the {thing.noun}")
    return True


def _is_free(here: Here) -> bool:
    """Return whether "free" follows: "tunnel-free"."""
    behind = here.items[here.at + 2 : here.at + 3]
    if not behind or behind[0].text != "free":
        return False
    behind[0].state = READ
    return True


def _of_another_kind(here: Here) -> bool:
    """Return whether cars or people are such as no traffic is of: "burnt-out | cars"."""
    before = here.before
    unknown = before is not None and (before.kind == "unknown" or before.text == "out")
    begins = here.at < 2 or here.items[here.at - 2].is_mark(ENDS)  # "Ban cars"
    return here.item.words[0] == "parked" or (unknown and not begins)


def _is_of_a_compound(here: Here) -> bool:
    """Return whether a noun ends a word that is not known: "heat-island"."""
    hyphen = here.before is not None and here.before.is_mark("-")
    return hyphen and here.at > 1 and here.items[here.at - 2].kind == "unknown"


def _nouns(here: Here) -> None:
    """Read what is there because it is named."""
    item = here.item
    noun, group = item.noun, item.noun_class
    if _is_of_a_compound(here) or item.text == "flat":
        return  # "rooftops mostly flat" speaks of no apartment
    if here.after is not None and here.after.is_mark("-") and _is_free(here):
        here.found.deny(noun, item)
        return
    if noun in ("vehicle", "pedestrian") and _of_another_kind(here):
        here.found.leave(item, "a kind of its own")
        return
    if group == "type":
        every = any(one.get("rel") == "all" for one in here.items[max(0, here.at - 3) : here.at])
        near = here.items[max(0, here.at - 2) : here.at]
        one = any(before.text in ("a", "an", "the", "one") for before in near)
        single = noun in LANDMARKS or (noun in ELEMENTS and one)
        alone = not every and not item.words[-1].endswith("s")
        if alone and single:
            here.found.add("element", noun, item)
        elif alone and one:
            here.found.leave(item, f"a single {noun}")
        else:
            here.found.add("building.type", noun, item)
    elif group == "element":
        here.found.add("element", noun, item)
    elif group == "plant":
        here.found.add("nature.trees", "some", item)
        if any(form in _KINDS_OF_TREES for form in forms_of(item.text)):
            here.found.leave(item, "kind of the trees")
    elif noun in ("vehicle", "pedestrian"):
        here.found.add("traffic" if noun == "vehicle" else "pedestrians", "medium", item)
    elif group in ("vehicle", "person"):
        here.found.add("agent", noun, item)
    elif noun == "ring_road":
        here.found.add("roads.rings", 1, item)
    elif noun == "motorway":
        here.found.add("roads.motorways", 1, item)
    elif group in ("building", "road", "place") and noun not in ("flying", "crane", "center"):
        item.state = READ


def _of_roofs(here: Here, noun: Item | None) -> bool:
    """Return whether a colour is that of roofs: "red roofs", "give the roofs a red colour"."""
    if noun is not None:
        return noun.noun == "roof"
    return any(one.noun == "roof" for one in here.clause())


def _of_the_air(here: Here) -> bool:
    """Return whether a colour is that of the day: "a grey and gloomy November afternoon"."""
    for item in here.items[here.at + 1 :]:
        if item.get("slot").startswith(_AIR):
            return True
        passes = item.kind in ("function", "unknown") or item.is_mark(",")
        if not (passes or item.get("rel") == "and" or item.has("color", "strength", "size")):
            return False
    return False


def _looks(here: Here) -> None:
    """Read materials and colours with what they are of."""
    material, color = here.item.get("material"), here.item.get("color")
    if not (material or color):
        return
    noun = here.noun_behind()
    if color and noun is None and _of_the_air(here):
        if color == "grey":
            here.found.add("weather", "overcast", here.item)
        else:
            here.found.leave(here.item, "colour of the light")
    elif color and noun is None and here.after is not None and here.after.kind == "unknown":
        here.found.leave(here.item, f"colour of the {here.after.text}")
    elif color and _of_roofs(here, noun):
        here.found.add("roof.color", color, here.item)
    elif noun is not None and noun.noun_class not in (*BUILDINGS, "place"):
        here.found.leave(here.item, f"look of the {noun.noun}")
    else:
        here.found.add(
            f"building.{'material' if material else 'color'}", material or color, here.item,
            every=here.of_every_building(),
        )  # fmt: skip
