"""Describing: the items of an instruction become slots."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

from cityx.language.air_words import read_air, settle_lamps
from cityx.language.brief import Note
from cityx.language.clauses import leave_clauses
from cityx.language.comparisons import read_comparisons
from cityx.language.counted_there import settle_counted_there
from cityx.language.denials import read_dropped, read_settled
from cityx.language.doubts import take_back
from cityx.language.enclosures import read_enclosure, read_ring, settle_rings
from cityx.language.group_words import read_groups
from cityx.language.here import (
    BUILDINGS,
    KINDS_OF_PEOPLE,
    LANDMARKS,
    PLOTS,
    ROADS,
    ROLES,
    Findings,
    Here,
)
from cityx.language.infill_words import read_infill, settle_infill
from cityx.language.lexicon.numbers import EVERY_SO_MANY
from cityx.language.lexicon.phrases import FUNCTION_WORDS, PARTS_OF_SPEECH
from cityx.language.life_words import leave_ways, read_beacons, read_clothes, read_march, read_mix
from cityx.language.looks import SHADES, read_looks, roofed, under_a_roof
from cityx.language.mentions import leave_mentions
from cityx.language.part_words import read_parts, read_walls, settle_walls
from cityx.language.place_words import leave_place, read_place
from cityx.language.quantities import read_quantity
from cityx.language.relations import (
    LINED,
    OUTSKIRTS,
    are_of_some,
    has_own_looks,
    is_of_a_quarter,
    read_part,
    stands_in_a_part,
    thing_before,
)
from cityx.language.restrictions import (
    ABOUT,
    is_at_known_things,
    is_of_the_excepted,
    is_set_apart,
    leave_restricted,
)
from cityx.language.scan import ENDS, Item, Quantity
from cityx.language.scopes import DROPPED, KEPT, NEGATED, READ
from cityx.language.shared_places import read_shared_places
from cityx.language.side_words import read_at_each, read_axis_or_side, read_middle
from cityx.language.site import read_site
from cityx.language.some_alone import leave_some_alone
from cityx.language.standing_words import read_standing, settle_greens, settle_standing
from cityx.language.street_words import read_streets
from cityx.language.syntax import Syntax, is_plural
from cityx.language.things import read_modifier, read_noun
from cityx.language.totals import sum_up
from cityx.language.windows import read_window
from cityx.town.elements import BARRIERS, ELEMENTS, attributes_of
from cityx.town.quarter_kinds import COUNTED_KINDS, HOUSES, KINDS

_HOUSE_FLOORS = KINDS["house"].floors[1]
_DETERMINERS = PARTS_OF_SPEECH["determiners"]
_WIDE = ("river", "canal", "beach", "bridge", "promenade")  # elements with a width
_STREET_ELEMENTS = ("dead_end", "roundabout")  # which are streets or junctions themselves
_WITH_STOREYS = ("house", "apartment", "office", "factory")  # kinds that are tall or low alone
LOW_AND_HIGH = {"low": ("max", 1.2), "tall": ("min", 2.0)}  # metres of barriers
_FALLS = ("rain", "snow", "fog")  # weather with an intensity of its own
_OF_BUILDINGS = ("style", "building.roof", "building.feature")
_ADJECTIVE = (("shade", "shade"),)  # senses of a word that only describes
_BESIDE = ("on", "by", "at", "in", "near", "facing", "along", "beside")
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
_ROWS = ("rows of", "row of", "rows", "row", "streets of", "street of")
_MILLS = ("mill", "mills", "brewery", "breweries", "smelter", "smelters", "ironworks")
_TO_CHIMNEY = 6  # items from a mill to its chimney
_DOING = ("park", "double_park", "sit", "talk", "wait", "play")  # what somebody does at a place
_OWN = ("'s", "’s")
_PARTS_OF_ALL = ("roofs", "walls", "facades", "fronts", "windows", "doors", "gables")
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
    _read_every_second(items)
    syntax = _settled_heads(items)
    settle_rings(items, syntax)
    for at in range(len(items)):
        read_window(Here(found, items, at, syntax))
    read_infill(found, items)
    read_comparisons(found, items)
    read_parts(found, items)
    read_walls(found, items)
    read_standing(found, items)
    leave_clauses(found, items)
    leave_mentions(found, items, syntax)
    read_groups(found, items, syntax)
    read_shared_places(found, items, syntax)
    leave_restricted(found, items, syntax)
    for at, item in enumerate(items):
        if item.state in (NEGATED, KEPT):
            state = item.state
            read_settled(Here(found, items, at, syntax))
            item.state = state  # what is denied in one place is not asked for there
        elif item.state == DROPPED:
            read_dropped(Here(found, items, at, syntax))
    rules = (
        read_at_each, read_march, leave_ways, read_mix, read_clothes, read_beacons, read_air,
        read_enclosure, read_ring, read_site,
        read_modifier, read_streets, _strengths, read_quantity, _amounts, _shapes,
        read_middle, read_axis_or_side, _phrases, read_noun, read_looks, read_place,
    )  # fmt: skip
    for rule in rules:
        for at, item in enumerate(items):
            if not item.state:
                rule(Here(found, items, at, syntax))
    _drop_as_most(found, items, syntax)
    sum_up(found, items, syntax)
    take_back(found, items, syntax)
    settle_infill(found)
    leave_some_alone(found, items, syntax, unread(items, described=True))
    settle_counted_there(found)
    _call_high_houses_flats(found)
    settle_lamps(found)
    settle_walls(found)
    settle_standing(found)
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


def _read_every_second(items: Sequence[Item]) -> None:
    """Take "every second street" for a part of them; "every other" may be all the others."""
    for item, after in pairwise(items):
        share = EVERY_SO_MANY.get(item.get("rel"))
        if share is not None and item.text != "every other" and after.noun == "road":
            item.kind, item.senses = "quantity", ()
            item.quantity = Quantity("part", round(share, 4), round(share, 4))


def _settled_heads(items: Sequence[Item]) -> Syntax:
    """Return the noun phrases, once it is settled which words are things and which materials.

    "Houses of dark wood" are of timber, and "a house in a dark wood" is among trees; "dead-end
    lanes" are dead ends.
    """
    _settle_terraces(items)
    settle_greens(items)
    _settle_mills(items)
    for item, after in pairwise(items):
        if item.text in SHADES and after.has("material"):
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


def _settle_terraces(items: Sequence[Item]) -> None:
    """Take "rows of red-brick | terraces" for houses, which no terraces of the land are."""
    for at, (before, item) in enumerate(pairwise(items)):
        rows = before.text in _ROWS or before.has("material")
        if item.kind == "unknown" and item.text == "terraces" and rows:
            item.kind, item.senses = "phrase", (("noun", "type:terrace"),)
            first = before if before.text in _ROWS else items[max(at - 1, 0)]
            if first.text in _ROWS:
                first.state = first.state or READ


def _settle_mills(items: Sequence[Item]) -> None:
    """Take mills and the like that have chimneys for factories, not for wheels at a stream."""
    stacks = [at for at, item in enumerate(items) if item.get("slot") == "building.feature=chimney"]
    for at, item in enumerate(items):
        near = any(at < k <= at + _TO_CHIMNEY for k in stacks)
        if item.kind == "unknown" and item.text in _MILLS and near:
            item.kind, item.senses = "phrase", (("noun", "type:factory"),)


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
    if item.has("bound") and item.words[-1] == "than":
        thing = next((one for one in items[at + 1 :] if one.kind != "function"), item)
        return bool(thing.noun) and thing.quantity is None  # "a park | larger than the square"
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
    if here.item.text == "everywhere" and _are_told_of_all(noun):
        here.item.state = READ  # "terracotta roofs | everywhere"
        return
    busy = "heavy" if amount == "many" else "light"
    if noun.noun_class == "plant" or (noun.noun == "green" and amount == "many"):
        here.found.add("nature.trees", amount, here.item)
    elif noun.noun == "vehicle":
        here.found.add("traffic", busy, here.item, noun)
    elif noun.noun in (*KINDS_OF_PEOPLE, *ROLES):
        here.found.add("agent", noun.noun, here.item, noun)
    elif noun.noun_class == "person" and noun.noun != "dog":
        here.found.add("pedestrians", busy, here.item, noun)
    elif is_plural(noun.words[-1]):
        _some(here, noun)


def _are_told_of_all(noun: Item) -> bool:
    """Return whether a word is for streets, for buildings or for how these look."""
    looks = noun.get("slot").startswith(("building.", "roof."))
    return looks or noun.noun_class in (*BUILDINGS, "road") or noun.words[-1] in _PARTS_OF_ALL


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
    elif noun is not None and noun.words[-1] in PLOTS and noun.noun not in ELEMENTS:
        here.found.leave(here.item, f"size of the {here.found.said(noun)}")
    elif (noun is None and _district_behind(here)) or (noun is not None and noun.noun == "city"):
        here.found.add("size", item.get("size"), item)
    elif noun is not None and _has_size(here, noun):
        here.found.add(f"{noun.noun}.size", item.get("size"), item)
    elif noun is not None and noun.noun in ELEMENTS and "size" not in attributes_of(noun.noun):
        here.found.refuse(item, noun.noun, "size")
    elif noun is not None:
        here.found.leave(item, f"size of the {noun.noun}")


def _has_size(here: Here, noun: Item) -> bool:
    """Return whether a thing takes more or less ground than usual where it is large or small."""
    sized = noun.noun in ELEMENTS and ELEMENTS[noun.noun].has_size and noun.has("noun")
    return (
        sized
        and noun.noun not in KINDS
        and noun.state in ("", READ)
        and not here.is_another_kind(noun)
    )


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
    if height in LOW_AND_HIGH and noun.noun in BARRIERS:
        end, metres = LOW_AND_HIGH[height]
        here.found.add(f"{noun.noun}.height.{end}", metres, here.item)
        return
    if height and ringed and noun.noun not in _WITH_STOREYS:
        here.found.leave(here.item, f"height of the {noun.noun}")
        return
    if height == "tall" and noun.noun in ("house", *HOUSES):
        here.found.leave(here.item, f"height of the {noun.noun}")  # no such house is a tower
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
    elif (width and noun.noun in _WIDE) or (width and noun.noun == "sidewalk"):
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
    if here.found.mapped and _is_a_name_of_a_place(here):
        here.found.leave(here.item, "part of a name")
        return
    if here.item.text == "maze" and _is_a_garden(here):
        here.found.leave(here.item, "no maze of streets")
        return
    if here.item.get("slot").startswith(("building.roof", "building.feature")):
        placed = here.after is not None and here.after.get("rel") in ("on", "of")
        owner = under_a_roof(here, None) if placed else None
        owner = owner or here.owner(past_comma=here.item.words[-1].endswith("ed"))
        if owner is not None and owner.span < here.item.span:
            owner = roofed(here, owner, here.syntax.index(here.phrase_of(here.item)[0])) or owner
        whole = here if not placed or owner is None else replace(here, at=here.syntax.index(owner))
        part = owner is not None and stands_in_a_part(here, owner)
        if is_of_the_excepted(here):
            here.found.leave(here.item, "excepted")
            return
        if _are_roofs_of_some(here, owner) or (not part and is_set_apart(whole)):
            here.found.leave(here.item, ABOUT)
            return
        if (
            owner is not None
            and owner.noun_class in ("type", "element")
            and has_own_looks(here, owner)
        ):
            key, _, value = here.item.get("slot").partition("=")
            if key == "building.roof" and here.takes(owner, "roof"):
                here.found.add(f"{owner.noun}.roof", value, here.item)
            elif key == "building.roof" and owner.noun in ELEMENTS:
                here.found.refuse(here.item, owner.noun, "roof")
            else:
                here.found.leave(here.item, f"of the {here.found.said(owner)}")
            return
    if here.item.text in OUTSKIRTS and _are_there(here):
        return
    if here.item.get("slot").startswith("building.height=") and _are_heights_of_some(here):
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
    if here.item.get("slot") == "roads.pattern=grid" and _is_unknown(here.before):
        here.found.leave(here.item, "kind of grid")  # "hexagonal | grid"
        return
    if (
        here.item.words[-1] == "crowd"
        and here.before is not None
        and here.before.get("size") == "small"
    ):
        here.found.leave(here.item, "a crowd of its own")  # "a busker with a small | crowd"
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
            if key == "building.roof" and here.item.words[-1].endswith("s") and _is_counted(here):
                here.found.leave(here.item, "number of such roofs")  # "ten domes"
                continue
            every = key in _OF_BUILDINGS and here.of_every_building()
            here.found.add(key, value, here.item, every=every)
    if here.item.has("use") and _is_one_alone(here):
        here.found.leave(here.item, "a single one")  # "a convenience store on a corner"
    elif here.item.has("use"):
        every = here.of_every_building()
        here.found.add("building.use", here.item.get("use"), here.item, every=every)


def _is_counted(here: Here) -> bool:
    """Return whether a number stands before a word, which is then not of all buildings."""
    before = here.items[here.at - 1] if here.at else None
    number = before.quantity if before is not None else None
    return number is not None and number.dimension == "count"


# Quarters that decide what all of a town is -> the buildings that most of one are.
_A = ("a", "an")
_QUARTERS = {
    "suburban": "house", "industrial": "warehouse", "residential": "apartment",
    "downtown": "office", "commercial": "shop", "old_town": "", "slum": "", "village": "house",
}  # fmt: skip


def _is_unknown(item: Item | None) -> bool:
    return item is not None and item.kind == "unknown" and not item.state


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


def _are_heights_of_some(here: Here) -> bool:
    """Read "mid-rise flats" among others, which are the height of these alone."""
    head = here.syntax.modifies(here.at)
    owner = here.items[head] if head >= 0 else None
    if owner is None or owner.noun_class != "type":
        return False
    listed = any(
        one.noun_class == "type" and one.noun not in (owner.noun, *LANDMARKS) and one.has("noun")
        for one in here.items
    )
    if not (listed or are_of_some(here, owner)):
        return False
    height = here.item.get("slot").partition("=")[2]
    if height in ("tall", "low") and owner.noun in _WITH_STOREYS:
        here.found.add(f"{owner.noun}.height", height, here.item)
    else:
        here.found.leave(here.item, f"height of the {owner.noun}")
    return True


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


def _is_a_name_of_a_place(here: Here) -> bool:
    """Return whether a quarter is part of a name, where a map is given: "the East | Village"."""
    before = here.before
    own = here.found.said(here.item)[:1].isupper() and here.item.get("slot").startswith("district=")
    known = before is not None and before.kind != "mark" and here.found.said(before)[:1].isupper()
    return own and known and before is not None and before.has("side", "size", "shade")


_SIGHTS = ("view", "views", "sight", "sightline", "line", "path", "way", "passage")


def _is_plain(here: Here) -> bool:
    """Leave "clear" that is said of a thing and not of the sky: "a clear business district"."""
    head = here.syntax.modifies(here.at)
    thing = here.items[head] if head >= 0 else None
    if here.item.text != "clear":
        return False
    if here.after is not None and here.after.text in _SIGHTS:
        here.found.leave(here.item, f"of the {here.after.text}")
        return True
    if thing is None:
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
