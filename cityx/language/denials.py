"""Denials: what is denied, protected or to be there in place of something else."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

from cityx.language.brief import Note
from cityx.language.clauses import may_do
from cityx.language.denied_traits import TRAIT
from cityx.language.here import BUILDINGS, COUNTED, ROADS, Here
from cityx.language.place_words import NO_PLACE
from cityx.language.scan import ENDS, Item
from cityx.language.scopes import NEGATED, READ
from cityx.language.syntax import is_plural, is_unknown
from cityx.language.things import is_species, is_where_a_town_is

_LACKING = (
    "without", "with no", "free", "lacking", "bare of", "empty of", "devoid", "cleared of",
    "clear of", "rid of", "emptied of", "stripped of", "shut to", "closed to", "barred to",
    "off limits", "out of bounds",
)  # fmt: skip
_ONE_PLACE = ("element", "type", "vehicle", "person")

# What stands behind a word about how much of it there is.
_THINGS = {"nature.trees": "tree", "pedestrians": "pedestrian", "lights": "light"}
_WITHIN = ("inside", "within", "behind", "outside", "beyond", "beneath", "under")
_DOING = ("road", "place", "vehicle", "person", "plant", "element")
_BEING = ("be", "stand", "exist", "remain", "appear")
_THERE = ("there", "present", "seen", "visible", "allowed", "permitted", "anywhere", "left")
_WHERE = ("near", "on", "along", "around")


def read_settled(here: Here) -> None:
    """Put what is denied or protected into its own list."""
    item = here.item
    denied = item.state == NEGATED
    value = _settled_value(here)
    if item.has(TRAIT):
        here.found.deny(item.get(TRAIT), item)
    elif denied and item.get("slot") in ("weather=cloudy", "weather=overcast"):
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
    elif value and denied and _is_where(here):
        here.found.leave(item, "denied in one place alone")  # "land where nobody builds"
    elif value == "everything" and denied and not _ends(here):
        here.found.leave(item, "denied in one part alone")  # "leave out everything | west of it"
    elif value and denied and _there_alone(here):
        here.found.leave(item, "denied in one place alone")
    elif value and denied and _of_one_place(here):
        here.found.leave(item, "denied of one thing alone")
    elif value and denied and (_is_compared(here) or _are_two(here) or _does_something(here)):
        here.found.leave(item, "of which something is denied")
    elif value and denied and any(one.text in ("until", "till") for one in here.clause()):
        here.found.leave(item, "denied for a time alone")
    elif value and denied and _is_missing_in_a_file(here):
        here.found.leave(item, "what a file shows")
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
    elif value == "everything" and here.after is not None and here.after.has("side"):
        here.found.leave(item, "kept in one part alone")  # "don't touch anything | south of it"
    elif value:
        here.found.keep(value, item)
    elif denied and item.get("strip") == "parking":
        here.found.deny("parked_vehicle", item)  # "no on-street parking"
    elif denied and (
        item.has("height", "width", "size", "attr", "surface", "strip")
        or item.get("rel") == "near"
        or item.quantity is not None
    ):
        here.found.leave(item, "denied")


def read_dropped(here: Here) -> None:
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


def _ends(here: Here) -> bool:
    """Return whether a clause ends behind an item."""
    return here.after is None or here.after.is_mark(ENDS + ",")


def _does_something(here: Here) -> bool:
    """Return whether what things do or may do is denied: "no house | sharing a wall"."""
    after, before = here.after, here.before_in_clause()
    neg = max((n for n, one in enumerate(before) if one.has("neg")), default=len(before))
    if any(_is_done(one) for one in before[neg + 1 :]):
        return True  # "no house sharing | a wall"
    if after is None or here.item.noun_class not in (*BUILDINGS, *_DOING):
        return False
    doing = _is_done(after) and after.kind == "unknown" and after.text != "existing"
    if _is_done(after):
        to = here.items[here.at + 2 : here.at + 4]
        if any(one.noun or one.text in ("the", "a", "each") for one in to[:1]):
            return True  # "no lamp posts blocking | the walkways"
    own = here.item.noun_class in (*BUILDINGS, "road", "place")
    behind = [one.text for one in here.clause() if one.span > after.span]
    there = not behind or (behind[0] in _BEING and behind[1:2] in ([], *([one] for one in _THERE)))
    return (doing and own) or (may_do(here) and not there)


def _is_done(item: Item) -> bool:
    """Return whether a participle tells what things do: "sharing", "blocking"."""
    verbal = item.kind == "unknown" or item.has("verb")
    return item.text.endswith("ing") and verbal and not item.has("noun")


def _is_where(here: Here) -> bool:
    """Return whether a clause denies something of one place: "land where nobody builds"."""
    where = any(one.text == "where" for one in here.before_in_clause())
    return where and not is_where_a_town_is(here)


def _is_missing_in_a_file(here: Here) -> bool:
    """Return whether a text tells what a file lacks: "there are no | buildings in it"."""
    link, of = [*here.items[here.at + 1 : here.at + 3], None, None][:2]
    said = link is not None and link.get("rel") in ("in", "on") and of is not None
    there = any(one.text == "there" for one in here.before_in_clause()[-4:])
    return bool(
        here.found.mapped and there and said and of is not None
        and (of.text in ("it", "the map", "there") or of.has("any_source", "source"))
    )  # fmt: skip


def _there_alone(here: Here) -> bool:
    """Return whether something is denied in one place alone: "no trees on the main road"."""
    last = _last_denied(here)
    if last + 1 < len(here.items) and here.items[last + 1].has("mode"):
        last += 1  # "no cars moving | on the street between"
    after = here.items[last + 1] if last + 1 < len(here.items) else None
    rel = after.get("rel") if after is not None else ""
    place = here.items[last + 2 : last + 4]
    nouns = [one for one in place if one.noun and one.noun not in ("road", "city", "landscape")]
    middle = any(one.noun == "center" for one in nouns)  # "no cars in the centre"
    element = any(one.noun_class == "element" for one in nouns)
    quarter = any("district=" in one.get("slot") for one in here.items[last + 2 : last + 5])
    unknown = len(place) == 2 and place[0].text in ("the", "this") and place[1].kind == "unknown"
    if unknown and rel in ("on", "in", "along", "near", "around"):
        return True  # "no cars on the course"
    if after is not None and after.text in _WITHIN:
        ends = last + 2 >= len(here.items) or here.items[last + 2].is_mark(ENDS + ",")
        return bool(nouns) or ends or quarter  # "inside the city wall", "no cars | inside"
    if rel in ("on", "in") and _street_apart(here.items[last + 2 : last + 5]):
        return True
    if rel == "in":
        return middle or quarter or element or any(one.noun in ROADS for one in nouns)
    head = here.syntax.object_of(last + 1) if after is not None else -1
    unknown = head > 0 and is_unknown(here.items[head]) and here.items[head - 1].text == "the"
    named = bool(place) and place[0].text == "the" and any(one.noun for one in place)
    if after is not None and after.text in ("from", "between") and named:
        return True  # "no cars drive | from the church to the park"
    return rel in ("on", "along", "near", "around") and (bool(nouns) or unknown)


def _street_apart(place: Sequence[Item]) -> bool:
    """Return whether one street is set apart from others: "the street between", "in front of"."""
    for street, told in pairwise(place):
        if street.noun == "road" and not is_plural(street.words[-1]):
            return told.get("rel") in ("near", "along", "by", "to") or (
                told.text in ("between", *_WITHIN)
            )
    return False


def _last_denied(here: Here) -> int:
    """Return where a list of what is denied ends: "no houses or | shops near the river"."""
    last = here.at
    while last + 2 < len(here.items) and (
        here.items[last + 1].get("rel") in ("or", "and") or here.items[last + 1].text == "nor"
    ):
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
    skipped = [one for one in before if one.has("neg") and one.text.endswith("ing")]
    if skipped and here.item.noun_class in ("road", "place"):
        return True  # "a tree every 10 m, skipping | junctions"
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
    head = here.syntax.modifies(here.at)
    if head >= 0 and here.item.has("noun"):  # "no road markings", "no park benches"
        return is_unknown(here.items[head]) or here.items[head].state == NEGATED
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
        if item.noun in NO_PLACE:
            return "" if item.state == NEGATED else "everything"
        return COUNTED["plant"] if item.noun_class == "plant" else item.noun
    if item.has("slot"):
        key, _, value = item.get("slot").partition(" ")[0].partition("=")
        return _THINGS.get(key, value)
    alone = here.after is None or not here.after.noun
    return (item.get("material") or item.get("color")) if alone else ""
