"""Streets of steps where the land climbs, with ramps beside them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Annotated, Any

import numpy as np
import shapely
from shapely.ops import substring

from cityx.checks.predicates.junctions import LAYERS
from cityx.city import City
from cityx.city.asked_goals import asked
from cityx.city.layout import joined_tables
from cityx.errors import ActionFailed, UsageError
from cityx.geometry.arrays import FloatArray
from cityx.protocol import Choice, Port, Range, action
from cityx.sources.features.tagged import Owner, Tags
from cityx.town.cutting import street_rows
from cityx.town.wishes.street_elements import MOST, SIDES, best_stretch, walked_on

LENGTH = (25.0, 130.0)  # metres of a street that becomes steps
CLIMB = (0.045, 0.5)  # rise over run from its foot to its head
RAMPED = (0.03, 0.125)  # the same of one with a ramp, which wheels climb
SAMPLES = 9  # places along a street at which the land is looked at
FALLS = 0.15  # of its climb, by which it may fall on the way
RAMP, BETWEEN = 2.0, 0.3  # metres of a ramp, and between it and the steps
APART = 3.0  # metres from a junction to where steps and ramp part
STEEPER = 4.0  # by which each unit of rise over run makes a street suit better


@action(
    "road/steps-v1",
    limits=["A street that becomes steps carries no cars; the land has to climb along it."],
    requires=("layout",),
    after=("terrain", "road/drawn_streets-v1"),
    takes=(Port("layout", "scene_layout"),),
    gives=(Port("layout", "scene_layout"),),
    labels=("steps", "stairs", "stairway", "ramp", "stepped street"),
)
def steps(
    city: City,
    *,
    least: Annotated[int, Range(0, 100)] = 0,
    most: Annotated[int, Range(0, MOST)] = MOST,
    ramps: Annotated[int, Range(0, 100)] = 0,
    side: Annotated[str, Choice(*SIDES)] = "any",
) -> City:
    """Make so many streets steps where the land climbs, some of them with a ramp beside them.

    Parameters
    ----------
    city
        City with streets and its land.
    least, most
        How many streets of steps there shall be; those of a map are not taken away.
    ramps
        How many of the new ones have a ramp beside them.
    side
        Where new ones are: a side of the site, its middle or its edge.
    """
    least = max(least, ramps)
    if least > most:
        raise UsageError(f"least = {least} or ramps = {ramps} is more than most = {most}.")
    have = len(LAYERS["steps"](city, "steps").shapes)
    if have > most:
        raise ActionFailed(f"There are {have} streets of steps, of which {most} may stay.")
    for number in range(have, least):
        ramped = number - have < ramps
        part = best_stretch(city, side, LENGTH, _climbing(city, RAMPED if ramped else CLIMB))
        if part is None:
            raise ActionFailed(
                f"{least} streets of steps cannot be had: the land climbs enough along {number}. "
                "Ask for fewer, or for steeper land."
            )
        city = _stepped(city, *part, number, ramped=ramped)
    city = asked(city, f"{least} streets of steps", "n(steps)", least=least,
                 most=None if most == MOST else most)  # fmt: skip
    return asked(city, f"{ramps} ramps beside them", "n(ramp)", least=ramps) if ramps else city


def _climbing(city: City, grades: tuple[float, float]) -> Callable[[Any], float]:
    """Return how well a line suits by how steadily the land climbs along it."""

    def fits(line: Any) -> float:
        share = np.linspace(0.0, 1.0, SAMPLES)
        at = shapely.get_coordinates(shapely.line_interpolate_point(line, share, normalized=True))
        z = city.terrain.height_at(at)
        rise = abs(float(z[-1] - z[0]))
        steady = float(np.abs(np.diff(z)).sum()) <= (1 + 2 * FALLS) * rise
        grade = rise / line.length
        return STEEPER * round(grade, 4) if steady and grades[0] <= grade <= grades[1] else np.nan

    return fits


def _stepped(city: City, row: int, part: FloatArray, number: int, *, ramped: bool) -> City:
    """Make a stretch of a street steps; a ramp takes one side of it."""
    city = walked_on(city, row, part, number, "steps", "concrete", "Steps")
    if not ramped:
        return city
    roads = city.layout.roads
    own = int(np.flatnonzero(roads["source"] == f"made/steps/{number}")[0])
    wide, name = float(roads["width"].iloc[own]), str(roads["name"].iloc[own])
    narrow = wide - RAMP - BETWEEN
    rows: list[tuple[Any, Tags, tuple[Any, ...]]] = [
        (_aside(part, (RAMP + BETWEEN) / 2),
         {"highway": "steps", "surface": "concrete", "width": f"{narrow:.2f}", "name": name},
         ("made", "steps", number)),
        (_aside(part, -(wide - RAMP) / 2),
         {"highway": "footway", "surface": "paving_stones", "width": f"{RAMP:g}", "ramp": "yes",
          "name": f"{name} Ramp"}, ("made", "ramp", number)),
    ]  # fmt: skip
    new = street_rows(
        city, [line for line, _, _ in rows], [Owner(key, tags) for _, tags, key in rows]
    )
    kept = roads.drop(index=roads.index[own]).reset_index(drop=True)
    return replace(city, layout=replace(city.layout, roads=joined_tables(kept, new)))


def _aside(part: FloatArray, away: float) -> Any:
    """Return a line beside another one, to its left, that begins and ends with it."""
    line = shapely.LineString(part)
    inner = substring(line, APART, line.length - APART)
    beside = shapely.get_coordinates(shapely.offset_curve(inner, away, join_style="mitre"))
    return shapely.LineString(np.concatenate([part[:1], np.round(beside, 3), part[-1:]]))
