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
from cityx.system.tables import table

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


PRESETS = table("town/presets", dict[str, Preset])
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
