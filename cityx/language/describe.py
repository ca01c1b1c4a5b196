"""Describing: the items of an instruction become slots."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

from cityx.language.air_words import read_air, settle_lamps
from cityx.language.brief import Note
from cityx.language.clauses import leave_clauses
from cityx.language.doubts import take_back
from cityx.language.here import (
    AIR,
    BUILDINGS,
    COUNTED,
    KINDS_OF_PEOPLE,
    PLOTS,
    ROADS,
    Findings,
    Here,
)
from cityx.language.lexicon.phrases import FUNCTION_WORDS, PARTS_OF_SPEECH
from cityx.language.life_words import leave_ways, read_beacons, read_clothes, read_march, read_mix
from cityx.language.mentions import leave_mentions
from cityx.language.quantities import read_quantity
from cityx.language.relations import (
    LINED,
    OUTSKIRTS,
    are_of_some,
    has_own_looks,
    is_of_a_quarter,
    read_part,
    stands_in_a_part,
)
from cityx.language.restrictions import ABOUT, is_at_known_things, is_set_apart, leave_restricted
from cityx.language.scan import ENDS, Item, Quantity
from cityx.language.scopes import DROPPED, KEPT, NEGATED, READ
from cityx.language.site import read_site
from cityx.language.street_words import read_streets
from cityx.language.syntax import Syntax, is_plural, is_unknown
from cityx.language.things import (
    PARTS_OF_HOUSES,
    is_species,
    leave_place,
    read_at_each,
    read_axis_or_side,
    read_middle,
    read_modifier,
    read_noun,
    read_place,
    thing_before,
)
from cityx.town.quarter_kinds import COUNTED_KINDS, KINDS

_HOUSE_FLOORS = KINDS["house"].floors[1]
_DETERMINERS = PARTS_OF_SPEECH["determiners"]
_WIDE = ("river", "canal", "beach", "bridge", "promenade")  # elements with a width
_STREET_ELEMENTS = ("dead_end", "roundabout")  # which are streets or junctions themselves
_WITH_STOREYS = ("house", "apartment", "office", "factory")  # kinds that are tall or low alone
_FALLS = ("rain", "snow", "fog")  # weather with an intensity of its own
_OF_THE_AIR = (*AIR, "wetness=")
_OF_BUILDINGS = ("style", "building.roof")
_LACKING = (
    "without", "with no", "free", "lacking", "bare of", "empty of", "devoid", "cleared of",
    "clear of", "rid of", "emptied of", "stripped of", "shut to", "closed to", "barred to",
    "off limits", "out of bounds",
)  # fmt: skip
_ONE_PLACE = ("element", "type", "vehicle", "person")
_NEAR = 3  # items behind a colour in which the thing is that has it
_ADJECTIVE = (("shade", "shade"),)  # senses of a word that only describes
_SHADES = ("dark", "deep", "pale", "bright", "light", "rusty")
_NO_PLACE = ("city", "landscape", "center", "sky")
# What stands behind a word about how much of it there is.
_THINGS = {"nature.trees": "tree", "pedestrians": "pedestrian", "lights": "light"}
_BESIDE = ("on", "by", "at", "in", "near", "facing", "along", "beside")
_WITHIN = ("inside", "within", "behind", "outside", "beyond", "beneath", "under")
_ENDED = ("stopped", "ended", "ceased", "passed")
_CONTENT = {
    "slot", "noun", "material", "color", "amount", "strength", "size", "height", "width", "side",
    "axis", "use", "compared", "attr", "source", "mode", "rank", "verb", "vague", "surface",
    "later", "direction", "strip", "shade", "wears", "pace", "beacons",
}  # fmt: skip
# Kinds of words that carry a meaning only beside others.
_FUNCTION = {
    "attr", "mode", "verb", "rel", "bound", "approx", "exact", "neg", "after_neg", "neither",
    "nothing_but", "except", "keep", "unchanged", "any_source",
}  # fmt: skip
# Words for a measure that say something without a number: "a long avenue", not "the length".
_DESCRIBING = ("long", "deep", "broad", "steep", "sloping", "fast", "square", "slope", "incline")
_LIMITING = (
    "only", "between", "mostly", "mainly", "largely", "predominantly", "chiefly", "primarily",
    "usually", "typically", "normally", "most",
)  # fmt: skip
_DOING = ("park", "double_park", "sit", "talk", "wait", "play")  # what somebody does at a place
_OWN = ("'s", "’s")
_SPOTS = ("end", "ends", "edge", "edges", "corner", "corners")
_OF_SIDES = ("one", "other", "both", "each", "either", "its", "far")


def describe(text: str, items: Sequence[Item], *, mapped: bool = False) -> Findings:
    """Read what the items say of a city; each item that says something counts as read.

    Parameters
    ----------
    mapped
        Whether the city is that of a file, whose place the text may name.
    """
    found = Findings(text, mapped)
    syntax = _settled_heads(items)
    leave_clauses(found, items)
    leave_mentions(found, items, syntax)
    leave_restricted(found, items, syntax)
    for at, item in enumerate(items):
        if item.state in (NEGATED, KEPT):
            state = item.state
            _settled(Here(found, items, at, syntax))
            item.state = state  # what is denied in one place is not asked for there
        elif item.state == DROPPED:
            _dropped(Here(found, items, at, syntax))
    rules = (
        read_at_each, read_march, leave_ways, read_mix, read_clothes, read_beacons, read_air,
        read_site, read_modifier, read_streets, _strengths, read_quantity, _amounts, _shapes,
        read_middle, read_axis_or_side, _phrases, read_noun, _looks, read_place,
    )  # fmt: skip
    for rule in rules:
        for at, item in enumerate(items):
            if not item.state:
                rule(Here(found, items, at, syntax))
    _drop_as_most(found, items, syntax)
    take_back(found, items, syntax)
    _call_high_houses_flats(found)
    settle_lamps(found)
    found.settle_presumed()
    return found


def _call_high_houses_flats(found: Findings) -> None:
    """Take houses of more storeys than a house has for what they are: blocks of flats."""
    kinds = {str(one.value) for one in found.slots if one.key == "building.type"}
    owners = ("house", "building") if kinds == {"house"} else ("house",)
    floors = [f"{owner}.floors{end}" for owner in owners for end in ("", ".min")]
    high = next(
        (one for one in found.slots if one.key in floors and float(one.value) > _HOUSE_FLOORS), None
    )
    if high is None:
        return
    for at, slot in enumerate(found.slots):
        owner, dot, key = slot.key.partition(".")
        if slot.key == "building.type" and slot.value == "house":
            found.slots[at] = replace(slot, value="apartment")
        elif owner == "house":
            found.slots[at] = replace(slot, key=f"apartment{dot}{key}")
    said = f'Houses of "{high.text}" are read as blocks of flats.'
    found.notes.append(Note("kind", said, high.span))


def _settled_heads(items: Sequence[Item]) -> Syntax:
    """Return the noun phrases, once it is settled which words are things and which materials.

    "Houses of dark wood" are of timber, and "a house in a dark wood" is among trees; "dead-end
    lanes" are dead ends.
    """
    for item, after in pairwise(items):
        if item.text in _SHADES and after.has("material"):
            item.senses, item.kind = _ADJECTIVE, "phrase"  # "dark | wood"
    syntax = Syntax(items)
    for at, item in enumerate(items):
        if item.has("material") and item.has("noun") and _is_a_substance(items, syntax, at):
            item.senses = tuple(sense for sense in item.senses if sense[0] != "noun")
        head = syntax.modifies(at)
        if head >= 0 and item.has("noun") and _is_a_kind_of(item, items[head]):
            items[head].senses, item.senses = item.senses, _ADJECTIVE
            item.state = READ
    return Syntax(items)


def _is_a_substance(items: Sequence[Item], syntax: Syntax, at: int) -> bool:
    """Return whether a word is the material of something, and no thing of its own."""
    phrase = syntax.phrase(at)
    if phrase is None or is_plural(items[at].words[-1]):
        return False
    first = items[phrase.first]
    if phrase.first < at and (first.text in _DETERMINERS or first.quantity is not None):
        return False
    if phrase.head > at:
        return items[phrase.head].has("noun")  # "wood | houses"
    before = phrase.first - 1
    while before > 0 and (items[before].get("rel") == "and" or items[before].has("material")):
        before -= 1  # "of stone and | wood"
    link = items[before] if before >= 0 else None
    return link is not None and link.text in ("of", "in", "from", "out of", "made of")


def _is_a_kind_of(item: Item, head: Item) -> bool:
    """Return whether a word behind an element names its class alone: "dead-end | lanes"."""
    if item.noun_class != "element" or item.noun not in _STREET_ELEMENTS:
        return False
    return head.noun == "road" and head.noun_class == "road"


def _drop_as_most(found: Findings, items: Sequence[Item], syntax: Syntax) -> None:
    """Let kinds of buildings that are somewhere among others not be what most buildings are."""
    placed = [note.of for note in found.notes if note.of is not None]
    kinds = {one.noun for one in items if one.noun_class == "type" and one.state in ("", READ)}
    for at, item in enumerate(items):
        inside = any(first <= item.span[0] and item.span[1] <= last for first, last in placed)
        if inside and len(kinds) > 1 and is_of_a_quarter(Here(found, items, at, syntax), item):
            most = ("building.type", item.noun)
            found.slots[:] = [one for one in found.slots if (one.key, one.value) != most]


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
    syntax = Syntax(items)
    return [
        item for at, item in enumerate(items)
        if not item.state
        and (
            _has_content(item)
            or (described and (_limits(items, at, every=every) or _is_done(syntax, at)))
        )
    ]  # fmt: skip


def _is_done(syntax: Syntax, at: int) -> bool:
    """Return whether a word for a command says how things are: "stepped gables", "tram stops"."""
    item, phrase = syntax.items[at], syntax.phrase(at)
    empty = item.text in FUNCTION_WORDS or item.has("noun", "slot", "rel", "keep", "mode")
    if empty or not item.has("verb"):
        return False
    near = syntax.items[max(0, at - 1) : at + 3]
    if item.text != "colored" and any(one.has("color", "material") for one in near):
        return False  # "painted blue"
    head = phrase is not None and phrase.head == at
    return head or item.words[-1].endswith(("ing", "ed"))


def _limits(items: Sequence[Item], at: int, *, every: bool) -> bool:
    """Return whether a word says of how many or where something holds: only, each, between."""
    item = items[at]
    if item.text == "steps" and item.get("rel") == "change":
        return True  # "steps down to the beach"
    if item.get("mode") in _DOING and item.kind == "phrase" and not item.has("noun"):
        return True
    last = items[at - 1] if at else item
    if item.text in ("side", "sides") and (last.text in _OF_SIDES or last.state == ""):
        return last.has("side", "ordinal") or last.text in _OF_SIDES
    if (item.get("attr") == "side" and item.words[0] == "on") or item.get("rel") == "direction":
        return True
    if item.text in _SPOTS and last.text in ("its", "the", "their", "far", "one", "each"):
        return True  # "a lighthouse at its | end"
    if item.text in (*_LIMITING, "round") or item.get("rel") in ("green", "rest"):
        return True
    behind = [one for one in items[at + 1 : at + 6] if one.noun]
    if at + 1 < len(items) and items[at + 1].quantity is not None and items[at + 1].state:
        return False  # "each seven floors high"
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
    if item.text in ("nothing", "nobody") and item.has("neg"):
        return True
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
    elif denied and item.get("slot") == "lights=on":
        behind = here.items[here.at + 1 : here.at + 3]
        if item.words[-1] == "on" and len(behind) == 2 and behind[1].noun:
            here.found.leave(item, "denied in one place alone")  # "street lights on | the square"
            behind[1].state = READ
            return
        windows = {"window", "windows"} & set(item.words)
        here.found.add(*(("windows.lit", "none") if windows else ("lights", "off")), item)
    elif denied and item.get("slot").startswith("sun."):
        here.found.leave(item, "denied")
    elif denied and item.get("slot").startswith(("moon=", "wind=")):
        here.found.add(item.get("slot").partition("=")[0], "none", item)
    elif denied and item.get("slot").startswith("terrain="):
        here.found.add("terrain", "flat", item)
    elif denied and item.text == "flat":
        here.found.leave(item, "denied")
    elif value and denied and any(one.text == "where" for one in here.before_in_clause()):
        here.found.leave(item, "denied in one place alone")  # "land where nobody builds"
    elif value and denied and _there_alone(here):
        here.found.leave(item, "denied in one place alone")
    elif value and denied and _of_one_place(here):
        here.found.leave(item, "denied of one thing alone")
    elif value and denied and (_is_compared(here) or _are_two(here)):
        here.found.leave(item, "of which something is denied")
    elif value and denied and _is_a_place_not_to_be_at(here):
        here.found.leave(item, "where something is not to be")
    elif value and denied and _of_some_alone(here):
        here.found.leave(item, "denied of some of them alone")
    elif value and denied and is_species(item):
        here.found.leave(item, "denied of one kind alone")  # "no oaks"
    elif value and denied and _of_a_kind(here):
        here.found.leave(item, "denied of one kind alone")
    elif value and denied:
        here.found.deny(value, item)
    elif value and any(one.has("except") for one in here.before_in_clause()):
        here.found.leave(item, "excepted")
    elif value:
        here.found.keep(value, item)
    elif denied and (
        item.has("height", "width", "size", "attr", "surface")
        or item.get("rel") == "near"
        or item.quantity is not None
    ):
        here.found.leave(item, "denied")


def _dropped(here: Here) -> None:
    """Deny what something is to be there in place of: "carriages instead of cars"."""
    value = _settled_value(here)
    water = here.item.noun in ("river", "canal", "lake", "sea", "pond")
    words = [one for one in here.items[: here.at] if one.has("neither")]
    replaced = bool(words) and words[-1].words[0] in ("instead", "rather", "in")  # no "no need for"
    if (
        value
        and replaced
        and (
            here.item.noun_class in ("vehicle", "person", "plant")
            or (here.item.noun_class == "element" and not water)
        )
    ):
        here.found.deny(value, here.item)
    elif here.item.has("noun", "slot", "material", "color") and not here.item.has("axis"):
        here.found.notes.append(
            Note("instead", f'"{here.found.said(here.item)}" is not asked for.', here.item.span)
        )


def _are_two(here: Here) -> bool:
    """Return whether what several share is denied: "no two houses of the same colour"."""
    number = here.before
    denied = here.at > 1 and here.items[here.at - 2].has("neg")
    return denied and number is not None and number.quantity is not None


def _is_compared(here: Here) -> bool:
    """Return whether it is denied how a thing is: "no house is nearer than 50 m to the lake"."""
    be = here.after
    behind = here.items[here.at + 2] if here.at + 2 < len(here.items) else None
    linked = be is not None and (be.get("rel") == "be" or be.text in ("more", "so", "as"))
    measured = any(item.quantity is not None for item in here.items[here.at + 2 : here.at + 6])
    before = here.before
    none = before is not None and before.text.startswith("none of")
    if be is None:
        return False
    far = be.quantity is not None and be.quantity.dimension == "length"  # "no trees within 30 m"
    nearer = be.text in ("closer", "nearer", "farther", "further")
    told = far or nearer or be.text in ("that", "which")
    return told or bool(linked and behind and (measured or none))


def _there_alone(here: Here) -> bool:
    """Return whether something is denied in one place alone: "no trees on the main road"."""
    last = _last_denied(here)
    after = here.items[last + 1] if last + 1 < len(here.items) else None
    rel = after.get("rel") if after is not None else ""
    place = here.items[last + 2 : last + 4]
    nouns = [one for one in place if one.noun and one.noun not in ("road", "city", "landscape")]
    element = any(one.noun_class == "element" for one in nouns)
    quarter = any("district=" in one.get("slot") for one in here.items[last + 2 : last + 5])
    unknown = len(place) == 2 and place[0].text in ("the", "this") and place[1].kind == "unknown"
    if unknown and rel in ("on", "in", "along", "near", "around"):
        return True  # "no cars on the course"
    if after is not None and after.text in _WITHIN:
        return bool(nouns)  # "inside the city wall"
    if rel == "in":
        return quarter or element or any(one.noun in ROADS for one in nouns)
    head = here.syntax.object_of(last + 1) if after is not None else -1
    unknown = head > 0 and is_unknown(here.items[head]) and here.items[head - 1].text == "the"
    return rel in ("on", "along", "near", "around") and (bool(nouns) or unknown)


def _last_denied(here: Here) -> int:
    """Return where a list of what is denied ends: "no houses or | shops near the river"."""
    last = here.at
    while last + 2 < len(here.items) and here.items[last + 1].get("rel") in ("or", "and"):
        if here.items[last + 2].state != NEGATED:
            break
        last += 2
    return last


def _of_one_place(here: Here) -> bool:
    """Return whether a thing before is to be without others: "a park without trees"."""
    for at in range(here.at - 1, -1, -1):
        item = here.items[at]
        if item.is_mark(ENDS + ","):
            return False
        if item.has("neg"):
            head = here.syntax.head_before(at) if item.text.startswith(_LACKING) else -1
            thing = here.items[head] if head >= 0 else None
            if thing is not None and thing.state == NEGATED:
                return False
            return thing is not None and (is_unknown(thing) or thing.noun_class in _ONE_PLACE)
    return False


def _is_a_place_not_to_be_at(here: Here) -> bool:
    """Return whether only a place is denied: "a school, not near the main road"."""
    before = [one for one in here.items[max(0, here.at - 4) : here.at] if one.kind != "function"]
    denied = len(before) > 1 and before[-2].has("neg") and before[-2].text == "not"
    return denied and before[-1].get("rel") in _WHERE


def _of_some_alone(here: Here) -> bool:
    """Return whether something is denied of some things: "one of the streets is closed to cars"."""
    before = here.before_in_clause()
    some = any(
        one.quantity is not None and one.quantity.dimension in ("count", "part", "share")
        and after.get("rel") == "of"
        for one, after in pairwise(before)
    )  # fmt: skip
    parted = any(
        one.quantity is not None and one.quantity.dimension == "part" and one.span < here.item.span
        for one in before
    )
    others = any(one.get("rel") == "rest" or one.text in ("others", "other") for one in before)
    return some or parted or others


def _of_a_kind(here: Here) -> bool:
    """Return whether things of one kind alone are denied: "no narrow streets", "no parked cars"."""
    before = here.before
    if before is not None and (before.kind == "unknown" or before.text in ("through", "parked")):
        return True
    looks = ("width", "size", "height", "material", "color", "compared", "surface")
    if before is not None and before.get("attr") == "slope":
        return True  # "no steep streets"
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
        here.found.add("nature.trees", amount, here.item)
    elif noun.noun == "vehicle":
        here.found.add("traffic", busy, here.item, noun)
    elif noun.noun in KINDS_OF_PEOPLE:
        here.found.add("agent", noun.noun, here.item, noun)
    elif noun.noun_class == "person" and noun.noun != "dog":
        here.found.add("pedestrians", busy, here.item, noun)
    elif is_plural(noun.words[-1]):
        _some(here, noun)


def _some(here: Here, noun: Item) -> None:
    """Read "several churches", "a few offices" and "lots of houses"."""
    kind = noun.noun
    least, _, most = here.item.get("some").partition("-")
    lined = here.item.words[-1] == "with"  # "a street lined with | shops"
    if kind in COUNTED_KINDS and not (least or lined or here.is_some_kind(noun)):
        here.found.add("building.type", kind, here.item, noun)
    elif least:
        here.item.quantity = Quantity("count", float(least), float(most))
        read_quantity(here)


def _shapes(here: Here) -> None:
    """Read "wide", "tall" and "small" with the noun they go with."""
    item = here.item
    if item.has("slot") or not item.has("width", "height", "size"):
        return
    noun = here.noun_behind()
    if item.has("width", "height"):
        noun = noun or _subject(here)
        _shape(here, noun)
    elif noun is not None and noun.words[-1] in PLOTS:
        here.found.leave(here.item, f"size of the {here.found.said(noun)}")
    elif (noun is None and _district_behind(here)) or (noun is not None and noun.noun == "city"):
        here.found.add("size", item.get("size"), item)
    elif noun is not None:
        here.found.leave(item, f"size of the {noun.noun}")


def _shape(here: Here, noun: Item | None) -> None:
    width, height = here.item.get("width"), here.item.get("height")
    if noun is None:
        return
    if is_at_known_things(here, here.item):
        here.found.leave(here.item, ABOUT)  # "buses on the | wide roads"
        return
    first = here.syntax.index(here.phrase_of(noun)[0])
    ringed = (
        first > 1
        and here.items[first - 1].text in ("by", "with")
        and (here.items[first - 2].text in LINED or here.items[first - 1].words[0] in LINED)
    )
    if height and ringed and noun.noun not in _WITH_STOREYS:
        here.found.leave(here.item, f"height of the {noun.noun}")
        return
    if (
        height
        and not are_of_some(here, noun)
        and (noun.noun_class in BUILDINGS or noun.noun == "everything")
    ):
        if is_set_apart(here):
            here.found.leave(here.item, ABOUT)
            return
        here.found.add("building.height", height, here.item)
    elif height in ("tall", "low") and noun.noun in _WITH_STOREYS and are_of_some(here, noun):
        here.found.add(f"{noun.noun}.height", height, here.item)
    elif width and noun.noun in ROADS and here.is_some_kind(noun):
        here.found.leave(here.item, f"width of the {noun.noun}")  # "wide access roads"
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
    return here.noun_before() if linked else None


def _district_behind(here: Here) -> bool:
    for item in here.items[here.at + 1 : here.at + 4]:
        if "district=" in item.get("slot"):
            return True
        if not item.has("slot", "material", "color") and item.kind != "function":
            return False
    return False


def _phrases(here: Here) -> None:
    """Read a phrase that says its slots by itself."""
    if here.item.text == "today" and here.found.text[here.item.span[1] :][:2] not in _OWN:
        here.found.leave(here.item, "a day")
        return
    if _is_over(here) or _is_a_state(here) or _is_plain(here) or _is_the_place(here):
        return
    thing = thing_before(here) if here.item.words[0] in _BESIDE else None
    if thing is not None and here.item.get("slot").startswith(("district=", "terrain=")):
        leave_place(here, thing, here.item.span)  # "a lighthouse on the coast"
    if here.item.text == "maze" and _is_a_garden(here):
        here.found.leave(here.item, "no maze of streets")
        return
    if here.item.get("slot").startswith(("building.roof", "building.feature")):
        placed = here.after is not None and here.after.get("rel") in ("on", "of")
        owner = _under_a_roof(here, None) if placed else None
        owner = owner or here.owner(past_comma=here.item.words[-1].endswith("ed"))
        whole = here if not placed or owner is None else replace(here, at=here.syntax.index(owner))
        part = owner is not None and stands_in_a_part(here, owner)
        if _are_roofs_of_some(here, owner) or (not part and is_set_apart(whole)):
            here.found.leave(here.item, ABOUT)
            return
        if (
            owner is not None
            and owner.noun_class in ("type", "element")
            and has_own_looks(here, owner)
        ):
            key, _, value = here.item.get("slot").partition("=")
            if here.has_looks(owner) and key == "building.roof":
                here.found.add(f"{owner.noun}.roof", value, here.item)
            else:
                here.found.leave(here.item, f"of the {here.found.said(owner)}")
            return
    if here.item.text in OUTSKIRTS and _are_there(here):
        return
    if here.item.get("slot").startswith("lights=") and (thing := _lit(here)) is not None:
        here.found.leave(here.item, f"of the {here.found.said(thing)}")
        return
    if here.item.get("slot") == "lights=on" and _is_of_windows(here):
        here.found.leave(here.item, "which of the windows")
        return
    if here.item.get("slot").startswith("roads.pattern=") and _is_one_street(here):
        here.found.leave(here.item, "course of one street")  # "one | winding road"
        return
    if _is_part_of_a_town(here):
        return
    if "terraces" in here.item.words and _are_houses(here):
        here.found.leave(here.item, "houses or land")
        return
    if here.item.get("slot") == "roads.pattern=superblock" and _is_patterned(here):
        here.found.leave(here.item, "a kind of blocks")
        return
    if here.item.get("slot") == "pedestrians=heavy" and _is_of_others(here):
        here.found.leave(here.item, "what something else does")  # "houses | crowding into lanes"
        return
    for pair in here.item.get("slot").split():
        key, _, value = pair.partition("=")
        if key == "not":
            here.item.state = READ
            here.found.deny(value, here.item)
        else:
            every = key in _OF_BUILDINGS and here.of_every_building()
            here.found.add(key, value, here.item, every=every)
    if here.item.has("use") and _is_one_alone(here):
        here.found.leave(here.item, "a single one")  # "a convenience store on a corner"
    elif here.item.has("use"):
        every = here.of_every_building()
        here.found.add("building.use", here.item.get("use"), here.item, every=every)


# Quarters that decide what all of a town is -> the buildings that most of one are.
_WHERE = ("near", "on", "along", "around")
_A = ("a", "an")
_QUARTERS = {
    "suburban": "house", "industrial": "warehouse", "residential": "apartment",
    "downtown": "office", "commercial": "shop", "old_town": "", "slum": "", "village": "house",
}  # fmt: skip


def _is_part_of_a_town(here: Here) -> bool:
    """Read a quarter beside others, which is no word for the whole: "and a suburb in the east"."""
    key, _, value = here.item.get("slot").partition(" ")[0].partition("=")
    if key == "style":
        head = here.syntax.modifies(here.at)
        thing = here.items[head] if head >= 0 else None
        quarter = thing is not None and "district=" in thing.get("slot")
        if thing is None or not (quarter and _is_beside_others(replace(here, at=head))):
            return False
        here.found.leave(here.item, f"of the {here.found.said(thing)}")
        return True
    if key != "district" or value not in _QUARTERS or not _is_beside_others(here):
        return False
    where, kind = _part_said(here), _QUARTERS[value]
    if where is None or not kind:
        here.found.leave(here.item, "a part of the town")
        return True
    side = where.get("side") or ("center" if where.noun == "center" else "edge")
    here.found.add(f"{kind}.part", side, here.item, where)
    at = here.syntax.index(where)
    for one in here.items[min(here.at, at) + 1 : at]:
        one.state = one.state or (READ if one.has("rel") else "")
    return True


def _are_roofs_of_some(here: Here, owner: Item | None) -> bool:
    """Return whether roofs are some among others: "flat roofs over 200 m2", "of the tallest"."""
    ranked = owner is not None and any(one.has("rank") for one in here.phrase_of(owner))
    sized = here.before is not None and here.before.has("size")
    bound = (
        here.after is not None
        and here.after.quantity is not None
        and here.after.quantity.dimension == "area"
    )
    return ranked or sized or bound


def _are_houses(here: Here) -> bool:
    """Return whether terraces are rows of houses: "80 dwellings, half of them in | terraces"."""
    sentence = [one for one in here.items if one.span < here.item.span]
    homes = any(one.noun in ("house", "apartment", "terrace") for one in sentence[-8:])
    near = here.before_in_clause()[-3:]
    rows = any(one.has("material", "color") or one.text.startswith("row") for one in near)
    part = any(one.quantity is not None and one.quantity.dimension == "part" for one in near)
    return here.item.words[0] == "in" and (homes or rows or part)


def _part_said(here: Here) -> Item | None:
    """Return the word for the part of a town that a quarter is: "a suburb in the | north"."""
    phrase = here.phrase_of(here.item)
    if (half := _half_before(here)) is not None:
        return half
    for one in (*phrase, *here.items[here.at + 1 : here.at + 4]):
        if one.is_mark(ENDS + ",") or one.get("rel") in ("and", "with", "of"):
            return None
        if one.has("side") or one.noun == "center" or one.text in OUTSKIRTS:
            return one
    return None


def _half_before(here: Here) -> Item | None:
    """Return the side of "the southern half a | suburb"."""
    before = here.before_in_clause()[-4:]
    halves = any(one.quantity is not None or one.text in ("part", "half") for one in before)
    return next((one for one in before if one.has("side") and halves), None)


def _is_beside_others(here: Here) -> bool:
    """Return whether a quarter or a core is named before one, which decides what the town is."""
    phrase = here.phrase_of(here.item)
    first = here.syntax.index(phrase[0])
    article = phrase[0].text in ("a", "an", "one", "the") or phrase[0].quantity is not None
    before = [one for one in here.items[:first] if one.state != NEGATED]
    if _half_before(here) is not None:
        return True
    quarter = any(
        one.get("slot").startswith("district=") and one.get("slot").partition("=")[2] in _QUARTERS
        for one in before
    )
    cores = (one for one in before if one.noun == "center")
    return article and (quarter or any(here.phrase_of(one)[0].text in _A for one in cores))


def _are_there(here: Here) -> bool:
    """Read "villas on the outskirts", which are a part of a town and not the kind of it."""
    first = here.syntax.index(here.phrase_of(here.item)[0])
    before = here.items[first - 1] if first else None
    thing = thing_before(here)
    if before is None or before.get("rel") not in ("in", "on", "to") or thing is None:
        return False
    before.state = before.state or READ
    if not read_part(here, thing, "edge"):
        leave_place(here, thing, here.item.span)
        here.item.state = READ
    return True


def _is_patterned(here: Here) -> bool:
    """Return whether the pattern of the streets is said by another word."""
    return any(
        one is not here.item and one.get("slot").startswith("roads.pattern=")
        and "superblock" not in one.get("slot")
        for one in here.items
    )  # fmt: skip


def _is_of_windows(here: Here) -> bool:
    """Return whether some windows are lit, and no street lamps: "a few windows are | lit"."""
    near = [*here.before_in_clause(), *([here.after] if here.after is not None else [])]
    return any(one.noun == "window" and one.has("noun") for one in near)


def _is_one_street(here: Here) -> bool:
    """Return whether a pattern is said of a single street, or of a grid of measured cells."""
    item, before = here.item, here.before
    if before is None:
        return False
    cells = before.quantity is not None and before.quantity.dimension == "length"
    road = item.noun_class == "road" and not is_plural(item.words[-1])
    behind = here.syntax.modifies(here.at)
    if behind >= 0 and here.items[behind].noun_class == "road":  # "a | winding track"
        one = not is_plural(here.items[behind].words[-1])
        return one and here.phrase_of(here.items[behind])[0].text in ("a", "one")
    if before.noun_class == "road" and not is_plural(before.words[-1]):
        return here.phrase_of(before)[0].text in ("a", "one", "the")  # "a road | winding down"
    return cells or (before.text in ("a", "one", "single") and road)


def _is_of_others(here: Here) -> bool:
    """Return whether a participle for crowds is of what is before it, and that are no people."""
    before = here.before
    doing = here.item.words[-1].endswith("ing") and before is not None
    return doing and before is not None and bool(before.noun) and before.noun_class != "person"


def _lit(here: Here) -> Item | None:
    """Return what has lights of its own: "hazard | lights on", "nine lorries, | lights off"."""
    if here.before is not None and here.before.kind == "unknown":
        return here.before
    head = here.syntax.head_before(here.at, past_comma=True)
    thing = here.items[head] if head >= 0 else None
    return thing if thing is not None and thing.noun_class == "vehicle" else None


def _is_one_alone(here: Here) -> bool:
    """Return whether an item is the head of a phrase in the singular, with an article."""
    phrase = here.phrase_of(here.item)
    article = phrase[0].text in ("a", "an", "one", "the")
    return article and phrase[-1] is here.item and not is_plural(here.item.words[-1])


def _is_a_garden(here: Here) -> bool:
    """Return whether a maze is one of hedges: "a garden maze"."""
    before = [one for one in here.phrase_of(here.item) if one.span < here.item.span]
    return any(one.noun_class == "element" for one in before)


def _is_over(here: Here) -> bool:
    """Read weather that has ended: of rain the ground is wet, of the rest nothing is known."""
    weather = here.item.get("slot").removeprefix("weather=")
    near = here.items[max(0, here.at - 2) : here.at + 3]
    ended = any(item.text in _ENDED for item in near) or any(
        item.text == "after" for item in here.items[max(0, here.at - 2) : here.at]
    )
    if not ended or weather not in ("rain", "storm", "snow", "fog"):
        return False
    if weather == "rain":
        here.found.add("wetness", "high", here.item)
    else:
        here.found.leave(here.item, f"{weather} that is over")
    return True


def _is_the_place(here: Here) -> bool:
    """Leave the name of where a map is, which says no style: "here is central London"."""
    phrase = here.syntax.phrase(here.at)
    last = phrase is not None and phrase.end == here.at + 1
    name = here.found.said(here.item)[:1].isupper() and here.item.get("slot").startswith("style=")
    like = here.before is not None and here.before.text in ("like", "style")
    if not (here.found.mapped and last and name) or like or here.item.words[-1].endswith("ish"):
        return False
    here.found.leave(here.item, "where the map is")
    return True


def _is_plain(here: Here) -> bool:
    """Leave "clear" that is said of a thing and not of the sky: "a clear business district"."""
    head = here.syntax.modifies(here.at)
    thing = here.items[head] if head >= 0 else None
    if here.item.text != "clear" or thing is None:
        return False
    named = thing.has("noun") and thing.noun not in ("sky", "light")
    if not named and "district=" not in thing.get("slot"):
        return False
    here.found.leave(here.item, f"of the {here.found.said(thing)}")
    return True


def _is_a_state(here: Here) -> bool:
    """Read what denies things in a place but says how a thing is before one: "abandoned cars"."""
    thing = here.after
    if thing is None or thing.noun_class not in (*BUILDINGS, "vehicle", "person"):
        return False
    if not here.item.get("slot").startswith("not="):
        return False
    here.found.leave(here.item, f"state of the {thing.noun}")
    thing.state = thing.state or READ
    return True


def _of_roofs(here: Here, noun: Item | None) -> bool:
    """Return whether a colour is that of roofs: "red roofs", "give the roofs a red colour"."""
    if noun is not None:
        return noun.noun == "roof"
    if here.after is not None and here.after.get("slot").startswith("building.roof"):
        return True  # "grey slate"
    owner = here.owner()
    if owner is not None:
        return owner.noun == "roof"  # "the walls are | white and the roofs are red"
    return any(one.noun == "roof" for one in here.clause())


def _stands_for_something(here: Here) -> bool:
    """Return whether a colour is the subject of a clause: "red is shops", "blue = water"."""
    before, after = here.before, here.after
    begins = before is None or before.kind == "mark" or before.get("rel") == "and"
    equal = after is not None and (
        after.get("rel") == "be" or after.is_mark("=:") or after.text in ("means", "marks")
    )
    return begins and equal and here.at + 2 < len(here.items)


def _is_of_nothing(here: Here) -> bool:
    """Return whether a colour begins a text and no thing is near that could have it: "Navy day"."""
    before = here.syntax.head_before(here.at, past_comma=True)
    near = here.items[here.at + 1 : here.at + 1 + _NEAR]
    return before < 0 and not any(one.noun or one.has("slot") for one in near)


def _roof_color(here: Here, roof: Item | None, color: str) -> None:
    """Read the colour of roofs, of the one thing or kind of building that has them if one does."""
    thing = _under_a_roof(here, roof)
    if thing is None or not has_own_looks(here, thing):
        if is_set_apart(here):
            here.found.leave(here.item, ABOUT)
            return
        here.found.add("roof.color", color, here.item)
    elif here.has_looks(thing):
        here.found.add(f"{thing.noun}.roof_color", color, here.item)
    else:
        here.found.leave(here.item, f"colour of the roof of the {here.found.said(thing)}")
        return
    _leave_shade(here)


def _under_a_roof(here: Here, roof: Item | None) -> Item | None:
    """Return the building of "a church with a red | roof" or "a blue | dome on the church"."""
    at = here.at if roof is None else here.syntax.index(roof)
    phrase = here.syntax.phrase(at)
    end = at + 1 if phrase is None else phrase.end
    on = end < len(here.items) and here.items[end].get("rel") in ("on", "of")
    head = here.syntax.object_of(end) if on else -1
    if head < 0 or not here.items[head].has("noun"):  # "with red roofs | at the edge"
        head = here.syntax.head_before(at if phrase is None else phrase.first)
    thing = here.items[head] if head >= 0 else None
    return thing if thing is not None and thing.has("noun") else None


def _of_the_air(here: Here) -> bool:
    """Return whether a colour is that of the day: "a grey and gloomy November afternoon"."""
    for item in here.items[here.at + 1 :]:
        if item.get("slot").startswith(_OF_THE_AIR):
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
    head = here.syntax.head_behind(here.at)
    feature = here.items[head] if head >= 0 else here.item
    if _is_of_the_rest(here):
        here.found.leave(here.item, "of a part of them")
    elif feature.get("slot").startswith("building.feature="):
        here.found.leave(here.item, f"look of the {here.found.said(feature)}")  # "red | awnings"
    elif here.after is not None and here.after.text == "up":
        here.found.leave(here.item, "a state of them")  # "shops | boarded up"
    elif _is_of_it(here):
        here.found.leave(here.item, ABOUT)
    elif color and _stands_for_something(here):
        here.found.leave(here.item, "colour of a legend")  # "red | is shops"
    elif color and here.after is not None and here.after.get("slot").startswith("lights="):
        here.found.leave(here.item, "colour of the lights")
    elif color and here.after is not None and here.after.has("color") and not material:
        here.found.leave(here.item, f"shade of {here.found.said(here.after)}")  # "rusty | red"
    elif color == "green" and noun is None and _is_a_share(here):
        here.found.leave(here.item, "a share of green")
    elif color == "green" and noun is None and _is_a_green(here):
        here.found.leave(here.item, "a green of its own")
    elif color and noun is None and _of_the_air(here):
        if color == "grey":
            here.found.add("weather", "overcast", here.item)
        else:
            here.found.leave(here.item, "colour of the light")
    elif color and noun is None and here.after is not None and here.after.kind == "unknown":
        here.found.leave(here.item, f"colour of the {here.after.text}")
    elif color and _of_roofs(here, noun):
        _roof_color(here, noun, color)
    elif (thing := _not_of_buildings(here, noun)) is not None and here.has_looks(thing):
        look = "material" if material else "color"
        here.found.add(f"{thing.noun}.{look}", material or color, here.item)
        _leave_shade(here)
    elif thing is not None:
        here.found.leave(here.item, f"look of the {here.found.said(thing)}")
        thing.state = thing.state or (READ if thing.noun in PARTS_OF_HOUSES else "")
    elif color and not material and _is_of_nothing(here):
        here.found.leave(here.item, "colour of what is not said")
    elif is_set_apart(here):
        here.found.leave(here.item, ABOUT)
    else:
        for look, value in (("material", material), ("color", color)):
            if value:  # "whitewashed" says both
                every = here.of_every_building()
                here.found.add(f"building.{look}", value, here.item, every=every)
        _leave_shade(here)


def _is_of_it(here: Here) -> bool:
    """Return whether a look is of some that were told of: "roofs over 9 m, paint them | red"."""
    before = here.items[max(0, here.at - 3) : here.at]
    pronoun = [one for one in before if one.text in ("them", "those", "these", "it")]
    if not pronoun or any(one.has("noun") for one in before if one.span > pronoun[-1].span):
        return False
    first = here.at
    while first > 0 and not here.items[first - 1].is_mark(ENDS):
        first -= 1
    told = here.items[first : here.syntax.index(pronoun[-1])]
    return any(one.has("rank", "ordinal") or _is_bound(one) for one in told)


def _is_bound(item: Item) -> bool:
    quantity = item.quantity
    return quantity is not None and quantity.exact is None and quantity.dimension != "count"


def _is_of_the_rest(here: Here) -> bool:
    """Return whether a look is of some of what was told: "half are white and the rest | grey"."""
    before = here.before_in_clause()
    if any(one.get("rel") == "rest" or one.text in ("rest", "others") for one in before):
        return True
    part = [one for one in before if one.quantity is not None
            and one.quantity.dimension in ("part", "share")]  # fmt: skip
    told = [one for one in before if one.has("noun") and part and one.span > part[-1].span]
    return bool(told) and told[0].noun_class in (*BUILDINGS, "place") and any(
        one.get("rel") == "be" and one.span > told[0].span for one in before
    )  # fmt: skip


def _not_of_buildings(here: Here, noun: Item | None) -> Item | None:
    """Return the thing that a material or colour is of, if that is not what buildings are of."""
    owner = noun or here.owner(past_comma=True)
    roofs = noun is None and owner is not None and owner.noun == "roof"  # "with roofs, in brick"
    if owner is None or owner.state == NEGATED or roofs:
        return None
    if owner.has("slot") and owner.noun != "roof":
        return owner if owner.get("slot").startswith(_OF_THE_AIR) else None  # "Navy | day"
    of_all = owner.noun_class in (*BUILDINGS, "place") and owner.noun not in PARTS_OF_HOUSES
    if owner.noun == "facade" and _are_free_walls(here, owner):
        return owner
    return None if of_all and not has_own_looks(here, owner) else owner


def _is_a_share(here: Here) -> bool:
    """Return whether "green" is what a part is: "at least a quarter | green"."""
    before = here.before
    parts = ("quarter", "third", "half", "fifth", "tenth")
    return before is not None and (before.quantity is not None or before.text in parts)


def _is_a_green(here: Here) -> bool:
    """Return whether "green" is a noun: "a village: green in the middle"."""
    before, after = here.before, here.after
    begins = before is None or before.kind == "mark" or before.text in ("a", "the")
    placed = after is not None and (
        after.get("rel") in ("in", "with", "near") or after.words[:1] in (("in",), ("on",))
    )
    return begins and placed


def _are_free_walls(here: Here, walls: Item) -> bool:
    """Return whether walls are of no building: "dry stone walls", "terraces with stone walls"."""
    phrase = here.phrase_of(walls)
    if any(one.kind == "unknown" for one in phrase):
        return True
    first = here.syntax.index(phrase[0])
    head = here.syntax.head_before(first) if here.items[first - 1].text == "with" else -1
    return head >= 0 and (is_unknown(here.items[head]) or here.of_one_thing(here.items[head]))


def _leave_shade(here: Here) -> None:
    """Note a shade that is built as its plain colour or material: "dark red", "dark wood"."""
    before = here.before
    apart = before is not None and before.text in _SHADES
    shade = before if apart and before is not None else here.item
    if apart or (len(shade.words) > 1 and shade.words[0] in _SHADES):
        shade.state = READ
        said = f'"{shade.words[0]}" of "{here.found.said(here.item)}" is left open.'
        here.found.notes.append(Note("left_open", said, shade.span))
