"""Algorithm 1 of the paper: a character, or a crowd of them, that walks or runs along a path.

The paper's loop makes a model at every point of the path; one is meant, so it is made once and has
a sample at every point it passes. The paper takes the velocity from the curvature; here the
direction is that of the tangent, and curvature only limits the speed.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from typing import Annotated

import numpy as np
import shapely

from cityx.assets.people.looks import STYLES
from cityx.assets.styles.materials import srgb_to_linear
from cityx.assets.vehicles.movers import person_look
from cityx.city.city import City
from cityx.city.layout import CURVE, Layout, make_table
from cityx.city.sites import merged
from cityx.errors import ActionFailed
from cityx.geometry.arrays import FloatArray
from cityx.ids import hash_ids, stable_id, uniform
from cityx.motion.courses import course, paces
from cityx.motion.feasible import check_walk
from cityx.motion.paths import Path, find_path
from cityx.motion.processions import Cast, new_ids, procession
from cityx.motion.walkways import beside, walkable
from cityx.protocol import Choice, Points, Port, Range, Serves, Text, Way, action, has_ground
from cityx.road.network.curves import FARTHEST, curve_faults

ACTION = "dynamic/character-v1"

SINGLE, CROWD = "single", "crowd"
STAND = "stand"
SPEEDS = {"walk": 1.4, "run": 3.2, STAND: 0.0}  # metres per second, of grown people
GAITS = {"walk": "walk", "run": "run", STAND: "still"}
SIDEWAYS = 2.5  # metres per second squared that people lean into in a bend
PULL = 1.5  # metres per second squared of starting and slowing down
SLACK = 0.15  # metres by which people cut a corner
SPACING = 1.0  # metres between samples at most
APART = {"walk": 1.3, "run": 2.4, STAND: 0.8}  # metres from one to the next, behind one another
ABREAST = 0.35  # metres that two abreast are off the middle of the path
SHOULDER = 0.3  # metres, half of what somebody takes of the width of a path
USUAL_CROWD = 12
MOST = 2000  # characters of one call
AT_MOST = 1_000_000_000  # that can be asked for; more than fits is refused with what fits
DRAWN_PEOPLE = 100  # numbers of people that a crowd is drawn from
# "run, male_jog02": how somebody goes, who it is, and the number of the person.
CATEGORY = re.compile(r"(?:(walk|run|stand), *)?(male|female)(?:_[a-z]+)?_?(\d+)?")
# Clothes that are drawn when colours are random, sRGB: those of runners and walkers in a park.
COLORS = (0xB8342F, 0xD9A627, 0x2F6FB0, 0x3E8F5A, 0xE07A3A, 0x7A5BA6, 0xD77C9A, 0x2B2F3A,
          0xE3E0D8, 0x2E7F86, 0x86A3BF, 0x8C2F2E)  # fmt: skip


@dataclass(frozen=True)
class Wanted:
    """The character asked for: gait, sex, and the person's number or -1."""

    gait: str
    sex: str
    number: int


@action(
    ACTION,
    limits=[
        "Characters follow the path and one another. They set out so that they meet nobody who "
        "walks already, as far as there are gaps; vehicles they do not evade.",
        "On an open path they leave the city at its end.",
    ],
    requires=("layout", has_ground()),
    takes=(Port("curve", "line", role="curve", optional=True),),
    labels=("pedestrian", "runner", "jogger", "person", "people", "crowd", "walking"),
    serves=(Serves("edit=add_agent", "agent=pedestrian", "path"),),
    binds={"path": "path", "walk_run": "mode", "count": "count", "gender": "gender",
           "speed": "speed"},
)  # fmt: skip
def character(
    city: City,
    *,
    path: Annotated[str, Way()],
    crowd_creation: Annotated[str | None, Choice(SINGLE, CROWD)] = None,
    walk_run: Annotated[str, Choice("walk", "run", STAND)] = "walk",
    style: Annotated[str, Choice(*STYLES)] = "casual",
    category: Annotated[str | None, Text(40)] = None,
    model_quality: Annotated[str, Choice("low_poly", "high_poly")] = "high_poly",
    random_color: bool = False,
    count: Annotated[int | None, Range(1, AT_MOST)] = None,
    gender: Annotated[str | None, Choice("male", "female")] = None,
    speed: Annotated[float | None, Range(0.1, 12.0)] = None,
    seconds: Annotated[float, Range(1.0, 3600.0)] = 60.0,
    points: Annotated[
        tuple[tuple[float, ...], ...] | None, Points(), Range(-FARTHEST, FARTHEST)
    ] = None,
) -> City:
    """Let a character or a crowd walk or run along a path.

    Parameters
    ----------
    city
        City with its ground.
    path
        Name of a curve or a way, or words such as "around the park" or "along the main street".
    crowd_creation
        One character or a crowd; as many as are counted when left out.
    walk_run
        How they go.
    style
        What they wear.
    category
        Animation and model as the paper writes them, such as "run, male_jog02": how the character
        goes, its sex, and the number of the person.
    model_quality
        Whether their form is that of near views.
    random_color
        Whether the colour of their clothes is drawn instead of the person's own.
    count
        How many; a dozen in a crowd when left out.
    gender
        Of all of them; mixed when left out.
    speed
        Metres per second along the path; usual for how they go when left out.
    seconds
        How long they go around a closed path.
    points
        Draw the curve named `path` through these first, metres east and north of the origin.
    """
    return add_characters(
        city, path=path, crowd_creation=crowd_creation, walk_run=walk_run, style=style,
        category=category, model_quality=model_quality, random_color=random_color, count=count,
        gender=gender, speed=speed, seconds=seconds, points=points,
    )[0]  # fmt: skip


def add_characters(
    city: City,
    *,
    path: str,
    crowd_creation: str | None = None,
    walk_run: str = "walk",
    style: str = "casual",
    category: str | None = None,
    model_quality: str = "high_poly",
    random_color: bool = False,
    count: int | None = None,
    gender: str | None = None,
    speed: float | None = None,
    seconds: float = 60.0,
    points: tuple[tuple[float, ...], ...] | None = None,
) -> tuple[City, tuple[int, ...]]:
    """Do what `character` does, and return the ids of the characters with the city.

    Raises
    ------
    ActionFailed
        If the path names nothing or cannot be walked, more are asked for than fit, or what is
        asked for contradicts itself.
    """
    wanted = _wanted(category, walk_run, gender)
    several = _count(crowd_creation, count)
    if points is not None:
        city = with_curve(city, path, points)
    found = walkable(city, find_path(city, path))
    files = _files(city, found, several, APART[walk_run])
    pace = SPEEDS[walk_run] if speed is None else speed
    if walk_run == STAND and speed:
        raise ActionFailed(f"Who stands has no speed; {speed:g} m/s is for a walk or a run.")
    ids = new_ids(city, ACTION, found.name, several)
    made: list[int] = []
    for line, begins in files:
        mine = ids[len(made) : len(made) + len(begins)]
        way = course(line.points, closed=line.closed, slack=SLACK, spacing=SPACING)
        going = paces(way, pace, sideways=SIDEWAYS, pull=PULL) if pace else np.zeros(len(way.along))
        cast = Cast(
            _looks(city, mine, wanted, style, fine=model_quality == "high_poly", first=not made),
            _tints(city, mine, drawn=random_color),
            begins * way.length / max(line.line.length, 1e-9),
            GAITS[walk_run], ACTION, found.name, found.roads, APART[walk_run],
        )  # fmt: skip
        city, added = procession(city, way, going, cast, seconds)
        made += added
    return city, tuple(made)


def with_curve(city: City, name: str, points: tuple[tuple[float, ...], ...]) -> City:
    """Return the city with a curve drawn through points; one of the same name is replaced.

    Raises
    ------
    ActionFailed
        If they make no curve.
    """
    line = shapely.LineString([point[:2] for point in points])
    if faults := curve_faults(shapely.get_parts(line)):
        raise ActionFailed(f'points of path "{name}": {" ".join(faults)}')
    row = make_table(
        "lines", [line], id=[stable_id(CURVE, name)], source=[name], kind=[CURVE], tags=["{}"]
    )
    drawn = merged(city.layout, Layout(city.layout.extent, lines=row))
    return replace(city, layout=drawn)


def _wanted(category: str | None, walk_run: str, gender: str | None) -> Wanted:
    """Read the paper's category and refuse what it contradicts."""
    if category is None:
        return Wanted(walk_run, gender or "", -1)
    read = CATEGORY.fullmatch(category.strip())
    if read is None:
        raise ActionFailed(
            f'category = "{category}" is none. It says how somebody goes, who it is and which '
            'number, as in "run, male_jog02" or "walk, female_casual07".'
        )
    gait, sex, number = read.groups()
    faults = []
    if gait and gait != walk_run:
        faults.append(f'category = "{category}" says {gait}, walk_run says {walk_run}.')
    if gender and sex != gender:
        faults.append(f'category = "{category}" says {sex}, gender says {gender}.')
    if faults:
        raise ActionFailed(" ".join(faults))
    return Wanted(walk_run, sex, int(number) if number else -1)


def _count(crowd_creation: str | None, count: int | None) -> int:
    if crowd_creation == SINGLE and (count or 1) > 1:
        raise ActionFailed(f'crowd_creation = "{SINGLE}" is one character, count says {count}.')
    if crowd_creation == CROWD:
        return USUAL_CROWD if count is None else count
    return count or 1


def _files(city: City, path: Path, count: int, apart: float) -> list[tuple[Path, FloatArray]]:
    """Return the lines on which people go behind one another, and where each begins, metres.

    Raises
    ------
    ActionFailed
        If the path cannot be walked, or fewer fit on it.
    """
    check_walk(city, path.line, path.name)
    room = path.width / 2 - SHOULDER if path.width else ABREAST
    lines = [path]
    if count > 1 and room >= ABREAST:
        lines = [beside(path, ABREAST), beside(path, -ABREAST)]
    fits = [max(1, int(line.line.length / apart)) for line in lines]
    most = min(sum(fits), MOST)
    if count > most:
        abreast = " two abreast" if len(lines) > 1 else ""
        raise ActionFailed(
            f'{count:,} characters do not fit on the path "{path.name}", which is '
            f"{path.line.length:.0f} m long: {most} fit{abreast}, {apart:g} m apart. "
            f"Ask for {most} at most."
        )
    first = min(count - count // 2, fits[0]) if len(lines) > 1 else count
    shares = [first, count - first] if count > first else [first]
    return [
        (line, spread(city.seed, line, share, apart, f"{ACTION}/{number}"))
        for number, (line, share) in enumerate(zip(lines, shares, strict=False))
    ]


def spread(seed: int, line: Path, count: int, apart: float, purpose: str) -> FloatArray:
    """(n,) metres along a line where movers begin: none nearer than `apart`, unevenly spread."""
    if count == 1:
        return np.zeros(1)
    length = line.line.length if line.closed else line.line.length - apart
    free = max(length - count * apart, 0.0)
    key = np.uint64(stable_id(purpose, line.name))
    gaps = uniform(seed, f"{purpose}/gap", key, np.arange(count + 1)) + 0.2
    gaps *= free / gaps.sum()
    return np.asarray(np.arange(count) * apart + np.cumsum(gaps)[:count])


def _looks(
    city: City, ids: list[int], wanted: Wanted, style: str, *, fine: bool, first: bool
) -> tuple[str, ...]:
    numbers = hash_ids(city.seed, f"{ACTION}/person", np.array(ids, np.uint64)) % np.uint64(
        DRAWN_PEOPLE
    )
    found = numbers.astype(int).tolist()
    if first and wanted.number >= 0:
        found[0] = wanted.number
    age = "adult" if wanted.gait == "run" or wanted.sex else ""
    return tuple(
        person_look(
            number, age=age, sex=wanted.sex, style=style, jogs=wanted.gait == "run", fine=fine
        )
        for number in found
    )


def _tints(city: City, ids: list[int], *, drawn: bool) -> FloatArray:
    """(n, 3) colours of clothes, white for the person's own."""
    if not drawn:
        return np.ones((len(ids), 3))
    colors = np.array([srgb_to_linear(color) for color in COLORS]) / 0.8  # the material is 0.80
    number = hash_ids(city.seed, f"{ACTION}/color", np.array(ids, np.uint64))
    return np.asarray(colors[(number % np.uint64(len(COLORS))).astype(int)])
