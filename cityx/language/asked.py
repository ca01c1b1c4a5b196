"""What is asked for: the slots of a brief, with what they mean for actions.

A brief says "downtown", "dense" or "two hectares"; actions take zones, shares and metres.
`cityx.town.presets` says what the words mean; here numbers go over them. What follows is
written with the name of the action it is for: "town.zone" is the parameter ``zone`` of
``layout/town``, and the key "do" lists actions that are called for, with their arguments.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from math import sqrt
from types import MappingProxyType
from typing import Any

from cityx.assets.outside_words import brings_buildings
from cityx.edit.moment import SEASONS
from cityx.language import Brief
from cityx.language.asked_buildings import (
    MARGIN,
    added_parts,
    counts,
    floor_area,
    groups,
    heights,
    heights_of_kinds,
    host_parts,
    is_one,
    kinds,
    plots,
    quarters,
    shares,
)
from cityx.language.asked_places import (
    dressed,
    elements,
    enclosed,
    gradients,
    places,
    steps,
    terrain,
    tree_rows,
    trees,
    water,
)
from cityx.language.asked_values import (
    LIMITS,
    Found,
    Wishes,
    bounds,
    highest,
    number,
    wanted,
    wish,
    within,
)
from cityx.language.commands.terminals import ADDED
from cityx.language.goals import (
    LAYOUTS,
)
from cityx.language.here import KINDS_OF_PEOPLE, ROLES
from cityx.language.life_words import MIXED, SERVICES
from cityx.protocol.serving import DO, Slots
from cityx.town.presets import PRESETS, plan_of

MEDIAN = 4.0  # metres between carriageways where a median is asked for
WIDE_WALK, NARROW_WALK = 3.6, 1.5  # metres of what is called a wide and a narrow pavement
BESIDE_AVENUE = 400.0  # metres of a site across a street whose length is said
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
        if slot.key == "agent" and is_one(brief.text, slot):
            found.setdefault(f"{slot.value}.count.min", (1,))
    for slot in brief.negated:
        found["not"] = (*found.get("not", ()), slot.value)
    town, wishes = _of_words(found)
    for rule in _RULES:
        rule(found, town, wishes)
    found |= {f"town.{name}": (value,) for name, value in town.items()}
    found[DO] = tuple((action.partition("#")[0], args) for action, args in wishes.items())
    return found


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
            wish(wishes, action, **args)
    return dict(town), wishes


def _size(found: Slots, town: dict[str, Any], wishes: Wishes) -> None:
    del wishes
    if "size.area" in found:
        town |= dict.fromkeys(("width", "depth"), sqrt(float(found["size.area"][0])))
    for key, name in (("size.x", "width"), ("size.y", "depth")):
        if key in found:
            town[name] = float(found[key][0])


def _streets(found: Slots, town: dict[str, Any], wishes: Wishes) -> None:
    given = {
        name: found[key][0]
        for name, key in (
            ("lanes", "roads.main.lanes"), ("axis", "roads.main.axis"),
            ("others", "roads.other.lanes"),
        )
        if key in found
    }  # fmt: skip
    length = number(found, "roads.main.length", MARGIN)
    if length is not None:
        along = "width" if given.get("axis") == "east_west" else "depth"
        town.setdefault(along, length)
        town.setdefault("width" if along == "depth" else "depth", BESIDE_AVENUE)
        given["length"] = length
    if "median" in found.get("element", ()):
        given["median"] = MEDIAN
    if given:
        wish(wishes, "layout/boulevard-v1", **given)
    if "roads.motorways" in found or any(key.startswith("roads.motorway.") for key in found):
        motorway = {
            name: found[f"roads.motorway.{name}"][0]
            for name in ("lanes", "axis")
            if f"roads.motorway.{name}" in found
        }
        wish(wishes, "layout/motorway-v1", **motorway)
    for of, keys in (("main", ("roads", "roads.main")), ("local", ("roads", "roads.other"))):
        for key in keys:
            town |= bounds(found, f"{key}.width", f"{of}least", f"{of}_most", float)
            if key == "roads" or not given:  # the others are those of a boulevard
                names = f"{of}_least_lanes", f"{of}_most_lanes"
                town |= bounds(found, f"{key}.lanes", *names, int)
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
            wish(wishes, design, kind=kind, surface=found[f"{key}.surface"][0])
        if f"{key}.oneway" in found:
            wishes[f"{design}#{kind}/oneway"] = {"kind": kind, "oneway": True}
    speed = number(found, "roads.speed")
    if speed is not None:
        wish(wishes, design, kind="all", speed_kmh=round(speed * 3.6, 1))
    walk = number(found, "sidewalk.width", MARGIN)
    words = {"wide": WIDE_WALK, "narrow": NARROW_WALK}
    for said in found.get("sidewalk.width", ()):
        walk = words.get(str(said), walk)
    if walk is not None:
        wish(wishes, design, kind="all", walk=float(walk))
    share = number(found, "oneway.share", MARGIN)
    if share is not None:
        wishes[f"{design}#all/oneway"] = {"kind": "all", "oneway": True, "share": float(share)}
    _cycling(found, wishes)


def _cycling(found: Slots, wishes: Wishes) -> None:
    """Lanes and tracks for cycles: on a share of the streets, on main ones, or on none."""
    design = "layout/street_design-v1"
    for noun, word in (("cycleway", "lane"), ("cycle_track", "track")):
        shares = {
            kind: number(found, f"{noun}{part}.share", MARGIN)
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


def _street_elements(found: Slots, town: dict[str, Any], wishes: Wishes) -> None:
    """Roundabouts, signalled junctions, dead ends, streets without cars."""
    del town
    for kind in ("roundabout", "pedestrian_zone", "road_works", "dead_end", "signalled_junction"):
        args = wanted(found, kind)
        if args is not None:
            side = {"side": found[f"{kind}.side"][0]} if f"{kind}.side" in found else {}
            wish(wishes, "layout/street_elements-v1", kind=kind, **args, **side)
    for kind in ("closed_bridge", "scaffold"):
        args = wanted(found, kind)
        if args is not None:
            side = {"side": found[f"{kind}.side"][0]} if f"{kind}.side" in found else {}
            wish(wishes, "layout/obstacles-v1", kind=kind, **args, **side)
    for kind in ("streetlight", "bench"):
        spacing = number(found, f"{kind}.spacing", MARGIN)
        if spacing is not None:
            wish(wishes, "layout/street_rows-v1", kind=kind, spacing=spacing)


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
        value = within(found, key)
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
        share = within(found, f"{kind}.share")
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
        share = within(found, f"{kind}.share")
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
    if (speed := within(found, f"{kind}.speed")) is not None:
        told["speed"] = speed
    if wears := found.get(f"{kind}.wears"):
        told["wears"] = wears[0]
    return told


def _numbered(found: Slots, kind: str, usual: int) -> int:
    """Return how many of a kind of people or vehicles are asked for, 0 for none."""
    count = within(found, f"{kind}.count")
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
            wish(wishes, made.action)


_RULES: tuple[Callable[[Found, dict[str, Any], Wishes], None], ...] = (
    _size, plots, heights, heights_of_kinds, kinds, shares, counts, places, elements,
    host_parts, quarters, groups, tree_rows, enclosed, dressed,
    water, terrain, floor_area, highest, _streets, _street_design, _street_elements, steps,
    _blocks, gradients, trees, _air, _life, added_parts, _outside,
)  # fmt: skip
