"""States of road surfaces: a material of the table, older, more worn or wetter.

A state is a material like those of the table, and its name says all of it, so every view makes the
same surface from the name alone: ``asphalt_a2w3r0`` is asphalt half bleached, worn, and dry.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from functools import lru_cache

from cityx.assets.styles.materials import MATERIALS, Material, wet_look
from cityx.system.tables import table

STEPS = 4  # of age, wear and wetness from 0 to 1: few states, so that streets share materials
_NAME = re.compile(rf"([a-z_]+)_a([0-{STEPS}])w([0-{STEPS}])r([0-{STEPS}])")


@dataclass(frozen=True)
class Ageing:
    """How a surface changes.

    Attributes
    ----------
    fresh, old
        Factors on the colour when new and after decades: asphalt bleaches, concrete and stone
        darken.
    polish
        Share of the roughness that tyres take off.
    worn
        Pattern from half worn on, "" where it stays.
    """

    fresh: float
    old: float
    polish: float
    worn: str = ""


AGEING = table("assets/ageing", Ageing)


def state_of(family: str, *, age: float, wear: float, wetness: float = 0.0) -> str:
    """Return the name of a state.

    Parameters
    ----------
    family
        Key of `AGEING`.
    age, wear, wetness
        0 to 1, rounded to quarters.
    """
    a, w, r = (round(STEPS * min(max(value, 0.0), 1.0)) for value in (age, wear, wetness))
    return f"{family}_a{a}w{w}r{r}"


@lru_cache(maxsize=1024)
def material_named(name: str) -> Material:
    """Return a material of the table, a state of one, or a grey one under an unknown name."""
    match = _NAME.fullmatch(name)
    if name in MATERIALS or match is None or match[1] not in AGEING:
        return MATERIALS.get(name) or Material(name, (0.5, 0.5, 0.5))
    family, ageing = MATERIALS[match[1]], AGEING[match[1]]
    age, wear, wetness = (int(step) / STEPS for step in match.groups()[1:])
    factor = ageing.fresh + (ageing.old - ageing.fresh) * age
    red, green, blue = (min(1.0, factor * channel) for channel in family.color)
    aged = replace(
        family,
        name=name,
        family=family.name,
        color=(red, green, blue),
        roughness=family.roughness * (1.0 - ageing.polish * wear),
        texture=ageing.worn if ageing.worn and wear >= 0.5 else family.texture,
    )
    color, roughness = wet_look(aged, wetness)
    return replace(aged, color=color, roughness=roughness)
