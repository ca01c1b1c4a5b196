"""What is said of streets: blocks, the turn of a grid, gradients, spacing, surfaces, lanes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from cityx.language.here import BUILDINGS, ROADS, Here
from cityx.language.scan import ENDS, Item, Quantity
from cityx.language.scopes import NEGATED, READ
from cityx.language.syntax import is_plural

_BLOCK = ("block", "blocks")
_LINES = ("row", "rows", "column", "columns")
# Words for the way in which blocks lie -> what they are then counted as.
_WAYS = {
    "wide": "columns", "across": "columns", "broad": "columns", "long": "rows", "deep": "rows",
    "down": "rows", "high": "rows",
}  # fmt: skip
_BETWEEN_BLOCKS = 3  # items between a number and the blocks it counts
_NEAR = 5  # items between blocks and their size
_AWAY = ("from", "away", "off", "down", "along", "north", "south", "east", "west")
_BY = ("by", "x", "×", "*", "times")
_TURNED = ("turn", "turned", "rotated", "rotate", "tilted", "skewed", "angled", "turning", "angle")
_WORDS_OF_TURNS = (*_TURNED, "clockwise", "counter", "counterclockwise", "anti", "anticlockwise")
_LEAST_LENGTH = 100.0  # metres from which a length of a street is no width
_EDGES = ("edge", "edges", "outskirts", "periphery", "border", "borders", "outside", "rim")
_RISES = ("rising", "rises", "rise", "growing", "grow", "grows", "taller", "higher", "denser",
          "increasing", "increase", "increases", "climb", "climbs", "climbing")  # fmt: skip
_FALLS = ("falling", "falls", "fall", "lower", "shorter", "sparser", "decreasing", "decrease",
          "decreases", "descending", "thinning", "dropping")  # fmt: skip
_BUILT_WORDS = ("taller", "shorter", "denser", "sparser", "thinning")
_DENSER = ("denser", "sparser", "thinning", "density")
_TO_PLACE = 4  # items between "taller" and the place towards which
_ACROSS = {"center": "edge", "edge": "center", "north": "south", "south": "north",
           "east": "west", "west": "east"}  # fmt: skip
OF_STREETS = (
    "roundabout",
    "pedestrian_zone",
    "signalled_junction",
    "dead_end",
    "road_works",
    "closed_bridge",
    "scaffold",
)
_SCAFFOLDED = ("house", "building", "apartment", "terrace", "office", "shop")
_AT_HOUSES = ("in front of", "before", "at", "on", "along", "with", "behind", "under", "in")
_SPACED = ("streetlight", "bench")
_SHARED = {"cycleway": "cycleway", "cycle_track": "cycle_track"}


def read_streets(here: Here) -> None:
    """Read what an item says of streets and of what lies between and along them."""
    for rule in (
        _pair_of_counts, _rows_of_blocks, _blocks_each_way, _blocks, _size_of_blocks, _turn,
        _gradient, _spacing, _surface, _one_way, _length, _lanes_past_comma,
        _width_of_walks, _share_of_streets, _ramps, _middle, _scaffolded,
    ):  # fmt: skip
        if not here.item.state:
            rule(here)


def _is_blocks(item: Item) -> bool:
    """Return whether an item is the word for land between streets."""
    return item.noun == "city" and item.words[-1] in _BLOCK


def _blocks_behind(here: Here, at: int) -> Item | None:
    """Return the blocks that a number before an index counts."""
    for item in here.items[at : at + _BETWEEN_BLOCKS + 1]:
        if _is_blocks(item):
            after = here.items[here.items.index(item) + 1 :][:1]
            return None if after and after[0].text in _AWAY else item
        looks = item.has("slot", "size", "width", "height", "material", "color")
        looks = looks or (item.quantity is not None and item.quantity.dimension == "length")
        if item.noun or not (looks or item.is_mark("-") or item.text in ("of", "identical")):
            return None
    return None


def _pair_of_counts(here: Here) -> None:
    """Read "4 by 3 blocks", "a 4 x 3 grid" and "six blocks by four"."""
    items = list(here.items[here.at : here.at + 4])
    named = items.pop(1) if len(items) == 4 and _is_blocks(items[1]) else None
    if len(items) < 3 or items[1].text not in _BY:
        return
    counts = [_whole(items[0].quantity), _whole(items[2].quantity)]
    blocks = named or _blocks_behind(here, here.at + 3)
    if blocks is None or not all(counts):
        return
    for item in (items[1], blocks):
        item.state = item.state or READ
    here.found.add("block.columns", counts[0], items[0], items[2])
    here.found.add("block.rows", counts[1], items[0], items[2])


def _rows_of_blocks(here: Here) -> None:
    """Read "four rows of six blocks"."""
    lines = here.after.words[0] if here.after is not None and here.after.words else ""
    of = [one for one in here.items[here.at + 1 : here.at + 3] if one.words[-1:] == ("of",)]
    if lines not in _LINES or not of:
        return
    at = here.items.index(of[0]) + 1
    inner = here.items[at : at + 1]
    counts = [_whole(here.item.quantity), _whole(inner[0].quantity) if inner else 0]
    blocks = _blocks_behind(here, at + 1)
    if blocks is None or not all(counts):
        return
    for item in (*here.items[here.at + 1 : at], blocks):
        item.state = item.state or READ
    along, across = ("rows", "columns") if lines in _LINES[:2] else ("columns", "rows")
    items = (here.item, *inner)
    here.found.add(f"block.{across}", counts[1], items[0], items[-1])
    here.found.add(f"block.{along}", counts[0], items[0], items[-1])


def _blocks_each_way(here: Here) -> None:
    """Read "six blocks long and three wide": those across count from west to east."""
    if _way_of_blocks(here, here.at) is None:
        return
    count, blocks, first = _way_of_blocks(here, here.at) or (0, here.item, here.item)
    link = here.items[here.at + 3 : here.at + 4]
    joined = bool(link) and (link[0].is_mark(",") or link[0].get("rel") in ("and", "by"))
    other = _way_of_blocks(here, here.at + 4, named=False) if joined else None
    ways = [_WAYS.get(first.words[-1], ""), "" if other is None else
            _WAYS.get(other[2].words[-1], "")]  # fmt: skip
    if other is None or ways[0] == ways[1] or not all(ways):
        return
    for item in (blocks, first, *link, other[1], other[2]):
        item.state = item.state or READ
    last = here.items[here.at + 4]
    for way, number in sorted(zip(ways, (count, other[0]), strict=True)):
        here.found.add(f"block.{way}", number, here.item, last)


def _way_of_blocks(here: Here, at: int, *, named: bool = True) -> tuple[int, Item, Item] | None:
    """Return a number, the blocks it counts, and the word for the way they lie in."""
    items = here.items[at : at + 3]
    count = _whole(items[0].quantity) if items else 0
    blocks = items[1] if len(items) > 1 and _is_blocks(items[1]) else None
    way = items[2 if blocks is not None else 1 :][:1]
    if not count or not way or (named and blocks is None) or way[0].words[-1] not in _WAYS:
        return None
    return count, blocks or items[0], way[0]


def _whole(quantity: Quantity | None) -> int:
    exact = quantity.exact if quantity is not None and quantity.dimension == "count" else None
    return int(exact) if exact is not None and exact == int(exact) else 0


def _blocks(here: Here) -> None:
    """Read how many blocks there are."""
    quantity = here.item.quantity
    if quantity is None or quantity.dimension != "count":
        return
    before = here.before
    if before is not None and before.text in ("within", "every"):
        return
    blocks = _blocks_behind(here, here.at + 1)
    if blocks is None or blocks.words[-1] == "block":
        return
    here.found.add_bounded("block.count", quantity, here.item, blocks)


def _size_of_blocks(here: Here) -> None:
    """Read "113 m blocks", "blocks of 80 x 120 m", "blocks 100 m long"."""
    quantity = here.item.quantity
    if quantity is None or quantity.dimension not in ("length", "pair"):
        return
    if quantity.attribute not in ("", "width", "length", "side"):
        return
    blocks = _blocks_with(here)
    if blocks is None:
        return
    blocks.state = blocks.state or READ
    _mark_each(here)
    if quantity.dimension == "pair":
        sides = sorted((quantity.low or 0.0, quantity.other or 0.0))
        for key, side in zip(("width", "length"), sides, strict=True):
            here.found.add(f"block.{key}", side, here.item)
        return
    keys = ("width", "length") if quantity.attribute in ("", "side") else (quantity.attribute,)
    for key in keys:
        here.found.add_bounded(f"block.{key}", quantity, here.item)


def _mark_each(here: Here) -> None:
    for item in here.items[max(0, here.at - 2) : here.at]:
        if item.text in ("each", "every", "measuring", "size") and not item.state:
            item.state = READ


def _blocks_with(here: Here) -> Item | None:
    """Return the blocks that a length is the size of."""
    behind = _blocks_behind(here, here.at + 1)
    if behind is not None and behind.words[-1] == "blocks":
        return behind
    for item in reversed(here.items[max(0, here.at - _NEAR) : here.at]):
        if item.is_mark(ENDS) or (item.quantity is not None and item.quantity.dimension != "count"):
            return item if _is_blocks(item) else None
        if _is_blocks(item):
            size = here.items[here.items.index(item) + 1].text in ("size", "sizes")
            return item if size or item.words[-1] == "blocks" else None
        if item.noun:
            return None
    return None


def _turn(here: Here) -> None:
    """Read by what angle the grid is turned."""
    quantity = here.item.quantity
    if quantity is None or quantity.dimension != "angle" or quantity.exact is None:
        return
    clause = here.clause()
    grid = any("roads.pattern=grid" in one.get("slot") or one.noun in ROADS for one in clause)
    turned = [one for one in clause if one.text in _TURNED]
    if not grid or not turned:
        return
    words = [one for one in clause if set(one.words) & set(_WORDS_OF_TURNS)]
    counter = any("counter" in word or "anti" in word for one in words for word in one.words)
    clockwise = any(word.endswith("clockwise") for one in words for word in one.words)
    for one in words:
        one.state = one.state or READ
    angle = quantity.exact if counter or not clockwise else -quantity.exact
    here.found.add("roads.turn", (angle + 45.0) % 90.0 - 45.0 or 0.0, here.item)
    if not any(slot.key == "roads.pattern" for slot in here.found.slots):
        here.found.add("roads.pattern", "grid", turned[0])


def _gradient(here: Here) -> None:
    """Read "taller towards the centre" and "thinning out to the edge"."""
    item = here.item
    rises, falls = (
        bool(set(item.words) & set(words)) and item.quantity is None for words in (_RISES, _FALLS)
    )
    if not (rises or falls):
        return
    built = set(item.words) & set(_BUILT_WORDS) or any(
        one.noun_class in BUILDINGS or one.text == "skyline" for one in here.clause()
    )
    towards = _towards(here) if built else None  # the land rises as well
    if towards is None:
        return
    place, read = towards
    key = "density" if set(item.words) & set(_DENSER) else "building"
    for one in here.items[max(0, here.at - 3) : here.at + 4]:
        if one.text in ("density", "heights", "height", "skyline"):
            key = "density" if one.text == "density" else key
            read.append(one)
    for one in read:
        one.state = one.state or READ
    here.found.add(f"{key}.gradient", place if rises else _ACROSS[place], item, *read[:1])


def _towards(here: Here) -> tuple[str, list[Item]] | None:
    """Return the place that follows "towards", and the items that say so."""
    items = here.items[here.at + 1 : here.at + 2 + _TO_PLACE]
    for k, item in enumerate(items):
        if item.is_mark(ENDS) or item.quantity is not None:
            return None
        to = item.get("rel") in ("to", "near", "in") or set(item.words) & {"toward", "towards"}
        if not to:
            continue
        for place in items[k:]:
            if place.noun == "center" or {"center", "middle"} & set(place.words):
                return "center", [item, place]
            if set(place.words) & set(_EDGES):
                return "edge", [item, place]
            if place.has("side") and place.get("side") in _ACROSS:
                return place.get("side"), [item, place]
            if place is not item and place.kind not in ("function", "unknown"):
                return None
    return None


def _spacing(here: Here) -> None:
    """Read how far apart lamps and benches stand along streets."""
    quantity = here.item.quantity
    if quantity is None or quantity.dimension != "length":
        return
    every = here.before is not None and here.before.text in ("every", "each")
    if quantity.attribute != "spacing" and not (every and not quantity.attribute):
        return
    noun = _before(here)
    if noun is None or noun.noun not in _SPACED:
        return
    if _elsewhere(here):
        return
    if every and here.before is not None:
        here.before.state = READ
    noun.state = noun.state or READ
    here.found.add_bounded(f"{noun.noun}.spacing", quantity, here.item)


def _elsewhere(here: Here) -> bool:
    """Return whether a row of things stands along no street: "every 20 m along the river"."""
    for item in here.clause():
        if item.get("rel") in ("along", "on", "in", "around", "near"):
            behind = here.items[here.items.index(item) + 1 :][:3]
            noun = next((one for one in behind if one.noun), None)
            if noun is not None and noun.noun_class not in ("road", "place"):
                return True
    return False


def _before(here: Here, far: int = 6) -> Item | None:
    """Return the noun shortly before an item, within its clause."""
    for item in reversed(here.items[max(0, here.at - far) : here.at]):
        if item.is_mark(ENDS + ","):
            return None
        if item.noun and item.noun not in ("city", "center"):
            return item if item.state in ("", READ) else None
    return None


def _road_of(here: Here) -> Item | None:
    """Return the street that a word is of: the one behind it, or before "paved with" it."""
    noun = here.noun_behind() or _before(here)
    return noun if noun is not None and noun.noun in ROADS else None


def _surface(here: Here) -> None:
    """Read what streets are paved with."""
    road = _road_of(here) if here.item.has("surface") and not here.item.has("slot") else None
    if road is None or road.state == NEGATED:
        return
    if any(one.has("surface") for one in here.items[here.at + 1 : here.at + 3]):
        here.item.state = READ  # "paved with setts"
        return
    for item in here.items[max(0, here.at - 2) : here.at]:
        if item.text in ("paved", "surfaced", "covered", "laid"):
            item.state = READ
    here.found.add(f"{_of(road)}.surface", here.item.get("surface"), here.item, road)


def _of(road: Item) -> str:
    """Return the key of the streets that a noun names."""
    return {"avenue": "roads.main", "ring_road": "roads.ring"}.get(road.noun, ROADS[road.noun])


def _one_way(here: Here) -> None:
    """Read which streets are one-way."""
    item = here.item
    if not item.has("direction") or item.get("direction") != "along":
        return
    road = item if item.noun in ROADS else _road_of(here)
    if road is None:
        return
    near = here.items[max(0, here.at - 4) : here.at]
    share = next((one for one in near if one.quantity and one.quantity.dimension in _PARTS), None)
    if share is not None and share.quantity is not None:
        road.state = road.state or READ
        here.found.add_bounded("oneway.share", share.quantity, share, item)
        return
    here.found.add(f"{_of(road)}.oneway", "yes", item, road)


_PARTS = ("part", "share")


def _length(here: Here) -> None:
    """Read the length of a street: "a 1.5 km avenue", "a boulevard of 2 km"."""
    quantity = here.item.quantity
    if (
        quantity is None
        or quantity.dimension != "length"
        or quantity.attribute not in ("", "length")
    ):
        return
    low = quantity.low if quantity.low is not None else quantity.high
    road = here.noun_behind() or _before(here)
    if road is None and here.before is not None and here.before.is_mark(","):
        road = here.last_noun()
    if road is None or road.noun not in ("avenue", "main_street"):
        return
    if not quantity.attribute and (low or 0.0) < _LEAST_LENGTH:
        return
    long = [one for one in here.items[max(0, here.at - 5) : here.at + 4]
            if one.text in ("long", "straight", "dead straight")]  # fmt: skip
    for one in long:
        one.state = one.state or READ
    road.state = road.state or READ
    here.found.add_bounded("roads.main.length", quantity, here.item)


def _lanes_past_comma(here: Here) -> None:
    """Read "a long avenue, 2 km, six lanes"."""
    quantity = here.item.quantity
    comma = here.before is not None and here.before.is_mark(",")
    if quantity is None or quantity.dimension != "lanes" or not comma:
        return
    road = here.last_noun() if here.noun_behind() is None else None
    if road is None or road.noun not in ("avenue", "main_street", "motorway", "ring_road"):
        return
    here.found.add_bounded(f"{_of(road)}.lanes", quantity, here.item)


def _width_of_walks(here: Here) -> None:
    """Read "wide pavements"."""
    width = here.item.get("width")
    noun = here.noun_behind() if width and not here.item.has("slot") else None
    if noun is not None and noun.noun == "sidewalk":
        here.found.add("sidewalk.width", width, here.item, noun)


def _share_of_streets(here: Here) -> None:
    """Read on how many streets there are cycle lanes: "bike lanes on half of the main streets"."""
    kind = _SHARED.get(here.item.noun, "")
    if not kind:
        return
    items: Sequence[Item] = here.items[here.at + 1 : here.at + 7]
    on = next((k for k, one in enumerate(items) if one.get("rel") in ("on", "along")), -1)
    part = next((k for k, one in enumerate(items) if _tells_of_how_many(one)), -1)
    if part < 0 and on >= 0 and items[on + 1 : on + 2] and items[on + 1].text == "the":
        part = on + 1  # "on the main streets" is on all of them
    if part < 0 or not 0 <= on < part:
        return
    road = next((one for one in items[part:] if one.noun in ROADS), None)
    if road is None or any(one.is_mark(ENDS + ",") for one in items[: items.index(road)]):
        return
    if items[part].text == "the" and not is_plural(road.words[-1]):
        return  # "on the street by the church"
    found = items[part].quantity
    share = found if found is not None else Quantity("share", 1.0, 1.0)
    key = _of(road).replace("roads", kind, 1) + ".share"
    told = items[on : items.index(road) + 1]
    here.found.add_bounded(key, replace(share, dimension="share"), here.item, *told)


def _ramps(here: Here) -> None:
    """Read "dropped kerbs at every crossing"."""
    if here.item.noun != "curb_ramp":
        return
    at, every, place = ([*here.items[here.at + 1 : here.at + 4], None, None, None])[:3]
    if at is None or every is None or place is None or place.noun != "crossing":
        return
    if at.get("rel") == "on" and every.get("rel") in ("all", "every"):
        at.state = every.state = place.state = READ
        here.found.add("crossing.ramps", "all", here.item)


def _middle(here: Here) -> None:
    """Read "a pedestrian street through the middle"."""
    if here.item.noun != "center":
        return
    before = [one for one in here.before_in_clause() if one.noun]
    if before and before[-1].noun in OF_STREETS and before[-1].state in ("", READ):
        here.found.add(f"{before[-1].noun}.side", "middle", here.item)


def _scaffolded(here: Here) -> None:
    """Read how many houses have scaffolds: "scaffolds before two houses", "two with scaffolds"."""
    quantity = here.item.quantity
    house = here.after
    if quantity is None or quantity.dimension != "count" or house is None:
        return
    if house.noun not in _SCAFFOLDED:
        return
    before, after = here.items[max(0, here.at - 2) : here.at], here.items[here.at + 2 : here.at + 4]
    for scaffold, how in (pair for pair in (before, after[::-1]) if len(pair) == 2):
        if scaffold.noun == "scaffold" and how.text in _AT_HOUSES and scaffold.state in ("", READ):
            how.state = scaffold.state = house.state = READ
            here.found.add_bounded("scaffold.count", quantity, here.item, scaffold)
            return


def _tells_of_how_many(item: Item) -> bool:
    part = item.quantity is not None and item.quantity.dimension in _PARTS
    return part or item.get("rel") in ("all", "every")
