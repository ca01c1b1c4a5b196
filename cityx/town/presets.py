"""What words for districts, density, streets and patterns mean: arguments of layout actions.

One table per slot of a brief. A planner joins the rows of the words it was given (`plan_of`); what
is said in numbers goes over them. Every row gives what the goals of a brief measure for
its word, on any site of 150 metres and more.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any

from cityx.errors import UsageError, nearest

Arguments = Mapping[str, Any]
TOWN = "layout/town-v1"


@dataclass(frozen=True)
class Preset:
    """What one word asks of a layout.

    Attributes
    ----------
    town
        Arguments of `layout/town-v1`.
    then
        Actions after it, with their arguments; their records say in which order.
    """

    town: Arguments = field(default_factory=dict)
    then: tuple[tuple[str, Arguments], ...] = ()


PRESETS: Mapping[str, Mapping[str, Preset]] = MappingProxyType({
    "district": {
        # Towers on podiums; half of them 60 m and more.
        "downtown": Preset({"zone": "core", "density": 0.97, "radius": 1500.0, "pattern": "grid",
                            "parks": 0.05}),
        # Offices, lower than downtown.
        "business": Preset({"zone": "core", "density": 0.88, "radius": 1500.0, "pattern": "grid",
                            "parks": 0.06}),
        "commercial": Preset({"zone": "core", "density": 0.88, "radius": 1500.0,
                              "pattern": "grid", "parks": 0.06}),
        # Closed rows of houses of up to six storeys on small blocks.
        "old_town": Preset(
            {"zone": "midrise", "pattern": "organic", "streets": "narrow", "block": 85.0,
             "parks": 0.04, "plazas": 1.0},
            (("layout/building_limits-v1", {"most_floors": 6}),),
        ),
        # Detached houses in gardens.
        "suburban": Preset(
            {"zone": "suburb", "pattern": "organic", "parks": 0.04, "plazas": 0.0,
             "block": 120.0},
            (("layout/building_limits-v1", {"most_floors": 3}),),
        ),
        # A few streets of small houses round a square.
        "village": Preset(
            {"zone": "suburb", "pattern": "organic", "parks": 0.08, "plazas": 0.0, "block": 120.0},
            (("layout/places-v1", {"kind": "plaza", "count": 1, "central": True}),
             ("layout/building_limits-v1", {"most_floors": 3})),
        ),
        # Halls and yards on large blocks, a house for offices on some.
        "industrial": Preset({"zone": "industry", "pattern": "grid", "parks": 0.0, "plazas": 0.0,
                              "block": 160.0}),
        # Flats and rows of houses.
        "residential": Preset({"zone": "midrise", "parks": 0.10, "industry": 0.0}),
        # The sea in the south unless a side is said.
        "coastal": Preset({"pattern": "organic"},
                          (("layout/coast-v1", {"side": "south", "share": 0.25}),)),
    },
    "density": {
        "high": Preset({"zone": "core", "density": 0.9, "parks": 0.03, "plazas": 0.3,
                        "built": 0.72},
                       (("layout/cover-v1", {"least": 0.35}),)),
        "medium": Preset({"density": 0.66, "radius": 800.0}),
        "low": Preset({"zone": "suburb", "density": 0.25},
                      (("layout/cover-v1", {"most": 0.2}),)),
    },
    "roads.width": {
        "narrow": Preset({"streets": "narrow"}),
        "wide": Preset({"streets": "wide"}),
        "usual": Preset({"streets": "usual"}),
    },
    "roads.pattern": {
        "grid": Preset({"pattern": "grid"}),
        "organic": Preset({"pattern": "organic"}),
        "radial": Preset({"pattern": "radial"}),
        "ring": Preset({"pattern": "organic"}, (("layout/ring_road-v1", {}),)),
    },
    "size": {
        "small": Preset({"width": 380.0, "depth": 380.0}),
        "medium": Preset({"width": 600.0, "depth": 600.0}),
        "large": Preset({"width": 1050.0, "depth": 1000.0}),
    },
})  # fmt: skip
# Buildings per hectare of a bounded site without parks and plazas, by zone; measured on 200 m.
PER_HECTARE: Mapping[str, float] = MappingProxyType(
    {"core": 3.5, "midrise": 8.0, "suburb": 12.0, "row": 26.0}
)


def plan_of(words: Iterable[tuple[str, str]]) -> list[tuple[str, dict[str, Any]]]:
    """Return the layout actions that words ask for, the town first.

    Parameters
    ----------
    words
        Slot and word, such as ("district", "downtown"); later ones go over earlier ones.

    Raises
    ------
    UsageError
        For a slot or a word that no table knows, with the nearest one.
    """
    town: dict[str, Any] = {}
    then: dict[str, dict[str, Any]] = {}
    for slot, word in words:
        if slot not in PRESETS:
            raise UsageError(f'No preset for "{slot}".{nearest(slot, PRESETS)}')
        if word not in PRESETS[slot]:
            raise UsageError(f'"{word}" is no {slot}.{nearest(word, PRESETS[slot])}')
        preset = PRESETS[slot][word]
        town |= preset.town
        for action, args in preset.then:
            then.setdefault(action, {}).update(args)
    return [(TOWN, town), *then.items()]


def zone_for(count: int, area: float) -> str:
    """Return the zone whose houses are about so many on a site of some square metres."""
    wanted = max(count / (area / 1e4), 1e-9)
    return min(PER_HECTARE, key=lambda zone: abs(math.log(PER_HECTARE[zone] / wanted)))
