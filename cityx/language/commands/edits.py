"""Edits: a parsed command becomes the changes it asks for."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace

from cityx.checks.predicates.vocabulary import family_of
from cityx.language.brief import Edit, Reference, Selector, Value
from cityx.language.commands.grammar import Node
from cityx.language.commands.selection import (
    HERE,
    IT,
    MEASURES,
    PEOPLE,
    Place,
    choice_of,
    is_plural,
    kind_of,
    placed,
    places_of,
    references_of,
    species_of,
    targets_of,
)
from cityx.language.commands.short_looks import FACES
from cityx.language.commands.terminals import ADDED, share_of
from cityx.language.life_words import EVERYBODY, SERVICES
from cityx.language.measurable import things
from cityx.language.scan import Item
from cityx.traffic.kinds import DRIVING

Pairs = list[tuple[str, Value]]

_LOOKS = {
    "COLOR": ("set_color", "color"), "MATERIAL": ("set_material", "material"),
    "STYLE": ("set_style", "style"), "ROOF": ("set_roof", "roof"),
}  # fmt: skip
_FACTORS = {"DOUBLE": 2.0, "TRIPLE": 3.0, "QUADRUPLE": 4.0, "HALVE": 0.5}
_TIMES = {"twice": 2.0, "thrice": 3.0, "half as": 0.5}
# Verbs of sizes -> whether they make larger.
_GROWS = {
    "enlarge": 1, "upscale": 1, "magnify": 1, "blow": 1, "scale up": 1, "make bigger": 1,
    "shrink": -1, "downscale": -1, "scale down": -1,
}  # fmt: skip
_ROWS = {"behind": "behind", "in front of": "before"}  # else one is beside the other
_WHERE = ("in", "on", "near", "along", "around", "side", "of", "off", "path")  # keys of places
_GENDERS = {"man": "male", "woman": "female"}
_GAITS = ("run", "walk", "stand", "sit", "talk", "wait", "play")
_QUEUE = "queue"
# Where vehicles that wait stand in the lanes.
_WAITED_AT = (
    "crossing",
    "crosswalk",
    "traffic_light",
    "level_crossing",
    "gate",
    "signalled_junction",
)
_DRIVEN = (*DRIVING, *SERVICES, "vehicle")  # kinds of vehicles that go by the streets
_STANDING = ("park", "double_park", _QUEUE)  # modes of vehicles that are of no traffic
_STAYING = (
    "stand",
    "sit",
    "talk",
    "wait",
    "play",
)  # modes of people who are at a place, not on a way
_SLOW = {"vehicle": 4.0, "person": 0.8}  # metres per second
_WAYS = ("to", "from")  # relations of a place to who walks there
_FLAT = (
    "main_street", "road", "side_street", "river", "canal", "avenue", "ring_road", "sidewalk",
)  # fmt: skip
_LENGTHS = ("height", "width", "floors", "lanes", "length", "count")
KMH = 3.6  # kilometres per hour, of a metre per second
_NEW = {"type": "building.type", "element": "element", "plant": "nature"}


class Unclear(Exception):
    """A command names what to change and not by how much; or what else is open, as a question."""


def edits_of(command: Node) -> list[Edit]:
    """Return the edits of a command; several targets or changes make several.

    Raises
    ------
    Unclear
        If it does not say by how much.
    """
    return _RULES[command.name](command)


def _item(node: Node) -> Item:
    assert node.item is not None
    return node.item


def _value(item: Item) -> float:
    """Return the number of an item, its bound where it is one."""
    quantity = item.quantity
    assert quantity is not None
    return (quantity.high if quantity.low is None else quantity.low) or 0.0


def _whole(value: float) -> float | int:
    value = round(value, 4)
    return int(value) if value == int(value) else value


def _measured(name: str, item: Item) -> Iterator[tuple[str, Value]]:
    quantity = item.quantity
    assert quantity is not None
    if quantity.exact is not None:
        yield name, _whole(quantity.exact)
        return
    if quantity.low is not None:
        yield f"{name}.min", _whole(quantity.low)
    if quantity.high is not None:
        yield f"{name}.max", _whole(quantity.high)


def _each(
    command: Node, verb: str, change: Sequence[tuple[str, Value]] = (),
    refs: Sequence[Reference] = (),
) -> list[Edit]:  # fmt: skip
    """Return one edit for every target; of a street, its height is its width."""
    return [
        _of_walks(Edit(own_verb(verb, one), None if one == Selector() else one, tuple(change),
                       refs=tuple(refs)))
        for one in targets_of(command)
    ]  # fmt: skip


def _of_walks(edit: Edit) -> Edit:
    """Return a width of walks as what it is of the streets that have them."""
    target = edit.target
    if target is None or target.kind != "sidewalk" or edit.verb != "set_width":
        return edit
    change = tuple((key.replace("width", "walk"), value) for key, value in edit.change)
    word = target.inside or target.along
    street = replace(target, kind="road", inside="", along="", alone=False)
    if word:
        known = bool(things(word)) or word == IT
        named = Selector(word, alone=True) if known else Selector(ids=(word,))
        street = replace(named, but=target.but)
    return replace(edit, verb="set_walks", target=street, change=change)


def own_verb(verb: str, target: Selector) -> str:
    """Return what a change of height is of a target: of a street, its width; of a tree, of all."""
    if target.kind in _FLAT:
        return verb.replace("height", "width")
    known = things(target.kind)
    piece = bool(known) and not known.startswith("building")
    return "scale" if piece and verb == "scale_height" else verb


# -- what becomes of objects ---------------------------------------------------------------------


def _remove(command: Node) -> list[Edit]:
    return _each(command, "remove")


def _list(command: Node) -> list[Edit]:
    """Read "list the cameras", which changes nothing."""
    return _each(command, "list")


_WALKED = ("path", "sidewalk")


def _way_of(command: Node) -> list[Edit]:
    """Read "lay a gravel path through the park", "a footpath from the church to the pond"."""
    noun = command.first("ROAD")
    assert noun is not None
    if noun.noun not in _WALKED:
        raise Unclear(f"A {noun.text} cannot be added to a city that stands; a path can.")
    change: Pairs = []
    for item in [item for child in command.children for item in child.leaves()
                 if child.name in ("SURFACE", "LENGTH", "MATERIAL", "COUNT", "SIZE")]:  # fmt: skip
        if item.has("surface"):
            change.append(("surface", item.get("surface")))
        elif item.quantity is not None and item.quantity.dimension == "length":
            change.append(("width", _whole(_value(item))))
        else:
            raise Unclear(f'A path takes a surface, a width and its way; what is "{item.text}"?')
    if "gravel" in noun.words and "surface" not in dict(change):
        change.append(("surface", "gravel"))
    ends = command.own("spot")
    if len(ends) == 2:
        refs = tuple(Reference(key, (choice_of(spot),))
                     for key, spot in zip(("start", "end"), ends, strict=True))  # fmt: skip
        return [Edit("add_path", None, tuple(change), refs=refs)]
    places = places_of(command.own("place"))
    if any(place.side for place in places) or not places:
        raise Unclear("Which way does the path lead? Say through, along or between what.")
    change += [pair for place in places for pair in place.items()]
    return [Edit("add_path", None, tuple(change), refs=references_of(places))]


_FOR_WALKERS = ("footbridge", "pedestrian bridge", "foot bridge")


def _parted(place: Place) -> list[Place]:
    """Return "over the river near the park" as two places: over the river, and near the park."""
    ref = place.reference
    if ref is None or ref.key != "on" or len(ref.spots) != 1:
        return [place]
    spot = ref.spots[0]
    near = [Place("", "near", spot.near)] if spot.near else []
    return [
        Place("", "on", spot.kind),
        *near,
        *(Place("", "", "", reference=r) for r in spot.where),
    ]


def _bridge(thing: Node, noun: Item, places: Sequence[Place]) -> Edit:
    """Read "a footbridge over the river near the church"."""
    if noun.text.removesuffix("s") not in _FOR_WALKERS:
        raise Unclear("A bridge for cars cannot be added to a city that stands; a footbridge can.")
    places = [one for place in places for one in _parted(place)]
    over = next((place for place in places if place.relation == "on" and place.spot), None)
    if over is None or thing.first("COUNT") is not None or thing.first("EVERY") is not None:
        raise Unclear("What does the footbridge lead over? Say one, as in: over the river.")
    change: Pairs = [("over", over.spot)]
    for item in thing.leaves("LENGTH", "MATERIAL", "COLOR", "LIMIT"):
        if item.quantity is not None and item.quantity.attribute in ("width", ""):
            change.append(("width", _whole(_value(item))))
        elif item.get("material") != "timber":  # of which its deck is
            raise Unclear(f'A footbridge has a timber deck; "{item.text}" cannot be chosen.')
    others = [place for place in places if place is not over]
    change += [pair for place in others for pair in place.items()]
    return Edit("add_bridge", None, tuple(change), refs=references_of(others))


def _look(command: Node) -> list[Edit]:
    named = command.branch("attr")
    about = named.first("ATTR") if named is not None else None
    changes: dict[str, Pairs] = {}
    taken = [_taken_over(change, _attribute(about)) for change in command.own("change")]
    refs = [one for one in taken if one is not None]
    if refs:
        if len(refs) < len(taken):
            raise Unclear
        return [edit for one in refs for edit in _each(command, f"set_{one.key}", (), (one,))]
    said = command.own("change", "roofing")
    for change, after in zip(said, [*said[1:], None], strict=True):
        if after is not None and _colors_roof(change, after):
            color = change.first("COLOR")
            assert color is not None
            changes.setdefault("set_roof", []).append(("roof.color", color.get("color")))
            continue
        of_part = change.first("ATTR") if change.children[0].name in ("COLOR", "MATERIAL") else None
        ways = change.own("ONEWAY")  # "one-way eastbound"
        verb, pairs = _change((*ways, *change.children)[max(len(ways) - 1, 0)],
                              _attribute(of_part or about))  # fmt: skip
        changes.setdefault(verb, []).extend(pairs)
    if "replace" in changes:  # "into brick houses": the look is that of what is new
        changes = {"replace": [pair for pairs in changes.values() for pair in pairs]}
    return [
        edit
        for verb, pairs in reversed(changes.items())
        for edit in _each(command, verb, tuple(dict.fromkeys(pairs)))
    ]


def _colors_roof(change: Node, after: Node) -> bool:
    """Return whether a colour is of the roof that follows it: "a green | copper roof"."""
    color, roof = change.first("COLOR"), after.first("ROOF")
    if color is None or roof is None or {"roof", "roofs"}.isdisjoint(roof.words):
        return False
    return len(change.children) == 1 and roof.span[0] - color.span[1] <= 1


def _pairs(command: Node) -> list[Edit]:
    """Read "paint the red houses blue and the blue ones red"."""
    found = []
    for pair in command.own("pair", "tell"):
        found += _look(Node("look", None, pair.children))
    return found


def _attribute(item: Item | None) -> str:
    if item is None:
        return ""
    return item.get("attr") or item.noun  # "the roofs of all houses"


_LIKE = {"color": "color", "material": "material", "roof": "roof", "style": "style"}


def _taken_over(change: Node, about: str) -> Reference | None:
    """Read "the same colour as the church" and "one floor lower than it"."""
    spot = change.branch("spot")
    if spot is None:
        return None
    if change.own("LIKE"):
        named = change.first("ATTR") or change.first("LIKE")
        what = named.get("attr") if named is not None else about
        if what not in (*_LIKE, *_LENGTHS):
            raise Unclear
        return Reference(what, (choice_of(spot),))
    amount, than = change.branch("amount"), change.first("THAN")
    assert amount is not None
    assert than is not None
    item = next(amount.leaves())
    about, way = than.get("compared").split()
    if item.quantity is None or item.quantity.dimension not in ("length", "floors"):
        raise Unclear
    what = "floors" if item.quantity.dimension == "floors" else about
    more = _value(item) * (1 if way == "over" else -1)
    return Reference(what, (choice_of(spot),), more)


def _change(word: Node, about: str) -> tuple[str, Pairs]:
    if word.name == "factor":
        named = word.first("ATTR")
        if word.first("SIZE") is not None:  # "twice as big"
            return "scale", [("factor", _factor(word))]
        what = named.get("attr") if named is not None else about
        return f"scale_{'width' if what == 'width' else 'height'}", [("factor", _factor(word))]
    item = _item(word)
    own = _of_street(item)
    if own is not None:
        return own
    if about == "roof" and (item.text == "flat" or word.name in ("COLOR", "MATERIAL")):
        key = "roof.color" if word.name == "COLOR" else "roof"
        return "set_roof", [(key, item.get("color") or item.get("material") or "flat")]
    if word.name in _LOOKS:
        verb, key = _LOOKS[word.name]
        return verb, [(key, item.get(key) or item.get("slot").split()[0].partition("=")[2])]
    if word.name == "KIND":
        each: Pairs = [("each", "yes")] if is_plural(item) else []  # "into cafes"
        return "replace", [("building.type", item.noun), *each]
    quantity = item.quantity
    assert quantity is not None
    measure = quantity.attribute or about or MEASURES.get(quantity.dimension, "")
    if quantity.dimension in ("floors", "lanes"):
        measure = quantity.dimension
    if measure not in _LENGTHS:
        raise Unclear
    if quantity.relative:
        return f"raise_{measure}", [("by", _whole(_value(item) * quantity.relative))]
    return f"set_{measure}", list(_measured(measure, item))


def _of_street(item: Item) -> tuple[str, Pairs] | None:
    """Return what a word makes of a street: its surface, its direction, its speed, no cars."""
    if item.has("surface"):
        return "set_surface", [("surface", item.get("surface"))]
    if item.has("direction"):
        return "set_direction", [("direction", item.get("direction"))]
    if item.get("slot") == "not=vehicle":
        return "close", []
    if item.quantity is not None and item.quantity.dimension == "speed":
        return "set_speed", [("speed_kmh", _whole(_value(item) * KMH))]
    return None


def _pave(command: Node) -> list[Edit]:
    """Read "put cobbles on every street" and "cobble the street"."""
    surface = command.first("SURFACE")
    assert surface is not None
    change: Pairs = [("surface", surface.get("surface"))]
    if command.branch("targets") is None:  # of the street that was spoken of
        return [Edit("set_surface", Selector(IT, alone=True), tuple(change))]
    return _there(command, _each(command, "set_surface", change))


def _there(command: Node, edits: list[Edit]) -> list[Edit]:
    """Return changes of streets at the places that a command names last."""
    for place in places_of(command.own("place")):
        edits = [
            replace(edit, target=placed(edit.target or Selector("road"), place)) for edit in edits
        ]
    return edits


def _strip(command: Node) -> list[Edit]:
    """Read "add a cycle lane to both sides of the main street" and "no parking on x1"."""
    strip = command.first("STRIP")
    assert strip is not None
    key = "cycling" if strip.noun == "cycleway" else "parking"
    sides = "none" if command.children[0].name in ("REMOVE", "CLOSE") else "both"
    if command.branch("targets") is None:  # of the street that was spoken of
        return [Edit(f"set_{key}", Selector(IT, alone=True), ((key, sides),))]
    given = command.children[0].name == "MAKE" and command.children[-1].name == "STRIP"
    if given and not all(one.kind in (*_FLAT, IT) or one.ids for one in targets_of(command)):
        raise Unclear("Which street is to have it? Name one, as in: the main street.")
    return _each(command, f"set_{key}", [(key, sides)])


def _equip(command: Node) -> list[Edit]:
    """Read "add red awnings to the shops" and "give the houses balconies"."""
    part, color = command.first("PART"), command.first("COLOR")
    assert part is not None
    word = part.get("slot").partition("=")[2]
    if word not in ADDED:
        raise Unclear(
            f"A {word.replace('_', ' ')} cannot be added to a building that stands; "
            f"{', '.join(one.replace('_', ' ') for one in ADDED)} can."
        )
    change: Pairs = [("part", word)]
    change += [("color", color.get("color"))] if color is not None else []
    change += [("facing", item.get(FACES)) for item in command.leaves() if item.has(FACES)]
    return _each(command, "add_parts", change)


def _factor(node: Node) -> float | int:
    times, share, count = node.first("TIMES"), node.first("SHARE"), node.first("COUNT")
    if times is not None:
        return _whole(_TIMES[times.get("rel")])
    if share is not None:
        more = share.quantity.relative if share.quantity is not None else 0
        return _whole(1 + more * share_of(share) if more else share_of(share))
    if count is None:
        raise Unclear
    return _whole(_value(count))


def _resize(command: Node) -> list[Edit]:
    verb = command.children[0].name
    named = command.branch("attr")
    about = next(named.leaves("ATTR")).get("attr") if named is not None else "height"
    if about == "speed":
        return _limited(command, verb)
    about = "width" if verb in ("WIDEN", "NARROW") else about
    about = about if about in _LENGTHS else "height"
    flat = next((one.kind for one in targets_of(command) if one.kind in _FLAT), "")
    if flat and named is None and verb in ("RAISE", "LOWER") and not _tells_lanes(command):
        said = flat.replace("_", " ")
        raise Unclear(f"The level of a {said} cannot be changed; its width can.")
    if verb in _FACTORS and (named is None or about == "count"):
        return [edit for one in targets_of(command) for edit in _multiplied(verb, one, about)]
    if verb in _FACTORS:
        return _each(command, f"scale_{about}", [("factor", _whole(_FACTORS[verb]))])
    amount = command.branch("amount")
    if amount is None:
        raise Unclear
    way = command.branch("way")
    by = way is not None and way.first("TO") is None
    return _resized(command, amount, about, grows=verb in ("RAISE", "WIDEN"), by=by)


_MANY = ("piece", "lamp", "vehicle", "pedestrian")  # families of things that there are many of


def _multiplied(verb: str, one: Selector, about: str) -> list[Edit]:
    """Read "halve the trees" as half of them gone; of twice as many it is open where they stand."""
    many = family_of(things(one.kind).partition(",")[0]) in _MANY and not one.alone
    if not many:
        verb_of = own_verb(f"scale_{about}", one)
        return [Edit(verb_of, one, (("factor", _whole(_FACTORS[verb])),))]
    if verb == "HALVE":
        return [Edit("remove", replace(one, share=0.5 * (one.share or 1.0)))]
    raise Unclear(
        "Are they to become larger, or are more of them to be added? Say how many, and where."
    )


def _tells_lanes(command: Node) -> bool:
    """Return whether an amount is of lanes or a speed, of which streets have some."""
    amount = command.branch("amount")
    return amount is not None and any(
        item.quantity is not None and item.quantity.dimension in ("lanes", "speed", "count")
        for item in amount.leaves()
    )


def _limited(command: Node, verb: str) -> list[Edit]:
    """Read "lower the speed limit to 30 km/h"."""
    amount, way = command.branch("amount"), command.branch("way")
    word = next(amount.leaves(), None) if amount is not None else None
    quantity = word.quantity if word is not None else None
    to = way is not None and way.first("TO") is not None
    if word is None or quantity is None or not to or verb not in ("RAISE", "LOWER"):
        raise Unclear
    if quantity.dimension != "speed":
        raise Unclear
    change = [("speed_kmh", _whole(_value(word) * KMH))]
    if command.branch("targets") is None:
        return _there(command, [Edit("set_speed", Selector("road"), tuple(change))])
    return _each(command, "set_speed", change)


def _resized(command: Node, amount: Node, about: str, *, grows: bool, by: bool) -> list[Edit]:
    """Read "by 10 m", "to three floors", "by half" and "by a factor of 2"."""
    inner = amount.branch("factor")
    if inner is not None and inner.first("SHARE") is None:
        factor = _factor(inner)
        return _each(
            command, f"scale_{about}", [("factor", factor if grows else _whole(1 / factor))]
        )
    item = next(amount.leaves())
    dimension = item.quantity.dimension if item.quantity is not None else "share"
    if dimension in ("share", "part"):
        part = share_of(item) if by else share_of(item) - 1
        factor = 1 + (part if grows or not by else -part)
        return _each(command, f"scale_{about}", [("factor", _whole(factor))])
    if dimension == "speed" and not by:
        return _each(command, "set_speed", [("speed_kmh", _whole(_value(item) * KMH))])
    if dimension not in ("floors", "lanes", "length", "count"):
        raise Unclear
    about = dimension if dimension in ("floors", "lanes") else about
    if by:
        return _each(
            command, f"raise_{about}", [("by", _whole(_value(item) * (1 if grows else -1)))]
        )
    return _each(command, f"set_{about}", list(_measured(about, item)))


def _shift(command: Node) -> list[Edit]:
    """Read "add two floors to b15" and "shave 5 m off it"."""
    amount = command.branch("amount")
    assert amount is not None
    word = next(amount.leaves())
    if word.quantity is not None and word.quantity.dimension == "speed":  # "20 mph on x1"
        return _each(command, "set_speed", [("speed_kmh", _whole(_value(word) * KMH))])
    grows = command.children[0].name in ("ADD", "RAISE")
    return _resized(command, amount, "height", grows=grows, by=True)


def _replace(command: Node) -> list[Edit]:
    new = command.branch("new") or command.branch("made")
    assert new is not None
    noun = new.first("KIND", "THING", "AGENT", "PLANT", "BUILDING")
    assert noun is not None
    told = [int(_value(one)) for one in new.leaves("COUNT")]
    if told and any(told[0] not in (1, one.k) for one in targets_of(command)):
        raise Unclear(f"One thing gives way to one other; where do the {told[0]} stand?")
    key = _NEW.get(noun.noun_class)
    change: Pairs = [(key, kind_of(noun))] if key else []
    change += [("species", species)] if (species := species_of(noun)) else []
    if key == "building.type" and is_plural(noun):
        change.append(("each", "yes"))  # "into cafes" is one for each
    return _each(command, "replace", change + _traits(new))


def _traits(new: Node) -> Pairs:
    """Return material, colour, style, roof, floors and height of something new."""
    found: Pairs = []
    looks = list(new.leaves("MATERIAL", "COLOR", "STYLE", "ROOF", "ATTR"))
    for at, item in enumerate(looks):
        after = looks[at + 1] if at + 1 < len(looks) else None
        if after is not None and item.has("color") and _is_of_roof(item, after):
            found.append(("roof.color", item.get("color")))
            continue
        if item.noun == "roof" and not item.has("slot"):
            continue
        kind = next((name for name in ("material", "color") if item.has(name)), "")
        key, _, value = item.get("slot").partition(" ")[0].partition("=")
        found.append((kind, item.get(kind)) if kind else (key, value))
    for item in new.leaves("FLOORS", "LENGTH", "LIMIT"):
        floors = item.quantity is not None and item.quantity.dimension == "floors"
        wide = item.quantity is not None and item.quantity.attribute == "width"
        measure = "floors" if floors else "width" if wide else "height"
        found += _measured(f"building.{measure}", item)
    return found


def _is_of_roof(color: Item, roof: Item) -> bool:
    """Return whether a colour is of the roof behind it: "with orange | tiled roofs"."""
    said = "roof=" in roof.get("slot") or roof.noun == "roof"
    said = said and not {"roof", "roofs"}.isdisjoint(roof.words)
    return said and 0 <= roof.span[0] - color.span[1] <= 1


def _move(command: Node) -> list[Edit]:
    way = _way(command)
    far = [pair for pair in way if pair[0] == "by"]
    towards = [pair for pair in way if pair[0] == "direction"]
    if len(far) > 1 and len(far) == len(towards) and len(way) == 2 * len(far):
        # "10 m north and 5 m east" is one after the other
        steps = zip(far, towards, strict=True)
        return [edit for step in steps for edit in _each(command, "move", step)]
    return _each(command, "move", way, _where_to(command))


def _where_to(command: Node) -> tuple[Reference, ...]:
    return references_of(places_of(command.own("place", "destination")))


def _way(command: Node) -> Pairs:
    """Read how far and where to something is moved."""
    change: Pairs = [("by", _whole(_value(_item(word)))) for word in command.own("LENGTH")]
    for word in command.own("direction"):
        change.append(("direction", next(word.leaves()).get("side")))
    for place in places_of(command.own("place")):
        change += [("direction", place.side)] if place.side and not place.spot else place.items()
    for place in places_of(command.own("destination")):  # into a park, but up to a church
        if place.reference is not None:
            continue
        within = family_of(place.spot.rpartition(" ")[2]) == "land" and not place.named
        change.append(("in" if within else "near", place.spot))
    return change


def _rotate(command: Node) -> list[Edit]:
    angle = math.radians(_value(_item(command.own("ANGLE", "COUNT")[0])))
    turn = command.first("CLOCKWISE")
    back = turn is not None and turn.get("rel") == "clockwise"
    return _each(command, "rotate", [("angle", round(-angle if back else angle, 4))])


def _scale(command: Node) -> list[Edit]:
    words = command.own("factor", "COUNT", "SHARE")
    holder = words[0] if words[0].name == "factor" else Node("factor", None, tuple(words))
    factor = float(_factor(holder))
    said = _item(command.children[0]).text
    way = _GROWS.get(said.split()[0], _GROWS.get(said, 0))
    share = holder.first("SHARE")
    if way and share is not None and share.quantity is not None and not share.quantity.relative:
        to = any(link.first("TO") is not None for link in command.own("link"))
        factor = factor if to else 1 + way * factor  # "enlarge it by 50 %"
    elif way < 0 and factor > 1:
        factor = 1 / factor  # "shrink it by a factor of 2"
    named = holder.first("ATTR")
    about = named.get("attr") if named is not None else ""
    verb = f"scale_{about}" if about in _LENGTHS else "scale"  # "shrink it to half its height"
    return _each(command, verb, [("factor", _whole(factor))])


def _close(command: Node) -> list[Edit]:
    """Read "close the street to cars between the church and the park"."""
    return _there(command, _each(command, command.children[0].name.lower()))


def _lights(command: Node) -> list[Edit]:
    """Read "turn off the lamps"; those of one place alone are told by what is meant."""
    state = "off" if command.children[0].name == "TURN_OFF" else "on"
    return [
        Edit("set_lights", None if one == Selector(one.kind, alone=one.alone) else one,
             (("lights", state),))
        for one in targets_of(command)
    ]  # fmt: skip


def _copy(command: Node) -> list[Edit]:
    """Read "copy b03 to the west of b05"; what is copied counts for "beside it"."""
    verb = command.children[0].item
    count = int(verb.get("copies") or 1) if verb is not None else 1
    change: Pairs = [("count", count)] if count > 1 else []
    own = [*change, *(pair for pair in _way(command) if pair[1] != IT)]
    return _each(command, "copy", own, _where_to(command))


def _lined(command: Node) -> list[Edit]:
    """Read "line the main street with bollards"."""
    places = [place for one in targets_of(command) for place in _along(one)]
    things_ = command.branch("things")
    if things_ is None:
        return _plant(command, places)
    return [_added(thing, places) for thing in things_.own("thing")]


def _along(one: Selector) -> list[Place]:
    """Return the place along a street; of streets that more tells than a kind, that holds too."""
    plain = Selector(one.kind, ids=one.ids, alone=one.alone)
    if one == plain or one.kind == IT:
        return [Place("", "along", name) for name in one.ids or (one.kind,)]
    return [Place("", "", "", reference=Reference("along", (one,)))]


def _swap(command: Node) -> list[Edit]:
    """Read "swap concrete for glass on the five tallest" as giving those a look of glass."""
    old, new = list(command.leaves("MATERIAL", "COLOR", "STYLE", "SURFACE"))[:2]
    key = next((name for name in ("surface", "material", "color") if new.has(name)), "style")
    value = new.get(key) if key != "style" else new.get("slot").split()[0].partition("=")[2]
    verb = f"set_{key}"
    if command.branch("targets") is not None:
        return _each(command, verb, [(key, value)])
    kind, own = ("road", "surface") if key == "surface" else ("building", key)
    was = old.get(own) if own != "style" else old.get("slot").split()[0].partition("=")[2]
    return [Edit(verb, Selector(kind, filters=(f"{own}={was}",)), ((key, value),))]


# -- what is new ---------------------------------------------------------------------------------


def _add(command: Node) -> list[Edit]:
    places = places_of(_places(command))
    late = command.own("SPEED", "MODE", "EVERY", "AXIS", "GATES", "ACROSS", "LENGTH", "MATERIAL")
    things = command.branch("things")
    assert things is not None
    for place in _places(command):
        if place.first("IT") is not None and any(w.text in _EACH for w in place.leaves("ALL")):
            raise Unclear("Where does each stand? Name the place of each by itself.")
    named = things.own("thing")
    walked = any(_noun_class(thing) == "person" for thing in named)
    added = [
        _added(
            replace(thing, children=(*thing.children, *late)),
            _driven(places) if walked and _noun_class(thing) == "vehicle" else places,
        )
        for thing in named
    ]
    faced = tuple(Reference("facing", (choice_of(node.own("spot")[0]),))
                  for node in command.own("faced"))  # fmt: skip
    added = [replace(edit, refs=(*edit.refs, *faced)) for edit in added]
    for more in command.own("more"):  # "a bench by the church and a lamp opposite it"
        added += _add(more)
    return _again(added, command)


def _noun_class(thing: Node) -> str:
    noun = thing.first("AGENT", "THING", "KIND", "BUILDING")
    return noun.noun_class if noun is not None else ""


def _driven(places: Sequence[Place]) -> list[Place]:
    """Return places without those of people: "80 cars, and people | on the pavements"."""
    return [place for place in places if place.spot not in _WALKED]


def _again(added: list[Edit], command: Node) -> list[Edit]:
    """Read "and another behind it", a row of the same, and "and another near b02", one more."""
    again = command.branch("again")
    if again is None:
        return added
    last, said = added[-1], again.first("COUNT")
    more = int(_value(said)) if said is not None else 1
    places = places_of([*again.own("place"), *again.own("destination")])
    if any(place.spot != IT and not _is_it(place) for place in places):
        kept = [pair for pair in last.change if pair[0] not in _WHERE and pair[0] != "count"]
        own = [pair for place in places for pair in place.items()]
        count = [("count", more)] if more > 1 else []
        refs = [_of_the_same(ref, last) for ref in references_of(places)]
        return [*added, replace(last, change=(*kept, *count, *own), refs=tuple(refs))]
    if last.verb != "add":
        raise Unclear('Where is "it"? Name the place of each.')
    change = dict(last.change)
    where = again.first("REL")
    row = _ROWS.get(where.text, "beside") if where is not None else "beside"
    change |= {"count": int(change.get("count", 1)) + more, "row": row}
    return [*added[:-1], replace(last, change=tuple(change.items()))]


def _of_the_same(ref: Reference, last: Edit) -> Reference:
    """Return "the eastern end" as that of what the western end before it was of."""
    before = [one for one in last.refs if one.key in ("end", "corner", "edge", "middle")]
    if before and [spot.kind for spot in ref.spots] == [HERE]:
        return replace(ref, spots=before[0].spots)
    return ref


def _is_it(place: Place) -> bool:
    """Return whether a place is told by what was named before it: "in front of it"."""
    return place.reference is not None and all(spot.kind == IT for spot in place.reference.spots)


def _places(command: Node) -> list[Node]:
    inner = [child for child in command.children if child.name not in ("again", "more")]
    held = Node(command.name, None, tuple(inner))
    return [*held.find("place"), *held.find("destination"), *held.find("source")]


SEVERAL = 4  # things that "benches by the church" are
AMOUNTS = {"few": 3, "some": SEVERAL, "many": 10}  # things at a place
FULL = 20  # people or vehicles that fill a place where no number is told


def _fill(command: Node) -> list[Edit]:
    """Read "fill the plaza with 50 people"."""
    places = [Place("", "", name) for one in targets_of(command) for name in one.ids or (one.kind,)]
    things = command.branch("things")
    assert things is not None
    added = [_added(thing, places) for thing in things.own("thing")]
    return [
        replace(edit, change=(*edit.change, ("count", FULL)))
        if edit.verb == "add_agent" and "count" not in dict(edit.change) else edit
        for edit in added
    ]  # fmt: skip


def _in_a_row(places: Sequence[Place]) -> bool:
    """Return whether things stand in a row along something, as many as fit."""
    return any(place.relation == "along" for place in places)


def _added(thing: Node, places: Sequence[Place]) -> Edit:
    noun = thing.first("AGENT", "THING", "KIND", "BUILDING")
    assert noun is not None
    if noun.noun_class in ("vehicle", "person"):
        return _agent(thing, noun, places)
    if noun.noun == "bridge":
        return _bridge(thing, noun, places)
    change: Pairs = [(key, noun.noun)] if (key := _NEW.get(noun.noun_class)) else []
    size = thing.first("SIZE")
    change += [("size", size.get("size"))] if size is not None else []
    count = thing.first("COUNT")
    if count is not None and count.span > noun.span:
        raise Unclear(f"What of it are there {_whole(_value(count))}? Ask for that by itself.")
    change += [("count", _whole(_value(count)))] if count is not None else []
    told = _amount(thing) if count is None and noun.noun_class == "element" else []
    if told and is_plural(noun) and not _in_a_row(places):
        told = [("count", AMOUNTS[str(told[0][1])])] if told[0][1] in AMOUNTS else told
    change += told
    change += _traits(thing)
    change += _form_of(thing, noun)
    every = thing.first("EVERY")
    change += [("spacing", _whole(_value(every)))] if every is not None else []
    if is_plural(noun) and not {"count", "amount", "spacing"} & {key for key, _ in change}:
        lined = _in_a_row(places) or not places
        change += [("count", SEVERAL)] if noun.noun_class == "element" and not lined else []
    elif _is_one_along(noun, change, places):
        change.append(("count", 1))
    change += [pair for place in places for pair in place.items()]
    if noun.noun_class == "element" and any(_is_several(place) for place in places):
        if count is None and not any(_is_end(place) for place in places):
            change = [pair for pair in change if pair != ("count", SEVERAL)]
        change += [("each", "yes")]
    verb = "add" if noun.noun_class == "element" else "add_building"
    return Edit(verb, None, tuple(change), refs=references_of(places))


_LONG = ("hedge", "fence", "wall", "city_wall")  # which run along something


def _is_one_along(noun: Item, change: Pairs, places: Sequence[Place]) -> bool:
    """Return whether one thing stands along something: "a street lamp along the quay"."""
    along = any(place.relation == "along" or (place.reference and place.reference.key == "along")
                for place in places)  # fmt: skip
    counted = {"count", "amount", "spacing"} & {key for key, _ in change}
    return noun.noun_class == "element" and along and not counted and noun.noun not in _LONG


def _is_several(place: Place) -> bool:
    """Return whether a place is at each of several: "outside five shops", "by every park"."""
    ref = place.reference
    if ref is None or not ref.spots:
        return place.each and place.relation in ("near", "on", "in")
    if ref.key in ("corner", "end", "entrance", "on", "in", "near"):
        return place.each
    return ref.key in ("before", "behind") and not ref.spots[0].alone


def _is_end(place: Place) -> bool:
    return place.reference is not None and place.reference.key == "end"


_EACH = ("each", "every", "each of", "all of")
_ROUND = ("pond", "lake")  # whose size is told from one bank to the other


def _form_of(thing: Node, noun: Item) -> Pairs:
    """Return how wide a pond is, as its area, and how many entrances a fence has."""
    across, gates = thing.first("ACROSS"), thing.first("GATES")
    found: Pairs = [("gates", _whole(_value(gates)))] if gates is not None else []
    if across is None:
        return found
    if noun.noun not in _ROUND:
        said = noun.noun.replace("_", " ")
        raise Unclear(f"How wide a {said} is cannot be told; its place and number can.")
    return [*found, ("area", round(math.pi / 4 * _value(across) ** 2))]


def _agent(thing: Node, noun: Item, places: Sequence[Place]) -> Edit:
    change: Pairs = []
    traffic = noun.text == "traffic"
    if not traffic:
        car = noun.noun == "vehicle" and "car" in noun.text
        change.append(("agent", "car" if car else kind_of(noun)))
        if noun.noun in _GENDERS:
            change.append(("gender", _GENDERS[noun.noun]))
        if noun.noun in PEOPLE and noun.noun not in _GENDERS:
            change.append(("who", noun.noun))
        modes = dict.fromkeys(item.get("mode") for item in thing.leaves() if item.has("mode"))
        own = _GAITS if noun.noun_class == "person" else _STANDING
        waits = "wait" in modes and any(place.spot in _WAITED_AT for place in places)
        if noun.noun_class == "vehicle" and (
            waits or any("queu" in one.text for one in thing.leaves())
        ):
            modes = {_QUEUE: None}  # people who queue are said to wait
        if noun.noun_class == "person" and not modes.keys().isdisjoint(_STANDING):
            raise Unclear("People do not park; say which vehicles do.")
        change += [("mode", mode) for mode in modes if mode in own]
        count = _count(thing, noun)
        change += [("count", count)] if count else []
    change += _amount(thing)
    speed = thing.first("SPEED")
    change += [("speed", round(_value(speed), 4))] if speed is not None else []
    if speed is None and thing.first("PACE") is not None:
        change.append(("speed", _SLOW[noun.noun_class]))
    worn = thing.first("WEARS")
    change += [("wears", worn.get("wears"))] if worn is not None else []
    if noun.noun == "parked_vehicle":
        change[0] = ("agent", "car")
        change.append(("mode", _STANDING[0]))
    axis = thing.first("AXIS")
    change += [("direction", axis.get("axis"))] if axis is not None else []
    goes = noun.noun_class == "vehicle" and _goes(thing, places, change)
    sets_out = any(place.relation == "from" for place in places)
    if noun.noun_class == "vehicle" and sets_out and not goes:
        raise Unclear(_standing(noun, change))
    # "around the park on loop1": the way that has a name leads around the park.
    for place in [place for place in places if place.named] or places:
        if (
            noun.noun_class == "person"
            and place.spot in _WALKED
            and place.relation in ("on", "along")
        ):
            continue  # where people walk anyway
        if front := _front(place):
            place = Place("", "near", front, each=place.each)
        if place.reference is not None:
            leads = place.reference.key in ("in", "on", "near", "along", "around", "to")
            change += [("path", name) for name in _names_in(place.reference) if leads]
            continue
        key = "near" if place.relation == "near" else "path"
        if (noun.noun_class == "person" or goes) and place.relation in _WAYS and place.spot:
            key = place.relation
            if not goes and key == "to" and "mode" not in dict(change) and len(places) == 1:
                key = "at"  # "add ten people to the park"
        elif _stays(noun, place, change):
            key = "at"
            change += _of_stay(noun, change)
            on_seats = noun.noun_class == "person" and place.spot == "bench"
            if on_seats and place.relation == "on" and "mode" not in dict(change):
                change.append(("mode", "sit"))
            change += [("each", "yes")] if place.each else []
        change.append((key, place.spot) if place.spot else ("side", place.side))
    verb = "add_traffic" if traffic else "add_agent"
    named = any(key in ("path", "at") for key, _ in change)
    stands = noun.noun_class == "vehicle" and not any(item.has("mode") for item in thing.leaves())
    if stands and not named and references_of(places):
        change.append(("mode", _STANDING[0]))
    return Edit(verb, None, tuple(change), refs=() if named else references_of(places))


def _goes(thing: Node, places: Sequence[Place], change: Pairs) -> bool:
    """Return whether vehicles are on their way: "a bus | from the church to the park"."""
    told = dict(change)
    if told.get("agent") not in _DRIVEN or told.get("mode") in _STANDING:
        return False
    modes = {item.get("mode") for item in thing.leaves() if item.has("mode")}
    return bool(modes) or any(place.relation == "from" for place in places)


def _standing(noun: Item, change: Pairs) -> str:
    """Return the question about who stands, or keeps to rails or water, and is told a way."""
    told = dict(change)
    if told.get("mode") in _STANDING:
        mode = str(told["mode"]).replace("_", " ")
        return f"Do the vehicles stand or go? Those that {mode} are at a place or street."
    if "agent" not in told:
        return "How many vehicles go there? Traffic is along streets: say which."
    stands = "are" if is_plural(noun) else "is"
    return (
        f"Where {stands} the {noun.text}? Only vehicles of the street go from one place to another."
    )


def _front(place: Place) -> str:
    """Return what somebody is in front of, "" for nothing, or what takes more to tell."""
    reference = place.reference
    if reference is None or reference.key != "before" or len(reference.spots) != 1:
        return ""
    spot = reference.spots[0]
    return spot.kind if spot == Selector(kind=spot.kind, alone=spot.alone) else ""


def _names_in(reference: Reference) -> list[str]:
    """Return the names of ways that a place holds: "round the park on loop1"."""
    found: list[str] = []
    for spot in reference.spots:
        found += spot.ids
        found += [name for inner in spot.where for name in _names_in(inner)]
    return found


def _stays(noun: Item, place: Place, change: Pairs) -> bool:
    """Return whether who or what is added is at a place: "ten people | on the square"."""
    mode = dict(change).get("mode", "")
    if not place.spot or (place.named and mode not in (*_STAYING, *_STANDING)):
        return False
    on_a_way = place.relation in ("along", "around", "") or place.spot in (*_FLAT, "bridge")
    kinds = _STANDING if noun.noun_class == "vehicle" else _STAYING
    return mode in kinds or (mode == "" and not on_a_way)


def _of_stay(noun: Item, change: Pairs) -> Pairs:
    """Return what else is said of who or what stays: vehicles park, men are all men."""
    told = dict(change)
    if noun.noun_class == "vehicle":
        return [] if "mode" in told else [("mode", _STANDING[0])]
    return [("who", noun.noun)] if noun.noun in _GENDERS and "who" not in told else []


def _count(thing: Node, noun: Item) -> int:
    """Return how many are asked for: a singular noun is one, a bare plural no number."""
    said = thing.first("COUNT")
    if said is not None:
        return int(_value(said))
    many = is_plural(noun) or noun.text in EVERYBODY or thing.first("AMOUNT") is not None
    return 0 if many else 1


def _amount(thing: Node) -> Pairs:
    words = ["some" if item.get("rel") == "more" else item.get("amount")
             for item in thing.leaves("AMOUNT")]  # fmt: skip
    return [("amount", word) for word in words if word]


def _plant(command: Node, places: Sequence[Place] = ()) -> list[Edit]:
    places = places or places_of(_places(command))
    plants, planted = command.branch("plants"), []
    while plants is not None:  # "oaks | and five limes"
        joined = plants.branch("plants")
        own = replace(plants, children=tuple(one for one in plants.children if one is not joined))
        planted.append(_planted(own, command, places))
        plants = joined
    return _again(planted, command)


def _planted(plants: Node, command: Node, places: Sequence[Place]) -> Edit:
    """Return the edit for trees of one kind at the places of a command."""
    change: Pairs = [("nature", "tree")]
    plant = plants.first("PLANT")
    assert plant is not None
    change += [("species", species)] if (species := species_of(plant)) else []
    count, every = plants.first("COUNT"), command.first("EVERY")
    change += [("count", int(_value(count)))] if count is not None else []
    change += _amount(plants) if every is None and count is None else []  # "some, one every 8 m"
    change += [("spacing", _whole(_value(every)))] if every is not None else []
    for place in places:
        change += place.items()
    return Edit("plant", None, tuple(change), refs=references_of(places))


_RULES: Mapping[str, Callable[[Node], list[Edit]]] = {
    "remove": _remove, "look": _look, "pairs": _pairs, "resize": _resize, "shift": _shift,
    "replace": _replace, "add": _add, "plant": _plant, "move": _move,
    "rotate": _rotate, "scale": _scale, "close": _close, "lights": _lights,
    "pave": _pave, "strip": _strip, "equip": _equip,
    "copy": _copy, "fill": _fill, "lined": _lined, "swap": _swap,
    "list": _list, "laid": _way_of,
}  # fmt: skip
