"""What is asked for: the slots of a brief, with what they mean for actions in numbers.

A brief says "downtown", "dense" or "two hectares"; actions take zones, shares and metres. The
tables here say how one becomes the other. Keys that a brief does not know are written with a
leading stage: "town.zone", "limits.most_floors".
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from math import sqrt
from types import MappingProxyType
from typing import Any

from cityx.agents.brief import Brief

Found = dict[str, tuple[Any, ...]]

# Kind of quarter -> what a town is laid out with.
DISTRICTS: Mapping[str, Mapping[str, Any]] = MappingProxyType(
    {
        "downtown": {"town.zone": "core", "town.density": 1.0},
        "business": {"town.zone": "core", "town.density": 1.0},
        "commercial": {"town.zone": "midrise", "use.retail": 0.25},
        "residential": {"town.zone": "midrise", "use.apartments": 0.7, "town.industry": 0.0},
        "old_town": {
            "town.zone": "midrise", "town.block": 80.0, "limits.most_floors": 5,
            "roads.width": "narrow", "town.industry": 0.0,
        },
        "suburban": {"town.zone": "suburb", "limits.most_floors": 3, "town.industry": 0.0},
        "village": {"town.zone": "rural", "limits.most_floors": 3, "town.industry": 0.0},
        "rural": {"town.zone": "rural", "limits.most_floors": 3},
        "industrial": {"town.zone": "industry", "town.industry": 1.0},
        "coastal": {"coast": True},
        "harbour": {"coast": True, "coast.beach": 0.0},
    }
)  # fmt: skip
# Share of the site under buildings, and density of a town.
DENSITIES: Mapping[str, Mapping[str, Any]] = MappingProxyType(
    {
        "high": {"town.density": 0.9, "cover.least": 0.37},
        "medium": {"town.density": 0.6},
        "low": {"town.density": 0.15, "cover.most": 0.19},
    }
)
SIZES: Mapping[str, float] = MappingProxyType({"small": 380.0, "medium": 700.0, "large": 1100.0})
HEIGHTS: Mapping[str, Mapping[str, Any]] = MappingProxyType(
    {"tall": {"town.zone": "core", "town.density": 1.0}, "low": {"limits.highest": 11.5}}
)
PATTERNS: Mapping[str, str] = MappingProxyType({"ring": "radial"})
# Words for weather that the air of a city has under another name.
SKIES: Mapping[tuple[str, str], str] = MappingProxyType(
    {("snow", "light"): "light snow", ("snow", "heavy"): "heavy snow", ("rain", "light"): "drizzle"}
)
TOWERS = ("tower", "skyscraper", "high_rise")
TALL = MappingProxyType({"tower": 50.0, "skyscraper": 100.0, "high_rise": 35.0})  # metres, at least
TALLER = 1.8  # times the least height, where no greatest is said
MARGIN = 0.02  # of a height, by which a bound is kept clear


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
    for slot in brief.negated:
        found["not"] = (*found.get("not", ()), slot.value)
    for rule in _RULES:
        for key, values in rule(found).items():
            found.setdefault(key, values)
    return found


def _of_table(key: str, table: Mapping[str, Mapping[str, Any]]) -> Callable[[Found], Found]:
    def rule(found: Found) -> Found:
        made: Found = {}
        for word in found.get(key, ()):
            for name, value in table.get(str(word), {}).items():
                made.setdefault(name, (value,))
        return made

    return rule


def _size(found: Found) -> Found:
    side = sqrt(found["size.area"][0]) if "size.area" in found else None
    if side is None and "size" in found:
        side = SIZES[str(found["size"][0])]
    return {} if side is None else {"size.x": (side,), "size.y": (side,)}


def _towers(found: Found) -> Found:
    """Towers that are counted stand for themselves; others raise the whole town."""
    kind = next((word for word in found.get("building.type", ()) if word in TOWERS), None)
    if kind is None:
        return {}
    low = float(found.get("building.height.min", (TALL[kind],))[0])
    high = found.get("building.height.max", (None,))[0]
    made: Found = {"town.zone": ("core",), "town.density": (1.0,)}
    if "building.count" not in found:
        return made | ({} if high is None else {"highest": (float(high) * (1 - MARGIN),)})
    around = [word for word in ("plaza", "park") if word in found.get("element", ())]
    return made | {
        "towers.count": found["building.count"],
        "towers.lowest": (low * (1 + MARGIN),),
        "towers.highest": ((float(high) if high is not None else low * TALLER) * (1 - MARGIN),),
        "towers.around": (around[0] if around else "nothing",),
    }


def _counted(found: Found) -> Found:
    if "building.count" in found and "towers.count" not in found:
        return {"buildings.count": found["building.count"]}
    return {}


def _limits(found: Found) -> Found:
    """Bounds that hold for every building, unless they speak of towers alone."""
    keys = {
        "limits.least_floors": "building.floors.min",
        "limits.most_floors": "building.floors.max",
    }
    if "towers.count" not in found and "highest" not in found:
        keys |= {"limits.lowest": "building.height.min", "limits.highest": "building.height.max"}
    made = {name: found[key] for name, key in keys.items() if key in found}
    if "building.floors" in found:
        exact = found["building.floors"]
        made |= {"limits.least_floors": exact, "limits.most_floors": exact}
    if made or any(key.startswith("limits.") for key in found):
        made["limits"] = (True,)
    return made


def _places(found: Found) -> Found:
    """Plazas, parks and lakes: how many, and whether one of them lies in the middle."""
    elements = found.get("element", ())
    made: Found = {}
    if "park" in elements and "lake" in elements:
        made["central_park"] = (True,)
        elements = tuple(word for word in elements if word not in ("park", "lake"))
    for word in ("plaza", "park", "lake"):
        count = found.get(f"{word}.count", (1,) if word in elements else ())
        if count:
            made[f"{word}.wanted"] = count
    return made


def _water(found: Found) -> Found:
    elements = found.get("element", ())
    made: Found = {}
    if (
        "river" in elements
        or any(key.startswith("river.") for key in found)
        or "bridge.count" in found
    ):
        made["river"] = (True,)
    if {"beach", "sea"} & set(elements) or "beach.side" in found or "sea.side" in found:
        made["coast"] = (True,)
    side = found.get("beach.side", found.get("sea.side"))
    if side:
        made["coast.side"] = side
    return made


def _streets(found: Found) -> Found:
    made: Found = {}
    if "roads.main.lanes" in found or "roads.main.axis" in found:
        made["boulevard"] = (True,)
    pattern = found.get("roads.pattern", ())
    if pattern and str(pattern[0]) in PATTERNS:
        made["town.pattern"] = (PATTERNS[str(pattern[0])],)
    elif not pattern and ("roads.avenues" in found or "roads.rings" in found):
        made["town.pattern"] = ("radial",)
    elif pattern:
        made["town.pattern"] = pattern
    return made


def _cover(found: Found) -> Found:
    return {"cover": (True,)} if {"cover.least", "cover.most"} & found.keys() else {}


def _trees(found: Found) -> Found:
    if "tree" in found.get("not", ()):
        return {"trees.street_trees": (False,), "trees.budget": (0,)}
    return {}


def _air(found: Found) -> Found:
    """Weather with its intensity, a season as a date."""
    made: Found = {}
    for word in found.get("weather", ()):
        for intensity in found.get(f"{word}.intensity", ()):
            sky = SKIES.get((str(word), str(intensity)))
            if sky is not None:
                made["sky"] = (sky,)
    return made


_RULES: Iterable[Callable[[Found], Found]] = (
    _size, _of_table("district", DISTRICTS), _of_table("density", DENSITIES),
    _of_table("building.height", HEIGHTS), _towers, _counted, _limits, _places, _water, _streets,
    _cover, _trees, _air,
)  # fmt: skip
