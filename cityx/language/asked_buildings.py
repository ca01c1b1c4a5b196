"""Buildings that a brief asks for: kinds, numbers, heights, quarters, groups and their parts."""

from __future__ import annotations

import re
from collections.abc import Mapping
from math import sqrt
from types import MappingProxyType
from typing import Any

from cityx.checks.predicates.words import COLORS
from cityx.language import Slot
from cityx.language.asked_values import (
    LIMITS,
    Wishes,
    bounds,
    is_wanted,
    least,
    spare,
    wish,
    within,
)
from cityx.language.goals import (
    LAYOUTS,
    LOW_FLOORS,
    PART,
    TALL_FLOORS,
    is_of_a_part,
    quarters_named,
)
from cityx.language.here import SEVERAL
from cityx.language.measurable import COLORS as NAMED_COLORS
from cityx.language.measurable import MATERIALS
from cityx.language.syntax import is_plural
from cityx.protocol.serving import Slots
from cityx.town.building_groups import group_of
from cityx.town.elements import (
    ELEMENTS,
    side_and_place,
)
from cityx.town.part_kinds import PART_KINDS
from cityx.town.presets import zone_for
from cityx.town.quarter_kinds import (
    COUNTED_KINDS,
    DWELLINGS,
    HOUSES,
    KINDS,
    ZONE_OF_KIND,
    reach_of,
)

# Tall buildings that are counted by themselves -> metres, at least.
TOWERS: Mapping[str, float] = MappingProxyType(
    {"tower": 50.0, "skyscraper": 100.0, "high_rise": 35.0}
)
TALLER = 1.8  # times the least height, where no greatest is said
MARGIN = 0.02  # of a height, by which a bound is kept clear
TALL_TOWN = MappingProxyType({"zone": "core", "density": 1.0})
LOW = 11.5  # metres of buildings that are called low
KIND_COUNT, GROUP = "layout/kind_count-v1", "layout/building_group-v1"
# Storeys of kinds of buildings that are called so.
FLOORS_OF: Mapping[str, Mapping[str, int]] = MappingProxyType(
    {"tall": {"least_floors": TALL_FLOORS}, "low": {"most_floors": LOW_FLOORS}}
)
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
_ONE = re.compile(r"\b(?:an?|one|a single)(?: [\w-]+){0,2} $", re.IGNORECASE)


def is_one(text: str, slot: Slot) -> bool:
    """Return whether one person or vehicle of a kind is told of: "a man walking his dog"."""
    return bool(_ONE.search(text[: slot.span[0]])) and not is_plural(slot.text)


def heights(found: Slots, town: dict[str, Any], wishes: Wishes) -> None:
    """Bounds that hold for every building, unless they speak of towers."""
    for word in found.get("building.height", ()):
        if word == "tall":
            town |= TALL_TOWN
        elif word == "low":
            wish(wishes, LIMITS, highest=LOW)
    kind = next((str(word) for word in found.get("building.type", ()) if word in TOWERS), "")
    low, high = (found.get(f"building.height.{end}", (None,))[0] for end in ("min", "max"))
    if kind:
        town |= TALL_TOWN if not set(_counted_kinds(found)) & set(DWELLINGS) else {}
        _towers(found, wishes, low or TOWERS[kind], high)
    else:
        if low is not None:
            wish(wishes, LIMITS, lowest=float(low))
        if high is not None:
            wish(wishes, LIMITS, highest=float(high))
    exact = found.get("building.floors", (None,))[0]
    for end, name in (("min", "least_floors"), ("max", "most_floors")):
        floors = found.get(f"building.floors.{end}", (exact,))[0]
        if floors is not None and not isinstance(floors, str):
            wish(wishes, LIMITS, **{name: int(floors)})


def _towers(found: Slots, wishes: Wishes, low: float, high: float | None) -> None:
    """Towers that are counted stand alone; where they are not, the highest is as high as said."""
    if "building.count" not in found:
        if "building.height.min" in found:
            ends = {"lowest": float(low)} | ({} if high is None else {"highest": float(high)})
            wish(wishes, LIMITS, kind="tower", **ends)
        if high is not None:
            wish(wishes, "layout/highest-v1", height=float(high) * (1 - MARGIN))
        return
    around = next((w for w in ("plaza", "park") if w in found.get("element", ())), "nothing")
    top = float(high) if high is not None else low * TALLER
    wish(
        wishes, "layout/towers-v1", count=int(found["building.count"][0]), around=around,
        lowest=low * (1 + MARGIN), highest=top * (1 - MARGIN), alone=True,
    )  # fmt: skip


def heights_of_kinds(found: Slots, town: dict[str, Any], wishes: Wishes) -> None:
    """Bounds that hold for buildings of one kind: houses, shops, churches..."""
    del town
    for kind in LIMITED:
        args = bounds(found, f"{kind}.height", "lowest", "highest", float)
        args |= bounds(found, f"{kind}.floors", "least_floors", "most_floors", int)
        if "tallest" in found.get(f"{kind}.height", ()):
            wishes[f"layout/tallest-v1#{kind}"] = {"kind": kind}
        for word in found.get(f"{kind}.height", ()):
            args = {**FLOORS_OF.get(str(word), {}), **args}
        if args:
            spare(found, wishes, args)
            wish(wishes, LIMITS, kind=kind, **args)


def kinds(found: Slots, town: dict[str, Any], wishes: Wishes) -> None:
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
        count = bounds(found, "building.count", "least", "most", int).get("least", 0)
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


def shares(found: Slots, town: dict[str, Any], wishes: Wishes) -> None:
    """Shares of uses among the buildings, and of green and built land."""
    for kind, use in USE_OF_KIND.items():
        args = bounds(found, f"{kind}.share", "least", "most", float)
        if args:
            _use_share(wishes, use, **args)
    if is_wanted(found, "courtyard"):
        town.setdefault("zone", "midrise")  # closed blocks
    house = found.get("house.share", found.get("house.share.min", (0.0,)))[0]
    if float(house) >= MANY_HOUSES:
        town.setdefault("zone", ZONE_OF_KIND["house"])
    green = bounds(found, "green.share", "share", "most", float)
    if green:
        wish(wishes, "layout/green_share-v1", **{"share": 0.0, **green})
    built = bounds(found, "building.share", "least", "most", float)
    if built:
        wish(wishes, "layout/cover-v1", **built)


def counts(found: Slots, town: dict[str, Any], wishes: Wishes) -> None:
    """Tell how many buildings there are, of the kinds that are counted."""
    args = bounds(found, "building.count", "least", "most", int)
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
        wish(wishes, KIND_COUNT, kind=name, **ends)
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
    wish(wishes, "layout/buildings_count-v1", **told)
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
        wish(
            wishes, "layout/towers-v1", count=args["least"], around="nothing",
            lowest=low * (1 + MARGIN), highest=float(high or low * TALLER) * (1 - MARGIN),
        )  # fmt: skip
    if "most" in args:
        wish(wishes, "layout/buildings_count-v1", kind="tower", most=args["most"])


def _counted_kinds(found: Slots) -> Wishes:
    """Return how many there are to be of each kind of buildings that is counted.

    Of kinds that nobody counts beside dwellings that are counted there are some.
    """
    counted = {kind: bounds(found, f"{kind}.count", "least", "most", int) for kind in COUNTED_KINDS}
    types = [str(word) for word in found.get("building.type", ())]
    if len(types) == 1 and types[0] in COUNTED_KINDS:
        counted[types[0]] |= bounds(found, "building.count", "least", "most", int)
    counted = {kind: _amid(ends) for kind, ends in counted.items() if ends}
    if not counted.keys() & set(DWELLINGS):
        return counted
    return {kind: {"least": _some(counted)} for kind in types if kind in COUNTED_KINDS} | counted


def _some(counted: Wishes) -> int:
    """Return how many there are of a kind that nobody counts beside others."""
    return max(SOME_OF_A_KIND, least(counted.values()) // 10)


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
        ends = bounds(found, f"{kind}.count", "least", "most", int)
        _counted_towers(found, wishes, kind, kind, ends)
        counted |= {kind: ends} if ends else {}
    others = {str(word) for word in found.get("building.type", ())} - counted.keys()
    if others - ELEMENTS.keys() or not any(kind in counted for kind in DWELLINGS):
        return {}  # they stand among others
    placed = {key.partition(".")[0] for key in found if key.endswith((".by", ".part"))}
    apart = len((placed & KINDS.keys()) - counted.keys())
    more = _landmarks(found) + apart * (least(counted.values()) // 2)
    bounded = [one for one in counted.values() if "most" in one]
    if not all("least" in one for one in counted.values()):
        most = {"most": sum(int(one["most"]) for one in bounded) + more}
        return most if len(bounded) == len(counted) else {}
    number = least(counted.values()) + more
    return {"least": number, **({"most": number} if bounded else {})}


def plots(found: Slots, town: dict[str, Any], wishes: Wishes) -> None:
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


def added_parts(found: Slots, town: dict[str, Any], wishes: Wishes) -> None:
    """Clocks, balconies, awnings... of finished buildings of a kind, and their colours."""
    del town
    for host, part in _parts_named(found):
        key, kind = f"{host}.{part}", PART_KINDS[part]
        if not kind.added or bounds(found, f"{key}.count", "least", "most", int).get("most") == 0:
            continue
        args: dict[str, Any] = {"part": kind.added, "kind": host}
        shade = COLORS.get(NAMED_COLORS.get(str(found.get(f"{key}.color", ("",))[0]), ""))
        if shade and not kind.body:
            from cityx.assets.styles.materials import srgb_to_linear  # with textures

            args["tint"] = srgb_to_linear(shade[0])
        wishes[f"edit/add_parts-v1#{key}"] = args


def host_parts(found: Slots, town: dict[str, Any], wishes: Wishes) -> None:
    """Towers, domes, chimneys of buildings of a kind: how many, how high, how they look."""
    del town
    for host, part in _parts_named(found):
        key, kind = f"{host}.{part}", PART_KINDS[part]
        ends = bounds(found, f"{key}.count", "least", "most", int)
        if kind.body:
            color = NAMED_COLORS.get(str(found.get(f"{key}.color", ("",))[0]), "")
            args: dict[str, Any] = {"kind": host, "part": part, "least": 1, **ends}
            args["least"] = min(args["least"], args.get("most", args["least"]))
            height = within(found, f"{key}.height")
            material = MATERIALS.get(str(found.get(f"{key}.material", ("",))[0]), "")
            told = (("height", height), ("color", color), ("material", material))
            args |= {name: value for name, value in told if value}
            wishes[f"layout/host_parts-v1#{key}"] = args


def quarters(found: Slots, town: dict[str, Any], wishes: Wishes) -> None:
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


def groups(found: Slots, town: dict[str, Any], wishes: Wishes) -> None:
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
        args = {} if kept else bounds(found, f"{subject}.count", "least", "most", int)
        args |= bounds(found, f"{subject}.floors", "least_floors", "most_floors", int)
        args |= bounds(found, f"{subject}.height", "lowest", "highest", float)
        if not args:
            continue
        spare(found, wishes, args)
        told = {"kind": group.kind, "part": group.part, "near": group.near, "added": group.added}
        said = {name: value for name, value in told.items() if value}
        said |= {"within": group.within} if group.near else {}
        wishes[f"{GROUP}#{subject}"] = {**said, **args}
    for kind in sorted(quarters_named(found)):
        spare(found, wishes, {"least_floors": KINDS[kind].floors[0]})


def floor_area(found: Slots, town: dict[str, Any], wishes: Wishes) -> None:
    """For how many people the town is, how much floor it has, how high it is on average."""
    args = {
        name: value
        for name, key in (
            ("people", "population"), ("ratio", "plot.ratio"), ("floors", "floors.mean"),
            ("height", "height.mean"),
        )
        if (value := within(found, key)) is not None
    }  # fmt: skip
    if not args:
        return
    wish(wishes, "layout/floor_area-v1", **args)
    if "people" not in args or {"width", "depth"} & town.keys() or "source" in found:
        return
    zone = str(town.setdefault("zone", "midrise"))
    if zone in PEOPLE:
        floors = within(found, "building.floors") or PEOPLE[zone][1]
        hectares = args["people"] / (PEOPLE[zone][0] * floors / PEOPLE[zone][1])
        side = min(max(100.0 * sqrt(SPARE * hectares), SMALLEST_TOWN), LARGEST_TOWN)
        town |= dict.fromkeys(("width", "depth"), round(side))
