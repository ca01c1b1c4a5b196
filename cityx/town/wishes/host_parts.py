"""Parts of buildings that are asked for: two minarets of each mosque, a green spire of a church."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated

from cityx.checks.predicates.measuring import rows_of
from cityx.checks.predicates.words import COLORS, MATERIALS
from cityx.city import City, Goal
from cityx.city.bounds import CLEAR, bounds_of
from cityx.errors import ActionFailed, UsageError
from cityx.protocol import Choice, Port, Range, action
from cityx.town.host_parts import Look, NoRoomForPart, with_parts
from cityx.town.part_kinds import HOSTS, PART_KINDS, as_high, counted

MOST = 40  # parts of a kind on one building
ANY = "any"
# Material of walls or roofs -> word of building:material=*.
_WORDS = {"tiles": "roof_tiles"}


@action(
    "layout/host_parts-v1",
    limits=["A part stands within its building, but for round ones at its corners."],
    requires=("layout",),
    after=("layout/tallest-v1",),
    takes=(Port("layout", "scene_layout"),),
    gives=(Port("layout", "scene_layout"),),
    labels=("part", *PART_KINDS),
)
def host_parts(
    city: City,
    *,
    kind: Annotated[str, Choice(*HOSTS)],
    part: Annotated[str, Choice(*(name for name, one in PART_KINDS.items() if one.body))],
    least: Annotated[int, Range(0, MOST)] = 1,
    most: Annotated[int, Range(0, MOST)] = MOST,
    height: Annotated[float, Range(0.0, 300.0)] = 0.0,
    color: Annotated[str, Choice(ANY, *COLORS)] = ANY,
    material: Annotated[str, Choice(ANY, *MATERIALS)] = ANY,
) -> City:
    """Give every building of a kind so many towers, spires, domes, minarets or chimneys.

    Parameters
    ----------
    city
        City with buildings of that kind.
    kind
        Which get them.
    part
        What they get; what they have counts.
    least, most
        How many each has.
    height
        Metres from the ground to the top of the part, 0 for what suits its building.
    color
        Of its walls; of spires and domes of what covers them.
    material
        The same.
    """
    if least > most:
        raise UsageError(f"least = {least} is more than most = {most}.")
    rows = rows_of(HOSTS[kind], city)
    word, host = part.replace("_", " "), kind.replace("_", " ")
    if not len(rows):
        raise ActionFailed(f"There is no {host} that could have a {word}.")
    body = PART_KINDS[part].body
    shade = COLORS[color][0] if color != ANY else -1
    own = _WORDS.get(material, material) if material != ANY else ""
    bound = bounds_of(city.layout.buildings, "height").most - CLEAR
    layout = city.layout
    for row in rows.tolist():
        look = Look(height, float(bound[row]), shade, own)
        try:
            layout = with_parts(layout, row, part, least, most, look, seed=city.seed)
        except NoRoomForPart as error:
            source = layout.buildings["source"].iloc[row]
            raise ActionFailed(f"The {host} {source} has no {word}: {error}.") from error
    ends = (least, most if most < MOST else None)
    goals = [Goal(f"{word} of the {host}", one) for one in counted(kind, part, *ends)
             if f"{body}s" in one]  # fmt: skip
    if height:
        told = as_high(kind, part, 0.95 * height, 1.05 * height)
        goals.append(Goal(f"{word} of the {host} {height:g} m high", told))
    return replace(city, layout=layout, goals=(*city.goals, *goals))
