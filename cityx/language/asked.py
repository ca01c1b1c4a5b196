"""What is asked for: the slots of a brief, with what they mean for actions.

A brief says "downtown", "dense" or "two hectares"; actions take zones, shares and metres.
`cityx.town.presets` says what the words mean; here numbers go over them. What follows is
written with the name of the action it is for: "town.zone" is the parameter ``zone`` of
``layout/town``, and the key "do" lists actions that are called for, with their arguments.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from math import sqrt
from types import MappingProxyType
from typing import Any

from cityx.assets.outside_words import brings_buildings
from cityx.checks.predicates.words import COLORS
from cityx.edit.moment import SEASONS
from cityx.language import Brief, Slot
from cityx.language.commands.terminals import ADDED
from cityx.language.goals import (
    LAYOUTS,
    LOW_FLOORS,
    PART,
    TALL_FLOORS,
    is_of_a_part,
    quarters_named,
)
from cityx.language.here import KINDS_OF_PEOPLE, ROLES, SEVERAL
from cityx.language.lexicon.phrases import SPECIES
from cityx.language.life_words import MIXED, SERVICES
from cityx.language.measurable import COLORS as NAMED_COLORS
from cityx.language.measurable import MATERIALS, THING_MATERIALS, look_of_kind
from cityx.language.site import OPPOSITE
from cityx.language.syntax import is_plural
from cityx.protocol.serving import DO, Slots
from cityx.town.building_groups import group_of
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
from cityx.town.part_kinds import PART_KINDS
from cityx.town.presets import PRESETS, plan_of, zone_for
from cityx.town.quarter_kinds import (
    COUNTED_KINDS,
    DWELLINGS,
    HOUSES,
    KINDS,
    ZONE_OF_KIND,
    reach_of,
)

Found = dict[str, tuple[Any, ...]]
Wishes = dict[str, dict[str, Any]]  # action, with its kind where it may be called for twice

# Tall buildings that are counted by themselves -> metres, at least.
TOWERS: Mapping[str, float] = MappingProxyType(
    {"tower": 50.0, "skyscraper": 100.0, "high_rise": 35.0}
)
TALLER = 1.8  # times the least height, where no greatest is said
MARGIN = 0.02  # of a height, by which a bound is kept clear
MEDIAN = 4.0  # metres between carriageways where a median is asked for
WIDE_WALK, NARROW_WALK = 3.6, 1.5  # metres of what is called a wide and a narrow pavement
BESIDE_AVENUE = 400.0  # metres of a site across a street whose length is said
MANY, SOME, FEW = 60, 10, 30  # trees
TALL_TOWN = MappingProxyType({"zone": "core", "density": 1.0})
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
CLEAR = 0.1  # of a bound, by which it is kept clear
LOW = 11.5  # metres of buildings that are called low
LATE_SUMMER = "08-10"  # a day on which the sun sets near west at noon's height of a summer
GATHERING, FLOW = "dynamic/gathering-v1", "dynamic/vehicle_flow-v1"
FEW_PEOPLE, FEW_VEHICLES = 4, 3  # of a kind that is to be there and that nobody counts
WINDS = MappingProxyType({"none": 0.0, "light": 2.5, "medium": 6.0, "strong": 12.0})
# Slot -> argument of `cityx.light.conditions`, and what words mean there.
_CONDITIONS: tuple[tuple[str, str, Mapping[str, float]], ...] = (
    ("visibility", "visibility", {}), ("cloud.share", "cloud", {}),
    ("wetness", "wetness", {"high": 0.8, "low": 0.0}),
    ("snow.cover", "snow_cover", {"high": 0.85, "low": 0.3}), ("wind", "wind", WINDS),
    ("moon", "moon", {"none": 0.0, "full": 1.0}),
    ("windows.lit", "windows", {"none": 0.0, "all": 1.0}),
)  # fmt: skip
LIMITS = "layout/building_limits-v1"
KIND_COUNT, GROUP = "layout/kind_count-v1", "layout/building_group-v1"
# Storeys of kinds of buildings that are called so.
FLOORS_OF: Mapping[str, Mapping[str, int]] = MappingProxyType(
    {"tall": {"least_floors": TALL_FLOORS}, "low": {"most_floors": LOW_FLOORS}}
)
MOST_FLOORS = 200  # where nothing bounds them
# Kinds of buildings that have limits of their own.
LIMITED = ("house", "tower", "apartment", "office", "shop", "factory", *HOUSES, *sorted(
    name for name, one in ELEMENTS.items() if one.building
))  # fmt: skip
# Kind that most buildings shall have -> use that nearly all of them get.
USE_OF_KIND: Mapping[str, str] = MappingProxyType({
    "office": "office", "shop": "retail", "apartment": "apartments", "factory": "industrial",
})  # fmt: skip
# Zone -> people that live on a hectare of it, and the mean storeys of its buildings; measured.
PEOPLE: Mapping[str, tuple[float, float]] = MappingProxyType(
    {"midrise": (195.0, 4.7), "row": (94.0, 2.3), "suburb": (36.0, 1.5)}
)
SPARE = 1.1  # times the land that people take, so that there is some for schools and squares
SMALLEST_TOWN, LARGEST_TOWN = 150.0, 3000.0  # metres of a side
USUAL = 600.0  # metres of a side of a town, where no size is said
SOME_OF_A_KIND = 3  # buildings of a kind that nobody counts beside others that are counted
MOSTLY, MANY_HOUSES = 0.7, 0.3  # shares of buildings
CLOCKS: Mapping[str, str] = MappingProxyType({"golden_hour": "golden", "blue_hour": "blue"})
# How strong weather is, of that of its preset.
STRENGTHS: Mapping[str, float] = MappingProxyType({"light": 0.4, "heavy": 1.0})


def slots_of_brief(brief: Brief) -> Found:
    """Return what a brief asks for, with what follows from it.

    Parameters
    ----------
    brief
        Without conflicts.
    """
    found: Found = {}
    for slot in brief.slots:
        found[slot.key] = (*found.get(slot.key, ()), slot.value)
        if slot.key == "agent" and _is_one(brief.text, slot):
            found.setdefault(f"{slot.value}.count.min", (1,))
    for slot in brief.negated:
        found["not"] = (*found.get("not", ()), slot.value)
    town, wishes = _of_words(found)
    for rule in _RULES:
        rule(found, town, wishes)
    found |= {f"town.{name}": (value,) for name, value in town.items()}
    found[DO] = tuple((action.partition("#")[0], args) for action, args in wishes.items())
    return found


_ONE = re.compile(r"\b(?:an?|one|a single)(?: [\w-]+){0,2} $", re.IGNORECASE)


def _is_one(text: str, slot: Slot) -> bool:
    """Return whether one person or vehicle of a kind is told of: "a man walking his dog"."""
    return bool(_ONE.search(text[: slot.span[0]])) and not is_plural(slot.text)


def _of_words(found: Slots) -> tuple[dict[str, Any], Wishes]:
    """Join the presets of the words."""
    words = [
        (key, str(value))
        for key in PRESETS
        for value in sorted(found.get(key, ()), key=lambda value: value == "cul_de_sac")
        if str(value) in PRESETS[key]
    ]
    (_, town), *then = plan_of(words)
    wishes: Wishes = {}
    mapped = any(source in LAYOUTS for source in found.get("source", ()))
    for action, args in then:
        if action == LIMITS or not mapped:  # a village that is mapped has the squares it has
            _wish(wishes, action, **args)
    return dict(town), wishes


def _wish(wishes: Wishes, action: str, **args: Any) -> None:
    """Call for an action; what was asked of it before stays where nothing else is said."""
    key = f"{action}#{args['kind']}" if "kind" in args else action
    wishes.setdefault(key, {}).update(args)


def _size(found: Slots, town: dict[str, Any], wishes: Wishes) -> None:
    del wishes
    if "size.area" in found:
        town |= dict.fromkeys(("width", "depth"), sqrt(float(found["size.area"][0])))
    for key, name in (("size.x", "width"), ("size.y", "depth")):
        if key in found:
            town[name] = float(found[key][0])


def _heights(found: Slots, town: dict[str, Any], wishes: Wishes) -> None:
    """Bounds that hold for every building, unless they speak of towers."""
    for word in found.get("building.height", ()):
        if word == "tall":
            town |= TALL_TOWN
        elif word == "low":
            _wish(wishes, LIMITS, highest=LOW)
    kind = next((str(word) for word in found.get("building.type", ()) if word in TOWERS), "")
    low, high = (found.get(f"building.height.{end}", (None,))[0] for end in ("min", "max"))
    if kind:
        town |= TALL_TOWN if not set(_counted_kinds(found)) & set(DWELLINGS) else {}
        _towers(found, wishes, low or TOWERS[kind], high)
    else:
        if low is not None:
            _wish(wishes, LIMITS, lowest=float(low))
        if high is not None:
            _wish(wishes, LIMITS, highest=float(high))
    exact = found.get("building.floors", (None,))[0]
    for end, name in (("min", "least_floors"), ("max", "most_floors")):
        floors = found.get(f"building.floors.{end}", (exact,))[0]
        if floors is not None and not isinstance(floors, str):
            _wish(wishes, LIMITS, **{name: int(floors)})


def _towers(found: Slots, wishes: Wishes, low: float, high: float | None) -> None:
    """Towers that are counted stand alone; where they are not, the highest is as high as said."""
    if "building.count" not in found:
        if "building.height.min" in found:
            ends = {"lowest": float(low)} | ({} if high is None else {"highest": float(high)})
            _wish(wishes, LIMITS, kind="tower", **ends)
        if high is not None:
            _wish(wishes, "layout/highest-v1", height=float(high) * (1 - MARGIN))
        return
    around = next((w for w in ("plaza", "park") if w in found.get("element", ())), "nothing")
    top = float(high) if high is not None else low * TALLER
    _wish(
        wishes, "layout/towers-v1", count=int(found["building.count"][0]), around=around,
        lowest=low * (1 + MARGIN), highest=top * (1 - MARGIN), alone=True,
    )  # fmt: skip


def _heights_of_kinds(found: Slots, town: dict[str, Any], wishes: Wishes) -> None:
    """Bounds that hold for buildings of one kind: houses, shops, churches..."""
    del town
    for kind in LIMITED:
        args = _bounds(found, f"{kind}.height", "lowest", "highest", float)
        args |= _bounds(found, f"{kind}.floors", "least_floors", "most_floors", int)
        if "tallest" in found.get(f"{kind}.height", ()):
            wishes[f"layout/tallest-v1#{kind}"] = {"kind": kind}
        for word in found.get(f"{kind}.height", ()):
            args = {**FLOORS_OF.get(str(word), {}), **args}
        if args:
            _spare(found, wishes, args)
            _wish(wishes, LIMITS, kind=kind, **args)


def _spare(found: Slots, wishes: Wishes, args: Mapping[str, Any]) -> None:
    """Let what is usual in a quarter bind its houses alone where a kind is asked to be higher."""
    usual = wishes.get(LIMITS, {})
    told = any(key.startswith(("building.floors", "building.height")) for key in found)
    if not told and args.get("least_floors", 0) > usual.get("most_floors", MOST_FLOORS):
        _wish(wishes, LIMITS, kind="house", **wishes.pop(LIMITS))


def _bounds(
    found: Slots, key: str, least: str, most: str, as_type: Callable[[Any], Any]
) -> dict[str, Any]:
    """Return the least and the greatest value of a slot, each where it is said."""
    exact = found.get(key, (None,))[0]
    ends = {least: found.get(f"{key}.min", (exact,))[0], most: found.get(f"{key}.max", (exact,))[0]}
    numbers = {name: v for name, v in ends.items() if v is not None and not isinstance(v, str)}
    return {name: as_type(value) for name, value in numbers.items()}


def _kinds(found: Slots, town: dict[str, Any], wishes: Wishes) -> None:
    """Let a town be of the buildings that most of it shall be."""
    kinds = {str(word) for word in found.get("building.type", ())}
    if not kinds or "source" in found:
        return
    if len(kinds) > 1:
        _mixed(found, sorted(kinds), town, wishes)
        return
    kind = kinds.pop()
    if kind in _counted_kinds(found) and kind not in DWELLINGS:
        return  # they stand among others
    if kind in ZONE_OF_KIND and not {"district", "density"} & found.keys():
        count = _bounds(found, "building.count", "least", "most", int).get("least", 0)
        area = town.get("width", USUAL) * town.get("depth", USUAL)
        close = ZONE_OF_KIND[kind] == "suburb" and count and zone_for(count, area) == "row"
        town.setdefault("zone", "row" if close else ZONE_OF_KIND[kind])
    elif kind in USE_OF_KIND and not any(key.startswith(f"{kind}.share") for key in found):
        _use_share(wishes, USE_OF_KIND[kind], least=MOSTLY)


def _mixed(found: Slots, kinds: list[str], town: dict[str, Any], wishes: Wishes) -> None:
    """Let a town be of several kinds of buildings, of each a part."""
    counted = _counted_kinds(found)
    zones = [ZONE_OF_KIND[kind] for kind in kinds if kind in ZONE_OF_KIND]
    # Where houses are counted lots are small; blocks of flats find room on some of them.
    zones.sort(key=lambda zone: zone != "suburb" if counted else 0)
    if zones and not {"district", "density"} & found.keys():
        town.setdefault("zone", zones[0])
    for kind in kinds:
        told = any(key.startswith((f"{kind}.share", f"{kind}.count")) for key in found)
        if kind in USE_OF_KIND and not told and kind not in counted:
            _use_share(wishes, USE_OF_KIND[kind], least=min(PART, 1.0 / len(kinds)) + MARGIN)


def _use_share(wishes: Wishes, use: str, **args: float) -> None:
    """Call for a share of the buildings of a use; each use is a wish of its own."""
    wishes.setdefault(f"layout/use_share-v1#{use}", {"use": use}).update(args)


def _shares(found: Slots, town: dict[str, Any], wishes: Wishes) -> None:
    """Shares of uses among the buildings, and of green and built land."""
    for kind, use in USE_OF_KIND.items():
        args = _bounds(found, f"{kind}.share", "least", "most", float)
        if args:
            _use_share(wishes, use, **args)
    if _is_wanted(found, "courtyard"):
        town.setdefault("zone", "midrise")  # closed blocks
    house = found.get("house.share", found.get("house.share.min", (0.0,)))[0]
    if float(house) >= MANY_HOUSES:
        town.setdefault("zone", ZONE_OF_KIND["house"])
    green = _bounds(found, "green.share", "share", "most", float)
    if green:
        _wish(wishes, "layout/green_share-v1", **{"share": 0.0, **green})
    built = _bounds(found, "building.share", "least", "most", float)
    if built:
        _wish(wishes, "layout/cover-v1", **built)


def _counts(found: Slots, town: dict[str, Any], wishes: Wishes) -> None:
    args = _bounds(found, "building.count", "least", "most", int)
    if "building" in map(str, found.get("not", ())):
        args = {"least": 0, "most": 0}
    if "layout/towers-v1" in wishes:
        return
    kind = str(found.get("building.type", ("",))[0])
    if args and kind in TOWERS:
        _counted_towers(found, wishes, "building", kind, args)
        return
    kinds = _counted_kinds(found)
    for name in (name for name in COUNTED_KINDS if name in kinds):
        more = [kinds[one] for one in HOUSES if one in kinds and name == "house"]
        ends = {end: number + sum(one.get(end, 0) for one in more)
                for end, number in kinds[name].items()}  # fmt: skip
        _wish(wishes, KIND_COUNT, kind=name, **ends)
    if args and kind in COUNTED_KINDS:
        args = {}  # "20 houses and a church" are 21 buildings
    elif args and "building.type" in found:
        args = {end: number + _landmarks(found) for end, number in args.items()}
    args = args or _counts_of_kinds(found, wishes, kinds)
    if not args or (args.keys() == {"least"} and args["least"] <= SEVERAL):
        return
    exact = args.get("least") == args.get("most")
    apart = any(part == "garage" for _, part in _parts_named(found))
    told: dict[str, Any] = {"with_sheds": False} if apart else {}
    told |= {"count": args["least"]} if exact else args
    _wish(wishes, "layout/buildings_count-v1", **told)
    if "least" in args:
        town.setdefault("plazas", 0.0)
        town.setdefault("parks", 0.0)
        if {"width", "depth"} <= town.keys():
            town.setdefault("pattern", "grid")
            town.setdefault("zone", zone_for(args["least"], town["width"] * town["depth"]))


def _landmarks(found: Slots) -> int:
    """Return how many churches, schools... stand among the buildings that are counted."""
    named = [name for name, one in ELEMENTS.items() if one.building]
    named = [name for name in named if name not in found.get("building.type", ())]
    return sum(
        int(found[f"{name}.count"][0]) if f"{name}.count" in found
        else int(found.get(f"{name}.count.min", (int(name in found.get("element", ())),))[0])
        for name in named
    )  # fmt: skip


def _counted_towers(
    found: Slots, wishes: Wishes, base: str, kind: str, args: dict[str, Any]
) -> None:
    """Build towers among other buildings, and lower those that are too many."""
    if "least" in args:
        low, high = (found.get(f"{base}.height.{end}", (None,))[0] for end in ("min", "max"))
        low = float(low or TOWERS[kind])
        _wish(
            wishes, "layout/towers-v1", count=args["least"], around="nothing",
            lowest=low * (1 + MARGIN), highest=float(high or low * TALLER) * (1 - MARGIN),
        )  # fmt: skip
    if "most" in args:
        _wish(wishes, "layout/buildings_count-v1", kind="tower", most=args["most"])


def _counted_kinds(found: Slots) -> Wishes:
    """Return how many there are to be of each kind of buildings that is counted.

    Of kinds that nobody counts beside dwellings that are counted there are some.
    """
    counted = {
        kind: _bounds(found, f"{kind}.count", "least", "most", int) for kind in COUNTED_KINDS
    }
    types = [str(word) for word in found.get("building.type", ())]
    if len(types) == 1 and types[0] in COUNTED_KINDS:
        counted[types[0]] |= _bounds(found, "building.count", "least", "most", int)
    counted = {kind: _amid(ends) for kind, ends in counted.items() if ends}
    if not counted.keys() & set(DWELLINGS):
        return counted
    return {kind: {"least": _some(counted)} for kind in types if kind in COUNTED_KINDS} | counted


def _some(counted: Wishes) -> int:
    """Return how many there are of a kind that nobody counts beside others."""
    return max(SOME_OF_A_KIND, _least(counted.values()) // 10)


def _least(counted: Iterable[Mapping[str, Any]]) -> int:
    """Return how many buildings there are at least of kinds that are counted."""
    return sum(int(ends.get("least", 0)) for ends in counted)


def _amid(ends: dict[str, Any]) -> dict[str, Any]:
    """Return bounds, the lower one amid both: of "three to seven" there are five at least."""
    if ends.keys() == {"least", "most"}:
        least, most = ends["least"], ends["most"]
        return {"least": (least + most + 1) // 2, "most": most}
    return ends


def _counts_of_kinds(found: Slots, wishes: Wishes, kinds: Wishes) -> dict[str, Any]:
    """Return how many buildings there are where every kind is counted, dwellings among them."""
    counted = {**kinds}
    for kind in TOWERS:
        ends = _bounds(found, f"{kind}.count", "least", "most", int)
        _counted_towers(found, wishes, kind, kind, ends)
        counted |= {kind: ends} if ends else {}
    others = {str(word) for word in found.get("building.type", ())} - counted.keys()
    if others - ELEMENTS.keys() or not any(kind in counted for kind in DWELLINGS):
        return {}  # they stand among others
    placed = {key.partition(".")[0] for key in found if key.endswith((".by", ".part"))}
    apart = len((placed & KINDS.keys()) - counted.keys())
    more = _landmarks(found) + apart * (_least(counted.values()) // 2)
    bounded = [one for one in counted.values() if "most" in one]
    if not all("least" in one for one in counted.values()):
        most = {"most": sum(int(one["most"]) for one in bounded) + more}
        return most if len(bounded) == len(counted) else {}
    number = _least(counted.values()) + more
    return {"least": number, **({"most": number} if bounded else {})}


def _places(found: Slots, town: dict[str, Any], wishes: Wishes) -> None:
    """Plazas, parks and lakes: how many, the first square in the middle."""
    del town
    elements = set(found.get("element", ()))
    if {"park", "lake"} <= elements:
        share = found.get("park.share.min", found.get("green.share.min", (None,)))[0]
        _wish(wishes, "layout/central_park-v1", **({} if share is None else {"share": share}))
        elements -= {"park", "lake"}
    denied = {str(word) for word in found.get("not", ())}
    if "pond" in elements or any(key.startswith("pond.count") for key in found):
        wanted = _bounds(found, "pond.count", "least", "most", int).get("least", 1)
        side = found.get("pond.side", ("any",))[0]
        placed = {"side": side} if side in OPPOSITE else {}
        if wanted:
            _wish(wishes, "layout/ponds-v1", least=wanted, **placed)
            elements |= set() if any(key.startswith("park.") for key in found) else {"park"}
    for kind in ("plaza", "park", "lake"):
        ends = _bounds(found, f"{kind}.count", "least", "most", int)
        none_or_one = 0 if kind in denied else 1 if kind in elements else None
        count = next(iter(ends.values()), none_or_one)
        if count is not None:
            middle = kind == "plaza" or "middle" in found.get(f"{kind}.side", ())
            more: dict[str, Any] = {"central": True} if middle else {}
            more |= _lakes(found, kind) if kind == "lake" and count else {}
            area = _within(found, f"{kind}.area")
            more |= {"area": area} if area is not None and count else {}
            _wish(wishes, "layout/places-v1", kind=kind, count=count, **more)


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
    count = _within(found, "island.count")
    return round(count) if count else 1


def _water_of_islands(found: Slots) -> str:
    """Return the water that islands lie in: lake, river, or sea where the town is one; "" for none.

    Where the words do not say it is the water that is asked for, or the sea.
    """
    if not _is_wanted(found, "island"):
        return ""
    said = str(found.get("island.near", ("",))[0])
    waters = [kind for kind in ("lake", "river") if kind in found.get("element", ())]
    return said or (waters[0] if waters else "sea")


def _wanted(found: Slots, kind: str) -> dict[str, Any] | None:
    """Return the least and the greatest number of a kind of thing, None where it is not asked."""
    args = _bounds(found, f"{kind}.count", "least", "most", int)
    if kind in map(str, found.get("not", ())):
        return {"least": 0, "most": 0}
    if kind in map(str, found.get("element", ())) or "least" in args:
        args.setdefault("least", 1)
    elif "most" in args:
        args["least"] = 0
    else:
        return None
    return args


def _elements(found: Slots, town: dict[str, Any], wishes: Wishes) -> None:
    """Churches, schools, playgrounds...: how many, none, where, and to what they stand near."""
    del town
    named = {str(word) for word in found.get("element", ())}
    denied = {str(word) for word in found.get("not", ())}
    for kind in sorted(ELEMENTS, key=_order_of(found)):
        parts = _parts_of(found, kind, named, denied)
        args = _wanted(found, kind)
        if kind == "pier" and args is None and _is_a_port(found):
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
                placed["side"] = _side_of_land(found, rise)
                if placed["side"] == "middle" and "plaza" not in named:
                    wishes.get("layout/places-v1#plaza", {}).pop("central", None)
            for end, name in ((".min", "nearest"), (".max", "farthest")):
                if f"{kind}.metres{end}" in found:
                    placed[name] = found[f"{kind}.metres{end}"][0]
            if not ELEMENTS[kind].is_thing:
                placed |= _sides_of(found, kind)
            args |= {**placed, **parts}
        _wish(wishes, "layout/elements-v1", kind=kind, **args)


def _sides_of(
    found: Slots, kind: str, names: Sequence[str] = ("length", "width")
) -> dict[str, Any]:
    """Return how high, long or wide a thing is to be, in metres, within the bounds that are told.

    What it cannot be is left out.
    """
    told: dict[str, Any] = {}
    for name in names:
        own = name in attributes_of(kind)
        value = _within(found, f"{kind}.{name}") if own else None
        if value is not None:
            told[name] = value
    return told


def _dressed(found: Slots, town: dict[str, Any], wishes: Wishes) -> None:
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


def _enclosed(found: Slots, town: dict[str, Any], wishes: Wishes) -> None:
    """Tell what goes round elements."""
    del town
    for kind in (*ELEMENTS, *PLACES):
        for barrier in found.get(f"{kind}.enclosed", ()):
            args: dict[str, Any] = {"kind": kind, "barrier": BARRIERS[str(barrier)]}
            height = _within(found, f"{barrier}.height")
            args |= {} if height is None else {"height": height}
            wishes[f"edit/ring-v1#{kind}/{barrier}"] = args


def _plots(found: Slots, town: dict[str, Any], wishes: Wishes) -> None:
    """Let houses stand alone, in pairs or in rows, with gardens and drives, as they are told to."""
    del wishes
    if "source" in found:
        return
    walls = {str(word) for kind in DWELLINGS for word in found.get(f"{kind}.walls", ())}
    plots = [(host, part) for host, part in _parts_named(found) if PART_KINDS[part].plot]
    if walls == {"semi"}:
        town["zone"] = "semi"
    elif walls == {"detached"} and town.get("zone") not in ("suburb", "rural"):
        town["zone"] = "suburb"
    elif plots and town.get("zone") not in ("suburb", "semi", "row", "rural"):
        rows = "terrace" in found.get("building.type", ())
        town["zone"] = "row" if rows else "suburb"
    roomy = any(part != "garden" or any(key.startswith(f"{host}.garden.area") for key in found)
                for host, part in plots)  # fmt: skip
    if roomy and town.get("zone") in ("suburb", "semi"):
        town["density"] = 0.0


def _parts_named(found: Slots) -> list[tuple[str, str]]:
    """Return the kinds of buildings with the parts that are said of each."""
    return list(dict.fromkeys(
        (key.split(".")[0], key.split(".")[1]) for key in found if is_of_a_part(key)
    ))  # fmt: skip


def _added_parts(found: Slots, town: dict[str, Any], wishes: Wishes) -> None:
    """Clocks, balconies, awnings... of finished buildings of a kind, and their colours."""
    del town
    for host, part in _parts_named(found):
        key, kind = f"{host}.{part}", PART_KINDS[part]
        if not kind.added or _bounds(found, f"{key}.count", "least", "most", int).get("most") == 0:
            continue
        args: dict[str, Any] = {"part": kind.added, "kind": host}
        shade = COLORS.get(NAMED_COLORS.get(str(found.get(f"{key}.color", ("",))[0]), ""))
        if shade and not kind.body:
            from cityx.assets.styles.materials import srgb_to_linear  # with textures

            args["tint"] = srgb_to_linear(shade[0])
        wishes[f"edit/add_parts-v1#{key}"] = args


def _side_of_land(found: Slots, rise: str) -> str:
    """Return the side of a site, its middle or its edge, where the land is high or low."""
    form = str(found.get("terrain", ("hill",))[0])
    if form in ("slope", "terraces"):
        shore = next((str(found[key][0]) for key in ("sea.side", "beach.side") if key in found), "")
        up = str(found.get("terrain.side", (OPPOSITE.get(shore, "north"),))[0])
        return up if rise == "high" else OPPOSITE.get(up, "south")
    return "middle" if (rise == "high") == (form != "valley") else "edge"


def _host_parts(found: Slots, town: dict[str, Any], wishes: Wishes) -> None:
    """Towers, domes, chimneys of buildings of a kind: how many, how high, how they look."""
    del town
    for host, part in _parts_named(found):
        key, kind = f"{host}.{part}", PART_KINDS[part]
        ends = _bounds(found, f"{key}.count", "least", "most", int)
        if kind.body:
            color = NAMED_COLORS.get(str(found.get(f"{key}.color", ("",))[0]), "")
            args: dict[str, Any] = {"kind": host, "part": part, "least": 1, **ends}
            args["least"] = min(args["least"], args.get("most", args["least"]))
            height = _within(found, f"{key}.height")
            material = MATERIALS.get(str(found.get(f"{key}.material", ("",))[0]), "")
            told = (("height", height), ("color", color), ("material", material))
            args |= {name: value for name, value in told if value}
            wishes[f"layout/host_parts-v1#{key}"] = args


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


def _quarters(found: Slots, town: dict[str, Any], wishes: Wishes) -> None:
    """Tell what most buildings are in parts of the town, and along what lies in it."""
    del town
    for kind in KINDS:
        for key, name in (("part", "part"), ("by", "near")):
            for value in found.get(f"{kind}.{key}", ()):
                args: dict[str, Any] = {"kind": kind, name: str(value)}
                side, place = side_and_place(str(value))
                if side:
                    args |= {"near": place, "side": side, "within": reach_of(str(value))}
                others = [one for one in KINDS if value in found.get(f"{one}.{key}", ())]
                if len(others) > 1:
                    share = 1.0 / len(others)
                    args |= {"share": share, "begin": others.index(kind) * share}
                wishes[f"layout/quarter-v1#{kind}/{key}/{value}"] = args


def _groups(found: Slots, town: dict[str, Any], wishes: Wishes) -> None:
    """Tell how many buildings of a kind stand in one place, or are added, and how high they are.

    Of a map what stands is kept, and its number with it.
    """
    del town
    mapped = any(source in LAYOUTS for source in found.get("source", ()))
    for subject in dict.fromkeys(key.partition(".")[0] for key in found):
        group = group_of(subject)
        if group is None:
            continue
        kept = mapped and not group.added
        args = {} if kept else _bounds(found, f"{subject}.count", "least", "most", int)
        args |= _bounds(found, f"{subject}.floors", "least_floors", "most_floors", int)
        args |= _bounds(found, f"{subject}.height", "lowest", "highest", float)
        if not args:
            continue
        _spare(found, wishes, args)
        told = {"kind": group.kind, "part": group.part, "near": group.near, "added": group.added}
        said = {name: value for name, value in told.items() if value}
        said |= {"within": group.within} if group.near else {}
        wishes[f"{GROUP}#{subject}"] = {**said, **args}
    for kind in sorted(quarters_named(found)):
        _spare(found, wishes, {"least_floors": KINDS[kind].floors[0]})


def _tree_rows(found: Slots, town: dict[str, Any], wishes: Wishes) -> None:
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


def _water(found: Slots, town: dict[str, Any], wishes: Wishes) -> None:
    del town
    elements = set(found.get("element", ()))
    islands = _water_of_islands(found)
    in_sea = islands == "sea"
    for kind in ("river", "canal"):
        asked = any(key.startswith(f"{kind}.") for key in found)
        bridged = kind == "river" and any(key.startswith("bridge.count") for key in found)
        bridged |= kind == "river" and _is_wanted(found, "closed_bridge")
        bridged = (bridged and not in_sea) or (kind == "river" and islands == "river")
        if kind in elements or asked or (bridged and "canal" not in elements):
            _flowing(found, wishes, kind)
    placed = (f"{kind}.side" for kind in ("beach", "sea", "harbour", *AT_SEA))
    side = next((found[key] for key in placed if found.get(key, ("",))[0] in OPPOSITE), ())
    side = ("all",) if in_sea else side
    if {"beach", "sea", "harbour"} & elements or "beach.side" in found or "sea.side" in found:
        _wish(wishes, COAST, **({"side": side[0]} if side else {}))
    if in_sea:
        beach = BEACH if "beach" in elements else 0.0
        _wish(wishes, COAST, side="all", share=ISLAND_SEA, beach=beach)
        wishes.pop("layout/ring_road-v1", None)  # the promenade is one
    sand = _within(found, "beach.width")
    if sand is not None:
        _wish(wishes, COAST, beach=sand)
    port = _is_a_port(found)
    set_out = {kind for kind in AT_SEA[:2] if _is_wanted(found, kind)}
    wet = {"river", "canal", "lake", "pond", "sea", "beach"} & elements
    if port or (set_out and not wet):
        _wish(wishes, COAST, quay=QUAY, **({"side": side[0]} if side else {}))


def _is_a_port(found: Slots) -> bool:
    """Return whether a harbour is asked for, which has a quay and a pier."""
    return "harbour" in found.get("element", ()) or "harbour" in found.get("district", ())


def _is_wanted(found: Slots, kind: str) -> bool:
    """Return whether at least one of something is asked for."""
    counts = [found.get(f"{kind}.count{end}", (0,))[0] for end in ("", ".min")]
    return kind in found.get("element", ()) or any(int(count) > 0 for count in counts)


def _flowing(found: Slots, wishes: Wishes, kind: str) -> None:
    """Ask for rivers or canals: how many, how wide, where, and under how many bridges."""
    args: dict[str, Any] = {} if kind == "river" else {"kind": kind, "width": CANAL}
    width = _within(found, f"{kind}.width")
    words = found.get(f"{kind}.width", ())
    if words and isinstance(words[0], str):
        width = WIDE_RIVER if words[0] == "wide" else NARROW_RIVER
    if width is not None:
        args["width"] = width
    if "river.meet" in found and kind == "river":
        args |= {"meet": True, "count": int(found["river.meet"][0])}
    else:
        count = _within(found, f"{kind}.count")
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
    bridges = _within(found, "bridge.count")
    if bridges is not None:
        args["bridges"] = round(bridges)
    elif args.get("count", 1) > 1:
        args["bridges"] = BRIDGES * args["count"]
    closed = (_wanted(found, "closed_bridge") or {}).get("least", 0)
    if bridges is None and closed > BRIDGES:
        args["bridges"] = max(closed, args.get("bridges", 0))
    key = f"layout/river-v1#{kind}" if kind == "canal" else "layout/river-v1"
    wishes.setdefault(key, {}).update(args)


def _terrain(found: Found, town: dict[str, Any], wishes: Wishes) -> None:
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
        value = _within(found, key)
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
    _wish(wishes, RELIEF, **args)


def _within(found: Slots, key: str) -> float | None:
    """Return a number as a slot says it, or one that keeps its bounds, None where it says none."""
    if key in found:
        return None if isinstance(found[key][0], str) else float(found[key][0])
    low, high = (found.get(f"{key}.{end}", (None,))[0] for end in ("min", "max"))
    if low is not None and high is not None:
        return (float(low) + float(high)) / 2
    clear = 0.0 if key.endswith(".count") else CLEAR
    if low is not None:
        return float(low) * (1 + clear)
    return None if high is None else float(high) * (1 - clear)


def _highest(found: Slots, town: dict[str, Any], wishes: Wishes) -> None:
    """Make the highest building as high as is said of it."""
    del town
    height = _within(found, "height.highest")
    if height is not None:
        _wish(wishes, "layout/highest-v1", height=height)


def _floor_area(found: Slots, town: dict[str, Any], wishes: Wishes) -> None:
    """For how many people the town is, how much floor it has, how high it is on average."""
    args = {
        name: value
        for name, key in (
            ("people", "population"), ("ratio", "plot.ratio"), ("floors", "floors.mean"),
            ("height", "height.mean"),
        )
        if (value := _within(found, key)) is not None
    }  # fmt: skip
    if not args:
        return
    _wish(wishes, "layout/floor_area-v1", **args)
    if "people" not in args or {"width", "depth"} & town.keys() or "source" in found:
        return
    zone = str(town.setdefault("zone", "midrise"))
    if zone in PEOPLE:
        floors = _within(found, "building.floors") or PEOPLE[zone][1]
        hectares = args["people"] / (PEOPLE[zone][0] * floors / PEOPLE[zone][1])
        side = min(max(100.0 * sqrt(SPARE * hectares), SMALLEST_TOWN), LARGEST_TOWN)
        town |= dict.fromkeys(("width", "depth"), round(side))


def _streets(found: Slots, town: dict[str, Any], wishes: Wishes) -> None:
    given = {
        name: found[key][0]
        for name, key in (
            ("lanes", "roads.main.lanes"), ("axis", "roads.main.axis"),
            ("others", "roads.other.lanes"),
        )
        if key in found
    }  # fmt: skip
    length = _number(found, "roads.main.length", MARGIN)
    if length is not None:
        along = "width" if given.get("axis") == "east_west" else "depth"
        town.setdefault(along, length)
        town.setdefault("width" if along == "depth" else "depth", BESIDE_AVENUE)
        given["length"] = length
    if "median" in found.get("element", ()):
        given["median"] = MEDIAN
    if given:
        _wish(wishes, "layout/boulevard-v1", **given)
    if "roads.motorways" in found or any(key.startswith("roads.motorway.") for key in found):
        motorway = {
            name: found[f"roads.motorway.{name}"][0]
            for name in ("lanes", "axis")
            if f"roads.motorway.{name}" in found
        }
        _wish(wishes, "layout/motorway-v1", **motorway)
    for of, keys in (("main", ("roads", "roads.main")), ("local", ("roads", "roads.other"))):
        for key in keys:
            town |= _bounds(found, f"{key}.width", f"{of}_least", f"{of}_most", float)
            if key == "roads" or not given:  # the others are those of a boulevard
                names = f"{of}_least_lanes", f"{of}_most_lanes"
                town |= _bounds(found, f"{key}.lanes", *names, int)
    spokes = {
        name: int(found[key][0])
        for name, key in (("avenues", "roads.avenues"), ("rings", "roads.rings"))
        if key in found
    }
    if spokes:
        town |= {"pattern": "radial", **spokes}


def _blocks(found: Slots, town: dict[str, Any], wishes: Wishes) -> None:
    """Say how many, how large and how turned the blocks between streets are."""
    del wishes
    count = next((found[k][0] for k in ("block.count", "block.count.min") if k in found), None)
    grid: dict[str, Any] = {} if count is None else {"blocks": int(count)}
    for key, name in (("block.columns", "columns"), ("block.rows", "rows")):
        if key in found:
            grid[name] = int(found[key][0])
    for key, name in (("block.length", "block_width"), ("block.width", "block_depth")):
        for end in ("", ".min", ".max"):
            if f"{key}{end}" in found:
                grid[name] = float(found[f"{key}{end}"][0])
    if "roads.turn" in found:
        grid["turn_deg"] = float(found["roads.turn"][0])
    if not grid:
        return
    sized = {"width", "depth"} & town.keys() or "size" in found
    numbered = {"blocks", "columns"} & grid.keys()
    town |= {**grid, "fitted": bool(numbered and not sized)}
    if not set(map(str, found.get("roads.pattern", ()))) - {"grid"}:
        town["pattern"] = "grid"


def _street_design(found: Slots, town: dict[str, Any], wishes: Wishes) -> None:
    """How streets are made: their speed, surface, walks, cycle lanes, and which are one-way."""
    del town
    design = "layout/street_design-v1"
    for key, kind in (("roads", "all"), ("roads.main", "main"), ("roads.other", "other")):
        if f"{key}.surface" in found:
            _wish(wishes, design, kind=kind, surface=found[f"{key}.surface"][0])
        if f"{key}.oneway" in found:
            wishes[f"{design}#{kind}/oneway"] = {"kind": kind, "oneway": True}
    speed = _number(found, "roads.speed")
    if speed is not None:
        _wish(wishes, design, kind="all", speed_kmh=round(speed * 3.6, 1))
    walk = _number(found, "sidewalk.width", MARGIN)
    words = {"wide": WIDE_WALK, "narrow": NARROW_WALK}
    for said in found.get("sidewalk.width", ()):
        walk = words.get(str(said), walk)
    if walk is not None:
        _wish(wishes, design, kind="all", walk=float(walk))
    share = _number(found, "oneway.share", MARGIN)
    if share is not None:
        wishes[f"{design}#all/oneway"] = {"kind": "all", "oneway": True, "share": float(share)}
    _cycling(found, wishes)


def _cycling(found: Slots, wishes: Wishes) -> None:
    """Lanes and tracks for cycles: on a share of the streets, on main ones, or on none."""
    design = "layout/street_design-v1"
    for noun, word in (("cycleway", "lane"), ("cycle_track", "track")):
        shares = {
            kind: _number(found, f"{noun}{part}.share", MARGIN)
            for part, kind in (("", "all"), (".main", "main"), (".other", "other"))
        }
        for kind, share in shares.items():
            if share is not None:
                args = {"kind": kind, "cycling": word, "share": min(float(share), 1.0)}
                wishes[f"{design}#{kind}/{noun}"] = args
        if noun in found.get("element", ()) and not any(s is not None for s in shares.values()):
            wishes[f"{design}#main/{noun}"] = {"kind": "main", "cycling": word}
        if noun in found.get("not", ()):
            wishes[f"{design}#all/{noun}"] = {"kind": "all", "cycling": "none"}


def _steps(found: Slots, town: dict[str, Any], wishes: Wishes) -> None:
    """Streets of steps, with ramps beside them; where nothing is said of the land it slopes."""
    del town
    args, ramps = _wanted(found, "steps"), _wanted(found, "ramp")
    if args is None and ramps is None:
        return
    args = args or {"least": 0}
    if ramps is not None:
        args["ramps"] = ramps["least"]
        args["least"] = max(args["least"], ramps["least"])
    side = {"side": found["steps.side"][0]} if "steps.side" in found else {}
    _wish(wishes, "road/steps-v1", **args, **side)
    told = "terrain" in found or any(key.startswith("terrain.") for key in found)
    if args["least"] and not told and "height_field" not in found.get("source", ()):
        _wish(wishes, RELIEF, form="slope", grade=STEPPED)


def _number(found: Slots, key: str, margin: float = 0.0) -> float | None:
    """Return the number asked for, or a bound kept clear of by a margin."""
    for end, sign in (("", 0.0), (".min", 1.0), (".max", -1.0)):
        for value in found.get(f"{key}{end}", ()):
            if not isinstance(value, str):
                return float(value) * (1 + sign * margin)
    return None


def _street_elements(found: Slots, town: dict[str, Any], wishes: Wishes) -> None:
    """Roundabouts, signalled junctions, dead ends, streets without cars."""
    del town
    for kind in ("roundabout", "pedestrian_zone", "road_works", "dead_end", "signalled_junction"):
        args = _wanted(found, kind)
        if args is not None:
            side = {"side": found[f"{kind}.side"][0]} if f"{kind}.side" in found else {}
            _wish(wishes, "layout/street_elements-v1", kind=kind, **args, **side)
    for kind in ("closed_bridge", "scaffold"):
        args = _wanted(found, kind)
        if args is not None:
            side = {"side": found[f"{kind}.side"][0]} if f"{kind}.side" in found else {}
            _wish(wishes, "layout/obstacles-v1", kind=kind, **args, **side)
    for kind in ("streetlight", "bench"):
        spacing = _number(found, f"{kind}.spacing", MARGIN)
        if spacing is not None:
            _wish(wishes, "layout/street_rows-v1", kind=kind, spacing=spacing)


def _gradients(found: Slots, town: dict[str, Any], wishes: Wishes) -> None:
    """Where the city rises, and where it is densest."""
    del town
    limits = wishes.get("layout/building_limits-v1", {})
    floors = {name: n for name, n in limits.items() if name in ("least_floors", "most_floors")}
    for towards in found.get("building.gradient", ()):
        _wish(wishes, "layout/height_gradient-v1", towards=towards, **floors)
    for towards in found.get("density.gradient", ()):
        _wish(wishes, "layout/density_gradient-v1", towards=towards)


def _trees(found: dict[str, tuple[Any, ...]], town: dict[str, Any], wishes: Wishes) -> None:
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
    counted = _bounds(found, "tree.count", "least", "most", int)
    apart = _bounds(found, "nature.spacing", "least_apart", "most_apart", float)
    found |= {f"trees.{name}": (value,) for name, value in (counted | apart).items()}
    for key, name in (
        ("nature.species", "species"), ("nature.species.streets", "street_species"),
        ("nature.species.parks", "park_species"),
    ):  # fmt: skip
        if len(found.get(key, ())) == 1:  # of several none can be that of all trees
            found[f"trees.{name}"] = found[key]


def _air(found: dict[str, tuple[Any, ...]], town: dict[str, Any], wishes: Wishes) -> None:
    """Return how strong the weather is, the clock of a word for a time, the day of a season."""
    del town, wishes
    for word in found.get("weather", ()):
        for strength in found.get(f"{word}.intensity", ()):
            if str(strength) in STRENGTHS:
                found["weather.strength"] = (STRENGTHS[str(strength)],)
    for word in found.get("time", ()):
        if word in CLOCKS:
            found["sun.time"] = (CLOCKS[str(word)],)
        if word in ("sunset", "sunrise"):
            found["sun.date"] = (LATE_SUMMER,)
    _conditions(found)
    for season in found.get("season", ()):
        if season in SEASONS:
            found |= {"sun.date": (SEASONS[str(season)][0],), "trees.season": (season,)}
    if "date" in found:
        found["sun.date"] = found["date"]


def _conditions(found: Found) -> None:
    """Return single numbers of the air, by the names of `cityx.light.conditions`."""
    for key, name, words in _CONDITIONS:
        value = _within(found, key)
        word = str(found.get(key, ("",))[0])
        if value is not None:
            found[f"air.{name}"] = (value,)
        elif word in words:
            found[f"air.{name}"] = (words[word],)
    if "wind.from" in found:
        found["air.wind_from"] = found["wind.from"]
        found.setdefault("air.wind", (WINDS["medium"],))
    if "sun.side" in found:
        found["sun.towards"] = found["sun.side"]
    if "sun.height" in found:
        found["sun.low"] = (True,)


def air_slots(change: Iterable[tuple[str, Any]]) -> Found:
    """Return the strength of the weather and the clock that a change of a city asks for."""
    found: Found = {}
    for key, value in change:
        found[key] = (*found.get(key, ()), value)
    clocks = tuple(CLOCKS.get(str(word), word) for word in found.get("time", ()))
    said = dict(found)
    _air(said, {}, {})
    strength = {key: value for key, value in said.items()
                if key == "weather.strength" or key.startswith(("air.", "sun."))}  # fmt: skip
    return {**strength, **({"time": clocks} if clocks else {})}


def _life(found: Found, town: dict[str, Any], wishes: Wishes) -> None:
    """Who is about and what drives by kinds, the shares of kinds in traffic, and parked cars."""
    del town
    denied = set(map(str, found.get("not", ())))
    for kind in MIXED:
        share = _within(found, f"{kind}.share")
        if share is not None:
            found[f"{kind}.share"] = (min(share, 1.0),)
            found.setdefault("traffic", ("medium",))
        elif kind in denied and "traffic" in found:
            found[f"{kind}.share"] = (0.0,)
    if "parked_vehicle" in denied:
        found |= {"parked_cars.occupancy": (0.0,), "parked_cars.lots": (0.0,)}
    for part in found.get("building.feature", ()):
        if part in ADDED:
            wishes[f"edit/add_parts-v1#{part}"] = {"part": part}
    for kind in KINDS_OF_PEOPLE:
        share = _within(found, f"{kind}.share")
        if share is not None:
            found[f"{kind}.share"] = (min(share, 1.0),)
    for kind in (*KINDS_OF_PEOPLE, *ROLES, "man", "woman"):
        count = _numbered(found, kind, FEW_PEOPLE)
        if count and kind not in denied and f"{kind}.share" not in found:
            doing = "run" if kind == "runner" else "stand" if kind in ROLES else "walk"
            wishes[f"{GATHERING}#{kind}"] = {
                "who": kind, "count": count, "doing": doing, **_how(found, kind)
            }  # fmt: skip
    for kind in (*MIXED, *SERVICES):
        count = _numbered(found, kind, 1 if kind in SERVICES else FEW_VEHICLES)
        if count and kind not in denied and f"{kind}.share" not in found:
            wishes[f"{FLOW}#{kind}"] = {"kind": kind, "count": count, **_how(found, kind)}
            if f"{kind}.count" in found and "traffic" in found and kind in MIXED:
                found[f"{kind}.share"] = (0.0,)  # those that are counted are all there are


def _how(found: Slots, kind: str) -> dict[str, Any]:
    """Return how fast a kind of people or vehicles goes, and what people have on."""
    told: dict[str, Any] = {}
    if (speed := _within(found, f"{kind}.speed")) is not None:
        told["speed"] = speed
    if wears := found.get(f"{kind}.wears"):
        told["wears"] = wears[0]
    return told


def _numbered(found: Slots, kind: str, usual: int) -> int:
    """Return how many of a kind of people or vehicles are asked for, 0 for none."""
    count = _within(found, f"{kind}.count")
    if count is not None:
        return round(count)
    return usual if kind in map(str, found.get("agent", ())) else 0


def _outside(found: Slots, town: dict[str, Any], wishes: Wishes) -> None:
    """Let the generator of an installed package raise the buildings that are to be of its kind."""
    del town
    if not brings_buildings():
        return
    # With libraries that a reader need not load.
    from cityx.assets.styles.package_generators import outside_buildings

    for word in found.get("building.type", ()):
        made = outside_buildings().get(str(word))
        if made is not None:
            _wish(wishes, made.action)


_RULES: tuple[Callable[[Found, dict[str, Any], Wishes], None], ...] = (
    _size, _plots, _heights, _heights_of_kinds, _kinds, _shares, _counts, _places, _elements,
    _host_parts, _quarters, _groups, _tree_rows, _enclosed, _dressed,
    _water, _terrain, _floor_area, _highest, _streets, _street_design, _street_elements, _steps,
    _blocks, _gradients, _trees, _air, _life, _added_parts, _outside,
)  # fmt: skip
