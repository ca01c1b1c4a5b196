"""Places that a brief asks for: squares, waters, land, elements, what goes round them, trees."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from cityx.checks.predicates.words import COLORS
from cityx.language.asked_values import (
    Found,
    Wishes,
    bounds,
    is_a_port,
    is_wanted,
    side_of_land,
    wanted,
    wish,
    within,
)
from cityx.language.lexicon.phrases import SPECIES
from cityx.language.measurable import COLORS as NAMED_COLORS
from cityx.language.measurable import THING_MATERIALS, look_of_kind
from cityx.language.site import OPPOSITE
from cityx.protocol.serving import Slots
from cityx.town.elements import (
    BARRIERS,
    ELEMENTS,
    OTHER_THINGS,
    PARTS,
    PLACES,
    attributes_of,
    looked_at,
    side_and_place,
)

MANY, SOME, FEW = 60, 10, 30  # trees
CANAL, WIDE_RIVER, NARROW_RIVER = 12.0, 45.0, 9.0  # metres of water
BRIDGES = 2  # over each river
_SIDES_OF_THINGS = ("height", "length", "width")
AT_SEA = ("pier", "breakwater", "harbour_crane", "container")
QUAY = 42.0  # metres of paving at the water of a harbour
COAST = "layout/coast-v1"
ISLAND_SEA, BEACH = 0.35, 35.0  # of the site, that is sea round an island; metres of a beach
RELIEF = "terrain/relief-v1"
GENTLE = 0.08  # rise over run of gentle land, at most
STEPPED = 0.1  # rise over run of land on which steps are asked for, and no other


def places(found: Slots, town: dict[str, Any], wishes: Wishes) -> None:
    """Plazas, parks and lakes: how many, the first square in the middle."""
    del town
    elements = set(found.get("element", ()))
    if {"park", "lake"} <= elements:
        share = found.get("park.share.min", found.get("green.share.min", (None,)))[0]
        wish(wishes, "layout/central_park-v1", **({} if share is None else {"share": share}))
        elements -= {"park", "lake"}
    denied = {str(word) for word in found.get("not", ())}
    if "pond" in elements or any(key.startswith("pond.count") for key in found):
        wanted = bounds(found, "pond.count", "least", "most", int).get("least", 1)
        side = found.get("pond.side", ("any",))[0]
        placed = {"side": side} if side in OPPOSITE else {}
        if wanted:
            wish(wishes, "layout/ponds-v1", least=wanted, **placed)
            elements |= set() if any(key.startswith("park.") for key in found) else {"park"}
    for kind in ("plaza", "park", "lake"):
        ends = bounds(found, f"{kind}.count", "least", "most", int)
        none_or_one = 0 if kind in denied else 1 if kind in elements else None
        count = next(iter(ends.values()), none_or_one)
        if count is not None:
            middle = kind == "plaza" or "middle" in found.get(f"{kind}.side", ())
            more: dict[str, Any] = {"central": True} if middle else {}
            more |= _lakes(found, kind) if kind == "lake" and count else {}
            area = within(found, f"{kind}.area")
            more |= {"area": area} if area is not None and count else {}
            wish(wishes, "layout/places-v1", kind=kind, count=count, **more)


def _lakes(found: Slots, kind: str) -> dict[str, Any]:
    """Return where lakes lie, how large each is, and how many islands there are in one."""
    more: dict[str, Any] = {}
    side = found.get(f"{kind}.side", ("",))[0]
    if side in OPPOSITE:
        more["side"] = side
    if _water_of_islands(found) == "lake":
        more["islands"] = _islands(found)
    return more


def _islands(found: Slots) -> int:
    """Return how many islands are asked for."""
    count = within(found, "island.count")
    return round(count) if count else 1


def _water_of_islands(found: Slots) -> str:
    """Return the water that islands lie in: lake, river, or sea where the town is one; "" for none.

    Where the words do not say it is the water that is asked for, or the sea.
    """
    if not is_wanted(found, "island"):
        return ""
    said = str(found.get("island.near", ("",))[0])
    waters = [kind for kind in ("lake", "river") if kind in found.get("element", ())]
    return said or (waters[0] if waters else "sea")


def elements(found: Slots, town: dict[str, Any], wishes: Wishes) -> None:
    """Churches, schools, playgrounds...: how many, none, where, and to what they stand near."""
    del town
    named = {str(word) for word in found.get("element", ())}
    denied = {str(word) for word in found.get("not", ())}
    for kind in sorted(ELEMENTS, key=_order_of(found)):
        parts = _parts_of(found, kind, named, denied)
        args = wanted(found, kind)
        if kind == "pier" and args is None and is_a_port(found):
            args = {"least": 1}
        if args is None and parts.get("parts", 0) > 0:
            args = {"least": 1}
        if args is None:
            continue
        if args["least"]:
            placed = {
                name: found[f"{kind}.{name}"][0]
                for name in ("side", "near", "relation", "second", "metres", "size")
                if f"{kind}.{name}" in found
            }
            if (rise := str(placed.get("side", ""))) in ("high", "low"):
                placed["side"] = side_of_land(found, rise)
                if placed["side"] == "middle" and "plaza" not in named:
                    wishes.get("layout/places-v1#plaza", {}).pop("central", None)
            for end, name in ((".min", "nearest"), (".max", "farthest")):
                if f"{kind}.metres{end}" in found:
                    placed[name] = found[f"{kind}.metres{end}"][0]
            if not ELEMENTS[kind].is_thing:
                placed |= _sides_of(found, kind)
            args |= {**placed, **parts}
        wish(wishes, "layout/elements-v1", kind=kind, **args)


def _sides_of(
    found: Slots, kind: str, names: Sequence[str] = ("length", "width")
) -> dict[str, Any]:
    """Return how high, long or wide a thing is to be, in metres, within the bounds that are told.

    What it cannot be is left out.
    """
    told: dict[str, Any] = {}
    for name in names:
        own = name in attributes_of(kind)
        value = within(found, f"{kind}.{name}") if own else None
        if value is not None:
            told[name] = value
    return told


def dressed(found: Slots, town: dict[str, Any], wishes: Wishes) -> None:
    """Tell of which material, colour and size things, land, walls and bridges are."""
    del town
    for kind in (*ELEMENTS, *OTHER_THINGS):
        own = attributes_of(kind)
        if not own or looked_at(kind).startswith("building"):
            continue
        element = ELEMENTS.get(kind)
        thing = element is None or element.is_thing or element.looks
        args: dict[str, Any] = _sides_of(found, kind, _SIDES_OF_THINGS) if thing else {}
        if element is not None and element.is_thing and f"{kind}.size" in found:
            args["size"] = found[f"{kind}.size"][0]
        looks = _looks_of(found, kind)
        for turn, look in enumerate(looks or [{}]):
            several = {"turn": turn, "turns": len(looks)} if len(looks) > 1 else {}
            if args or look:
                key = f"edit/dress-v1#{kind}/{turn}"
                wishes[key] = {"kind": kind, **args, **look, **several}


def _looks_of(found: Slots, kind: str) -> list[dict[str, Any]]:
    """Return the materials and colours that things of a kind have, several in turn."""
    materials = [
        {"material": THING_MATERIALS[str(word)]} for word in found.get(f"{kind}.material", ())
        if look_of_kind(f"{kind}.material", str(word))[0]
    ]  # fmt: skip
    colors = [
        {"color": COLORS[NAMED_COLORS[str(word)]][0]} for word in found.get(f"{kind}.color", ())
        if look_of_kind(f"{kind}.color", str(word))[0]
    ]  # fmt: skip
    return [
        {**(materials[turn % len(materials)] if materials else {}),
         **(colors[turn % len(colors)] if colors else {})}
        for turn in range(max(len(materials), len(colors)))
    ]  # fmt: skip


def enclosed(found: Slots, town: dict[str, Any], wishes: Wishes) -> None:
    """Tell what goes round elements."""
    del town
    for kind in (*ELEMENTS, *PLACES):
        for barrier in found.get(f"{kind}.enclosed", ()):
            args: dict[str, Any] = {"kind": kind, "barrier": BARRIERS[str(barrier)]}
            height = within(found, f"{barrier}.height")
            args |= {} if height is None else {"height": height}
            wishes[f"edit/ring-v1#{kind}/{barrier}"] = args


def _axis_of_sides(found: Slots, kind: str) -> str | None:
    """Return which way water flows that has something in the west or the east of it."""
    sides = [side_and_place(str(value)) for key in found if key.endswith(".by")
             for value in found[key]]  # fmt: skip
    sides += [
        (str(found.get(key.replace(".near", ".relation"), ("",))[0]), str(found[key][0]))
        for key in found if key.endswith(".near")
    ]  # fmt: skip
    own = {side for side, place in sides if place == kind}
    return "north_south" if own & {"east", "west"} and not own & {"north", "south"} else None


def tree_rows(found: Slots, town: dict[str, Any], wishes: Wishes) -> None:
    """Ask for trees along rivers, squares..., of whichever kind."""
    del town
    for kind in ("tree", *SPECIES):
        for value in found.get(f"{kind}.by", ()):
            args: dict[str, Any] = {"near": str(value)}
            args |= {} if kind == "tree" else {"species": kind}
            wishes[f"layout/tree_row-v1#{kind}/{value}"] = args


def _order_of(found: Slots) -> Callable[[str], tuple[int, int, float]]:
    """Return the order of elements: lines, then what takes most; what is near others after them."""

    def depth(kind: str, seen: tuple[str, ...] = ()) -> int:
        others = [str(found[f"{kind}.{name}"][0]) for name in ("near", "second")
                  if f"{kind}.{name}" in found]  # fmt: skip
        others = ["pier" if one == "harbour" else one for one in others]
        behind = [one for one in others if one in ELEMENTS and one not in seen]
        return 1 + max((depth(one, (*seen, kind)) for one in behind), default=0)

    return lambda kind: (depth(kind), not ELEMENTS[kind].builder, -ELEMENTS[kind].area)


def _parts_of(
    found: Slots, kind: str, named: set[str], denied: set[str]
) -> dict[str, Any]:  # fmt: skip
    """Return how many gates, level crossings or stops a line has, and how high it is."""
    part = PARTS.get(ELEMENTS[kind].builder, "")
    args: dict[str, Any] = {}
    if part in denied and kind in named:
        args["parts"] = 0
    elif f"{part}.count" in found:
        args["parts"] = int(found[f"{part}.count"][0])
    elif part in named and kind not in named and kind != "city_wall":  # gates are of fences, too
        args["parts"] = 1
    height = found.get(f"{kind}.height", ())
    if ELEMENTS[kind].builder and height and not isinstance(height[0], str):
        args["height"] = float(height[0])
    return args


def water(found: Slots, town: dict[str, Any], wishes: Wishes) -> None:
    """Tell of rivers, canals, coasts, harbours and bridges."""
    del town
    elements = set(found.get("element", ()))
    islands = _water_of_islands(found)
    in_sea = islands == "sea"
    for kind in ("river", "canal"):
        asked = any(key.startswith(f"{kind}.") for key in found)
        bridged = kind == "river" and any(key.startswith("bridge.count") for key in found)
        bridged |= kind == "river" and is_wanted(found, "closed_bridge")
        bridged = (bridged and not in_sea) or (kind == "river" and islands == "river")
        if kind in elements or asked or (bridged and "canal" not in elements):
            _flowing(found, wishes, kind)
    placed = (f"{kind}.side" for kind in ("beach", "sea", "harbour", *AT_SEA))
    side = next((found[key] for key in placed if found.get(key, ("",))[0] in OPPOSITE), ())
    side = ("all",) if in_sea else side
    if {"beach", "sea", "harbour"} & elements or "beach.side" in found or "sea.side" in found:
        wish(wishes, COAST, **({"side": side[0]} if side else {}))
    if in_sea:
        beach = BEACH if "beach" in elements else 0.0
        wish(wishes, COAST, side="all", share=ISLAND_SEA, beach=beach)
        wishes.pop("layout/ring_road-v1", None)  # the promenade is one
    sand = within(found, "beach.width")
    if sand is not None:
        wish(wishes, COAST, beach=sand)
    port = is_a_port(found)
    set_out = {kind for kind in AT_SEA[:2] if is_wanted(found, kind)}
    wet = {"river", "canal", "lake", "pond", "sea", "beach"} & elements
    if port or (set_out and not wet):
        wish(wishes, COAST, quay=QUAY, **({"side": side[0]} if side else {}))


def _flowing(found: Slots, wishes: Wishes, kind: str) -> None:
    """Ask for rivers or canals: how many, how wide, where, and under how many bridges."""
    args: dict[str, Any] = {} if kind == "river" else {"kind": kind, "width": CANAL}
    width = within(found, f"{kind}.width")
    words = found.get(f"{kind}.width", ())
    if words and isinstance(words[0], str):
        width = WIDE_RIVER if words[0] == "wide" else NARROW_RIVER
    if width is not None:
        args["width"] = width
    if "river.meet" in found and kind == "river":
        args |= {"meet": True, "count": int(found["river.meet"][0])}
    else:
        count = within(found, f"{kind}.count")
        if count is not None and count != 1:
            args["count"] = round(count)
    side = found.get(f"{kind}.side", ("any",))[0]
    axis = found.get("river.axis", (None,))[0] or _axis_of_sides(found, kind)
    if side == "any" and "valley" in found.get("terrain", ()):
        side = "middle"  # its sides rise on both banks
    if side != "any":
        args["side"] = side
    if axis is not None:
        args["axis"] = "north_south" if axis == "north_south" else "west_east"
    if kind == "river" and _water_of_islands(found) == "river":
        args["islands"] = _islands(found)
    bridges = within(found, "bridge.count")
    if bridges is not None:
        args["bridges"] = round(bridges)
    elif args.get("count", 1) > 1:
        args["bridges"] = BRIDGES * args["count"]
    closed = (wanted(found, "closed_bridge") or {}).get("least", 0)
    if bridges is None and closed > BRIDGES:
        args["bridges"] = max(closed, args.get("bridges", 0))
    key = f"layout/river-v1#{kind}" if kind == "canal" else "layout/river-v1"
    wishes.setdefault(key, {}).update(args)


def terrain(found: Found, town: dict[str, Any], wishes: Wishes) -> None:
    """Bring metres, sides and steps to the land that words ask for; files of heights go before."""
    del town
    if "height_field" in found.get("source", ()):
        wishes.pop(RELIEF, None)
        return
    wide = {key: found[key] for key in found if key.startswith("terrain.")}
    if RELIEF not in wishes and not wide:
        return
    args: dict[str, Any] = {}
    for name, key in (("metres", "terrain.relief"), ("grade", "terrain.slope")):
        value = within(found, key)
        if value is not None:
            args[name] = value
    if "terrain.steps" in found:
        args |= {"steps": int(found["terrain.steps"][0]), "form": "terraces"}
    if "slope" in found.get("terrain", ()) and "terrain.slope" in found:
        args["form"] = "slope"
    shores = [found[key][0] for key in ("sea.side", "beach.side") if key in found]
    if "terrain.side" in found:
        args["side"] = found["terrain.side"][0]
    elif shores and shores[0] in OPPOSITE:
        args["side"] = OPPOSITE[shores[0]]
    axis = found.get("terrain.axis", found.get("river.axis", (None,)))[0]
    if axis is not None:
        args["axis"] = "north_south" if axis == "north_south" else "west_east"
    grade = found.get("terrain.grade", (None,))[0]
    if grade is not None:
        args["steepest" if grade == "gentle" else "steep"] = GENTLE if grade == "gentle" else True
    wish(wishes, RELIEF, **args)


def steps(found: Slots, town: dict[str, Any], wishes: Wishes) -> None:
    """Streets of steps, with ramps beside them; where nothing is said of the land it slopes."""
    del town
    args, ramps = wanted(found, "steps"), wanted(found, "ramp")
    if args is None and ramps is None:
        return
    args = args or {"least": 0}
    if ramps is not None:
        args["ramps"] = ramps["least"]
        args["least"] = max(args["least"], ramps["least"])
    side = {"side": found["steps.side"][0]} if "steps.side" in found else {}
    wish(wishes, "road/steps-v1", **args, **side)
    told = "terrain" in found or any(key.startswith("terrain.") for key in found)
    if args["least"] and not told and "height_field" not in found.get("source", ()):
        wish(wishes, RELIEF, form="slope", grade=STEPPED)


def gradients(found: Slots, town: dict[str, Any], wishes: Wishes) -> None:
    """Where the city rises, and where it is densest."""
    del town
    limits = wishes.get("layout/building_limits-v1", {})
    floors = {name: n for name, n in limits.items() if name in ("least_floors", "most_floors")}
    for towards in found.get("building.gradient", ()):
        wish(wishes, "layout/height_gradient-v1", towards=towards, **floors)
    for towards in found.get("density.gradient", ()):
        wish(wishes, "layout/density_gradient-v1", towards=towards)


def trees(found: dict[str, tuple[Any, ...]], town: dict[str, Any], wishes: Wishes) -> None:
    """Tell how many trees there are, of which kinds, and how far apart."""
    del town, wishes
    words = found.get("nature.trees", ())
    if "tree" in found.get("not", ()):
        found |= {"trees.street_trees": (False,), "trees.most": (0,)}
    elif "many" in words:
        found["trees.least"] = (MANY,)
    elif "some" in words:
        found["trees.least"] = (SOME,)
    elif "few" in words:
        found["trees.most"] = (FEW,)
    counted = bounds(found, "tree.count", "least", "most", int)
    apart = bounds(found, "nature.spacing", "least_apart", "most_apart", float)
    found |= {f"trees.{name}": (value,) for name, value in (counted | apart).items()}
    for key, name in (
        ("nature.species", "species"), ("nature.species.streets", "street_species"),
        ("nature.species.parks", "park_species"),
    ):  # fmt: skip
        if len(found.get(key, ())) == 1:  # of several none can be that of all trees
            found[f"trees.{name}"] = found[key]
