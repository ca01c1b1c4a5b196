"""Selection: the objects and the places that a command names."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from typing import Any

from cityx.assets.outside_words import outside_trees
from cityx.language.brief import Reference, Selector, Value
from cityx.language.commands.grammar import Node
from cityx.language.commands.terminals import share_of
from cityx.language.lexicon.phrases import NOUNS, SPECIES
from cityx.language.scan import Item

_NUMBERED = re.compile(r"(\D+)(\d+)")
# What a bare number with a unit measures of an object.
MEASURES = {"length": "height", "floors": "floors", "speed": "speed", "area": "area"}
_THROUGH = ("path", "center", "sidewalk", "green")  # "the path around the park": the park
_WATERS = ("river", "canal", "lake", "sea", "beach", "harbour")
_ROADS = ("main_street", "road", "side_street", "avenue", "ring_road")
_MOST_IDS = 500  # in one range
_MANY = (
    "ALL",
    "COUNT",
    "SHARE",
    "RANK",
    "NEAREST",
    "ORDINAL",
    "REST",
)  # what says how many are meant
_SPOTS = (
    "BUILDING", "KIND", "THING", "ROAD", "PLANT", "WHOLE", "QUARTER", "ID", "IT", "NEIGHBORS",
    "ONES",
)  # fmt: skip
_SINGULAR = ("it", "this", "that", "one")
ONES, REST, NEIGHBORS = "ones", "rest", "neighbors"
HERE = "here"  # kind of what a corner or an end is of that says nothing of it
_LOOKS = ("COLOR", "MATERIAL", "ROOF", "STYLE")
# First words of a relation that is more than "near" -> what it is.
_HOW = {"behind": "behind", "opposite": "opposite", "facing": "opposite"}
_BEFORE = ("in front", "in front of")
_OF_SITE = "at the edge of"
ABOUT = 1.5  # times the metres told to something, within which it is looked for
IT = "it"  # kind of what was named last


@dataclass(frozen=True)
class Place:
    """Where something is: on a side (of something), or near, along, in, on an object.

    Attributes
    ----------
    side, relation, spot
        Words for them, "" for none.
    named
        Whether the object is told by a name or an id rather than by its kind.
    off
        Metres from the object, on the side; None where none are told.
    each
        Whether every such object is meant by itself: "at every bus stop".
    reference
        The place, where more than a relation and the name of a kind tells it.
    """

    side: str
    relation: str
    spot: str
    named: bool = False
    off: float | None = None
    each: bool = False
    reference: Reference | None = None

    def items(self) -> Iterator[tuple[str, Value]]:
        """Yield the place as keys and values, none where other objects tell it."""
        if self.reference is not None:
            return
        if self.side:
            yield "side", self.side
            if self.spot and self.spot != "city":
                yield "of", self.spot
            if self.off is not None:
                yield "off", self.off
        else:
            own = self.relation in ("along", "in", "on", "around")
            to = "in" if self.relation == "to" else "near"
            yield (self.relation if own else to), self.spot


_EACH = ("each", "every", "each of the", "every one of")
PEOPLE = (
    "man",
    "woman",
    "child",
    "elder",
    "wheelchair",
    "pram",
    "runner",
    "steward",
    "officer",
)  # kinds of people


def kind_of(noun: Item) -> str:
    """Return the kind of object that a noun names."""
    if noun.noun in PEOPLE:
        return "pedestrian"
    if noun.noun in ("roof", "window", "facade"):  # on which parts are put
        return "building"
    return {"plant": "tree"}.get(noun.noun_class, noun.noun)


_GREENERY = frozenset((
    "tree", "street tree", "shade tree", "planting", "plant", "vegetation", "foliage", "greenery",
))  # fmt: skip


def species_of(noun: Item) -> str:
    """Return the kind of tree that a noun names, "" for trees of any kind.

    A kind that no city has is told by its own word, so that nobody takes it for any tree.
    """
    if noun.noun_class != "plant":
        return ""
    known = {**SPECIES, **{name: tree.words for name, tree in outside_trees().items()}}
    text = noun.text
    said = {text, text.removesuffix("s"), text.removesuffix("es"), f"{text.removesuffix('s')} tree",
            text.replace("ies", "y")}  # fmt: skip
    if said & _GREENERY:
        return ""
    found = next((name for name, words in known.items() if not said.isdisjoint(words)), "")
    return found or min(said, key=len).removesuffix(" tree")


def is_plural(noun: Item) -> bool:
    """Return whether a noun stands for several."""
    words = [word for word in noun.words if not word.endswith("ed")]  # "cars parked"
    last = (words or noun.words)[-1]
    return (last.endswith("s") and last not in ("bus", "grass")) or last in (
        "people", "men", "women", "children",
    )  # fmt: skip


def targets_of(command: Node) -> list[Selector]:
    """Return what a command is about; ids in a row make one selection."""
    targets = next(command.find("targets"))
    found = _at_one_place(_selectors(targets))
    nodes = [*targets.own("exception"), *command.own("exception")]
    but = [like(one, found[-1]) for node in nodes for one in _selectors(node)]
    return [replace(one, but=(*one.but, *but)) for one in found]


_OF_PLACE = ("near", "reach", "inside", "along", "side", "of", "where")


def _at_one_place(found: list[Selector]) -> list[Selector]:
    """Return "the bins and benches | in the park" as those of both kinds that are there.

    What there is one of is told by itself: "the church and the trees in the park". Of several
    places each is told of what stands before it.
    """
    place: dict[str, Any] = {}
    placed: list[Selector] = []
    for one in reversed(found):
        own = {name: value for name in _OF_PLACE if (value := getattr(one, name))}
        plain = one.kind and one == Selector(
            one.kind, share=one.share, k=one.k, filters=one.filters
        )
        placed.append(replace(one, **place) if plain else one)
        place = (own if one.kind else {}) if own else place
    return placed[::-1]


def _selectors(node: Node) -> list[Selector]:
    found: list[Selector] = []
    for target in node.own("target"):
        one = _selector(target)
        if found and (street := _along_another(found[-1], one)) is not None:
            found.append(street)
        elif found and found[-1].ids and one.ids:
            found[-1] = replace(found[-1], ids=found[-1].ids + one.ids)
        else:
            found.append(one)
    return found


def _along_another(before: Selector, one: Selector) -> Selector | None:
    """Return "the houses along Hay Road and | Wool Lane" as those along it; None for others."""
    street = one.ids[0] if len(one.ids) == 1 and one == Selector(ids=one.ids) else ""
    if not (before.kind and " " in street):
        return None
    if " " in before.along:
        return replace(before, along=street)
    return replace(before, inside=street) if " " in before.inside else None


def like(one: Selector, other: Selector) -> Selector:
    """Return a choice of "those along the river" as a choice of what was named before."""
    if one.kind != ONES:
        return one
    told = {_about(text) for text in one.filters}
    kept = (*(text for text in other.filters if _about(text) not in told), *one.filters)
    return replace(one, kind=other.kind or "building", filters=tuple(dict.fromkeys(kept)))


def places_of(nodes: Iterable[Node]) -> list[Place]:
    """Return the places of some nodes."""
    return [_place(node) for node in nodes]


def _about(condition: str) -> str:
    return condition.partition("=")[0].removesuffix("!").partition(">")[0].partition("<")[0]


def _selector(target: Node) -> Selector:
    selector = Selector()
    for child in target.children:
        if child.name == "mod":
            selector = _modified(selector, child.children[0])
            if child.own("NOT"):
                selector = _looking(selector, child)
        elif child.name == "filter":
            selector = _filtered(selector, child)
        elif child.name == "NEAREST" and child.item is not None:
            selector = replace(selector, rank=child.item.get("rank"))
        elif child.name == "reference":  # "the nearest bench to the church"
            selector = replace(selector, near=_spot(next(child.find("spot"))))
        elif child.name == "ID" and child.item is not None:
            selector = replace(selector, ids=_ids((*selector.ids, child.item.text)))
        elif child.name in ("TO", *_SPOTS) and target.own("ID"):
            continue  # "buildings b01 to b05"
        elif child.name == "IT":
            selector = replace(selector, kind=IT)
        elif child.name in ("ONES", "REST", "NEIGHBORS"):
            one = child.item is not None and child.item.text == "one"
            selector = replace(selector, kind=child.name.lower(), alone=one and not selector.rank)
        elif child.name == "BUILDING" and child.item is None:  # "the tallest"
            selector = replace(selector, kind="building", k=selector.k or (not selector.nth))
        elif child.name == "QUARTER" and child.item is not None:
            selector = replace(selector, kind="building", inside=_quarter(child.item))
        elif child.item is not None:
            selector = _of_kind(selector, child.item)
            many = bool(target.own("NEAREST"))
            many |= any(mod.own(*_MANY) for mod in target.own("mod"))
            selector = replace(selector, alone=_is_one(child.item) and not many)
    return selector


def _quarter(item: Item) -> str:
    """Return the kind of quarter that "the old town" names."""
    return item.get("slot").split()[0].partition("=")[2]


def _is_one(noun: Item) -> bool:
    """Return whether a noun stands for a single object: no plural, no mass, no place."""
    mass = noun.text in ("traffic", "vegetation", "foliage", "planting", "greenery")
    return not (is_plural(noun) or mass or noun.noun in ("city", "everything", "landscape"))


def _ids(named: tuple[str, ...]) -> tuple[str, ...]:
    """Return the ids of "b01 to b05", or those named."""
    begin, end = _NUMBERED.fullmatch(named[0]), _NUMBERED.fullmatch(named[-1])
    if begin is None or end is None or begin[1] != end[1]:
        return named
    numbers = range(int(begin[2]), min(int(end[2]), int(begin[2]) + _MOST_IDS) + 1)
    return tuple(f"{begin[1]}{number:0{len(begin[2])}d}" for number in numbers)


def _of_kind(selector: Selector, noun: Item) -> Selector:
    """Add the kind; "the tallest tower" is one, the city as a whole is no object."""
    selector = replace(selector, kind="" if noun.noun == "city" else kind_of(noun))
    if species := species_of(noun):
        selector = replace(selector, filters=(*selector.filters, f"species={species}"))
    if noun.noun_class == "plant" and "street" in noun.words and not selector.along:
        selector = replace(selector, along="road")  # "street trees"
    if selector.rank and not selector.k and not selector.nth and not is_plural(noun):
        selector = replace(selector, k=1)
    return selector


def _modified(selector: Selector, word: Node) -> Selector:
    item = word.item
    assert item is not None
    if word.name == "NOT":
        return selector
    if word.name == "CORNER":
        return replace(selector, where=(*selector.where, Reference("corner")))
    if word.name == "REST":
        return replace(selector, where=(*selector.where, Reference(REST)))
    if word.name == "COUNT" and item.quantity is not None:
        return replace(selector, k=int(item.quantity.low or 0))
    if word.name == "SHARE":
        return replace(selector, share=share_of(item))
    if word.name in ("RANK", "NEAREST"):
        return replace(selector, rank=item.get("rank"))
    if word.name == "ORDINAL":
        return replace(selector, nth=int(item.get("ordinal")))
    if word.name == "SIDE":
        return replace(selector, side=item.get("side"))
    return replace(selector, filters=(*selector.filters, *_conditions(item)))


def _filtered(selector: Selector, node: Node) -> Selector:
    place = node.branch("place")
    if place is not None:
        return placed(selector, _place(place))
    spot = node.branch("spot")
    if spot is not None:  # "the benches from the park"
        return replace(selector, inside=_spot(spot))
    if node.own(*_LOOKS) and not node.own("WITH", "OF"):
        return _looking(selector, node)
    close = node.branch("within") or node.branch("nearest")
    if close is not None:  # "within 50 m of the church", "closest to the lake"
        spot = close.branch("spot")
        assert spot is not None
        limit, rank = close.first("LIMIT"), close.own("NEAREST")
        if rank and rank[0].item is not None:
            word = rank[0].item.get("rank")
            return replace(selector, near=_spot(spot), rank=word)
        far = limit.quantity.high if limit is not None and limit.quantity is not None else None
        if not _is_plain(spot):
            reference = Reference("near", _choices(spot), far or 0.0)
            return replace(selector, where=(*selector.where, reference))
        return replace(selector, near=_spot(spot), reach=far or 0.0)
    if node.own(*_LOOKS):
        return _looking(selector, node)
    for item in node.leaves("LIMIT", "ROOF", "MATERIAL", "FLOORS"):
        selector = replace(selector, filters=(*selector.filters, *_conditions(item)))
    return selector


def _looking(selector: Selector, node: Node) -> Selector:
    """Add what things look like, or do not."""
    told = [text for item in node.leaves(*_LOOKS) for text in _conditions(item)]
    if node.own("NOT"):
        told = [text.replace("=", "!=") for text in told]
    return replace(selector, filters=(*selector.filters, *told))


def _conditions(item: Item) -> Iterator[str]:
    """Yield a word or a bound as conditions on single objects."""
    quantity = item.quantity
    if quantity is not None:
        name = quantity.attribute or MEASURES.get(quantity.dimension, quantity.dimension)
        if quantity.exact is not None:
            yield f"{name}={quantity.exact:g}"
        elif quantity.low is not None:
            yield f"{name}>{quantity.low:g}"
        if quantity.exact is None and quantity.high is not None:
            yield f"{name}<{quantity.high:g}"
        return
    for kind in ("material", "color"):
        if item.has(kind):
            yield f"{kind}={item.get(kind)}"
            return
    key, _, value = item.get("slot").partition("=")
    if value:
        yield f"{key.rpartition('.')[2]}={value}"


def placed(selector: Selector, place: Place) -> Selector:
    """Return a choice of those objects that are at a place."""
    if place.reference is not None:
        return replace(selector, where=(*selector.where, place.reference))
    if place.off is not None:  # "the bench 10 m north of b05"
        near, reach = place.spot, ABOUT * place.off
        return replace(selector, side=place.side, of=place.spot, near=near, reach=reach)
    if place.side:
        return replace(selector, side=place.side, of=place.spot)
    fronts = (*_ROADS, *_WATERS) if _are_houses(selector) else _ROADS
    if place.relation == "along" or (place.relation == "on" and place.spot in fronts):
        return replace(selector, along=place.spot)
    if place.relation in ("in", "on"):
        return replace(selector, inside=place.spot)
    return replace(selector, near=place.spot)


def _are_houses(selector: Selector) -> bool:
    """Return whether a choice is of buildings, which stand on the bank of a river."""
    return selector.kind == "building" or selector.kind in NOUNS["type"]


def _place(node: Node) -> Place:
    if whole := _side_of_site(node):
        return Place(whole, "", "")
    reference = _reference(node)
    if reference is not None:
        every = bool(next(node.find("end"), node).own("BOTH"))
        for place in node.own("spot"):  # "at every crossing on Hay Road"
            every |= any(
                word.text in _EACH for which in place.own("ALL") for word in which.leaves()
            )
        return Place("", "", "", each=every, reference=reference)
    node = node.branch("away") or node
    side = next((child.item for child in node.own("SIDE")), None)
    where = next(node.find("where"), None)
    relation = (
        where.first() if where is not None else next((to.item for to in node.own("TO")), None)
    )
    said = relation.get("rel") if relation is not None else "from" if node.own("FROM") else ""
    spot = node.branch("spot")
    return Place(
        side.get("side") if side is not None else "",
        said,
        _spot(spot) if spot is not None else "",
        spot is not None and any(item.kind == "id" for item in spot.leaves()),
        next((_metres(far) for far in node.own("AWAY")), None),
        spot is not None and any(word.text in _EACH for word in spot.leaves("ALL")),
    )


def _side_of_site(node: Node) -> str:
    """Return the side of "in the southern half of town", "" for other places."""
    spot = node.branch("spot")
    if spot is None or node.own("SIDE", "AWAY") or not _is_site(spot):
        return ""
    told = {child.name for child in spot.children} - {"WHOLE", "OF", "ALL"}
    side = spot.first("SIDE")
    return side.get("side") if told == {"SIDE"} and side is not None else ""


def _reference(node: Node) -> Reference | None:
    """Return a place that takes more than a relation and the name of a kind to tell."""
    between, close, end = (node.branch(name) for name in ("between", "close_to", "end"))
    if (flank := node.branch("flank")) is not None:
        side, along = flank.first("SIDE"), any(one.get("rel") == "along" for one in flank.leaves())
        assert side is not None
        key = "along" if along else "side"
        return Reference(key, _choices(flank.own("spot")[0]), side=side.get("side"))
    if (off := node.branch("off")) is not None:
        far = off.first("OFF")
        assert far is not None
        assert far.quantity is not None
        amount = far.quantity.low or far.quantity.high or 0.0
        key = "beyond" if far.quantity.high is None else "off"
        return Reference(key, _choices(off.own("spot")[0]), amount)
    if between is not None:
        return Reference("between", tuple(choice_of(spot) for spot in between.own("spot")))
    if close is not None:
        limit = close.first("LIMIT")
        assert limit is not None
        assert limit.quantity is not None
        return Reference("near", _choices(close.own("spot")[0]), limit.quantity.high or 0.0)
    if end is not None:
        part = end.own("CORNER", "END", "EDGE", "MIDDLE", "ENTRANCE")[0].name.lower()
        side = end.first("SIDE") if end.own("SIDE") else None
        spots = tuple(choice_of(spot) for spot in end.own("spot") if not _is_site(spot))
        spots = spots or (() if end.own("spot") else (Selector(HERE),))
        return Reference(part, spots, side=side.get("side") if side is not None else "")
    spot, where = node.branch("spot"), next(node.find("where"), None)
    to = next((child.item for child in node.own("TO", "FROM")), None)
    relation = where.first() if where is not None else to
    if spot is None or relation is None or node.own("SIDE") or node.branch("away") is not None:
        return None
    if relation.text == _OF_SITE:
        return Reference("edge", () if _is_site(spot) else _choices(spot))
    how = _HOW.get(relation.words[0], "before" if relation.text in _BEFORE else "")
    if not how and _is_plain(spot):
        return None
    return Reference(how or relation_of(relation), _choices(spot))


def relation_of(item: Item) -> str:
    """Return how something stands to what follows, "near" where nothing closer is said."""
    said = item.get("rel")
    return said if said in ("in", "on", "along", "around", "to") else "near"


def _is_site(spot: Node) -> bool:
    return any(item.noun == "city" for node in spot.own("WHOLE") for item in node.leaves())


def _is_plain(spot: Node) -> bool:
    """Return whether a kind and a rank, or a name, tell all of a place."""
    inner = spot.branch("beyond")
    told = spot.own("SIDE", "SIZE", "ORDINAL", "NEIGHBORS", "ONES", *_LOOKS)
    noun = spot.own(*_SPOTS)[0].item
    if noun is not None and noun.get("rel") == IT and noun.text not in _SINGULAR:
        return False  # "behind them"
    through = inner is not None and noun is not None and noun.noun in _THROUGH
    return not told and (inner is None or (through and inner.branch("spot") is not None))


def _choices(spot: Node) -> tuple[Selector, ...]:
    return (choice_of(spot),)


def choice_of(spot: Node) -> Selector:
    """Return the objects that a place is about."""
    noun = spot.own(*_SPOTS)[0]
    chosen = Selector()
    for child in spot.children:
        if child.name in ("ALL", "SIZE") or child.item is None:
            continue
        if child.name in ("COUNT", "RANK", "NEAREST", "SIDE", "ORDINAL", *_LOOKS):
            chosen = _modified(chosen, child)
    if noun.item is None:
        chosen = replace(chosen, kind="building", k=chosen.k or (not chosen.nth))
    elif noun.name == "ID":
        chosen = replace(chosen, ids=(noun.item.text,))
    elif noun.name in ("IT", "ONES", "NEIGHBORS"):
        one = noun.item.text in _SINGULAR  # "it" is not what several are
        chosen = replace(chosen, kind=noun.name.lower(), alone=one)
    elif noun.name == "QUARTER":
        chosen = replace(chosen, kind="building", inside=_quarter(noun.item))
    else:
        many = any(child.name in _MANY for child in spot.children)
        chosen = _of_kind(chosen, noun.item)
        chosen = replace(chosen, alone=_is_one(noun.item) and not many)
    beyond = spot.branch("beyond")
    return chosen if beyond is None else _beyond(chosen, beyond)


def _beyond(chosen: Selector, node: Node) -> Selector:
    """Add where the objects of a place are: "the church by the river"."""
    told = _reference(node)
    if told is not None:
        return replace(chosen, where=(*chosen.where, told), alone=False)
    inner, first = node.own("spot")[0], node.children[0].item
    assert first is not None
    rank = node.own("NEAREST")
    if rank and _is_plain(inner):
        word = first.get("rank")
        return replace(chosen, near=_spot(inner), rank=word, k=0, alone=False)
    how = _HOW.get(first.words[0], relation_of(first))
    return replace(chosen, where=(*chosen.where, Reference(how, _choices(inner))), alone=False)


def references_of(places: Iterable[Place]) -> tuple[Reference, ...]:
    """Return the places that other objects tell."""
    return tuple(place.reference for place in places if place.reference is not None)


def _metres(far: Node) -> float:
    quantity = far.item.quantity if far.item is not None else None
    assert quantity is not None
    return round(quantity.exact or 0.0, 4)


def _spot(spot: Node) -> str:
    """Return the object a place is about; of "the path around the park" it is the park."""
    item = spot.own(*_SPOTS)[0].item
    if item is None:
        return f"{_rank_of(spot)} building".strip()
    if item.get("rel") == IT:
        return IT
    if item.get("slot").startswith("district="):
        return _quarter(item)
    beyond = spot.branch("beyond")
    inner = beyond.branch("spot") if beyond is not None else None
    if inner is not None and item.noun in _THROUGH:
        return _spot(inner)
    if item.kind == "id":
        return item.text
    return f"{_rank_of(spot)} {kind_of(item)}".strip()


def _rank_of(spot: Node) -> str:
    """Return the rank of "the tallest building", "" for none."""
    return next(
        (item.get("rank") for node in spot.own("RANK", "NEAREST") for item in node.leaves()), ""
    )
