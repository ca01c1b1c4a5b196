"""Looks: materials and colours with what they are of."""

from __future__ import annotations

from cityx.language.brief import Note
from cityx.language.here import AIR, BUILDINGS, Here
from cityx.language.measurable import look_of_kind
from cityx.language.relations import has_own_looks
from cityx.language.restrictions import (
    ABOUT,
    IN_MANY_COLORS,
    OF_A_PART,
    is_of_the_excepted,
    is_set_apart,
)
from cityx.language.scan import ENDS, Item, begin_of
from cityx.language.scopes import NEGATED, READ
from cityx.language.syntax import is_unknown
from cityx.language.things import PARTS_OF_HOUSES
from cityx.town.elements import ELEMENTS, OTHER_THINGS, PLACES, attributes_of, looked_at

_OF_THE_AIR = (*AIR, "wetness=")
_RANGES = ("colourful", "pastel")  # of which each building has one in turn
_NEAR = 3  # items behind a colour in which the thing is that has it
_HELD = 3  # things that one thing has besides a roof
_HAVING = ("with", "has", "have", "having")
SHADES = ("dark", "deep", "pale", "bright", "light", "rusty")  # of a colour or a material
_MADE_OF = ("of", "in", "made of", "built of", "made from", "out of")
_GROUND = ("ground", "soil", "earth", "land", "terrain", "dirt")


def _of_roofs(here: Here, noun: Item | None) -> bool:
    """Return whether a colour is that of roofs: "red roofs", "give the roofs a red colour"."""
    if noun is not None:
        return noun.noun == "roof"
    if here.after is not None and here.after.get("slot").startswith("building.roof"):
        return True  # "grey slate"
    owner = here.owner()
    if owner is not None:
        return owner.noun == "roof"  # "the walls are | white and the roofs are red"
    if any(one.noun == "roof" for one in here.before_in_clause()):
        return True
    for one in here.items[here.at + 1 :]:  # "most of them | white with red roofs"
        if one.kind == "mark" or one.get("rel") in ("with", "and"):
            return False
        if one.noun == "roof":
            return True
    return False


_COVERS = ("metal",)  # materials of roofs; slate and tiles are kinds of roofs by themselves


def _is_of_what_covers(here: Here, noun: Item | None) -> bool:
    """Return whether a material is that of roofs: "roofs of | copper", "roofs: | metal"."""
    owner = noun or here.owner()
    if owner is not None:
        return owner.noun == "roof" and not owner.get("slot").startswith("building.roof")
    labels = here.items[max(0, here.at - 2) : here.at]
    return any(one.noun == "roof" for one in labels)


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


def _roof_look(here: Here, roof: Item | None, key: str, look: str, value: str) -> None:
    """Read a look of roofs, of the one thing or kind of building that has them if one does."""
    thing = under_a_roof(here, roof)
    one = thing is not None and (thing.noun in ELEMENTS and thing.noun_class == "element")
    if thing is None or not (one or has_own_looks(here, thing) or here.of_a_kind(thing)):
        if is_set_apart(here):
            here.found.leave(here.item, ABOUT)
            return
        here.found.add(key, value, here.item)
    elif here.takes(thing, look):
        here.found.add(f"{thing.noun}.{look}", value, here.item)
    elif thing.noun in ELEMENTS:
        here.found.refuse(here.item, thing.noun, look)
        if roof is not None:
            roof.state = roof.state or READ
        return
    else:
        here.found.leave(here.item, f"look of the roof of the {here.found.said(thing)}")
        return
    _leave_shade(here)


def under_a_roof(here: Here, roof: Item | None) -> Item | None:
    """Return the building of "a church with a red | roof" or "a blue | dome on the church"."""
    at = here.at if roof is None else here.syntax.index(roof)
    phrase = here.syntax.phrase(at)
    end = at + 1 if phrase is None else phrase.end
    on = end < len(here.items) and here.items[end].get("rel") in ("on", "of")
    head = here.syntax.object_of(end) if on else -1
    if head < 0 or not here.items[head].has("noun"):  # "with red roofs | at the edge"
        head = here.syntax.head_before(at if phrase is None else phrase.first)
    thing = here.items[head] if head >= 0 else None
    return roofed(here, thing, at if phrase is None else phrase.first)


def roofed(here: Here, thing: Item | None, first: int) -> Item | None:
    """Return what has a roof: what has the things that a roof is told of besides.

    "A | school with a playground and a red roof" is no red playground.
    """
    own, link = thing, here.items[first - 1] if first else None
    for _ in range(_HELD):
        if own is None or link is None or not (link.get("rel") == "and" or link.is_mark(",")):
            break
        bare = own.noun_class == "element" and "roof" not in attributes_of(own.noun)
        if not bare or not own.has("noun"):
            break
        first = here.syntax.index(here.phrase_of(own)[0])
        head, link = here.syntax.head_before(first, past_comma=True), here.items[first - 1]
        own = here.items[head] if head >= 0 and first else None
        if own is not None and link.text in _HAVING:
            thing = own
            break
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


def read_looks(here: Here) -> None:
    """Read materials and colours with what they are of."""
    material, color = here.item.get("material"), here.item.get("color")
    if not (material or color):
        _read_paving(here)
        return
    noun = here.noun_behind()
    if noun is not None and (made := _made_of(here, noun)) is not None:
        noun = made
    head = here.syntax.head_behind(here.at)
    feature = here.items[head] if head >= 0 else here.item
    if _is_of_the_rest(here):
        here.found.leave(here.item, OF_A_PART)
    elif (
        color in _RANGES
        and (owner := noun or here.owner()) is not None
        and (owner.noun_class in BUILDINGS)
    ):
        here.found.leave(here.item, IN_MANY_COLORS)
    elif feature.get("slot").startswith("building.feature="):
        here.found.leave_look(here.item, feature)  # "red | awnings"
    elif color and noun is None and _is_a_substance(here):
        here.found.leave(here.item, "a thing of its own")  # "white | sand", "with roses"
    elif here.after is not None and here.after.text == "up":
        here.found.leave(here.item, "a state of them")  # "shops | boarded up"
    elif is_of_the_excepted(here):
        here.found.leave(here.item, "excepted")
    elif _is_of_it(here):
        here.found.leave(here.item, ABOUT)
    elif color and feature.get("slot").startswith("terrain="):
        here.found.leave_look(here.item, feature)  # "green | mountain"
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
        _roof_look(here, noun, "roof.color", "roof_color", color)
    elif material and _is_of_what_covers(here, noun):
        if material in _COVERS:
            _roof_look(here, noun or here.owner(), "building.roof", "roof", material)
        else:
            here.found.leave(here.item, "material of the roofs")
    elif (thing := _not_of_buildings(here, noun)) is not None and here.takes(
        thing, look := "material" if material else "color"
    ):
        if look == "material" and color and not looked_at(thing.noun):
            look = "color"  # no building is of bronze
        here.found.add(f"{thing.noun}.{look}", material if look == "material" else color, here.item)
        _leave_shade(here)
    elif thing is not None and (thing.noun in ELEMENTS or thing.noun in OTHER_THINGS):
        here.found.refuse(here.item, thing.noun, "material" if material else "color")
    elif thing is not None:
        here.found.leave_look(here.item, thing)
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


# Words for colours that are things as well.
_SUBSTANCES = frozenset(
    ("sand", "gold", "silver", "copper", "rust", "rose", "lime", "olive", "orange", "peach", "plum",
     "cherry", "salmon", "coral", "cream", "chocolate", "charcoal", "emerald", "ruby", "lavender")
)  # fmt: skip


def _is_a_substance(here: Here) -> bool:
    """Return whether a word for a colour is the thing itself: "white | sand", "beds of roses"."""
    word = here.item.text
    if word not in _SUBSTANCES and word.removesuffix("s") not in _SUBSTANCES:
        return False
    before, after = here.before, here.after
    led = before is not None and (before.has("color", "size") or before.text in ("with", "the"))
    joined = (
        after is not None
        and after.get("rel") == "and"
        and any(one.has("surface") for one in here.items[here.at + 2 : here.at + 3])
    )
    return word not in _SUBSTANCES or led or joined


def _made_of(here: Here, noun: Item) -> Item | None:
    """Return what is of a material that a list follows: "a fountain of | bronze and red benches".

    None where the material is of the noun behind it: "streets of | brick and timber houses".
    """
    between = here.items[here.at + 1 : here.syntax.index(noun)]
    linked = here.before is not None and here.before.text in _MADE_OF
    if not linked or not any(one.get("rel") == "and" or one.is_mark(",") for one in between):
        return None
    of = here.syntax.head_before(here.at)
    thing = here.items[of] if of >= 0 else None
    if thing is None or not thing.has("noun") or thing.noun in PLACES:
        return None
    return thing if thing.noun_class in ("type", "element") else None


def _read_paving(here: Here) -> None:
    """Read what the ground of a place is paved with: "a gravel | car park"."""
    surface = "" if here.item.has("slot") else here.item.get("surface")
    thing = here.noun_behind() or here.noun_before() if surface else None
    known = thing is not None and (thing.noun in ELEMENTS or thing.noun in OTHER_THINGS)
    if thing is None or not known or thing.state not in ("", READ):
        return
    if any(one.has("surface") for one in here.items[here.at + 1 : here.at + 3]):
        here.item.state = READ  # "paved with | gravel"
        return
    if not here.takes(thing, "material"):
        here.found.refuse(here.item, thing.noun, "material")
    elif look_of_kind(f"{thing.noun}.material", surface)[0]:
        here.found.add(f"{thing.noun}.material", surface, here.item)
    else:
        here.found.leave(here.item, f"what no {here.found.said(thing)} is of")
    for one in here.items[max(0, here.at - 2) : here.at]:
        if one.text in ("paved", "surfaced", "covered", "laid"):
            one.state = one.state or READ


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


_PARTS = ("quarter", "third", "half", "fifth", "tenth")
_REST = ("rest", "others", "everything else", "all else", "anything else")


def _is_of_the_rest(here: Here) -> bool:
    """Return whether a look is of some of what was told: "half are white and the rest | grey"."""
    before = here.before_in_clause()
    if any(one.get("rel") == "rest" or one.text in _REST for one in before):
        return True
    part = [one for one in before if one.quantity is not None
            and one.quantity.dimension in ("part", "share")]  # fmt: skip
    near = here.items[max(0, here.at - 2) : here.at]
    sentence = here.items[begin_of(here.items, here.at, ENDS) : here.at]
    if any(one in part or one.text in _PARTS for one in near) and any(
        one.noun_class in BUILDINGS for one in sentence
    ):
        return True  # "a third of the houses yellow, a third | white"
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
    of_all = of_all and owner.words[-1] not in _GROUND  # "red sand | ground"
    if owner.noun == "facade" and _are_free_walls(here, owner):
        return owner
    own = has_own_looks(here, owner) or here.of_a_kind(owner)
    return None if of_all and not own else owner


def _is_a_share(here: Here) -> bool:
    """Return whether "green" is what a part is: "at least a quarter | green"."""
    before = here.before
    return before is not None and (before.quantity is not None or before.text in _PARTS)


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
    apart = before is not None and before.text in SHADES
    shade = before if apart and before is not None else here.item
    if apart or (len(shade.words) > 1 and shade.words[0] in SHADES):
        shade.state = READ
        said = f'"{shade.words[0]}" of "{here.found.said(here.item)}" is left open.'
        here.found.notes.append(Note("left_open", said, shade.span))
