"""Things: what is named is there, or says of which kind another thing is."""

from __future__ import annotations

from dataclasses import replace

from cityx.language.clauses import may_do
from cityx.language.here import (
    BUILDINGS,
    LANDMARKS,
    ROADS,
    SEVERAL,
    Here,
)
from cityx.language.lexicon.phrases import NOUNS, SPECIES
from cityx.language.lexicon.words import forms_of
from cityx.language.place_words import (
    NO_PLACE,
    REACH,
    RELATIONS,
    is_a_town,
    is_first_town,
    is_traffic_near,
    noun_after,
)
from cityx.language.relations import (
    LINED,
    PLACED,
    is_a_place,
    read_held,
    read_row,
)
from cityx.language.restrictions import is_at_known_things
from cityx.language.scan import ENDS, Item, begin_of
from cityx.language.scopes import READ
from cityx.language.syntax import is_plural, is_unknown
from cityx.town.elements import ELEMENTS
from cityx.town.quarter_kinds import COUNTED_KINDS

_WATERS = ("river", "canal", "lake", "harbour")  # which a "river promenade" has
_OF_THINGS = ("style", "density", "building.roof", "building.feature")  # said of towns or of things
# Heads that name the scene itself, which is as its adjectives say: "a rush hour test".
_FRAMES = ("test", "tests", "scene", "scenes", "scenario", "drill", "exercise", "demo", "shot",
           "simulation", "run", "footage", "sequence")  # fmt: skip
_OF_AIR = ("time", "season", "weather", "traffic", "pedestrians", "wetness", "lights")
_ADJECTIVAL = ("y", "ing", "ed", "al", "lit")
_STREETS = ("main_street", "avenue", "path", "crossing")  # not there because streets are
_BELOW, _HIDDEN = ("below", "under", "beneath"), ("underground", "subterranean", "sunken", "indoor")
_KINDS_OF_TREES = {name: kind for kind, names in SPECIES.items() for name in (kind, *names)}
_BEHIND = 3  # items behind trees in which the way to their place begins
PARTS_OF_HOUSES = ("roof", "window", "light")


def read_modifier(here: Here) -> None:
    """Leave open what only says of which kind another thing is: "school buses", "church bells"."""
    item, head = here.item, here.syntax.modifies(here.at)
    if item.has("noun") and item.noun_class in PLACED and _is_possessive(here):
        here.found.leave(item, "whose something is")
        return
    if item.get("slot") in (f"{key}={item.text[:-1]}" for key in ("season", "time")):
        here.found.leave(item, "several")  # "mineral springs"
        return
    if (
        item.text == "plain"
        and here.after is not None
        and (
            here.after.has("color", "material")
            or here.after.noun_class in BUILDINGS
            or here.after.kind == "unknown"
        )
    ):
        here.found.leave(item, "look of what is plain")
        return
    if item.words[-1] in ("plain", "plains") and here.is_some_kind(item):
        here.found.leave(item, "a kind of its own")  # "the flood plain"
        return
    if head < 0:
        return
    thing = here.items[head]
    if item.noun == "courtyard" and _are_most(here, thing):
        here.found.add("element", item.noun, item)  # "courtyard | houses" have some
        here.found.leave_span(item.span, f"of each of the {here.found.said(thing)}")
        return
    if item.has("slot") and _is_a_name(here, thing):
        here.found.leave(item, "part of a name")
    elif (item.has("source") and is_unknown(thing)) or (
        item.has("noun") and _names_a_kind(here, thing)
    ):
        here.found.leave(item, f"kind of the {here.found.said(thing)}")
    elif item.has("slot") and not item.has("noun") and _says_a_kind(here, thing):
        here.found.leave(item, f"of the {here.found.said(thing)}")


def _are_most(here: Here, thing: Item) -> bool:
    """Return whether buildings are named without a number."""
    counted = any(one.quantity is not None and one.quantity.dimension == "count"
                  for one in here.phrase_of(thing))  # fmt: skip
    return thing.noun_class in BUILDINGS and is_plural(thing.words[-1]) and not counted


def _is_possessive(here: Here) -> bool:
    """Return whether a noun only says whose a thing is: "a kids' town"."""
    said = here.found.said(here.item)
    mark = here.after is not None and here.after.is_mark("'’")
    return mark or said.endswith(("'s", "’s"))


def _is_a_name(here: Here, head: Item) -> bool:
    """Return whether a word is part of a name: "the | English Embankment"."""
    said = here.found.said
    between = here.items[here.at + 1 : here.syntax.index(head)]
    capital = all(said(one)[:1].isupper() for one in (here.item, *between, head))
    words = here.found.text.split()
    titled = 2 * sum(word[:1].isupper() for word in words) > len(words)
    named = head is not here.item and not head.has("slot")
    return capital and named and not titled


def _names_a_kind(here: Here, thing: Item) -> bool:
    """Return whether a noun before a head is no thing of its own: a river is, in "river town"."""
    item = here.item
    between = here.items[here.at + 1 : here.syntax.index(thing)]
    if thing.noun_class == "road" and any(one.kind == "unknown" for one in between):
        return True
    if item.noun in ("ring_road", "motorway"):  # "a ring wall", "a motorway slip road"
        town = thing.noun_class == "road" or thing.noun in ("city", "landscape")
        return thing.has("noun") and not town
    if item.text == "square" and (thing.noun_class == "place" or "district=" in thing.get("slot")):
        return True  # "square blocks", "a square test district"
    if item.noun_class not in PLACED or item.text == "flat":
        return False
    if is_unknown(thing):
        return True
    if thing.noun == "facade":
        return item.noun not in _WATERS
    if thing.noun_class == "place" or thing.get("slot").startswith("district="):
        lit = thing.noun == "light" and item.noun_class == "type"  # "shop lights"
        return lit or item.noun_class in ("person", "vehicle")  # "a commuter suburb"
    if thing.noun_class == "road":
        return item.noun_class == "vehicle" or (
            item.noun_class in ("element", "type") and item.noun not in _WATERS
        )
    own = thing.has("noun") and thing.noun_class in PLACED and thing.noun_class != "building"
    return own and item.noun not in _WATERS


def _says_a_kind(here: Here, thing: Item) -> bool:
    """Return whether a word for a town is said of one thing: "a modern fountain"."""
    key = here.item.get("slot").partition("=")[0]
    if thing.words[-1] in _FRAMES and key in _OF_AIR:
        return False
    unknown, town = is_unknown(thing), thing.has("slot") or thing.noun_class in ("place", "road")
    if key == "district" and thing.noun_class in ("element", "vehicle"):
        return here.item.get("slot") != "district=village"  # "an industrial canal"
    if key in ("district", "terrain", "size"):
        return unknown and any(is_a_town(one) for one in here.items if one is not here.item)
    if key in ("time", "season", "weather"):
        adjective = here.item.words[-1].endswith(_ADJECTIVAL)
        return not adjective and (unknown or thing.noun_class in ("element", "vehicle", "type"))
    if key in _OF_THINGS:
        common = thing.noun_class in BUILDINGS and not here.of_one_thing(thing)
        alone = key in ("style", "density") and not any(
            is_a_town(one) or one.noun_class in BUILDINGS
            for one in here.items if one not in (here.item, thing)
        )  # fmt: skip
        return not (town or common or alone)
    if key == "roads.pattern":
        return not (town or thing.noun_class in BUILDINGS)
    return unknown and key in ("wetness", "lights", "traffic", "pedestrians", "nature.trees")


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
    return unknown and not begins


def _is_of_a_compound(here: Here) -> bool:
    """Return whether a noun ends a word that is not known: "heat-island"."""
    hyphen = here.before is not None and here.before.is_mark("-")
    return hyphen and here.at > 1 and here.items[here.at - 2].kind == "unknown"


def _of_other_things(here: Here) -> bool:
    """Return whether rings are no roads: "growth | rings", "rings | of housing"."""
    before, behind = here.before, here.items[here.at + 1 : here.at + 3]
    named = used = False
    if before is not None and before.kind not in ("function", "mark", "quantity"):
        named = not before.has("amount", "size", "rel", "neg", "keep", "verb")
        used = before.text == "use"  # "land-use rings"
    of_ = len(behind) == 2 and behind[0].get("rel") == "of" and behind[1].noun_class != "road"
    return named or used or of_


def read_noun(here: Here) -> None:
    """Read what is there because it is named."""
    item = here.item
    if not item.noun or (not item.has("noun") and item.has("material", "color")):
        return  # "glass-fronted | offices"
    noun, group = item.noun, item.noun_class
    if _is_of_a_compound(here) or item.text == "flat" or item.has("direction"):
        return  # "rooftops mostly flat" speaks of no apartment, "one-way streets" are left
    if here.after is not None and here.after.is_mark("-") and _is_free(here):
        here.found.deny(noun, item)
        return
    if group in BUILDINGS and noun not in LANDMARKS and _is_measured_from(here):
        item.state = READ
        return
    about = (
        _is_no_thing(here)
        or _is_no_road(here)
        or ("of a compound" if _begins_a_compound(here) else "")
    )
    named = {"main", "high", "principal"}.intersection(item.words)
    if about == _BARE and noun == "main_street" and named and not here.found.mapped:
        here.found.add("element", noun, item)  # "with a | main street"
    elif about:
        here.found.leave(item, about)
    elif group == "type":
        _type(here)
    elif group == "element" and _are_several(item):
        here.found.add(f"{noun}.count.min", SEVERAL, item)
    elif group == "element":
        here.found.add("element", noun, item)
        read_held(here)
    elif group == "plant" and here.is_a_single(item):
        here.found.add("tree.count.min", 1, item)
    elif group == "plant":
        here.found.add("nature.trees", "some", item)
        _species(here)
    elif noun == "pedestrian" and here.is_a_single(item):
        here.found.add("pedestrian.count.min", 1, item)
    elif noun in ("vehicle", "pedestrian"):
        here.found.add("traffic" if noun == "vehicle" else "pedestrians", "medium", item)
    elif noun == "parked_vehicle":
        here.found.leave(item, "where they are parked")
    elif group in ("vehicle", "person"):
        here.found.add("agent", noun, item)
    elif noun == "ring_road" and here.syntax.modifies(here.at) >= 0:
        here.found.leave(item, "a kind of town")  # "a ring | city"
    elif noun == "ring_road" and item.text == "rings" and _of_other_things(here):
        here.found.leave(item, "rings of other things than roads")  # "land-use | rings"
    elif noun == "ring_road" and here.found.has("roads.rings"):
        item.state = READ  # "three ring roads, the inner | ring"
    elif noun == "ring_road":
        here.found.add("roads.rings", 2 if is_plural(item.words[-1]) else 1, item)
    elif noun == "motorway":
        here.found.add("roads.motorways", 1, item)
    elif group in ("building", "road", "place") and noun not in ("flying", "crane", "center"):
        item.state = READ


_FIELDS = ("forest", "meadow", "vineyard", "orchard", "crop_field")  # land without a number


def _are_several(item: Item) -> bool:
    """Return whether more than one element is named: "fountains", but no "allotments".

    Of a word that the book knows in the plural alone there may be one, and land has no number.
    """
    element = ELEMENTS.get(item.noun)
    placed = item.noun in ("plaza", "park", "lake", "pond", "bridge")
    made = element is not None and bool(element.building or element.points or element.areas)
    known = placed or (made and item.noun not in _FIELDS and not is_plural(item.noun))
    return known and is_plural(item.words[-1]) and item.text not in _written(item.noun)


def _written(noun: str) -> tuple[str, ...]:
    """Return the words of an element as the book has them."""
    return tuple(word.strip() for word in NOUNS["element"].get(noun, "").split(","))


def _is_measured_from(here: Here) -> bool:
    """Return whether something is only kept away from buildings: "500 m from any | house"."""
    first = here.syntax.index(here.phrase_of(here.item)[0])
    before = here.items[max(0, first - 2) : first]
    if len(before) < 2 or before[1].text not in ("from", "of", "to"):
        return False
    far = before[0].quantity is not None and before[0].quantity.dimension == "length"
    return far or before[0].text in ("away", "far", "clear", "distant")


def _is_no_road(here: Here) -> str:
    """Return what rings are where they are no roads: "changing in rings", "a ring of streets"."""
    item, before, after = here.item, here.before, here.after
    if item.noun != "ring_road" or item.words[-1] not in ("ring", "rings"):
        return ""
    of = after is not None and after.get("rel") == "of"
    among = before is not None and before.get("rel") == "in" and before.text == "in"
    rings = before is not None and item.text == "ring" and is_plural(before.text)
    among = among or (rings and before is not None and before.kind != "function")  # "bells | ring"
    return "rings of something" if of or among else ""


def _begins_a_compound(here: Here) -> bool:
    """Return whether a noun begins a word that is not known: "car-sharing"."""
    behind = here.items[here.at + 1 : here.at + 3]
    return len(behind) == 2 and behind[0].is_mark("-") and behind[1].kind == "unknown"


def is_species(item: Item) -> bool:
    """Return whether a noun names a kind of trees."""
    return item.noun_class == "plant" and any(
        form in _KINDS_OF_TREES for form in forms_of(item.text)
    )


def _species(here: Here) -> None:
    """Read the kind of trees, of the whole town or of its streets or parks."""
    kind = next((_KINDS_OF_TREES[form] for form in forms_of(here.item.text)
                 if form in _KINDS_OF_TREES), "")  # fmt: skip
    if not kind:
        return
    behind = range(here.at + 1, min(here.at + 1 + _BEHIND, len(here.items)))
    way = next((at for at in behind if here.items[at].get("rel") in RELATIONS), -1)
    place = noun_after(replace(here, at=way)) if way > 0 else None
    one = not is_plural(here.item.words[-1]) and here.phrase_of(here.item)[0].text in ("a", "an")
    own = one or (way > 0 and place is None)  # "in the middle", "on both sides"
    if not own and _lines_streets(here):
        here.found.add("nature.species.streets", kind, here.item)
        return
    if own or (place is not None and place.noun in NO_PLACE and place.noun == "center"):
        here.found.leave(here.item, "kind of the trees")
    elif place is None or place.noun in NO_PLACE:
        here.found.add("nature.species", kind, here.item)
    elif place.noun_class == "road":
        here.found.add("nature.species.streets", kind, here.item)
    elif place.noun == "park":
        here.found.add("nature.species.parks", kind, here.item)
    elif not read_row(replace(here, at=way), here.item, place):
        here.found.leave(here.item, "kind of the trees")


def _lines_streets(here: Here) -> bool:
    """Return whether trees line streets: "avenues lined with | planes"."""
    before = here.items[begin_of(here.items, here.at, ENDS) : here.at]
    lined = next((at for at in range(len(before) - 1, max(-1, len(before) - 4), -1)
                  if before[at].words[:1] and before[at].words[0] in LINED), 0)  # fmt: skip
    nouns = [one for one in before[:lined] if one.noun and one.noun_class != "place"]
    return bool(nouns) and nouns[-1].noun_class == "road"


_NOT = ("not", "n't", "never", "cannot")
_HAVING = (
    "featuring", "containing", "including", "comprising", "having", "showing", "boasting",
    "involving",
)  # fmt: skip


def _is_denied_something(here: Here) -> bool:
    """Return whether a thing is not to do something: "cars should not drive in the lanes"."""
    after = here.after
    if after is None or not (after.has("neg") and after.text.endswith(_NOT)):
        return False
    measured = any(item.quantity is not None for item in here.clause())
    return here.item.noun_class in PLACED and not measured


def _is_given_to(here: Here) -> bool:
    """Return whether people are those who get something: "give the | kids a town"."""
    phrase = here.phrase_of(here.item)
    first = here.syntax.index(phrase[0])
    giver = here.items[first - 1] if first else None
    then = here.after
    giving = giver is not None and giver.text in ("give", "build", "make", "show", "offer")
    return giving and then is not None and then.text in ("a", "an", "the", "some")


def _is_said_of_streets(here: Here) -> bool:
    """Return whether "pedestrian" says how streets are: "the inner streets are pedestrian"."""
    before = here.before
    be = before is not None and before.get("rel") == "be" and not is_plural(here.item.words[-1])
    return be and any(one.noun_class == "road" for one in here.before_in_clause())


def _is_in_one_place(here: Here) -> bool:
    """Return whether a clause with "where" tells of a place alone: "the edge, where huts stand"."""
    before = here.before_in_clause()
    where = next((one for one in before if one.text == "where"), None)
    if where is None:
        return False
    at = here.syntax.index(where)
    head = here.syntax.head_before(at, past_comma=True)
    place = here.items[head] if head >= 0 else None
    if place is None or place.noun_class in ("road", "place"):
        return False
    return not (is_a_town(place) and is_first_town(here, place))


def is_where_a_town_is(here: Here) -> bool:
    """Return whether "where" before an item tells of all of a town: "a town where there is no"."""
    where = next((one for one in here.before_in_clause() if one.text == "where"), None)
    head = -1 if where is None else here.syntax.head_before(here.syntax.index(where))
    place = here.items[head] if head >= 0 else None
    town = place is not None and (place.noun == "city" or "district=" in place.get("slot"))
    return place is not None and town and is_first_town(here, place)


def _is_underground(here: Here) -> bool:
    """Return whether a thing is to lie below the ground: "a car park below ground"."""
    behind = here.items[here.at + 1 : here.at + 3]
    low = len(behind) == 2 and behind[0].text in _BELOW and behind[1].noun == "landscape"
    near = (*here.phrase_of(here.item), *behind[:1])
    return low or any(one.text in _HIDDEN for one in near)


def _is_an_infinitive(here: Here) -> bool:
    """Return whether a noun is a verb with an object: "somewhere to | park the car"."""
    before, after = here.before, here.after
    to = before is not None and before.text == "to" and len(here.item.words) == 1
    return to and after is not None and after.text in ("the", "a", "an", "your", "my", "our")


def _is_done_with(here: Here, before: Item) -> bool:
    """Return whether a noun is the object of what a thing before does: "carrying | lanterns"."""
    does = before.kind == "unknown" and before.text.endswith("ing") and before.text not in _HAVING
    return does and here.syntax.head_before(here.at - 1) >= 0


_BARE = "nothing is said of it"


def _is_no_thing(here: Here) -> str:
    """Return why a noun that is named is not built for that, "" if it is."""
    item, noun = here.item, here.item.noun
    whole = here.part_of_one(item)
    if whole is not None:
        return f"of the {here.found.said(whole)}"
    if here.is_another_kind(item):
        return "a kind of its own"
    if _is_an_infinitive(here):
        return "what somebody does"
    if _is_denied_something(here):
        return "of which something is denied"
    if here.before is not None and _is_done_with(here, here.before):
        return "what something is done with"
    if item.noun_class == "element" and _is_underground(here):
        return "below the ground"
    living = noun == "vehicle" or item.noun_class == "person"
    if living and _of_another_kind(here):
        return "a kind of its own"
    if item.noun_class in ("vehicle", "person") and noun != "vehicle" and may_do(here):
        return "what it can do"
    if item.noun_class == "person" and _is_given_to(here):
        return "whom it is for"
    if noun == "pedestrian" and _is_said_of_streets(here):
        return "for whom streets are"
    if item.noun_class in ("type", "element") and _is_in_one_place(here):
        return "in one place alone"
    told = item.state == READ or _is_measured(here) or _has_traffic(here) or is_a_place(here)
    street = noun in _STREETS and not told
    part = noun in (*PARTS_OF_HOUSES, "facade") and not _has_a_look(here)
    part = part and not any(
        one.get("slot").startswith("weather=snow") for one in here.clause(REACH)
    )
    return _BARE if street or part else ""


def _type(here: Here) -> None:
    """Read a type of building: one thing, one of which nothing is known, or what most are."""
    item, noun = here.item, here.item.noun
    told = here.items[max(begin_of(here.items, here.at, ENDS), here.at - 3) : here.at]
    every = any(one.get("rel") == "all" for one in told)
    near = here.items[max(0, here.at - 2) : here.at]
    one = any(before.text in ("a", "an", "the", "one") for before in near)
    alone = not every and not is_plural(item.words[-1])
    before = here.before
    if before is not None and before.has("neg") and before.state == READ:
        item.state = READ  # "no office above 11 m" asks for none
    elif not alone and (
        here.phrase_of(item)[0].text in ("its", "their") or is_at_known_things(here, item)
    ):
        item.state = READ
        here.found.presume(f"{noun}.count.min", SEVERAL, item)
    elif alone and (noun in LANDMARKS or (noun in ELEMENTS and one)):
        here.found.add("element", noun, item)
    elif noun in LANDMARKS and noun in ELEMENTS and not every:
        here.found.add(f"{noun}.count.min", SEVERAL, item)
    elif alone and one and noun in COUNTED_KINDS and noun != "house":
        here.found.add(f"{noun}.count.min", 1, item)
        here.found.add("building.type", noun, item)
    elif alone and (one or _is_bare(here)):
        here.found.leave(item, f"a single {noun}")
    else:
        here.found.add("building.type", noun, item)


def _is_bare(here: Here) -> bool:
    """Return whether a single building is named in a list beside others: "church, pub, houses"."""
    phrase = here.phrase_of(here.item)
    others = any(
        one.noun_class == "type" and one.noun != here.item.noun and one.has("noun")
        for one in here.items
    )
    first = here.syntax.index(phrase[0])
    listed = first > 0 and (
        here.items[first - 1].is_mark(",:") or here.items[first - 1].get("rel") == "and"
    )
    return others and listed and len(phrase) == 1


def _has_a_look(here: Here) -> bool:
    """Return whether the material or colour of a part of buildings is told."""
    phrase = here.phrase_of(here.item)
    return any(one.has("material", "color") for one in (*phrase, *here.clause(REACH)))


def _has_traffic(here: Here) -> bool:
    """Return whether a street is where traffic is, which is measured on main streets."""
    return here.item.noun == "main_street" and is_traffic_near(here)


def _is_measured(here: Here) -> bool:
    """Return whether something was read of a street: its width, axis or number."""
    key = ROADS.get(here.item.noun, here.item.noun)
    return any(slot.key.startswith(f"{key}.") for slot in here.found.slots)
